"""Exact fronts of small cells, without a constraint solver."""

from __future__ import annotations

import subprocess
import sys

import pytest
from tests.schedule.cells import THESIS, gearbox, thesis, thesis_schedule

from tandem.cell.model import Cell
from tandem.errors import InfeasibleError, NothingFoundError
from tandem.files.generators import layered
from tandem.plan.dynamic_programming import solve
from tandem.plan.method import Progress
from tandem.plan.question import Question
from tandem.plan.result import Status
from tandem.schedule.checker import faults


def test_the_thesis_s_front_is_proven():
    front = solve(thesis())
    assert front.points == [(23, 7), (24, 3), (34, 2)]
    assert front.complete
    assert {result.status for result in front} == {Status.OPTIMAL}
    assert [(result.bound.makespan, result.bound.stress) for result in front] == front.points
    assert all(faults(thesis(), result.schedule) == [] for result in front)


@pytest.mark.parametrize(
    ("question", "points"),
    [
        (Question("makespan"), [(23, 7)]),
        (Question("stress"), [(34, 2)]),
        (Question("weighted", weights=(1, 1)), [(24, 3)]),
        (Question("weighted", weights=(1, 0.2)), [(23, 7)]),
        (Question("weighted", weights=(1, 20)), [(34, 2)]),
        (Question("weighted", weights=(0, 1)), [(34, 2)]),
        (Question("weighted", weights=(1, 0)), [(23, 7)]),
        (Question(max_stress=5), [(24, 3), (34, 2)]),
        (Question(max_makespan=30), [(23, 7), (24, 3)]),
        (Question("stress", max_makespan=33.9), [(24, 3)]),
        (Question("makespan", max_stress=2.5), [(34, 2)]),
    ],
)
def test_each_question_has_its_answer(question, points):
    front = solve(thesis(), question)
    assert front.points == points
    assert front.complete


def test_what_cannot_be_is_proven_to_be_impossible():
    with pytest.raises(InfeasibleError, match=r"makespan of at most 22\.9 s: every order"):
        solve(thesis(), Question(max_makespan=22.9))
    with pytest.raises(InfeasibleError, match=r"stress of at most 1\.5"):
        solve(thesis(), Question(max_stress=1.5))
    with pytest.raises(InfeasibleError):
        solve(thesis().replace(stress_of_set={"1": 1}))


def test_a_table_of_sets_is_minimised_instead_of_the_sum():
    front = solve(thesis().replace(stress_of_set={"3": 9, "3,6": 1, "3,5,6": 4}))
    assert front.points == [(23, 4), (24, 1)]


def test_a_cell_with_a_bit_of_everything_is_planned():
    front = solve(gearbox())
    assert front.complete
    assert all(faults(gearbox(), result.schedule) == [] for result in front)
    assert front.points == sorted(front.points)
    assert all(
        one.stress > other.stress for one, other in zip(front, list(front)[1:], strict=False)
    )


def test_joint_work_can_be_the_only_way_to_the_front():
    cell = Cell.model_validate(
        {
            "operators": {"robot": {"kind": "robot"}, "human": {"kind": "human"}},
            "tasks": {
                "lift": {
                    "time": {"robot": 10},
                    "together": [{"operators": ["robot", "human"], "time": 4, "stress": 3}],
                }
            },
        }
    )
    assert solve(cell).points == [(4, 3), (10, 0)]


def test_waiting_can_be_right():
    """The human waits for the long task that only they can do, although another one is at hand."""
    tasks = {
        "quick": {"time": {"robot": 1}},
        "key": {"time": {"human": 10}, "after": ["quick"]},
        "other": {"time": {"robot": 6, "human": 5}},
    }
    cell = Cell.model_validate({"operators": THESIS["operators"], "tasks": tasks})
    assert solve(cell, Question("makespan")).points == [(11, 0)]


def test_decimals_are_exact():
    tasks = {
        "a": {"time": {"human": 0.1}, "stress": 0.1},
        "b": {"time": {"human": 0.2}, "stress": 0.2, "after": ["a"]},
    }
    cell = Cell.model_validate({"operators": THESIS["operators"], "tasks": tasks})
    assert solve(cell).points == [(0.3, 0.3)]


def test_when_time_is_up_the_bounds_hold():
    """A front cut short never claims more than the whole one shows."""
    cell = layered(10, seed=3)
    whole = solve(cell)
    assert whole.complete
    for limit in (1e-9, 0.05, 0.2):
        part = solve(cell, time_limit=limit)
        assert not part.complete or part.points == whole.points
        for result in part:
            assert result.bound.makespan <= min(
                time for time, stress in whole.points if stress <= result.stress
            )
            assert result.bound.stress <= min(
                stress for time, stress in whole.points if time <= result.makespan
            )
            assert faults(cell, result.schedule) == []


def test_when_time_is_up_without_an_answer_it_is_left_open():
    cell = layered(14, seed=5)
    least = solve(layered(14, seed=5), Question("stress"), time_limit=0.2).points[0][1]
    with pytest.raises(NothingFoundError, match="open whether there is one"):
        solve(
            cell,
            Question(
                max_makespan=5 + sum(min(task.time.values()) for task in cell.tasks.values()) / 2,
                max_stress=least,
            ),
            time_limit=1e-9,
        )


@pytest.mark.parametrize("stop_at", [1, 2, 5])
def test_it_can_be_stopped_and_gives_what_it_has(stop_at):
    """What is given when it is stopped claims no more than the whole front shows."""
    cell, seen = layered(9, seed=1), []

    def stop(progress: Progress) -> None:
        seen.append(progress)
        if len(seen) == stop_at:
            raise KeyboardInterrupt

    front, whole = solve(cell, on_solution=stop), solve(cell)
    assert front.interrupted
    assert not front.complete
    assert front.results
    for result in (*front, *(result for progress in seen for result in progress.found)):
        assert result.bound.makespan <= min(
            time for time, stress in whole.points if stress <= result.stress
        )
        assert result.bound.stress <= min(
            stress for time, stress in whole.points if time <= result.makespan
        )
        assert result.status == Status.FEASIBLE or (result.makespan, result.stress) in whole.points


def test_progress_only_gets_better():
    seen: list[Progress] = []
    front = solve(layered(9, seed=2), Question("makespan"), on_solution=seen.append)
    values = [(progress.found[0].makespan, progress.found[0].stress) for progress in seen]
    assert values == sorted(values, reverse=True)
    assert values[-1] == front.points[0]
    assert all(progress.bound <= front.points[0][0] for progress in seen)


def test_a_hint_is_where_it_begins():
    front = solve(thesis(), Question("makespan"), hint=thesis_schedule(), time_limit=1e-9)
    assert front.points == [(23, 7)]


def test_a_dozen_tasks_are_proven():
    assert solve(layered(11, seed=1)).complete


def test_it_runs_without_the_constraint_solver():
    modules = "sys, tandem.plan.dynamic_programming, tandem.plan.rules, tandem.plan.lower_bound"
    code = f"import {modules}; print(any(m.startswith('ortools') for m in sys.modules))"
    assert (
        subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=True
        ).stdout
        == "False\n"
    )
