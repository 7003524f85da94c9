"""A game of turns so small that a person can work it out, and judges that know nothing."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from tandem.learn.alphazero.network import Prediction


class Way(NamedTuple):
    """moves: `[]` int32, made so far. first: `[]` int32, the first one, -1 before."""

    moves: jax.Array
    first: jax.Array


@partial(jax.tree_util.register_dataclass, data_fields=["unit", "fees"], meta_fields=[])
@dataclass(frozen=True)
class Trap:
    """Agent 0 goes left (move 0) or right (move 1), then agent 1 chooses, then it is over; both pay
    the same.

    Left costs 1 and then 5 or 6; right costs 2 and then 1 or 9. Least: right, then move 0, 3 in
    all. Who looks one step ahead goes left; who thinks that agent 1 is an adversary goes left, too.
    Move 2 would cost nothing, and is never legal.
    """

    unit: Any
    fees: Any

    agents = ("first", "second")
    moves = 3
    longest = 3

    @classmethod
    def of(cls) -> Trap:
        return cls(jnp.float32(1.0), jnp.array([[1.0, 2.0, 0.0], [5.0, 6.0, 0.0], [1.0, 9.0, 0.0]]))

    def reset(self) -> Way:
        return Way(jnp.zeros((), jnp.int32), jnp.full((), -1, jnp.int32))

    def legal(self, state: Way) -> jax.Array:
        return jnp.array([True, True, False]) & ~self.is_over(state)

    def to_play(self, state: Way) -> jax.Array:
        return jnp.where(self.is_over(state), -1, state.moves)

    def step(self, state: Way, move: Any) -> tuple[Way, jax.Array]:
        over = self.is_over(state)
        row = jnp.where(state.moves == 0, 0, 1 + state.first)
        first = jnp.where(state.moves == 0, move, state.first)
        return Way(state.moves + ~over, first.astype(jnp.int32)), jnp.where(
            over, 0.0, self.fees[row, move]
        )

    def is_over(self, state: Way) -> jax.Array:
        return state.moves >= 2

    def observe(self, state: Way) -> jax.Array:
        return jax.nn.one_hot(jnp.where(state.moves == 0, 0, 1 + state.first), 3)

    def least(self, state: Way) -> jax.Array:
        return jnp.zeros(())


@dataclass(frozen=True)
class Blind:
    """Knows nothing: prefers no move, expects what is certain."""

    moves: int

    def start(self, key: Any, game: Any = None) -> dict[str, Any]:
        return {}

    def read(self, parameters: Any, seen: Any, least: Any, mover: Any) -> Prediction:
        return Prediction(jnp.zeros(self.moves), jnp.asarray(least))


@dataclass(frozen=True)
class Told:
    """Says what it is told for each of `Trap`'s three situations: `logits` `[3, 3]`, `to_come`
    `[3]`.
    """

    def start(self, key: Any, game: Any = None) -> dict[str, Any]:
        return {"logits": jnp.zeros((3, 3)), "to_come": jnp.zeros(3)}

    def read(self, parameters: Any, seen: Any, least: Any, mover: Any) -> Prediction:
        return Prediction(seen @ parameters["logits"], seen @ parameters["to_come"])
