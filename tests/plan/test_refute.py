"""Proofs of makespans by search along the clock."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.boards import OPTIMA
from tests.schedule.cells import thesis
from tests.strategies import cells

from tandem.errors import InfeasibleError
from tandem.lab.yu2020.board import desk, random_board
from tandem.plan.dynamic_programming import solve
from tandem.plan.instance import Instance
from tandem.plan.lower_bound import prove_makespan
from tandem.plan.question import Question
from tandem.plan.rules import RULES
from tandem.schedule.checker import faults
from tandem.schedule.measures import exact, makespan, stress


def test_the_desk_takes_94_and_that_is_proven_in_seconds():
    """Yu et al. (2020), 53 tasks; a rule's schedule of 95 or more is where it begins."""
    cell = desk().to_cell()
    instance = Instance.of(cell)
    start = RULES["best-of-n"](cell, Question("makespan"))[0].makespan
    proof = prove_makespan(instance, int(start), 60)
    assert (proof.bound, proof.upper) == (94, 94)
    assert start == 94 or faults(cell, instance.schedule(proof.starts)) == []
    assert proof.nodes < 12_000  # partial schedules, which take two seconds


@pytest.mark.parametrize("seed", range(0, 20, 4))
def test_yu_s_random_boards_are_proven(seed):
    cell = random_board(seed=seed).to_cell()
    proof = prove_makespan(
        Instance.of(cell), int(RULES["balanced"](cell, Question("makespan"))[0].makespan), 60
    )
    assert proof.bound == proof.upper == OPTIMA[seed]


def test_the_thesis_needs_23_s_and_more_with_less_stress():
    instance = Instance.of(thesis())
    assert prove_makespan(instance, 40, 10).bound == 23
    assert prove_makespan(instance, 40, 10, most_units=6).bound == 24
    assert prove_makespan(instance, 40, 10, most_units=2).bound == 34
    assert prove_makespan(instance, 40, 10, most_units=1).bound == 40


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(cells(max_tasks=6, rich=False), st.floats(0, 1))
def test_it_agrees_with_exhaustive_search(cell, share):
    front, instance = solve(cell).points, Instance.of(cell)
    limit = front[-1][1] + share * (front[0][1] - front[-1][1])
    best = min(time for time, load in front if load <= limit) * instance.per_second
    proof = prove_makespan(
        instance, instance.horizon + 1, 30, most_units=int(exact(limit) * instance.per_stress)
    )
    assert proof.bound == proof.upper == best
    found = instance.schedule(proof.starts)
    assert faults(cell, found) == []
    assert makespan(found) * instance.per_second == best
    assert stress(cell, found) <= limit


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(cells(max_tasks=5))
def test_what_it_refutes_is_refuted_for_cells_with_every_feature(cell):
    instance = Instance.of(cell)
    try:
        best = solve(cell, Question("makespan")).points[0][0] * instance.per_second
    except InfeasibleError:
        best = instance.horizon + 1
    assert prove_makespan(instance, instance.horizon + 1, 30).bound <= best


def test_it_keeps_to_its_time_and_says_what_it_knows():
    cell = random_board(seed=3).to_cell()
    proof = prove_makespan(Instance.of(cell), 158, 0.1)
    assert proof.bound <= 158 == proof.upper
    assert proof.starts is None
    assert prove_makespan(Instance.of(cell), 158, 60, stop=lambda: True).nodes == 0
