"""The event world as pure functions for JAX, as gymnax has them: `reset` and `step` with a key, a
state and parameters; an episode that ends begins anew by itself. `jit` and `vmap` go through.

Source of the form: Lange (2022), gymnax, `environments/environment.py`. It is the world, the
observation, the mask and the reward of `tandem/RobotBesideHuman-v0`: the same actions bring the
same there and here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from math import lcm
from typing import Any, NamedTuple

import gymnasium
import jax
import jax.numpy as jnp
import numpy as np
from gymnasium import spaces

from tandem.cell.model import Cell
from tandem.envs.cells import AnyCells, Cells, Room
from tandem.envs.game import mask_of, ways_of
from tandem.envs.observations import MOST, observe
from tandem.envs.padding import padded, padded_person
from tandem.errors import UsageError
from tandem.plan.instance import Instance
from tandem.world import episode
from tandem.world import state as world
from tandem.world.arrays import Array, Arrays, Names
from tandem.world.episode import Shift
from tandem.world.people import Person, crew, stacked
from tandem.world.population import Crowd, crowd
from tandem.world.randomness import OFF, Chance, Draw, Scenario, scenario

PERSONS = 64
"""So many people are drawn from a crowd for each cell; each episode takes one of them."""


class Params(NamedTuple):
    """The cells of an environment, all padded to one size, with a leading axis `C`.

    Attributes:
      arrays: of each cell. people: of each, with a second axis of persons.
      there: `[C, T]` bool, the tasks that are there; the others count as done.
      shown: `[C, D]` float32, 1 where the observation means something.
      ways: `[C, 3, W]` float32, what the observation tells of the ways.
      unit: `[C]` float32, ticks, the mean duration of a way. per_stress: `[C]` float32.
      limit: `[C]` int32, ticks after which an episode is cut off.
    """

    arrays: Arrays
    people: Person
    there: Array
    shown: Array
    ways: Array
    unit: Array
    per_stress: Array
    limit: Array


class EnvState(NamedTuple):
    """An episode under way: which cell it is played on, the shift, and what chance and the people
    have in store.
    """

    cell: Array
    shift: Shift
    chance: Scenario
    people: Person


Observation = dict[str, Array]
"""`observation` `[D]` float32 and `action_mask` `[W + 1]` int8, as at the Gymnasium face."""


@dataclass(frozen=True)
class Functional:
    """The environment; made by `functional`.

    Attributes:
      cells: it plays. room: what all are padded to.
      default_params: what `reset` and `step` take where none are given.
      per_second: ticks in a second. draw: what chance needs.
      stress_factor: seconds that a unit of stress is worth in the reward.
    """

    cells: tuple[Cell, ...]
    room: Room
    default_params: Params
    per_second: int
    draw: Draw
    stress_factor: float

    @property
    def name(self) -> str:
        """What it is called."""
        return "tandem/RobotBesideHuman-v0"

    @property
    def num_actions(self) -> int:
        """How many there are, waiting, which is 0, included."""
        return self.room.ways + 1

    def action_space(self, params: Params | None = None) -> gymnasium.Space[Any]:
        """In Gymnasium's words."""
        return spaces.Discrete(self.num_actions)

    def observation_space(self, params: Params | None = None) -> gymnasium.Space[Any]:
        """In Gymnasium's words."""
        box = spaces.Box(0.0, MOST, (self.room.size,), np.float32)
        return spaces.Dict(
            {"observation": box, "action_mask": spaces.MultiBinary(self.num_actions)}
        )

    def reset(self, key: Array, params: Params | None = None) -> tuple[Observation, EnvState]:
        """The first observation of an episode; cell, person and chance are drawn from the key."""
        given = self.default_params if params is None else params
        number, persons = given.people.pace.shape
        cell_key, person_key, chance_key = jax.random.split(key, 3)
        cell = jax.random.randint(cell_key, (), 0, number)
        one = self._of(given, cell)
        who = jax.random.randint(person_key, (), 0, persons)
        people = crew(one.arrays, jax.tree.map(lambda leaf: leaf[who], one.people))
        uniform = jax.random.uniform(chance_key, (self.draw.numbers,))
        chance = scenario(self.draw, one.arrays, uniform)
        begun = episode.begin(one.arrays, people)
        # what is not there counts as done in a way that no cell has, so that nobody waits for it
        stands = begun.state._replace(
            way=jnp.where(one.there, begun.state.way, self.room.ways).astype(jnp.int32),
            start_at=jnp.where(one.there, begun.state.start_at, 0).astype(jnp.int32),
            end_at=jnp.where(one.there, begun.state.end_at, 0).astype(jnp.int32),
        )
        shift = self._to_a_turn(one, chance, begun._replace(state=stands))
        return self._seen(one, shift), EnvState(cell, shift, chance, people)

    def step(
        self, key: Array, state: EnvState, action: Array, params: Params | None = None
    ) -> tuple[Observation, EnvState, Array, Array, dict[str, Any]]:
        """One decision, as `step_env`; where the episode ends with it, observation and state are
        those of the next one, and `info["final_observation"]` is the last of this one.
        """
        seen, after, reward, done, info = self.step_env(key, state, action, params)
        info["final_observation"] = seen["observation"]
        fresh = self.reset(key, params)
        begins = partial(jax.tree.map, lambda new, old: jnp.where(done, new, old))
        observation, following = begins(fresh, (seen, after))
        return observation, following, reward, done, info

    def step_env(
        self, key: Array, state: EnvState, action: Array, params: Params | None = None
    ) -> tuple[Observation, EnvState, Array, Array, dict[str, Any]]:
        """One decision of whose turn it is; nothing begins anew, and nothing is drawn from the key.
        An illegal action counts as waiting.

        Returns:
          Observation, state, reward (minus the seconds, less the factor for each unit of stress),
          whether the episode has ended, and what else is known: `terminated`, `truncated`, `time`
          (s), `makespan` (s), `stress`, `illegal`, `cell`.
        """
        one = self._of(self.default_params if params is None else params, state.cell)
        before = state.shift
        mask = mask_of(one.arrays, before.state, before.mask, before.turn)
        legal = (jnp.arange(self.num_actions) == action) & (mask > 0)
        way = jnp.where(legal.any(), action - 1, -1).astype(jnp.int32)
        decided = episode.decide(one.arrays, state.chance, state.people, before, way)
        shift = self._to_a_turn(one, state.chance, decided)
        stress = [world.stress(one.arrays, each.state) for each in (before, shift)]
        seconds = (shift.state.clock - before.state.clock) / self.per_second
        reward = -seconds - self.stress_factor * (stress[1] - stress[0]) / one.per_stress
        ended = world.is_done(shift.state)
        late = shift.state.clock >= one.limit
        cut = ~ended & (episode.is_over(one.arrays, shift) | late)
        info = {
            "terminated": ended,
            "truncated": cut,
            "time": shift.state.clock / self.per_second,
            "makespan": world.makespan(shift.state) / self.per_second,
            "stress": stress[1] / one.per_stress,
            "illegal": ~legal.any(),
            "cell": state.cell,
        }
        after = state._replace(shift=shift)
        return self._seen(one, shift), after, reward.astype(jnp.float32), ended | cut, info

    def _of(self, params: Params, cell: Array) -> Params:
        """One cell's. Of a single one nothing has to be looked up, however many copies there
        are.
        """
        alone = params.unit.shape[0] == 1
        found: Params = jax.tree.map(lambda leaf: jnp.asarray(leaf)[0 if alone else cell], params)
        return found

    def _seen(self, one: Params, shift: Shift) -> Observation:
        state, mask, turn = shift.state, shift.mask, shift.turn
        seen = observe(one.arrays, state, mask, turn, unit=one.unit)
        whole = jnp.concatenate([seen, one.ways.reshape(-1)]) * one.shown
        return {"observation": whole, "action_mask": mask_of(one.arrays, state, mask, turn)}

    def _to_a_turn(self, one: Params, chance: Scenario, shift: Shift) -> Shift:
        """Time runs on until it is somebody's turn, the limit has come, or all is over."""

        def goes_on(shift: Shift) -> Array:
            over = episode.is_over(one.arrays, shift) | (shift.state.clock >= one.limit)
            return (shift.turn < 0) & ~over

        return jax.lax.while_loop(
            goes_on, lambda shift: episode.run_on(one.arrays, chance, shift), shift
        )


