"""A cell with people drawn from a crowd, as a world to learn in.

The decider is one agent that acts for whose turn it is: it tells a robot what to begin and asks a
person, who then does as it likes. Episode by episode somebody else stands there, with an untold
pace and habits of its own. The rules are those of `tandem.world.episode`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import NamedTuple, Self

import jax
import jax.numpy as jnp
import numpy as np

from tandem.learn.ppo import observation
from tandem.learn.world import StageValues, StepResult
from tandem.world import episode, state
from tandem.world.arrays import Array, Arrays
from tandem.world.episode import Shift
from tandem.world.people import Person, crew
from tandem.world.population import Crowd
from tandem.world.randomness import OFF, Chance, Draw, Scenario, scenario

UNFINISHED = 2.0
"""What an assembly that nobody can finish costs, in units of `sight.scale`."""

PEOPLE = 4096
"""So many people are drawn from a population before the training; each episode takes one of
them.
"""


class EpisodeState(NamedTuple):
    """An episode under way: the shift, its scenario (`fate`: checkpoints call it so) and its crew
    (one person per operator), which the decider does not see.
    """

    shift: Shift
    fate: Scenario
    people: Person


@partial(
    jax.tree_util.register_dataclass,
    data_fields=["arrays", "people", "weights"],
    meta_fields=["draw"],
)
@dataclass(frozen=True)
class BesidePeople:
    """The world (`tandem.learn.world.World`), with one agent.

    Attributes:
      people: with a leading axis `P`; each episode takes one of them.
      weights: `[2]` float32, the cost of a tick and of a unit of stress.
      draw: what chance needs.
    """

    arrays: Arrays
    people: Person
    weights: Array
    draw: Draw

    @classmethod
    def of(
        cls,
        crowd: Crowd,
        *,
        chance: Chance = OFF,
        weights: tuple[float, float] = (1.0, 0.0),
        seed: int = 0,
    ) -> Self:
        """The crowd's cell with `PEOPLE` of the crowd, or with the one person that it is.

        Args:
          weights: of a second and of a unit of the cell's stress.
          seed: of who is drawn.
        """
        names = crowd.names
        arrays = names.arrays(undo=chance.undo if crowd.makes_mistakes else None)
        people = crowd.draw(np.random.default_rng(seed), 1 if crowd.is_one else PEOPLE)
        per = np.array([weights[0] / names.per_second, weights[1] / names.per_stress], np.float32)
        arrays_, people_, per_ = jax.tree.map(jnp.asarray, (arrays, people, per))
        return cls(arrays_, people_, per_, Draw.of(names, arrays, chance))

    @property
    def agents(self) -> tuple[str, ...]:
        return ("decider_0",)

    @property
    def actions(self) -> int:
        return int(self.arrays.way_ticks.shape[-1]) + 1

    @property
    def observation_size(self) -> int:
        return observation.observation_size(self.arrays)

    def reset(self, key: Array) -> EpisodeState:
        who_key, scenario_key = jax.random.split(key)
        index = jax.random.randint(who_key, (), 0, self.people.pace.shape[0])
        chance = scenario(
            self.draw, self.arrays, jax.random.uniform(scenario_key, (self.draw.numbers,))
        )
        people = crew(self.arrays, jax.tree.map(lambda leaf: leaf[index], self.people))
        return EpisodeState(
            self._to_a_turn(chance, episode.begin(self.arrays, people)), chance, people
        )

    def observe(self, state: EpisodeState) -> Array:
        return observation.observe(
            self.arrays, state.shift.state, state.shift.mask, state.shift.turn
        )[None]

    def legal(self, state: EpisodeState) -> Array:
        return observation.choices(
            self.arrays, state.shift.state, state.shift.mask, state.shift.turn
        )[None]

    def narrow(self, state: EpisodeState, legal: Array, action: Array) -> Array:
        return legal

    def step(self, state: EpisodeState, action: Array) -> tuple[EpisodeState, StepResult]:
        way = jnp.where(action[0] == self.actions - 1, -1, action[0])
        shift = self._to_a_turn(
            state.fate,
            episode.decide(self.arrays, state.fate, state.people, state.shift, way),
        )
        over, lost = (
            episode.is_over(self.arrays, shift),
            UNFINISHED * observation.scale(self.arrays) * self.weights[0],
        )
        cost = (
            self.cost(shift) - self.cost(state.shift) + jnp.where(over & ~is_done(shift), lost, 0.0)
        )
        return EpisodeState(shift, state.fate, state.people), StepResult(
            -cost[None].astype(jnp.float32), over, jnp.zeros(1, jnp.int32)
        )

    def in_stage(self, stage: StageValues) -> Self:
        return self

    def cost(self, shift: Shift) -> Array:
        """`[]` float32, what time and stress have cost so far."""
        return self.weights[0] * shift.state.clock + self.weights[1] * state.stress(
            self.arrays, shift.state
        )

    def _to_a_turn(self, chance: Scenario, shift: Shift) -> Shift:
        """Time runs on until it is somebody's turn or all is over."""
        goes_on = lambda shift: (shift.turn < 0) & ~episode.is_over(self.arrays, shift)  # noqa: E731
        return jax.lax.while_loop(
            goes_on, lambda shift: episode.run_on(self.arrays, chance, shift), shift
        )


def is_done(shift: Shift) -> Array:
    """`[]` bool, everything was done, and rightly."""
    return state.is_done(shift.state)
