"""A workbook on its way into the page: the cell in it, how each column was read and what was left
out; where it gives no cell, what stands in the way and what there is to see, so that it can be said
by hand what the columns mean.
"""

from __future__ import annotations

import base64
from collections.abc import Callable
from pathlib import Path, PurePath
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from tandem.errors import CellError, UnsoundScheduleError, UsageError
from tandem.studio.asked import Json
from tandem.studio.failures import failure

if TYPE_CHECKING:
    from tandem.files.spreadsheet.draft import Draft
    from tandem.files.spreadsheet.grid import Book

SHEETS = (".xlsx", ".xlsm", ".xls", ".xlsb", ".ods", ".csv", ".tsv")
MOST_ROWS = 5
"""So many rows of a sheet are shown."""


def read_in(request: Json, tell: Callable[[Json], None]) -> Json:
    """The cell in a workbook. Where there is none a failure, with what was `seen` of the workbook.

    Raises UsageError for a file that is no workbook and for meanings that there are not.
    """
    from tandem.files.spreadsheet.draft import read_book
    from tandem.files.spreadsheet.workbook import open_book

    ending = PurePath(request["name"]).suffix.lower()
    if ending not in SHEETS:
        raise UsageError(f"name ends with {ending!r}: workbooks end with {', '.join(SHEETS)}.")
    columns = dict(map(_meaning, request.get("map", ())))
    with TemporaryDirectory(prefix="tandem-") as folder:
        path = Path(folder) / f"workbook{ending}"
        path.write_bytes(base64.b64decode(request["content"]))
        try:
            book = open_book(path)
        except CellError as error:
            raise without_path(error, str(path)) from None
        try:
            draft = read_book(
                book,
                sheet=request.get("sheet"),
                columns=columns,
                humans=request.get("human", ()),
                robots=request.get("robot", ()),
                machines=request.get("machine", ()),
            )
        except CellError as error:
            # no table was found: the columns can only be told by their letters
            told = failure(without_path(error, str(path)))
            return {**told, "seen": _raw(book, request.get("sheet"))}
    seen = _seen(draft, book, request.get("lang", "en"))
    if draft.faults:
        return {**failure(CellError(draft.faults)), "seen": seen}
    return {"cell": draft.cell().to_dict(), **seen}


def _seen(draft: Draft, book: Book, language: str) -> Json:
    """How each column and operator was read, the first rows, and what was left out or assumed."""
    return {
        "sheet": draft.sheet,
        "sheets": _visible(book),
        "columns": [
            {
                "place": column.place,
                "header": column.header,
                "meaning": None if column.meaning is None else str(column.meaning),
            }
            for column in draft.columns
        ],
        "operators": [
            {"name": name, "kind": operator["kind"]}
            for name, operator in draft.document["operators"].items()
        ],
        "rows": [list(row) for row in draft.rows],
        "notes": [
            {"kind": note.kind, "place": note.place, "message": note.sentence(language)}
            for note in draft.notes
        ],
    }


def _raw(book: Book, sheet: str | None) -> Json:
    """The first rows of a sheet as they stand, the first of them as headers."""
    from tandem.files.spreadsheet.grid import shown

    names = _visible(book)
    chosen = sheet if sheet in names else next(iter(names), None)
    grid = next((grid for grid in book.grids if grid.name == chosen), None)
    filled = [] if grid is None else [n for n, _ in enumerate(grid.rows) if list(grid.filled(n))]
    rows = [list(map(shown, grid.rows[n])) for n in filled[: MOST_ROWS + 1]] if grid else []
    heads = rows[0] if rows else []
    return {
        "sheet": chosen,
        "sheets": names,
        "columns": [
            {"place": grid.place(filled[0], n), "header": text, "meaning": None}
            for n, text in enumerate(heads)
            if grid is not None
        ],
        "operators": [],
        "rows": rows[1:],
        "notes": [],
    }


def _visible(book: Book) -> list[str]:
    return [grid.name for grid in book.grids if not grid.hidden]


def _meaning(text: str) -> tuple[str, str]:
    header, equals, meaning = text.rpartition("=")
    if not equals or not header.strip() or not meaning.strip():
        raise UsageError(f"map {text!r}: write HEADER=MEANING, such as Spalte 4=time robot [s].")
    return header.strip(), meaning.strip()


def without_path(
    error: CellError | UnsoundScheduleError, path: str
) -> CellError | UnsoundScheduleError:
    """The same, said of the plan: where it lay meanwhile is nobody's business."""
    if isinstance(error, CellError):
        return CellError([fault.at(fault.place.replace(path, "plan")) for fault in error.faults])
    return UnsoundScheduleError([fault.replace(path, "plan") for fault in error.faults])