def functional(
    cell: AnyCells,
    *,
    room: Room | Mapping[str, int] | None = None,
    person: str = "compliant",
    part: str = "held_out",
    chance: Chance = OFF,
    stress_factor: float = 0.0,
    limit: float | None = None,
    drawn: int = 64,
    seed: int = 0,
) -> Functional:
    """The environment over a cell, a folder or a list of them, or over `drawn` cells of a
    generator, which are made now.

    Args:
      room: what they are padded to; the largest of all when absent.
      person, part, chance, stress_factor, limit: as at the Gymnasium face.
      seed: of the generator, and of who is drawn from a crowd.

    Raises:
      UsageError: an option is wrong, a cell has no room, or cells cannot be padded to each other.
      CellError: a file holds no sound cell, or one is too large to be counted in common ticks.
    """
    source, draws = Cells(cell, room), np.random.default_rng(seed)
    if drawn < 1:
        raise UsageError(f"drawn={drawn!r}: give how many cells the generator makes, 1 or more.")
    cells = source.known or tuple(source.drawn(draws) for _ in range(drawn))
    per_second = _ticks(cells)
    names = [Names.of(one, per_second=per_second) for one in cells]
    crowds = [crowd(person, one, one.arrays(), part=part) for one in names]
    mistakes = any(one.makes_mistakes for one in crowds)
    tables = [one.arrays(undo=chance.undo if mistakes else None) for one in names]
    sizes = [Room.of(one) for one in names]
    space = source.room or sizes[0]
    each = [
        _params(*parts, space, draws, limit)
        for parts in zip(names, padded(tables, space), tables, crowds, strict=True)
    ]
    whole: Params = jax.tree.map(lambda *leaves: np.stack(leaves), *each)
    needed = [Draw.of(one, table, chance) for one, table in zip(names, tables, strict=True)]
    draw = Draw(
        chance,
        per_second,
        space.ways,
        space.tasks,
        space.operators,
        max(one.absences for one in needed),
        mistakes,
        max(one.decisions for one in needed),
    )
    return Functional(cells, space, whole, per_second, draw, stress_factor)


