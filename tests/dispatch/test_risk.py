"""The risk of a plan: what its makespan becomes where times scatter."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.world.test_carried_out import carried_out, front_of

import tandem
from tandem.cli.risk import AskedRisk, told_risk
from tandem.cli.root import run
from tandem.dispatch.evaluation import as_planned, risk
from tandem.dispatch.evaluation.risk import searching, with_risk
from tandem.errors import UsageError
from tandem.plan.result import Front, Quantiles, Risk
from tandem.report import write
from tandem.report.stored import read_plan
from tandem.world import state as world
from tandem.world.arrays import Names
from tandem.world.carried_out import Plan
from tandem.world.randomness import Chance, Draw, scenario

EXAMPLES = Path(__file__).parents[2] / "examples"
THESIS = EXAMPLES / "thesis.yaml"


@pytest.fixture(scope="module")
def front() -> Front:
    return tandem.plan(tandem.load(THESIS), time_limit=None, workers=1)


@pytest.fixture(scope="module")
def risky(front: Front) -> Front:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(risk, "MOST_REPLANNED", 20)
        patch.setattr(risk, "FEWEST_REPLANNED", 20)
        return with_risk(front, cv=0.3)


def quantiles(front: Front) -> list[tuple[float, float]]:
    return [(r.risk.fixed.p50, r.risk.fixed.p95) for r in front if r.risk is not None]


def test_each_point_has_a_risk_about_its_makespan(front: Front, risky: Front) -> None:
    assert len(quantiles(risky)) == len(front)
    for result, (p50, p95) in zip(front, quantiles(risky), strict=True):
        assert 0.9 * result.makespan < p50 < 1.1 * result.makespan < p95


def test_hardly_any_scatter_is_hardly_any_risk(front: Front) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(risk, "MOST_REPLANNED", 2)
        patch.setattr(risk, "FEWEST_REPLANNED", 2)
        found = with_risk(front, cv=0.001)
    assert np.allclose(quantiles(found), [[r.makespan] * 2 for r in front], atol=0.2)


def test_the_same_seed_gives_the_same_risk(front: Front, risky: Front) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(risk, "MOST_REPLANNED", 20)
        patch.setattr(risk, "FEWEST_REPLANNED", 20)
        assert quantiles(with_risk(front, cv=0.3)) == quantiles(risky)
        assert quantiles(with_risk(front, cv=0.3, seed=1)) != quantiles(risky)


def test_a_robust_front_recommends_by_what_comes_of_its_points(front: Front) -> None:
    late = (40.0, 30.0, 35.0)
    found = replace(
        front,
        robust=True,
        results=tuple(
            replace(result, risk=Risk(Quantiles(0, p95, 9), Quantiles(0, p95, 9)))
            for result, p95 in zip(front, late, strict=True)
        ),
    )
    assert front.knee is front[1]
    # the first point is beaten in both by the second, so only two are left: the quicker of them
    assert found.knee is found[1]
    steady = replace(found, results=(found[0], found[2]))
    assert steady.knee is steady[1]


def test_nothing_that_scatters_is_said(front: Front) -> None:
    with pytest.raises(UsageError, match="--cv"):
        with_risk(front)


def test_a_risk_is_kept_with_the_plan(risky: Front, tmp_path: Path) -> None:
    kept = read_plan(write(replace(risky, robust=True), tmp_path / "plan.json")).front
    assert [result.risk for result in kept] == [result.risk for result in risky]
    assert kept.robust
    assert json.loads((tmp_path / "plan.json").read_text())["recommended_by"] == "p95"


class Clock:
    """Each look at it takes a second, so that what is done in a time can be counted."""

    def __init__(self) -> None:
        self.seconds = 0

    def __call__(self) -> float:
        self.seconds += 1
        return self.seconds


def test_when_time_is_up_all_points_rest_on_the_assemblies_that_all_have(front: Front) -> None:
    # one look before the first part, then one for each of the three points of a part
    missed: list[str] = []
    found = with_risk(front, cv=0.3, until=12, now=Clock(), missed=missed.append)
    assert [result.risk.fixed.episodes for result in found if result.risk] == [300] * 3
    assert [result.risk.replanned for result in found if result.risk] == [None] * 3
    assert missed == ["replanned"]
    all_drawn = risk._Floor.of(front, 0.3, 0).as_planned(risk._Clock(None, Clock()))
    first = [np.quantile(makespans[:300], [0.5, 0.95]) for makespans in all_drawn]
    assert np.allclose(quantiles(found), first, atol=1e-4)


def test_re_planning_too_ends_with_its_last_whole_part(front: Front) -> None:
    missed: list[str] = []
    clock = Clock()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(risk, "EPISODES", 100)
        patch.setattr(risk, "MOST_REPLANNED", 6)
        patch.setattr(risk, "FEWEST_REPLANNED", 2)
        whole = with_risk(front, cv=0.3, until=1000, now=clock)
        last = clock.seconds
        found = with_risk(front, cv=0.3, until=last - 1, now=Clock(), missed=missed.append)
    assert [told.risk.replanned.episodes for told in whole if told.risk] == [6] * 3
    assert [told.risk.replanned.episodes for told in found if told.risk] == [4] * 3
    assert missed == []


def test_without_time_the_front_stays_as_it_is_and_jax_is_not_asked(front: Front) -> None:
    missed: list[str] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(risk, "_Floor", None)  # nothing is drawn
        found = with_risk(front, cv=0.3, robust=True, until=4, now=Clock(), missed=missed.append)
    assert found is front
    assert missed == ["fixed"]


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        (AskedRisk(cv=0.3), "give a larger --time-limit."),
        (AskedRisk(cv=0.3, robust=True), "the recommendation goes by the planned makespan."),
    ],
)
def test_what_there_was_no_time_for_is_said_with_the_remedy(
    front: Front, capsys: pytest.CaptureFixture[str], asked: AskedRisk, words: str
) -> None:
    assert told_risk(front, asked, until=0.0, quiet=True) is front
    told = capsys.readouterr().err
    assert told.startswith("No time was left to tell what the points risk:")
    assert words in told


@pytest.mark.parametrize("option", [["--cv", "0.3"], ["--cv", "0.3", "--robust"]])
def test_without_jax_that_is_said_before_the_search(
    capsys: pytest.CaptureFixture[str], option: list[str]
) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, "jax", None)
        assert run(["plan", str(THESIS), *option]) == 1
    told = capsys.readouterr()
    assert told.out == ""
    # nothing was searched: no point was told on the way
    assert told.err.strip() == (
        "tandem: telling the risk of a plan needs JAX, which is not installed. Get it with:"
        " pip install 'tandem[learn]'"
    )


def test_a_spread_that_the_cell_states_is_told_when_time_is_left(
    front: Front, capsys: pytest.CaptureFixture[str]
) -> None:
    data = {
        "name": "two",
        "operators": {"anna": {"kind": "human"}},
        "tasks": {"1": {"time": {"anna": 3}, "spread": 0.2, "stress": 1}},
    }
    stated = tandem.plan(tandem.Cell.model_validate(data), work=1)
    assert told_risk(stated, AskedRisk(wanted=False), until=0.0, quiet=True) is stated
    assert capsys.readouterr().err == ""
    assert told_risk(stated, AskedRisk(), until=0.0, quiet=True) is stated
    told = capsys.readouterr().err
    assert "--risk" in told
    assert "--no-risk" in told


def test_by_work_no_clock_is_asked(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    cell = THESIS.read_text().replace("stress: 10}", "stress: 10, spread: 0.2}")
    (tmp_path / "cell.yaml").write_text(cell)
    assert run(["plan", str(tmp_path / "cell.yaml"), "--work", "1", "--json", "-q"]) == 0
    points = json.loads(capsys.readouterr().out)["front"]
    assert [point["risk"]["fixed"]["episodes"] for point in points] == [2000] * 3
    assert all(point["risk"].get("replanned") is None for point in points)


def test_a_part_of_the_limit_is_set_aside_where_that_is_of_use() -> None:
    assert searching(60.0) == pytest.approx(40.0)
    assert searching(10.0) == pytest.approx(5.5)
    assert searching(5.0) == 5.0
    assert searching(float("inf")) == float("inf")
    assert AskedRisk(robust=True).searching(60.0) == pytest.approx(40.0)
    assert AskedRisk().searching(60.0) == 60.0


@pytest.mark.parametrize("seed", range(60))
def test_carried_out_as_it_stands_a_plan_ends_when_the_world_has_it_end(seed: int) -> None:
    for result in front_of(seed) or ():
        names = Names.of(result.cell)
        arrays, plan = names.arrays(), Plan.of(names, result.schedule)
        draw = Draw.of(names, arrays, Chance("lognormal", 0.5))
        numbers = np.random.default_rng(seed).random(draw.numbers, np.float32)
        factor = scenario(draw, arrays, numbers).factor[:, 0]
        cell = as_planned.planned_ways(arrays, plan)
        ticks = as_planned.drawn_ticks(cell, factor[plan.way])
        state = world.reset(cell)
        ready = as_planned.due(cell, plan.awaits, state)
        while as_planned.goes_on(cell, state, ready):
            state, ready = as_planned.step(cell, ticks, plan.rank, plan.awaits, state, ready)
        played = carried_out(result.cell, result.schedule, 0.5, seed)
        assert names.seconds(int(world.makespan(state))) == played.makespan
        if seed % 30 == 0:  # compiled it comes to the same
            compiled = as_planned.carried_out(arrays, plan, factor[None])
            assert compiled.tolist() == [int(world.makespan(state))]


@pytest.mark.parametrize("given", [["--robust"], ["--cv", "0.2", "--no-risk"], ["--cv", "-1"]])
def test_what_makes_no_sense_is_wrong_usage(given: list[str]) -> None:
    assert run(["plan", str(THESIS), *given]) == 2
