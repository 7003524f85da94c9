"""Workbooks as planners really keep them, built here so that each one's ugliness can be read. Every
builder's docstring is its story.
"""

from __future__ import annotations

import datetime
import itertools
import struct
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

import openpyxl

from tandem.cell.model import Cell
from tandem.files.spreadsheet.form import EXAMPLE

THESIS = Cell.model_validate(EXAMPLE)

PLAIN_HEADER = ["Task", "Time robot [s]", "Time human [s]", "Stress", "Predecessors"]
PLAIN_ROWS: list[list[Any]] = [
    [1, 9, 10, 10, None],
    [2, 7, 8, 11, None],
    [3, 0, 10, 2, None],
    [4, 2, None, None, "1; 2"],
    [5, 4, 2, 4, 3],
    [6, 10, 3, 1, "1; 2; 4"],
    [7, 2, 4, 5, "1; 2; 3; 4; 5; 6"],
]


def same_work(cell: Cell, other: Cell = THESIS) -> bool:
    """The two cells differ at most in their names."""
    return cell.replace(name="") == other.replace(name="")


def sheet(
    path: Path, rows: Sequence[Sequence[Any]], title: str = "Sheet1", merged: Sequence[str] = ()
) -> Path:
    """A workbook with one sheet, written from A1."""
    book = openpyxl.Workbook()
    fill(book.active, rows, title, merged)
    book.save(path)
    return path


def fill(target: Any, rows: Sequence[Sequence[Any]], title: str, merged: Sequence[str] = ()) -> Any:
    target.title = title
    for row, values in enumerate(rows, 1):
        for column, value in enumerate(values, 1):
            if value is not None:
                target.cell(row, column, value)
    for area in merged:
        target.merge_cells(area)
    return target


def german_plan(path: Path) -> Path:
    """The planner's own sheet: a merged title, a date, a header of two lines with "Zeit [min]"
    merged over the operators, decimal commas typed as text, a blank row between the assemblies, a
    heading, a total, and a remark below.
    """
    rows = [
        ["Montageplan Baugruppe 4711"],
        ["Stand:", datetime.date(2024, 3, 12), None, None, "Bearbeiter: Kr."],
        [],
        [
            "Nr.",
            "Bezeichnung",
            "Zeit [1/100 min]",
            None,
            "Belastung\n(EAWS-Punkte)",
            "Vorgänger",
            "Bemerkung",
            None,
        ],
        [None, None, "Roboter", "Mensch", None, None, None, None],
        ["Vormontage"],
        [1, "Deckel einlegen", 15, "16,67", 10, None, "Teil ölig"],
        [2, "Rad fügen", "11,67", 13.335, 11, None],
        [],
        ["Hauptmontage"],
        [3, "Kabel stecken", "-", 16.67, "2", None],
        [4, "Schraube", 3.34, "k.A.", None, "1; 2"],
        [5, "Prüfen", 6.67, 3.34, 4, 3],
        ["Summe", None, "=SUM(C7:C13)", "=SUM(D7:D13)", 27],
        [],
        ["* Zeiten mit der Stoppuhr aufgenommen"],
    ]
    return sheet(
        path,
        rows,
        "Montage",
        ["A1:H1", "C4:D4", "A4:A5", "B4:B5", "E4:E5", "F4:F5", "A6:H6", "A10:H10"],
    )


def one_row_an_operator(path: Path) -> Path:
    """A long list: one row for each operator who can do the task, the task merged or left blank
    below its first row, both together as "Anna + UR5", and the stress beside the human's row only.
    """
    rows = [
        ["Work element", "Description", "Operator", "Duration", "EAWS", "After"],
        ["A10", "cover", "Anna", 10, 10, None],
        [None, None, "UR5", 9, None, None],
        ["A20", "wheel", "UR5", 7, 0, "A10"],
        [None, None, "Anna", 8, 11, None],
        [None, None, "Anna + UR5", "4,5", 6, None],
        ["A30", "cable", "Anna / UR5", 10, 2, "A10, A20"],
    ]
    return sheet(path, rows, "Elements", ["A2:A3", "B2:B3"])


