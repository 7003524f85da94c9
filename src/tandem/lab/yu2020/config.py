"""What the training and the search of Yu, Huang and Chang (2020) are told: frozen configurations
that check themselves.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Annotated, Any, Literal

from pydantic import Field

from tandem.learn.alphazero.config import Simulations
from tandem.learn.settings import NotNegative, Positive, Units, checked

Rounds = Annotated[int, Field(ge=1, le=10_000)]


@checked
@dataclass(frozen=True)
class YuSearch:
    """How it is made.

    Attributes:
      simulations: for each decision.
      depth: own moves that it looks ahead at most.
      exploration: the constant c.
      temperature: tau; a move is drawn with N^(1/tau), so that 1000 draws almost evenly from what
        was looked at. 0 takes the most visited.
      quirk: Q leaves out the time of the move itself.
      unvisited: a move that was not looked at yet comes "first", or counts Q = "zero": then, where
        an untrained network expects negative costs, the first move is looked at and no other.
    """

    simulations: Simulations = 30
    depth: Simulations = 4
    exploration: NotNegative = 100.0
    temperature: NotNegative = 0.0
    quirk: bool = True
    unvisited: Literal["first", "zero"] = "first"


@checked
@dataclass(frozen=True)
class YuConfig:
    """How Yu, Huang and Chang (2020) train, as their code was read.

    `outer` times: first `5 x switch` games in which the robot learns, then as many in which the
    human does; after each game the agent's network is fitted once to its last positions. While one
    learns, the other plays what its own network likes best.

    ASSUMPTION: each agent has positions of its own; a game begins on the same board each time, or
    on one drawn from those that are given.

    Attributes:
      search: of the agent that learns.
      outer, inner, switch: games of each agent = outer x inner x switch.
      kept: positions that are learned from, the newest.
      minibatch: of a fit, which goes once over them.
      learning_rate: of Adam, its default.
      filters, dense, value_norm: see `yu_network`.
    """

    search: YuSearch = field(default_factory=lambda: YuSearch(temperature=1000.0))
    outer: Rounds = 10
    inner: Rounds = 5
    switch: Rounds = 5
    kept: Annotated[int, Field(ge=1, le=2**20)] = 200
    minibatch: Annotated[int, Field(ge=1, le=2**20)] = 16
    learning_rate: Positive = 1e-3
    filters: Units = 10
    dense: Units = 128
    value_norm: tuple[Positive, Positive] = (110.0, 90.0)

    @property
    def games(self) -> int:
        """All games of a training."""
        return 2 * self.outer * self.inner * self.switch

    def to_dict(self) -> dict[str, Any]:
        """Plain values, as a run keeps them."""
        return asdict(self)
