"""What a reader of values does not show: formulas without a stored result, error values, hidden
rows and columns, number formats.

Calamine gives an empty text for the first two, so that a broken formula would look like "cannot do
it"; 1.5 for what is shown as "1.50 min"; and no merged areas of ods. This file looks into the XML
of xlsx and ods for them. The binary formats xls and xlsb stay closed; `look` says so with its
second answer.
"""

from __future__ import annotations

import io
import posixpath
import re
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import IO, Literal
from xml.etree import ElementTree

from tandem.files.spreadsheet.number_format import BUILT_IN, dress, shown_duration
from tandem.files.spreadsheet.struck import STRUCK, Run, odd_runs

NO_RESULT = "holds a formula with no stored result: open and save it in Excel or LibreOffice"
MOST_REPEATS = 2_000
RAISED = re.compile(r"super|0*[1-9]")
"""The position of a text in an ods, by a word or per cent of its height."""
MOST_PARENTS = 20
"""Of an ods, styles above one another: as many are looked at, so that a ring of them ends."""


@dataclass
class Sight:
    """One sheet's odd cells, `(row, column)` -> what they hold; its hidden rows and columns,
    counted from 0.

    Attributes:
      words: of numbers -> what their format writes beside them, "min" or "%".
      durations: of numbers that are shown to the second -> what is shown, "0:01:30".
      merged: areas `(top, left, bottom, right)`; of ods only.
      comments: cells -> what somebody remarked there; of xlsx only.
    """

    odd: dict[tuple[int, int], str] = field(default_factory=dict)
    words: dict[tuple[int, int], str] = field(default_factory=dict)
    durations: dict[tuple[int, int], str] = field(default_factory=dict)
    merged: list[tuple[int, int, int, int]] = field(default_factory=list)
    comments: dict[tuple[int, int], str] = field(default_factory=dict)
    hidden_rows: frozenset[int] = frozenset()
    hidden_columns: frozenset[int] = frozenset()


def look(content: bytes) -> tuple[dict[str, Sight], bool]:
    """Sheet name -> `Sight`, and whether the format could be looked into at all."""
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        names = set(archive.namelist())
        try:
            if "content.xml" in names:
                named = _ods_styles(archive.read("styles.xml")) if "styles.xml" in names else {}
                with archive.open("content.xml") as stream:
                    return dict(_ods(stream, named)), True
            if "xl/workbook.bin" in names:
                return {}, False
            sights = {}
            formats, marks = _formats(archive), _marks(archive)
            for sheet, part in _sheet_parts(archive):
                if part in names:
                    with archive.open(part) as stream:
                        sights[sheet] = _xlsx(stream, formats, marks)
                    sights[sheet].comments = _comments(archive, part, names)
            return sights, True
        except (ElementTree.ParseError, KeyError, zipfile.BadZipFile):
            return {}, False


def _error(value: str) -> str:
    return f"holds the error {value}: mend the formula, or clear the cell if there is none"


def _tag(element: ElementTree.Element) -> str:
    return element.tag.rpartition("}")[2]


def _attribute(element: ElementTree.Element, name: str) -> str | None:
    return next(
        (value for key, value in element.attrib.items() if key.rpartition("}")[2] == name), None
    )


# --- xlsx -----------------------------------------------------------------------------------------


def _book_parts(archive: zipfile.ZipFile) -> tuple[str, list[tuple[str, str, str]]]:
    """The workbook's part, and its relations `(kind, key, part)`; the parts may have any name."""
    book = next(
        (
            target
            for kind, _, target in _relations(archive, "_rels/.rels", "")
            if kind.endswith("/officeDocument")
        ),
        "xl/workbook.xml",
    )
    folder, name = posixpath.split(book)
    return book, list(_relations(archive, f"{folder}/_rels/{name}.rels", folder))


def _sheet_parts(archive: zipfile.ZipFile) -> Iterator[tuple[str, str]]:
    """`(sheet name, part)` by way of the relations."""
    book, relations = _book_parts(archive)
    targets = {key: target for _, key, target in relations}
    for element in ElementTree.fromstring(archive.read(book)).iter():
        if _tag(element) == "sheet":
            key = next((value for k, value in element.attrib.items() if k.endswith("}id")), "")
            if key in targets:
                yield element.attrib.get("name", ""), targets[key]


def _relations(archive: zipfile.ZipFile, part: str, folder: str) -> Iterator[tuple[str, str, str]]:
    for element in ElementTree.fromstring(archive.read(part)):
        target = element.attrib.get("Target", "")
        whole = (
            target.lstrip("/")
            if target.startswith("/")
            else posixpath.normpath(posixpath.join(folder, target))
        )
        yield element.attrib.get("Type", ""), element.attrib.get("Id", ""), whole


