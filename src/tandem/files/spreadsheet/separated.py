"""CSV as spreadsheets write it: encoding, separator and quotes are found out, not asked."""

from __future__ import annotations

import csv
import io
import re
from collections import Counter
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from tandem.errors import CellError, Fault
from tandem.files.spreadsheet.grid import MOST_ROWS, MOST_TEXT, Book, Grid, flood, letters, trimmed
from tandem.files.spreadsheet.said import say
from tandem.files.spreadsheet.struck import struck_by_marks

MOST_COLUMNS, MOST_SIGNS = 16_384, 32_767
"""What a sheet and a cell of Excel hold."""

STATED = re.compile(r"sep=(.)(?:\r\n|\r|\n|\Z)", re.IGNORECASE)
"""The first line with which Excel states the separator."""

KEEP = "Keep only the tasks of one station."

ONE_BYTE = {"cp1252": "Windows-1252", "cp850": "DOS (code page 850)", "mac_roman": "Mac Roman"}
"""Codes of a byte a letter, the likeliest first: the umlauts of one are signs in another."""
MOST_LOOKED_AT = 200_000

SEPARATORS = {"\t": "tabs", ";": "semicolons", "|": "bars", ",": "commas"}
"""In the order in which they are believed when two fit equally well: a comma may be a decimal
mark.
"""


def read(path: Path, content: bytes) -> Book:
    """One sheet, named like the file.

    Raises:
      CellError: when the content is not text, or holds too many rows.
    """
    text, encoding = _decode(path, content)
    if stated := STATED.match(text):
        separator = stated[1]
        text = "\n" + text[stated.end() :]  # keeps the row numbers
    else:
        separator = _separator(text)
    records = _records(path, text, separator)
    rows = trimmed([record.fields for record in records])
    if too_much := flood(rows):
        raise CellError([Fault(f"{too_much}. {KEEP}", place=path.name)])
    _refuse_stray_quotes(path, text, separator, records)
    width = max(map(len, rows), default=0)
    full = tuple((*row, *[""] * (width - len(row))) for row in rows)
    named = SEPARATORS.get(separator)
    remark = say(
        "text",
        encoding=encoding,
        separator=say(f"separator.{named}") if named else repr(separator),
    )
    grid = Grid(path.stem, full, odd=struck_by_marks(full), lengths=tuple(map(len, rows)))
    return Book(path, (grid,), remarks=(remark,))


@dataclass(frozen=True)
class Record:
    """One row: its fields, and the lines of the file that it takes, counted from 0, the last one
    not included.
    """

    fields: list[str]
    first_line: int
    end_line: int


def _records(path: Path, text: str, separator: str) -> list[Record]:
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=separator)
    records, line = [], 0
    try:
        for fields in reader:
            records.append(Record(fields, line, reader.line_num))
            line = reader.line_num
            if len(records) > MOST_ROWS:
                message = f"has more than {MOST_ROWS:,} rows, the most that Tandem reads. {KEEP}"
                raise CellError([Fault(message, place=path.name)])
            _refuse_a_flood(path, fields, len(records))
    except csv.Error as error:
        raise CellError([Fault(f"is no readable CSV: {error}.", place=path.name)]) from error
    return records


def _refuse_a_flood(path: Path, fields: list[str], number: int) -> None:
    """More columns, or more in one cell, than a workbook can hold; rows are filled up to the
    widest, so one such row would cost as much in all.
    """
    if len(fields) > MOST_COLUMNS:
        message = (
            f"row {number} has {len(fields):,} columns, and a sheet has at most {MOST_COLUMNS:,}."
            " Is another separator meant?"
        )
        raise CellError([Fault(message, place=path.name)])
    for column, text in enumerate(fields):
        if len(text) > MOST_SIGNS:
            message = (
                f"holds {len(text):,} characters, and a cell has at most {MOST_SIGNS:,}."
                " Shorten it."
            )
            raise CellError([Fault(message, place=f"{path.stem}!{letters(column)}{number}")])


