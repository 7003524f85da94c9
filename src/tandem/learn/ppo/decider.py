"""What PPO has learned as it decides: what it thinks best, in NumPy on the station's PC or under
JAX for many episodes at once.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path

from tandem.cell.model import Cell
from tandem.errors import UsageError
from tandem.learn.algorithm import Learnt
from tandem.learn.forms import unreadable
from tandem.learn.networks import forward, mapped
from tandem.learn.policy import Policy
from tandem.learn.ppo import observation
from tandem.world.arrays import Array, Arrays, Names, namespace
from tandem.world.episode import Decider, Shift
from tandem.world.state import State


def learnt(path: Path, cell: Cell) -> Learnt:
    """The policy in the file, for `tandem.learn.training.algorithms.DECIDERS`."""
    return Learnt(partial(worth, policy_for(path, cell)))


def policy_for(path: Path, cell: Cell, *, trained_on: str | None = None) -> Policy:
    """The policy in the file, which fits the cell.

    Args:
      trained_on: digest of the cell it was trained on; what the file says when absent.

    Raises:
      CellError: the file is no policy, or none of the cell that it was trained on.
      UsageError: the cell has another shape than the one that was learned.
    """
    policy, arrays = Policy.load(path), Names.of(cell).arrays()
    if cell.digest == (policy.notes.get("digest") if trained_on is None else trained_on):
        _must_be_whole(policy, arrays, path)
    _must_fit(policy, arrays, cell)
    return policy


def worth(policy: Policy, arrays: Arrays, state: State, mask: Array, turn: Array) -> Array:
    """`[W + 1]` float32, how much the policy is for each way, the last one being to wait; minus
    infinity for what is not legal.

    Args:
      mask: `[W]` bool, what may begin now. turn: `[]` int, whose turn it is.
    """
    xp = namespace(mask)
    actor = mapped(lambda array: array[0], policy.actor)
    logits = forward(xp, actor, observation.observe(arrays, state, mask, turn), policy.activation)
    return xp.where(observation.choices(arrays, state, mask, turn), logits, -xp.inf)


def decider(policy: Policy) -> Decider:
    """The policy as `tandem.world.episode` asks it."""

    def decide(arrays: Arrays, shift: Shift) -> Array:
        xp = namespace(shift.mask)
        action = xp.argmax(worth(policy, arrays, shift.state, shift.mask, shift.turn))
        return xp.where(action == arrays.way_ticks.shape[0], -1, action).astype(xp.int32)

    return decide


def _must_fit(policy: Policy, arrays: Arrays, cell: Cell) -> None:
    """Raises UsageError when the policy was trained on a cell of another shape: other numbers of
    tasks, ways or operators.
    """
    if _shape(policy) != _wanted(arrays):
        learned = policy.notes.get("cell") or "another cell"
        raise UsageError(
            f"the policy was trained on {learned!r}, whose tasks, ways of doing them or operators"
            f" are not as many as those of {cell.name or 'this cell'!r}: it reads"
            f" {policy.observation_size} numbers, not {observation.observation_size(arrays)}. Train"
            " one on this cell, or take --recipe alphazero, which reads cells of any size."
        )


def _must_be_whole(policy: Policy, arrays: Arrays, path: Path) -> None:
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
    return 1, observation.observation_size(arrays), int(arrays.way_ticks.shape[-1]) + 1
