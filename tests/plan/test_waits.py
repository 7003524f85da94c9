"""Waits between tasks: what each method of planning makes of them, where a person can tell."""

from __future__ import annotations

from random import Random
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from tests.plan.brute_force import front_in_order
from tests.schedule.cells import GLUED, glued
from tests.strategies import cells

import tandem
from tandem.cell.model import Cell
from tandem.errors import InfeasibleError, NothingFoundError
from tandem.files.validate import cell_of
from tandem.plan import dynamic_programming, exact
from tandem.plan.bounds import chain_bound, least_makespan, one_operator_bound
from tandem.plan.infeasible import infeasible
from tandem.plan.instance import Instance, Lag
from tandem.plan.least_change import replan
from tandem.plan.list_scheduling import Layout, by_start
from tandem.plan.question import Question
from tandem.plan.rules import RULES, SPECS, build
from tandem.plan.starts import appended, in_time, moved_up
from tandem.schedule.checker import faults

METHODS = {"exact": exact.solve, "exhaustive": dynamic_programming.solve}
ANNA = {"anna": {"kind": "human"}}
TWO = {"cobot": {"kind": "robot"}, **ANNA}


def quickest(method: str, cell: Cell) -> dict[str, float]:
    """The makespan, and when each task starts in the quickest schedule."""
    front = tandem.plan(cell, minimize="makespan", method=method, workers=1)
    assert front.complete
    return {"": front[0].makespan, **{a.task: a.start for a in front[0].schedule}}


@pytest.mark.parametrize("method", METHODS)
def test_glue_is_put_on_late_when_nobody_can_press_it_sooner(method: str) -> None:
    """Anna sorts until 100 s. Glue that was put on at once would be too old by then."""
    found = quickest(method, glued())
    assert found == {"": 110, "sort": 0, "glue": 35, "press": 100, "cool": 104}


@pytest.mark.parametrize("method", METHODS)
def test_what_must_follow_at_once_draws_a_whole_chain_along(method: str) -> None:
    """c follows b at once, b follows a at once, and c wants the operator who is busy until 9 s."""
    cell = cell_of(
        {
            "operators": TWO,
            "tasks": {
                "a": {"time": {"cobot": 2}},
                "b": {"time": {"cobot": 3}, "wait": {"after": "a", "at_most": 0}},
                "c": {"time": {"anna": 1}, "wait": {"after": "b", "at_most": 0}, "release": 9},
            },
        }
    )
    assert quickest(method, cell) == {"": 10, "a": 4, "b": 6, "c": 9}


@pytest.mark.parametrize("method", METHODS)
def test_a_task_that_is_put_off_gives_way_to_others_of_its_operator(method: str) -> None:
    """The cobot has time for two other tasks before the glue, and none of them comes later."""
    tasks = {
        **GLUED["tasks"],
        "one": {"time": {"cobot": 20}},
        "other": {"time": {"cobot": 15}, "after": ["one"]},
    }
    found = quickest(method, glued(tasks=tasks))
    assert found == {"": 110, "sort": 0, "one": 0, "other": 20, "glue": 35, "press": 100,
    "cool": 104}  # fmt: skip


@pytest.mark.parametrize("method", METHODS)
def test_a_break_draws_the_task_before_a_wait_along(method: str) -> None:
    """Anna's break lets the press begin at 12 s only; at most 2 s after the glue."""
    cell = cell_of(
        {
            "operators": {**TWO, "anna": {"kind": "human", "breaks": [[4, 12]]}},
            "tasks": {
                "glue": {"time": {"cobot": 3}},
                "press": {"time": {"anna": 3}, "wait": {"after": "glue", "at_most": 2}},
            },
        }
    )
    assert quickest(method, cell) == {"": 15, "glue": 7, "press": 12}


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    ("wait", "start"),
    [
        ({"at_least": 2}, 7),
        ({"between": "start-start"}, 0),
        ({"between": "start-start", "at_least": 2}, 2),
        ({"between": "start-start", "at_least": 2.5, "at_most": 2.5}, 2.5),
    ],
)
def test_a_wait_counts_from_the_end_or_from_the_start(
    method: str, wait: dict[str, Any], start: float
) -> None:
    cell = cell_of(
        {
            "operators": TWO,
            "tasks": {
                "second": {"time": {"anna": 4}, "wait": {"after": "first", **wait}},
                "first": {"time": {"cobot": 5}},
            },
        }
    )
    assert quickest(method, cell)["second"] == start


