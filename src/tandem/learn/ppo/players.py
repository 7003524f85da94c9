"""What PPO has learned as it plays a cell, in NumPy. No JAX is loaded."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tandem.cell.model import Cell
from tandem.learn.episodes import played
from tandem.learn.networks import masked_log_softmax, sample
from tandem.learn.policy import Policy
from tandem.learn.ppo.decider import policy_for, worth
from tandem.learn.results import Reached
from tandem.world.arrays import Array, Arrays
from tandem.world.episode import Decider, Shift

if TYPE_CHECKING:
    from tandem.learn.algorithm import TrainingOrder


def players(
    path: Path, cell: Cell, order: TrainingOrder, *, seed: int, episodes: int
) -> dict[str, list[Reached]]:
    """How the decider plays the cell: what it thinks best, what it draws, and the best of that.

    Raises:
      CellError: the file is no policy, or none of the run's own cell. UsageError: the cell has
        another shape than the one that was learned.
    """
    policy = policy_for(path, cell, trained_on=order.cell.digest)
    draws = np.random.default_rng(seed)
    greedy = played(
        cell, order.stress_factor, _chooser(policy, lambda logits: int(np.argmax(logits))), 1
    )
    sampled = played(
        cell, order.stress_factor, _chooser(policy, lambda logits: drawn(logits, draws)), episodes
    )
    return {
        "greedy": greedy,
        "sampled": sampled,
        f"best of {episodes}": [min(sampled, key=lambda one: one.cost)],
    }


def _chooser(policy: Policy, choose: Callable[[Array], int]) -> Decider:
    def decide(arrays: Arrays, shift: Shift) -> Array:
        action = choose(worth(policy, arrays, shift.state, shift.mask, shift.turn))
        return np.int32(-1 if action == arrays.way_ticks.shape[0] else action)

    return decide


def drawn(logits: Array, draws: np.random.Generator) -> int:
    """One of the choices, each as likely as the network believes in it; minus infinity is none."""
    legal = np.isfinite(logits)
    return int(
        sample(np, masked_log_softmax(np, np.where(legal, logits, 0.0), legal), draws.random(()))
    )
