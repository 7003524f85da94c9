"""What a move costs, as each agent has learned it: the network of `alphazero.network`, read as
Q-values.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import Field

from tandem.learn.alphazero.network import Prediction, Scorer
from tandem.learn.networks import mapped
from tandem.learn.observation import Observation
from tandem.learn.settings import Units, checked
from tandem.world.arrays import namespace

Array = Any

MOST_AGENTS = 1000
"""That decide in one cell."""


@checked
@dataclass(frozen=True)
class ValueNetworks:
    """Q(s, a) is the cost that is still to come when the agent whose turn it is does a: what the
    state says plus what the move says.

    Attributes:
      agents: so many networks, one for each; 1 decides for all. Every array of the parameters has
        them as its leading axis.
      units: of the layers.
    """

    agents: Annotated[int, Field(ge=1, le=MOST_AGENTS)] = 1
    units: Units = 64

    kind: ClassVar[str] = "values"

    def start(self, key: Array, game: Any = None) -> Any:
        import jax

        return jax.vmap(Scorer(self.units).start)(jax.random.split(key, self.agents))

    def like(self, arrays: Mapping[str, Any]) -> Any:
        def each(leaf: Any) -> Any:
            return np.zeros((self.agents, *leaf.shape), leaf.dtype)

        return mapped(each, Scorer(self.units).like(arrays))

    def read(self, parameters: Any, seen: Observation, least: Array, mover: Array) -> Prediction:
        """The logits are minus the Q-values, so that the best move has the largest."""
        xp, scorer = namespace(seen.moves), Scorer(self.units)
        mine = xp.clip(mover, 0, self.agents - 1)
        if xp is np:
            found = scorer.score(np, mapped(lambda leaf: leaf[mine], parameters), seen, least)
            return Prediction(-(found.to_come + found.logits), found.to_come)
        import jax

        each = jax.vmap(lambda weights: scorer.score(xp, weights, seen, least))(parameters)
        to_come = each.to_come[mine]
        return Prediction(-(to_come + each.logits[mine]), to_come)
