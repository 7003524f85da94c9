"""Machines that hold parts, and zones that keep kinds apart, where work begins: legal play, in the
world and in the look-ahead, makes sound schedules.
"""

from __future__ import annotations

from random import Random
from typing import Any

import numpy as np
import pytest
from tests.fuzz.judges import drawn
from tests.plan.test_judges import two_parts

from tandem.cell.model import Cell
from tandem.dispatch.lookahead.transitions import Moves
from tandem.errors import CellError
from tandem.files.validate import cell_of
from tandem.schedule.checker import faults
from tandem.schedule.model import Assignment, Schedule
from tandem.world import state
from tandem.world.arrays import NEVER, Arrays, Names


def random_cell(seed: int, key: str) -> Cell | None:
    """Without deadlines, and without a most of waits: they rule out nothing here."""
    _, data = drawn(seed, key)
    for task in data["tasks"].values():
        task.pop("deadline", None)
        for wait in task.get("wait", ()):
            wait.pop("at_most", None)
    try:
        return cell_of(data)
    except CellError:
        return None


def played(cell: Cell, random: Random) -> Schedule | None:
    """A schedule by legal moves at random; None when they lead nowhere."""
    names = Names.of(cell)
    arrays = names.arrays()
    now = state.reset(arrays)
    while not state.is_done(now):
        ways = np.flatnonzero(state.legal(arrays, now)).tolist()
        if ways and (random.random() < 0.8 or state.next_event(arrays, now) == NEVER):
            now = state.assign(arrays, now, np.int32(random.choice(ways)))
        elif state.next_event(arrays, now) == NEVER:
            return None
        else:
            now = state.advance(arrays, now)
    return names.schedule(now.way, now.start_at, now.end_at)


def looked_ahead(cell: Cell, random: Random) -> Schedule | None:
    """The same by the look-ahead."""
    moves = Moves.of(cell)
    here, clock, rows = moves.root(), 0, []
    while not moves.is_over(here):
        ways, event = moves.legal(here), moves.next_event(here)
        if ways and (random.random() < 0.8 or event is None):
            way = random.choice(ways)
            here = moves.begin(here, way)
            left = next(left for other, left in here.running if other == way)
            end = clock + left
            rows.append((end - moves.ticks[way], end, *moves.named(way)))
        elif event is None:
            return None
        else:
            here, clock = moves.after(here, event), clock + event
    seconds = moves.instance.seconds
    return Schedule(
        tuple(Assignment(seconds(a), seconds(b), task, who) for a, b, task, who in rows)
    )


@pytest.mark.parametrize("key", ["holds", "apart"])
def test_legal_play_of_random_cells_makes_sound_schedules(key: str) -> None:
    counted = {"world": 0, "look-ahead": 0}
    for seed in range(1, 61):
        cell = random_cell(seed, key)
        if cell is None:
            continue
        for name, play in (("world", played), ("look-ahead", looked_ahead)):
            if name == "look-ahead" and cell.stress_of_set is not None:
                continue
            schedule = play(cell, Random(seed))
            if schedule is not None:
                counted[name] += 1
                assert faults(cell, schedule) == [], (seed, name)
    assert min(counted.values()) > 15, counted


def open_to(cell: Cell, begun: dict[str, tuple[str, ...]], ended: bool) -> set[str]:
    """The tasks that may begin when these have begun, one after the other, and ended or not."""
    names = Names.of(cell)
    arrays = names.arrays()
    now = state.reset(arrays)
    for task, who in begun.items():
        now = state.assign(arrays, now, np.int32(names.way(task, who)))
        if ended or task != list(begun)[-1]:
            now = until_free(arrays, now)
    return {names.ways[way][0] for way in np.flatnonzero(state.legal(arrays, now))}


def until_free(arrays: Arrays, now: Any) -> Any:
    while state.next_event(arrays, now) < NEVER:
        now = state.advance(arrays, now)
    return now


def test_a_part_goes_in_when_the_other_is_out_and_the_machine_does_nothing_else_meanwhile() -> None:
    cell, first = two_parts(), {"in 1": ("anna",), "run 1": ("press",), "out 1": ("ben",)}
    assert open_to(cell, {}, True) == {"in 1", "in 2", "stamp"}
    assert open_to(cell, {"in 1": ("anna",)}, False) == set()
    assert open_to(cell, {"in 1": ("anna",)}, True) == {"run 1"}
    assert open_to(cell, first, False) == set()
    assert open_to(cell, first, True) == {"in 2", "stamp"}
    # Anna could put it in, but the press is still at work
    assert open_to(cell, {"stamp": ("press",)}, False) == set()
