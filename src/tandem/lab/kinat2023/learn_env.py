"""The thesis's station as worlds to learn in: by ticks as the thesis has it, or by decisions."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, Literal, Self

import jax
import jax.numpy as jnp

from tandem.cell.model import Cell
from tandem.lab.kinat2023 import decisions
from tandem.lab.kinat2023 import world as ticks
from tandem.lab.kinat2023.recipe import OBSERVATIONS, StationRecipe
from tandem.lab.kinat2023.rewards import reward_set
from tandem.lab.kinat2023.station import station, whole_ticks
from tandem.lab.kinat2023.world import HUMAN, ROBOT, Rewards, State, Station
from tandem.learn.world import StageValues, StepResult

Array = Any


@partial(
    jax.tree_util.register_dataclass,
    data_fields=["station", "rewards"],
    meta_fields=["pace", "sees"],
)
@dataclass(frozen=True)
class StationWorld:
    """A station with its rewards.

    Attributes:
      pace: "ticks" of one second, where any action may be tried and illegal ones are punished; or
        "decisions", where the world runs on until someone decides.
      sees: what the agents observe, a name in `OBSERVATIONS`.
    """

    station: Station
    rewards: Rewards
    pace: Literal["ticks", "decisions"] = field(default="decisions")
    sees: str = field(default="normalised")

    @property
    def agents(self) -> tuple[str, ...]:
        return ("robot_0", "human_0")

    @property
    def tasks(self) -> int:
        """How many tasks there are, `T`."""
        return int(self.station.needs.shape[-1])

    @property
    def actions(self) -> int:
        return self.tasks + 1

    @property
    def observation_size(self) -> int:
        squares = self.tasks**2
        return (
            6 * self.tasks + 4 + squares
            if self.sees == "normalised"
            else 2 + 3 * self.tasks + squares
        )

    @property
    def channels(self) -> tuple[int, ...]:
        """How many numbers of the thesis's observation belong to each of its channels: the task in
        hand of robot and human, the times of both, the stress, the dependencies. Ours is one.
        """
        if self.sees == "normalised":
            return ()
        return (1, 1, self.tasks, self.tasks, self.tasks, self.tasks**2)

    @classmethod
    def of(cls, cell: Cell, recipe: StationRecipe, *, stress_factor: float = 0.0) -> Self:
        """The cell as the recipe wants it; times that are no whole seconds of at least 2 are
        counted in smaller ticks.

        The rewards are those of the thesis's later stages; what idling costs in a stage of the
        training is the stage's to say.

        Raises:
          CellError: the thesis's encoding cannot hold the cell.
        """
        data = station(cell, per_second=whole_ticks(cell))
        rewards = reward_set(recipe.rewards, stress_factor=stress_factor)
        as_arrays = jax.tree.map(jnp.asarray, (data, jax.tree.map(jnp.float32, rewards)))
        return cls(as_arrays[0], as_arrays[1], pace=recipe.pace, sees=recipe.sees)

    def reset(self, key: Array) -> State:
        return ticks.reset(self.station)

    def observe(self, state: State) -> Array:
        return OBSERVATIONS[self.sees](self.station, state)

    def legal(self, state: State) -> Array:
        return (
            ticks.legal(self.station, state)
            if self.pace == "ticks"
            else decisions.choices(self.station, state)
        )

    def narrow(self, state: State, legal: Array, action: Array) -> Array:
        if self.pace == "ticks":
            return legal
        xp = ticks.namespace(legal)
        return xp.stack(
            [decisions.after_human(state, legal, action[HUMAN]), legal[HUMAN]][
                :: 1 if ROBOT == 0 else -1
            ]
        )

    def step(self, state: State, action: Array) -> tuple[State, StepResult]:
        step = ticks.step if self.pace == "ticks" else decisions.decide_step
        after, reward, done, info = step(self.station, self.rewards, state, action)
        return after, StepResult(reward, done, info.illegal)

    def in_stage(self, stage: StageValues) -> Self:
        return replace(self, rewards=self.rewards._replace(idle=stage.idle))
