"""Learning beside people, measured: the program on a tiny instance, and the result that is kept."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tandem.dispatch.deciders.table import policy
from tandem.dispatch.situation.model import Situation
from tandem.errors import UsageError
from tandem.files.generators import layered
from tandem.plan.bounds import least_makespan
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout

pytest.importorskip("jax", reason="needs tandem[learn]")
ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "benchmarks"))
import beside_people  # noqa: E402  the program
from beside_people import Job, Settings, difference, done, jobs, tables, work_off  # noqa: E402

TINY = Settings(
    sizes=(7,), cells=1, seeds=2, training=0.02, episodes=4, planned=((50, 2), (500, 2))
)
KEPT = ROOT / "benchmarks" / "results" / "beside_people.json"


def quiet(line: str) -> None:
    """Nobody listens."""


@pytest.mark.slow
def test_what_was_stopped_goes_on_and_nothing_is_done_twice(tmp_path: Path) -> None:
    found = work_off(TINY, tmp_path, 60.0, quiet)
    assert list(found) == [job.file for job in jobs(TINY)]
    assert len(found["7-0/response"]["makespans"]["pace"]) == TINY.seeds
    (tmp_path / "7-0" / "tandem.json").unlink()
    told: list[str] = []
    again = work_off(TINY, tmp_path, 60.0, told.append)
    assert [line.partition(": ")[2] for line in told] == ["7-0/tandem"]
    played = {file: one.get("makespans") for file, one in found.items()}
    assert {file: one.get("makespans") for file, one in again.items()} == played
    shown = "\n".join(tables({"settings": vars(TINY), "results": again}))
    assert "–" not in shown


def test_no_job_begins_when_the_minutes_are_over(tmp_path: Path) -> None:
    assert work_off(TINY, tmp_path, -1.0, quiet) == {}
    with pytest.raises(UsageError, match="other settings"):
        work_off(replace(TINY, cells=2), tmp_path, -1.0, quiet)


def test_who_plays_fewer_episodes_plays_the_first_ones(tmp_path: Path) -> None:
    """Pairs are episodes of the same people and chances."""
    job = Job(7, 0, "replan", "pace", 50)
    fewer, more = (
        done(job, replace(TINY, planned=((50, count),)), tmp_path)["makespans"] for count in (2, 4)
    )
    assert len(more) == 4
    assert more[:2] == fewer


def test_auto_decides_as_re_planning_where_nothing_was_trained() -> None:
    """So the program does not play it again."""
    here = Situation.of(layered(7, seed=0))
    auto, robust = (policy(name, here.cell).decide(here) for name in ("auto", "replan-robust"))
    assert (auto.starts, auto.asks) == (robust.starts, robust.asks)


def results(of_seeds: list[list[float]], other: list[float]) -> dict[str, Any]:
    """One cell: what the learner's seeds took, and what `fixed` did."""
    return {
        Job(7, 0, "response").file: {"makespans": {"pace": of_seeds}},
        Job(7, 0, "fixed", "pace").file: {"makespans": other},
    }


def test_a_difference_is_paired_and_its_interval_holds_the_mean() -> None:
    """Of four episodes `fixed` played the first two: the others do not count."""
    alike = difference(
        results([[100.0, 200.0, 9.0, 9.0]] * 2, [110.0, 220.0]), TINY, 7, "pace", "fixed"
    )
    assert alike is not None
    assert alike["episodes"] == 2
    assert alike["mean"] == pytest.approx(0.1)
    assert alike["ci95"] == pytest.approx((0.1, 0.1))
    apart = difference(
        results([[100.0, 100.0], [120.0, 120.0]], [110.0, 110.0]), TINY, 7, "pace", "fixed"
    )
    assert apart is not None
    low, high = apart["ci95"]
    assert low == pytest.approx(110 / 120 - 1)
    assert high == pytest.approx(110 / 100 - 1)
    assert difference({}, TINY, 7, "pace", "fixed") is None


@pytest.fixture(scope="module")
def kept() -> dict[str, Any]:
    document: dict[str, Any] = json.loads(KEPT.read_text(encoding="utf-8"))
    return document


def test_the_kept_result_is_whole(kept: dict[str, Any]) -> None:
    """Each of its jobs is one of its settings, with as many episodes and seeds as they say."""
    settings = Settings.told(kept["settings"])
    known = {job.file: job for job in jobs(settings)}
    planned = dict(settings.planned)
    assert kept["results"]
    for file, found in kept["results"].items():
        job = known[file]
        if job.what.startswith("train-"):
            assert len(found["cpu_s"]) == settings.seeds
            continue
        if job.what in beside_people.LEARNERS:
            for rows in found["makespans"].values():
                assert np.shape(rows) == (settings.seeds, settings.episodes)
            continue
        count = planned.get(job.budget_ms, settings.episodes)
        assert len(found["makespans"]) == min(count, settings.episodes)


def test_nobody_in_the_kept_result_is_quicker_than_work_allows(kept: dict[str, Any]) -> None:
    """The quickest people need 0.6 of the stated times, robots all of them: nobody falls below that
    share of a bound that holds for all plans.
    """
    for file, found in kept["results"].items():
        size, _, number = file.partition("/")[0].partition("-")
        if "makespans" not in found:
            continue
        instance = Instance.of(layered(int(size), seed=int(number)))
        least = 0.6 * least_makespan(Layout.of(instance)) / instance.per_second
        rows = found["makespans"]
        many = rows.values() if isinstance(rows, dict) else [rows]
        assert min(np.min(one) for one in many) >= least, file


def test_the_page_shows_the_kept_result(kept: dict[str, Any]) -> None:
    page = (ROOT / "docs" / "learning.md").read_text(encoding="utf-8")
    assert [line for line in tables(kept) if line not in page] == []
