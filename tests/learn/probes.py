"""Worlds so small that a person knows what must be learned."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple, Self

import jax
import jax.numpy as jnp

from tandem.learn.ppo.config import Config, Stage
from tandem.learn.world import StageValues, StepResult


class Count(NamedTuple):
    """How many steps, and what the first action of each agent was (-1 before)."""

    step: jax.Array
    first: jax.Array


class Probe:
    """What the probes share: two agents, three actions, all legal, chosen at the same time."""

    agents = ("robot_0", "human_0")
    actions = 3
    observation_size = 2

    def reset(self, key: Any) -> Count:
        return Count(jnp.zeros((), jnp.int32), jnp.full(2, -1, jnp.int32))

    def observe(self, state: Count) -> jax.Array:
        """The step only: what was done before cannot be seen."""
        return jnp.broadcast_to(
            jnp.stack([state.step == 0, state.step == 1]).astype(jnp.float32), (2, 2)
        )

    def legal(self, state: Count) -> jax.Array:
        return jnp.ones((2, 3), bool)

    def narrow(self, state: Count, legal: jax.Array, action: jax.Array) -> jax.Array:
        return legal

    def in_stage(self, stage: StageValues) -> Self:
        return self

    def after(self, state: Count, action: jax.Array) -> Count:
        return Count(
            state.step + 1, jnp.where(state.step == 0, action, state.first).astype(jnp.int32)
        )


def probe(cls: Any) -> Any:
    return partial(jax.tree_util.register_dataclass, data_fields=[], meta_fields=[])(
        dataclass(frozen=True)(cls)
    )


@probe
class OneTask(Probe):
    """Action 1 does the only task and ends the episode with +1; any other costs 1 and goes on. Best
    return: +1.
    """

    def step(self, state: Count, action: jax.Array) -> tuple[Count, StepResult]:
        does = action == 1
        return self.after(state, action), StepResult(
            jnp.where(does, 1.0, -1.0), jnp.all(does), jnp.zeros(2, jnp.int32)
        )


@probe
class OneBestAssignment(Probe):
    """One step; only robot 2 with human 1 pays 1, all else nothing. Best return: 1."""

    def step(self, state: Count, action: jax.Array) -> tuple[Count, StepResult]:
        best = (action[0] == 2) & (action[1] == 1)
        return self.after(state, action), StepResult(
            jnp.full(2, 1.0 * best), jnp.ones((), bool), jnp.zeros(2, jnp.int32)
        )


@probe
class LateReward(Probe):
    """Two steps; what the first action earns (1 for action 2) is paid with the second, which does
    not matter. Best return: 1.
    """

    def step(self, state: Count, action: jax.Array) -> tuple[Count, StepResult]:
        over = state.step == 1
        return self.after(state, action), StepResult(
            jnp.where(over & (state.first == 2), 1.0, 0.0), over, jnp.zeros(2, jnp.int32)
        )


@probe
class ForbiddenFruit(Probe):
    """One step; action 2 pays 5 but is illegal, action 1 pays 1. What a learner that keeps to the
    mask gets at best: 1.
    """

    def legal(self, state: Count) -> jax.Array:
        return jnp.broadcast_to(jnp.array([True, True, False]), (2, 3))

    def step(self, state: Count, action: jax.Array) -> tuple[Count, StepResult]:
        paid = jnp.where(action == 2, 5.0, jnp.where(action == 1, 1.0, 0.0))
        return self.after(state, action), StepResult(
            paid, jnp.ones((), bool), (action == 2).astype(jnp.int32)
        )


SOLVED = {OneTask: 1.0, OneBestAssignment: 1.0, LateReward: 1.0, ForbiddenFruit: 1.0}
"""Probe -> the return that each agent gets at best."""

SMALL = Config(
    stages=(
        Stage(steps=12 * 512, entropy=0.05, learning_rate=0.01),
        Stage(steps=12 * 512, entropy=0.0, learning_rate=0.003),
    ),
    environments=64,
    horizon=8,
    episode_limit=8,
    minibatch=256,
    hidden=(16,),
)
SEEDS = 6
