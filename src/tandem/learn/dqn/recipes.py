"""The recipes of deep Q-learning: ours, and that of Yu, Huang and Chang (2021) as far as it is known."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Self

from tandem.learn.dqn.config import Config


@dataclass(frozen=True)
class ValueRecipe:
    """How deep Q-learning trains the agents of a cell, any number of them.

    Attributes:
      config: of the learner.
      waiting: an operator may let its turn pass although it could do something.
      samples: games in which a twentieth of the moves is random, of which the best counts.
    """

    config: Config
    waiting: bool = True
    samples: int = 64

    algorithm: ClassVar[str] = "dqn"

    def to_dict(self) -> dict[str, Any]:
        return {"config": self.config.to_dict(), "waiting": self.waiting, "samples": self.samples}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Self:
        return cls(**{**data, "config": Config.from_dict(data["config"])})


DQN = ValueRecipe(Config(double=True, agents="each", horizon="next"))
"""Ours: double DQN, a network for each operator; a value goes on with whoever decides next."""

YU_2021 = ValueRecipe(Config(), waiting=False)
"""Yu, Huang and Chang (2021): a DQN for each agent on the same game, nobody waits. All numbers are ASSUMPTION: none is public."""
