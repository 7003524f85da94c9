"""A plan carried out: who does what in which order stays, only the clock gives way.

A task waits until every task that is planned to begin before it and wants one of its operators, its
tool or its zone has begun. So, while times are as stated and people do as they are asked, each task
begins no later than planned: by induction over the plan, what it needs is free by then. In a
semi-active plan it then begins exactly as planned.
"""

from __future__ import annotations

from typing import NamedTuple, Self

import numpy as np

from tandem.cell.model import Cell
from tandem.schedule.model import Assignment, Schedule
from tandem.world.arrays import Array, Arrays, Names, namespace
from tandem.world.episode import Shift


class Plan(NamedTuple):
    """A schedule as the world reads it.

    way: `[T]` int32, how each task is done. rank: `[T]` int32, its place in the order of starts.
    awaits: `[T, T]` bool, the first task may begin only once the second has begun.
    """

    way: Array
    rank: Array
    awaits: Array

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
                awaits[one, other] = theirs.start < mine.start and _share(
                    _needs(cell, mine), _needs(cell, theirs)
                )
        return cls(way, rank, awaits)


Needs = tuple[frozenset[str], str | None, str | None]
"""A task's operators, with the machines that hold a part from it on or until then; its tool and its
zone.
"""


def _needs(cell: Cell, row: Assignment) -> Needs:
    task = cell.tasks[row.task]
    holding = (
        who
        for who, operator in cell.operators.items()
        if any(row.task in pair for pair in operator.holds)
    )
    return frozenset((*row.operators, *holding)), task.tool, task.zone


def _share(mine: Needs, theirs: Needs) -> bool:
    return bool(mine[0] & theirs[0]) or any(
        one is not None and one == other for one, other in zip(mine[1:], theirs[1:], strict=True)
    )


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
