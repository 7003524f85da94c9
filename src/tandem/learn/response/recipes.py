"""The recipe of a best response: PPO's configuration, and beside whom it is trained."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

from pydantic import ConfigDict

from tandem.learn.ppo.config import Config, Stage
from tandem.learn.forms import STRICT
from tandem.learn.settings import must_hold


@dataclass(frozen=True)
class ResponseRecipe:
    """How one decider learns beside people.

    Attributes:
      config: of PPO.
      people: beside whom, as `tandem.world.behaviour` reads it. Of a population file the training part.
    """

    config: Config
    people: str = "random:0..1+pace:0.5..3"

    algorithm: ClassVar[str] = "response"
    __pydantic_config__: ClassVar[ConfigDict] = STRICT

    def __post_init__(self) -> None:
        must_hold(self.faults())

    def faults(self) -> Iterator[str]:
        """Everything that is wrong with it, beside its `config`."""
        for name in ("share_actor", "share_critic"):
            if getattr(self.config, name):
                yield f"config.{name} true: one decider has nobody to share a network with."

    def to_dict(self) -> dict[str, Any]:
        return {"people": self.people, "config": self.config.to_dict()}


RESPONSE = ResponseRecipe(
    Config(
        stages=(
            Stage(steps=262_144, entropy=0.02, learning_rate=2e-3),
            Stage(steps=262_144, entropy=0.005, learning_rate=1e-3),
            Stage(steps=262_144, entropy=0.001, learning_rate=3e-4),
        ),
        environments=256,
        horizon=32,
        minibatch=2048,
        epochs=4,
        gae=0.97,
        hidden=(64, 64),
    )
)
"""Half a minute of one core for a cell of seven tasks. The settings were found on the thesis's cell and kept for all others."""
