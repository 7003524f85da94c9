"""Opens xlsx, xlsm, xls, xlsb, ods and csv: a path in, a `Book` out, or one message why not."""

from __future__ import annotations

import io
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any

from tandem.errors import CellError, Fault
from tandem.files.spreadsheet import hidden_content, separated
from tandem.files.spreadsheet.confined import REMEDY, RefusedError, open_apart
from tandem.files.spreadsheet.grid import Book, Grid, flood, trimmed
from tandem.files.spreadsheet.said import say
from tandem.files.spreadsheet.struck import struck_by_marks

MOST_BYTES = 50_000_000
MOST_BYTES_UNPACKED = 600_000_000
MOST_RATIO = 100
"""Of a large archive's content to its size: a million rows that are empty but for their format pack
to a twenty-eighth.
"""
MOST_ENTRIES = 5_000
TEXT_ENDINGS = {".csv", ".tsv", ".txt"}
ENDINGS = (".xlsx", ".xlsm", ".xls", ".xlsb", ".ods", ".csv", ".tsv")
OLD_OFFICE = bytes.fromhex("d0cf11e0a1b11ae1")


def is_spreadsheet(path: Path) -> bool:
    """The file's ending is one that planners' sheets have."""
    return path.suffix.lower() in ENDINGS


def open_book(path: Path) -> Book:
    """Every sheet of the file.

    Raises:
      CellError: one fault with the file's name when it is missing, empty, cut off, protected by a
        password, or no workbook at all.
    """
    try:
        with open(path, "rb") as file:
            content = file.read(MOST_BYTES + 1)  # no more of it, whatever size it claims
    except OSError as error:
        raise refused(path, f"cannot be read: {error.strerror or error}.") from error
    if len(content) > MOST_BYTES:
        raise refused(
            path,
            f"is larger than {MOST_BYTES // 1_000_000} MB. Keep only the sheet with the tasks, and"
            " save it under a new name.",
        )
    return book_of(path, content)


def book_of(path: Path, content: bytes) -> Book:
    """The same for content that is at hand; `path` gives it a name. Raises as `open_book` does."""
    if not content.strip(b"\0 \r\n\t"):
        raise refused(path, "is empty. Was it saved or copied completely?")
    if content.startswith(b"PK\x03\x04"):
        return _apart(path, content)
    if content.startswith(OLD_OFFICE):
        if "EncryptedPackage".encode("utf-16-le") in content:
            raise refused(
                path,
                "is protected by a password. Remove it in Excel (File, Info, Protect Workbook,"
                " Encrypt with Password) and save.",
            )
        return _apart(path, content)
    if path.suffix.lower() in TEXT_ENDINGS or (
        path.suffix.lower() == ".xls" and _looks_like_text(content)
    ):
        return separated.read(path, content)
    if path.suffix.lower() not in ENDINGS:
        raise refused(path, f"is no spreadsheet that Tandem reads. Known are {', '.join(ENDINGS)}.")
    raise refused(
        path,
        f"is no {path.suffix.lower()} workbook although its name says so. Open it where it was made"
        " and save it as .xlsx.",
    )


def refused(path: Path, message: str) -> CellError:
    """One fault about the file as a whole."""
    return CellError([Fault(message, place=path.name)])


def _apart(path: Path, content: bytes) -> Book:
    try:
        return open_apart(path, content)
    except RefusedError as error:
        raise refused(path, str(error)) from error


def unpacked(path: Path, content: bytes) -> Book:
    """The book that is opened here and now, in this process: for content of our own making, and for
    the process that `confined` starts.
    """
    return _calamine(path, content)


def _looks_like_text(content: bytes) -> bool:
    """Some programs write tab-separated text and call it .xls."""
    head = content[:4096]
    return not head.lstrip().startswith((b"<", b"{")) and (
        head.startswith((b"\xff\xfe", b"\xfe\xff")) or b"\0" not in head
    )


