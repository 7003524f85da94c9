"""PPO for the policy for any cell, which only an ablation asks for; and ablations that are kept."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("jax", reason="training needs the extra tandem[learn]")

from benchmarks import graph_ppo, graph_training
from benchmarks.graph_ppo import Config, clipped, schedules_of, train
from benchmarks.graph_training import Ablation, Job, judged

from tandem.errors import UsageError
from tandem.learn.graph.labels import cost, drawn_exchange, layout_of
from tandem.learn.graph.making import Maker
from tandem.learn.graph.network import Weights
from tandem.learn.graph.outlook import Outlook
from tandem.learn.graph.pool import DECISIONS, SIZES, Seen, batch
from tandem.learn.graph.training import likely, untrained
from tandem.learn.graph.training_cells import training_cell
from tandem.learn.graph.weights import packed, unpacked

SMALL = Config(
    seed=1, batches=12, cells=12, cells_large=0, small=8, most_tasks=8, batch=12, rate=4e-3
)
FRESH = untrained(1)


def held_out(weights: Weights) -> float:
    """Mean cost in mean task times of the greedy schedules of cells that are never drawn."""
    found = list[float]()
    for number in range(40):
        layout = layout_of(training_cell(number, 8))
        seen = Outlook.of(layout, drawn_exchange(number, layout))
        state = Maker.of(weights, seen).build()
        assert state is not None
        found.append(cost(state, seen.exchange) / seen.scale)
    return float(np.mean(found))


def drawn(number: int) -> list[Seen]:
    return schedules_of(unpacked(FRESH), number, 8, 6, np.random.default_rng(number))


def test_what_a_schedule_gained_is_said_of_each_choice_that_was_made() -> None:
    told = drawn(3)
    assert len(told) == 6
    gains = list[float]()
    for one in told:
        gain, chance = one.label.losses.T
        made = [gain[begin:end] for begin, end in zip(one.at, one.at[1:], strict=False)]
        (alike,) = {float(row[row != 0][0]) for row in made}
        assert all(np.count_nonzero(row) == 1 for row in made)
        gains.append(alike)
        sums = np.add.reduceat(np.exp(chance), one.at[:-1])
        np.testing.assert_allclose(sums, 1, atol=1e-5)
    # against the mean of the cell's own schedules, in their standard deviation
    assert np.mean(gains) == pytest.approx(0, abs=1e-6)
    assert np.std(gains) == pytest.approx(1, abs=1e-5)
    for one, again in zip(told, drawn(3), strict=True):
        np.testing.assert_array_equal(one.label.losses, again.label.losses)


def test_the_objective_is_the_clipped_one() -> None:
    """Equation 7 of Schulman et al. (2017), choice by choice in NumPy."""
    pool: list[list[Seen]] = [[] for _ in SIZES]
    for number in range(4):
        for one in drawn(number):
            pool[one.size].append(one)
    part, count = batch(pool, np.random.default_rng(0), 4), 4 * DECISIONS
    real = part["decision"] < count
    now = np.asarray(likely(FRESH, part, count))[real]
    gain, before = part["loss"][real].T
    # the network that drew, as far as its cells are rounded
    np.testing.assert_allclose(now, before, atol=0.02)
    # and one that is far from it, so that the clip matters
    part["loss"][real, 1] = before = before + np.where(np.arange(len(before)) % 2, 0.5, -0.5)
    ratio = np.exp(now - before)
    parts = [
        min(one * much, min(max(one, 0.8), 1.2) * much)
        for one, much in zip(ratio, gain, strict=True)
    ]
    entropy = -(np.exp(now) * now).sum()
    decisions = len(set(part["decision"][real].tolist()))
    expected = -(sum(parts) + 0.05 * entropy) / decisions
    found = clipped(FRESH, part, count=count, clip=0.2, entropy=0.05)
    assert float(found) == pytest.approx(expected, rel=1e-4)


def test_a_short_training_is_better_than_none(tmp_path: Path) -> None:
    assert held_out(train(SMALL, tmp_path)) < 0.8 * held_out(unpacked(FRESH))


def test_what_was_stopped_goes_on_to_the_same_bits(tmp_path: Path) -> None:
    config = replace(SMALL, batches=graph_ppo.KEPT_EVERY + 1, cells=2, schedules=2, epochs=2)
    whole, told = train(config, tmp_path / "whole"), list[int]()

    def stop(done: int) -> None:
        told.append(done)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        train(config, tmp_path / "parts", stop)
    again = train(config, tmp_path / "parts", told.append)
    assert told == [graph_ppo.KEPT_EVERY, config.batches]
    for name, part in packed(whole).items():
        np.testing.assert_array_equal(packed(again)[name], part)
    with pytest.raises(UsageError, match="another configuration"):
        train(replace(config, clip=0.1), tmp_path / "parts")


@pytest.mark.slow
def test_ablations_are_kept_and_no_number_of_processes_changes_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # what is good matters as little here as the policies
    monkeypatch.setattr(graph_training, "VISITS", 2000)
    config = replace(SMALL, batches=1, cells=2, small=5, most_tasks=5, schedules=2, batch=2)
    asked = [Ablation("ppo", "labels", config)]
    (row,) = judged(tmp_path / "two", asked, 2, 2)
    assert (row["without"], row["seeds"]) == ("labels", 2)
    assert row["cpu_s"] > 0
    alone = Job(asked[0], 1, tmp_path / "alone").done(graph_training.good())
    again = Job(asked[0], 1, tmp_path / "two" / "ppo-1").kept()
    assert again is not None
    assert again | {"cpu_s": 0} == alone | {"cpu_s": 0}
    # what is there is not trained again: nothing of it is needed any more
    for file in (tmp_path / "two").glob("*/state-*.npz"):
        file.unlink()
    assert list(judged(tmp_path / "two", asked, 2, 1)) == [row]
