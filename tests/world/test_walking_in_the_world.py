"""Walking, and tools by operator, in the world: idle time is used to walk, as for changeovers, in
NumPy and under JAX; and plans replay to the tick.
"""

from __future__ import annotations

from typing import Any

import jax
import numpy as np
import pytest
from tests.dispatch.stations import ROOT

import tandem
from tandem.cell.model import Cell
from tandem.files.validate import cell_of
from tandem.plan.methods import plan
from tandem.world.arrays import Names
from tandem.world.replay import replay
from tandem.world.state import State, advance, assign, legal, reset, starts


def station(**more: Any) -> Cell:
    data = {
        "operators": {"anna": {"kind": "human"}, "cobot": {"kind": "robot"}},
        "tasks": {
            "a": {"time": {"anna": 2}, "place": "bench", "tool": "driver"},
            "b": {"time": {"anna": 3}, "place": "press", "tool": {"anna": "gauge"}},
            "c": {"time": {"cobot": 5}},
        },
        "tools": {"gauge": {"changeover": {"anna": 1}}},
        "walk": {"anna": {"bench-press": 3, "press-bench": 2}},
    }
    return cell_of({**data, **more})


def starting(names: Names, state: State, task: str) -> float:
    way = names.way(task, ("anna",))
    return names.seconds(int(starts(names.arrays(), state)[way]))


def test_a_walk_and_a_changeover_come_before_the_task_and_idle_time_counts() -> None:
    names = Names.of(station())
    arrays = names.arrays()
    state = assign(arrays, reset(arrays), np.int32(names.way("a", ("anna",))))
    state = assign(arrays, state, np.int32(names.way("c", ("cobot",))))
    state = advance(arrays, state)
    assert names.seconds(int(state.clock)) == 2
    assert starting(names, state, "b") == 6
    state = advance(arrays, state)
    assert names.seconds(int(state.clock)) == 5
    assert starting(names, state, "b") == 6
    assert state.stands.tolist() == [names.places.index("bench"), -1]
    state = assign(arrays, state, np.int32(names.way("b", ("anna",))))
    assert state.stands[0] == names.places.index("press")
    assert names.seconds(int(state.end_at[1])) == 9


def test_no_break_falls_into_a_walk() -> None:
    names = Names.of(station(operators={
        "anna": {"kind": "human", "breaks": [[4, 7]]}, "cobot": {"kind": "robot"},
    }))  # fmt: skip
    arrays = names.arrays()
    state = assign(arrays, reset(arrays), np.int32(names.way("a", ("anna",))))
    state = advance(arrays, state)
    assert not legal(arrays, state)[names.way("b", ("anna",))]
    while int(state.clock) < names.ticks(7):
        state = advance(arrays, state)
    assert legal(arrays, state)[names.way("b", ("anna",))]
    assert starting(names, state, "b") == 11


def test_each_takes_its_own_tool() -> None:
    side = {"time": {"anna": 4, "cobot": 4}, "tool": {"anna": "driver", "cobot": "spindle"}}
    names = Names.of(station(tasks={"left": side, "right": side}, walk={}, tools={}))
    arrays = names.arrays()
    state = assign(arrays, reset(arrays), np.int32(names.way("left", ("anna",))))
    may = legal(arrays, state)
    assert may[names.way("right", ("cobot",))]
    shared = {**side, "tool": "driver"}
    names = Names.of(station(tasks={"left": shared, "right": shared}, walk={}, tools={}))
    arrays = names.arrays()
    state = assign(arrays, reset(arrays), np.int32(names.way("left", ("anna",))))
    assert not legal(arrays, state)[names.way("right", ("cobot",))]


@pytest.mark.parametrize("point", [0, 1])
def test_plans_replay_to_the_tick(point: int) -> None:
    cell = tandem.load(ROOT / "examples" / "pump.yaml")
    result = plan(cell, workers=1)[point]
    assert replay(cell, result.schedule) == result.makespan


def test_the_same_lines_hold_under_jax() -> None:
    names = Names.of(tandem.load(ROOT / "examples" / "pump.yaml"))
    arrays = names.arrays()
    on_device = jax.tree.map(jax.numpy.asarray, arrays)
    state, traced = reset(arrays), reset(on_device)
    moves = {"starts": jax.jit(starts), "legal": jax.jit(legal), "assign": jax.jit(assign)}
    rng = np.random.default_rng(1)
    for _ in range(60):
        may = legal(arrays, state)
        assert np.array_equal(may, moves["legal"](on_device, traced))
        assert np.array_equal(starts(arrays, state), moves["starts"](on_device, traced))
        if may.any():
            way = np.int32(rng.choice(np.flatnonzero(may)))
            state, traced = assign(arrays, state, way), moves["assign"](on_device, traced, way)
        else:
            state, traced = advance(arrays, state), jax.jit(advance)(on_device, traced)
        assert np.array_equal(state.stands, traced.stands)
    assert (state.way >= 0).all()
