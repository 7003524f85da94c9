"""What the training and the search of Yu, Huang and Chang (2020) are told: frozen configurations
that check themselves.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from typing import Any, ClassVar, Literal

from pydantic import ConfigDict

from tandem.learn.alphazero.config import MOST_SIMULATIONS
from tandem.learn.forms import STRICT
from tandem.learn.settings import counts, must_hold, one_of


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

    simulations: int = 30
    depth: int = 4
    exploration: float = 100.0
    temperature: float = 0.0
    quirk: bool = True
    unvisited: Literal["first", "zero"] = "first"

    __pydantic_config__: ClassVar[ConfigDict] = STRICT

    def __post_init__(self) -> None:
        must_hold(self.faults())

    def faults(self) -> Iterator[str]:
        """What is wrong with it."""
        yield from counts(self, ("simulations", "depth"), most=MOST_SIMULATIONS)
        for name in ("exploration", "temperature"):
            if not getattr(self, name) >= 0:
                yield f"{name} {getattr(self, name)}: must be 0 or more."
        yield from one_of(self, "unvisited", ("first", "zero"))


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
    outer: int = 10
    inner: int = 5
    switch: int = 5
    kept: int = 200
    minibatch: int = 16
    learning_rate: float = 1e-3
    filters: int = 10
    dense: int = 128
    value_norm: tuple[float, float] = (110.0, 90.0)

    __pydantic_config__: ClassVar[ConfigDict] = STRICT

    def __post_init__(self) -> None:
        must_hold(self.faults())

    def faults(self) -> Iterator[str]:
        """Everything that is wrong with it."""
        yield from counts(self, ("outer", "inner", "switch"), most=10_000)
        yield from counts(self, ("kept", "minibatch"), most=2**20)
        yield from counts(self, ("filters", "dense"), most=4096)
        if not self.learning_rate > 0:
            yield f"learning_rate {self.learning_rate}: must be more than 0."
        if len(self.value_norm) != 2 or not min(self.value_norm) > 0:
            yield f"value_norm {self.value_norm}: needs two numbers above 0."

    @property
    def games(self) -> int:
        """All games of a training."""
        return 2 * self.outer * self.inner * self.switch

    def to_dict(self) -> dict[str, Any]:
        """Plain values, as a run keeps them."""
        return asdict(self)