def _calamine(path: Path, content: bytes) -> Book:
    import python_calamine as calamine

    zipped = content.startswith(b"PK")
    if zipped:
        _refuse_a_damaged_archive(path, content)
    try:
        workbook = calamine.CalamineWorkbook.from_filelike(io.BytesIO(content))
    except calamine.PasswordError as error:
        raise refused(
            path, "is protected by a password. Remove the password where it was made, and save."
        ) from error
    except Exception as error:
        # calamine has no common promise about what it raises on damaged files
        raise refused(
            path,
            f"cannot be read as a workbook ({error}). It may be cut off: copy it again, or open and"
            " save it anew.",
        ) from error
    sights, sees_errors = hidden_content.look(content) if zipped else ({}, False)
    indents = hidden_content.indented(content) if zipped else {}
    grids, passed_over = [], {}
    for sheet in workbook.sheets_metadata:
        if sheet.typ != calamine.SheetTypeEnum.WorkSheet:
            passed_over[sheet.name] = say("why.no_sheet")
            continue
        try:
            data = workbook.get_sheet_by_name(sheet.name)
            rows, merged = (
                _rows(data),
                tuple((a[0], a[1], b[0], b[1]) for a, b in data.merged_cell_ranges or ()),
            )
        except Exception as error:
            raise refused(
                path,
                f"sheet {sheet.name!r} cannot be read ({error}). Open and save the workbook anew.",
            ) from error
        if too_much := flood(trimmed(rows)):
            passed_over[sheet.name] = say("why.flood", text=too_much)
            continue
        sight = sights.get(sheet.name, hidden_content.Sight())
        visible = sheet.visible == calamine.SheetVisibleEnum.Visible
        grids.append(
            replace(
                _grid(sheet.name, rows, merged, sight, not visible),
                indents=indents.get(sheet.name, {}),
            )
        )
    return Book(path, tuple(grids), passed_over, sees_errors=sees_errors)


def _grid(
    name: str,
    rows: list[list[Any]],
    merged: tuple[tuple[int, int, int, int], ...],
    sight: hidden_content.Sight,
    hidden: bool,
) -> Grid:
    height = max([len(rows), *(row + 1 for row, _ in sight.odd)])
    width = max([*(len(row) for row in rows), *(column + 1 for _, column in sight.odd)], default=0)
    full = [[*row, *[""] * (width - len(row))] for row in [*rows, *([[]] * (height - len(rows)))]]
    for (row, column), length in sight.durations.items():
        if row < height and column < width:
            full[row][column] = length
    return Grid(
        name,
        tuple(map(tuple, full)),
        merged=merged or tuple(sight.merged),
        odd={**struck_by_marks(full), **sight.odd},
        words=sight.words,
        comments=sight.comments,
        hidden=hidden,
        hidden_rows=sight.hidden_rows,
        hidden_columns=sight.hidden_columns,
    )


def _rows(sheet: Any) -> list[list[Any]]:
    """Rows from A1, without the empty ones at the end that formatting alone leaves behind."""
    rows: list[list[Any]] = sheet.to_python(skip_empty_area=False)
    while rows and all(value == "" for value in rows[-1]):
        rows.pop()
    return rows


def _refuse_a_damaged_archive(path: Path, content: bytes) -> None:
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            unpacked = sum(entry.file_size for entry in archive.infolist())
            names = archive.namelist()
    except (zipfile.BadZipFile, OSError, ValueError) as error:
        raise refused(
            path,
            "is damaged or cut off (its end is missing). Copy it again from where it was made.",
        ) from error
    if unpacked > MOST_BYTES_UNPACKED:
        raise refused(
            path,
            f"unpacks to {unpacked // 1_000_000:,} MB, more than Tandem opens. Keep only the sheet"
            " with the tasks.",
        )
    if unpacked > MOST_BYTES and unpacked > MOST_RATIO * len(content):
        raise refused(
            path,
            f"unpacks to {unpacked // len(content):,} times its size, as no workbook does."
            f" {REMEDY}",
        )
    if len(names) > MOST_ENTRIES:
        raise refused(
            path, f"holds {len(names):,} parts, and Tandem opens at most {MOST_ENTRIES:,}. {REMEDY}"
        )
    if not any(name.startswith("xl/") or name == "content.xml" for name in names):
        raise refused(
            path,
            "is a zip archive but no workbook. Open it where it was made and save it as .xlsx.",
        )
