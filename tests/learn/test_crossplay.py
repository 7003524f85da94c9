"""The robots of one policy beside the humans of another; policies with drawn weights, untrained."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from tests.learn import tiny
from tests.learn.drawn import CELL, network, run_of

import tandem
from tandem.cli.root import run
from tandem.errors import UsageError
from tandem.lab.kinat2023.observations import observe_normalised
from tandem.lab.kinat2023.simulations import agents_of
from tandem.lab.kinat2023.station import station, whole_ticks
from tandem.lab.kinat2023.world import reset
from tandem.learn.algorithm import TrainingOrder
from tandem.learn.policy import Policy
from tandem.learn.training.crossplay import crossplay
from tandem.learn.training.evaluate import evaluate
from tandem.learn.training.runs import RunFolder


def station_run(folder: Path, seeds: tuple[int, ...], shared: bool = False) -> Path:
    """The same on the thesis's station: two agents, each with a network of its own or one."""
    laid = station(CELL, per_second=whole_ticks(CELL))
    sees, actions = observe_normalised(laid, reset(laid)).shape[1], len(CELL.tasks) + 1
    place = RunFolder(folder)
    place.begin(TrainingOrder(CELL, tiny.RECIPE, "station", seeds, 1.0).to_dict())
    lead: tuple[int, ...] = () if shared else (2,)
    for seed in seeds:
        notes = {"kind": "station", "pace": "decisions", "sees": "normalised"}
        notes |= {"rewards": "appendix", "stress_factor": 1.0, "seed": seed}
        actor = network(seed, lead, sees + 2 * shared, actions)
        agents = ("robot_0", "human_0")
        Policy(agents, actor, "tanh", True, shared, notes).save(place.policy(seed))
    return folder


def test_a_policy_beside_itself_is_what_its_evaluation_plays(tmp_path: Path) -> None:
    first, second = run_of(tmp_path / "a", (0, 1)), run_of(tmp_path / "b", (2,))
    found = crossplay([first, second])
    assert [one.name for one in found.partners] == ["a:0", "a:1", "b:2"]
    for place, partner in enumerate(found.partners):
        own = evaluate(partner.path.parent, seed=partner.seed, episodes=2).line("greedy")
        line = found.lines[place][place]
        assert (line.makespan, line.stress, line.gap) == (own.makespan, own.stress, own.gap)
        assert line.schedule == own.schedule


def test_who_decides_is_settled_by_whose_turn_it_is(tmp_path: Path) -> None:
    """Some pair plays what neither of its two plays alone, and all keep to the cell."""
    found = crossplay([run_of(tmp_path / "a", tuple(range(5)))])
    alone = {found.lines[place][place].schedule for place in range(5)}
    pairs = {line.schedule for row in found.lines for line in row}
    assert None not in pairs
    assert pairs - alone
    assert all(tandem.faults(CELL, schedule) == [] for schedule in pairs if schedule)


def test_means_tell_own_partners_other_seeds_and_other_runs_apart(tmp_path: Path) -> None:
    found = crossplay([run_of(tmp_path / "a", (0, 1, 2)), run_of(tmp_path / "b", (3, 4, 5))])
    gaps = np.array([[line.gap for line in row] for row in found.lines], float)
    means = {(mean.robots, mean.humans, mean.which): mean for mean in found.means()}
    off = ~np.eye(3, dtype=bool)
    for key, cells in {
        ("a", "a", "own partner"): np.diag(gaps)[:3],
        ("a", "a", "other seeds"): gaps[:3, :3][off],
        ("a", "b", "other run"): gaps[:3, 3:],
        ("b", "a", "other run"): gaps[3:, :3],
    }.items():
        assert means[key].gap == pytest.approx(cells.mean(), abs=1e-6)
        assert means[key].gap_ci95 is not None
        low, high = means[key].gap_ci95
        assert cells.min() - 1e-6 <= low <= means[key].gap <= high <= cells.max() + 1e-6
    assert len(means) == 6
    few = crossplay([run_of(tmp_path / "c", (0, 1))])
    assert {mean.gap_ci95 for mean in few.means()} == {None}, "two seeds say nothing of a third"


def test_every_pair_meets_the_same_people(tmp_path: Path) -> None:
    folder = run_of(tmp_path / "a", (0,))
    asked = {"people": "pace:0.5..2", "episodes": 8}
    first, again = crossplay([folder], **asked), crossplay([folder], **asked)
    assert first.to_dict() == again.to_dict()
    assert first.lines[0][0].makespan_ci95 > 0
    slow, stated = crossplay([folder], people="pace:2", episodes=2), crossplay([folder])
    assert slow.lines[0][0].makespan > stated.lines[0][0].makespan


@pytest.mark.parametrize("shared", [False, True])
def test_agents_of_the_thesiss_station_change_partners(tmp_path: Path, shared: bool) -> None:
    folder = station_run(tmp_path / "a", (0, 1), shared)
    place, laid = RunFolder(folder), station(CELL, per_second=whole_ticks(CELL))
    seen = observe_normalised(laid, reset(laid))
    robots, humans = Policy.load(place.policy(0)), Policy.load(place.policy(1))
    together = agents_of(place.policy(0), place.policy(1), CELL)
    np.testing.assert_allclose(together.logits(seen)[0], robots.logits(seen)[0], rtol=1e-5)
    np.testing.assert_allclose(together.logits(seen)[1], humans.logits(seen)[1], rtol=1e-5)
    found = crossplay([folder], draws=True, episodes=3)
    assert [len(row) for row in found.lines] == [2, 2]
    assert all(line.episodes == 3 for row in found.lines for line in row)


def test_what_cannot_play_together_is_said_with_every_reason(tmp_path: Path) -> None:
    event, own = run_of(tmp_path / "a", (0,)), station_run(tmp_path / "b", (0,))
    with pytest.raises(UsageError, match=r"factors 0, 1: .*--stress-factor"):
        crossplay([event, own])
    with pytest.raises(UsageError, match=r"different worlds[\s\S]*knows no paces"):
        crossplay([event, own], stress_factor=0, people="pace:2")
    with pytest.raises(UsageError, match="named twice"):
        crossplay([event, event])


def test_the_command_shows_the_matrix_and_writes_every_pair(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "120")
    run_of(tmp_path / "a", (0, 1))
    assert run(["crossplay", "a", "-q", "-o", "pairs.csv"]) == 0
    shown = capsys.readouterr().out
    assert "a:0" in shown
    assert "own partner" in shown
    assert "other seeds" in shown
    assert run(["crossplay", "a", "-q", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    rows = list(csv.DictReader((tmp_path / "pairs.csv").read_text().splitlines()))
    assert [(row["robots"], row["humans"]) for row in rows] == [
        (pair["robots"], pair["humans"]) for pair in document["pairs"]
    ]
    assert [float(row["makespan"]) for row in rows] == [
        pair["makespan"] for pair in document["pairs"]
    ]
    assert run(["crossplay", "nothing", "-q"]) == 3
