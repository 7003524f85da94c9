"""CSV as spreadsheets write it: encoding, separator and quotes are found out, not asked."""

from __future__ import annotations

import csv
import io
from collections import Counter
from pathlib import Path

from tandem.cell.spreadsheet.grid import MOST_ROWS, Book, Grid
from tandem.errors import CellError, Fault

SEPARATORS = {"\t": "tabs", ";": "semicolons", "|": "bars", ",": "commas"}
"""In the order in which they are believed when two fit equally well: a comma may be a decimal mark."""


def read(path: Path, content: bytes) -> Book:
    """One sheet, named like the file.

    Raises:
      CellError: when the content is not text, or holds too many rows.
    """
    text, encoding = _decode(path, content)
    lines = text.splitlines()
    if lines and lines[0].lower().startswith("sep=") and len(lines[0]) == 5:
        separator = lines[0][4]
        text = "\n" + "\n".join(lines[1:])  # keeps the row numbers
    else:
        separator = _separator(lines)
    try:
        rows = [row for row, _ in zip(csv.reader(io.StringIO(text, newline=""), delimiter=separator), range(MOST_ROWS + 1), strict=False)]
    except csv.Error as error:
        raise CellError([Fault(f"is no readable CSV: {error}.", place=path.name)]) from error
    if len(rows) > MOST_ROWS:
        message = f"has more than {MOST_ROWS:,} rows, the most that Tandem reads. Keep only the tasks of one station."
        raise CellError([Fault(message, place=path.name)])
    width = max(map(len, rows), default=0)
    full = tuple((*row, *[""] * (width - len(row))) for row in rows)
    remark = f"read as {encoding} text with columns separated by {SEPARATORS.get(separator, repr(separator))}."
    return Book(path, (Grid(path.stem, full),), remarks=(remark,))


def _decode(path: Path, content: bytes) -> tuple[str, str]:
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        return content.decode("utf-16", errors="replace"), "UTF-16"
    if b"\0" in content:
        raise CellError([Fault("is not text. Is it a workbook with the wrong ending? Save it as .xlsx or as CSV UTF-8.", place=path.name)])
    try:
        return content.decode("utf-8-sig"), "UTF-8"
    except UnicodeDecodeError:
        return content.decode("cp1252", errors="replace"), "Windows-1252"


def _separator(lines: list[str]) -> str:
    """The separator by which most lines have the same number of columns, more than one."""
    sample = "\n".join([line for line in lines if line.strip()][:200])

    def share(separator: str) -> float:
        try:
            widths = Counter(len(row) for row in csv.reader(io.StringIO(sample), delimiter=separator))
        except csv.Error:
            return 0.0
        several = Counter({width: count for width, count in widths.items() if width > 1})
        return several.most_common(1)[0][1] / sum(widths.values()) if several else 0.0

    return max(SEPARATORS, key=share) if any(map(share, SEPARATORS)) else ","
