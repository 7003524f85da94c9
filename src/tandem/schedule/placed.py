"""One task of a schedule put elsewhere, as a person drags a bar: who, when, what comes of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from tandem.cell.model import Cell
from tandem.cell.names import Known, clean
from tandem.cell.parts import Mode
from tandem.errors import UnsoundScheduleError, UsageError
from tandem.schedule import checker
from tandem.schedule.measures import exact, makespan, stress
from tandem.schedule.model import Assignment, Schedule

ALONE = (
    checker.times_are_numbers,
    checker.operators_are_known,
    checker.the_group_can_do_the_task,
    checker.nothing_starts_before_zero,
    checker.releases_are_kept,
    checker.deadlines_are_kept,
    checker.breaks_are_free_of_work,
    checker.operators_are_set_up_first,
)
"""The rules of the checker in which no other task plays a part: what breaks one of them stays
wrong, wherever the others go.
"""


@dataclass(frozen=True)
class Placed:
    """What comes of it.

    Attributes:
      schedule: the given one with the task there; nothing else has moved.
      reasons: why the task cannot stand there wherever the others go; empty when it can.
      faults: all that the checker finds in the schedule, in sentences; empty when it is sound.
      ways: every way of doing the task.
    """

    cell: Cell
    schedule: Schedule
    reasons: tuple[str, ...]
    faults: tuple[str, ...]
    ways: tuple[Mode, ...]

    @property
    def allowed(self) -> bool:
        """The task may stand there; the others may have to make room."""
        return not self.reasons

    @property
    def makespan(self) -> float:
        """When the last task ends, seconds."""
        return makespan(self.schedule)

    @property
    def stress(self) -> float | None:
        """The cell's measure of stress; None where a task is done in no way that the cell has."""
        try:
            return stress(self.cell, self.schedule)
        except (UnsoundScheduleError, KeyError):
            return None


def place(
    cell: Cell, schedule: Schedule, task: str, operators: Sequence[str], start: float
) -> Placed:
    """The schedule with a task begun by these operators at `start` seconds, and what is wrong then.

    The task takes the time that the cell states for the operators, the shortest where they have
    several ways; where they have none it is as long as it was.

    Raises UsageError when the cell or the schedule has no such task.
    """
    task = clean(task)
    if task not in cell.tasks:
        raise UsageError(f"there is no task {task!r}. {Known(cell.tasks).hint(task)}")
    old = next((a for a in schedule if a.task == task), None)
    if old is None:
        raise UsageError(f"the schedule has no task {task!r}.")
    ways = tuple(cell.modes(task))
    who = set(map(clean, operators))
    named = [name for name in cell.operators if name in who]
    unknown = [name for name in map(clean, operators) if name not in cell.operators]
    times = [way.time for way in ways if set(way.operators) == who]
    seconds = exact(min(times)) if times else exact(old.end) - exact(old.start)
    end = float(exact(start) + seconds)
    there = Assignment(float(start), end, task, (*named, *unknown))
    moved = Schedule(tuple(there if a is old else a for a in schedule))
    alone = checker.Judged.of(cell, Schedule((there,)))
    reasons = [sentence for rule in ALONE for sentence in rule(alone)]
    return Placed(cell, moved, tuple(reasons), tuple(checker.faults(cell, moved)), ways)
