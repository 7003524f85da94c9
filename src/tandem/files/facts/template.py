"""A workbook of example tasks to overwrite, so that nobody starts from an empty sheet."""

from __future__ import annotations

import io
import json
from importlib import resources
from pathlib import Path
from typing import Any, Literal

from tandem.files.atomic import store

EXAMPLES: dict[str, Any] = json.loads(
    resources.files(__package__).joinpath("template.json").read_text("utf-8")
)
"""`columns`: fact -> its heading in English and German; `rows`: 20 tasks; `words`: of German."""


def write(path: Path, language: Literal["en", "de"] = "en") -> None:
    """Writes the workbook. Raises OSError when it cannot be written; nothing is left behind."""
    store(path, workbook(language))


def workbook(language: Literal["en", "de"]) -> bytes:
    """The workbook as bytes: tasks, and a sheet that says what each column means."""
    from openpyxl import Workbook
    from openpyxl.styles import Alignment, Font, PatternFill

    place = 0 if language == "en" else 1
    book = Workbook()
    sheet = book.worksheets[0]
    sheet.title = ("Facts", "Angaben")[place]
    columns: dict[str, Any] = EXAMPLES["columns"]
    for number, (heading_en, heading_de, width) in enumerate(columns.values(), 1):
        cell = sheet.cell(1, number, (heading_en, heading_de)[place])
        cell.font, cell.fill = Font(bold=True), PatternFill("solid", fgColor="E3EEF2")
        cell.alignment = Alignment(wrap_text=True, vertical="top")
        sheet.column_dimensions[cell.column_letter].width = width
    for line, row in enumerate(EXAMPLES["rows"], 2):
        for number, name in enumerate(columns, 1):
            if name in row:
                sheet.cell(line, number, _in_language(row[name], place))
    sheet.row_dimensions[1].height = 48
    sheet.freeze_panes = "C2"
    help_sheet = book.create_sheet(("Help", "Hilfe")[place])
    help_sheet.column_dimensions["A"].width = 110
    for line, text in enumerate(EXAMPLES["help"][language], 1):
        help_sheet.cell(line, 1, text).alignment = Alignment(wrap_text=True, vertical="top")
    stream = io.BytesIO()
    book.save(stream)
    return stream.getvalue()


def _in_language(value: Any, place: int) -> Any:
    if isinstance(value, list):
        return value[place]
    if isinstance(value, bool):
        return (("no", "nein"), ("yes", "ja"))[value][place]
    return EXAMPLES["words"].get(value, value) if place and isinstance(value, str) else value
