"""Times in millionths of a second: a handful of tasks has a front that is proven at once, whatever
the number of ticks.

CP-SAT was seen to refute "one tick less" tick by tick, millions of them, where work is packed
around a break; after a minute the front of three tasks was still not complete.
"""

from __future__ import annotations

from typing import Any

import pytest
from tests.plan.brute_force import front_in_order

from tandem.files.validate import cell_of
from tandem.plan.methods import METHODS
from tandem.plan.question import Question

LIMIT_S = 60
"""Seconds, of which hundredths are needed."""


def human(*breaks: tuple[float, float]) -> dict[str, Any]:
    return {"anna": {"kind": "human", "breaks": [list(pair) for pair in breaks]}}


def alone(*times: float, **more: Any) -> dict[str, Any]:
    return {
        f"t{place}": {"time": {"anna": time}, "stress": place + 0.5, **more}
        for place, time in enumerate(times)
    }


ROUND_A_BREAK = {
    "operators": human((5.357562, 8.51266)),
    "tasks": alone(1.999697, 3.50654, 3.50654),
}
FOUR_ROUND_A_BREAK = {
    "operators": human((6.883032, 10.497734)),
    "tasks": alone(4.596312, 2.716813, 4.463644, 7.556205),
}
TWO_BREAKS_AND_TOOLS = {
    "operators": {
        "anna": {**human((7.572771, 8.67895), (9.950969, 11.875726))["anna"], "tool": "wrench"}
    },
    "tasks": alone(3.14585, 4.068877, 3.267483, 3.264225, tool="driver"),
    "tools": {"driver": {"changeover": {"anna": 0.186494}}},
}
A_ROBOT_IN_A_BENCH = {
    "operators": {"cobot": {"kind": "robot", "breaks": [[6.74303, 8.301964]]}},
    "tasks": {
        name: {"time": {"cobot": time}, "zone": "bench"}
        for name, time in zip("abcd", (4.742859, 7.600542, 6.175617, 6.022946), strict=True)
    },
}
JOINT_AND_RELEASED = {
    "operators": {**human((7.847916, 11.066783)), "cobot": {"kind": "robot"}},
    "tasks": {
        "t0": {
            "time": {"anna": 4.497102},
            "stress": 8.017383,
            "together": [{"operators": ["cobot", "anna"], "time": 3.921554}],
        },
        "t1": {"time": {"anna": 4.161674}, "stress": 4.332353, "release": 0.300001},
        "t2": {
            "time": {"anna": 4.781601, "cobot": 3.595406},
            "stress": 2.46976,
            "after": ["t0", "t1"],
        },
        "t3": {
            "time": {"anna": 4.101613},
            "stress": 3.565304,
            "together": [{"operators": ["cobot", "anna"], "time": 5.083618, "stress": 3.548282}],
        },
    },
}
CHOICE_OF_TWO = {
    "operators": {
        **human(),
        "cobot": {"kind": "robot", "breaks": [[2.358106, 3.422914], [10.275385, 11.28926]]},
    },
    "tasks": {
        "t0": {"time": {"anna": 7.087633, "cobot": 2.452456}, "stress": 5.31981},
        "t1": {"time": {"cobot": 5.073911}},
        "t2": {"time": {"cobot": 5.734024, "anna": 4.110571}, "stress": 7.83245},
        "t3": {"time": {"anna": 2.087882, "cobot": 7.193094}, "stress": 4.8345},
    },
}
CELLS = [
    ROUND_A_BREAK,
    FOUR_ROUND_A_BREAK,
    TWO_BREAKS_AND_TOOLS,
    A_ROBOT_IN_A_BENCH,
    JOINT_AND_RELEASED,
    CHOICE_OF_TWO,
]


@pytest.mark.parametrize("workers", [1, 2])
@pytest.mark.parametrize("data", CELLS)
def test_the_front_of_fine_times_is_proven(data, workers):
    right = front_in_order(data)
    front = METHODS["exact"](cell_of(data), time_limit=LIMIT_S, workers=workers)
    assert front.points == right
    assert front.complete
    for minimize, point in (("makespan", right[0]), ("stress", right[-1])):
        best = METHODS["exact"](
            cell_of(data), Question(minimize), time_limit=LIMIT_S, workers=workers
        )
        assert (best.points, best.complete) == ([point], True)
