"""Waits between tasks in a workbook: read as planners write them, refused where they are not."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import openpyxl
import pytest
from tests.schedule.cells import glued

from tandem.files.spreadsheet.draft import Draft, read_workbook
from tandem.files.spreadsheet.template import export_cell
from tandem.files.spreadsheet.waits import Written, waits_text, written_waits


def read(folder: Path, *waits: str, header: str = "wait after [s]", **more: Any) -> Draft:
    """A task sheet of glue, base and press, the waits those of press."""
    book = openpyxl.Workbook()
    sheet = book.active
    sheet.append(["task", "time human [s]", "time robot [s]", header])
    sheet.append(["glue", None, 5, None])
    sheet.append(["base", 8, None, None])
    sheet.append(["press", 10, None, "; ".join(waits)])
    book.save(folder / "work.xlsx")
    return read_workbook(folder / "work.xlsx", **more)


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("glue >= 40 <= 60", [Written("glue", False, "40", "60")]),
        ("glue ≥ 2,5", [Written("glue", False, "2,5", None)]),
        ("glue <= 60 s", [Written("glue", False, None, "60 s")]),
        ("a>=1; b <= 2", [Written("a", False, "1", None), Written("b", False, None, "2")]),
        ("glue (Beginn) >= 5", [Written("glue", True, "5", None)]),
        ("base (start)", [Written("base", True, None, None)]),
        ('"a >= 3; b" >= 4', [Written('"a >= 3; b"', False, "4", None)]),
    ],
)  # fmt: skip
def test_a_wait_is_taken_apart(text: str, found: list[Written]) -> None:
    assert written_waits(text) == found


def test_waits_are_read_in_the_unit_of_their_column(tmp_path: Path) -> None:
    draft = read(
        tmp_path, "glue >= 0,5 <= 1,25", "base (Beginn) >= 1", header="Wartezeit nach [min]"
    )
    assert draft.faults == ()
    assert draft.document["tasks"]["press"]["wait"] == [
        {"after": "glue", "at_least": 30.0, "at_most": 75.0},
        {"after": "base", "between": "start-start", "at_least": 60.0},
    ]
    assert not any("may begin at once" in str(note) for note in draft.notes)


@pytest.mark.parametrize(
    ("wait", "said"),
    [
        ("glue", "holds 'glue', which says of no task how long to wait after it: write"),
        ("40", "holds '40', which says of no task"),
        ("gluee >= 4", "holds 'gluee', which is no task. Did you mean 'glue'?"),
        ("glue >= 4 >= 5", "states >= twice"),
        ("glue, base >= 4", "holds 'glue, base', which is not one task"),
        ("glue >= 60 <= 40", "at least 60 s and at most 40 s"),
        ("press >= 4", "task 'press' waits for itself"),
    ],
)
def test_what_is_no_wait_is_refused_at_its_cell(tmp_path: Path, wait: str, said: str) -> None:
    [fault] = read(tmp_path, wait).faults
    assert fault.place == "Sheet!D4"
    assert said in fault.message


def test_another_header_can_be_mapped(tmp_path: Path) -> None:
    draft = read(tmp_path, "glue >= 4", header="Curing", columns={"Curing": "wait after"})
    assert draft.document["tasks"]["press"]["wait"] == [{"after": "glue", "at_least": 4.0}]


@pytest.mark.parametrize(
    ("lang", "header"), [("en", "wait after [s]"), ("de", "Wartezeit nach [s]")]
)
def test_a_cell_with_waits_goes_through_a_workbook_and_back(
    tmp_path: Path, lang: Any, header: str
) -> None:
    cell = glued(name="Glue")
    assert export_cell(cell, tmp_path / "glue.xlsx", lang=lang) == ()
    draft = read_workbook(tmp_path / "glue.xlsx")
    assert draft.cell() == cell
    assert header in [column.header for column in draft.columns]
    assert waits_text(cell.tasks["press"].wait) == "glue >= 40 <= 60"
    assert waits_text(cell.tasks["cool"].wait) == "press (start) >= 4 <= 9"
