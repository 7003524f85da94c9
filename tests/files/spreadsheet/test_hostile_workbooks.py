"""Workbooks that claim, hide or repeat more than a machine can hold: one message, exit 3, and this
process lives on.
"""

from __future__ import annotations

import re
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest
from openpyxl.utils import get_column_letter
from tests.files.spreadsheet import books

from tandem.errors import CellError
from tandem.files.spreadsheet import confined, separated, workbook
from tandem.files.spreadsheet.draft import import_cell
from tandem.files.spreadsheet.workbook import open_book

SHEET = "xl/worksheets/sheet1.xml"
ROWS = [["Task", "Human [s]", "Robot [s]", "Predecessors"], ["a", 10, 20, None], ["b", 5, 6, "a"]]


def edited(path: Path, edit: Callable[[str], str]) -> Path:
    """A good workbook of two tasks whose sheet was changed by hand."""
    good = books.sheet(path.with_name("good.xlsx"), ROWS)
    with zipfile.ZipFile(good) as old, zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as new:
        for entry in old.infolist():
            text = old.read(entry)
            new.writestr(entry, edit(text.decode()).encode() if entry.filename == SHEET else text)
    return path


def behind(more: str) -> Callable[[str], str]:
    """The sheet with further rows at its end."""
    return lambda text: text.replace("</sheetData>", f"{more}</sheetData>")


def refusal(path: Path) -> str:
    """What the one fault says."""
    with pytest.raises(CellError) as caught:
        open_book(path)
    (fault,) = caught.value.faults
    assert fault.place == path.name
    return fault.message


def test_a_false_dimension_changes_nothing(tmp_path: Path) -> None:
    path = edited(
        tmp_path / "book.xlsx",
        lambda text: re.sub(r'<dimension ref="[^"]*"', '<dimension ref="A1:XFD1048576"', text),
    )
    assert {name: dict(task.time) for name, task in import_cell(path)[0].tasks.items()} == {
        "a": {"Human": 10, "Robot": 20},
        "b": {"Human": 5, "Robot": 6},
    }


@pytest.mark.parametrize(
    "row",
    [
        '<row r="1048576"><c r="XFD1048576"><v>1</v></c></row>',
        '<row r="4294967295"><c r="A4294967295"><v>1</v></c></row>',
        '<row r="900000"><c r="A900000"><v>1</v></c><c r="XFC900000"><v>1</v></c></row>',
    ],
    ids=["last cell of all", "no such row", "far down and far right"],
)
def test_a_cell_that_makes_the_sheet_immense_ends_in_one_message(tmp_path: Path, row: str) -> None:
    assert "2 GB of memory" in refusal(edited(tmp_path / "book.xlsx", behind(row)))


@pytest.mark.parametrize("reference", ["ZZZZZZZ99999999999", "A0", "22B", "-1", "A" * 5000])
def test_a_reference_that_is_none_ends_in_one_message(tmp_path: Path, reference: str) -> None:
    said = refusal(
        edited(tmp_path / "book.xlsx", lambda text: text.replace('r="B2"', f'r="{reference}"'))
    )
    assert re.search(r"is damaged|cannot be read", said)


def test_an_archive_that_unpacks_to_hundreds_of_times_its_size_is_not_unpacked(
    tmp_path: Path,
) -> None:
    assert re.search(
        r"unpacks to \d+ times its size",
        refusal(edited(tmp_path / "book.xlsx", behind("<row></row>" * 6_000_000))),
    )


def test_an_archive_of_countless_parts_is_not_read(tmp_path: Path) -> None:
    path = books.sheet(tmp_path / "book.xlsx", ROWS)
    with zipfile.ZipFile(path, "a") as archive:
        for number in range(workbook.MOST_ENTRIES):
            archive.writestr(f"xl/media/{number}", b"")
    assert "parts, and Tandem opens at most 5,000" in refusal(path)


