"""Template, fill, import: the same cell; and export to the template's form says what it cannot
keep.
"""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import openpyxl
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from tests.files.spreadsheet import books
from tests.strategies import cells

from tandem.cell.model import Cell
from tandem.errors import UsageError
from tandem.files.spreadsheet import import_cell
from tandem.files.spreadsheet.draft import read_book
from tandem.files.spreadsheet.template import export_cell, lost, to_workbook, write_template
from tandem.files.spreadsheet.workbook import book_of


@pytest.mark.parametrize("lang", ["en", "de"])
def test_the_template_holds_the_thesis_cell(lang: str, tmp_path: Path) -> None:
    write_template(tmp_path / "t.xlsx", lang=lang)  # type: ignore[arg-type]
    cell, _ = import_cell(tmp_path / "t.xlsx")
    assert cell == books.THESIS
    assert cell.digest == books.THESIS.digest


@pytest.mark.parametrize("lang", ["en", "de"])
def test_template_filled_by_hand(lang: str, tmp_path: Path) -> None:
    write_template(tmp_path / "t.xlsx", lang=lang)  # type: ignore[arg-type]
    book = openpyxl.load_workbook(tmp_path / "t.xlsx")
    tasks = book.worksheets[0]
    headers = {tasks.cell(1, column).value: column for column in range(1, tasks.max_column + 1)}
    time_of_robot = next(column for header, column in headers.items() if "robot" in header)
    tasks.cell(9, 1, "extra")
    tasks.cell(9, time_of_robot, 2.5)
    tasks.cell(9, headers["predecessors" if lang == "en" else "Vorgänger"], "7")
    tasks.cell(2, time_of_robot).value = None
    book.save(tmp_path / "filled.xlsx")
    cell, _ = import_cell(tmp_path / "filled.xlsx")
    data = books.THESIS.to_dict()
    del data["tasks"]["1"]["time"]["robot"]
    data["tasks"]["extra"] = {"time": {"robot": 2.5}, "after": ["7"]}
    assert cell.to_dict() == data


def test_the_template_checks_what_is_typed(tmp_path: Path) -> None:
    write_template(tmp_path / "t.xlsx")
    book = openpyxl.load_workbook(tmp_path / "t.xlsx")
    kinds = {rule.type for sheet in book for rule in sheet.data_validations.dataValidation}
    assert kinds == {"decimal", "custom", "list"}
    assert [sheet.title for sheet in book] == [
        "Tasks",
        "Operators",
        "Tools",
        "Zones",
        "Places",
        "Walking",
        "Cell",
        "Help",
    ]


ODD_NAMES = (
    *(
        "Anna",
        "time lord",
        "b+c",
        "UR-5",
        "stress",
        "Werker 1",
        "Bens Hand",
        "and",
        "with",
        "Team",
        "beide",
        "Zeit [s]",
        "human / robot",
        "1",
        "-",
    ),
    *(
        "Maschinenzeit",
        "Vorgänger",
        "x",
        "no",
        "robot",
        "REBA",
        "100 %",
        "Summe",
        "together",
        "s",
        "alle",
        "A & B",
        "time per piece",
        "Σ",
    ),
)
ODD_TASKS = (
    *(
        "=A1",
        "010",
        "10",
        "1.1",
        "1",
        "1.2",
        "a; b",
        "1-3",
        "2FS",
        "Summe",
        "total",
        "x",
        "-",
        "3 + 4",
        "Task",
        "Vorgang 2",
        "Ü",
        "none",
        "TRUE",
    ),
    *("1e3", "Milestone 1", "von", "Predecessors", "Fügen A/B", "2.1.1", "2"),
)


@st.composite
def dressed(draw: st.DrawFn) -> Cell:
    """A random cell with every feature whose operators and tasks bear names that look like
    something else, and with labels and parts.
    """
    data = draw(cells(max_tasks=6)).to_dict()
    people = (
        dict(zip(data["operators"], draw(st.permutations(ODD_NAMES)), strict=False))
        if draw(st.booleans())
        else {}
    )
    steps = (
        dict(zip(data["tasks"], draw(st.permutations(ODD_TASKS)), strict=False))
        if draw(st.booleans())
        else {}
    )
    return Cell.model_validate(
        _renamed(
            data,
            people,
            steps,
            lambda: draw(st.sampled_from((None, None, "cover", "=1+1", "12", "Summe"))),
        )
    )


def _renamed(
    data: dict[str, Any],
    people: dict[str, str],
    steps: dict[str, str],
    text: Callable[[], str | None],
) -> dict[str, Any]:
    def by_who(value: Any) -> Any:
        return (
            {people.get(who, who): amount for who, amount in value.items()}
            if isinstance(value, dict)
            else value
        )

    tasks = {}
    for name, task in data["tasks"].items():
        for what in ("time", "stress", "difficulty", "spread", "tool"):
            if what in task:
                task[what] = by_who(task[what])
        for joint in task.get("together", ()):
            joint["operators"] = [people.get(who, who) for who in joint["operators"]]
            for what in ("stress", "tool"):
                if what in joint:
                    joint[what] = by_who(joint[what])
        task["after"] = [steps.get(first, first) for first in task.get("after", ())]
        for wait in task.get("wait", ()):
            wait["after"] = steps.get(wait["after"], wait["after"])
        tasks[steps.get(name, name)] = {**task, "label": text(), "part": text()}
    for tool in data.get("tools", {}).values():
        tool["changeover"] = by_who(tool.get("changeover", {}))
    for operator in data["operators"].values():
        if operator.get("holds"):
            operator["holds"] = [[steps.get(n, n) for n in pair] for pair in operator["holds"]]
    sets = data.get("stress_of_set")
    return {
        **data,
        "operators": by_who(data["operators"]),
        "walk": by_who(data.get("walk", {})),
        "tasks": tasks,
        "same_operator": [
            [steps.get(name, name) for name in pair] for pair in data.get("same_operator", ())
        ],
        "stress_of_set": sets
        and {
            ",".join(steps.get(name, name) for name in key.split(",")) if key else "": value
            for key, value in sets.items()
        },
    }


