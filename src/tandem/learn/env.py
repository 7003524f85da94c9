"""What a search asks of a game: agents that take turns and share one cost. Pure functions; a game
is data, `vmap` adds the batch.

A game is a JAX pytree (`jax.tree_util.register_dataclass`): the instance. Its state is another: the
progress. So one compiled search serves every game of the same shape, and many games are played side
by side, each with its own instance. Nothing here is drawn: a game with chance holds what was drawn
for the episode in its data.

All agents pay the same cost, so a value never changes its sign on the way up a tree, whoever moves.
"""

from __future__ import annotations

from typing import Any, Protocol

import jax
import jax.numpy as jnp
import numpy as np

Array = Any
State = Any


class Game(Protocol):
    """One game. Costs are 0 or more; `unit` is what they are divided by to come near 1."""

    @property
    def agents(self) -> tuple[str, ...]:
        """Their names, in the order of `to_play`."""

    @property
    def moves(self) -> int:
        """How many moves there are, `K`; the same for all agents."""

    @property
    def longest(self) -> int:
        """No game has more moves than this."""

    @property
    def unit(self) -> Array:
        """`[]` float32, the cost of a typical move."""

    def reset(self) -> State:
        """The first state in which someone has to choose."""

    def legal(self, state: State) -> Array:
        """`[K]` bool, what the agent whose turn it is may do; all False once the game is over, else
        at least one True.
        """

    def to_play(self, state: State) -> Array:
        """`[]` int32, whose turn it is; -1 once the game is over."""

    def step(self, state: State, move: Array) -> tuple[State, Array]:
        """The next state in which someone has to choose (or the last one), and what it cost to get
        there, `[]` float32.

        Assumes `legal(state)[move]`. The last step also pays for what is still under way. After the
        end nothing changes and nothing is paid.
        """

    def is_over(self, state: State) -> Array:
        """`[]` bool."""

    def observe(self, state: State) -> Any:
        """What the network is shown, seen by the agent whose turn it is: a
        `tandem.learn.observation.Observation`, or whatever a game's own network takes."""

    def least(self, state: State) -> Array:
        """`[]` float32, a cost that is certainly still to come; 0 where nothing is known."""


def stacked(games: list[Any]) -> Any:
    """Several games of the same shape as one, with a leading axis. Raises ValueError when they have
    different shapes.
    """
    shapes = {tuple(np.shape(leaf) for leaf in jax.tree.leaves(game)) for game in games}
    if len(shapes) != 1 or len({jax.tree.structure(game) for game in games}) != 1:
        raise ValueError("the games have different shapes and cannot be played side by side.")
    return jax.tree.map(lambda *leaves: jnp.asarray(np.stack(leaves)), *games)


def many(game: Any, number: int) -> Any:
    """The same game so many times, with a leading axis."""
    return jax.tree.map(
        lambda leaf: jnp.broadcast_to(jnp.asarray(leaf), (number, *np.shape(leaf))), game
    )
