"""Machines that hold parts: which task makes way for which, because a machine holds one part at a
time and does nothing else meanwhile.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from tandem.cell.model import Cell
from tandem.cell.precedence import between
from tandem.schedule.measures import exact
from tandem.schedule.model import Assignment, Schedule


@dataclass(frozen=True)
class Hold:
    """The machine holds a part from the start of one task to the end of another.

    Attributes:
      within: the tasks that belong to it, both ends included.
    """

    machine: str
    first: Assignment
    last: Assignment
    within: frozenset[str]

    @property
    def ends(self) -> set[str]:
        """The names of both."""
        return {self.first.task, self.last.task}

    def later(self, seconds: float) -> Hold:
        """The same hold of a part that comes so much later."""
        first, last = (
            replace(
                row,
                start=float(exact(row.start) + exact(seconds)),
                end=float(exact(row.end) + exact(seconds)),
            )
            for row in (self.first, self.last)
        )
        return replace(self, first=first, last=last)


def holds(cell: Cell, schedule: Schedule) -> tuple[Hold, ...]:
    """Every hold of the cell in the schedule, in the cell's order. Assumes a sound schedule."""
    rows = {a.task: a for a in schedule}
    return tuple(
        Hold(name, rows[first], rows[last], between(cell, first, last))
        for name, operator in cell.operators.items()
        for first, last in operator.holds
    )


def parts_handed_over(cell: Cell, schedule: Schedule) -> Iterator[tuple[str, str, str]]:
    """(machine, task that has ended, task that can begin then because of that).

    Of all that must have ended before a hold begins, or before the machine does something that does
    not belong to it, that which ends last; the others follow from it. What the order of the
    operators' own tasks says already is left out. Assumes a sound schedule.
    """
    found = holds(cell, schedule)
    for machine in dict.fromkeys(hold.machine for hold in found):
        mine = [hold for hold in found if hold.machine == machine]
        for after, before in _waits(mine, schedule.of(machine)):
            ended = [row for row in before if exact(row.end) <= exact(after.start)]
            last = max(ended, key=lambda row: (exact(row.end), row), default=None)
            if last is not None and not set(last.operators) & set(after.operators):
                yield machine, last.task, after.task


def _waits(
    mine: list[Hold], rows: tuple[Assignment, ...]
) -> Iterator[tuple[Assignment, list[Assignment]]]:
    """What cannot be at the same time as something else on one machine, with the ends of that."""
    for row in rows:  # what belongs to a hold waits for its first task
        if not any(row.task in hold.within for hold in mine):
            yield row, [hold.last for hold in mine]
    for hold in mine:
        before = [row for row in rows if row.task not in hold.within]
        for other in mine:
            if not (hold.ends <= other.within or other.ends <= hold.within):
                before.append(other.last)
        yield hold.first, before
