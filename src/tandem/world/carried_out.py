"""A plan carried out: who does what in which order stays, only the clock gives way.

A task waits until every task that is planned to begin before it and wants one of its operators, its
tool or its zone has begun. So, while times are as stated and people do as they are asked, each task
begins no later than planned: by induction over the plan, what it needs is free by then. In a
semi-active plan it then begins exactly as planned. A task that another one must follow within a
time does not begin before its planned start.
"""

from __future__ import annotations

from typing import NamedTuple, Self

import numpy as np

from tandem.cell.model import Cell
from tandem.schedule.model import Assignment, Schedule
from tandem.schedule.queues import taken_by
from tandem.world.arrays import Array, Arrays, Names, namespace
from tandem.world.episode import Shift


class Plan(NamedTuple):
    """A schedule as the world reads it.

    way: `[T]` int32, how each task is done. rank: `[T]` int32, its place in the order of starts.
    awaits: `[T, T]` bool, the first task may begin only once the second has begun. not_before:
    `[T]` int32, ticks before which it is held back; 0 for a task that none must follow within a
    time.
    """

    way: Array
    rank: Array
    awaits: Array
    not_before: Array

    @classmethod
    def of(cls, names: Names, schedule: Schedule) -> Self:
        """The plan of a schedule that keeps the cell."""
        cell, count = names.cell, len(names.tasks)
        rows = {row.task: row for row in schedule}
        way, rank = np.zeros(count, np.int32), np.zeros(count, np.int32)
        awaits = np.zeros((count, count), bool)
        order = [names.tasks.index(row.task) for row in schedule]
        for place, one in enumerate(order):
            mine = rows[names.tasks[one]]
            way[one], rank[one] = names.way(mine.task, mine.operators), place
            for other in order[:place]:
                theirs = rows[names.tasks[other]]
                # those that begin at the same moment have room beside each other, in either order
                awaits[one, other] = theirs.start < mine.start and bool(
                    _needs(cell, mine) & _needs(cell, theirs)
                )
        not_before = np.zeros(count, np.int32)
        for lag, _ in names.instance.most_lags:
            not_before[lag.before] = names.ticks(rows[names.tasks[lag.before]].start)
        return cls(way, rank, awaits, not_before)

    def held_back(self, arrays: Arrays) -> Arrays:
        """The cell in which nothing that is held back can begin before its time."""
        xp = namespace(arrays.release)
        return arrays._replace(release=xp.maximum(arrays.release, self.not_before))


def _needs(cell: Cell, row: Assignment) -> set[tuple[str, str]]:
    """Its operators, the machines that hold a part from it on or until then, its operators' tools
    and its zone.
    """
    holding = (
        who
        for who, operator in cell.operators.items()
        if any(row.task in pair for pair in operator.holds)
    )
    return {("operator", who) for who in (*row.operators, *holding)} | {
        (kind, name) for kind, name, _ in taken_by(cell, row)
    }


def carry_on(plan: Plan, arrays: Arrays, shift: Shift) -> Array:
    """`[]` int32, what whose turn it is begins by the plan; -1 for waiting. A decider of the world
    (`episode.Decider`) once the plan is given.
    """
    xp, state = namespace(shift.mask), shift.state
    is_open = state.way < 0
    mine = (arrays.way_uses & (xp.arange(arrays.human.shape[0]) == shift.turn)[None, :]).any(axis=1)
    due = is_open & ~(plan.awaits & is_open[None, :]).any(axis=1) & (shift.mask & mine)[plan.way]
    first = xp.where(due, plan.rank, plan.rank.shape[0]).argmin()
    return xp.where(due.any(), plan.way[first], -1).astype(xp.int32)
