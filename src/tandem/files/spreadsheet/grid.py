"""A sheet as it lies on the planner's screen: values in a rectangle from A1, and what is odd about
some of them.
"""

from __future__ import annotations

import datetime
import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from tandem.cell.names import clean
from tandem.files.spreadsheet.said import Said

Value = str | float | bool | datetime.date | datetime.time | datetime.timedelta
"""What one sheet cell holds; the empty text when it holds nothing."""

MOST_ROWS = 10_000
"""A sheet with more rows than this is data of another kind, not the tasks of one station."""
MOST_CELLS, MOST_TEXT = 500_000, 10_000_000
"""Of a sheet, its columns reckoned to the last one that holds anything, and characters in all of
it: ten thousand tasks with fifty columns. What is larger would keep the import busy for minutes.
"""


@dataclass(frozen=True)
class Grid:
    """One sheet.

    Attributes:
      name: of the sheet; of the file without its ending for CSV.
      rows: values from A1 on, every row equally long, empty ones as "".
      merged: merged areas, `(top, left, bottom, right)`, all counted from 0 and included.
      words: `(row, column)` of numbers -> what their number format writes beside them: "min", "%",
        "€".
      odd: `(row, column)` of cells without a usable value -> what they hold, as the end of a
        sentence and the way out.
      lengths: how many columns each row of a text file has of its own.
      hidden: the sheet itself is hidden.
      hidden_rows, hidden_columns: counted from 0.
      indents: `(row, column)` -> how far the cell is indented by its format, where it is.
      comments: `(row, column)` -> what somebody remarked at the cell.
    """

    name: str
    rows: tuple[tuple[Value, ...], ...]
    merged: tuple[tuple[int, int, int, int], ...] = ()
    odd: Mapping[tuple[int, int], str] = field(default_factory=dict)
    words: Mapping[tuple[int, int], str] = field(default_factory=dict)
    lengths: tuple[int, ...] = ()
    hidden: bool = False
    hidden_rows: frozenset[int] = frozenset()
    hidden_columns: frozenset[int] = frozenset()
    indents: Mapping[tuple[int, int], int] = field(default_factory=dict)
    comments: Mapping[tuple[int, int], str] = field(default_factory=dict)

    @cached_property
    def width(self) -> int:
        return max((len(row) for row in self.rows), default=0)

    def place(self, row: int, column: int) -> str:
        """Where a person finds it: `Sheet1!C4`."""
        return f"{self.name}!{letters(column)}{row + 1}"

    def is_blank(self, row: int) -> bool:
        """Nothing stands in the row, not even a formula without a result."""
        return all(blank(value) for value in self.rows[row]) and not any(
            r == row for r, _ in self.odd
        )

    def spread_of(self, row: int, column: int) -> tuple[int, int, int, int]:
        """The merged area around a cell; the cell itself when it is not merged."""
        return self._areas.get((row, column), (row, column, row, column))

    @cached_property
    def _areas(self) -> dict[tuple[int, int], tuple[int, int, int, int]]:
        """Cell -> the merged area that it is part of, as far as the sheet reaches. Areas of a sound
        file never overlap.
        """
        found: dict[tuple[int, int], tuple[int, int, int, int]] = {}
        for area in self.merged:
            top, left, bottom, right = area
            rows, columns = (
                range(top, min(bottom + 1, len(self.rows))),
                range(left, min(right + 1, self.width)),
            )
            for cell in itertools.product(rows, columns):
                if cell in found:
                    break  # so that a damaged file costs no more than its cells
                found[cell] = area
        return found

    def origin(self, row: int, column: int) -> int:
        """The row whose cell speaks for this one: the top of an area that is merged downwards, else
        the row itself.
        """
        top, left, _, _ = self.spread_of(row, column)
        return top if left == column else row

    def value(self, row: int, column: int) -> Value:
        """What stands there; the value of a merged area counts for every row of it, in its first
        column.
        """
        return self.rows[self.origin(row, column)][column]

    def filled(self, row: int) -> Iterator[tuple[int, Value]]:
        """`(column, value)` of what is not blank in a row."""
        return ((column, value) for column, value in enumerate(self.rows[row]) if not blank(value))


@dataclass(frozen=True)
class Book:
    """A file of sheets.

    Attributes:
      grids: worksheets in the file's order.
      passed_over: sheets without rows of their own (charts, macros), and sheets that are too long,
        name -> why.
      remarks: how the file was read, one sentence each.
      sees_errors: error values can be told from empty cells.
    """

    path: Path
    grids: tuple[Grid, ...]
    passed_over: Mapping[str, Said] = field(default_factory=dict)
    remarks: tuple[Said, ...] = ()
    sees_errors: bool = True


def trimmed(rows: Sequence[Sequence[Value]]) -> list[Sequence[Value]]:
    """The rows without the empty columns behind the last one that holds anything."""
    width = max((_filled_width(row) for row in rows), default=0)
    return [row[:width] for row in rows]


def _filled_width(row: Sequence[Value]) -> int:
    width = len(row)
    while width and row[width - 1] == "":
        width -= 1
    return width


def flood(rows: Sequence[Sequence[Value]]) -> str:
    """Why a sheet is more than Tandem reads, as the end of a sentence; empty when it is not."""
    if len(rows) > MOST_ROWS:
        return f"has {len(rows):,} rows, and Tandem reads at most {MOST_ROWS:,}"
    cells = len(rows) * max(map(len, rows), default=0)
    if cells > MOST_CELLS:
        return f"has {cells:,} cells, and Tandem reads at most {MOST_CELLS:,}"
    signs = sum(len(value) for row in rows for value in row if isinstance(value, str))
    if signs > MOST_TEXT:
        return f"holds {signs:,} characters, and Tandem reads at most {MOST_TEXT:,}"
    return ""


def letters(column: int) -> str:
    """0 -> A, 25 -> Z, 26 -> AA."""
    text = ""
    column += 1
    while column:
        column, rest = divmod(column - 1, 26)
        text = chr(65 + rest) + text
    return text


def blank(value: Value) -> bool:
    """Nothing to see: empty, or blanks of any width."""
    return isinstance(value, str) and not tidy(value)


def tidy(text: str) -> str:
    """The text as names are spelled everywhere: single blanks, no unseen signs, letters with their
    accents in one piece.
    """
    return clean(text)


def shown(value: Value) -> str:
    """The value as a person reads it in the sheet."""
    if isinstance(value, bool):
        return str(value).upper()
    if isinstance(value, float | int):
        return f"{value:.15g}"
    if isinstance(value, str):
        return tidy(value)
    return str(value)
