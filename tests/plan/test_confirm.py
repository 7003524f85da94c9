"""Who proved a bound is said, and the dynamic program has a say in what CP-SAT has proven."""

from __future__ import annotations

from dataclasses import replace
from math import inf

import pytest
from tests.schedule.cells import gearbox, thesis

from tandem.cell.model import Cell
from tandem.errors import InfeasibleError, NothingFoundError
from tandem.files.validate import cell_of
from tandem.plan import confirm, methods
from tandem.plan.archive import Archive
from tandem.plan.bounds import closed_forms, least_makespan
from tandem.plan.confirm import confirm_none, opinion
from tandem.plan.door import RefusedScheduleWarning
from tandem.plan.goal import Goal
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout
from tandem.plan.method import Method
from tandem.plan.methods import METHODS, plan
from tandem.plan.provers import Prover, Step, rising
from tandem.plan.question import Question
from tandem.plan.result import Front, Outcome, Status
from tandem.schedule.model import Schedule


def one_robot(tasks: int) -> Cell:
    """Tasks of 2 s that one robot does one after the other."""
    return cell_of(
        {
            "operators": {"arm": {"kind": "robot"}},
            "tasks": {f"t{number}": {"time": {"arm": 2}} for number in range(tasks)},
        }
    )


def test_on_the_cell_of_the_thesis_each_bound_says_whose_it_is() -> None:
    front = plan(thesis(), workers=1)
    both = Prover.CONFIRMED
    assert [result.bound.proved_by for result in front] == [
        (both, both),
        (both, both),
        (both, Prover.LEAST_STRESS),
    ]
    point = front.to_dict()["front"][2]
    assert point["bound"] == {"makespan": 34, "stress": 2}
    assert point["proved_by"] == {
        "makespan": "cp-sat, confirmed by dynamic programming",
        "stress": "least stress",
    }
    assert front.to_dict()["confirmation"] == {
        "by": "dynamic programming",
        "outcome": "confirmed",
        "states": 32,
    }


def test_without_confirmation_cp_sat_stands_alone() -> None:
    front = plan(thesis(), workers=1, confirm=False)
    assert front.confirmation is None
    assert front[0].bound.proved_by == (Prover.CP_SAT, Prover.CP_SAT)


def test_what_can_be_reckoned_is_not_laid_to_cp_sat() -> None:
    """Six tasks of 2 s and one robot: 12 s of work, and no human whose stress would count."""
    (point,) = plan(one_robot(6), workers=1)
    assert point.bound.proved_by == (Prover.LOAD, Prover.LEAST_STRESS)


@pytest.mark.parametrize("minimize", ["makespan", "stress", "weighted"])
def test_single_answers_say_so_too(minimize: str) -> None:
    front = plan(thesis(), workers=1, minimize=minimize)
    assert front.confirmation is not None
    assert front.confirmation.outcome == Outcome.AGREES
    assert front[0].bound.proved_by is not None
    assert Prover.CP_SAT not in front[0].bound.proved_by


def test_the_exhaustive_search_and_the_rules_name_themselves() -> None:
    (first, *_) = METHODS["exhaustive"](thesis())
    assert first.bound.proved_by == (Prover.DYNAMIC, Prover.DYNAMIC)
    (by_rule, *_) = METHODS["longest-tail"](thesis())
    assert by_rule.bound.proved_by == (Prover.SHARED, Prover.LEAST_STRESS)


def test_closed_forms_are_the_parts_of_the_least_makespan() -> None:
    for cell in (thesis(), gearbox(), one_robot(3)):
        layout = Layout.of(Instance.of(cell))
        steps = closed_forms(layout)
        assert steps[-1].value == least_makespan(layout)
        assert [step.value for step in steps] == sorted({step.value for step in steps})


def test_an_archive_names_the_first_prover_of_equal_bounds_and_keeps_what_others_gave() -> None:
    archive = Archive(thesis(), Layout.of(Instance.of(thesis())), Goal(1, 0))
    assert archive.prover_of(inf) == Prover.CHAIN
    archive.learn(inf, 16, Prover.CP_SAT)  # the chain says as much
    assert archive.prover_of(inf) == Prover.CHAIN
    archive.learn(inf, 20, Prover.ALLOCATION)
    archive.learn(5, 24, Prover.CP_SAT)
    times, _ = archive.steps((25, 3))
    assert times == (
        Step(16, Prover.CHAIN),
        Step(20, Prover.ALLOCATION),
        Step(24, Prover.CP_SAT),
    )
    assert archive.steps((25, 6))[0][-1] == Step(20, Prover.ALLOCATION)


def test_of_equal_steps_the_one_that_needs_least_stands() -> None:
    steps = [Step(7, Prover.CP_SAT), Step(7, Prover.CHAIN), Step(3, Prover.LOAD)]
    assert rising(steps) == (Step(3, Prover.LOAD), Step(7, Prover.CHAIN))


def without_its_best_point(front: Front) -> Front:
    """The front as a solver would give it that has wrongly ruled out the quickest point."""
    return replace(front, results=front.results[1:])


def test_a_proof_that_the_dynamic_program_contradicts_is_none(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    exact: Method = METHODS["exact"].solve

    def wrong(*arguments: object, **options: object) -> Front:
        return without_its_best_point(exact(*arguments, **options))  # type: ignore[arg-type]

    monkeypatch.setattr(
        methods, "METHODS", {**METHODS, "exact": replace(METHODS["exact"], solve=wrong)}
    )
    with pytest.warns(RefusedScheduleWarning, match="two proofs contradict each other"):
        front = plan(thesis(), workers=1)
    assert not front.complete
    assert front.confirmation is not None
    assert front.confirmation.outcome == Outcome.DISAGREES
    assert {result.status for result in front} == {Status.FEASIBLE}
    assert front[0].bound.makespan == 18


def test_an_infeasibility_that_the_dynamic_program_contradicts_is_none(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def wrong(*arguments: object, **options: object) -> Front:
        raise InfeasibleError("no schedule keeps the cell's own limits; this is proven.")

    monkeypatch.setattr(
        methods, "METHODS", {**METHODS, "exact": replace(METHODS["exact"], solve=wrong)}
    )
    with pytest.raises(NothingFoundError, match="two proofs contradict each other"):
        plan(thesis(), workers=1)


def test_an_infeasibility_is_confirmed() -> None:
    said = confirm_none(thesis(), Question(max_makespan=22), None)
    assert said.outcome == Outcome.AGREES


def test_a_cell_with_too_many_states_is_said_not_to_be_confirmed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Twelve tasks alike but for their times, for four people whose stress differs."""
    people = [f"p{number}" for number in range(4)]
    cell = cell_of(
        {
            "operators": {name: {"kind": "human"} for name in people},
            "tasks": {
                f"t{n}": {
                    "time": {name: 20 + (7 * n + 5 * k) % 13 for k, name in enumerate(people)},
                    "stress": {name: 10 + (5 * n + 3 * k) % 11 for k, name in enumerate(people)},
                }
                for n in range(12)
            },
        }
    )
    monkeypatch.setattr(confirm, "MOST_STATES", 400)
    nothing: tuple[Schedule, ...] = ()
    said = opinion(cell, Question(max_stress=150), nothing, None)
    assert said.confirmation.outcome == Outcome.OPEN
    assert said.confirmation.states == 400


def test_larger_cells_are_not_asked() -> None:
    assert plan(one_robot(13), workers=1).confirmation is None
    assert methods.is_asked(one_robot(12), Question())
