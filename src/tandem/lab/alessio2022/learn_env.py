"""The grid of Alessio et al. (2022) as a world to learn in, and its humans as opponents."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any, Self

import jax
import jax.numpy as jnp

from tandem.lab.alessio2022 import coverage, people, world
from tandem.lab.alessio2022.adversarial import Draws
from tandem.lab.alessio2022.layout import RIGHT, WRONG, Layout
from tandem.lab.alessio2022.observations import OBSERVATIONS, observe
from tandem.lab.alessio2022.world import Grid, Rewards, State
from tandem.learn.world import StageValues, StepResult, World

Array = Any


@partial(
    jax.tree_util.register_dataclass,
    data_fields=["grid", "rewards", "marks", "lawful"],
    meta_fields=[],
)
@dataclass(frozen=True)
class GridWorld:
    """A grid with its rewards. Agents take turns: who is not on turn has one action, to wait.

    Attributes:
      marks: what terminal states show before they are reached; see `observe`.
      lawful: `[]` bool, only possible moves may be chosen; otherwise any may be tried, and an
        impossible one moves nobody and costs `rewards.illegal`.
    """

    grid: Grid
    rewards: Rewards
    marks: Array
    lawful: Array

    @classmethod
    def of(
        cls,
        layout: Layout,
        *,
        rewards: Rewards | None = None,
        sees: str = "marked",
        lawful: bool = True,
        **options: Any,
    ) -> Self:
        """The layout with these rewards; `sees` is a name in `OBSERVATIONS`, `options` as
        `tandem.lab.alessio2022.world.grid` takes them.
        """
        data, paid = world.grid(layout, **options), jax.tree.map(jnp.float32, rewards or Rewards())
        return cls(
            jax.tree.map(jnp.asarray, data),
            paid,
            jnp.float32(OBSERVATIONS[sees]),
            jnp.asarray(lawful),
        )

    @property
    def agents(self) -> tuple[str, ...]:
        return ("robot_0", "human_0")

    @property
    def actions(self) -> int:
        return len(world.ACTIONS)

    @property
    def observation_size(self) -> int:
        return 4 * int(self.grid.kind.shape[-1])

    def reset(self, key: Array) -> State:
        return world.reset(self.grid)

    def observe(self, state: State) -> Array:
        seen = observe(self.grid, state, self.marks)
        return jnp.broadcast_to(seen, (2, *seen.shape))

    def legal(self, state: State) -> Array:
        on_turn = (jnp.arange(2) == state.turn)[:, None]
        return world.legal(self.grid, state) | (on_turn & ~self.lawful)

    def narrow(self, state: State, legal: Array, action: Array) -> Array:
        return legal

    def step(self, state: State, action: Array) -> tuple[State, StepResult]:
        after, reward, over, illegal = world.step(self.grid, self.rewards, state, action)
        return after, StepResult(reward, over, illegal)

    def in_stage(self, stage: StageValues) -> Self:
        return self


@partial(
    jax.tree_util.register_dataclass,
    data_fields=["neighbour", "distances", "mistakes"],
    meta_fields=[],
)
@dataclass(frozen=True)
class Pursuer:
    """A human that goes straight for a terminal state, another one each episode. See
    `people.pursues`.
    """

    neighbour: Array
    distances: Array
    mistakes: Array

    @classmethod
    def of(cls, layout: Layout, *, goals: str = WRONG + RIGHT, mistakes: float = 0.1) -> Self:
        """One that pursues any of the terminal states of these kinds, `W`, `G` or both, and errs
        with that probability (ASSUMPTION: 0.1).
        """
        neighbour = [layout.neighbours(place) for place in range(len(layout.text))]
        return cls(
            jnp.asarray(neighbour, jnp.int32),
            jnp.asarray(people.goals(layout, of=goals)),
            jnp.float32(mistakes),
        )

    def choose(self, world: World, state: State, seat: int, legal: Array, draws: Draws) -> Array:
        return people.pursues(
            self.neighbour,
            self.distances,
            state.position,
            legal,
            draws.episode[seat],
            draws.moment[seat],
            self.mistakes,
        )


@partial(jax.tree_util.register_dataclass, data_fields=["grid", "rewards"], meta_fields=[])
@dataclass(frozen=True)
class CoverageWorld:
    """Robot and human cover the free squares together, in turns; see
    `tandem.lab.alessio2022.coverage`.
    """

    grid: Grid
    rewards: coverage.Rewards

    @classmethod
    def of(cls, layout: Layout, *, rewards: coverage.Rewards | None = None, **options: Any) -> Self:
        """The layout with these rewards; `options` as `tandem.lab.alessio2022.world.grid` takes
        them.
        """
        data = world.grid(layout, closing=False, **options)
        return cls(
            jax.tree.map(jnp.asarray, data),
            jax.tree.map(jnp.float32, rewards or coverage.Rewards()),
        )

    @property
    def agents(self) -> tuple[str, ...]:
        return ("robot_0", "human_0")

    @property
    def actions(self) -> int:
        return len(world.ACTIONS)

    @property
    def observation_size(self) -> int:
        return 4 * int(self.grid.kind.shape[-1])

    def reset(self, key: Array) -> coverage.State:
        return coverage.reset(self.grid)

    def observe(self, state: coverage.State) -> Array:
        return coverage.observe(self.grid, state)

    def legal(self, state: coverage.State) -> Array:
        return coverage.legal(self.grid, state)

    def narrow(self, state: coverage.State, legal: Array, action: Array) -> Array:
        return legal

    def step(self, state: coverage.State, action: Array) -> tuple[coverage.State, StepResult]:
        after, reward, over, illegal = coverage.step(self.grid, self.rewards, state, action)
        return after, StepResult(reward, over, illegal)

    def in_stage(self, stage: StageValues) -> Self:
        return self