def _comments(archive: zipfile.ZipFile, sheet: str, names: set[str]) -> dict[tuple[int, int], str]:
    """Cell -> its remark, that of a conversation included, which Excel writes a second time so."""
    folder, name = posixpath.split(sheet)
    links = f"{folder}/_rels/{name}.rels"
    found: dict[tuple[int, int], str] = {}
    for kind, _, part in _relations(archive, links, folder) if links in names else ():
        if not kind.endswith("/comments") or part not in names:
            continue
        for remark in ElementTree.fromstring(archive.read(part)).iter():
            at = re.fullmatch(r"([A-Z]{1,3})(\d{1,7})", remark.attrib.get("ref", ""))
            if _tag(remark) == "comment" and at:
                text = "".join(piece.text or "" for piece in remark.iter() if _tag(piece) == "t")
                said = " ".join(text.rpartition("Comment:\n")[2].split())
                found[int(at[2]) - 1, _column(at[1], 0)] = said
    return found


def _formats(archive: zipfile.ZipFile) -> dict[str, str]:
    """Number of a cell's style -> its number format, for those that are not the plain one."""
    part = next(
        (target for kind, _, target in _book_parts(archive)[1] if kind.endswith("/styles")), ""
    )
    if part not in archive.namelist():
        return {}
    root = ElementTree.fromstring(archive.read(part))
    codes = {str(number): code for number, code in BUILT_IN.items()}
    codes |= {
        e.attrib.get("numFmtId", ""): e.attrib.get("formatCode", "")
        for e in root.iter()
        if _tag(e) == "numFmt"
    }
    styles = next((list(element) for element in root if _tag(element) == "cellXfs"), [])
    return {
        str(place): code
        for place, style in enumerate(styles)
        if (code := codes.get(style.attrib.get("numFmtId", "")))
    }


@dataclass(frozen=True)
class Struck:
    """What a person sees of texts and their fonts, and a reader of values does not.

    Attributes:
      styles: of cells that are struck through.
      texts: number of a shared text -> what is odd about it.
    """

    styles: frozenset[str]
    texts: Mapping[str, str]

    def odd(self, cell: ElementTree.Element) -> str | None:
        """Why the cell may not say what its value says."""
        inside = {_tag(part): part for part in cell}
        value = inside["v"].text if "v" in inside else None
        if not value and "is" not in inside:
            return None
        if cell.attrib.get("s", "") in self.styles:
            return STRUCK
        if "is" in inside:
            return _odd_text(inside["is"])
        return self.texts.get(value or "") if cell.attrib.get("t") == "s" else None


def _marks(archive: zipfile.ZipFile) -> Struck:
    parts = {kind.rpartition("/")[2]: part for kind, _, part in _book_parts(archive)[1]}
    names = set(archive.namelist())
    struck: frozenset[str] = frozenset()
    texts: dict[str, str] = {}
    if (part := parts.get("styles", "")) in names and b"strike" in (read := archive.read(part)):
        struck = frozenset(_struck_styles(ElementTree.fromstring(read)))
    if (part := parts.get("sharedStrings", "")) in names:
        read = archive.read(part)
        if b"strike" in read or b"superscript" in read:
            items = (item for item in ElementTree.fromstring(read) if _tag(item) == "si")
            texts = {str(n): why for n, item in enumerate(items) if (why := _odd_text(item))}
    return Struck(struck, texts)


def _struck_styles(root: ElementTree.Element) -> Iterator[str]:
    lists = {_tag(element): list(element) for element in root}
    fonts = {str(n) for n, font in enumerate(lists.get("fonts", [])) if _is_struck(font)}
    for place, style in enumerate(lists.get("cellXfs", [])):
        if style.attrib.get("fontId", "0") in fonts:
            yield str(place)


def _is_struck(font: ElementTree.Element) -> bool:
    return any(
        _tag(part) == "strike" and part.attrib.get("val", "1") not in ("0", "false")
        for part in font
    )


def _odd_text(text: ElementTree.Element) -> str | None:
    return odd_runs(_run(part) for part in text if _tag(part) == "r")


def _run(part: ElementTree.Element) -> Run:
    fonts = [inner for inner in part if _tag(inner) == "rPr"]
    raised = any(
        _tag(inner) == "vertAlign" and inner.attrib.get("val") == "superscript"
        for font in fonts
        for inner in font
    )
    said = "".join(inner.text or "" for inner in part if _tag(inner) == "t")
    return Run(said, any(map(_is_struck, fonts)), raised)


def _xlsx(stream: IO[bytes], formats: Mapping[str, str], marks: Struck) -> Sight:
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
                if why := _odd(cell) or marks.odd(cell):
                    sight.odd[row, column] = why
                elif code := formats.get(cell.attrib.get("s", "")):
                    _dressed(cell, code, row, column, sight)
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


