"""Exact values: known numbers, order of moves, and two searches that must agree."""

from __future__ import annotations

from itertools import pairwise

import pytest
from tests.dispatch.stations import THESIS, station

from tandem.cell.model import Cell
from tandem.dispatch.lookahead.bayes_adaptive import bayes_adaptive, belief_values
from tandem.dispatch.lookahead.branch_and_bound import BranchAndBound
from tandem.dispatch.lookahead.dynamic_programming import Human, expected, minimax, values
from tandem.dispatch.lookahead.mistakes import repair_values
from tandem.dispatch.lookahead.objective import Objective
from tandem.dispatch.lookahead.transitions import Moves, Position
from tandem.errors import CellError, NothingFoundError
from tandem.files.generators import layered
from tandem.files.validate import cell_of
from tandem.plan.dynamic_programming import solve
from tandem.plan.question import Question

PRIOR = {0.6: 0.2, 1.0: 0.2, 1.5: 0.2, 2.0: 0.2, 3.0: 0.2}


@pytest.mark.parametrize(
    ("random", "makespan"), [(0.0, 23.0), (0.1, 23 + 7 / 30), (0.5, 24 + 1 / 6), (1.0, 25 + 1 / 3)]
)
def test_the_thesis_cell_beside_a_human_who_picks_at_random(random: float, makespan: float) -> None:
    """The values that a prototype found: the human moves first, and the robot sees what it does."""
    assert expected(THESIS, random=random) == pytest.approx(makespan, abs=1e-9)


def test_a_hostile_human_costs_more_than_a_random_one() -> None:
    assert minimax(THESIS) > expected(THESIS, random=1.0) > expected(THESIS)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("objective", [Objective(), Objective(1.0, 0.5), Objective(0.0, 1.0)])
def test_a_compliant_human_leaves_the_planners_optimum(seed: int, objective: Objective) -> None:
    """Value function, branch and bound, and the planner's exhaustive search are three different
    programs.
    """
    cell = layered(7, seed=seed)
    found = values(cell, objective=objective)
    value = found.value(found.moves.root())
    planned = solve(cell, Question(minimize="weighted", weights=(objective.time, objective.stress)))
    assert value == pytest.approx(objective.cost(planned[0].makespan, planned[0].stress))
    assert BranchAndBound(found.moves, found.weights).value(found.moves.root()) == pytest.approx(
        value
    )


@pytest.mark.parametrize(
    "cell",
    [station(), station(together=True), station(zone=True), station(limit=True)],
    ids=["plain", "joint", "zone", "limit"],
)
def test_the_features_of_a_cell_are_held(cell: Cell) -> None:
    found = values(cell)
    assert found.value(found.moves.root()) == pytest.approx(
        solve(cell, Question(minimize="makespan"))[0].makespan
    )


def test_more_randomness_is_never_better() -> None:
    cell = layered(7, seed=3)
    found = [expected(cell, random=share) for share in (0.0, 0.25, 0.5, 0.75, 1.0)]
    assert all(one <= other + 1e-9 for one, other in pairwise(found))


def test_a_human_with_an_own_order_is_answered_as_well_as_possible() -> None:
    """Who always takes task 1 first, whatever is asked: better than one who may pick anything,
    worse than one who complies.
    """
    found = values(
        THESIS,
        Human(
            taste=tuple(10.0 if way in (1,) else 0.0 for way in range(12)), follows=0.0, obeys=False
        ),
    )
    assert expected(THESIS) <= found.value(found.moves.root()) <= minimax(THESIS)


def test_not_knowing_the_pace_costs_and_looking_in_between_helps() -> None:
    """Who knows the pace is best; who may look at moments without an event is better than who waits
    for events.
    """
    knowing = sum(share * expected(THESIS, pace={"human": pace}) for pace, share in PRIOR.items())
    looking, waiting = bayes_adaptive(THESIS, PRIOR, watches=True), bayes_adaptive(THESIS, PRIOR)
    assert knowing == pytest.approx(25.46)
    assert looking == pytest.approx(25.62)
    assert waiting == pytest.approx(26.02)


