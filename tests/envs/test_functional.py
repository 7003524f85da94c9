"""The functional face plays what the Gymnasium face plays, over one cell and over padded ones."""

from __future__ import annotations

import runpy
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest

pytest.importorskip("jax", reason="needs tandem[learn]")

import jax

from tandem.cell.model import Cell
from tandem.envs.cells import Room
from tandem.envs.functional import Functional, functional
from tandem.envs.padding import AXES
from tandem.errors import UsageError
from tandem.files.generators import layered
from tandem.world.arrays import Arrays

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"
NAME = "tandem/RobotBesideHuman-v0"
SEVERAL = [EXAMPLES / f"{name}.yaml" for name in ("thesis", "gearbox", "crew", "pump", "window")]
"""Cells with tools, zones, joint tasks, set-ups, waits and limits among them."""


def beside(env: Functional, step: Any, cells: list[Any], number: int, seed: int) -> None:
    """An episode on the cell with that number, at both faces, by the same drawn actions, of which
    some are illegal.
    """
    face = gymnasium.make(
        NAME,
        cell=cells if len(cells) > 1 else cells[0],
        room=env.room,
        per_second=env.per_second,
        stress_factor=0.5,
    )
    observation, _ = face.reset(options={"cell": cells[number]})
    draws, keys = np.random.default_rng(seed), iter(range(10_000))
    seen, state = env.reset(jax.random.key(next(keys)))
    while int(state.cell) != number:
        seen, state = env.reset(jax.random.key(next(keys)))
    ended = False
    while not ended:
        assert env.observation_space().contains(jax.tree.map(np.asarray, seen))
        np.testing.assert_allclose(seen["observation"], observation["observation"], atol=1e-4)
        np.testing.assert_array_equal(seen["action_mask"], observation["action_mask"])
        action = int(draws.choice(np.flatnonzero(observation["action_mask"])))
        action = int(draws.integers(env.num_actions)) if draws.random() < 0.1 else action
        observation, reward, ended, cut, info = face.step(action)
        key = jax.random.key(1)
        seen, state, paid, _, told = step(key, state, action)
        assert float(paid) == pytest.approx(reward, abs=1e-3)
        assert (bool(told["terminated"]), bool(told["truncated"])) == (ended, cut)
        assert bool(told["illegal"]) == info["illegal"]
        assert float(told["time"]) == pytest.approx(info["time"], abs=1e-3)
        assert float(told["stress"]) == pytest.approx(info["stress"], abs=1e-3)
        ended = ended or cut


@pytest.fixture(scope="module")
def several() -> tuple[Functional, Any]:
    env = functional(SEVERAL, stress_factor=0.5)
    return env, jax.jit(env.step_env)


@pytest.mark.parametrize("number", range(len(SEVERAL)), ids=lambda number: SEVERAL[number].stem)
def test_padded_cells_play_as_at_the_gymnasium_face(
    several: tuple[Functional, Any], number: int
) -> None:
    beside(*several, SEVERAL, number, seed=number)


def test_an_episode_that_ends_begins_anew_and_keeps_its_last_observation() -> None:
    env = functional(layered(3, seed=1))
    step, key = jax.jit(env.step), jax.random.key(0)
    seen, state = env.reset(key)
    assert float(state.shift.state.clock) == 0
    ends = 0
    for number in range(12):
        action = int(np.flatnonzero(seen["action_mask"])[-1])
        seen, state, _, done, info = step(jax.random.key(number), state, action)
        last = np.asarray(info["final_observation"])
        if done:
            ends += 1
            assert info["terminated"]
            assert float(state.shift.state.clock) == 0
            assert (
                last[-1] != np.asarray(seen["observation"])[-1]
                or (last != seen["observation"]).any()
            )
        else:
            np.testing.assert_array_equal(last, seen["observation"])
    assert ends >= 2


def test_a_generator_draws_its_cells_before(tmp_path: Path) -> None:
    def drawn(rng: np.random.Generator) -> Cell:
        return layered(int(rng.integers(3, 6)), seed=int(rng.integers(1000)))

    room = Room(tasks=6, ways=12, robots=1, humans=1)
    env, again = (functional(drawn, room=room, drawn=5, seed=1) for _ in range(2))
    assert [cell.digest for cell in env.cells] == [cell.digest for cell in again.cells]
    assert len({cell.digest for cell in env.cells}) > 1
    assert env.num_actions == 13
    assert env.default_params.there.sum(axis=1).tolist() == [len(cell.tasks) for cell in env.cells]
    with pytest.raises(UsageError, match="say how large they may become"):
        functional(drawn)
    with pytest.raises(UsageError, match="drawn=0"):
        functional(drawn, room=room, drawn=0)


def test_every_field_of_a_cell_can_be_padded() -> None:
    assert set(AXES) == set(Arrays._fields)


def test_listed_sets_cannot_be_padded_to_cells_that_have_none() -> None:
    cell = layered(4, seed=1)
    listed = cell.replace(stress_of_set={",".join(cell.tasks): 1.0})
    with pytest.raises(UsageError, match="stress_of_set"):
        functional([listed, layered(4, seed=2)])


def test_a_thousand_copies_run_as_the_example_says(capsys: pytest.CaptureFixture[str]) -> None:
    example = runpy.run_path(str(EXAMPLES / "many_copies.py"))
    env = functional(EXAMPLES / "thesis.yaml", person="random:0.5")
    told = jax.tree.map(np.asarray, example["play"](env, 1024, 64, 0))
    assert told["done"].shape == (64, 1024)
    assert (told["done"].sum(axis=0) >= 1).all(), "each copy ended at least once, and went on"
    spans = told["makespan"][told["terminated"]]
    assert spans.min() >= 23
    # that of random legal decisions, beside the exact optimum of 24.167 s
    assert 27 < spans.mean() < 38
