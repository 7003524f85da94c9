"""A schedule played in the world: planner, checker and world agree on what a second is."""

from __future__ import annotations

import numpy as np

from tandem.cell.model import Cell
from tandem.errors import UnsoundScheduleError
from tandem.schedule.checker import faults
from tandem.schedule.model import Schedule
from tandem.world.arrays import Names
from tandem.world.state import advance, assign, is_done, legal, makespan, reset, starts


def replay(cell: Cell, schedule: Schedule) -> float:
    """Plays the schedule by the world's rules and returns how long it took, seconds.

    Raises:
      UnsoundScheduleError: the schedule breaks its cell, or the world does not let it be played as
        it stands.
    """
    if wrong := faults(cell, schedule):
        raise UnsoundScheduleError(wrong)
    names = Names.of(cell)
    arrays = names.arrays()
    state = reset(arrays)
    # of two that start together, one may wait for the other to begin
    place = {names.instance.tasks[task]: index for index, task in enumerate(names.instance.order)}
    for row in sorted(schedule, key=lambda row: (row.start, place[row.task])):
        way, due = names.way(row.task, row.operators), names.ticks(row.start)
        while state.clock < due:
            state = advance(arrays, state, np.int32(due))
        if not legal(arrays, state)[way] or starts(arrays, state)[way] != due:
            raise UnsoundScheduleError(
                [
                    f"task {row.task!r}: the world does not let {' and '.join(row.operators)} start"
                    f" it at {row.start:g} s."
                ]
            )
        state = assign(arrays, state, np.int32(way))
    while not is_done(state):
        state = advance(arrays, state)
    return names.seconds(makespan(state))
