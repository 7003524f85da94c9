"""The risk of a plan: what its makespan becomes where times scatter."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import tandem
from tandem.cli.root import run
from tandem.dispatch.evaluation import risk
from tandem.dispatch.evaluation.risk import with_risk
from tandem.errors import UsageError
from tandem.plan.result import Front, Quantiles, Risk
from tandem.report import write
from tandem.report.stored import read_plan

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


@pytest.mark.parametrize("given", [["--robust"], ["--cv", "0.2", "--no-risk"], ["--cv", "-1"]])
def test_what_makes_no_sense_is_wrong_usage(given: list[str]) -> None:
    assert run(["plan", str(THESIS), *given]) == 2