def _dressed(cell: ElementTree.Element, code: str, row: int, column: int, sight: Sight) -> None:
    """Notes what the number format adds to the cell's number, or hides of it."""
    text = next((part.text for part in cell if _tag(part) == "v"), None)
    if text is None or cell.attrib.get("t", "n") != "n":
        return
    try:
        value = float(text)
    except ValueError:
        return
    if (length := shown_duration(code, value)) is not None:
        sight.durations[row, column] = length
    look = dress(code, value)
    if look.hidden or look.scaled:
        how = "hides" if look.hidden else "shows in thousands"
        sight.odd[row, column] = (
            f"holds {value:.15g}, which its number format {how}: format the cell as a plain number,"
            " or clear it"
        )
    elif look.words:
        sight.words[row, column] = look.words


def _column(reference: str, otherwise: int) -> int:
    found = re.match(r"[A-Z]+", reference)
    if not found:
        return otherwise
    number = 0
    for letter in found.group():
        number = number * 26 + ord(letter) - 64
    return number - 1


# --- ods ------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Style:
    """What a style of an ods says of its text; None where it leaves that to the style above it."""

    above: str
    struck: bool | None
    raised: bool | None


Styles = dict[str, Style]
"""Family and name of a style -> what it says."""


def _ods(stream: IO[bytes], named: Styles) -> Iterator[tuple[str, Sight]]:
    styles = dict(named)
    for _, element in ElementTree.iterparse(stream, events=("end",)):
        if _tag(element) == "automatic-styles":
            styles.update(_styles_in(element))
        elif _tag(element) == "table" and _attribute(element, "name") is not None:
            yield _attribute(element, "name") or "", _ods_sheet(element, styles)
            element.clear()


def _ods_styles(content: bytes) -> Styles:
    """The styles that have names of their own, such as "Deleted"."""
    if b"line-through" not in content and b"text-position" not in content:
        return {}
    return dict(_styles_in(ElementTree.fromstring(content)))


def _styles_in(root: ElementTree.Element) -> Iterator[tuple[str, Style]]:
    for element in root.iter():
        if _tag(element) != "style":
            continue
        family, name = _attribute(element, "family") or "", _attribute(element, "name") or ""
        above = _attribute(element, "parent-style-name")
        text = next((part for part in element if _tag(part) == "text-properties"), None)
        line = raised = None
        if text is not None:
            # an older program writes the type of the line, a newer one its style
            kinds = (_attribute(text, f"text-line-through-{what}") for what in ("style", "type"))
            line = next((kind for kind in kinds if kind), None)
            raised = _attribute(text, "text-position")
        yield (
            f"{family}/{name}",
            Style(
                f"{family}/{above}" if above else "",
                None if line is None else line != "none",
                None if raised is None else RAISED.match(raised) is not None,
            ),
        )


def _says(styles: Styles, name: str, what: Literal["struck", "raised"]) -> bool:
    """The style says so, or the nearest one above it that says anything."""
    for _ in range(MOST_PARENTS):
        style = styles.get(name)
        if style is None:
            return False
        said = style.struck if what == "struck" else style.raised
        if said is not None:
            return said
        name = style.above
    return False


def _ods_sheet(table: ElementTree.Element, styles: Styles) -> Sight:
    sight = Sight()
    hidden_rows: set[int] = set()
    hidden_columns: set[int] = set()
    of_columns: dict[int, str] = {}
    row = column = 0
    for element in table.iter():
        tag = _tag(element)
        if tag == "table-column":
            repeats = int(_attribute(element, "number-columns-repeated") or 1)
            columns = range(column, column + min(repeats, MOST_REPEATS))
            if _attribute(element, "visibility") in ("collapse", "filter"):
                hidden_columns.update(columns)
            if plain := _attribute(element, "default-cell-style-name"):
                of_columns.update(dict.fromkeys(columns, plain))
            column += repeats
        elif tag == "table-row":
            repeats = int(_attribute(element, "number-rows-repeated") or 1)
            if _attribute(element, "visibility") in ("collapse", "filter"):
                hidden_rows.update(range(row, row + min(repeats, MOST_REPEATS)))
            rows = range(row, row + min(repeats, MOST_REPEATS))
            for place, why in (*_ods_struck(element, of_columns, styles), *_ods_row(element)):
                sight.odd.update({(r, place): why for r in rows})
            for place, words in _ods_words(element):
                sight.words.update({(r, place): words for r in rows})
            sight.merged.extend(_ods_merged(element, row))
            row += repeats
    sight.hidden_rows, sight.hidden_columns = frozenset(hidden_rows), frozenset(hidden_columns)
    return sight


