"""Walking, and tools by operator, in finished schedules: what the checker says, what it comes to,
and what waits for it.
"""

from __future__ import annotations

from typing import Any

import pytest

from tandem.cell.model import Cell
from tandem.files.validate import cell_of
from tandem.schedule.checker import faults
from tandem.schedule.critical import critical_path, slack
from tandem.schedule.measures import changeovers, changing, idle, walks
from tandem.schedule.model import Assignment, Schedule

ANNA, COBOT = ("anna",), ("cobot",)


def station(anna: dict[str, Any] | None = None, **more: Any) -> Cell:
    """Three tasks of Anna's: at the bench, anywhere, and at the press with another tool."""
    data = {
        "operators": {"anna": {"kind": "human", **(anna or {})}, "cobot": {"kind": "robot"}},
        "tasks": {
            "a": {"time": {"anna": 2}, "place": "bench", "tool": "driver"},
            "b": {"time": {"anna": 1}},
            "c": {"time": {"anna": 3, "cobot": 3}, "place": "press", "tool": {"anna": "gauge"}},
        },
        "tools": {"gauge": {"changeover": {"anna": 1}}},
        "walk": {"anna": {"bench-press": 3, "press-bench": 2}},
    }
    return cell_of({**data, **more})


def rows(*starts: tuple[str, tuple[str, ...], float, float]) -> Schedule:
    return Schedule(tuple(Assignment(start, end, task, who) for task, who, start, end in starts))


IN_TIME = rows(("a", ANNA, 0, 2), ("b", ANNA, 2, 3), ("c", ANNA, 7, 10))


def test_walk_and_changeover_add_up_directly_before_the_task() -> None:
    assert faults(station(), IN_TIME) == []
    early = rows(("a", ANNA, 0, 2), ("b", ANNA, 2, 3), ("c", ANNA, 6.5, 9.5))
    assert faults(station(), early) == [
        "operator 'anna': needs 3 s to walk from 'bench' to 'press' and 1 s to take up tool 'gauge'"
        " before task 'c', which starts only 3.5 s after task 'b'; 7 s is the earliest."
    ]


def test_each_direction_takes_its_own_time() -> None:
    back = rows(("c", ANNA, 0, 3), ("b", ANNA, 3, 4), ("a", ANNA, 5, 7))
    assert faults(station(), back) == [
        "operator 'anna': needs 2 s to walk from 'press' to 'bench' before task 'a', which starts"
        " only 1 s after task 'b'; 6 s is the earliest."
    ]


def test_who_stands_elsewhere_at_the_start_walks_first() -> None:
    there = station({"place": "press"})
    assert faults(there, IN_TIME) == [
        "operator 'anna': needs 2 s to walk from 'press' to 'bench' before task 'a', which starts"
        " only 0 s after the beginning; 2 s is the earliest."
    ]


def test_no_walk_runs_into_a_break() -> None:
    resting = station({"breaks": [[4, 5]]})
    assert faults(resting, IN_TIME) == [
        "operator 'anna': needs 3 s to walk from 'bench' to 'press' and 1 s to take up tool 'gauge'"
        " before task 'c'; from 3 s to 7 s that runs into the break from 4 s to 5 s; after it, 9 s"
        " is the earliest."
    ]


def test_who_is_not_in_walk_needs_no_time() -> None:
    assert faults(station(), rows(("a", ANNA, 0, 2), ("b", ANNA, 2, 3), ("c", COBOT, 0, 3))) == []


def test_only_those_who_need_a_tool_share_it() -> None:
    cell = cell_of(
        {
            "operators": {"anna": {"kind": "human"}, "cobot": {"kind": "robot"}},
            "tasks": {
                "left": {
                    "time": {"anna": 4, "cobot": 4},
                    "tool": {"anna": "driver", "cobot": "spindle"},
                },
                "right": {"time": {"anna": 4, "cobot": 4}, "tool": "driver"},
            },
        }
    )
    assert faults(cell, rows(("left", COBOT, 0, 4), ("right", ANNA, 0, 4))) == []
    assert faults(cell, rows(("left", ANNA, 0, 4), ("right", COBOT, 0, 4))) == [
        "tool 'driver': there is only 1 of it, but 2 operators need it at once from 0 s to 4 s"
        " (tasks 'left' and 'right')."
    ]


def test_walks_and_changeovers_are_told_apart_and_counted_together() -> None:
    [walk], [change] = walks(station(), IN_TIME), changeovers(station(), IN_TIME)
    assert (walk.origin, walk.place, walk.task) == ("bench", "press", "c")
    assert (walk.start, walk.end, change.start, change.end) == (3, 6, 6, 7)
    assert changing(station(), IN_TIME) == {"anna": 4, "cobot": 0}
    assert idle(station(), IN_TIME) == {"anna": 0, "cobot": 10}


@pytest.mark.parametrize(
    ("more", "reason", "words"),
    [
        ({}, "preparation", "when anna has walked there and changed tools after b"),
        ({"tools": {}}, "walk", "when anna has walked there after b"),
        ({"walk": {}}, "changeover", "when anna has changed tools after b"),
    ],
)
def test_what_waits_for_a_walk_says_so(more: dict[str, Any], reason: str, words: str) -> None:
    cell = station(**more)
    start = 3 + (3 if cell.walk else 0) + (1 if cell.tools else 0)
    plan = rows(("a", ANNA, 0, 2), ("b", ANNA, 2, 3), ("c", ANNA, start, start + 3))
    assert faults(cell, plan) == []
    last = critical_path(cell, plan)[-1]
    assert (last.reason, last.waited_for) == (reason, "b")
    assert words in str(last)
    assert slack(cell, plan) == {"a": 0, "b": 0, "c": 0}
