"""The fixed plan carried out: beside people who comply, at stated times, it takes what was
planned.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from tests.dispatch.stations import ROOT, THESIS, station
from tests.strategies import cells

import tandem
from tandem.cell.model import Cell
from tandem.dispatch.deciders.fixed import Fixed, fixed
from tandem.dispatch.deciders.policy import Basis, Chosen, Options, basis_of
from tandem.dispatch.deciders.table import policy
from tandem.dispatch.evaluation.batch import EpisodeBatch, Outcome
from tandem.dispatch.lookahead.objective import SECONDS, Objective
from tandem.dispatch.situation.model import Situation
from tandem.errors import CellError, InfeasibleError, UnsoundScheduleError
from tandem.files.generators import layered
from tandem.files.load import load
from tandem.files.validate import cell_of
from tandem.plan.result import Result
from tandem.schedule.model import Schedule
from tandem.world.arrays import Names
from tandem.world.population import crowd
from tandem.world.randomness import OFF, Draw

ALTERNATOR = load(ROOT / "examples" / "alternator.yaml")


def played(cell: Cell, decider: Fixed, people: str = "compliant") -> Outcome:
    """Two shifts of the fixed plan, times as stated."""
    names = Names.of(cell)
    arrays = names.arrays()
    persons = crowd(people, names, arrays).draw(np.random.default_rng(0), 2)
    return EpisodeBatch.of(names, arrays, Draw.of(names, arrays, OFF), persons, 0).play(decider)


def planned(cell: Cell, objective: Objective = SECONDS) -> Fixed:
    return fixed(cell, objective, Options())


@settings(max_examples=150)
@given(cells(max_tasks=7), st.sampled_from([SECONDS, Objective(1.0, 0.5), Objective(0.0, 1.0)]))
def test_a_plan_carried_out_beside_compliant_people_takes_what_was_planned(
    cell: Cell, objective: Objective
) -> None:
    """Tools with changeovers, zones, breaks, releases, deadlines, limits, joint ways and pairs:
    nothing is lost on the floor.
    """
    assume(cell.stress_of_set is None)
    try:
        decider = planned(cell, objective)
    except InfeasibleError:
        return
    found = played(cell, decider)
    assert found.done.all()
    assert decider.basis.proven
    assert found.makespan.tolist() == [decider.basis.makespan] * 2
    assert found.stress.tolist() == [decider.basis.stress] * 2


def given_plan(result: Result) -> Fixed:
    """The very schedule of a point, carried out."""
    chosen = Chosen(result.schedule, Basis.of(result, proven=True))
    return fixed(result.cell, SECONDS, Options(plan=chosen))


@settings(max_examples=40)
@given(cells(max_tasks=6))
def test_every_point_of_a_front_carried_out_takes_what_it_says(cell: Cell) -> None:
    assume(cell.stress_of_set is None)
    try:
        front = tandem.plan(cell, workers=1, time_limit=10)
    except InfeasibleError:
        return
    for result in front:
        found = played(cell, given_plan(result))
        assert found.makespan.tolist() == [result.makespan] * 2
        assert found.stress.tolist() == [result.stress] * 2


@pytest.mark.parametrize(
    "file", sorted(path.name for path in (ROOT / "examples").glob("*.yaml")), ids=str
)
def test_the_recommended_point_of_every_example_carried_out_takes_what_it_says(file: str) -> None:
    try:
        cell = load(ROOT / "examples" / file)
    except CellError:
        pytest.skip("no cell")
    if cell.stress_of_set is not None:
        with pytest.raises(CellError, match="stress that adds up"):
            planned(cell)
        return
    best = tandem.plan(cell, workers=1, time_limit=20).knee
    found = played(cell, given_plan(best))
    assert found.makespan.tolist() == [best.makespan] * 2
    assert found.stress.tolist() == [best.stress] * 2


def test_a_given_plan_that_breaks_the_cell_is_refused() -> None:
    best = tandem.plan(THESIS, minimize="makespan", workers=1)[0]
    moved = [
        replace(one, start=one.start + 1, end=one.end + 1) if one.task == "4" else one
        for one in best.schedule
    ]
    broken = Chosen(Schedule(tuple(moved)), Basis.of(best, proven=True))
    with pytest.raises(UnsoundScheduleError, match="'4'"):
        fixed(THESIS, SECONDS, Options(plan=broken))


@pytest.mark.parametrize(
    ("cell", "least"),
    [
        (THESIS, 23),
        (ALTERNATOR, 123),
        (layered(21, seed=0), 185),
        (layered(21, seed=3), 146),
        (layered(21, 2, seed=5), 98),
    ],
    ids=["thesis", "alternator", "21 tasks", "21 others", "two humans"],
)
def test_the_fixed_plan_is_the_exact_one(cell: Cell, least: float) -> None:
    decider = planned(cell)
    assert (decider.basis.makespan, decider.basis.proven) == (least, True)
    assert played(cell, decider).makespan.tolist() == [least] * 2


def bench(**changes: object) -> Cell:
    """The human needs 5 s before the bench, 4 s at it and 20 s after it; the robot needs it for 10
    s at any time.
    """
    tasks = {
        "fetch": {"time": {"human": 5}},
        "join": {"time": {"human": 4}, "after": ["fetch"], "zone": "bench"},
        "finish": {"time": {"human": 20}, "after": ["join"]},
        "test": {"time": {"robot": 10}, "zone": "bench"},
    }
    operators = {"robot": {"kind": "robot"}, "human": {"kind": "human"}}
    return cell_of({"name": "One bench", "operators": operators, "tasks": tasks, **changes})


def test_nobody_takes_a_place_that_the_plan_gives_to_another_first() -> None:
    """Begun at once, the robot's test would hold the bench until 10 s and cost the human 5 s."""
    assert played(bench(), planned(bench())).makespan.tolist() == [29] * 2


