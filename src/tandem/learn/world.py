"""What a learner asks of a world: pure functions with the agents as a leading axis. Any number of
agents, any rules.

A world is data as well (a JAX pytree: `jax.tree_util.register_dataclass`), so that one compiled
training loop serves every world of the same shape, and a batch of worlds can be mapped over.
"""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol, Self

Array = Any
State = Any


class StageValues(NamedTuple):
    """One stage as numbers that a compiled loop reads; see `Stage`. It ends at `episodes`, `steps`
    or `stop_return`.
    """

    entropy: Any
    learning_rate: Any
    idle: Any
    normalise_advantages: Any
    episodes: Any
    steps: Any
    stop_return: Any


class StepResult(NamedTuple):
    """What a step brought. `A` agents.

    reward: `[A]` float32.
    terminated: `[]` bool, the episode came to its end. A limit on its length is the learner's
    business, not the world's. illegal: `[A]` int32, how many rules the agent's action broke.
    """

    reward: Array
    terminated: Array
    illegal: Array


class World(Protocol):
    """One world. Chance, where it has any, lives in the state: `reset` puts a key there."""

    @property
    def agents(self) -> tuple[str, ...]:
        """Their names; the leading axis `A` everywhere."""

    @property
    def actions(self) -> int:
        """How many actions each agent has, `K`."""

    @property
    def observation_size(self) -> int:
        """How many numbers each agent sees, `D`."""

    def reset(self, key: Array) -> State:
        """The first state of an episode."""

    def observe(self, state: State) -> Array:
        """`[A, D]` float32."""

    def legal(self, state: State) -> Array:
        """`[A, K]` bool, True where the action is allowed; at least one a row."""

    def narrow(self, state: State, legal: Array, action: Array) -> Array:
        """`legal` once `action` `[A]` is known: rows of agents that choose later may lose actions
        that others have just taken.

        The rows of agents that choose first stay as they are. Where all choose at the same time
        this is `legal` itself.
        """

    def step(self, state: State, action: Array) -> tuple[State, StepResult]:
        """The next state and what came of it; `action` is `[A]` int32."""

    def in_stage(self, stage: StageValues) -> Self:
        """The same world as that stage of the training pays for it."""
