"""Tools by operator, places and walking times in workbooks: written, read back, and read from
people's own.
"""

from __future__ import annotations

from pathlib import Path

import openpyxl
import pytest

from tandem.errors import CellError
from tandem.files.load import load
from tandem.files.spreadsheet import import_cell
from tandem.files.spreadsheet.template import export_cell

PUMP = load("examples/pump.yaml")
Rows = list[list[object]]


def workbook(folder: Path, **sheets: Rows) -> Path:
    book = openpyxl.Workbook()
    book.remove(book.active)
    for name, rows in sheets.items():
        sheet = book.create_sheet(name)
        for row in rows:
            sheet.append(row)
    book.save(folder / "own.xlsx")
    return folder / "own.xlsx"


PEOPLE: Rows = [["operator", "kind", "place"], ["Anna", "human", "bench"], ["Cobot", "robot", None]]


@pytest.mark.parametrize("lang", ["en", "de"])
def test_a_cell_comes_back_as_it_was_written(lang: str, tmp_path: Path) -> None:
    assert export_cell(PUMP, tmp_path / "cell.xlsx", lang=lang) == ()  # type: ignore[arg-type]
    back, _ = import_cell(tmp_path / "cell.xlsx")
    assert (back.tasks, back.operators, back.places) == (PUMP.tasks, PUMP.operators, PUMP.places)
    assert back.walking == PUMP.walking


@pytest.mark.parametrize(
    ("place", "tool", "walking", "ends"),
    [
        ("place", "tool {}", "Walking", ["from", "to", "time Anna [s]"]),
        ("Ort", "Werkzeug {}", "Wege", ["von", "nach", "Zeit Anna [s]"]),
        ("location", "tool for {}", "Walks", ["From", "To", "Anna [min]"]),
        ("Platz", "Werkzeug für {}", "Laufwege", ["Von", "Nach", "Zeit Anna (s)"]),
    ],
)
def test_peoples_own_words_are_read(
    place: str, tool: str, walking: str, ends: list[object], tmp_path: Path
) -> None:
    time = 0.05 if "min" in str(ends[2]) else 3
    heads = [tool.format("Anna"), tool.format("Cobot"), tool.format("Anna + Cobot")]
    tasks: Rows = [
        ["task", "time Anna [s]", "time Cobot [s]", "time Anna + Cobot [s]", place, *heads],
        ["lid", 4, 8, 3, "bench", "mallet", None, "-"],
        ["screws", 9, 6, None, "fixture", "driver", "spindle", None],
    ]
    sheets = {"Tasks": tasks, "Operators": PEOPLE, walking: [ends, ["bench", "fixture", time]]}
    cell, notes = import_cell(workbook(tmp_path, **sheets))
    assert [task.place for task in cell.tasks.values()] == ["bench", "fixture"]
    assert cell.operators["Anna"].place == "bench"
    assert cell.walking == {"Anna": {("bench", "fixture"): 3, ("fixture", "bench"): 3}}
    assert [dict(mode.tools) for mode in cell.modes("lid")] == [{"Anna": "mallet"}, {}, {}]
    assert cell.tasks["screws"].tool == {"Anna": "driver", "Cobot": "spindle"}
    assert not [note for note in notes if note.kind == "column"]


def test_a_row_for_each_operator_may_name_a_tool_of_its_own(tmp_path: Path) -> None:
    tasks: Rows = [
        ["task", "operator", "time [s]", "tool"],
        ["screws", "Anna", 9, "driver"],
        ["screws", "Cobot", 6, "spindle"],
        ["press", "Anna", 4, "ram"],
        ["press", "Cobot", 4, "ram"],
        ["wipe", "Anna", 4, "rag"],
        ["wipe", "Cobot", 4, None],
    ]
    cell, _ = import_cell(workbook(tmp_path, Tasks=tasks, Operators=PEOPLE))
    assert [task.tool for task in cell.tasks.values()] == [
        {"Anna": "driver", "Cobot": "spindle"}, "ram", {"Anna": "rag"},
    ]  # fmt: skip


def test_coordinates_and_a_speed_are_read(tmp_path: Path) -> None:
    people: Rows = [
        ["operator", "kind", "walking speed [m/s]"], ["Anna", "human", "1,5"], ["Cobot", "robot"],
    ]  # fmt: skip
    tasks: Rows = [
        ["task", "time Anna [s]", "time Cobot [s]", "place"], ["lid", 4, 8, "bench"],
        ["cap", 4, 8, "press"],
    ]  # fmt: skip
    places: Rows = [["place", "x [m]", "y [m]"], ["bench", -1, 0], ["press", 0.5, 2]]
    sheets = {"Tasks": tasks, "Operators": people, "Places": places}
    cell, _ = import_cell(workbook(tmp_path, **sheets))
    assert cell.places == {"bench": (-1, 0), "press": (0.5, 2)}
    assert cell.walking["Anna"]["bench", "press"] == 1.7


@pytest.mark.parametrize(
    ("sheets", "said"),
    [
        (
            {"Walking": [["from", "to", "time Anna [s]"], ["bench", "fixtur", 3]]},
            "Walking!C2: walk of 'Anna': 'bench-fixtur' names 'fixtur', which is no place of the"
            " cell. Did you mean 'fixture'?",
        ),
        (
            {"Walking": [["from", "to", "time Anna [s]"], ["bench", None, 3]]},
            "Walking!A2: a way leads from a place to a place: name both, or clear the row.",
        ),
        (
            {
                "Walking": [
                    ["from", "to", "time Anna [s]"],
                    ["bench", "fixture", 3],
                    ["bench", "fixture", 4],
                ]
            },
            "Walking!A3: the way from 'bench' to 'fixture' stands here a second time.",
        ),
        (
            {"Places": [["place", "x [m]", "y [m]"], ["bench", 1, None]]},
            "Places!A2: place 'bench' needs two coordinates in metres, x and y.",
        ),
        (
            {"Places": [["place", "x [m]", "y [m]"], ["bench", 1, "far"]]},
            "Places!C2: holds 'far'",
        ),
    ],
)
def test_what_is_wrong_is_said_with_its_place(
    sheets: dict[str, Rows], said: str, tmp_path: Path
) -> None:
    tasks: Rows = [
        ["task", "time Anna [s]", "place"], ["lid", 4, "bench"], ["screws", 9, "fixture"],
    ]  # fmt: skip
    with pytest.raises(CellError) as refused:
        import_cell(workbook(tmp_path, Tasks=tasks, Operators=PEOPLE[:2], **sheets))
    assert said in str(refused.value)


def test_one_tool_and_one_for_each_contradict_each_other(tmp_path: Path) -> None:
    tasks: Rows = [
        ["task", "time Anna [s]", "time Cobot [s]", "tool", "tool Anna"],
        ["lid", 4, 8, "mallet", "hammer"],
    ]
    with pytest.raises(CellError) as refused:
        import_cell(workbook(tmp_path, Tasks=tasks, Operators=PEOPLE))
    assert (
        "Tasks!E2: gives a tool of 'Anna' although task 'lid' has one for all. Keep one of the two."
        in str(refused.value)
    )
