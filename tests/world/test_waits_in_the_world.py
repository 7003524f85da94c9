"""Waits in the event world, in NumPy as under jit: nothing begins before its wait is over, and what
comes too late is reported.
"""

from __future__ import annotations

from typing import Any

import jax
import numpy as np
import pytest
from tests.schedule.cells import glued, glued_schedule

from tandem.errors import UnsoundScheduleError
from tandem.world.arrays import NEVER, Names
from tandem.world.replay import replay
from tandem.world.state import advance, assign, late, legal, next_event, reset

NAMES = Names.of(glued())
TICK = NAMES.per_second


def begun(state: Any, task: str, operator: str) -> Any:
    """The state in which the operator has begun the task; it must be legal, and so under jit."""
    arrays, way = NAMES.arrays(), NAMES.way(task, (operator,))
    assert legal(arrays, state)[way]
    return assign(arrays, state, np.int32(way))


def moved(state: Any, seconds: float) -> Any:
    """The state when it is so late, event by event; NumPy and jit agree at each."""
    arrays = NAMES.arrays()
    jitted = jax.jit(seen)
    while state.clock < seconds * TICK:
        state = advance(arrays, state, np.int32(seconds * TICK))
        for one, other in zip(jitted(state), seen(state), strict=True):
            np.testing.assert_array_equal(one, other)
    return state


def seen(state: Any) -> tuple[Any, Any, Any]:
    arrays = NAMES.arrays()
    return legal(arrays, state), next_event(arrays, state), late(arrays, state)


def may_begin(state: Any) -> set[str]:
    return {NAMES.ways[way][0] for way in np.flatnonzero(legal(NAMES.arrays(), state))}


def test_a_schedule_with_waits_replays_to_its_makespan() -> None:
    assert replay(glued(), glued_schedule()) == 110
    with pytest.raises(UnsoundScheduleError, match="must start within 60 s"):
        replay(glued(), glued_schedule(glue=(("cobot",), 0, 5)))


def test_what_waits_may_begin_when_its_wait_is_over_and_not_before() -> None:
    state = moved(begun(reset(NAMES.arrays()), "sort", "anna"), 80)
    state = moved(begun(state, "glue", "cobot"), 100)
    assert may_begin(state) == set()
    assert int(next_event(NAMES.arrays(), state)) == 125 * TICK
    state = moved(state, 125)
    assert may_begin(state) == {"press"}
    state = begun(state, "press", "anna")
    assert int(next_event(NAMES.arrays(), state)) == 129 * TICK
    state = moved(state, 128.5)
    assert may_begin(state) == set()
    state = moved(state, 129)
    assert may_begin(state) == {"cool"}
    state = begun(state, "cool", "cobot")
    assert int(next_event(NAMES.arrays(), state)) == 135 * TICK
    assert late(NAMES.arrays(), state).tolist() == [0, 0, 0, 0]


def test_what_comes_too_late_may_begin_and_is_reported() -> None:
    state = begun(begun(reset(NAMES.arrays()), "sort", "anna"), "glue", "cobot")
    state = begun(moved(state, 100), "press", "anna")
    assert late(NAMES.arrays(), state).tolist() == [0, 0, 35 * TICK, 0]


def test_a_cell_without_waits_has_arrays_of_length_0_for_them() -> None:
    tasks = {"a": {"time": {"anna": 1}}, "b": {"time": {"cobot": 1}}}
    arrays = Names.of(glued(tasks=tasks)).arrays()
    assert arrays.lag_task.shape == arrays.lag_before.shape == (0, 2)
    assert arrays.lag_least.shape == arrays.lag_most.shape == (0,)
    assert NAMES.arrays().lag_most.tolist() == [60 * TICK, 9 * TICK]
    assert NEVER not in NAMES.arrays().lag_least
