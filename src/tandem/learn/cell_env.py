"""Any cell (`tandem.world`) as a game for a search: a move begins a task in one of its ways, or
lets the turn pass.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial
from typing import Any, NamedTuple, Self

import jax
import jax.numpy as jnp
import numpy as np

from tandem.cell.model import Cell, plain
from tandem.errors import UsageError
from tandem.learn.observation import Ahead, Observation
from tandem.learn.results import Reached
from tandem.learn.turns import choices, least_to_come, observe, static_features
from tandem.world import state as world
from tandem.world.arrays import NEVER, Arrays, Names
from tandem.world.state import State

Array = Any

STUCK = 2.0
"""What each unit of work costs, twice its time, that is left when limits were spent so that nothing
can go on.
"""


class TurnState(NamedTuple):
    """An assembly in which somebody is asked, or which is over.

    world: how it stands. mask: `[W]` bool, the ways that are legal for anybody. turn: `[]` int32,
    whose turn it is, -1 for nobody's.
    """

    world: State
    mask: Array
    turn: Array


@partial(
    jax.tree_util.register_dataclass,
    data_fields=[
        "arrays",
        "ahead",
        "unit",
        "per_second",
        "per_stress",
        "time_weight",
        "stress_weight",
    ],
    meta_fields=["agents", "waiting"],
)
@dataclass(frozen=True)
class CellGame:
    """One cell, any number of operators. At one moment the humans choose first. Moves are the
    world's ways; with `waiting` one more, the last.

    The cost is `time_weight` x seconds + `stress_weight` x stress. An operator that lets its turn
    pass is asked again at the next event.

    Attributes:
      arrays: the cell as the world has it.
      ahead: what the network is told of it beforehand.
      unit: `[]` float32, what a task of mean least time costs by its time alone.
      per_second, per_stress: `[]` float32, ticks in a second, the world's units in a stress of 1.
    """

    arrays: Arrays
    ahead: Ahead
    unit: Array
    per_second: Array
    per_stress: Array
    time_weight: Array
    stress_weight: Array
    agents: tuple[str, ...] = field(default=())
    waiting: bool = field(default=True)

    @classmethod
    def of(
        cls,
        cell: Cell,
        *,
        time_weight: float = 1.0,
        stress_weight: float = 0.0,
        waiting: bool = True,
    ) -> Self:
        """The cell's game.

        Raises:
          UsageError: a weight is below 0, or time weighs nothing.
          CellError: times or stresses are too large to be counted.
        """
        if not (
            np.isfinite([time_weight, stress_weight]).all()
            and time_weight > 0
            and stress_weight >= 0
        ):
            raise UsageError(
                f"weights of time {time_weight} and stress {stress_weight}: time must weigh more"
                " than 0, stress 0 or more."
            )
        names = Names.of(cell)
        arrays = names.arrays()
        known = static_features(names, arrays, time_weight=time_weight, stress_weight=stress_weight)
        per_second, per_stress = np.float32(names.per_second), np.float32(names.per_stress)
        weights = np.float32(time_weight), np.float32(stress_weight)
        return cls(
            arrays,
            known.ahead,
            known.unit,
            per_second,
            per_stress,
            weights[0],
            weights[1],
            names.operators,
            waiting,
        )

    @property
    def moves(self) -> int:
        return int(self.arrays.way_ticks.shape[-1]) + self.waiting

    @property
    def longest(self) -> int:
        tasks, operators = self.arrays.release.shape[-1], self.arrays.human.shape[-1]
        events = tasks + int(np.prod(self.arrays.break_to.shape[-2:])) + tasks * self.waiting
        return tasks + self.waiting * operators * events

    def reset(self) -> TurnState:
        arrays = jax.tree.map(jnp.asarray, self.arrays)
        return self._until_asked(jax.tree.map(jnp.asarray, world.reset(arrays)))

    def legal(self, state: TurnState) -> Array:
        arrays = self.arrays
        return choices(arrays, state.world, state.mask, state.turn, waiting=self.waiting)

    def to_play(self, state: TurnState) -> Array:
        return state.turn

    def step(self, state: TurnState, move: Array) -> tuple[TurnState, Array]:
        waits, over = move >= self.arrays.way_ticks.shape[0], self.is_over(state)
        before = state.world
        begun = world.assign(self.arrays, before, jnp.where(waits | over, -1, move))
        after = self._until_asked(world.wait(begun, jnp.where(waits, state.turn, -1)))
        cost = self.time_weight * (after.world.clock - before.clock) / self.per_second
        cost += (
            self.stress_weight
            * (world.stress(self.arrays, after.world) - world.stress(self.arrays, before))
            / self.per_stress
        )
        left = jnp.sum(jnp.where(after.world.way < 0, self.ahead.least, 0.0)) * self.unit * STUCK
        return after, cost + jnp.where(~over & self.is_over(after), left, 0.0)

    def is_over(self, state: TurnState) -> Array:
        return state.turn < 0

    def observe(self, state: TurnState) -> Observation:
        """What whose turn it is sees."""
        tick, waiting = self._tick, self.waiting
        stands, mask, turn = state.world, state.mask, state.turn
        return observe(self.ahead, self.arrays, stands, mask, turn, tick=tick, waiting=waiting)

    def least(self, state: TurnState) -> Array:
        return least_to_come(self.ahead, self.arrays, state.world, self._tick) * self.unit

    @property
    def _tick(self) -> Array:
        """`[]` float32, what a tick costs, in units."""
        return 1.0 / (self.per_second * self.unit / self.time_weight)

    def _until_asked(self, state: State) -> TurnState:
        """Time runs until somebody can choose, or all is done, or nothing can go on."""

        def asked(state: State) -> TurnState:
            mask = world.legal(self.arrays, state)
            return TurnState(state, mask, world.turn(self.arrays, mask))

        def goes_on(now: TurnState) -> Array:
            return (
                (now.turn < 0)
                & ~world.is_done(now.world)
                & (world.next_event(self.arrays, now.world) < NEVER)
            )

        return jax.lax.while_loop(
            goes_on, lambda now: asked(world.advance(self.arrays, now.world)), asked(state)
        )


def reached(cell: Cell, played: Any) -> Reached:
    """What one game of the cell reached, from its `cost` and last `state`, in the cell's seconds
    and stress; NumPy arrays.
    """
    names, state = Names.of(cell), played.state.world
    if not world.is_done(state):
        return Reached(None, None, 0, float(played.cost), None)
    makespan, stress = (
        names.seconds(world.makespan(state)),
        names.stress(world.stress(names.arrays(), state)),
    )
    return Reached(
        plain(makespan),
        plain(stress),
        0,
        float(played.cost),
        names.schedule(state.way, state.start_at, state.end_at),
    )
