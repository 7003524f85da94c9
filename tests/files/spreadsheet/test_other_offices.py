"""Units in number formats, in files that LibreOffice itself has written: read, or told that they
cannot be seen.
"""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import openpyxl
import pytest

from tandem.errors import CellError
from tandem.files.spreadsheet.draft import import_cell, read_workbook

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def profile(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A profile of LibreOffice of our own, so that a running one is left alone."""
    return tmp_path_factory.mktemp("profile")


def converted(path: Path, ending: str, profile: Path) -> Path:
    program = shutil.which("soffice") or pytest.skip(
        "no LibreOffice: apt-get install libreoffice-calc"
    )
    own = f"-env:UserInstallation=file://{profile}"
    call = [
        program,
        own,
        "--headless",
        "--convert-to",
        ending,
        "--outdir",
        str(path.parent),
        str(path),
    ]
    subprocess.run(call, check=True, capture_output=True, timeout=180)
    return path.with_suffix(f".{ending}")


def book(path: Path, header: str, form: str) -> Path:
    """Two tasks of 1.5 and 2.5, whose cells are shown in that format."""
    workbook = openpyxl.Workbook()
    sheet = workbook.active
    for row in (["Task", header, "Stress"], ["a", 1.5, 1], ["b", 2.5, 2]):
        sheet.append(row)
    for (cell,) in sheet.iter_rows(min_row=2, min_col=2, max_col=2):
        cell.number_format = form
    workbook.save(path)
    return path


def test_an_xls_file_without_a_stated_unit_is_refused_because_its_formats_cannot_be_seen(
    tmp_path: Path, profile: Path
) -> None:
    file = converted(book(tmp_path / "tasks.xlsx", "Human", '0.0 "min"'), "xls", profile)
    with pytest.raises(CellError) as refused:
        import_cell(file)
    (fault,) = refused.value.faults
    assert fault.place.endswith("!B1")
    assert "in .xls files the unit that a number format shows cannot be seen" in fault.message
    assert "Write [s], [min] or [1/100 min] into the header, or save as .xlsx" in fault.message


def test_an_xls_file_whose_header_states_the_unit_is_read_by_it(
    tmp_path: Path, profile: Path
) -> None:
    file = converted(book(tmp_path / "tasks.xlsx", "Human [min]", '0.0 "min"'), "xls", profile)
    assert [task.time["Human"] for task in import_cell(file)[0].tasks.values()] == [90, 150]


def test_an_ods_file_shows_its_formats(tmp_path: Path, profile: Path) -> None:
    file = converted(book(tmp_path / "tasks.xlsx", "Human", '0.0 "min"'), "ods", profile)
    draft = read_workbook(file)
    assert [task.time["Human"] for task in draft.cell().tasks.values()] == [90, 150]
    assert any("shows is the one that counts: B2 min, B3 min" in str(note) for note in draft.notes)


def test_an_ods_file_with_no_unit_anywhere_says_that_seconds_are_assumed(
    tmp_path: Path, profile: Path
) -> None:
    file = converted(book(tmp_path / "tasks.xlsx", "Human", "0.0"), "ods", profile)
    draft = read_workbook(file)
    assert [task.time["Human"] for task in draft.cell().tasks.values()] == [1.5, 2.5]
    assert any(
        "no unit is stated for 'Human': seconds are assumed" in str(note) for note in draft.notes
    )


@pytest.mark.parametrize("ending", ["xls", "ods"])
def test_clock_times_in_a_column_of_times_are_never_taken_for_bare_numbers(
    tmp_path: Path, profile: Path, ending: str
) -> None:
    """[h]:mm shows 1.5 days as 36:00; only hours, or a refusal, can be meant."""
    file = converted(book(tmp_path / "tasks.xlsx", "Human", "[h]:mm"), ending, profile)
    with pytest.raises(CellError):
        import_cell(file)
