"""The policy for any cell beside people, measured: the program on a small cell, the people as they
were measured, and the results that are kept.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("jax", reason="needs tandem[learn]")
ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "benchmarks"))
import policy_people  # noqa: E402  the program
from policy_people import CROWDS, EPISODES, MEASURED, Job, done, jobs, station, tables  # noqa: E402
from tandem.world.arrays import Names  # noqa: E402
from tandem.world.population import crowd  # noqa: E402

KEPT = ROOT / "benchmarks" / "results" / "policy_people.json"


@pytest.fixture(scope="module")
def kept() -> dict[str, Any]:
    document: dict[str, Any] = json.loads(KEPT.read_text(encoding="utf-8"))
    return document


def test_an_episode_comes_out_the_same_again() -> None:
    """Work is counted, so how busy the machine is decides nothing."""
    job = Job(7, 0, MEASURED, "learned")
    one, two = (done(job, 2)["makespans"] for _ in range(2))
    assert one == two
    assert len(set(one)) == 2


def test_what_scatters_is_stated_in_the_cell() -> None:
    cell = station(Job(7, 0, MEASURED, "learned"))
    (human,) = cell.humans
    stated = [task.spread for task in cell.tasks.values() if human in task.time]
    assert stated
    assert all(dict(one) == {human: 0.5} for one in stated)  # type: ignore[arg-type]
    assert all(not task.spread for task in station(Job(7, 0, "pace", "learned")).tasks.values())


def test_people_as_measured_are_as_the_recordings_say() -> None:
    """Paces within those of eight people, mean about 1; a tenth of the steps wrong; half of the
    people with an order of their own.
    """
    cell = station(Job(7, 0, MEASURED, "learned"))
    names = Names.of(cell)
    persons = crowd(CROWDS[MEASURED], names, names.arrays()).draw(np.random.default_rng(0), 4000)
    paces = np.asarray(persons.pace)
    assert 0.75 <= paces.min() <= paces.max() <= 1.3
    assert paces.mean() == pytest.approx(1.0, abs=0.03)
    assert 0.1 < np.log(paces).std() < 0.2
    assert np.mean(persons.forgets) == pytest.approx(0.1, abs=0.01)
    assert np.mean(np.asarray(persons.random) > 0) == pytest.approx(0.5, abs=0.03)


def test_the_kept_results_are_those_of_the_program(kept: dict[str, Any]) -> None:
    known = {job.file: job for job in jobs(list(EPISODES))}
    assert kept["results"]
    for file, found in kept["results"].items():
        assert len(found["makespans"]) == EPISODES[known[file].tasks]
        assert min(found["makespans"]) > 0


def test_the_page_tells_the_numbers_that_are_kept(kept: dict[str, Any]) -> None:
    page = (ROOT / "docs" / "one-policy.md").read_text(encoding="utf-8")
    lines = [line for line in tables(kept) if line.startswith("|")]
    assert len(lines) > 10
    assert [line for line in lines if line not in page] == []
    assert kept["weights"] in page


def test_those_who_do_not_ask_the_network_are_taken_from_an_earlier_result(tmp_path: Path) -> None:
    known = {job.file: {"makespans": [1.0]} for job in policy_people.jobs([7])}
    taken = policy_people.work_off([7], tmp_path, -1.0, known)
    who = {job.who for job in policy_people.jobs([7]) if job.file in taken}
    assert who == {"replan-robust", *policy_people.RULES}


def test_no_job_begins_when_the_minutes_are_over(tmp_path: Path) -> None:
    assert policy_people.work_off([7], tmp_path, -1.0, {}) == {}
    assert list(tables({"sizes": [7], "results": {}}))[2:3] == [""]
