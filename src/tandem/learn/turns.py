"""A cell as operators see it who choose one after the other: what is known beforehand, what whose
turn it is may do, what the network that knows no sizes is shown, what is certainly still to come.

In NumPy and under JAX alike, so that what was trained decides on a PC without JAX. Axes as in
`observation`: `W` ways, `K` moves; the moves are the ways, and with `waiting` one more, the last.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tandem.learn.observation import (
    Ahead,
    AssemblyStatus,
    Observation,
    ahead,
    features,
    missing,
    time_to_come,
)
from tandem.world import state as world
from tandem.world.arrays import Arrays, Names, namespace
from tandem.world.state import State

Array = Any


class StaticFeatures(NamedTuple):
    """What is known of a cell before its first game.

    ahead: its tasks and ways, times in units. unit: `[]` float32, what a task of mean least time
    costs by its time alone.
    """

    ahead: Ahead
    unit: Array


def static_features(
    names: Names, arrays: Arrays, *, time_weight: float, stress_weight: float
) -> StaticFeatures:
    """What is known of a cell whose cost is `time_weight` x seconds + `stress_weight` x stress."""
    seconds = arrays.way_ticks / names.per_second
    mean = np.mean([seconds[arrays.way_task == task].min() for task in range(len(names.tasks))])
    unit = mean * time_weight
    loads = (arrays.way_load * arrays.human).sum(1) / names.per_stress
    stress = loads * stress_weight / unit
    uses, needs, human = arrays.way_uses, arrays.needs, arrays.human
    known = ahead(arrays.way_task, uses, seconds / mean, stress, needs, human)
    return StaticFeatures(known, np.float32(unit))


def choices(arrays: Arrays, state: State, mask: Array, turn: Array, *, waiting: bool) -> Array:
    """`[K]` bool, what the operator `turn` may do; all False when it is nobody's turn.

    Args:
      mask: `[W]` bool, what may begin now, by anybody. turn: `[]` int, -1 for nobody.
    """
    mine = world.legal_of(arrays, mask, turn)
    if not waiting:
        return mine
    may_wait = (turn >= 0) & world.may_wait(arrays, state, mask, turn)
    return namespace(mask).append(mine, may_wait)


def standing(arrays: Arrays, state: State, tick: Array) -> AssemblyStatus:
    """How far the assembly is. What has to come off again is as if it had not begun.

    Args:
      tick: `[]` float32, what a tick is in units.
    """
    xp = namespace(state.way)
    begun, ended = state.way >= 0, world.mounted(state)
    left = xp.where(begun & ~ended, state.end_at - state.clock, 0) * tick
    if arrays.undo.shape[0]:
        off = world.to_undo(arrays, state)
        begun, ended = begun & ~off, ended & ~off
    free_at = xp.maximum(state.free_at, state.away_until)
    return AssemblyStatus(begun, ended, left, xp.maximum(free_at - state.clock, 0) * tick)


def observe(
    known: Ahead,
    arrays: Arrays,
    state: State,
    mask: Array,
    turn: Array,
    *,
    tick: Array,
    waiting: bool,
) -> Observation:
    """What the operator `turn` sees; arguments as in `choices` and `standing`."""
    xp = namespace(state.way)
    legal, now = choices(arrays, state, mask, turn, waiting=waiting), standing(arrays, state, tick)
    ways = arrays.way_ticks.shape[0]
    waits_for_none = (missing(known, now.ended) == 0) & ~now.begun
    there = arrays.way_open & waits_for_none[arrays.way_task]
    if arrays.undo.shape[0]:
        there = there | mask  # what stands on a wrong task comes off first, and waits for that task
    way, waits = xp.arange(ways), xp.zeros(ways, bool)
    if waiting:
        way, waits = xp.append(way, 0), xp.append(waits, True)
        there = xp.append(there, legal[-1])
    return features(known, now, turn, way, there, legal, waits)


def least_to_come(known: Ahead, arrays: Arrays, state: State, tick: Array) -> Array:
    """`[]` float32, units that the rest of the assembly certainly costs."""
    xp, now = namespace(state.way), standing(arrays, state, tick)
    stress = xp.sum(xp.where(now.begun, 0.0, known.least_stress))
    return time_to_come(known, now) + stress
