"""9999 for "cannot" is asked about: planned as a time, it would be the length of the schedule, or
silently leave a choice that there is not.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from tests.files.spreadsheet.books import sheet

from tandem.cell.model import Cell
from tandem.errors import CellError
from tandem.files.spreadsheet import import_cell
from tandem.files.spreadsheet.template import export_cell

TIMES = ["Vorgang", "Zeit Mensch [s]", "Zeit Roboter [s]", "Vorgänger"]


def plan(folder: Path, robot: Any, human: Any = 20) -> Path:
    rows = [TIMES, ["a", 10, 12, None], ["b", 11, robot, "a"], ["c", human, 30, "b"]]
    return sheet(folder / "plan.xlsx", rows)


def refused(path: Path, **options: Any) -> list[tuple[str, str]]:
    with pytest.raises(CellError) as caught:
        import_cell(path, **options)
    return [(fault.place.rpartition("!")[2], fault.message) for fault in caught.value.faults]


@pytest.mark.parametrize(
    "robot", [999, 9999, 99999, 1e6, 100000, 10000, 9999.99, "9999", "999,9", "1.000.000"]
)
def test_a_number_that_may_stand_for_cannot_is_asked_about(robot: Any, tmp_path: Path) -> None:
    ((place, message),) = refused(plan(tmp_path, robot))
    assert place == "C3"
    assert "no other time of the table is longer than 30 s: is it a time" in message
    assert "Write - or leave the cell empty if it cannot" in message
    assert " s', if it is a time." in message


def test_all_of_them_are_told_at_once(tmp_path: Path) -> None:
    assert [place for place, _ in refused(plan(tmp_path, 9999, 99999))] == ["B4", "C3"]


@pytest.mark.parametrize(("robot", "seconds"), [("9999 s", 9999), ("999 min", 59940)])
def test_with_its_unit_behind_it_it_is_a_time(robot: str, seconds: float, tmp_path: Path) -> None:
    cell, _ = import_cell(plan(tmp_path, robot))
    assert cell.tasks["b"].time["Roboter"] == seconds


@pytest.mark.parametrize("robot", [9000, 1000, 9989, 99, 7200, 1, "0:16:39"])
def test_long_times_that_somebody_may_have_measured_are_read(robot: Any, tmp_path: Path) -> None:
    cell, _ = import_cell(plan(tmp_path, robot))
    assert "Roboter" in cell.tasks["b"].time


def test_among_times_of_its_size_it_is_one_of_them(tmp_path: Path) -> None:
    cell, _ = import_cell(plan(tmp_path, 999, 60))
    assert cell.tasks["b"].time["Roboter"] == 999


def test_one_row_for_each_operator(tmp_path: Path) -> None:
    rows = [["Task", "Operator", "Time [TMU]"], ["a", "Human", 120], ["a", "Robot", 99999]]
    ((place, message),) = refused(sheet(tmp_path / "plan.xlsx", rows))
    assert (place, "'99999 TMU'" in message) == ("C3", True)


def test_what_is_written_into_a_workbook_is_read_back(tmp_path: Path) -> None:
    """A cell may have such a time; its sheet says that it is one."""
    cell = Cell.model_validate(
        {
            "format": 1,
            "operators": {"human": {"kind": "human"}, "robot": {"kind": "robot"}},
            "tasks": {"a": {"time": {"human": 5, "robot": 9999}}, "b": {"time": {"human": 7}}},
        }
    )
    export_cell(cell, tmp_path / "cell.xlsx")
    assert import_cell(tmp_path / "cell.xlsx")[0].tasks == cell.tasks