def _ods_struck(
    row: ElementTree.Element, of_columns: Mapping[int, str], styles: Styles
) -> Iterator[tuple[int, str]]:
    """Cells that hold something and are struck through, whole or in part. A cell without a style
    has that of its row, or of its column.
    """
    of_row = _attribute(row, "default-cell-style-name")
    for column, repeats, cell in _ods_cells(row):
        texts = [part for part in cell if _tag(part) == "p"]
        if not any("".join(text.itertext()).strip() for text in texts):
            continue
        style = _attribute(cell, "style-name") or of_row or of_columns.get(column, "")
        if _says(styles, f"table-cell/{style}", "struck"):
            why: str | None = STRUCK
        else:
            why = odd_runs(run for text in texts for run in _ods_runs(text, styles))
        if why:
            yield from ((column + i, why) for i in range(min(repeats, MOST_REPEATS)))


def _ods_runs(text: ElementTree.Element, styles: Styles) -> Iterator[Run]:
    """The parts of a paragraph, each in its font."""
    yield Run(text.text or "")
    for part in text:
        name = f"text/{_attribute(part, 'style-name') or ''}"
        struck, raised = _says(styles, name, "struck"), _says(styles, name, "raised")
        yield Run("".join(part.itertext()), struck, raised)
        yield Run(part.tail or "")


def _ods_cells(row: ElementTree.Element) -> Iterator[tuple[int, int, ElementTree.Element]]:
    """`(column, repeats, cell)` of a row."""
    column = 0
    for cell in row:
        if _tag(cell) in ("table-cell", "covered-table-cell"):
            repeats = int(_attribute(cell, "number-columns-repeated") or 1)
            yield column, repeats, cell
            column += repeats


def _ods_words(row: ElementTree.Element) -> Iterator[tuple[int, str]]:
    """What stands around the number in the text that the cell shows."""
    for column, repeats, cell in _ods_cells(row):
        if _attribute(cell, "value-type") in ("float", "percentage", "currency"):
            text = "".join("".join(part.itertext()) for part in cell if _tag(part) == "p")
            before, _, behind = re.sub(
                r"[-+−]?\d+(?:[.,'’\s]\d{3})*(?:[.,]\d+)?(?:E[+-]?\d+)?", "\0", text, count=1
            ).partition("\0")
            words = " ".join(f"{before} {behind}".split()).strip("()[]+-–−. ")
            if words and not re.fullmatch(r"[\d/ ]+", words):
                yield from ((column + i, words) for i in range(min(repeats, MOST_REPEATS)))


def _ods_merged(row: ElementTree.Element, number: int) -> Iterator[tuple[int, int, int, int]]:
    for column, _, cell in _ods_cells(row):
        down, across = (
            int(_attribute(cell, f"number-{what}-spanned") or 1) for what in ("rows", "columns")
        )
        if (down, across) != (1, 1):
            yield number, column, number + down - 1, column + across - 1


def _ods_row(row: ElementTree.Element) -> Iterator[tuple[int, str]]:
    for column, repeats, cell in _ods_cells(row):
        text = "".join(cell.itertext()).strip()
        formula = _attribute(cell, "formula") is not None
        if formula and re.fullmatch(
            r"#(REF|N/A|NAME\?|VALUE|DIV/0|NULL|NUM)!?|Err:\d+|#[A-ZÄÖÜ/]+[!?]", text
        ):
            yield from ((column + i, _error(text)) for i in range(min(repeats, MOST_REPEATS)))
        elif (
            formula
            and not text
            and _attribute(cell, "value") is None
            and _attribute(cell, "value-type") is None
        ):
            yield from ((column + i, NO_RESULT) for i in range(min(repeats, MOST_REPEATS)))


# --- indents --------------------------------------------------------------------------------------


def indented(content: bytes) -> dict[str, dict[tuple[int, int], int]]:
    """Sheet name -> `(row, column)` -> how far a cell of an xlsx is indented by its format; only
    cells that are.
    """
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
    cells = next(
        (list(element) for element in ElementTree.fromstring(styles) if _tag(element) == "cellXfs"),
        [],
    )
    indents = {
        str(place): part.attrib.get("indent", "0")
        for place, style in enumerate(cells)
        for part in style
        if _tag(part) == "alignment"
    }
    return {
        place: int(indent)
        for place, indent in indents.items()
        if indent.isdecimal() and indent != "0"
    }


def _indented_cells(
    stream: IO[bytes], styles: dict[str, int]
) -> Iterator[tuple[tuple[int, int], int]]:
    for _, element in ElementTree.iterparse(stream):
        if _tag(element) == "c" and (indent := styles.get(element.attrib.get("s", ""))):
            reference = re.fullmatch(r"([A-Z]{1,3})(\d{1,7})", element.attrib.get("r", ""))
            if reference:
                yield (int(reference[2]) - 1, _column(reference[1], 0)), indent
        elif _tag(element) == "row":
            element.clear()
