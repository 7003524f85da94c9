"""Why a schedule takes as long as it does, and what could slip."""

from __future__ import annotations

import itertools
from dataclasses import replace

import pytest
from hypothesis import given, settings
from tests.schedule.cells import (
    gearbox,
    gearbox_schedule,
    glued,
    glued_schedule,
    schedule,
    thesis,
    thesis_schedule,
)
from tests.strategies import cells

from tandem.cell.model import Cell
from tandem.errors import NothingFoundError
from tandem.plan.question import Question
from tandem.plan.rules import RULES
from tandem.schedule.checker import faults
from tandem.schedule.critical import critical_path, links, slack
from tandem.schedule.measures import exact, makespan
from tandem.schedule.model import Schedule


def test_the_thesis_s_critical_path_is_the_robot_s():
    path = critical_path(thesis(), thesis_schedule())
    assert [(link.assignment.task, link.reason, link.waited_for) for link in path] == [
        ("1", "start", None), ("2", "operator", "1"), ("4", "predecessor", "2"), ("6",
        "predecessor", "4"), ("7", "predecessor", "6"),
    ]  # fmt: skip
    assert str(path[1]) == "2 at 9 s, when robot is free from 1"


def test_only_what_is_off_the_critical_path_can_slip():
    assert slack(thesis(), thesis_schedule()) == {
        "1": 0,
        "2": 0,
        "3": 6,
        "4": 0,
        "5": 6,
        "6": 0,
        "7": 0,
    }


def test_a_path_can_begin_behind_a_break():
    path = critical_path(gearbox(), gearbox_schedule())
    assert [(link.assignment.task, link.reason, link.by) for link in path] == [
        ("pack", "break", "cobot")
    ]


def test_a_path_goes_through_changeovers_tools_and_zones():
    cell = Cell.model_validate({
        "operators": {"cobot": {"kind": "robot"}, "anna": {"kind": "human"}},
        "tools": {"driver": {"changeover": {"cobot": 2}}},
        "tasks": {
            "a": {"time": {"cobot": 3}, "tool": "gripper"},
            "b": {"time": {"cobot": 4}, "tool": "driver"},
            "c": {"time": {"anna": 1}, "tool": "driver", "zone": "jig"},
            "d": {"time": {"cobot": 5}, "zone": "jig"},
        },
    })  # fmt: skip
    plan = schedule(
        {
            "a": (("cobot",), 0, 3),
            "b": (("cobot",), 5, 9),
            "c": (("anna",), 9, 10),
            "d": (("cobot",), 10, 15),
        }
    )
    assert faults(cell, plan) == []
    path = critical_path(cell, plan)
    assert [(link.assignment.task, link.reason, link.by) for link in path] == [
        ("a", "start", ""), ("b", "changeover", "cobot"), ("c", "tool", "driver"), ("d", "zone",
        "jig"),
    ]  # fmt: skip
    assert slack(cell, plan) == {"a": 0, "b": 0, "c": 0, "d": 0}


def test_a_wait_and_a_follower_are_reasons_and_bound_how_far_a_task_may_slip():
    cell, plan = glued(), glued_schedule()
    path = critical_path(cell, plan)
    assert [(link.assignment.task, link.reason, link.by) for link in path] in (
        [("sort", "start", ""), ("press", "predecessor", "sort")],
        [("sort", "start", ""), ("press", "predecessor", "sort"), ("cool", "wait", "press")],
    )
    by_task = links(cell, plan)
    assert [(link.reason, link.by) for link in by_task["glue"]] == [("follower", "press")]
    assert [(link.reason, link.by) for link in by_task["cool"]] == [("wait", "press")]
    assert str(by_task["glue"][0]) == "glue at 35 s, no sooner, so that press follows in time"
    assert slack(cell, plan) == {"sort": 0, "glue": 20, "press": 0, "cool": 0}
    longer = glued_schedule(cool=(("cobot",), 106, 112))
    assert slack(cell, longer) == {"sort": 0, "glue": 22, "press": 0, "cool": 0}


def test_a_needless_wait_is_called_a_choice():
    plan = schedule({a.task: (a.operators, a.start + 1, a.end + 1) for a in thesis_schedule()})
    assert critical_path(thesis(), plan)[0].reason == "choice"


def test_an_empty_schedule_has_no_path():
    assert critical_path(thesis(), Schedule(())) == ()
    assert slack(thesis(), Schedule(())) == {}


@pytest.mark.parametrize("rule", ["longest-tail", "random"])
@settings(deadline=None, max_examples=60)
@given(cell=cells())
def test_a_path_explains_every_moment_of_a_schedule_by_rules(cell, rule):
    """Each task on it starts when what it waited for ended, it leads to the makespan, and rules
    leave no needless wait on it.
    """
    try:
        plan = RULES[rule](cell, Question("makespan"))[0].schedule
    except NothingFoundError:
        return
    path = critical_path(cell, plan)
    assert path[-1].assignment.end == makespan(plan)
    assert path[0].reason in ("start", "release", "break", "setup", "follower")
    for before, link in itertools.pairwise(path):
        assert link.waited_for == before.assignment.task
        between = link.reason in ("walk", "changeover", "preparation", "wait")
        assert between or before.assignment.end == link.assignment.start


@settings(deadline=None, max_examples=60)
@given(cell=cells())
def test_a_task_can_slip_alone_by_its_slack_when_nothing_follows_it(cell):
    try:
        plan = RULES["longest-tail"](cell, Question("makespan"))[0].schedule
    except NothingFoundError:
        return
    free = slack(cell, plan)
    assert min(free.values()) == 0
    last = {a.task: a for name in cell.operators for a in plan.of(name)[-1:]}
    for name, a in last.items():
        alone = not any(name in task.begun_first for task in cell.tasks.values()) and all(
            plan.of(who)[-1] == a for who in a.operators
        )
        if alone and not any(cell.tasks[name].tools_named()) and cell.tasks[name].zone is None:
            moved = replace(
                a,
                start=float(exact(a.start) + exact(free[name])),
                end=float(exact(a.end) + exact(free[name])),
            )
            slipped = Schedule((*(other for other in plan if other != a), moved))
            assert faults(cell, slipped) == []
            assert makespan(slipped) == makespan(plan)
