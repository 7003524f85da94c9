"""What PPO has learned as it plays a cell, in NumPy. No JAX is loaded."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tandem.cell.model import Cell
from tandem.errors import UsageError
from tandem.learn.episodes import played
from tandem.learn.forms import unreadable
from tandem.learn.networks import masked_log_softmax, sample
from tandem.learn.policy import Policy
from tandem.learn.ppo.decider import worth
from tandem.learn.ppo.observation import observation_size
from tandem.learn.results import Reached
from tandem.world.arrays import Array, Arrays, Names
from tandem.world.episode import Decider, Shift

if TYPE_CHECKING:
    from tandem.learn.algorithm import Order


def players(
    path: Path, cell: Cell, order: Order, *, seed: int, episodes: int
) -> dict[str, list[Reached]]:
    """How the decider plays the cell: what it thinks best, what it draws, and the best of that.

    Raises:
      CellError: the file is no policy, or none of the run's own cell. UsageError: the cell has
        another shape than the one that was learned.
    """
    policy, arrays = Policy.load(path), Names.of(cell).arrays()
    if cell.digest == order.cell.digest:
        must_be_whole(policy, arrays, path)
    fits(policy, arrays, cell)
    draws = np.random.default_rng(seed)
    greedy = played(
        cell, order.stress_factor, _chooser(policy, lambda logits: int(np.argmax(logits))), 1
    )
    sampled = played(
        cell, order.stress_factor, _chooser(policy, lambda logits: _drawn(logits, draws)), episodes
    )
    return {
        "greedy": greedy,
        "sampled": sampled,
        f"best of {episodes}": [min(sampled, key=lambda one: one.cost)],
    }


def fits(policy: Policy, arrays: Arrays, cell: Cell) -> None:
    """Raises UsageError when the policy was trained on a cell of another shape: other numbers of
    tasks, ways or operators.
    """
    if _shape(policy) != _wanted(arrays):
        learned = policy.notes.get("cell") or "another cell"
        raise UsageError(
            f"the policy was trained on {learned!r}, whose tasks, ways of doing them or operators"
            f" are not as many as those of {cell.name or 'this cell'!r}: it reads"
            f" {policy.observation_size} numbers, not {observation_size(arrays)}. Train one on this"
            " cell, or take --recipe alphazero, which reads cells of any size."
        )


def must_be_whole(policy: Policy, arrays: Arrays, path: Path) -> None:
    """Raises CellError when the policy says that it was trained on the cell of these arrays, but
    does not fit it.
    """
    if _shape(policy) != _wanted(arrays):
        agents, size, choices = _wanted(arrays)
        raise unreadable(
            path,
            [
                f"does not fit the cell that it says it was trained on: {len(policy.agents)} agents"
                f" that see {policy.observation_size} numbers and choose among {policy.actions},"
                f" where the cell has {agents} decider, {size} numbers to see and {choices}"
                " choices."
            ],
        )


def _shape(policy: Policy) -> tuple[int, int, int] | None:
    """Agents, numbers that they see, choices; None for agents that share a network, as a decider
    never does.
    """
    return None if policy.shared else (len(policy.agents), policy.observation_size, policy.actions)


def _wanted(arrays: Arrays) -> tuple[int, int, int]:
    return 1, observation_size(arrays), int(arrays.way_ticks.shape[-1]) + 1


def _chooser(policy: Policy, choose: Callable[[Array], int]) -> Decider:
    def decide(arrays: Arrays, shift: Shift) -> Array:
        action = choose(worth(policy, arrays, shift.state, shift.mask, shift.turn))
        return np.int32(-1 if action == arrays.way_ticks.shape[0] else action)

    return decide


def _drawn(logits: Array, draws: np.random.Generator) -> int:
    legal = np.isfinite(logits)
    return int(
        sample(np, masked_log_softmax(np, np.where(legal, logits, 0.0), legal), draws.random(()))
    )