def ms_project(path: Path) -> Path:
    """Pasted from MS Project: durations with their unit in the cell, "2FS" and ranges as
    predecessors, resources as the operator.
    """
    rows = [
        ["ID", "Task Name", "Duration", "Start", "Finish", "Predecessors", "Resource Names"],
        [
            1,
            "Fetch",
            "12 s",
            datetime.datetime(2024, 3, 12, 8),
            datetime.datetime(2024, 3, 12, 8),
            None,
            "Robot",
        ],
        [2, "Place", "0,5 min", None, None, "1FS", "Worker"],
        [3, "Screw", "1.5 mins", None, None, "1EA;2", "Worker"],
        [4, "Check", "20 sec", None, None, "1-3", "Robot"],
    ]
    return sheet(path, rows, "Project")


def dirty_numbers(path: Path) -> Path:
    """Copied out of a web page: no-break spaces, units behind the numbers, thousands, dashes for
    "cannot", formula noise.
    """
    rows = [
        ["Task", "t\u00a0human\u00a0[s]", "t robot (s)", "predecessors"],
        ["a\u00a0", "\u00a010,5\u00a0s", "1.234,5", "–"],
        ["b", "2 min", 0.1 + 0.2, "a"],
        ["c", "n/a", 3, "a,b"],
        ["d", "1 200,5", "−", "a b c"],
        ["e", 2, "0", "a–z" if False else "none"],
    ]
    return sheet(path, rows)


def operators_beside(path: Path) -> Path:
    """Several sheets: operators with kinds, limits and breaks in minutes, tools with changeovers, a
    cost sheet, a hidden old version, a hidden row and a hidden column in the tasks.
    """
    book = openpyxl.Workbook()
    tasks = fill(
        book.active,
        [
            [
                "Step",
                "Anna [s]",
                "Ben [s]",
                "Cell 7 [s]",
                "Stress Anna",
                "Stress Ben",
                "Tool",
                "Zone",
                "Latest end [min]",
            ],
            ["p1", 10, 12, 9, 3, 4, "driver", "table", None],
            ["p2", 8, None, 7, 1, None, "gripper", "table", 1.5],
            ["p3", None, 5, None, None, 2, None, None, None],
        ],
        "Steps",
    )
    tasks.row_dimensions[3].hidden = True
    tasks.column_dimensions["H"].hidden = True
    people = [
        ["Operator", "Kind", "Stress limit", "Breaks [min]"],
        ["Anna", "human", 20, "5-6; 10–11,5"],
        ["Ben", "Person"],
        ["Cell 7", "Cobot"],
    ]
    fill(book.create_sheet(), people, "Operators")
    fill(
        book.create_sheet(),
        [["Tool", "Capacity", "Changeover Anna [s]"], ["driver", 2, 4]],
        "Tools",
    )
    fill(book.create_sheet(), [["Zone", "Places"], ["table", 2]], "Zones")
    fill(book.create_sheet(), [["EUR", 12.5]], "Costs")
    old = fill(book.create_sheet(), [["Step", "Anna [s]"], ["p1", 99]], "Steps old")
    old.sheet_state = "hidden"
    book.save(path)
    return path


def broken_cells(path: Path) -> Path:
    """A formula that no program has computed, an error, a clock time, a date that Excel made of
    "1-2", a number that it made of "1,2", a negative time, a word, and a thousand that may be a
    decimal.
    """
    book = openpyxl.Workbook()
    rows = [
        ["Task", "Time human [s]", "Time robot [s]", "Predecessors"],
        [1, 10, 9, None],
        [2, "=B2*2", 7, None],
        [3, datetime.time(12, 30), 4, datetime.date(2024, 2, 1)],
        [4, -3, "fast", 1.2],
        [5, "1.234", None, "1; 22"],
        [6, 3, 3, 5],
    ]
    target = fill(book.active, rows, "Zeiten")
    target["C7"] = "#REF!"
    target["C7"].data_type = "e"
    book.save(path)
    return path


