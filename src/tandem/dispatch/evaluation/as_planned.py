"""A plan carried out as it stands in many assemblies at once, in JAX: who does what in which order
stays, only the clock gives way.

Nothing is left to decide, so nobody is asked: whatever is next in the plan begins as soon as it
may. That is what `carried_out.carry_on` comes to beside people who comply, without their turns and
answers, and of all ways of a task only the planned one is looked at.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np

from tandem.world import state as world
from tandem.world.arrays import NEVER, Array, Arrays, namespace
from tandem.world.carried_out import Plan
from tandem.world.state import State

OF_WAYS = (
    "way_task",
    "of_task",
    "way_uses",
    "way_size",
    "way_ticks",
    "way_load",
    "way_open",
    "spread",
    "way_tool",
    "swap",
    "takes",
    "due",
    "owes",
    "undo",
)
"""Those of `Arrays` whose first axis is that of ways, or empty."""


def planned_ways(arrays: Arrays, plan: Plan) -> Arrays:
    """The cell in which each task can be done in its planned way alone, way `i` doing task `i`, and
    nothing that the plan holds back can begin before its time.
    """
    ways = plan.way
    parts = {name: getattr(arrays, name) for name in OF_WAYS}
    return plan.held_back(arrays)._replace(
        **{name: part[ways] if len(part) else part for name, part in parts.items()},
        apart=arrays.apart[np.ix_(ways, ways)] if len(arrays.apart) else arrays.apart,
        hold_bars=arrays.hold_bars[:, ways],
    )


def carried_out(arrays: Arrays, plan: Plan, factor: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """`[E]` int32, the makespan of each assembly in ticks.

    Args:
      arrays: the cell, with all its ways.
      factor: `[E, W]`, the real duration of each way divided by the stated one.
    """
    cell = planned_ways(arrays, plan)
    ticks = drawn_ticks(cell, factor[:, plan.way])
    return np.asarray(_compiled()(cell, ticks, plan.rank, plan.awaits))


def drawn_ticks(
    arrays: Arrays, factor: np.ndarray[Any, Any]
) -> np.ndarray[Any, np.dtype[np.int32]]:
    """`[..., W]`, ticks that each way really takes, by the factors (`[..., W]`) on the stated
    ones.
    """
    stated = arrays.way_ticks
    # added to the whole number, so that the stated time stays what it is (as `episode` does it)
    return np.maximum(1, stated + np.rint(stated * factor - stated).astype(np.int32))


@lru_cache(maxsize=1)
def _compiled() -> Callable[[Arrays, Array, Array, Array], Array]:
    """Compiled once for all plans of a cell, and for all parts of one size: they come in as
    data.
    """
    import jax

    return jax.jit(jax.vmap(_one, in_axes=(None, 0, None, None)))


def _one(arrays: Arrays, ticks: Array, rank: Array, awaits: Array) -> Array:
    """`[]` int32, the makespan of one assembly; `ticks`: `[T]` int32, how long its tasks take."""
    import jax

    state = world.reset(arrays)
    state, _ = jax.lax.while_loop(
        lambda under_way: goes_on(arrays, *under_way),
        lambda under_way: step(arrays, ticks, rank, awaits, *under_way),
        (state, due(arrays, awaits, state)),
    )
    return world.makespan(state)


def due(arrays: Arrays, awaits: Array, state: State) -> Array:
    """`[T]` bool, the tasks that may begin now and wait for nothing in the plan. `arrays` are
    those of `planned_ways`.
    """
    is_open = state.way < 0
    return world.legal(arrays, state) & ~(awaits & is_open[None, :]).any(axis=1)


def goes_on(arrays: Arrays, state: State, ready: Array) -> Array:
    """`[]` bool, something is due (`ready`: `[T]`) or is still to come."""
    something_comes = ready.any() | (world.next_event(arrays, state) < NEVER)
    return something_comes & ~world.is_done(state)


def step(
    arrays: Arrays, ticks: Array, rank: Array, awaits: Array, state: State, ready: Array
) -> tuple[State, Array]:
    """The first that is due (`ready`: `[T]`) begins; where none is, time runs on. Gives what is due
    then.

    So it comes to an end: each task begins once, and time runs to what is still to come.
    """
    xp = namespace(state.way)
    first = xp.where(ready, rank, rank.shape[0]).argmin().astype(xp.int32)
    begun, later = world.assign(arrays, state, first, ticks[first]), world.advance(arrays, state)
    state = State(
        *(xp.where(ready.any(), one, other) for one, other in zip(begun, later, strict=True))
    )
    return state, due(arrays, awaits, state)
