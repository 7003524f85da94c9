"""Two agents from two files, the shortest of several simulations, and the log of every step."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest
from click.testing import CliRunner

from tandem.cli.laboratory import play_command
from tandem.errors import UsageError
from tandem.lab.kinat2023.episode import play
from tandem.lab.kinat2023.game import thesis_cell
from tandem.lab.kinat2023.rewards import reward_set
from tandem.lab.kinat2023.simulations import COLUMNS, agents_of, shortest, simulations
from tandem.learn.policy import Policy

TASKS, SEEN = 7, 6 * 7 + 4 + 49


def file_of(folder, name, seed, *, hidden=8, **notes):
    """A policy with random weights, masked, by decisions."""
    draws = np.random.default_rng(seed)
    sizes = [(SEEN, hidden), (hidden, TASKS + 1)]
    actor = {
        str(layer): {
            "weight": draws.normal(size=(2, *size)).astype(np.float32),
            "bias": np.zeros((2, size[1]), np.float32),
        }
        for layer, size in enumerate(sizes)
    }
    said = {"pace": "decisions", "sees": "normalised", "rewards": "appendix", "stress_factor": 1.0}
    return Policy(("robot_0", "human_0"), actor, "tanh", True, False, said | notes).save(
        folder / f"{name}.safetensors"
    )


def test_the_robot_is_of_one_file_and_the_human_of_the_other(tmp_path):
    cell, first, second = (
        thesis_cell(),
        file_of(tmp_path, "a", 1),
        file_of(tmp_path, "b", 2),
    )
    both, a, b = agents_of(first, second, cell), Policy.load(first), Policy.load(second)
    seen = np.random.default_rng(3).random((2, SEEN)).astype(np.float32)
    assert np.array_equal(both.logits(seen)[0], a.logits(seen)[0])
    assert np.array_equal(both.logits(seen)[1], b.logits(seen)[1])
    assert not np.array_equal(both.logits(seen)[1], a.logits(seen)[1])


def test_agents_that_play_in_different_ways_are_refused(tmp_path):
    first, second = file_of(tmp_path, "a", 1), file_of(tmp_path, "b", 2, pace="ticks")
    with pytest.raises(UsageError, match=r"cannot play together.*pace 'decisions' and 'ticks'"):
        agents_of(first, second, thesis_cell())
    with pytest.raises(UsageError, match="other widths"):
        agents_of(first, file_of(tmp_path, "c", 2, hidden=9), thesis_cell())


def test_the_shortest_of_the_simulations_is_no_longer_than_any(tmp_path):
    policy = agents_of(file := file_of(tmp_path, "a", 1), file, thesis_cell())
    episodes = [episode for episode, _ in simulations(thesis_cell(), policy, 20, seed=5)]
    best = shortest(episodes)
    ticks = [episode.ticks for episode in episodes if episode.done]
    assert best is not None
    assert episodes[best].ticks == min(ticks) >= 23
    assert len(set(ticks)) > 1
    assert shortest([]) is None


def test_the_log_adds_up_to_the_returns_and_can_be_replayed(tmp_path):
    cell = thesis_cell()
    policy = agents_of(file := file_of(tmp_path, "a", 1), file, cell)
    episode, log = next(iter(simulations(cell, policy, 1)))
    assert np.allclose(np.sum([one.reward for one in log], 0), episode.returns)
    assert [one.done for one in log] == [False] * (len(log) - 1) + [True]
    actions = iter([one.action for one in log])
    again = play(cell, reward_set(stress_factor=1.0), lambda *_: next(actions))
    assert again.schedule == episode.schedule


def test_the_command_prints_the_shortest_and_writes_the_log(tmp_path):
    first, second = file_of(tmp_path, "a", 1), file_of(tmp_path, "b", 2)
    steps = tmp_path / "steps.csv"
    asked = ["examples/thesis.yaml", "--robot", first, "--human", second, "--simulations", "5"]
    told = CliRunner().invoke(play_command, [*map(str, asked), "--log", str(steps), "--json"])
    assert told.exit_code == 0, told.output
    document = json.loads(told.stdout)
    assert document["shortest"]["makespan"] == max(
        row["end"] for row in document["shortest"]["assignments"]
    )
    rows = list(csv.DictReader(steps.open()))
    assert list(rows[0]) == COLUMNS
    assert {row["simulation"] for row in rows} == {"1", "2", "3", "4", "5"}
    assert sum(row["done"] == "1" for row in rows) == document["finished"]
    words = CliRunner().invoke(play_command, list(map(str, asked)))
    assert "the shortest is number" in words.stdout