def test_a_child_that_computes_for_ever_is_ended_by_its_limit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The limit is the child's own: it is started from a copy of its file that never ends, with one
    second to compute.
    """
    source = confined.WORKER.read_text(encoding="utf-8")
    endless = re.sub(
        r"^(    _limit\(.*\)\n)", r"\1    while True:\n        pass\n", source, flags=re.MULTILINE
    )
    assert endless != source
    copy = tmp_path / "endless.py"
    copy.write_text(endless, encoding="utf-8")
    monkeypatch.setattr(confined, "WORKER", copy)
    monkeypatch.setattr(confined, "MOST_CPU_S", 1)
    assert "is damaged, or would take more than" in refusal(
        books.sheet(tmp_path / "book.xlsx", ROWS)
    )


@pytest.mark.parametrize(
    "build",
    [
        books.german_plan,
        books.dirty_numbers,
        books.one_row_an_operator,
        books.operators_beside,
        books.ms_project,
    ],
)
def test_what_crosses_from_the_child_is_what_was_read(
    tmp_path: Path, build: Callable[[Path], Path]
) -> None:
    """Numbers, dates, durations, merged areas, formats and what is hidden come through as they
    are.
    """
    path = build(tmp_path / "book.xlsx")
    assert open_book(path) == workbook.unpacked(path, path.read_bytes())


def test_a_row_of_text_wider_than_any_sheet_is_refused_at_its_row(tmp_path: Path) -> None:
    path = tmp_path / "wide.csv"
    path.write_text("Task;Human [s]\na;5\n" + ";" * separated.MOST_COLUMNS + "\n")
    assert "row 3 has 16,385 columns" in refusal(path)


def test_a_cell_of_text_longer_than_any_in_a_sheet_is_refused_at_its_place(tmp_path: Path) -> None:
    path = tmp_path / "long.csv"
    path.write_text(f"Task;Human [s];Note\na;5;{'x' * 40_000}\n")
    with pytest.raises(
        CellError, match=r"long!C2: holds 40,000 characters, and a cell has at most 32,767"
    ):
        open_book(path)


@pytest.mark.parametrize("number", ["1e999", "9" * 8000, "-1e999", "0." + "0" * 400 + "1e-999"])
def test_numbers_beyond_all_sense_are_refused_at_their_cell(tmp_path: Path, number: str) -> None:
    path = books.sheet(tmp_path / "book.xlsx", [ROWS[0], ["a", number, 20, None], ROWS[2]])
    with pytest.raises(CellError, match=r"Sheet1!B2: "):
        import_cell(path)


def test_thousands_of_predecessors_in_one_cell_are_read_once_each(tmp_path: Path) -> None:
    path = books.sheet(tmp_path / "book.xlsx", [*ROWS[:2], ["b", 5, 6, ";".join(["a"] * 16_000)]])
    assert import_cell(path)[0].tasks["b"].after == ("a",)


def test_thousands_of_ranges_of_predecessors_end_soon(tmp_path: Path) -> None:
    tasks = [[number, 5, 6, None] for number in range(1, 200)]
    path = books.sheet(
        tmp_path / "book.xlsx", [ROWS[0], *tasks, [200, 5, 6, ";".join(["1-199"] * 3000)]]
    )
    assert len(import_cell(path)[0].tasks["200"].after) == 199


HEADER = "task;human [s];robot [s]"
FLOODS = {
    "rows": "a;5;6\n" * 10_001,
    "cells": f"{HEADER}{';x' * 240}\n" + f"a;5;6{';7' * 240}\n" * 2_200,
    "text": f"{HEADER}\n" + f"a;{'9' * 32_000};6\n" * 320,
    "a field": f'{HEADER}\n"' + "a;5\n" * 40_000,
    "commas": "," * 20_000,
}


@pytest.mark.parametrize("what", FLOODS)
def test_a_flood_of_text_ends_in_one_message(tmp_path: Path, what: str) -> None:
    path = tmp_path / "tasks.csv"
    path.write_text(FLOODS[what])
    said = refusal(path)
    assert re.search(
        r"more than 10,000 rows|cells, and Tandem|characters, and Tandem|field limit|20,001"
        r" columns",
        said,
    )


def test_a_text_file_that_never_ends_is_not_read_to_its_end(tmp_path: Path) -> None:
    zeros = Path("/dev/zero")
    if not zeros.exists():
        pytest.skip("this system has no /dev/zero")
    (tmp_path / "tasks.csv").symlink_to(zeros)
    assert "is larger than 50 MB" in refusal(tmp_path / "tasks.csv")


def test_empty_columns_behind_the_table_count_for_nothing(tmp_path: Path) -> None:
    path = tmp_path / "tasks.csv"
    path.write_text(
        f"{HEADER}{';' * 16_000}\n" + "".join(f"t{i};5;6{';' * 100}\n" for i in range(200))
    )
    cell, _ = import_cell(path)
    assert {dict(task.time)["robot"] for task in cell.tasks.values()} == {6}


@pytest.mark.parametrize("header", ["after", "same operator"])
def test_a_list_of_every_other_task_in_every_row_ends_at_a_row(tmp_path: Path, header: str) -> None:
    path = tmp_path / "tasks.csv"
    others = [" ".join(f"t{k}" for k in range(i)) for i in range(700)]
    path.write_text(f"{HEADER};{header}\n" + "".join(f"t{i};5;6;{others[i]}\n" for i in range(700)))
    with pytest.raises(
        CellError, match=r"tasks!D\d+: brings the references to other tasks to more than 200,000"
    ):
        import_cell(path)


@pytest.mark.parametrize("ending", ["\n", "\r\n", "\r"])
def test_a_stated_separator_is_taken_with_every_end_of_line(tmp_path: Path, ending: str) -> None:
    path = tmp_path / "tasks.csv"
    path.write_bytes(ending.join(["sep=|", "task|human [s]|robot [s]", "a, b|5|6", ""]).encode())
    assert list(import_cell(path)[0].tasks) == ["a, b"]


def test_a_sheet_of_too_many_cells_is_passed_over_with_its_reason(tmp_path: Path) -> None:
    columns = [get_column_letter(column) for column in range(1, 305)]
    rows = (
        "".join(f'<c r="{column}{row}"><v>7</v></c>' for column in columns)
        for row in range(4, 1_702)
    )
    more = "".join(f"<row>{cells}</row>" for cells in rows)
    passed_over = open_book(edited(tmp_path / "book.xlsx", behind(more))).passed_over
    assert {sheet: str(why) for sheet, why in passed_over.items()} == {
        "Sheet1": "it has 517,104 cells, and Tandem reads at most 500,000"
    }
