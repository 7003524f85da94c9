"""Words in columns of names that name nothing, or several: taken as they stand, they would be
tools, places and people of their own.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from tests.files.spreadsheet.books import fill, sheet

from tandem.errors import CellError
from tandem.files.spreadsheet import import_cell


def refused(path: Path, **options: Any) -> list[tuple[str, str]]:
    with pytest.raises(CellError) as caught:
        import_cell(path, **options)
    return [(fault.place.rpartition("!")[2], fault.message) for fault in caught.value.faults]


def plan(folder: Path, what: str, *names: Any) -> Path:
    rows = [["Task", "Human [s]", "Robot [s]", what]]
    rows += [[letter, 10, 12, name] for letter, name in zip("abcdef", names, strict=False)]
    return sheet(folder / "plan.xlsx", rows)


WHATS = [("Tool", "tool"), ("Werkzeug", "tool"), ("Zone", "zone"), ("Ort", "place")]


@pytest.mark.parametrize(("header", "what"), WHATS)
@pytest.mark.parametrize("word", ["none", "keins", "Ohne", "n/a", "k.A.", "nein", "-"])
def test_a_word_for_none_is_none(header: str, what: str, word: str, tmp_path: Path) -> None:
    """Else every such task would wait for the one tool that is called so."""
    cell, _ = import_cell(plan(tmp_path, header, word, "press", word))
    assert [getattr(task, what) for task in cell.tasks.values()] == [None, "press", None]


@pytest.mark.parametrize(("header", "what"), WHATS)
@pytest.mark.parametrize("word", ["dito", '"', "〃", "s.o.", "wie oben", "same as above", "?"])
def test_a_word_for_the_one_above_is_asked_about(
    header: str, what: str, word: str, tmp_path: Path
) -> None:
    ((place, message),) = refused(plan(tmp_path, header, "press", word))
    assert (place, f"names no {what}: write the name" in message) == ("D3", True)


@pytest.mark.parametrize(
    "listed", ["Schrauber; Presse", "Presse, Lampe", "Presse/Ofen", "Ofen + Presse", "Presse und X"]
)
def test_a_list_of_tools_is_no_tool_of_its_own(listed: str, tmp_path: Path) -> None:
    """Else nobody would wait for the press."""
    ((place, message),) = refused(plan(tmp_path, "Werkzeug", "Presse", listed))
    assert place == "D3"
    assert f"holds {listed!r}, which would be one tool of its own, and 'Presse'" in message


def test_tools_that_stand_in_lists_alone(tmp_path: Path) -> None:
    faults = refused(plan(tmp_path, "Tool", "drill; press", "press + lamp"))
    assert [place for place, _ in faults] == ["D2", "D3"]


@pytest.mark.parametrize("name", ["Bit T20, 5 Nm", "Schlüssel 1/2", "Zange (klein)", "Nut & Feder"])
def test_a_name_with_such_a_mark_is_a_name(name: str, tmp_path: Path) -> None:
    cell, _ = import_cell(plan(tmp_path, "Tool", "Presse", name, name))
    assert cell.tasks["c"].tool == name


def test_a_sheet_of_tools_says_what_a_tool_is_called(tmp_path: Path) -> None:
    import openpyxl

    book = openpyxl.load_workbook(plan(tmp_path, "Tool", "none", "Presse", "Presse; Ofen"))
    fill(book.create_sheet(), [["Tool", "Count"], ["none", 1], ["Presse; Ofen", 1]], "Tools")
    book.save(tmp_path / "tools.xlsx")
    cell, _ = import_cell(tmp_path / "tools.xlsx")
    assert [task.tool for task in cell.tasks.values()] == ["none", "Presse", "Presse; Ofen"]


# --- people ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("text", ["2 Werker", "2x Werker", "Werker (2)", "Werker x 2", "3 Human"])
def test_how_many_people_is_no_name(text: str, tmp_path: Path) -> None:
    rows = [["Task", "Operator", "Time [s]"], ["a", "Werker", 5], ["b", text, 7]]
    path = sheet(tmp_path / "plan.xlsx", rows)
    ((place, message),) = refused(path)
    assert (place, "how many people the task takes" in message) == ("B3", True)
    cell, _ = import_cell(path, humans=[text])
    assert text in cell.operators


@pytest.mark.parametrize("text", ["Werker 2", "Werker2", "2. Mann Anna", "UR5", "Halle 3 Robot"])
def test_a_name_with_a_number_is_a_name(text: str, tmp_path: Path) -> None:
    rows = [["Task", "Operator", "Time [s]"], ["a", "Werker 1", 5], ["b", text, 7]]
    cell, _ = import_cell(sheet(tmp_path / "plan.xlsx", rows))
    assert list(cell.operators) == ["Werker 1", text]


# --- numbers of tasks -----------------------------------------------------------------------------


def test_a_number_beside_numbers_of_tasks_is_no_place_in_the_list(tmp_path: Path) -> None:
    """Among 10, 20, 30, a 2 is a slip for 20; and where places are meant, 10 is the tenth task."""
    rows = [["Pos", "Task", "Human [s]", "Pred"], [10, "a", 1, None], [20, "b", 1, 10]]
    path = sheet(tmp_path / "plan.xlsx", [*rows, [30, "c", 1, 2]])
    ((place, message),) = refused(path)
    assert (place, "'2', which is no task. Did you mean '20'?" in message) == ("D4", True)
    places = [[10 * n, f"t{n}", 1, n - 1 or None] for n in range(1, 13)]
    faults = refused(sheet(tmp_path / "places.xlsx", [rows[0], *places]))
    assert [place for place, _ in faults] == ["D3"]
    assert "rows 3 to 11 and 13, as here: holds '1', which is no task" in faults[0][1]


def test_places_in_the_list_are_understood_where_no_number_is_a_task(tmp_path: Path) -> None:
    rows = [["Pos", "Task", "Human [s]", "Pred"], [10, "a", 1, None], [20, "b", 1, 1]]
    cell, _ = import_cell(sheet(tmp_path / "plan.xlsx", [*rows, [30, "c", 1, "1; 2"]]))
    assert cell.tasks["30"].after == ("10", "20")
