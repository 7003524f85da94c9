"""What a training is told: a frozen configuration that checks itself, with its stages as data."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Annotated, Any

from pydantic import Field

from tandem.learn.forms import key_of
from tandem.learn.networks import ACTIVATIONS
from tandem.learn.settings import (
    Count,
    NotNegative,
    Positive,
    Share,
    Units,
    checked,
    must_hold,
)
from tandem.learn.world import StageValues

MOST_STEPS = 2**22
"""Steps of a rollout that are held at once; a few gigabytes for a cell of a dozen tasks."""

MOST_LAYERS = 16
"""Of a network."""

Steps = Annotated[int, Field(ge=1, le=MOST_STEPS)]


@checked
@dataclass(frozen=True)
class Stage:
    """A stretch of the training. It ends with `episodes`, `steps` or `stop_return`, whichever comes
    first; of the first two one may be None.

    Attributes:
      episodes: finished episodes.
      steps: joint steps of the world, summed over the environments.
      entropy: weight of the entropy in the loss.
      learning_rate: of the optimiser.
      idle: what an agent is paid for a tick in which it is free and names no task.
      normalise_advantages: bring the advantages of a rollout to mean 0 and spread 1, per agent.
      stop_return: the stage ends once every agent's return of the episodes that a rollout ended (on
        the mean; with `stop_at_end` it is one episode) is this much; None for never.
    """

    episodes: Count | None = None
    steps: Count | None = None
    entropy: NotNegative = 0.01
    learning_rate: Positive = 1e-4
    idle: float = 0.0
    normalise_advantages: bool = True
    stop_return: float | None = None

    def __post_init__(self) -> None:
        if self.episodes is None and self.steps is None:
            must_hold(["episodes and steps: says neither, so it would never end."])

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
            math.inf if self.stop_return is None else float(self.stop_return),
        )


@checked
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
      adam_epsilon: what Adam adds to the root of the second moment.
      l2: weight of half the squared weights in the loss, biases aside; through Adam's moments, as
        part of the gradient.
      small_start: the actor's last layer begins at this share of its size: a small number makes a
        first policy that prefers nothing.
      layer_per_channel: each channel of the observation has a first layer of its own, and the
        second sees them all. A world says their sizes as `channels`; one that does not has one.
      hidden: units of the hidden layers, of actors and critics alike.
      activation: "relu" or "tanh".
      masked: illegal actions have probability 0, both when acting and when learning.
      normalise_returns: the critic works in units of the first rollout's returns (mean and spread,
        then kept).
      share_actor, share_critic: one network for all agents, which sees a one-hot of whose turn it
        is; else one each.
    """

    stages: Annotated[tuple[Stage, ...], Field(min_length=1)]
    environments: Steps = 64
    horizon: Steps = 64
    stop_at_end: bool = False
    episode_limit: Count | None = None
    minibatch: Steps = 1024
    epochs: Count = 4
    discount: Share = 1.0
    gae: Share = 0.95
    clip: Annotated[float, Field(gt=0, lt=1)] = 0.2
    value_weight: NotNegative = 0.5
    gradient_limit: Positive | None = 0.5
    hidden: Annotated[tuple[Units, ...], Field(min_length=1, max_length=MOST_LAYERS)] = (64, 64)
    activation: Annotated[str, key_of(ACTIVATIONS)] = "tanh"
    masked: bool = True
    normalise_returns: bool = True
    share_actor: bool = False
    share_critic: bool = False
    adam_epsilon: Positive = 1e-5
    l2: NotNegative = 0.0
    small_start: Positive = 0.01
    layer_per_channel: bool = False

    def __post_init__(self) -> None:
        must_hold(self.faults())

    def faults(self) -> Iterator[str]:
        """What is wrong with settings that each are right."""
        if self.layer_per_channel and (self.share_actor or self.share_critic):
            yield "layer_per_channel: a network that agents share has no channels of its own."
        if self.stop_at_end and self.environments != 1:
            yield f"stop_at_end: needs environments = 1, not {self.environments}."
        if self.environments * self.horizon > MOST_STEPS:
            yield (
                f"environments {self.environments} x horizon {self.horizon}: at most {MOST_STEPS:,}"
                " steps are held at once."
            )
        if not self.stop_at_end and (self.environments * self.horizon) % self.minibatch:
            yield (
                f"minibatch {self.minibatch}: must divide environments x horizon ="
                f" {self.environments * self.horizon}."
            )

    def to_dict(self) -> dict[str, Any]:
        """Plain values, as a run keeps them."""
        return asdict(self)
