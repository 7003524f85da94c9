"""Pictures on disk: whole or absent, and the same bytes every time."""

from __future__ import annotations

import io
import os
from pathlib import Path
from typing import TYPE_CHECKING

from tandem.errors import UsageError
from tandem.files.atomic import store

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PICTURES = (".svg", ".png", ".pdf")


def save(
    picture: Figure | Axes, path: str | os.PathLike[str], *, dpi: int = 150, about: str = ""
) -> Path:
    """Writes a figure, or the figure of an axes, as SVG, PNG or PDF and returns where. `about` goes
    into what the file says of itself.

    The same picture gives the same bytes: no date, no random identifiers. The file is whole or not
    there at all.

    Raises:
      UsageError: the name ends in none of .svg, .png, .pdf.
      OSError: the file cannot be written; nothing is left behind.
    """
    target = Path(path)
    if target.suffix.lower() not in PICTURES:
        raise UsageError(
            f"{target}: a picture's name ends in {', '.join(PICTURES[:-1])} or {PICTURES[-1]}, not"
            f" {target.suffix or 'nothing'!r}."
        )
    store(target, picture_bytes(picture, target.suffix.lower()[1:], dpi=dpi, about=about))
    return target


def picture_bytes(picture: Figure | Axes, form: str, *, dpi: int = 150, about: str = "") -> bytes:
    """The picture as the bytes of an "svg", "png" or "pdf" file."""
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = picture if isinstance(picture, Figure) else picture.get_figure(root=True)
    assert figure is not None
    if figure.canvas.manager is None:
        FigureCanvasAgg(figure)
    metadata: dict[str, str | None] = {}
    if form != "png":
        metadata["Date" if form == "svg" else "CreationDate"] = None
    if about:
        metadata["Subject" if form == "pdf" else "Description"] = about
    buffer = io.BytesIO()
    with matplotlib.rc_context(
        {"svg.hashsalt": "tandem", "svg.fonttype": "none", "pdf.fonttype": 42}
    ):
        figure.savefig(buffer, format=form, dpi=dpi, metadata=metadata, facecolor="white")
    return buffer.getvalue()
