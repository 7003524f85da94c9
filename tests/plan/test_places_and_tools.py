"""Walking, and tools by operator, in planning: small stations whose best plan a person can work
out, for every method; what cannot be, and what is planned anew.
"""

from __future__ import annotations

from typing import Any

import pytest
from tests.plan.brute_force import front_in_order, front_of_all

import tandem
from tandem.errors import InfeasibleError
from tandem.files.validate import cell_of
from tandem.plan.least_change import replan
from tandem.plan.methods import METHODS, plan
from tandem.schedule.checker import faults
from tandem.schedule.measures import walks

BOTH = ("exact", "exhaustive")


def alone(anna: dict[str, Any] | None = None, **more: Any) -> dict[str, Any]:
    """Anna, two tasks at the bench and one at the press."""
    return {
        "operators": {"anna": {"kind": "human", **(anna or {})}},
        "tasks": {
            "a": {"time": {"anna": 3}, "place": "bench"},
            "b": {"time": {"anna": 2}, "place": "press"},
            "c": {"time": {"anna": 1}, "place": "bench"},
        },
        "walk": {"anna": {"bench-press": 4, "press-bench": 2}},
        **more,
    }


def with_two_robots(**more: Any) -> dict[str, Any]:
    """Screws on two sides, by a person or a robot, each with tools of their own."""
    side = {
        "time": {"anna": 6, "cobot": 6},
        "tool": {"anna": "screwdriver", "cobot": "spindle"},
    }
    return {
        "operators": {"anna": {"kind": "human"}, "cobot": {"kind": "robot"}},
        "tasks": {"left": side, "right": side, **more},
    }


def quickest(data: dict[str, Any], method: str) -> float:
    cell = cell_of(data)
    [best] = plan(cell, method=method, minimize="makespan", workers=1)
    assert faults(cell, best.schedule) == []
    return best.makespan


@pytest.mark.parametrize("method", BOTH)
@pytest.mark.parametrize(
    ("data", "seconds"),
    [
        # press first, then the short way to the bench
        (alone(), 2 + 2 + 4),
        # from the bench the long way is walked once, in the end
        (alone({"place": "bench"}), 4 + 4 + 2),
        (alone({"place": "press"}), 2 + 2 + 4),
        # there is time to walk while nothing can begin
        (
            alone(tasks={"a": {"time": {"anna": 3}, "place": "bench"},
                         "b": {"time": {"anna": 2}, "place": "press", "release": 8}}),
            10,
        ),
        # no walk in a break: the work at the press, the break, the way
        (alone({"breaks": [[3, 5]]}), 5 + 2 + 4),
        # a way and a changeover before one task
        (
            alone(
                {"tool": "tongs"},
                tasks={"a": {"time": {"anna": 3}, "place": "bench"},
                       "b": {"time": {"anna": 2}, "place": "press", "tool": "ram"}},
                tools={"ram": {"changeover": {"anna": 5}}},
            ),
            5 + 2 + 2 + 3,
        ),
    ],
)  # fmt: skip
def test_ways_are_walked_and_seldom(method: str, data: dict[str, Any], seconds: float) -> None:
    assert quickest(data, method) == seconds
    assert front_in_order(data)[0][0] == seconds
    assert front_of_all(data)[0][0] == seconds


@pytest.mark.parametrize("method", BOTH)
def test_tools_of_their_own_let_both_work_at_once(method: str) -> None:
    assert quickest(with_two_robots(), method) == 6
    shared = with_two_robots()
    shared["tasks"] = {name: {**task, "tool": "driver"} for name, task in shared["tasks"].items()}
    assert quickest(shared, method) == 12


@pytest.mark.parametrize("method", BOTH)
def test_a_group_may_need_what_nobody_needs_alone(method: str) -> None:
    lid = {"together": [{"operators": ["anna", "cobot"], "time": 2, "tool": {"cobot": "gripper"}}]}
    data = with_two_robots(lid=lid)
    assert quickest(data, method) == 8
    data["tools"] = {"gripper": {"changeover": {"cobot": 3}}, "spindle": {}}
    # one order: the lid first, while the cobot has the gripper in hand
    assert quickest(data, method) == 8
    data["tasks"]["lid"]["after"] = ["left", "right"]
    assert quickest(data, method) == 11


@pytest.mark.parametrize("method", sorted(METHODS))
def test_every_method_keeps_to_the_ways(method: str) -> None:
    """What it plans is sound, and no better than the best."""
    cell = tandem.load("examples/pump.yaml")
    front = plan(cell, method=method, minimize="makespan", time_limit=20, workers=1)
    assert front[0].makespan >= 109
    assert faults(cell, front[0].schedule) == []
    assert walks(cell, front[0].schedule)


def test_large_cells_are_planned_with_their_ways() -> None:
    """Stretches that are planned anew begin where their operators stand."""
    places = ("bench", "press", "shelf")
    tasks = {
        f"t{n}": {
            "time": {"anna": 3 + n % 4, "cobot": 4 + n % 3},
            "place": places[n % 3],
            "after": [f"t{n - 6}"] if n >= 6 else [],
            "tool": {"anna": ("driver", "gauge")[n % 2]},
        }
        for n in range(45)
    }
    walk = {"bench-press": 2, "press-shelf": 2, "bench-shelf": 3}
    cell = cell_of(
        {
            "operators": {"anna": {"kind": "human"}, "cobot": {"kind": "robot"}},
            "tasks": tasks,
            "tools": {"driver": {"changeover": {"anna": 1}}},
            "walk": {"anna": walk, "cobot": walk},
        }
    )
    [best] = plan(cell, minimize="makespan", work=0.5, workers=1)
    assert faults(cell, best.schedule) == []
    assert best.bound.makespan <= best.makespan


def test_what_cannot_be_because_of_a_way_says_so() -> None:
    tasks = alone()["tasks"]
    tasks["b"]["deadline"], tasks["a"]["deadline"] = 7, 3
    with pytest.raises(InfeasibleError) as refused:
        plan(cell_of(alone(tasks=tasks)), workers=1)
    assert "Without the time that anna takes to walk it works: 6 s" in str(refused.value)


def later() -> dict[str, Any]:
    """A task at the bench, and one at the press that waits for its release."""
    return {
        "operators": {"anna": {"kind": "human"}},
        "tasks": {
            "a": {"time": {"anna": 3}, "place": "bench"},
            "d": {"time": {"anna": 1}, "place": "press", "release": 20, "after": ["a"]},
        },
        "walk": {"anna": {"bench-press": 4}},
    }


def test_nobody_sets_out_in_the_past() -> None:
    """At 10 s Anna stands at the bench still: by then she cannot have been on her way."""
    [old] = plan(cell_of(later()), minimize="makespan", workers=1)
    assert [a.start for a in old.schedule] == [0, 20]
    data = later()
    del data["tasks"]["d"]["release"]
    now = cell_of(data)
    changed = replan(now, old.schedule, at=10.0, allow=0.0, workers=1)[0].schedule
    assert [a.start for a in changed] == [0, 14]
    [walk] = walks(now, changed)
    assert walk.start == 10


def test_who_is_on_the_way_goes_on() -> None:
    """At 18 s she is on her way since 16 s, and what she goes for stays where it is."""
    [old] = plan(cell_of(later()), minimize="makespan", workers=1)
    data = later()
    data["tasks"]["d"]["time"]["anna"] = 5
    changed = replan(cell_of(data), old.schedule, at=18.0, allow=0.0, workers=1)[0].schedule
    assert [(a.start, a.end) for a in changed] == [(0, 3), (20, 25)]
