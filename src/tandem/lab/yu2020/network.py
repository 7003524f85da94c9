"""The networks of Yu, Huang and Chang (2020): one for each agent, convolutions over the board as it
lies, with raw times.

Source: IEEE Access 2020, arXiv 2007.04140, and the authors' code as it was read (not copied): two
convolutions of 10 filters of 2 x 2 with ReLU, "same" padding, each behind a max-pooling of 2 x 2; a
dense layer of 128 with ReLU; a linear value and a policy over the columns. The value is learned in
units of 110 s for the robot and 90 s for the human.

ASSUMPTION: pooling drops an odd last row or column ("valid"), and weights start Glorot-uniform with
biases 0, as their library has it by default.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import jax
import jax.numpy as jnp
import numpy as np

from tandem.learn.alphazero.network import Prediction, drawn
from tandem.learn.networks import Perceptron, forward
from tandem.learn.settings import Units, checked

Array = Any


@checked
@dataclass(frozen=True)
class YuNetworks:
    """For games that show the board, `[h, w, 3]`. Every array of the parameters has a leading axis
    of agents, the robot first.

    Attributes:
      filters, dense: of each convolution; units of the dense layer.
      value_norm: seconds in a value of 1, robot's and human's.
    """

    filters: Units = 10
    dense: Units = 128
    value_norm: tuple[float, float] = (110.0, 90.0)

    kind: ClassVar[str] = "yu"

    def start(self, key: Array, game: Any) -> dict[str, Perceptron]:
        """Weights that know nothing yet, for boards of the game's height and width."""
        height, width = game.layout.time.shape[-2:]
        return self._start(key, (height // 4) * (width // 4) * self.filters, width)

    def like(self, arrays: Mapping[str, Any]) -> dict[str, Perceptron]:
        """As for the board whose size the arrays tell: what comes into the dense layer, and the
        columns of the policy.
        """

        def size(name: str, axis: int) -> int:
            shape = np.shape(arrays.get(name, ()))
            return int(shape[axis]) if len(shape) == 3 else 1

        flat, width = size("dense/0/weight", -2), size("policy/0/weight", -1)
        found: dict[str, Perceptron] = jax.eval_shape(
            lambda key: self._start(key, flat, width), jax.random.key(0)
        )
        return found

    def reads(self, parameters: Mapping[str, Perceptron], height: int, width: int) -> bool:
        """Whether these weights are for boards of that height and width."""
        flat = (height // 4) * (width // 4) * self.filters
        shapes = [np.shape(parameters[name]["0"]["weight"]) for name in ("dense", "policy")]
        return (shapes[0][-2], shapes[1][-1]) == (flat, width)

    def _start(self, key: Array, flat: int, width: int) -> dict[str, Perceptron]:
        sizes = {
            "first": (4 * 3, self.filters),
            "second": (4 * self.filters, self.filters),
            "dense": (flat, self.dense),
            "value": (self.dense, 1),
            "policy": (self.dense, width),
        }
        return jax.vmap(lambda key: drawn(key, sizes))(jax.random.split(key))

    def read(
        self, parameters: dict[str, Perceptron], seen: Array, least: Array, mover: Array
    ) -> Prediction:
        """What the mover's network predicts. `to_come` is in seconds: a game that shows the board
        has a unit of one second.

        Layer by layer both agents' weights are multiplied at once and the mover's half is taken:
        over many games that have different movers this is quicker than to look up each game's
        weights, or to run both networks to their end.
        """
        robots = mover <= 0

        def layer(name: str, inputs: Array) -> Array:
            both = {
                part: jnp.concatenate([array[0], array[1]], -1)
                for part, array in parameters[name]["0"].items()
            }
            of_both = forward(jnp, {"0": both}, inputs, "relu")
            half = of_both.shape[-1] // 2
            return jnp.where(robots, of_both[..., :half], of_both[..., half:])

        logits, value = self._flow(layer, seen)
        return Prediction(logits, value * jnp.where(robots, *self.value_norm))

    def outputs(self, parameters: dict[str, Perceptron], board: Array) -> tuple[Array, Array]:
        """`[w]` logits and `[]` value, in units of `value_norm`, of one agent's network."""
        return self._flow(
            lambda name, inputs: forward(jnp, parameters[name], inputs, "relu"), board
        )

    def _flow(self, layer: Callable[[str, Array], Array], board: Array) -> tuple[Array, Array]:
        """From the board to logits and value; `layer` multiplies by the layer of a name."""
        flow = board
        for name in ("first", "second"):
            flow = _pooled(jax.nn.relu(layer(name, _patches(flow))))
        flow = jax.nn.relu(layer("dense", flow.reshape(-1)))
        return layer("policy", flow), layer("value", flow)[0]


def _patches(image: Array) -> Array:
    """`[h, w, 4 x c]`: each cell with its right, upper and diagonal neighbour; zeros beyond the
    edge, as "same" padding of 2 x 2 puts them.
    """
    padded = jnp.pad(image, ((0, 1), (0, 1), (0, 0)))
    return jnp.concatenate([padded[:-1, :-1], padded[:-1, 1:], padded[1:, :-1], padded[1:, 1:]], -1)


def _pooled(image: Array) -> Array:
    """The largest of each 2 x 2 cells; an odd last row or column is dropped."""
    height, width, channels = image.shape
    whole = image[: height // 2 * 2, : width // 2 * 2]
    return whole.reshape(height // 2, 2, width // 2, 2, channels).max((1, 3))
