"""Deadlines of tasks that can be done at different speeds: what counts is the way that is taken,
not the quickest.
"""

from __future__ import annotations

import pytest

from tandem.cell.model import Cell
from tandem.errors import InfeasibleError
from tandem.files.validate import cell_of
from tandem.plan.methods import plan
from tandem.plan.question import Question

ANNA_AND_COBOT = {"cobot": {"kind": "robot"}, "anna": {"kind": "human"}}
THREE = {**ANNA_AND_COBOT, "ben": {"kind": "human"}}


def cell(tasks: dict, operators: dict = ANNA_AND_COBOT, **more) -> Cell:
    return cell_of({"operators": operators, "tasks": tasks, **more})


GENTLE_IS_SLOW = cell(
    {
        "hold": {"time": {"cobot": 3}},
        "glue": {
            "time": {"cobot": 2},
            "stress": 1,
            "deadline": 4,
            "together": [{"operators": ["cobot", "anna"], "time": 1}],
        },
    }
)
ALL_FOUR = cell(
    {
        "t0": {"time": {"anna": 4}},
        "t1": {"time": {"cobot": 6}, "deadline": 11},
        "t2": {"time": {"anna": 6, "cobot": 7}, "stress": 2, "deadline": 12},
        "t3": {"time": {"anna": 3}, "deadline": 5},
    }
)
SLOWER_BUT_IN_TIME = cell(
    {
        "t0": {"time": {"anna": 1}, "stress": 2},
        "t1": {"time": {"anna": 7}},
        "t2": {"time": {"anna": 1, "cobot": 3}, "stress": 1, "deadline": 6},
        "t3": {"time": {"anna": 4, "cobot": 5}, "stress": 1, "deadline": 9},
    }
)
SLOW_IN_BREAKS = cell(
    {
        "a": {"time": {"anna": 2, "ben": 5}, "stress": {"anna": 3, "ben": 1}, "deadline": 7},
        "b": {"time": {"ben": 2}, "release": 1},
    },
    {**THREE, "ben": {"kind": "human", "breaks": [[5, 6]]}},
)
"""Ben's five seconds end in time at 5 s only, and then b waits for the break to end."""
JOINT_WAY_IN_A_ZONE = cell(
    {
        "lift": {
            "time": {"anna": 6},
            "together": [{"operators": ["anna", "ben"], "time": 2}],
            "stress": 2,
            "zone": "z",
            "deadline": 7,
        },
        "turn": {"time": {"cobot": 3}, "zone": "z"},
    },
    THREE,
    zones={"z": {"capacity": 2}},
)
CHAIN_OF_DEADLINES = cell(
    {
        "a": {"time": {"anna": 1, "cobot": 4}, "stress": 5, "deadline": 4},
        "b": {"time": {"anna": 2, "cobot": 3}, "stress": 1, "after": ["a"], "deadline": 7},
        "c": {"time": {"cobot": 2}},
    }
)
TENTHS = cell(
    {
        "a": {"time": {"anna": 0.1, "cobot": 0.3}, "stress": 0.1, "deadline": 0.4},
        "b": {"time": {"cobot": 0.2}},
    }
)
SHORT_OF_A_TICK = cell(
    {
        "a": {"time": {"anna": 0.1, "cobot": 0.3}, "stress": 0.1, "deadline": 0.49},
        "b": {"time": {"cobot": 0.2}, "after": ["a"]},
    }
)

FRONTS = [
    (GENTLE_IS_SLOW, [(4, 1), (5, 0)]),
    (ALL_FOUR, [(13, 2)]),
    (SLOWER_BUT_IN_TIME, [(8, 2)]),
    (SLOW_IN_BREAKS, [(3, 3), (8, 1)]),
    (JOINT_WAY_IN_A_ZONE, [(5, 4), (6, 2)]),
    (CHAIN_OF_DEADLINES, [(3, 6), (5, 5), (6, 1), (9, 0)]),
    (TENTHS, [(0.2, 0.1), (0.5, 0)]),
    (SHORT_OF_A_TICK, [(0.3, 0.1), (0.5, 0)]),
]
"""Cells small enough to be worked out by hand, with their fronts."""


@pytest.mark.parametrize("method", ["exact", "exhaustive"])
@pytest.mark.parametrize(("of", "points"), FRONTS)
def test_a_slower_way_ends_before_its_deadline(of, points, method):
    front = plan(of, method=method, workers=1)
    assert front.points == points
    assert front.complete


@pytest.mark.parametrize("method", ["exact", "exhaustive"])
@pytest.mark.parametrize(("of", "points"), FRONTS)
def test_the_ends_of_a_front_with_deadlines_are_found_alone(of, points, method):
    for minimize, point in (("makespan", points[0]), ("stress", points[-1])):
        front = plan(of, Question(minimize), method=method, workers=1)
        assert front.points == [point]
        assert front.complete


@pytest.mark.parametrize("method", ["exact", "exhaustive"])
@pytest.mark.parametrize(
    "tasks",
    [
        {
            "t0": {"time": {"cobot": 2}, "deadline": 4},
            "t1": {"time": {"anna": 5, "cobot": 4}, "deadline": 4},
        },
        {
            "t0": {"time": {"cobot": 3}, "deadline": 3},
            "t1": {"time": {"anna": 9, "cobot": 4}, "deadline": 6},
        },
        {
            "t0": {"time": {"anna": 9, "cobot": 1}, "deadline": 8},
            "t1": {"time": {"anna": 9, "cobot": 8}, "deadline": 8},
        },
        {
            "t0": {"time": {"anna": 2}, "deadline": 2.5},
            "t1": {"time": {"anna": 1, "cobot": 2.6}, "deadline": 2.5},
        },
    ],
)
def test_when_neither_way_is_in_time_that_is_proven(tasks, method):
    with pytest.raises(InfeasibleError, match="cannot be kept together"):
        plan(cell(tasks), method=method, workers=1)
