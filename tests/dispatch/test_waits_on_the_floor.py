"""Waits on the floor: what may begin, who is told when, and what comes of it beside people."""

from __future__ import annotations

import json
from typing import Any

import pytest
from tests.dispatch.cells import line
from tests.dispatch.test_forecast import ahead
from tests.dispatch.test_situation import done, reached, started
from tests.schedule.cells import GLUED, glued

from tandem.cell.model import Cell
from tandem.dispatch.deciders.beliefs import position, start_by
from tandem.dispatch.deciders.fixed import Fixed, fixed
from tandem.dispatch.deciders.policy import Options
from tandem.dispatch.deciders.table import policy
from tandem.dispatch.journal import Journal
from tandem.dispatch.lookahead.objective import SECONDS
from tandem.dispatch.lookahead.residual import rest
from tandem.dispatch.lookahead.transitions import Moves
from tandem.dispatch.shift.deadline import InTime
from tandem.dispatch.shift.live import Settings, Shift
from tandem.dispatch.shift.simulated import SimulatedFloor
from tandem.dispatch.situation.events import read_event
from tandem.dispatch.situation.legal import legal, next_change
from tandem.dispatch.situation.objections import remarks
from tandem.files.validate import cell_of
from tandem.schedule.checker import faults
from tandem.schedule.model import Assignment, Schedule

SORTED = (started(0, "sort", "anna"), done(20, "sort"))
QUICK = {**GLUED["tasks"], "sort": {"time": {"anna": 20}}}
"""Anna is free long before the glue has cured."""


def worked(cell: Cell, name: str, people: str = "compliant") -> Schedule:
    """What the decider makes of one product beside these people."""
    decider = InTime(
        policy(name, cell, SECONDS, Options()), policy("spt", cell, SECONDS, Options()), 1e6
    )
    with Journal() as journal:
        shift = Shift.open(cell, journal, Settings(), decider=decider)
        floor = SimulatedFloor(cell, people)
        while (event := floor.next(shift.situation, shift.decision["look_again"])) is not None:
            list(shift.take(json.dumps(event.to_dict())))
        assert shift.situation.is_over
        works = shift.situation.done.values()
        return Schedule(tuple(Assignment(w.start, w.end, w.task, w.operators) for w in works))


def test_a_task_may_begin_when_its_wait_is_over() -> None:
    cell = glued(tasks=QUICK)
    glue = (*SORTED[:1], started(0, "glue", "cobot"), done(5, "glue"))
    early = reached(*glue, done(20, "sort"), cell=cell)
    assert (legal(early), next_change(early)) == ([], 45)
    odd = remarks(early, read_event(started(21, "press", "anna"), cell))
    assert odd == ["task 'press' waits until 45 s, 40 s after task 'glue' ended."]
    over = reached(*glue, done(20, "sort"), line("tick", 45), cell=cell)
    assert legal(over) == [("press", ("anna",))]
    begun = reached(*glue, done(20, "sort"), started(45, "press", "anna"), cell=cell)
    assert (legal(begun), next_change(begun)) == ([], 49)
    cooling = reached(
        *glue, done(20, "sort"), started(45, "press", "anna"), line("tick", 49), cell=cell
    )
    assert legal(cooling) == [("cool", ("cobot",))]


def test_a_wait_from_a_start_counts_behind_the_changeover() -> None:
    """The cobot takes up the driver until 3 s; the test may begin 2 s later."""
    cell = cell_of(
        {
            "operators": {"cobot": {"kind": "robot", "tool": "gripper"}, "anna": {"kind": "human"}},
            "tools": {"driver": {"changeover": {"cobot": 3}}, "gripper": {}},
            "tasks": {
                "screw": {"time": {"cobot": 6}, "tool": "driver"},
                "watch": {
                    "time": {"anna": 1},
                    "wait": {"after": "screw", "between": "start-start", "at_least": 2},
                },
            },
        }
    )
    situation = reached(started(0, "screw", "cobot"), cell=cell)
    assert next_change(situation) == 5
    moves = Moves.of(cell)
    assert moves.next_event(position(moves, situation, {})) == 5 * moves.instance.per_second
    assert moves.next_event(moves.begin(moves.root(), 0)) == 5 * moves.instance.per_second