def circle_by_rows(path: Path) -> Path:
    """Predecessors are numbers of sheet rows, and three tasks wait for each other."""
    rows = [
        ["Description", "Human [s]", "Robot [s]", "Predecessors (row)"],
        ["cover", 3, 4, 4],
        ["wheel", 3, 4, 2],
        ["cable", 3, 4, 3],
        ["check", 3, 4, "2; 3"],
    ]
    return sheet(path, rows, "Line 3")


def two_variants(path: Path) -> Path:
    """Two versions side by side in one workbook; both look like tasks."""
    book = openpyxl.Workbook()
    fill(book.active, [PLAIN_HEADER, *PLAIN_ROWS], "today")
    fill(
        book.create_sheet(),
        [PLAIN_HEADER, *[[row[0], 5, 5, 0, row[4]] for row in PLAIN_ROWS]],
        "with robot 2",
    )
    book.save(path)
    return path


def chart_only(path: Path) -> Path:
    """Somebody sent the picture instead of the numbers."""
    book = openpyxl.Workbook()
    book.create_chartsheet("Diagramm")
    book.remove(book.active)
    book.save(path)
    return path


def formatted_to_the_end(path: Path) -> Path:
    """The whole column was formatted down to the last row of Excel, so that the sheet claims a
    million rows.
    """
    book = openpyxl.Workbook()
    target = fill(book.active, [PLAIN_HEADER, *PLAIN_ROWS], "Tasks")
    target.cell(1_048_576, 2).number_format = "0.00"
    book.save(path)
    return path


def successors(path: Path) -> Path:
    """Taken from a line-balancing tool: successors instead of predecessors, a row of units,
    repeated headers at the page break.
    """
    rows = [
        ["No", "Robot", "Human", "Score", "Successors"],
        [None, "cmin", "TMU", None, None],
        [1, 15, 277.7777, 10, "4 6 7"],
        [2, 11.666666667, 222.2222, 11, "4,6,7"],
        ["No", "Robot", "Human", "Score", "Successors"],
        [3, 0, 277.7777, 2, "5;7"],
        [4, 3.333333333, None, None, "6/7"],
        [5, 6.666666667, 55.5555, 4, 7],
        [6, 16.666666667, 83.3333, 1, 7],
        [7, 3.333333333, 111.1111, 5, None],
        [None, 56.666666667, 1027.7775, 33, None],
    ]
    return sheet(path, rows)


def windows_csv(path: Path) -> Path:
    """Saved by a German Excel: Windows-1252, semicolons, decimal commas, the list of predecessors
    in quotes.
    """
    text = (
        "Vorgänge der Station 3;;;;\r\n"
        ";;;;\r\n"
        "Vorgang;Zeit Roboter [s];Zeit Mensch [s];Belastung;Vorgänger\r\n"
    )
    for row in PLAIN_ROWS:
        time = "" if row[1] is None else f"{row[1]},0"
        after = row[4] if row[4] is not None else ""
        second, third = ("" if value is None else value for value in row[2:4])
        text += f'{row[0]};{time};{second};{third};"{after}"\r\n'
    path.write_bytes(text.encode("cp1252"))
    return path


def english_csv(path: Path) -> Path:
    """UTF-8 with a mark at the beginning, commas, lists in quotes."""
    lines = ["task,robot time [s],human time [s],ergonomics,predecessors"]
    lines += [
        ",".join("" if v is None else f'"{v}"' if isinstance(v, str) else str(v) for v in row)
        for row in PLAIN_ROWS
    ]
    path.write_bytes(b"\xef\xbb\xbf" + "\n".join(lines).encode())
    return path


def unicode_text(path: Path) -> Path:
    """Excel's "Unicode text": UTF-16 with tabs."""
    rows = [PLAIN_HEADER, *PLAIN_ROWS]
    path.write_bytes(
        "\r\n".join("\t".join("" if v is None else str(v) for v in row) for row in rows).encode(
            "utf-16"
        )
    )
    return path


