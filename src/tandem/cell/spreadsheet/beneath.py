"""What a reader of values does not show: formulas without a stored result, error values, hidden rows and columns.

Calamine gives an empty text for all of these, so that a broken formula would look like "cannot do it". This file looks into the
XML of xlsx and ods for them. The binary formats xls and xlsb stay closed; `look` says so with its second answer.
"""

from __future__ import annotations

import io
import posixpath
import re
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import IO
from xml.etree import ElementTree

NO_RESULT = "holds a formula with no stored result: open and save it in Excel or LibreOffice"
MOST_REPEATS = 2_000


@dataclass
class Sight:
    """One sheet's odd cells, `(row, column)` -> what they hold; its hidden rows and columns, counted from 0."""

    odd: dict[tuple[int, int], str] = field(default_factory=dict)
    hidden_rows: frozenset[int] = frozenset()
    hidden_columns: frozenset[int] = frozenset()


def look(content: bytes) -> tuple[dict[str, Sight], bool]:
    """Sheet name -> `Sight`, and whether the format could be looked into at all."""
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        names = set(archive.namelist())
        try:
            if "content.xml" in names:
                with archive.open("content.xml") as stream:
                    return dict(_ods(stream)), True
            if "xl/workbook.bin" in names:
                return {}, False
            sights = {}
            for sheet, part in _sheet_parts(archive):
                if part in names:
                    with archive.open(part) as stream:
                        sights[sheet] = _xlsx(stream)
            return sights, True
        except (ElementTree.ParseError, KeyError, zipfile.BadZipFile):
            return {}, False


def _error(value: str) -> str:
    return f"holds the error {value}: mend the formula, or clear the cell if there is none"


def _tag(element: ElementTree.Element) -> str:
    return element.tag.rpartition("}")[2]


def _attribute(element: ElementTree.Element, name: str) -> str | None:
    return next((value for key, value in element.attrib.items() if key.rpartition("}")[2] == name), None)


# --- xlsx ---------------------------------------------------------------------------------------------------------------------


def _sheet_parts(archive: zipfile.ZipFile) -> Iterator[tuple[str, str]]:
    """`(sheet name, part)` by way of the relations, as the parts may have any name."""
    book = next(
        (target for kind, _, target in _relations(archive, "_rels/.rels", "") if kind.endswith("/officeDocument")),
        "xl/workbook.xml",
    )
    folder, name = posixpath.split(book)
    targets = {key: target for _, key, target in _relations(archive, f"{folder}/_rels/{name}.rels", folder)}
    for element in ElementTree.fromstring(archive.read(book)).iter():
        if _tag(element) == "sheet":
            key = next((value for k, value in element.attrib.items() if k.endswith("}id")), "")
            if key in targets:
                yield element.attrib.get("name", ""), targets[key]


def _relations(archive: zipfile.ZipFile, part: str, folder: str) -> Iterator[tuple[str, str, str]]:
    for element in ElementTree.fromstring(archive.read(part)):
        target = element.attrib.get("Target", "")
        whole = target.lstrip("/") if target.startswith("/") else posixpath.normpath(posixpath.join(folder, target))
        yield element.attrib.get("Type", ""), element.attrib.get("Id", ""), whole


def _xlsx(stream: IO[bytes]) -> Sight:
    sight = Sight()
    hidden_rows: set[int] = set()
    hidden_columns: set[int] = set()
    row = -1
    for event, element in ElementTree.iterparse(stream, events=("start", "end")):
        tag = _tag(element)
        if event == "start" and tag == "row":
            row = int(element.attrib.get("r", row + 2)) - 1
            if element.attrib.get("hidden") in ("1", "true"):
                hidden_rows.add(row)
        elif event == "end" and tag == "col" and element.attrib.get("hidden") in ("1", "true"):
            first = int(element.attrib["min"])
            hidden_columns.update(range(first - 1, min(int(element.attrib["max"]), first + 200)))
        elif event == "end" and tag == "row":
            column = -1
            for cell in element:
                column = _column(cell.attrib.get("r", ""), column + 1)
                if why := _odd(cell):
                    sight.odd[row, column] = why
            element.clear()
    sight.hidden_rows, sight.hidden_columns = frozenset(hidden_rows), frozenset(hidden_columns)
    return sight


def _odd(cell: ElementTree.Element) -> str | None:
    parts = {_tag(part): part for part in cell}
    value = parts["v"].text if "v" in parts else None
    if cell.attrib.get("t") == "e":
        return _error(value or "?")
    if "f" in parts and not value and cell.attrib.get("t") != "str":
        return NO_RESULT
    return None


