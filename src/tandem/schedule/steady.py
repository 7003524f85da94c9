"""The steady state of a periodic schedule: the round that each operator goes, cycle after cycle.

Assumes a sound periodic schedule. Set-up happens once, before the first cycle, and is no part of
it.
"""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal

from tandem.cell.model import Cell
from tandem.schedule.cycle import PeriodicSchedule
from tandem.schedule.measures import Ready, exact, made_ready
from tandem.schedule.model import Assignment


@dataclass(frozen=True)
class Turn:
    """One task in an operator's round.

    Attributes:
      assignment: of one product, seconds since its own launch.
      begin: where in the cycle it starts, seconds from 0 on, less than the cycle time. It may end
        after the end of the cycle, in the next.
      lap: how many cycles before this one its product was launched.
      ready: the walk and the changeover directly before it.
    """

    assignment: Assignment
    begin: float
    lap: int
    ready: Ready

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
        return float(sum((exact(turn.ready.change) for turn in self.turns), Decimal(0)))

    @property
    def walking(self) -> float:
        """Seconds of each cycle on walks."""
        return float(sum((exact(turn.ready.walk) for turn in self.turns), Decimal(0)))

    @property
    def idle(self) -> float:
        """Seconds of each cycle in which the operator neither works, nor walks, nor changes
        tools.
        """
        busy = exact(self.working) + exact(self.walking) + exact(self.changing)
        return float(exact(self.length) - busy)

    def share(self, seconds: float) -> float:
        """So many seconds as a share of the cycle."""
        return float(exact(seconds) / exact(self.length))


def rounds(cell: Cell, periodic: PeriodicSchedule) -> dict[str, Round]:
    """Every operator's round, in the cell's order, also of those who do nothing.

    Where an operator stands at the beginning of a round, and the tool that it has in hand, is as
    the round before has left it.
    """
    found = {}
    for name in cell.operators:
        own = sorted(
            (a for a in periodic if name in a.operators),
            key=lambda a: (periodic.position(a.start), a),
        )
        # of two rounds the second: what is before the first cycle plays no part any more
        prepared = made_ready(cell, name, [*own, *own])[len(own) :]
        found[name] = Round(
            tuple(
                Turn(a, periodic.position(a.start), periodic.lap(a.start), ready)
                for a, ready in zip(own, prepared, strict=True)
            ),
            periodic.cycle_time,
        )
    return found
