"""The recipe of Yu, Huang and Chang (2020), as it was described."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, ClassVar

from pydantic import ConfigDict

from tandem.lab.yu2020.config import YuConfig
from tandem.learn.alphazero.recipes import MOST_GAMES
from tandem.learn.forms import STRICT
from tandem.learn.settings import counts, must_hold


@dataclass(frozen=True)
class YuRecipe:
    """How Yu, Huang and Chang (2020) train, for a cell that can be put on their board.

    Attributes:
      config: of the learner.
      samples: games that are drawn from the visits when the best of several is asked for.
        ASSUMPTION: the authors play one.
      what: it is, in a line; no setting.
    """

    config: YuConfig
    samples: int = 16
    what: str = field(default="", compare=False, kw_only=True)

    algorithm: ClassVar[str] = "yu"
    __pydantic_config__: ClassVar[ConfigDict] = STRICT

    def __post_init__(self) -> None:
        must_hold(self.faults())

    def faults(self) -> Iterator[str]:
        """Everything that is wrong with it, beside its `config`."""
        yield from counts(self, ("samples",), most=MOST_GAMES)

    def to_dict(self) -> dict[str, Any]:
        return {"config": self.config.to_dict(), "samples": self.samples}


YU_2020 = YuRecipe(YuConfig(), what="Yu, Huang and Chang 2020: self-play on the chessboard")
"""Yu, Huang and Chang (2020): their networks, search and schedule of 500 games. Their seed is
999.
"""
