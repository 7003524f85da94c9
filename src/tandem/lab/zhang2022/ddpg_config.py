"""What a training with two actors and a shared critic is told; see `ddpg.py`. Knows no JAX."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Annotated, Any

from pydantic import Field

from tandem.learn.forms import key_of
from tandem.learn.networks import ACTIVATIONS
from tandem.learn.settings import Count, NotNegative, Positive, Share, checked, must_hold

ACTORS_LEARN = ("relaxed", "expected")


@checked
@dataclass(frozen=True)
class Config:
    """A training. Nothing of it is public for Zhang et al. (2022): every number is an ASSUMPTION
    and an option.

    Attributes:
      steps: joint steps of the world, summed over the environments.
      environments: worlds played side by side, `N`.
      updates: gradient steps after each step of all environments.
      warm_up: steps before the first gradient step; until then every pair is drawn at random.
      replay: transitions kept, the newest.
      minibatch: transitions a gradient step, `B`.
      ahead: rewards summed before the critic is asked (n-step returns); 1 in DDPG.
      discount: of a decision.
      target_rate: how far the target networks move to the others after each gradient step.
      actor_rate, critic_rate: learning rates at the start; they fall linearly to `last_rate` times
        that.
      hidden: units of the hidden layers, of actors and critic alike.
      activation: "relu" or "tanh".
      candidates: choices of each actor that the critic is asked about; 1 lets the actors decide
        alone.
      actors_learn: "relaxed", DDPG's gradient of the critic at the actors' probabilities; or
        "expected", the critic's value of each candidate weighted with its probability.
      temperature: of the softmax that makes probabilities of scores in (-1, 1).
      entropy: weight of the actors' entropy, with "expected".
      double: the networks choose the next pair and the targets value it (van Hasselt et al. 2016,
        arXiv:1509.06461); else the targets do both.
      explore_from, explore_to: share of random pairs at the start and at the end, falling linearly
        until `explore_until` of the steps.
      noise: spread of the noise on the human's scores; 0 for none.
      noise_memory: 0 for Gaussian noise; towards 1 for Ornstein-Uhlenbeck noise that lasts (1 -
        theta there).
      noise_in_targets: the human's next choice is noisy in the critic's targets too, so that the
        values are those of working with such a human.
      gradient_limit: largest norm of a gradient; None for no limit.
    """

    steps: Count = 48_000
    environments: Count = 16
    updates: Count = 1
    warm_up: Count = 1_000
    replay: Count = 16_000
    minibatch: Count = 64
    ahead: Count = 1
    discount: Share = 0.99
    target_rate: Share = 0.005
    actor_rate: Positive = 1e-4
    critic_rate: Positive = 1e-3
    last_rate: Share = 1.0
    hidden: Annotated[tuple[Count, ...], Field(min_length=1)] = (64, 64)
    activation: Annotated[str, key_of(ACTIVATIONS)] = "relu"
    candidates: Count = 3
    actors_learn: Annotated[str, key_of(ACTORS_LEARN)] = "relaxed"
    temperature: Positive = 0.2
    entropy: NotNegative = 0.0
    double: bool = False
    explore_from: Share = 1.0
    explore_to: Share = 0.05
    explore_until: Share = 0.5
    noise: NotNegative = 0.0
    noise_memory: Share = 0.85
    noise_in_targets: bool = False
    gradient_limit: Positive | None = 10.0

    def __post_init__(self) -> None:
        if self.replay // self.environments < self.ahead + 2:
            must_hold(
                [
                    f"replay {self.replay}: holds too few steps of {self.environments} environments"
                    f" for returns over {self.ahead} of them."
                ]
            )

    @property
    def rounds(self) -> int:
        """Steps of all environments side by side."""
        return math.ceil(self.steps / self.environments)

    def to_dict(self) -> dict[str, Any]:
        """Plain values, as a record keeps them."""
        return asdict(self)
