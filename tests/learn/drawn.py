"""Runs whose policies have drawn weights: nothing is trained, and every seed plays differently."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from tests.learn import tiny

import tandem
from tandem.learn.algorithm import TrainingOrder
from tandem.learn.policy import Policy
from tandem.learn.ppo.observation import observation_size
from tandem.learn.ppo.recipes import TANDEM
from tandem.learn.training.runs import RunFolder
from tandem.world.arrays import Names

CELL = tandem.load(tiny.CELL)


def network(
    seed: int, lead: tuple[int, ...], sees: int, actions: int
) -> dict[str, dict[str, np.ndarray]]:
    """An actor of two layers with drawn weights."""
    draws = np.random.default_rng(seed)
    return {
        str(layer): {
            "weight": draws.normal(size=(*lead, *shape)).astype(np.float32),
            "bias": draws.normal(size=(*lead, shape[-1])).astype(np.float32),
        }
        for layer, shape in enumerate([(sees, 8), (8, actions)])
    }


def run_of(folder: Path, seeds: tuple[int, ...], factor: float = 0.0) -> Path:
    """A run of the recipe `tandem` whose policies have drawn weights."""
    arrays = Names.of(CELL).arrays()
    place = RunFolder(folder)
    place.begin(TrainingOrder(CELL, TANDEM, "tandem", seeds, factor).to_dict())
    for seed in seeds:
        actor = network(seed, (1,), observation_size(arrays), arrays.way_ticks.shape[0] + 1)
        notes = {"kind": "ppo", "digest": CELL.digest, "seed": seed}
        Policy(("decider_0",), actor, "tanh", True, False, notes).save(place.policy(seed))
    return folder
