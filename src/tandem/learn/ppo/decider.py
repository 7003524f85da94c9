"""A trained best response as it decides: what it thinks best, in NumPy on the station's PC or under
JAX for many episodes at once.
"""

from __future__ import annotations

from tandem.learn.networks import forward
from tandem.learn.policy import Policy
from tandem.learn.ppo import observation
from tandem.world.arrays import Array, Arrays, namespace
from tandem.world.episode import Decider, Shift
from tandem.world.state import State


def worth(policy: Policy, arrays: Arrays, state: State, mask: Array, turn: Array) -> Array:
    """`[W + 1]` float32, how much the policy is for each way, the last one being to wait; minus
    infinity for what is not legal.

    Args:
      mask: `[W]` bool, what may begin now. turn: `[]` int, whose turn it is.
    """
    xp = namespace(mask)
    actor = {
        layer: {part: array[0] for part, array in parts.items()}
        for layer, parts in policy.actor.items()
    }
    logits = forward(xp, actor, observation.observe(arrays, state, mask, turn), policy.activation)
    return xp.where(observation.choices(arrays, state, mask, turn), logits, -xp.inf)


def decider(policy: Policy) -> Decider:
    """The policy as `tandem.world.episode` asks it."""

    def decide(arrays: Arrays, shift: Shift) -> Array:
        xp = namespace(shift.mask)
        action = xp.argmax(worth(policy, arrays, shift.state, shift.mask, shift.turn))
        return xp.where(action == arrays.way_ticks.shape[0], -1, action).astype(xp.int32)

    return decide
