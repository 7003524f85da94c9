"""Limits of people in a workbook: a column of the operators' sheet and the products of a shift
beside the cell's name; written, read back, and read from people's own.
"""

from __future__ import annotations

from pathlib import Path

import openpyxl
import pytest
from tests import limited

from tandem.errors import CellError
from tandem.files.spreadsheet import import_cell
from tandem.files.spreadsheet.template import export_cell

CELL = limited.cell(420.5, peak_reba=9, time_above_reba_8=20.5, dose_lifft=0.000025).replace(
    name="Limited"
)


@pytest.mark.parametrize("lang", ["en", "de"])
def test_they_come_back_as_they_were_written(lang: str, tmp_path: Path) -> None:
    assert export_cell(CELL, tmp_path / "cell.xlsx", lang=lang) == ()  # type: ignore[arg-type]
    back = import_cell(tmp_path / "cell.xlsx")[0]
    assert back.operators == CELL.operators
    assert back.cycles_per_shift == CELL.cycles_per_shift


def workbook(folder: Path, header: str, value: object, cycles: tuple[str, object]) -> Path:
    export_cell(limited.cell(None), folder / "own.xlsx")
    book = openpyxl.load_workbook(folder / "own.xlsx")
    sheet = book["Operators"]
    place = next(cell.column for cell in sheet[1] if cell.value == "limits")
    sheet.cell(1, place, header)
    sheet.cell(2, place, value)
    book["Cell"].append(cycles)
    book.save(folder / "own.xlsx")
    return folder / "own.xlsx"


@pytest.mark.parametrize(
    ("header", "value"),
    [
        ("limits", "peak:reba = 9; dose:lifft=0.02"),
        ("Grenzwerte", "peak:reba=9; dose:lifft = 0,02;"),
    ],
)
def test_people_may_write_them_as_they_like(header: str, value: str, tmp_path: Path) -> None:
    said = import_cell(workbook(tmp_path, header, value, ("Stück je Schicht", 400)))[0]
    assert dict(said.operators["anna"].limits) == {"peak:reba": 9, "dose:lifft": 0.02}
    assert said.cycles_per_shift == 400


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ("peak:reba 9", r"Operators!\w2.*'peak:reba 9'.*measure = most"),
        ("peak:reba = many", "'peak:reba = many'"),
        ("peak:reba = 9; peak:reba = 8", "each measure once"),
        ("peak:rebba = 9", r"Operators!\w2.*no task of the cell has a value on the scale 'rebba'"),
    ],
)
def test_what_is_no_limit_is_told_at_its_place(value: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(CellError, match=words):
        import_cell(workbook(tmp_path, "limits", value, ("products per shift", 400)))