def _ticks(cells: tuple[Cell, ...]) -> int:
    """Ticks in a second that make every time of every cell whole; as fine as one cell has them by
    itself where that is a multiple.
    """
    common = lcm(*(Instance.of(cell).per_second for cell in cells))
    finest = min(Names.of(cell).per_second for cell in cells)
    return finest if finest % common == 0 else common


def _params(
    names: Names,
    arrays: Arrays,
    own: Arrays,
    people: Crowd,
    room: Room,
    draws: np.random.Generator,
    limit: float | None,
) -> Params:
    """One cell's. `own`: its arrays before they were padded."""
    persons = people.draw(draws, 1 if people.is_one else PERSONS)
    rows = [Person(*(part[row] for part in persons)) for row in range(len(persons.pace))]
    size = Room.of(names)
    longest = [max(mode.time for mode in names.cell.modes(task)) for task in names.tasks]
    dense = np.ones(size.size - 3 * size.ways, np.float32)
    shown = room.padded(dense, size, np.ones((3, size.ways), np.float32))
    ways = np.pad(ways_of(own), ((0, 0), (0, room.ways - size.ways)))
    return Params(
        arrays,
        stacked([padded_person(row, room.ways) for row in rows]),
        np.arange(room.tasks) < size.tasks,
        shown,
        ways,
        np.float32(own.way_ticks.mean()),
        np.float32(names.per_stress),
        np.int32(names.ticks(20 * sum(longest) if limit is None else limit)),
    )
