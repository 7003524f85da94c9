"""Values before proofs: what the checker has not accepted is no incumbent, no bound and no proof,
whoever found it.
"""

from __future__ import annotations

import warnings

import pytest
from tests.plan.test_deadlines import FRONTS
from tests.schedule.cells import gearbox, thesis, thesis_schedule

import tandem
from tandem.errors import NothingFoundError
from tandem.files.generators import layered
from tandem.plan import cpsat
from tandem.plan.chronological import Branching
from tandem.plan.door import Door, RefusedScheduleWarning
from tandem.plan.instance import Instance
from tandem.plan.methods import plan
from tandem.plan.question import Question
from tandem.schedule.checker import faults
from tandem.schedule.model import Schedule


def door(cell=None, question: Question = Question()) -> Door:
    cell = cell or thesis()
    return Door(cell, Instance.of(cell), question)


def test_a_sound_schedule_comes_in_with_its_worth():
    admitted = door().hinted(thesis_schedule())
    assert admitted is not None
    assert admitted.point == (23, 7)
    assert set(admitted.schedule) == set(thesis_schedule())


@pytest.mark.parametrize("limits", [{"max_makespan": 22.9}, {"max_stress": 6.5}])
def test_a_schedule_over_a_limit_of_the_question_stays_outside(limits):
    assert door(question=Question(**limits)).hinted(thesis_schedule()) is None


def test_a_schedule_that_breaks_the_cell_stays_outside_and_is_remembered_when_vouched_for():
    entrance = door()
    starts = [
        (way, start - (task == 3))
        for task, (way, start) in enumerate(entrance.instance.starts(thesis_schedule()))
    ]
    assert faults(thesis(), entrance.instance.schedule(starts))
    assert entrance.admit(starts) is None
    assert entrance.refused == ()
    assert entrance.vouched(starts) is None
    assert "task" in entrance.apology()


def left_out(rule: cpsat.Rule) -> tuple[cpsat.Rule, ...]:
    return tuple(other for other in cpsat.RULES if other is not rule)


ONE_FOR_BOTH = tandem.load(
    {
        "format": 1,
        "operators": {"left": {"kind": "robot"}, "right": {"kind": "robot"}},
        "tasks": {
            "hold": {"time": {"left": 5, "right": 5}},
            "screw": {"time": {"left": 5, "right": 5}},
        },
        "same_operator": [["hold", "screw"]],
    }
)
"""Takes 10 s, and half of that where each does one."""
CELLS = [thesis(), gearbox(), ONE_FOR_BOTH, *(of for of, _ in FRONTS)]
QUESTIONS = [Question(minimize) for minimize in ("front", "makespan", "stress", "weighted")]


@pytest.mark.parametrize(
    "rule",
    [
        cpsat.deadlines_are_kept,
        cpsat.predecessors_end_first,
        cpsat.an_operator_does_one_thing_at_a_time,
        cpsat.a_zone_holds_as_many_as_it_has_places,
        cpsat.some_tasks_have_the_same_operators,
    ],
)
def test_a_model_that_lacks_a_rule_proves_nothing_wrong(monkeypatch, rule):
    """The solver then finds schedules that the cell does not allow; what it makes of them may not
    be told as the truth.
    """
    refused = 0
    for cell in CELLS:
        for question in QUESTIONS:
            right = plan(cell, question, method="exhaustive").points
            with monkeypatch.context() as patch, warnings.catch_warnings(record=True) as said:
                patch.setattr(cpsat, "RULES", left_out(rule))
                warnings.simplefilter("always")
                try:
                    front = plan(cell, question, workers=1)
                except NothingFoundError:
                    refused += 1
                    continue
            refused += len(said)
            assert front.complete == (not said)
            assert not front.complete or front.points == right
            assert all(faults(cell, result.schedule) == [] for result in front)
    assert refused  # or this test would show nothing


def test_where_nothing_but_unsound_schedules_was_found_it_is_said_and_left_open(monkeypatch):
    monkeypatch.setattr(cpsat, "RULES", left_out(cpsat.deadlines_are_kept))
    with pytest.raises(
        NothingFoundError, match=r"the checker refused .* 't2': ends at .*This is a bug in Tandem"
    ):
        plan(FRONTS[1][0], minimize="makespan", workers=1)


def test_exhaustive_search_is_not_believed_either(monkeypatch):
    """Its moves are made to forget that operators are busy."""
    monkeypatch.setattr(Branching, "_start", lambda self, node, task, step, ready: ready)
    with pytest.warns(RefusedScheduleWarning):
        front = plan(thesis(), method="exhaustive")
    assert not front.complete
    assert all(faults(thesis(), result.schedule) == [] for result in front)
    assert all(result.status == "feasible" for result in front)


def test_a_hint_between_two_ticks_is_cut_down_to_them():
    late = Schedule(
        tuple(type(a)(a.start + 0.5, a.end + 0.5, a.task, a.operators) for a in thesis_schedule())
    )
    admitted = door().hinted(late)
    assert admitted is not None
    assert admitted.point == (23, 7)


@pytest.mark.parametrize("workers", [1, 2])
def test_larger_cells_are_improved_by_sound_schedules_alone(workers):
    seen = []
    cell = layered(40, 2, 1, seed=7)
    plan(cell, minimize="makespan", time_limit=2, workers=workers, on_solution=seen.append)
    assert seen
    assert all(
        faults(cell, result.schedule) == [] for progress in seen for result in progress.found
    )


def test_a_wrong_model_does_not_keep_a_search_without_limit_going(monkeypatch):
    """More tasks than CP-SAT takes alone; its model lacks precedence, without which a second less
    is possible, so it never proves anything.
    """
    monkeypatch.setattr(cpsat, "RULES", left_out(cpsat.predecessors_end_first))
    cell = layered(31, 1, 1, seed=2)
    with pytest.warns(RefusedScheduleWarning):
        front = plan(cell, minimize="makespan", workers=2, time_limit=None)
    assert not front.complete
    assert faults(cell, front[0].schedule) == []
