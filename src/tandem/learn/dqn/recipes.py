"""The recipe of deep Q-learning."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar

from pydantic import Field

from tandem.learn.dqn.config import Config
from tandem.learn.settings import checked

MOST_GAMES = 100_000
"""That a recipe plays with what was learned."""


@checked
@dataclass(frozen=True)
class ValueRecipe:
    """How deep Q-learning trains the agents of a cell, any number of them.

    Attributes:
      config: of the learner.
      waiting: an operator may let its turn pass although it could do something.
      samples: games in which a twentieth of the moves is random, of which the best counts.
      what: it is, in a line; no setting.
    """

    config: Config
    waiting: bool = True
    samples: Annotated[int, Field(ge=1, le=MOST_GAMES)] = 64
    what: str = field(default="", compare=False, kw_only=True)

    algorithm: ClassVar[str] = "dqn"

    def to_dict(self) -> dict[str, Any]:
        return {"config": self.config.to_dict(), "waiting": self.waiting, "samples": self.samples}


DQN = ValueRecipe(
    Config(double=True, agents="each", horizon="next"),
    what="deep Q-learning: a network for each operator, any number of them",
)
"""Ours: double DQN, a network for each operator; a value goes on with whoever decides next."""