ALONE = {
    "operators": ANNA,
    "tasks": {
        "glue": {"time": {"anna": 5}},
        "sort": {"time": {"anna": 100}, "after": ["glue"]},
        "press": {
            "time": {"anna": 10},
            "after": ["sort"],
            "wait": {"after": "glue", "at_least": 40, "at_most": 60},
        },
    },
}
"""Sorting takes longer than the glue stays open."""


@pytest.mark.parametrize("method", METHODS)
def test_a_wait_that_nobody_can_keep_is_proven_to_be_impossible(method: str) -> None:
    with pytest.raises(InfeasibleError):
        METHODS[method](cell_of(ALONE), Question("makespan"))


@pytest.mark.parametrize("breaks", [[], [[300, 301]]])
def test_a_wait_missed_by_a_tick_of_many_is_ruled_out_at_once(breaks: list[list[int]]) -> None:
    """Putting the glue off tick by tick would go on for a million rounds."""
    tasks: dict[str, Any] = {
        "glue": {"time": {"anna": 5}, "tool": "gun"},
        "sort": {"time": {"anna": 100.0001}, "after": ["glue"], "tool": "tray"},
        "press": {
            "time": {"anna": 10},
            "after": ["sort"],
            "wait": {"after": "glue", "at_most": 100},
        },
    }
    tools = {"gun": {"changeover": {"anna": 2}}, "tray": {}}
    people = {"anna": {"kind": "human", "breaks": breaks}}
    with pytest.raises(InfeasibleError):
        dynamic_programming.solve(
            cell_of({"operators": people, "tasks": tasks, "tools": tools}), Question()
        )


def test_the_reasons_name_the_wait_and_what_it_would_give_to_lift_it() -> None:
    assert list(infeasible("", cell_of(ALONE), Question()).reasons) == [
        "that task press starts at most 60 s after task glue has ended cannot be kept.",
        "Without that task press starts at most 60 s after task glue has ended it works: 115 s with"
        " a stress of 0.",
    ]


def test_least_waits_count_in_heads_tails_and_bounds() -> None:
    """5 + 40 + 10, then from the press's start 4 + 6, which ends no later than the press."""
    layout = Layout.of(Instance.of(glued()))
    instance = layout.instance
    names = dict(enumerate(instance.tasks))
    assert {names[t]: head for t, head in enumerate(instance.head)} == {
        "sort": 0, "glue": 0, "press": 100, "cool": 104,
    }  # fmt: skip
    assert {names[t]: tail for t, tail in enumerate(instance.tail)} == {
        "sort": 110, "glue": 55, "press": 10, "cool": 6,
    }  # fmt: skip
    assert {names[t]: rest for t, rest in enumerate(instance.rest)} == {
        "sort": 10, "glue": 50, "press": 0, "cool": 0,
    }  # fmt: skip
    assert (chain_bound(layout), one_operator_bound(layout)) == (110, 110)


def test_a_slow_way_leaves_less_of_a_wait_from_its_start_behind_its_end() -> None:
    cell = cell_of(
        {
            "operators": TWO,
            "tasks": {
                "a": {"time": {"cobot": 2, "anna": 10}},
                "b": {
                    "time": {"cobot": 5},
                    "wait": {"after": "a", "between": "start-start", "at_least": 20},
                },
            },
        }
    )
    layout = Layout.of(Instance.of(cell))
    assert layout.tail == (25, 5)
    assert layout.behind == (15, 0)
    assert exact.solve(cell, Question("makespan"))[0].makespan == 25


def test_a_list_schedule_is_drawn_together_and_moved_up_keeps_it_so() -> None:
    layout = Layout.of(Instance.of(glued()))
    state = build(layout, SPECS["longest-tail"], Random(0))
    assert state is not None
    starts = tuple(state.starts())
    assert in_time(layout.instance, starts)
    late = tuple((way, start + 7) for way, start in starts)
    assert moved_up(layout, late) == moved_up(layout, starts) == appended(layout, late)
    assert [start for _, start in moved_up(layout, late)] == [0, 35, 100, 104]


def test_of_two_that_start_together_the_one_that_waits_stands_behind() -> None:
    tasks = {
        "second": {"time": {"anna": 4}, "wait": {"after": "first", "between": "start-start"}},
        "first": {"time": {"cobot": 5}},
    }
    instance = Instance.of(cell_of({"operators": TWO, "tasks": tasks}))
    assert by_start(instance, [(0, 0), (0, 0)]) == [1, 0]
    assert instance.order == (1, 0)


