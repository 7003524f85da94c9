"""How our workbooks look: titles, tables, texts across a sheet, pages; and the frame in which every
workbook carries its cell.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from math import ceil
from typing import TYPE_CHECKING, Any

from tandem.cell.model import Cell, plain
from tandem.draw.imprint import imprint
from tandem.files.spreadsheet.template import to_workbook, workbook_bytes
from tandem.plan.cycle.result import CycleResult
from tandem.plan.result import Result
from tandem.report.language import Words

if TYPE_CHECKING:
    from openpyxl import Workbook
    from openpyxl.worksheet.worksheet import Worksheet

FONT = "Calibri"
HEAD, RULE = "1F4E5F", "C8CCD0"


def book_of(cell: Cell, language: str) -> tuple[Workbook, int]:
    """A workbook that holds the cell in the form that `tandem import` reads, and how many sheets
    that takes.
    """
    import openpyxl

    book = openpyxl.load_workbook(
        io.BytesIO(to_workbook(cell, lang="de" if language == "de" else "en"))
    )
    return book, len(book.sheetnames)


def finished(book: Workbook, cell_sheets: int) -> bytes:
    """The workbook as bytes, the sheets of the cell behind all others, each ready to be printed."""
    book._sheets = [*book._sheets[cell_sheets:], *book._sheets[:cell_sheets]]
    book.active = 0
    for sheet in book:
        fit_to_page(sheet)
        sheet.sheet_view.tabSelected = sheet is book.active
    return workbook_bytes(book)


def name_plan(book: Workbook, result: Result | CycleResult, t: Words, stale: bool) -> None:
    """Names the plan under the title of the newest sheet, and on each printed page."""
    from openpyxl.styles import Font

    sheet = book.worksheets[-1]
    put(sheet, 2, 1, imprint(result, t, stale=stale))
    sheet.cell(2, 1).font = Font(name=FONT, size=9, italic=True)
    name_on_paper(book, result, t, stale)


def name_on_paper(book: Workbook, result: Result | CycleResult, t: Words, stale: bool) -> None:
    """Names the plan on each printed page of the newest sheet."""
    sheet, says = book.worksheets[-1], imprint(result, t, stale=stale)
    sheet.oddFooter.right.text = says.replace("&", "&&")


def write_made(
    book: Workbook, sentences: Sequence[str], entries: Sequence[tuple[str, str]], t: Words
) -> None:
    """The sheet of what was assumed, and of how it was made as (what, value)."""
    from openpyxl.styles import Alignment

    sheet = book.create_sheet(t("sheet.made"))
    sheet.column_dimensions["A"].width, sheet.column_dimensions["B"].width = 24, 110
    put(sheet, 1, 1, t("assume.title"), bold=True)
    row = 2
    for sentence in [*sentences, t("safety")]:
        put(sheet, row, 2, sentence)
        sheet.cell(row, 2).alignment = Alignment(wrap_text=True, vertical="top")
        sheet.row_dimensions[row].height = 15 * _lines(sentence, 110)
        row += 1
    put(sheet, row + 1, 1, t("made.title"), bold=True)
    for offset, (what, value) in enumerate(entries, 2):
        put(sheet, row + offset, 1, what)
        put(sheet, row + offset, 2, value)


def put(sheet: Worksheet, row: int, column: int, value: Any, bold: bool = False) -> None:
    """A value as itself: a text that begins with "=" stays a text."""
    from openpyxl.styles import Font

    if value is None or value == "":
        return
    cell = sheet.cell(row, column, plain(round(value, 9)) if isinstance(value, float) else value)
    if isinstance(value, str):
        cell.data_type = "s"
    if bold:
        cell.font = Font(name=FONT, bold=True)


def write_row(sheet: Worksheet, row: int, values: Sequence[Any], bold: bool = False) -> None:
    """A row of a table, each value in a frame, as high as its texts need."""
    from openpyxl.cell.rich_text import CellRichText
    from openpyxl.styles import Alignment

    for column, value in enumerate(values, 1):
        put(sheet, row, column, value, bold)
        sheet.cell(row, column).border = edge()
        sheet.cell(row, column).alignment = Alignment(
            wrap_text=isinstance(value, str | CellRichText), vertical="top"
        )
    lines = [
        _lines(str(value), sheet.column_dimensions[letter(column)].width)
        for column, value in enumerate(values, 1)
        if value
    ]
    # programs other than Excel do not find it out themselves
    sheet.row_dimensions[row].height = 15 * max(lines, default=1)


def spread(sheet: Worksheet, row: int, text: str, columns: int) -> None:
    """A text across so many columns, the row as high as it needs."""
    from openpyxl.styles import Alignment

    put(sheet, row, 1, text)
    sheet.cell(row, 1).alignment = Alignment(wrap_text=True, vertical="top")
    sheet.merge_cells(start_row=row, end_row=row, start_column=1, end_column=columns)
    width = sum(sheet.column_dimensions[letter(column)].width for column in range(1, columns + 1))
    sheet.row_dimensions[row].height = 15 * _lines(text, width)


def _lines(text: str, width: float) -> int:
    """Lines that a text takes in so many characters across."""
    return sum(max(ceil(len(line) / (width * 0.95)), 1) for line in text.splitlines()) or 1


def write_title(sheet: Worksheet, text: str) -> None:
    """The title of a sheet."""
    from openpyxl.styles import Font

    put(sheet, 1, 1, text)
    sheet.cell(1, 1).font = Font(name=FONT, bold=True, size=14)


def write_header(sheet: Worksheet, row: int, heads: Sequence[str], widths: Sequence[float]) -> None:
    """The heads of a table, and how wide its columns are, characters."""
    from openpyxl.styles import Alignment, Font, PatternFill

    for column, head in enumerate(heads, 1):
        cell = sheet.cell(row, column, head)
        cell.data_type = "s"
        cell.font, cell.fill = (
            Font(name=FONT, bold=True, color="FFFFFF"),
            PatternFill("solid", fgColor=HEAD),
        )
        cell.alignment = Alignment(wrap_text=True, vertical="center")
    for column, width in enumerate(widths, 1):
        sheet.column_dimensions[letter(column)].width = width
    sheet.row_dimensions[row].height = 32


def edge() -> Any:
    """The frame of a cell."""
    from openpyxl.styles import Border, Side

    side = Side(style="thin", color=RULE)
    return Border(left=side, right=side, top=side, bottom=side)


def letter(column: int) -> str:
    """The letters of a column, counted from 1."""
    from openpyxl.utils import get_column_letter

    letters: str = get_column_letter(column)
    return letters


def sheet_name(book: Workbook, wanted: str) -> str:
    """A name that Excel accepts and that no sheet has yet."""
    plain_name = "".join("_" if c in "[]:*?/\\'" else c for c in wanted).strip()[:28] or "_"
    names = {sheet.lower() for sheet in book.sheetnames}
    return next(
        name
        for count in range(1, 1000)
        if (name := plain_name if count == 1 else f"{plain_name}{count}").lower() not in names
    )


def fit_to_page(sheet: Worksheet) -> None:
    """A4 landscape, as wide as the page, and as long as need be unless the sheet says otherwise."""
    sheet.page_setup.orientation, sheet.page_setup.paperSize = "landscape", 9
    sheet.page_setup.fitToWidth = 1
    sheet.page_setup.fitToHeight = sheet.page_setup.fitToHeight or 0
    sheet.sheet_properties.pageSetUpPr.fitToPage = True