def spelled_out(cell: Cell) -> Any:
    """All that a cell says, however it says it: a stress of 0 and none, a table and a number that
    are alike.
    """
    data = {**cell.to_dict(), "same_operator": sorted(map(tuple, cell.same_operator))}
    for name, task in data["tasks"].items():
        task["ways"] = sorted(
            (
                sorted(mode.operators),
                mode.time,
                sorted(mode.stress.items()),
                sorted(mode.tools.items()),
            )
            for mode in cell.modes(name)
        )
        for what in ("time", "together", "stress", "tool"):
            task.pop(what, None)
        if not task.get("spread"):
            task.pop("spread", None)
    data["walk"] = {who: sorted(times.items()) for who, times in cell.walking.items() if times}
    data["speeds"] = {who: table["speed"] for who, table in cell.walk.items() if "speed" in table}
    return data


@settings(max_examples=60, deadline=None, phases=[Phase.explicit, Phase.reuse, Phase.generate])
@given(st.one_of(cells(max_tasks=6), dressed()), st.sampled_from(("en", "de")))
def test_export_and_import_give_the_same_cell(cell: Cell, lang: str) -> None:
    """Also in German, and under names that look like totals, groups, lists or joint ways."""
    content = to_workbook(cell, lang=lang)  # type: ignore[arg-type]
    back = read_book(book_of(Path("x.xlsx"), content)).cell()
    assert spelled_out(back) == spelled_out(cell)


def test_names_that_look_like_something_else_survive() -> None:
    cell = Cell.model_validate(
        {
            "name": "=1+1",
            "operators": {
                "time lord": {"kind": "human"},
                "b+c": {"kind": "robot"},
                "UR-5": {"kind": "robot"},
                "stress": {"kind": "human"},
            },
            "tasks": {
                "=A1": {"time": {"time lord": 1.25, "UR-5": 2}, "label": "=SUM(A1)"},
                "010": {"time": {"b+c": 4}, "after": ["=A1"]},
                "10": {"time": {"stress": 4}, "after": ["010"]},
                "1.5": {"time": {"UR-5": 3}, "after": ["10", "010"]},
                "a; b": {"time": {"UR-5": 3}, "after": ["1.5"]},
                "1-3": {
                    "together": [
                        {"operators": ["UR-5", "time lord"], "time": 2, "stress": {"time lord": 1}}
                    ],
                    "after": ["a; b"],
                },
            },
        }
    )
    assert lost(cell, to_workbook(cell)) == ()
    assert lost(cell, to_workbook(cell, lang="de")) == ()


def test_what_the_form_cannot_keep_is_said(tmp_path: Path) -> None:
    cell = books.THESIS.replace(
        tasks={
            "1": {"time": {"human": 1.00004}},
            "2": {"time": {"human": 1}, "label": "two \u200dblanks"},
        }
    )
    sentences = export_cell(cell, tmp_path / "x.xlsx")
    assert "tasks.2.label: 'two \\u200dblanks' becomes 'two blanks'." in sentences
    assert any(
        sentence.startswith("tasks.1.time.human: 1.00004 becomes 1") for sentence in sentences
    )


def test_unknown_language() -> None:
    with pytest.raises(UsageError, match="'fr'"):
        to_workbook(books.THESIS, lang="fr")  # type: ignore[arg-type]


def test_five_hundred_rows_take_less_than_two_seconds(tmp_path: Path) -> None:
    rows = [
        [
            i,
            f"step {i}",
            10 + i % 7,
            9.5 if i % 3 else None,
            "; ".join(map(str, range(max(1, i - 3), i))),
            i % 5,
        ]
        for i in range(1, 501)
    ]
    path = books.sheet(
        tmp_path / "big.xlsx",
        [["No", "Step", "Zeit Mensch [s]", "Zeit Roboter [s]", "Vorgänger", "EAWS"], *rows],
    )
    cell, _ = import_cell(path)
    assert len(cell.tasks) == 500
    assert cell.tasks["500"].after == ("497", "498", "499")


def test_the_bytes_are_a_workbook_for_other_programs() -> None:
    book = openpyxl.load_workbook(io.BytesIO(to_workbook(books.THESIS)))
    assert [cell.value for cell in book["Tasks"][1]] == [
        "task",
        "time robot [s]",
        "time human [s]",
        "stress",
        "predecessors",
    ]
    assert [cell.value for cell in book["Tasks"][7]] == [6, 10, 3, 1, "1; 2; 4"]
