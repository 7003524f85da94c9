"""Headings, paragraphs and tables on A4, as a PDF that says the same bytes every time."""

from __future__ import annotations

import io
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from matplotlib.backends.backend_pdf import PdfPages
    from matplotlib.figure import Figure

WIDTH, HEIGHT, MARGIN = 595.0, 842.0, 42.0
"""Of a page, points."""
ROOM = WIDTH - 2 * MARGIN
SIZES = {"title": 15.0, "heading": 11.5, "task": 9.5, "text": 8.0, "table": 7.0}
SIGN = 0.56
"""Width of a sign on the mean, in sizes of the letters; measured for the font that is used."""
LINE = 1.35


@dataclass(frozen=True)
class Line:
    """A heading or a paragraph; `colour` behind it, where it has one."""

    text: str
    kind: Literal["title", "heading", "task", "text"] = "text"
    colour: str = ""


@dataclass(frozen=True)
class Grid:
    """A table.

    Attributes:
      widths: shares of the page's width.
      colours: behind the rows, as far as they have one.
    """

    heads: Sequence[str]
    rows: Sequence[Sequence[str]]
    widths: Sequence[float]
    colours: Sequence[str] = ()


Block = Line | Grid


def pdf(blocks: Sequence[Block], title: str) -> bytes:
    """The blocks one below the other on as many pages as they need, each page numbered."""
    import matplotlib
    from matplotlib.backends.backend_pdf import PdfPages

    stream = io.BytesIO()
    about = {"Title": title, "CreationDate": None, "Creator": "Tandem"}
    with (
        matplotlib.rc_context({"pdf.fonttype": 42, "font.family": "DejaVu Sans"}),
        PdfPages(stream, metadata=about) as pages,
    ):
        sheet = _Sheet(pages)
        for block in blocks:
            if isinstance(block, Line):
                sheet.line(block)
            else:
                sheet.table(block)
        sheet.turn()
    return stream.getvalue()


BELOW = {"title": 60, "heading": 120, "task": 60}
"""Points that must have room below a bold line."""


class _Sheet:
    """The page under way, written from the top down."""

    def __init__(self, pages: PdfPages):
        self.pages, self.number = pages, 0
        self.figure, self.y = self._blank(), MARGIN

    def _blank(self) -> Figure:
        from matplotlib.figure import Figure

        return Figure(figsize=(WIDTH / 72, HEIGHT / 72))

    def turn(self) -> None:
        """Writes the page, and begins the next."""
        self.number += 1
        self.text(WIDTH - MARGIN - 10, HEIGHT - MARGIN + 12, str(self.number), SIZES["table"])
        self.pages.savefig(self.figure)  # type: ignore[no-untyped-call]
        self.figure, self.y = self._blank(), MARGIN

    def need(self, height: float) -> None:
        """Turns the page where so much has no room any more."""
        if self.y + height > HEIGHT - MARGIN and self.y > MARGIN:
            self.turn()

    def text(self, x: float, y: float, said: str, size: float, bold: bool = False) -> None:
        self.figure.text(
            x / WIDTH, 1 - y / HEIGHT, said, fontsize=size, va="top", parse_math=False,
            fontweight="bold" if bold else "normal",
        )  # fmt: skip

    def behind(self, x: float, y: float, width: float, height: float, colour: str) -> None:
        from matplotlib.patches import Rectangle

        place = (x / WIDTH, 1 - (y + height) / HEIGHT)
        self.figure.add_artist(
            Rectangle(place, width / WIDTH, height / HEIGHT, color=colour, lw=0, zorder=-1)
        )

    def line(self, block: Line) -> None:
        size = SIZES[block.kind]
        bold = block.kind != "text"
        lines = _wrapped(block.text, ROOM, size * (1.08 if bold else 1))
        height = len(lines) * size * LINE
        above = 0.0 if block.kind == "text" else size * 0.9
        # a heading stays with what follows it, which may be the name of a task and its lines
        self.need(above + height + (BELOW[block.kind] if bold else 0))
        self.y += above if self.y > MARGIN else 0
        if block.colour:
            self.behind(MARGIN - 3, self.y - 2, ROOM + 6, height + 3, block.colour)
        for said in lines:
            self.text(MARGIN, self.y, said, size, bold)
            self.y += size * LINE
        self.y += 4

    def table(self, block: Grid) -> None:
        places = [MARGIN + ROOM * sum(block.widths[:at]) for at in range(len(block.widths))]
        self._row(block.heads, places, block.widths, bold=True)
        for at, row in enumerate(block.rows):
            colour = block.colours[at] if block.colours else ""
            if self._row(row, places, block.widths, colour=colour):
                continue
            self._row(block.heads, places, block.widths, bold=True)
            self._row(row, places, block.widths, colour=colour)
        self.y += 6

    def _row(
        self,
        cells: Sequence[str],
        places: Sequence[float],
        widths: Sequence[float],
        *,
        bold: bool = False,
        colour: str = "",
    ) -> bool:
        """Writes a row; False when the page had to be turned for it, so that the heads come
        first.
        """
        size = SIZES["table"]
        columns = [
            _wrapped(cell, ROOM * width - 6, size * (1.08 if bold else 1))
            for cell, width in zip(cells, widths, strict=True)
        ]
        height = max(map(len, columns)) * size * LINE + 2
        if self.y + height > HEIGHT - MARGIN and self.y > MARGIN:
            self.turn()
            if not bold:
                return False
        if colour:
            self.behind(MARGIN - 3, self.y - 1.5, ROOM + 6, height, colour)
        for lines, place in zip(columns, places, strict=True):
            for at, said in enumerate(lines):
                self.text(place, self.y + at * size * LINE, said, size, bold)
        self.y += height
        return True


def _wrapped(text: str, width: float, size: float) -> list[str]:
    return textwrap.wrap(text, max(4, int(width / (SIGN * size)))) or [""]
