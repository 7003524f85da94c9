"""What the journal's plain Python calls legal is what the world of arrays calls legal, all along
random shifts, with mistakes and without.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.plan.brute_force import front_of_all
from tests.strategies import cells

from tandem.cell.model import Cell
from tandem.dispatch.situation.events import Event
from tandem.dispatch.situation.legal import legal
from tandem.dispatch.situation.model import Situation, mode
from tandem.dispatch.situation.objections import objections, remarks
from tandem.dispatch.situation.transitions import after
from tandem.world import state as world
from tandem.world.arrays import NEVER, Arrays, Names


@settings(max_examples=60)
@given(st.data(), cells(), st.booleans())
def test_both_agree_on_what_may_begin_wherever_a_shift_comes(
    data: st.DataObject, cell: Cell, mistakes: bool
) -> None:
    names = Names.of(cell)
    arrays = names.arrays(undo=1.0 if mistakes else None)
    state, situation = world.reset(arrays), Situation.of(cell)
    for _ in range(60):
        mask = world.legal(arrays, state)
        ways = [int(way) for way in np.flatnonzero(mask)]
        assert set(legal(situation)) == {
            (task, way.operators) for task, way in (names.ways[number] for number in ways)
        }
        if ways and data.draw(st.booleans(), "begin something"):
            state, situation = _begin(data, names, arrays, state, situation, ways)
        elif world.next_event(arrays, state) < NEVER:
            state, situation = _run_on(names, arrays, state, situation)
        elif not ways:
            break
    assert bool(world.is_done(state)) == situation.is_over


def test_a_part_is_not_taken_up_where_another_must_come_before_it_is_out() -> None:
    """Each of the two parts must be out before the other comes in: nobody begins with either."""
    tasks = {"1": (), "2": (), "3": ("1", "2"), "4": ("3",), "5": ("1", "3")}
    cell = Cell.model_validate(
        {
            "name": "two parts",
            "operators": {
                "robot": {"kind": "robot"},
                "press": {"kind": "machine", "holds": [("1", "4"), ("3", "5")]},
            },
            "tasks": {
                name: {"time": {"robot": 1}, "after": after} for name, after in tasks.items()
            },
        }
    )
    names = Names.of(cell)
    arrays = names.arrays()
    mask = world.legal(arrays, world.reset(arrays))
    assert [names.ways[way][0] for way in np.flatnonzero(mask)] == ["2"]
    assert legal(Situation.of(cell)) == [("2", ("robot",))]
    assert front_of_all(cell.to_dict()) == []


def _begin(
    data: st.DataObject,
    names: Names,
    arrays: Arrays,
    state: world.State,
    situation: Situation,
    ways: list[int],
) -> tuple[world.State, Situation]:
    way = data.draw(st.sampled_from(ways), "way")
    task, chosen = names.ways[way]
    quickest = names.ways.index((task, mode(names.cell, task, chosen.operators)))
    if quickest not in ways:
        return state, situation
    badly = (
        bool(arrays.undo.shape[0])
        and task not in situation.wrong
        and data.draw(st.sampled_from((False, False, True)), "done badly")
    )
    noticed = (
        np.int32(data.draw(st.integers(0, 9), "noticed after") * names.per_second // 4)
        if badly
        else None
    )
    begun = world.assign(arrays, state, np.int32(quickest), noticed=noticed)
    situation = _take(situation, Event("started", situation.now, task, chosen.operators))
    number = list(names.cell.tasks).index(task)
    assert names.seconds(begun.end_at[number]) == situation.running[task].expected_end
    return begun, situation


def _run_on(
    names: Names, arrays: Arrays, state: world.State, situation: Situation
) -> tuple[world.State, Situation]:
    later = world.advance(arrays, state)
    now = names.seconds(later.clock)
    for place, task in enumerate(names.cell.tasks):
        if task in situation.running and state.end_at[place] <= later.clock:
            situation = _take(
                situation, Event("undone" if situation.running[task].undoing else "done", now, task)
            )
    if arrays.undo.shape[0]:
        for task, bad in zip(names.cell.tasks, later.bad_at <= later.clock, strict=True):
            if bad and task in situation.done:
                situation = _take(situation, Event("wrong", now, task))
    return later, replace(situation, now=now)


def _take(situation: Situation, event: Event) -> Situation:
    assert objections(situation, event) == []
    assert remarks(situation, event) == []
    return after(situation, event)
