"""What comes of a task that is put elsewhere, by hand-made cells whose answer a person can see."""

from __future__ import annotations

import pytest

import tandem
from tandem.schedule.placed import ALONE, place

CELL = tandem.Cell.model_validate(
    {
        "operators": {
            "ann": {"kind": "human", "breaks": [[20, 30]]},
            "bob": {"kind": "human"},
            "arm": {"kind": "robot", "setup": 2},
        },
        "tasks": {
            "cut": {"time": {"ann": 4, "arm": 6}, "stress": 3},
            "glue": {"time": {"ann": 5, "bob": 7}, "stress": 2, "after": ["cut"], "release": 4},
            "lift": {"together": [{"operators": ["ann", "bob"], "time": 3}], "deadline": 40},
        },
    }
)
PLAN = tandem.Schedule.from_list(
    [
        {"task": "cut", "operators": ["ann"], "start": 0, "end": 4},
        {"task": "glue", "operators": ["ann"], "start": 4, "end": 9},
        {"task": "lift", "operators": ["ann", "bob"], "start": 9, "end": 12},
    ]
)


def test_the_plan_is_sound():
    assert tandem.faults(CELL, PLAN) == []


def test_a_task_takes_the_time_of_who_does_it_there():
    found = place(CELL, PLAN, "glue", ["bob"], 12)
    (row,) = found.schedule.of("bob")[1:]
    assert (row.task, row.start, row.end) == ("glue", 12, 19)
    assert (found.allowed, found.reasons, found.faults) == (True, (), ())
    assert (found.makespan, found.stress) == (19, 5)
    # nothing else has moved
    assert {a for a in found.schedule if a.task != "glue"} == {a for a in PLAN if a.task != "glue"}


def test_who_is_in_the_way_is_a_fault_and_no_reason():
    found = place(CELL, PLAN, "glue", ["bob"], 6)
    assert found.allowed
    assert any("operator 'bob'" in fault for fault in found.faults)
    assert found.faults == tuple(tandem.faults(CELL, found.schedule))


@pytest.mark.parametrize(
    ("task", "operators", "start", "says"),
    [
        ("glue", ["arm"], 4, "arm cannot do it"),
        ("lift", ["ann"], 9, "ann cannot do it"),
        ("cut", ["nobody"], 0, "no operator 'nobody'"),
        ("glue", ["ann"], 3, "before its release"),
        ("lift", ["ann", "bob"], 38, "after its deadline"),
        ("cut", ["ann"], 18, "runs into the break"),
        ("cut", ["arm"], 1, "before it is set up"),
        ("cut", ["bob", "ann"], -1, "nothing can start before 0 s"),
        ("cut", ["ann"], float("nan"), "is no time"),
    ],
)
def test_what_no_other_task_can_mend_is_a_reason(task, operators, start, says):
    found = place(CELL, PLAN, task, operators, start)
    assert not found.allowed
    assert says in " ".join(found.reasons)
    assert set(found.reasons) <= set(found.faults)


def test_every_way_is_told():
    ways = place(CELL, PLAN, "lift", ["ann", "bob"], 9).ways
    assert [(way.operators, way.time) for way in ways] == [(("ann", "bob"), 3)]


def test_a_task_that_is_not_there_is_refused_with_the_nearest():
    with pytest.raises(tandem.UsageError, match=r"'glu'.*'glue'"):
        place(CELL, PLAN, "glu", ["ann"], 0)
    with pytest.raises(tandem.UsageError, match="the schedule has no task 'cut'"):
        place(CELL, tandem.Schedule(PLAN.assignments[1:]), "cut", ["ann"], 0)


def test_the_rules_that_stand_alone_are_rules_of_the_checker():
    from tandem.schedule.checker import RULES

    assert set(ALONE) < set(RULES)
