"""How PPO learns a cell: beside people who do as they are asked, or beside people who do as they
like.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Protocol, TypeVar

from tandem.learn.ppo.config import Config, Stage
from tandem.learn.settings import checked, must_hold


@checked
@dataclass(frozen=True)
class Recipe:
    """How one decider learns to act for all operators of a cell, any number of them.

    Attributes:
      config: of PPO.
      people: beside whom, as `tandem.world.behaviour` reads it. Of a population file the training
        part.
      what: it is, in a line; no setting.
    """

    config: Config
    people: str = "compliant"
    what: str = field(default="", compare=False, kw_only=True)

    algorithm: ClassVar[str] = "ppo"

    def __post_init__(self) -> None:
        must_hold(self.faults())

    def faults(self) -> Iterator[str]:
        """Everything that is wrong with it, beside its `config`."""
        for name in ("share_actor", "share_critic"):
            if getattr(self.config, name):
                yield f"config.{name} true: one decider has nobody to share a network with."

    def to_dict(self) -> dict[str, Any]:
        return {"people": self.people, "config": self.config.to_dict()}


class Staged(Protocol):
    """A recipe whose learner goes through stages: a frozen dataclass."""

    __dataclass_fields__: ClassVar[dict[str, Any]]

    @property
    def config(self) -> Config:
        """Of the learner."""


R = TypeVar("R", bound=Staged)


def longer(base: R, factor: float) -> R:
    """The recipe with `factor` times the episodes and steps in every stage; a step budget stays
    whole rollouts.
    """

    def stretched(stage: Stage) -> Stage:
        rollout = base.config.environments * base.config.horizon
        steps = stage.steps and max(1, round(stage.steps * factor / rollout)) * rollout
        return replace(
            stage, episodes=stage.episodes and max(1, round(stage.episodes * factor)), steps=steps
        )

    return replace(
        base,
        config=replace(base.config, stages=tuple(stretched(stage) for stage in base.config.stages)),
    )


TANDEM = Recipe(
    Config(
        stages=(
            Stage(steps=131_072, entropy=0.1, learning_rate=2e-3),
            Stage(steps=131_072, entropy=0.03, learning_rate=1e-3),
            Stage(steps=65_536, entropy=0.003, learning_rate=3e-4),
        ),
        environments=128,
        horizon=32,
        minibatch=1024,
        epochs=4,
        gae=0.97,
        hidden=(64, 64),
    ),
    what="PPO: one decider for all operators of any cell, beside people who do as they are asked",
)
"""Ours, for any cell. With a fifth of these weights of the entropy more seeds end in a plan that is
good and not the best, on the larger cells in `examples/`.
"""

RESPONSE = Recipe(
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
    ),
    people="random:0..1+pace:0.5..3",
    what="the same beside people who do as they like, for `tandem simulate` and `tandem dispatch`",
)
"""Half a minute of one core for a cell of seven tasks. The settings were found on the thesis's cell
and kept for all others.
"""