def test_an_instance_holds_waits_in_ticks_and_views_keep_them() -> None:
    instance = Instance.of(glued())
    lags = (Lag(1, 2, False, 40, 60), Lag(2, 3, True, 4, 9))
    assert instance.lags == lags
    assert instance.before == ((), (), (0, 1), ())
    assert instance.scaled(10).lags == (Lag(1, 2, False, 400, 600), Lag(2, 3, True, 40, 90))
    left = instance.restricted([2, 3], [instance.ways[2], instance.ways[3]], [0, 0])
    assert left.lags == (Lag(0, 1, True, 4, 9),)


@pytest.mark.parametrize("rule", sorted(RULES))
@settings(max_examples=15, deadline=None, suppress_health_check=list(HealthCheck))
@given(cell=cells(min_tasks=2, max_tasks=5))
def test_every_bound_holds_and_every_rule_keeps_waits(rule: str, cell: Cell) -> None:
    least = least_makespan(Layout.of(Instance.of(cell))) / Instance.of(cell).per_second
    try:
        for result in RULES[rule](cell):
            assert faults(cell, result.schedule) == []
            assert least <= result.makespan
    except NothingFoundError:
        pass


WAITING = (
    # a wait that binds two operators who are both wanted elsewhere
    {
        "a": {"time": {"cobot": 3}, "stress": 0},
        "b": {"time": {"anna": 6}, "stress": 1},
        "c": {"time": {"anna": 2, "cobot": 4}, "stress": 3, "wait": {"after": "a", "at_most": 1}},
        "d": {"time": {"cobot": 2}, "wait": {"after": "c", "at_least": 2, "at_most": 3}},
    },
    # open all along: what is first must not be too far from what is last
    {
        "a": {"time": {"cobot": 2, "anna": 1}, "stress": 2},
        "b": {"time": {"anna": 3, "cobot": 5}, "stress": 1, "after": ["a"]},
        "c": {"time": {"cobot": 4}, "after": ["a"]},
        "d": {
            "time": {"anna": 2},
            "after": ["b", "c"],
            "wait": {"after": "a", "between": "start-start", "at_most": 8},
        },
    },
    # two waits that overlap, and no time to lose in either
    {
        "a": {"time": {"cobot": 2}},
        "b": {"time": {"cobot": 3}},
        "c": {"time": {"anna": 3}, "wait": [{"after": "a", "at_least": 1, "at_most": 4}]},
        "d": {"time": {"anna": 2}, "wait": [{"after": "b", "at_least": 0, "at_most": 1}]},
    },
)


@pytest.mark.parametrize("tasks", WAITING)
def test_all_three_judges_agree(tasks: dict[str, Any]) -> None:
    data = {"operators": TWO, "tasks": tasks}
    right = front_in_order(data)
    for solve in METHODS.values():
        front = solve(cell_of(data))
        assert front.complete
        assert front.points == right


def test_a_front_of_a_larger_cell_is_proven_by_the_sweep() -> None:
    """The methods that work in parts (list schedules, stretches, refutation) keep waits too."""
    random = Random(4)
    tasks: dict[str, Any] = {}
    for place in range(18):
        tasks[f"t{place}"] = {
            "time": {"anna": random.randint(2, 9), "cobot": random.randint(2, 9)},
            "stress": random.randint(0, 3),
        }
        if place % 3 == 2:
            tasks[f"t{place}"]["wait"] = {"after": f"t{place - 1}", "at_least": 2, "at_most": 6}
    cell = cell_of({"operators": TWO, "tasks": tasks})
    front = exact.solve(cell, Question("makespan"), work=2.0, workers=1)
    assert faults(cell, front[0].schedule) == []
    assert front[0].bound.makespan <= front[0].makespan


def test_an_old_plan_is_carried_over_with_its_waits() -> None:
    """Glue that has been put on is pressed in time; where time has run out, the wait is named."""
    before = exact.solve(glued(), Question("makespan"))[0].schedule
    slower = {**GLUED["tasks"], "sort": {"time": {"anna": 98}}}
    after = replan(glued(tasks=slower), before, at=50, workers=1)
    rows = {a.task: (a.start, a.end) for a in after[0].schedule}
    assert rows["glue"] == (35, 40)
    assert rows["press"][0] in (98, 100)
    stuck = {**GLUED["tasks"], "sort": {"time": {"anna": 120}}}
    with pytest.raises(InfeasibleError) as caught:
        replan(glued(tasks=stuck), before, at=50, workers=1)
    said = (
        "Without the wait of task press (at most 60 s after task glue has ended) there is a plan."
    )
    assert said in str(caught.value)
