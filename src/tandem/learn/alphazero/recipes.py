"""The recipe of self-play with a search."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, ClassVar

from pydantic import ConfigDict

from tandem.learn.alphazero.config import MOST_SIMULATIONS, Config, Search
from tandem.learn.forms import STRICT
from tandem.learn.settings import counts, must_hold

MOST_GAMES = 10_000
"""That a recipe plays with what was learned, each under a search."""


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
    simulations: int = 32
    samples: int = 16
    what: str = field(default="", compare=False, kw_only=True)

    algorithm: ClassVar[str] = "alphazero"
    __pydantic_config__: ClassVar[ConfigDict] = STRICT

    def __post_init__(self) -> None:
        must_hold(self.faults())

    def faults(self) -> Iterator[str]:
        """Everything that is wrong with it, beside its `config`."""
        yield from counts(self, ("simulations",), most=MOST_SIMULATIONS)
        yield from counts(self, ("samples",), most=MOST_GAMES)

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