def _column(reference: str, otherwise: int) -> int:
    found = re.match(r"[A-Z]+", reference)
    if not found:
        return otherwise
    number = 0
    for letter in found.group():
        number = number * 26 + ord(letter) - 64
    return number - 1


# --- ods ----------------------------------------------------------------------------------------------------------------------


def _ods(stream: IO[bytes]) -> Iterator[tuple[str, Sight]]:
    for _, element in ElementTree.iterparse(stream, events=("end",)):
        if _tag(element) == "table" and _attribute(element, "name") is not None:
            yield _attribute(element, "name") or "", _ods_sheet(element)
            element.clear()


def _ods_sheet(table: ElementTree.Element) -> Sight:
    sight = Sight()
    hidden_rows: set[int] = set()
    hidden_columns: set[int] = set()
    row = column = 0
    for element in table.iter():
        tag = _tag(element)
        if tag == "table-column":
            repeats = int(_attribute(element, "number-columns-repeated") or 1)
            if _attribute(element, "visibility") in ("collapse", "filter"):
                hidden_columns.update(range(column, column + min(repeats, MOST_REPEATS)))
            column += repeats
        elif tag == "table-row":
            repeats = int(_attribute(element, "number-rows-repeated") or 1)
            if _attribute(element, "visibility") in ("collapse", "filter"):
                hidden_rows.update(range(row, row + min(repeats, MOST_REPEATS)))
            for place, why in _ods_row(element):
                sight.odd.update({(r, place): why for r in range(row, row + min(repeats, MOST_REPEATS))})
            row += repeats
    sight.hidden_rows, sight.hidden_columns = frozenset(hidden_rows), frozenset(hidden_columns)
    return sight


def _ods_row(row: ElementTree.Element) -> Iterator[tuple[int, str]]:
    column = 0
    for cell in row:
        if _tag(cell) not in ("table-cell", "covered-table-cell"):
            continue
        repeats = int(_attribute(cell, "number-columns-repeated") or 1)
        text = "".join(cell.itertext()).strip()
        formula = _attribute(cell, "formula") is not None
        if formula and re.fullmatch(r"#(REF|N/A|NAME\?|VALUE|DIV/0|NULL|NUM)!?|Err:\d+|#[A-ZÄÖÜ/]+[!?]", text):
            yield from ((column + i, _error(text)) for i in range(min(repeats, MOST_REPEATS)))
        elif formula and not text and _attribute(cell, "value") is None and _attribute(cell, "value-type") is None:
            yield from ((column + i, NO_RESULT) for i in range(min(repeats, MOST_REPEATS)))
        column += repeats


# --- indents ------------------------------------------------------------------------------------------------------------------


def indented(content: bytes) -> dict[str, dict[tuple[int, int], int]]:
    """Sheet name -> `(row, column)` -> how far a cell of an xlsx is indented by its format; only cells that are."""
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        names = set(archive.namelist())
        if "xl/styles.xml" not in names or "xl/workbook.xml" not in names:
            return {}
        try:
            styles = _indents_of_styles(archive.read("xl/styles.xml"))
            if not styles:
                return {}
            found = {}
            for sheet, part in _sheet_parts(archive):
                if part in names:
                    with archive.open(part) as stream:
                        found[sheet] = dict(_indented_cells(stream, styles))
            return found
        except (ElementTree.ParseError, KeyError, ValueError, zipfile.BadZipFile):
            return {}


def _indents_of_styles(styles: bytes) -> dict[str, int]:
    """The number of a cell's style -> its indent, where it has one."""
    cells = next((list(element) for element in ElementTree.fromstring(styles) if _tag(element) == "cellXfs"), [])
    indents = {str(place): part.attrib.get("indent", "0") for place, style in enumerate(cells) for part in style if _tag(part) == "alignment"}
    return {place: int(indent) for place, indent in indents.items() if indent.isdecimal() and indent != "0"}


def _indented_cells(stream: IO[bytes], styles: dict[str, int]) -> Iterator[tuple[tuple[int, int], int]]:
    for _, element in ElementTree.iterparse(stream):
        if _tag(element) == "c" and (indent := styles.get(element.attrib.get("s", ""))):
            reference = re.fullmatch(r"([A-Z]{1,3})(\d{1,7})", element.attrib.get("r", ""))
            if reference:
                yield (int(reference[2]) - 1, _column(reference[1], 0)), indent
        elif _tag(element) == "row":
            element.clear()
