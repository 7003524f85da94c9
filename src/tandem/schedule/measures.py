"""What a schedule is worth: makespan, stress, idle time, utilisation, critical path, slack."""

from __future__ import annotations

from tandem.cell.model import Cell
from tandem.schedule.model import Schedule


def makespan(schedule: Schedule) -> float:
    """When the last task ends, seconds; 0 for an empty schedule."""
    return max((a.end for a in schedule), default=0.0)


def stress(cell: Cell, schedule: Schedule) -> float:
    """The cell's measure of stress: the sum over the tasks done by humans, or the value of that set in `stress_of_set`."""
    raise NotImplementedError
