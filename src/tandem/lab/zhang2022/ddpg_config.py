"""What a training with two actors and a shared critic is told; see `ddpg.py`. Knows no JAX."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from typing import Any

from tandem.errors import UsageError
from tandem.learn.networks import ACTIVATIONS

ACTORS_LEARN = ("relaxed", "expected")


RANGES: tuple[tuple[tuple[str, ...], Callable[[float], bool], str], ...] = (
    (
        (
            "steps",
            "environments",
            "updates",
            "warm_up",
            "replay",
            "minibatch",
            "ahead",
            "candidates",
        ),
        lambda value: value >= 1,
        "be 1 or more",
    ),
    (
        (
            "discount",
            "target_rate",
            "last_rate",
            "explore_from",
            "explore_to",
            "explore_until",
            "noise_memory",
        ),
        lambda value: 0 <= value <= 1,
        "lie between 0 and 1",
    ),
    (
        ("actor_rate", "critic_rate", "temperature"),
        lambda value: math.isfinite(value) and value > 0,
        "be more than 0",
    ),
    (
        ("noise", "entropy"),
        lambda value: math.isfinite(value) and value >= 0,
        "be a number, 0 or more",
    ),
)
"""Settings, what holds of each, and the same in words."""


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

    steps: int = 48_000
    environments: int = 16
    updates: int = 1
    warm_up: int = 1_000
    replay: int = 16_000
    minibatch: int = 64
    ahead: int = 1
    discount: float = 0.99
    target_rate: float = 0.005
    actor_rate: float = 1e-4
    critic_rate: float = 1e-3
    last_rate: float = 1.0
    hidden: tuple[int, ...] = (64, 64)
    activation: str = "relu"
    candidates: int = 3
    actors_learn: str = "relaxed"
    temperature: float = 0.2
    entropy: float = 0.0
    double: bool = False
    explore_from: float = 1.0
    explore_to: float = 0.05
    explore_until: float = 0.5
    noise: float = 0.0
    noise_memory: float = 0.85
    noise_in_targets: bool = False
    gradient_limit: float | None = 10.0

    def __post_init__(self) -> None:
        if faults := list(self.faults()):
            raise UsageError(
                "The training's configuration does not hold:\n"
                + "\n".join(f"- {fault}" for fault in faults)
            )

    def faults(self) -> Iterator[str]:
        """Everything that is wrong with it."""
        for names, holds, must in RANGES:
            for name in names:
                if not holds(getattr(self, name)):
                    yield f"{name} {getattr(self, name)}: must {must}."
        if self.environments >= 1 and self.replay // self.environments < self.ahead + 2:
            yield (
                f"replay {self.replay}: holds too few steps of {self.environments} environments for"
                f" returns over {self.ahead} of them."
            )
        if not self.hidden or min(self.hidden) < 1:
            yield f"hidden {self.hidden}: needs one layer or more, each of 1 unit or more."
        if self.activation not in ACTIVATIONS:
            yield f"activation {self.activation!r}: choose {' or '.join(ACTIVATIONS)}."
        if self.actors_learn not in ACTORS_LEARN:
            yield f"actors_learn {self.actors_learn!r}: choose {' or '.join(ACTORS_LEARN)}."

    @property
    def rounds(self) -> int:
        """Steps of all environments side by side."""
        return math.ceil(self.steps / self.environments)

    def to_dict(self) -> dict[str, Any]:
        """Plain values, as a record keeps them."""
        return asdict(self)