def test_the_forecast_waits_too() -> None:
    """Pressed from 45 to 55 s, cooled from 49 to 55 s; and the same when the glue is on."""
    cell = glued(tasks=QUICK)
    assert ahead(reached(cell=cell))["plan"] == 55
    glue = (started(0, "sort", "anna"), started(0, "glue", "cobot"), done(5, "glue"))
    assert ahead(reached(*glue, cell=cell))["plan"] == 55
    pressed = (*glue, done(20, "sort"), started(47, "press", "anna"))
    assert ahead(reached(*pressed, cell=cell))["plan"] == 57


def test_what_must_start_in_time_is_due_and_a_plan_of_the_rest_knows_it() -> None:
    cell = glued(tasks=QUICK)
    situation = reached(
        started(0, "glue", "cobot"), started(0, "sort", "anna"), done(5, "glue"), cell=cell
    )
    moves = Moves.of(cell)
    second = moves.instance.per_second
    here = position(moves, situation, {})
    assert start_by(moves.instance, situation) == {2: 60 * second}
    assert here.waits == ((0, 40 * second),)
    left = rest(moves, here, due=start_by(moves.instance, situation))
    assert left is not None
    names = [moves.instance.tasks[task] for task in left.tasks]
    assert dict(zip(names, left.instance.release, strict=True))["press"] == 40 * second
    assert dict(zip(names, left.instance.deadline, strict=True))["press"] == 70 * second
    late = rest(moves, here)
    assert late is not None
    assert dict(zip(names, late.instance.deadline, strict=True))["press"] is None


@pytest.mark.parametrize(
    ("name", "most"), [("fixed", 110), ("replan", 110), ("replan-robust", 140)]
)
def test_who_plans_puts_the_glue_off_until_it_can_be_pressed_in_time(name: str, most: int) -> None:
    """The robust one puts it off further, for Anna may be slower than stated."""
    schedule = worked(glued(), name)
    assert faults(glued(), schedule) == []
    assert max(a.end for a in schedule) <= most


def test_a_rule_begins_the_glue_at_once_and_late_is_better_than_never() -> None:
    """As it is with deadlines: nobody is kept from beginning what is too late."""
    [fault] = faults(glued(), worked(glued(), "longest-tail"))
    assert "'press': starts at 100 s, 95 s after task 'glue' has ended" in fault


def test_who_plans_anew_puts_the_glue_off_further_for_a_slow_person() -> None:
    """Unpacked at 60 s instead of 30 s, it is due at 95 s by the stated times; Anna has shown that
    she is slower.
    """
    tasks: dict[str, Any] = {
        **GLUED["tasks"],
        "unpack": {"time": {"anna": 30}},
        "sort": {"time": {"anna": 100}, "after": ["unpack"]},
    }
    plain = {a.task: a.start for a in worked(glued(tasks=tasks), "replan", "pace:2")}
    robust = {a.task: a.start for a in worked(glued(tasks=tasks), "replan-robust", "pace:2")}
    assert plain["press"] == robust["press"] == 260
    assert (plain["glue"], robust["glue"] > 130) == (95, True)


def test_a_plan_holds_back_what_must_be_followed_in_time() -> None:
    decider = fixed(glued(), SECONDS, Options())
    assert isinstance(decider, Fixed)
    first = decider.decide(reached(cell=glued()))
    assert first.starts == ()
    assert first.announced == {"anna": "sort"}
    assert first.look_again == 35
    due = decider.decide(reached(started(0, "sort", "anna"), line("tick", 35), cell=glued()))
    assert due.starts == (("glue", ("cobot",)),)
