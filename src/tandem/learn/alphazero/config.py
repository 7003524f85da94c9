"""What self-play and its searches are told: frozen configurations that check themselves. No JAX is
needed to read them.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Annotated, Any, Literal

from pydantic import Field

from tandem.learn.settings import (
    Batch,
    Count,
    NotNegative,
    Positive,
    Share,
    Units,
    checked,
)

Simulations = Annotated[int, Field(ge=1, le=10_000)]
"""Of a search; its tree is held for all games at once."""


@checked
@dataclass(frozen=True)
class Search:
    """How a search is made.

    Attributes:
      kind: "gumbel" or "puct".
      simulations: for each decision.
      depth: moves that it looks ahead at most; None for no limit.
      considered: of "gumbel": how many moves of the root are looked at.
      gumbel_scale: of "gumbel": 1 draws, 0 is sure.
      exploration: of "puct": the constant c.
      noise, noise_alpha: of "puct": share and concentration of the Dirichlet noise at the root.
      temperature: of "puct": of the draw from the visits; 0 takes the most visited.
    """

    kind: Literal["gumbel", "puct"] = "gumbel"
    simulations: Simulations = 16
    depth: Simulations | None = None
    considered: Simulations = 8
    gumbel_scale: NotNegative = 1.0
    exploration: NotNegative = 1.25
    noise: Share = 0.25
    noise_alpha: Positive = 0.3
    temperature: NotNegative = 1.0


@checked
@dataclass(frozen=True)
class EpsilonGreedy:
    """No search: the network's greedy move, and with a probability of `share` any legal move
    instead.
    """

    share: Share = 0.05


@checked
@dataclass(frozen=True)
class Config:
    """How a network is trained.

    Attributes:
      search: of every move of the self-play.
      iterations: rounds of playing and learning.
      games: played side by side in a round, `B`; drawn from those that the training is given.
      kept: rounds whose experience is learned from.
      minibatch, minibatches: how much, and how often, is learned in a round.
      learning_rate: of Adam; it falls to a tenth of that along a straight line.
      value_weight: of the value's loss.
      gradient_limit: largest norm of the gradient.
      trust: see `selfplay`.
      imitated: share of each minibatch that comes from the cheapest games so far, with the moves
        that were made in them (self-imitation, Oh et al. 2018). What was found by luck is kept, so
        that the search may draw boldly: `search.gumbel_scale`.
      units: of the network's layers.
    """

    search: Search = field(default_factory=lambda: Search(gumbel_scale=3.0))
    iterations: Count = 60
    games: Batch = 64
    kept: Annotated[int, Field(ge=1, le=1000)] = 4
    minibatch: Batch = 512
    minibatches: Count = 24
    learning_rate: Positive = 2e-3
    value_weight: Positive = 0.25
    gradient_limit: Positive = 1.0
    trust: Share = 1.0
    imitated: Annotated[float, Field(ge=0, lt=1)] = 0.25
    units: Units = 64

    def to_dict(self) -> dict[str, Any]:
        """Plain values, as a run keeps them."""
        return asdict(self)