def test_the_policy_behind_the_value_takes_what_it_promises() -> None:
    """Carried out under each hypothesis, weighed by the prior; and nobody who knows the pace is
    slower.
    """
    found = belief_values(THESIS, PRIOR, watches=True)
    played = [found.played(number) for number in range(len(PRIOR))]
    assert sum(
        share * cost for share, cost in zip(PRIOR.values(), played, strict=True)
    ) == pytest.approx(found.value(found.root()))
    assert all(
        cost >= expected(THESIS, pace={"human": pace}) - 1e-9
        for pace, cost in zip(PRIOR, played, strict=True)
    )


def test_a_prior_that_is_sure_leaves_nothing_to_learn() -> None:
    assert bayes_adaptive(THESIS, {1.5: 1.0, 3.0: 0.0}) == pytest.approx(
        expected(THESIS, pace={"human": 1.5})
    )
    found = belief_values(THESIS, {1.0: 1.0})
    assert len(found.root()) == 1


def test_cells_that_cannot_be_valued_are_refused_by_name() -> None:
    tools = cell_of(
        {
            "operators": {"robot": {"kind": "robot"}},
            "tasks": {
                "a": {"time": {"robot": 1.0}, "tool": "x"},
                "b": {"time": {"robot": 1.0}, "tool": "y"},
            },
            "tools": {"x": {"changeover": {"robot": 1.0}}},
        }
    )
    with pytest.raises(CellError, match="changeovers"):
        values(tools)
    table = cell_of(
        {
            "operators": {"h": {"kind": "human"}},
            "tasks": {"a": {"time": {"h": 1.0}}},
            "stress_of_set": {"a": 1.0},
        }
    )
    with pytest.raises(CellError, match="stress_of_set"):
        values(table)
    with pytest.raises(CellError, match="replan"):
        values(THESIS, objective=Objective(max_stress=5.0))
    few = values(THESIS, most=10)
    with pytest.raises(NothingFoundError, match="10 positions"):
        few.value(few.moves.root())


@pytest.fixture(scope="module")
def erring() -> tuple[Moves, list[Position]]:
    """A small cell, and all positions that can be reached when the human errs."""
    found = repair_values(station(), 0.3, taking_apart=0.5)
    found.prepare(found.moves.root())
    return found.moves, list(found.known)


def test_every_wrong_state_is_repaired_as_quickly_as_value_iteration_says(
    erring: tuple[Moves, list[Position]],
) -> None:
    """From each, with no further mistake: what branch and bound (the re-planning decider's search)
    takes, sweeps over all positions take too.
    """
    moves, positions = erring
    wrong = [position for position in positions if position.wrong]
    assert len(wrong) > 20
    search, sweeps = (
        BranchAndBound(moves, (1 / moves.instance.per_second, 0.0)),
        repair_values(station(), 0.0, taking_apart=0.5),
    )
    for position in wrong:
        sweeps.prepare(position)
        assert search.value(position) == pytest.approx(sweeps.value(position))
        here = position
        while not moves.is_over(here):  # and the repair gets it done
            chosen, _ = search.best(here)
            for way in chosen:
                here = moves.begin(here, way)
            here = moves.after(here, moves.next_event(here) or 0)


def test_mistakes_cost_what_a_geometric_series_says() -> None:
    """One task, one human, always noticed: T, and with probability q once more taking apart (T/2)
    and doing it again, and so on.
    """
    cell = cell_of({"operators": {"h": {"kind": "human"}}, "tasks": {"a": {"time": {"h": 4.0}}}})
    found = repair_values(cell, 0.25, taking_apart=0.5)
    found.prepare(found.moves.root())
    assert found.value(found.moves.root()) == pytest.approx(4 + 0.25 / 0.75 * 6)