def test_nobody_takes_a_tool_that_the_plan_gives_to_another_first() -> None:
    data = bench().to_dict()
    for task in data["tasks"].values():
        if task.pop("zone", None):
            task["tool"] = "press"
    cell = cell_of({**data, "zones": {}})
    assert played(cell, planned(cell)).makespan.tolist() == [29] * 2


def test_the_fixed_plan_keeps_deadlines() -> None:
    """The robot's test must end by 12 s, so it comes first and the human waits for the bench."""
    data = bench().to_dict()
    data["tasks"]["test"]["deadline"] = 12
    late = cell_of(data)
    assert (
        planned(late).basis.makespan
        == tandem.plan(late, minimize="makespan", workers=1)[0].makespan
        == 34
    )
    assert played(late, planned(late)).makespan.tolist() == [34] * 2


@pytest.mark.parametrize(
    "people",
    ["random:1", "adversarial", "prefers:c,d", "postponing:0.4", "forgetful:0.3", "refusing:0.3"],
)
def test_the_fixed_plan_comes_to_an_end_whatever_people_do(people: str) -> None:
    cell = station(together=True, zone=True)
    names = Names.of(cell)
    they = crowd(people, names, names.arrays())
    arrays = names.arrays(undo=1.0 if they.makes_mistakes else None)
    stage = EpisodeBatch.of(
        names, arrays, Draw.of(names, arrays, OFF), they.draw(np.random.default_rng(0), 8), 0
    )
    assert stage.play(planned(cell)).done.all()


def test_who_refuses_leaves_the_task_to_the_quickest_who_can() -> None:
    decider = planned(THESIS)
    refused = replace(Situation.of(THESIS), refused={("robot", "2"): None})
    assert ("2", ("human",)) in {*decider.decide(refused).asks, *decider.decide(refused).starts}


def test_what_was_not_proven_in_the_time_given_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    """With next to no time the plan is the best of a few rules, and its bounds lie below it."""
    monkeypatch.setattr("tandem.dispatch.deciders.fixed.PLANNING_WORK", 1e-6)
    basis = planned(layered(40, seed=1)).basis
    assert not basis.proven
    assert basis.least_makespan < basis.makespan
    assert f"no plan is shorter than {basis.least_makespan:g} s" in basis.doubt


def test_only_who_carries_out_a_plan_has_one() -> None:
    assert basis_of(planned(THESIS)) == planned(THESIS).basis
    assert basis_of(policy("longest-tail", THESIS)) is None