def ods(
    path: Path,
    rows: Sequence[Sequence[Any]],
    broken: bool = False,
    merged: Sequence[tuple[int, int, int, int]] = (),
) -> Path:
    """As LibreOffice writes it: empty cells as repeats, and with `broken` a formula without result
    in B2 and an error in B3.

    Args:
      rows: values; a pair is a number and how it is shown, `(1.5, "1,50 min")`.
      merged: areas `(top, left, bottom, right)`, counted from 0.
    """

    def cell(value: Any) -> str:
        if isinstance(value, tuple):
            number, text = value
            return (
                '<table:table-cell office:value-type="float"'
                f' office:value="{number}"><text:p>{escape(text)}</text:p></table:table-cell>'
            )
        if value is None:
            return '<table:table-cell table:number-columns-repeated="1"/>'
        if isinstance(value, int | float):
            return (
                '<table:table-cell office:value-type="float"'
                f' office:value="{value}"><text:p>{value}</text:p></table:table-cell>'
            )
        return (
            "<table:table-cell"
            f' office:value-type="string"><text:p>{escape(value)}</text:p></table:table-cell>'
        )

    lines = [[cell(value) for value in row] for row in rows]
    for top, left, bottom, right in merged:
        spans = (
            f'table:number-rows-spanned="{bottom - top + 1}"'
            f' table:number-columns-spanned="{right - left + 1}"'
        )
        for row, column in itertools.product(range(top, bottom + 1), range(left, right + 1)):
            first = lines[top][left].replace("<table:table-cell", f"<table:table-cell {spans}", 1)
            lines[row][column] = (
                first if (row, column) == (top, left) else "<table:covered-table-cell/>"
            )
    if broken:
        lines[1][1] = '<table:table-cell table:formula="of:=[.A1]*2"/>'
        error = 'office:value-type="string" office:string-value=""><text:p>#REF!</text:p>'
        lines[2][1] = f'<table:table-cell table:formula="of:=[.#REF!]" {error}</table:table-cell>'
    body = "".join(f"<table:table-row>{''.join(line)}</table:table-row>" for line in lines)
    spaces = " ".join(
        f'xmlns:{name}="urn:oasis:names:tc:opendocument:xmlns:{name}:1.0"'
        for name in ("office", "table", "text")
    )
    content = (
        f'<?xml version="1.0" encoding="UTF-8"?><office:document-content {spaces}'
        ' office:version="1.2">'
        f'<office:body><office:spreadsheet><table:table table:name="Tabelle1">{body}'
        '<table:table-row table:number-rows-repeated="1048000"><table:table-cell'
        ' table:number-columns-repeated="1024"/></table:table-row>'
        "</table:table></office:spreadsheet></office:body></office:document-content>"
    )
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("mimetype", "application/vnd.oasis.opendocument.spreadsheet")
        archive.writestr("content.xml", content)
        archive.writestr(
            "META-INF/manifest.xml",
            '<?xml version="1.0"?>'
            "<manifest:manifest"
            ' xmlns:manifest="urn:oasis:names:tc:opendocument:xmlns:manifest:1.0">'
            '<manifest:file-entry manifest:full-path="/"'
            ' manifest:media-type="application/vnd.oasis.opendocument.spreadsheet"/>'
            "</manifest:manifest>",
        )
    return path


def password_protected(path: Path) -> Path:
    """What Excel writes with a password: an OLE container with the two streams of an encrypted
    package (here empty).
    """
    free, end, chain = 0xFFFFFFFF, 0xFFFFFFFE, 0xFFFFFFFD
    header = (
        bytes.fromhex("d0cf11e0a1b11ae1")
        + bytes(16)
        + struct.pack("<HHHHH6xIIIIIIIII", 0x3E, 3, 0xFFFE, 9, 6, 0, 1, 1, 0, 4096, end, 0, end, 0)
    )
    header += struct.pack("<I", 0) + struct.pack("<I", free) * 108
    table = struct.pack("<II", chain, end) + struct.pack("<I", free) * 126

    def entry(name: str, kind: int, child: int, right: int) -> bytes:
        text = name.encode("utf-16-le") + b"\0\0"
        return text.ljust(64, b"\0") + struct.pack(
            "<HBBIII36xIQ", len(text) if name else 0, kind, 1, free, right, child, end, 0
        )

    directory = entry("Root Entry", 5, 1, free) + entry("EncryptionInfo", 2, free, 2)
    directory += entry("EncryptedPackage", 2, free, free) + entry("", 0, free, free)
    path.write_bytes(header + table + directory)
    return path
