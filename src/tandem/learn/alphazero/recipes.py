"""The recipe of self-play with a search."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar

from pydantic import Field

from tandem.learn.alphazero.config import Config, Search, Simulations
from tandem.learn.settings import checked

MOST_GAMES = 10_000
"""That a recipe plays with what was learned, each under a search."""


@checked
@dataclass(frozen=True)
class SearchRecipe:
    """How self-play trains a network for a cell, any number of operators.

    Attributes:
      config: of the learner.
      waiting: an operator may let its turn pass although it could do something.
      simulations: of the search that plays what was learned.
      samples: how many games it plays, of which the best counts.
      what: it is, in a line; no setting.
    """

    config: Config
    waiting: bool = True
    simulations: Simulations = 32
    samples: Annotated[int, Field(ge=1, le=MOST_GAMES)] = 16
    what: str = field(default="", compare=False, kw_only=True)

    algorithm: ClassVar[str] = "alphazero"

    def to_dict(self) -> dict[str, Any]:
        return {
            "config": self.config.to_dict(),
            "waiting": self.waiting,
            "simulations": self.simulations,
            "samples": self.samples,
        }


ALPHAZERO = SearchRecipe(
    Config(
        search=Search(simulations=16, gumbel_scale=3.0),
        iterations=30,
        games=32,
        minibatch=256,
        minibatches=16,
    ),
    what="self-play with a search: any number of operators, plays cells that it was not trained on",
)
"""Ours: Gumbel search of 16 simulations, 32 games at a time. It is told what a cell is by features,
so that it plays cells it was not trained on.
"""
