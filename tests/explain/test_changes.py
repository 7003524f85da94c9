"""What changed: cells key by key, schedules task by task, fronts point by point."""

from __future__ import annotations

import itertools

import pytest

from tandem.cell.model import Cell
from tandem.explain.compare import compare_cells, compare_schedules
from tandem.explain.fronts import area, changes, reference
from tandem.explain.variant import variant
from tandem.plan.methods import METHODS, plan
from tandem.plan.question import Question


def test_same_cells_differ_in_nothing(thesis: Cell) -> None:
    assert compare_cells(thesis, thesis) == ()


def test_changed_cells(thesis: Cell) -> None:
    other = variant(
        thesis,
        [
            "tasks.6.time.robot=8",
            "tasks.4.after=[1]",
            "tasks.4.time.human=3",
            "tasks.2.stress=12",
            "operators.human.label=Eva",
        ],
        force=["5=human"],
    )
    assert [str(change) for change in compare_cells(thesis, other)] == [
        "operator human: label is 'Eva' instead of nothing",
        "task 2: stress is 12 instead of 11",
        "task 4: human can do it now, in 3 s",
        "task 4: no longer waits for 2",
        "task 5: robot can no longer do it (took 4 s)",
        "task 6: robot takes 8 s instead of 10 s",
    ]


def test_tasks_that_come_and_go(thesis: Cell) -> None:
    tasks = thesis.to_dict()["tasks"]
    del tasks["7"]
    other = thesis.replace(tasks={**tasks, "8": {"time": {"robot": 3}}})
    assert [str(change) for change in compare_cells(thesis, other)] == [
        "task 7: gone",
        "task 8: new (robot 3 s)",
    ]


def test_schedules_task_by_task(thesis: Cell) -> None:
    front = plan(thesis)
    moves = compare_schedules(front[0].schedule, front[1].schedule)
    assert {move.task for move in moves} == set(thesis.tasks)
    five = next(move for move in moves if move.task == "5")
    assert five.other_operators
    assert five.changed
    assert str(five).startswith("task 5: human -> robot, ")
    assert not any(move.changed for move in compare_schedules(front[0].schedule, front[0].schedule))


def test_what_becomes_of_each_point(thesis: Cell) -> None:
    """The numbers follow from the two fronts, which dynamic programming confirms."""
    other = variant(thesis, ["tasks.6.time.robot=8"], force=["5=human"])
    base, then = plan(thesis), METHODS["exhaustive"](other, Question())
    assert [(c.makespan, c.makespan_then, c.stress_then) for c in changes(base, plan(other))] == [
        (
            time,
            min((t for t, s in then.points if s <= load), default=None),
            min((s for t, s in then.points if t <= time), default=None),
        )
        for time, load in base.points
    ]
    assert [(c.seconds, c.more_stress) for c in changes(base, base)] == [(0, 0)] * 3


def test_area_counts_what_the_points_dominate() -> None:
    points = [(2.0, 5.0), (4.0, 1.0), (5.0, 3.0)]
    by_hand = sum(
        1
        for x, y in itertools.product(range(10), repeat=2)
        if any(t <= x and s <= y for t, s in points)
    )
    assert area(points, (10.0, 10.0)) == by_hand
    assert area([(11.0, 0.0)], (10.0, 10.0)) == 0
    assert reference([(23, 7), (34, 2)]) == pytest.approx((37.4, 8.0))
