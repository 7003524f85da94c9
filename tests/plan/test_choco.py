"""A second engine, Choco, confirms what CP-SAT proves of cells of 20 to 30 tasks; and its model, in
turn, keeps the rules of the page about cell files, one by one.
"""

from __future__ import annotations

from dataclasses import replace
from random import Random
from typing import Any

import pytest

pytest.importorskip("pychoco", reason="needs pychoco: pip install tandem[choco]")

from tests.fuzz import choco as program
from tests.fuzz.choco import Asked, questions, settled
from tests.plan.choco import Question

TWO = {"operators": {"anna": {"kind": "human"}, "cobot": {"kind": "robot"}}}


def possible(cell: dict[str, Any], makespan: int, stress: int | None = None) -> bool | None:
    return Question(cell, makespan, stress).answer(nodes=1000, seconds=10)


CASES = {
    "side by side": ({}, {}, 5),
    "one after the other": ({}, {"after": ["a"]}, 9),
    "in a zone of one": ({"zone": "jig"}, {"zone": "jig"}, 9),
    "with the one tool": ({"tool": "driver"}, {"tool": "driver"}, 9),
    "released later": ({}, {"release": 3}, 8),
    "by both together": (
        {"time": {}, "together": [{"operators": ["anna", "cobot"], "time": 2}]},
        {},
        7,
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_each_rule_alone(name: str) -> None:
    """Anna takes 4 s for the first task, the robot 5 s for the second."""
    first, second, least = CASES[name]
    cell = {
        **TWO,
        "tasks": {
            "a": {"time": {"anna": 4}, "stress": 6, **first},
            "b": {"time": {"cobot": 5}, "stress": 6, **second},
        },
    }
    assert possible(cell, least) is True
    assert possible(cell, least - 1) is False


def test_room_for_two_lets_two_in() -> None:
    task = {"zone": "jig", "tool": "driver"}
    cell = {
        **TWO,
        "tasks": {"a": {"time": {"anna": 4}, **task}, "b": {"time": {"cobot": 5}, **task}},
        "zones": {"jig": {"capacity": 2}},
        "tools": {"driver": {"capacity": 2}},
    }
    assert possible(cell, 5) is True


def test_stress_counts_for_humans_and_is_limited_in_all_and_for_each() -> None:
    cell: dict[str, Any] = {
        "operators": {**TWO["operators"], "ben": {"kind": "human"}},
        "tasks": {
            "a": {"time": {"anna": 4, "ben": 4}, "stress": {"anna": 6, "ben": 2}},
            "b": {"time": {"anna": 4, "cobot": 9}, "stress": 3},
        },
    }
    assert possible(cell, 9, 2) is True
    assert possible(cell, 9, 1) is False
    assert possible(cell, 8, 4) is False
    cell["operators"]["ben"]["stress_limit"] = 1
    assert possible(cell, 9, 6) is True
    assert possible(cell, 9, 5) is False


def test_a_deadline_is_kept() -> None:
    cell: dict[str, Any] = {**TWO, "tasks": {"a": {"time": {"anna": 4}, "deadline": 3}}}
    assert possible(cell, 9) is False


def test_what_the_model_does_not_know_is_refused() -> None:
    cell: dict[str, Any] = {**TWO, "tasks": {"a": {"time": {"anna": 4}, "wait": {"after": "b"}}}}
    with pytest.raises(ValueError, match="wait"):
        possible(cell, 9)


def test_both_engines_agree_on_cells_of_20_to_30_tasks(capsys: pytest.CaptureFixture[str]) -> None:
    assert program.main(["--questions", "16", "--seed", "800001"]) == 0
    assert "0 differ. " in capsys.readouterr().out


def test_a_wrong_proof_would_be_found() -> None:
    """Were CP-SAT to say that nothing reaches the optimum, Choco would not agree."""
    asked: Asked = next(questions(Random(800001)))
    assert settled(asked) is True
    assert settled(replace(asked, right=False)) is not False
