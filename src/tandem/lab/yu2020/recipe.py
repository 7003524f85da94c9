"""The recipe of Yu, Huang and Chang (2020), as it was described."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar

from pydantic import Field

from tandem.lab.yu2020.config import YuConfig
from tandem.learn.alphazero.recipes import MOST_GAMES
from tandem.learn.settings import checked


@checked
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
    samples: Annotated[int, Field(ge=1, le=MOST_GAMES)] = 16
    what: str = field(default="", compare=False, kw_only=True)

    algorithm: ClassVar[str] = "yu"

    def to_dict(self) -> dict[str, Any]:
        return {"config": self.config.to_dict(), "samples": self.samples}


YU_2020 = YuRecipe(YuConfig(), what="Yu, Huang and Chang 2020: self-play on the chessboard")
"""Yu, Huang and Chang (2020): their networks, search and schedule of 500 games. Their seed is
999.
"""
