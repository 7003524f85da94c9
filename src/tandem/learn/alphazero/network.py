"""A network that knows no sizes: it scores every move by what the move is and by what all moves
have in common.

The same weights read boards and cells of any size, with any number of operators, and the order of
the moves does not matter to them. What is still to come is told as what is certain (`Game.least`)
and something more, so that even an untrained network is not far off.

`score` works on NumPy and on JAX arrays alike. Axes: `K` moves, `F` and `G` features of a move and
of the whole, `H` units.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from types import ModuleType
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Protocol

import numpy as np

from tandem.learn.networks import Perceptron, forward, init
from tandem.learn.observation import MOVE_FEATURES, WHOLE_FEATURES, Observation
from tandem.learn.settings import Units, checked
from tandem.world.arrays import namespace

if TYPE_CHECKING:
    from tandem.learn.env import Game

Array = Any
Parameters = Any
State = Any


class Prediction(NamedTuple):
    """logits: `[K]`, over all moves, legal or not. to_come: `[]`, the cost that is still to come,
    in units of the game.
    """

    logits: Array
    to_come: Array


class Network(Protocol):
    """A network that a search can ask. It is hashable: it holds sizes, never weights.

    Attributes:
      kind: what its files call its form.
    """

    kind: ClassVar[str]

    def start(self, key: Array, game: Game) -> Parameters:
        """Weights that know nothing yet."""

    def like(self, arrays: Mapping[str, Any]) -> Parameters:
        """The form of its weights: leaves that have a shape and a dtype. What the sizes do not say,
        such as a board's, is taken from `arrays`.
        """

    def read(self, parameters: Parameters, seen: Any, least: Array, mover: Array) -> Prediction:
        """What it thinks of what `game.observe` shows, when `mover` is to play and a cost of
        `least` units is certain.
        """


def predict(network: Network, parameters: Parameters, game: Game, state: State) -> Prediction:
    """The network's prediction of a state; nothing is to come once the game is over."""
    found = network.read(
        parameters, game.observe(state), game.least(state) / game.unit, game.to_play(state)
    )
    xp = namespace(found.logits)
    return found._replace(to_come=xp.where(game.is_over(state), 0.0, found.to_come))


def greedy_action(network: Network, parameters: Parameters, game: Game, state: State) -> Array:
    """`[]` int32, the legal move with the highest logit; any once the game is over."""
    logits = predict(network, parameters, game, state).logits
    xp = namespace(logits)
    return xp.argmax(xp.where(game.legal(state), logits, IMPOSSIBLE))


IMPOSSIBLE = -1e9
"""The logit of a move that is not legal: its probability is 0 and its gradient finite."""


@checked
@dataclass(frozen=True)
class Scorer:
    """The network for games that show an `Observation`.

    Attributes:
      units: of each layer, `H`.
    """

    units: Units = 64

    kind: ClassVar[str] = "scorer"

    def start(self, key: Array, game: Game | None = None) -> dict[str, Perceptron]:
        """Glorot-uniform weights; those of the last layer of the policy are small, so that it
        prefers nothing.
        """
        return drawn(key, self._sizes, {"policy": 0.01})

    def like(self, arrays: Mapping[str, Any]) -> dict[str, Perceptron]:
        zeros = partial(np.zeros, dtype=np.float32)
        return {name: init(zeros, size) for name, size in self._sizes.items()}

    @property
    def _sizes(self) -> dict[str, tuple[int, ...]]:
        """Inputs, hidden units and outputs of each part."""
        units = self.units
        return {
            "moves": (MOVE_FEATURES, units),
            "whole": (WHOLE_FEATURES, units),
            "mix": (units, units),
            "policy_row": (units, units),
            "policy_pool": (2 * units, units),
            "policy": (units, 1),
            "value": (2 * units + WHOLE_FEATURES, units, 1),
        }

    def read(
        self, parameters: dict[str, Perceptron], seen: Observation, least: Array, mover: Array
    ) -> Prediction:
        return self.score(namespace(seen.moves), parameters, seen, least)

    def score(
        self, xp: ModuleType, parameters: dict[str, Perceptron], seen: Observation, least: Array
    ) -> Prediction:
        """`read` over an array namespace."""
        run = partial(forward, xp, activation="relu")
        apply = lambda name, inputs: run(parameters[name], inputs)  # noqa: E731
        first = xp.maximum(apply("moves", seen.moves) + apply("whole", seen.whole)[None], 0)
        rows = xp.maximum(apply("mix", first), 0) * seen.there[:, None]
        number = xp.maximum(seen.there.sum(), 1)
        pool = xp.concatenate([rows.sum(0) / number, rows.max(0)])
        scored = xp.maximum(apply("policy_row", rows) + apply("policy_pool", pool)[None], 0)
        more = apply("value", xp.concatenate([pool, seen.whole]))[0]
        return Prediction(
            apply("policy", scored)[:, 0], least + xp.logaddexp(more, xp.zeros_like(more))
        )


def drawn(
    key: Array, sizes: Mapping[str, tuple[int, ...]], last: Mapping[str, float] | None = None
) -> dict[str, Perceptron]:
    """Networks by name, their weights from one draw: every draw of its own takes a second to
    compile.

    Args:
      last: by name, see `networks.init`; 1 when absent.
    """
    import jax

    numbers = jax.random.uniform(
        key, (sum(a * b for size in sizes.values() for a, b in pairwise(size)),), minval=-1.0
    )
    used = 0

    def draw(shape: tuple[int, ...]) -> Array:
        nonlocal used
        used += shape[0] * shape[1]
        return numbers[used - shape[0] * shape[1] : used].reshape(shape)

    return {name: init(draw, size, (last or {}).get(name, 1.0)) for name, size in sizes.items()}
