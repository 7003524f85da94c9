"""What a training is told: a frozen configuration that checks itself, with its stages as data."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any, ClassVar

from pydantic import ConfigDict

from tandem.learn.forms import STRICT
from tandem.learn.networks import ACTIVATIONS
from tandem.learn.settings import counts, must_hold, one_of
from tandem.learn.world import StageValues

MOST_STEPS = 2**22
"""Steps of a rollout that are held at once; a few gigabytes for a cell of a dozen tasks."""

MOST_LAYERS, MOST_UNITS = 16, 4096
"""Of a network, and of one of its layers."""


@dataclass(frozen=True)
class Stage:
    """A stretch of the training. It ends with `episodes` or `steps`, whichever comes first; one of
    them may be None.

    Attributes:
      episodes: finished episodes.
      steps: joint steps of the world, summed over the environments.
      entropy: weight of the entropy in the loss.
      learning_rate: of the optimiser.
      idle: what an agent is paid for a tick in which it is free and names no task.
      normalise_advantages: bring the advantages of a rollout to mean 0 and spread 1, per agent.
    """

    episodes: int | None = None
    steps: int | None = None
    entropy: float = 0.01
    learning_rate: float = 1e-4
    idle: float = 0.0
    normalise_advantages: bool = True

    __pydantic_config__: ClassVar[ConfigDict] = STRICT

    def faults(self) -> Iterator[str]:
        """What is wrong with it."""
        if self.episodes is None and self.steps is None:
            yield "episodes and steps: says neither, so it would never end."
        yield from counts(self, ("episodes", "steps"))
        if not (math.isfinite(self.entropy) and self.entropy >= 0):
            yield f"entropy {self.entropy}: must be a number, 0 or more."
        if not (math.isfinite(self.learning_rate) and self.learning_rate > 0):
            yield f"learning_rate {self.learning_rate}: must be more than 0."
        if not math.isfinite(self.idle):
            yield f"idle {self.idle}: must be a finite number."

    def values(self) -> StageValues:
        """As numbers; a missing limit is the largest count there is."""
        most = 2**31 - 1
        return StageValues(
            float(self.entropy),
            float(self.learning_rate),
            float(self.idle),
            bool(self.normalise_advantages),
            self.episodes or most,
            self.steps or most,
        )


@dataclass(frozen=True)
class Config:
    """Independent PPO (Schulman et al. 2017, arXiv:1707.06347), and how it is run.

    Attributes:
      stages: one after the other.
      environments: worlds that are played side by side, `N`.
      horizon: steps of each environment before the agents learn, `H`.
      stop_at_end: with one environment, an episode's end also ends the rollout, so that the agents
        learn after every episode.
      episode_limit: steps after which an episode is cut off (truncated, not terminated); None for
        never.
      minibatch, epochs: how often and in what portions a rollout is learned from.
      discount, gae: gamma and lambda of the advantage estimate.
      clip: of the probability ratio.
      value_weight: of the critic's loss.
      gradient_limit: largest norm of an agent's gradient, actor and critic together; None for no
        limit.
      hidden: units of the hidden layers, of actors and critics alike.
      activation: "relu" or "tanh".
      masked: illegal actions have probability 0, both when acting and when learning.
      normalise_returns: the critic works in units of the first rollout's returns (mean and spread,
        then kept).
      share_actor, share_critic: one network for all agents, which sees a one-hot of whose turn it
        is; else one each.
    """

    stages: tuple[Stage, ...]
    environments: int = 64
    horizon: int = 64
    stop_at_end: bool = False
    episode_limit: int | None = None
    minibatch: int = 1024
    epochs: int = 4
    discount: float = 1.0
    gae: float = 0.95
    clip: float = 0.2
    value_weight: float = 0.5
    gradient_limit: float | None = 0.5
    hidden: tuple[int, ...] = (64, 64)
    activation: str = "tanh"
    masked: bool = True
    normalise_returns: bool = True
    share_actor: bool = False
    share_critic: bool = False

    __pydantic_config__: ClassVar[ConfigDict] = STRICT

    def __post_init__(self) -> None:
        must_hold(self.faults())

    def faults(self) -> Iterator[str]:
        """Everything that is wrong with it."""
        if not self.stages:
            yield "stages: none given; a training needs at least one."
        for index, stage in enumerate(self.stages):
            yield from (f"stages.{index}.{fault}" for fault in stage.faults())
        yield from counts(self, ("environments", "horizon", "minibatch"), most=MOST_STEPS)
        yield from counts(self, ("epochs", "episode_limit"))
        for name in ("discount", "gae"):
            if not 0 <= getattr(self, name) <= 1:
                yield f"{name} {getattr(self, name)}: must lie between 0 and 1."
        if not 0 < self.clip < 1:
            yield f"clip {self.clip}: must lie between 0 and 1."
        if self.stop_at_end and self.environments != 1:
            yield f"stop_at_end: needs environments = 1, not {self.environments}."
        for name, least in (("value_weight", 0), ("gradient_limit", 1e-9)):
            value = getattr(self, name)
            if value is not None and not least <= value < math.inf:
                yield (
                    f"{name} {value}: must be"
                    f" {'0 or more' if least == 0 else 'more than 0, or null for no limit'}."
                )
        if self.environments * self.horizon > MOST_STEPS:
            yield (
                f"environments {self.environments} x horizon {self.horizon}: at most {MOST_STEPS:,}"
                " steps are held at once."
            )
        if (
            not self.stop_at_end
            and self.minibatch > 0
            and (self.environments * self.horizon) % self.minibatch
        ):
            yield (
                f"minibatch {self.minibatch}: must divide environments x horizon ="
                f" {self.environments * self.horizon}."
            )
        if (
            not 1 <= len(self.hidden) <= MOST_LAYERS
            or not 1 <= min(self.hidden) <= max(self.hidden) <= MOST_UNITS
        ):
            yield (
                f"hidden {list(self.hidden)}: needs 1 to {MOST_LAYERS} layers, each of 1 to"
                f" {MOST_UNITS:,} units."
            )
        yield from one_of(self, "activation", ACTIVATIONS)

    def to_dict(self) -> dict[str, Any]:
        """Plain values, as a run keeps them."""
        return asdict(self)
