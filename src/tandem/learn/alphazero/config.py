"""What self-play and its searches are told: frozen configurations that check themselves. No JAX is
needed to read them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from typing import Any, ClassVar, Literal

from pydantic import ConfigDict

from tandem.errors import UsageError
from tandem.learn.forms import STRICT
from tandem.learn.settings import counts, must_hold, one_of

MOST_SIMULATIONS = 10_000
"""Of a search; its tree is held for all games at once."""


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
    simulations: int = 16
    depth: int | None = None
    considered: int = 8
    gumbel_scale: float = 1.0
    exploration: float = 1.25
    noise: float = 0.25
    noise_alpha: float = 0.3
    temperature: float = 1.0

    __pydantic_config__: ClassVar[ConfigDict] = STRICT

    def __post_init__(self) -> None:
        must_hold(self.faults())

    def faults(self) -> Iterator[str]:
        """What is wrong with it."""
        yield from one_of(self, "kind", ("gumbel", "puct"))
        yield from counts(self, ("simulations", "considered", "depth"), most=MOST_SIMULATIONS)
        for name in ("gumbel_scale", "exploration", "temperature"):
            if not getattr(self, name) >= 0:
                yield f"{name} {getattr(self, name)}: must be 0 or more."
        if not 0 <= self.noise <= 1 or not self.noise_alpha > 0:
            yield (
                f"noise {self.noise}, noise_alpha {self.noise_alpha}: a share from 0 to 1, and a"
                " number above 0."
            )


@dataclass(frozen=True)
class EpsilonGreedy:
    """No search: the network's greedy move, and with a probability of `share` any legal move
    instead.
    """

    share: float = 0.05

    def __post_init__(self) -> None:
        if not 0 <= self.share <= 1:
            raise UsageError(f"share {self.share}: must lie between 0 and 1.")


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
    iterations: int = 60
    games: int = 64
    kept: int = 4
    minibatch: int = 512
    minibatches: int = 24
    learning_rate: float = 2e-3
    value_weight: float = 0.25
    gradient_limit: float = 1.0
    trust: float = 1.0
    imitated: float = 0.25
    units: int = 64

    __pydantic_config__: ClassVar[ConfigDict] = STRICT

    def __post_init__(self) -> None:
        must_hold(self.faults())

    def faults(self) -> Iterator[str]:
        """Everything that is wrong with it."""
        yield from counts(self, ("iterations", "minibatches"))
        yield from counts(self, ("games", "minibatch"), most=2**16)
        yield from counts(self, ("kept",), most=1000)
        yield from counts(self, ("units",), most=4096)
        for name in ("learning_rate", "value_weight", "gradient_limit"):
            if not getattr(self, name) > 0:
                yield f"{name} {getattr(self, name)}: must be more than 0."
        if not 0 <= self.trust <= 1:
            yield f"trust {self.trust}: must lie between 0 and 1."
        if not 0 <= self.imitated < 1:
            yield f"imitated {self.imitated}: a share from 0 to less than 1."

    def to_dict(self) -> dict[str, Any]:
        """Plain values, as a run keeps them."""
        return asdict(self)