def _refuse_stray_quotes(path: Path, text: str, separator: str, records: list[Record]) -> None:
    """A quotation mark that opens a text and swallows the rows behind it, to the end of the file or
    to the next mark.
    """
    lines = io.StringIO(text, newline="").readlines()
    widest = max((len(record.fields) for record in records), default=1)
    faults = []
    for number, record in enumerate(records, 1):
        own = lines[record.first_line : record.end_line]
        is_open = record is records[-1] and _never_closed(own, separator)
        swallowed = next(
            (line for line in own[1:] if _reads_like_a_row(line, separator, widest)), None
        )
        if is_open or swallowed is not None:
            what = (
                "is opened and never closed"
                if is_open
                else f"is opened and closed only in line {record.end_line}, which takes in rows"
            )
            way_out = "Close it or take it out; a quotation mark in a text is written twice."
            line = f" (line {record.first_line + 1})" if record.first_line + 1 != number else ""
            column = next(
                (c for c, field in enumerate(record.fields) if "\n" in field or "\r" in field),
                len(record.fields) - 1,
            )
            faults.append(
                Fault(
                    f"row {number}{line}: a quotation mark {what}. {way_out}",
                    place=f"{path.stem}!{letters(column)}{number}",
                )
            )
    if faults:
        raise CellError(faults)


def _never_closed(lines: list[str], separator: str) -> bool:
    """A further line becomes part of the last text instead of a row of its own."""
    return (
        len(
            list(
                csv.reader(
                    [*lines[:-1], lines[-1].rstrip("\r\n") + "\n", "end"], delimiter=separator
                )
            )
        )
        == 1
        if lines
        else False
    )


def _reads_like_a_row(line: str, separator: str, widest: int) -> bool:
    """As far as the quotes reach, separators stand in it as between values: without a blank behind
    them, or as many as in a row.
    """
    closed = re.match(r'(?:[^"]|"")*"', line)
    inside = closed[0] if closed else line.rstrip("\r\n")
    return re.search(rf"{re.escape(separator)}\S", inside) is not None or inside.count(
        separator
    ) >= max(2, widest - 1)


def _decode(path: Path, content: bytes) -> tuple[str, str]:
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        return content.decode("utf-16", errors="replace"), "UTF-16"
    if b"\0" in content:
        raise CellError(
            [
                Fault(
                    "is not text. Is it a workbook with the wrong ending? Save it as .xlsx or as"
                    " CSV UTF-8.",
                    place=path.name,
                )
            ]
        )
    try:
        return content.decode("utf-8-sig"), "UTF-8"
    except UnicodeDecodeError:
        code = max(ONE_BYTE, key=lambda code: _letters(content[:MOST_LOOKED_AT], code))
        return content.decode(code, errors="replace"), ONE_BYTE[code]


def _letters(content: bytes, code: str) -> int:
    """How many letters with accents stand within words, umlauts twice, if that is the code."""
    text = content.decode(code, errors="replace")
    umlauts = re.findall(r"(?<=[A-Za-z])[äöüß]|[ÄÖÜäöü](?=[a-z])", text)
    return 2 * len(umlauts) + len(re.findall(r"(?<=[a-z])[éèêàáâçñóíúôûøåæ]", text))


def _separator(text: str) -> str:
    """The separator by which most lines have the same number of columns, more than one."""
    lines = (line for line in io.StringIO(text[:MOST_TEXT], newline=None) if line.strip())
    sample = "".join(islice(lines, 200))

    def share(separator: str) -> float:
        try:
            widths = Counter(
                len(row) for row in csv.reader(io.StringIO(sample), delimiter=separator)
            )
        except csv.Error:
            return 0.0
        several = Counter({width: count for width, count in widths.items() if width > 1})
        return several.most_common(1)[0][1] / sum(widths.values()) if several else 0.0

    return max(SEPARATORS, key=share) if any(map(share, SEPARATORS)) else ","
