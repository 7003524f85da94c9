"""The set-up of an operator in a workbook: a column of the operators' sheet, written, read back,
and read from people's own.
"""

from __future__ import annotations

from pathlib import Path

import openpyxl
import pytest

from tandem.errors import CellError
from tandem.files.spreadsheet import import_cell
from tandem.files.spreadsheet.template import export_cell
from tandem.files.validate import cell_of

CELL = cell_of({
    "operators": {"anna": {"kind": "human", "setup": 12.5}, "cobot": {"kind": "robot"}},
    "tasks": {"base": {"time": {"anna": 4, "cobot": 8}}, "cover": {"time": {"anna": 2},
    "after": ["base"]}},
    "tools": {"driver": {"changeover": {"anna": 3}}},
})  # fmt: skip


@pytest.mark.parametrize("lang", ["en", "de"])
def test_it_comes_back_as_it_was_written(lang: str, tmp_path: Path) -> None:
    export_cell(CELL, tmp_path / "cell.xlsx", lang=lang)  # type: ignore[arg-type]
    assert import_cell(tmp_path / "cell.xlsx")[0].operators == CELL.operators


def workbook(folder: Path, header: str, value: object) -> Path:
    book = openpyxl.Workbook()
    book.active.title = "Tasks"
    for row in (["task", "time anna [s]"], ["base", 4]):
        book.active.append(row)
    sheet = book.create_sheet("Operators")
    for row in (["operator", "kind", header], ["anna", "human", value]):
        sheet.append(row)
    book.save(folder / "own.xlsx")
    return folder / "own.xlsx"


@pytest.mark.parametrize(
    ("header", "value", "seconds"),
    [
        ("setup [s]", 30, 30),
        ("Setup", 0, 0),
        ("setup time [min]", 1.5, 90),
        ("Rüstzeit [s]", "12,5", 12.5),
        ("Rüsten", None, 0),
    ],
)
def test_peoples_own_words_for_it_are_read(
    header: str, value: object, seconds: float, tmp_path: Path
) -> None:
    cell, _ = import_cell(workbook(tmp_path, header, value))
    assert cell.operators["anna"].setup == seconds


def test_what_is_no_time_is_a_fault_with_its_place(tmp_path: Path) -> None:
    with pytest.raises(CellError, match=r"Operators!C2: .*'soon'"):
        import_cell(workbook(tmp_path, "setup [s]", "soon"))
