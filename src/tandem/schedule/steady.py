"""The steady state of a periodic schedule: the round that each operator goes, cycle after cycle.

Assumes a sound periodic schedule. Set-up happens once, before the first cycle, and is no part of
it.
"""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal

from tandem.cell.model import Cell
from tandem.schedule.cycle import PeriodicSchedule
from tandem.schedule.measures import changeover_times, exact
from tandem.schedule.model import Assignment


@dataclass(frozen=True)
class Turn:
    """One task in an operator's round.

    Attributes:
      assignment: of one product, seconds since its own launch.
      begin: where in the cycle it starts, seconds from 0 on, less than the cycle time. It may end
        after the end of the cycle, in the next.
      lap: how many cycles before this one its product was launched.
      change: seconds of the changeover directly before it; 0 when there is none.
      tool: what is taken up in that changeover; empty when there is none.
    """

    assignment: Assignment
    begin: float
    lap: int
    change: float
    tool: str

    @property
    def seconds(self) -> float:
        """How long the task takes."""
        return float(exact(self.assignment.end) - exact(self.assignment.start))


@dataclass(frozen=True)
class Round:
    """What one operator does in each cycle, by where in it that begins.

    Attributes:
      length: of the cycle, seconds.
    """

    turns: tuple[Turn, ...]
    length: float

    @property
    def working(self) -> float:
        """Seconds of each cycle on tasks."""
        return float(sum((exact(turn.seconds) for turn in self.turns), Decimal(0)))

    @property
    def changing(self) -> float:
        """Seconds of each cycle on changeovers."""
        return float(sum((exact(turn.change) for turn in self.turns), Decimal(0)))

    @property
    def idle(self) -> float:
        """Seconds of each cycle in which the operator neither works nor changes tools."""
        return float(exact(self.length) - exact(self.working) - exact(self.changing))

    def share(self, seconds: float) -> float:
        """So many seconds as a share of the cycle."""
        return float(exact(seconds) / exact(self.length))


def rounds(cell: Cell, periodic: PeriodicSchedule) -> dict[str, Round]:
    """Every operator's round, in the cell's order, also of those who do nothing.

    The tool in hand at the beginning of a round is the one that the round before has left there.
    """
    found = {}
    for name in cell.operators:
        own = sorted(
            (a for a in periodic if name in a.operators),
            key=lambda a: (periodic.position(a.start), a),
        )
        tasks = [a.task for a in own]
        # of two rounds the second: what is in hand before the first cycle plays no part any more
        changes = changeover_times(cell, name, [*tasks, *tasks])[len(tasks) :]
        found[name] = Round(
            tuple(
                Turn(
                    a,
                    periodic.position(a.start),
                    periodic.lap(a.start),
                    change,
                    (cell.tasks[a.task].tool or "") if change else "",
                )
                for a, change in zip(own, changes, strict=True)
            ),
            periodic.cycle_time,
        )
    return found
