"""What a training is told: a frozen configuration that checks itself, with its stages as data."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any, NamedTuple, Self

from tandem.errors import UsageError
from tandem.learn.networks import ACTIVATIONS


class StageValues(NamedTuple):
    """One stage as numbers that a compiled loop reads; see `Stage`. `end_*` are what the stage ends at."""

    entropy: Any
    learning_rate: Any
    idle: Any
    normalise_advantages: Any
    episodes: Any
    steps: Any


@dataclass(frozen=True)
class Stage:
    """A stretch of the training. It ends with `episodes` or `steps`, whichever comes first; one of them may be None.

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

    def faults(self) -> Iterator[str]:
        """What is wrong with it."""
        if self.episodes is None and self.steps is None:
            yield "says neither `episodes` nor `steps`, so it would never end."
        for name in ("episodes", "steps"):
            value = getattr(self, name)
            if value is not None and not 0 < value < 2**31:
                yield f"{name} {value}: must be a whole number, 1 or more."
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
      stop_at_end: with one environment, an episode's end also ends the rollout, so that the agents learn after every episode.
      episode_limit: steps after which an episode is cut off (truncated, not terminated); None for never.
      minibatch, epochs: how often and in what portions a rollout is learned from.
      discount, gae: gamma and lambda of the advantage estimate.
      clip: of the probability ratio.
      value_weight: of the critic's loss.
      gradient_limit: largest norm of an agent's gradient, actor and critic together; None for no limit.
      hidden: units of the hidden layers, of actors and critics alike.
      activation: "relu" or "tanh".
      masked: illegal actions have probability 0, both when acting and when learning.
      normalise_returns: the critic works in units of the first rollout's returns (mean and spread, then kept).
      share_actor, share_critic: one network for all agents, which sees a one-hot of whose turn it is; else one each.
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

    def __post_init__(self) -> None:
        if faults := list(self.faults()):
            raise UsageError("The training's configuration does not hold:\n" + "\n".join(f"- {fault}" for fault in faults))

    def faults(self) -> Iterator[str]:
        """Everything that is wrong with it."""
        if not self.stages:
            yield "stages: none given; a training needs at least one."
        for place, stage in enumerate(self.stages, 1):
            yield from (f"stage {place}: {fault}" for fault in stage.faults())
        for name in ("environments", "horizon", "minibatch", "epochs"):
            if getattr(self, name) < 1:
                yield f"{name} {getattr(self, name)}: must be 1 or more."
        if self.episode_limit is not None and self.episode_limit < 1:
            yield f"episode_limit {self.episode_limit}: must be 1 or more, or None."
        for name in ("discount", "gae"):
            if not 0 <= getattr(self, name) <= 1:
                yield f"{name} {getattr(self, name)}: must lie between 0 and 1."
        if not 0 < self.clip < 1:
            yield f"clip {self.clip}: must lie between 0 and 1."
        if self.stop_at_end and self.environments != 1:
            yield f"stop_at_end: needs environments = 1, not {self.environments}."
        if not self.stop_at_end and (self.environments * self.horizon) % self.minibatch:
            yield f"minibatch {self.minibatch}: must divide environments x horizon = {self.environments * self.horizon}."
        if not self.hidden or min(self.hidden) < 1:
            yield f"hidden {self.hidden}: needs one layer or more, each of 1 unit or more."
        if self.activation not in ACTIVATIONS:
            yield f"activation {self.activation!r}: choose {' or '.join(ACTIVATIONS)}."

    def to_dict(self) -> dict[str, Any]:
        """Plain values, as a run keeps them."""
        return asdict(self)

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Self:
        """The inverse of `to_dict`. Raises UsageError for a key it does not know or a value out of range."""
        unknown = set(data) - {field.name for field in fields(cls)}
        if unknown:
            raise UsageError(
                f"configuration: unknown keys {', '.join(sorted(unknown))}; it knows {', '.join(sorted(field.name for field in fields(cls)))}."
            )
        stages = tuple(Stage(**stage) for stage in data.get("stages", ()))
        return cls(**{**data, "stages": stages, "hidden": tuple(data.get("hidden", (64, 64)))})
