"""The recipes of self-play with a search: ours, and that of Yu, Huang and Chang (2020) as it was described."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Self

from tandem.learn.alphazero.config import Config, Search, YuConfig


@dataclass(frozen=True)
class SearchRecipe:
    """How self-play trains a network for a cell, any number of operators.

    Attributes:
      config: of the learner.
      waiting: an operator may let its turn pass although it could do something.
      simulations: of the search that plays what was learned.
      samples: how many games it plays, of which the best counts.
    """

    config: Config
    waiting: bool = True
    simulations: int = 32
    samples: int = 16

    algorithm: ClassVar[str] = "alphazero"

    def to_dict(self) -> dict[str, Any]:
        return {"config": self.config.to_dict(), "waiting": self.waiting, "simulations": self.simulations, "samples": self.samples}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Self:
        return cls(**{**data, "config": Config.from_dict(data["config"])})


@dataclass(frozen=True)
class YuRecipe:
    """How Yu, Huang and Chang (2020) train, for a cell that can be put on their board.

    Attributes:
      config: of the learner.
      samples: games that are drawn from the visits when the best of several is asked for. ASSUMPTION: the authors play one.
    """

    config: YuConfig
    samples: int = 16

    algorithm: ClassVar[str] = "yu"

    def to_dict(self) -> dict[str, Any]:
        return {"config": self.config.to_dict(), "samples": self.samples}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Self:
        return cls(**{**data, "config": YuConfig.from_dict(data["config"])})


ALPHAZERO = SearchRecipe(Config(search=Search(simulations=16, gumbel_scale=3.0), iterations=30, games=32, minibatch=256, minibatches=16))
"""Ours: Gumbel search of 16 simulations, 32 games at a time. It is told what a cell is by features, so that it plays cells it was not trained on."""

YU_2020 = YuRecipe(YuConfig())
"""Yu, Huang and Chang (2020): their networks, search and schedule of 500 games. Their seed is 999."""
