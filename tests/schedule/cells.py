"""Small cells whose numbers a person can work out, and schedules of them written by hand."""

from __future__ import annotations

from typing import Any

from tandem.cell.model import Cell
from tandem.schedule.model import Assignment, Schedule

THESIS: dict[str, Any] = {
    "operators": {"robot": {"kind": "robot"}, "human": {"kind": "human"}},
    "tasks": {
        "1": {"time": {"robot": 9, "human": 10}, "stress": 10},
        "2": {"time": {"robot": 7, "human": 8}, "stress": 11},
        "3": {"time": {"human": 10}, "stress": 2},
        "4": {"time": {"robot": 2}, "after": ["1", "2"]},
        "5": {"time": {"robot": 4, "human": 2}, "stress": 4, "after": ["3"]},
        "6": {"time": {"robot": 10, "human": 3}, "stress": 1, "after": ["1", "2", "4"]},
        "7": {
            "time": {"robot": 2, "human": 4},
            "stress": 5,
            "after": ["1", "2", "3", "4", "5", "6"],
        },
    },
}

GEARBOX: dict[str, Any] = {
    "operators": {
        "cobot": {"kind": "robot", "tool": "gripper", "breaks": [[12, 14]]},
        "anna": {"kind": "human", "stress_limit": 8},
        "ben": {"kind": "human"},
    },
    "tools": {
        "driver": {"capacity": 1, "changeover": {"cobot": 3, "anna": 0.5}},
        "gripper": {"changeover": {"cobot": 1}},
    },
    "zones": {"jig": {"capacity": 2}},
    "tasks": {
        "housing": {"time": {"cobot": 4, "anna": 5, "ben": 5}, "stress": 2, "tool": "gripper"},
        "shaft": {"time": {"anna": 2.5}, "stress": 3, "release": 1},
        "gears": {
            "together": [
                {"operators": ["anna", "ben"], "time": 3, "stress": {"anna": 1.1, "ben": 0.2}}
            ],
            "after": ["shaft"],
            "zone": "jig",
        },
        "screws": {
            "time": {"cobot": 2, "anna": 3},
            "stress": 1,
            "after": ["housing"],
            "tool": "driver",
            "deadline": 12,
        },
        "cover": {"time": {"ben": 4}, "stress": 4, "zone": "jig", "after": ["gears"]},
        "label": {
            "time": {"ben": 1, "anna": 1},
            "stress": 0.3,
            "difficulty": {"ben": 2, "anna": 0.1},
        },
        "check": {"time": {"anna": 2, "ben": 2}, "stress": 0.5, "after": ["cover"], "zone": "jig"},
        "pack": {"time": {"cobot": 3}, "after": ["screws"], "tool": "gripper"},
    },
    "same_operator": [["cover", "check"]],
}

GEARBOX_PLAN: dict[str, tuple[tuple[str, ...], float, float]] = {
    "housing": (("cobot",), 0, 4),
    "shaft": (("anna",), 1, 3.5),
    "gears": (("anna", "ben"), 3.5, 6.5),
    "screws": (("cobot",), 7, 9),
    "cover": (("ben",), 6.5, 10.5),
    "label": (("anna",), 6.5, 7.5),
    "check": (("ben",), 10.5, 12.5),
    "pack": (("cobot",), 15, 18),
}


GLUED: dict[str, Any] = {
    "operators": {"cobot": {"kind": "robot"}, "anna": {"kind": "human"}},
    "tasks": {
        "sort": {"time": {"anna": 100}},
        "glue": {"time": {"cobot": 5}},
        "press": {
            "time": {"anna": 10},
            "stress": 2,
            "after": ["sort"],
            "wait": {"after": "glue", "at_least": 40, "at_most": 60},
        },
        "cool": {
            "time": {"cobot": 6},
            "wait": [{"after": "press", "between": "start-start", "at_least": 4, "at_most": 9}],
        },
    },
}
"""Glue must be pressed 40 to 60 s after it was put on, and Anna is busy until 100 s."""

GLUED_PLAN: dict[str, tuple[tuple[str, ...], float, float]] = {
    "sort": (("anna",), 0, 100),
    "glue": (("cobot",), 35, 40),
    "press": (("anna",), 100, 110),
    "cool": (("cobot",), 104, 110),
}


def thesis() -> Cell:
    """The example of Kinat (2023), chapter 6."""
    return Cell.model_validate(THESIS)


def gearbox(**changes: Any) -> Cell:
    """A cell with a bit of everything; top-level keys can be changed."""
    return Cell.model_validate({**GEARBOX, **changes})


def glued(**changes: Any) -> Cell:
    """A cell with waits; top-level keys can be changed."""
    return Cell.model_validate({**GLUED, **changes})


def glued_schedule(**changes: tuple[tuple[str, ...], float, float]) -> Schedule:
    """A sound schedule of the glued cell, some of its rows changed."""
    return schedule({**GLUED_PLAN, **changes})


def schedule(rows: dict[str, tuple[tuple[str, ...], float, float]]) -> Schedule:
    """Task -> (operators, start, end), as a schedule."""
    return Schedule(
        tuple(Assignment(start, end, task, who) for task, (who, start, end) in rows.items())
    )


def gearbox_schedule(**changes: tuple[tuple[str, ...], float, float]) -> Schedule:
    """A sound schedule of the gearbox, some of its rows changed."""
    return schedule({**GEARBOX_PLAN, **changes})


def thesis_schedule() -> Schedule:
    """The thesis's second run: 23 s, stress 7."""
    robot, human = ("robot",), ("human",)
    return schedule({
        "1": (robot, 0, 9), "2": (robot, 9, 16), "3": (human, 0, 10), "4": (robot, 16, 18),
        "5": (human, 10, 12), "6": (human, 18, 21), "7": (robot, 21, 23),
    })  # fmt: skip
