"""The one door by which patterns come into a search: nothing counts that the checker of periodic
schedules has not accepted.
"""

from __future__ import annotations

from typing import NamedTuple

from tandem.cell.model import Cell
from tandem.plan.cycle.pattern import Pattern
from tandem.plan.cycle.question import CycleQuestion
from tandem.plan.instance import Instance
from tandem.schedule.cycle import PeriodicSchedule
from tandem.schedule.cycle_checker import faults
from tandem.schedule.measures import exact, stress


class Admitted(NamedTuple):
    """A pattern that the checker has accepted; only a `CycleDoor` makes one.

    Attributes:
      length: the cycle time, ticks; `stress` units; `makespan` of one product, ticks.
      pattern: per task `(way, start in ticks)`.
    """

    length: int
    stress: int
    makespan: int
    pattern: Pattern
    periodic: PeriodicSchedule

    @property
    def in_process(self) -> int:
        """The most products in the station at once."""
        return -(-self.makespan // self.length)


class CycleDoor:
    """Lets in the patterns that keep the cell and the limits of the question.

    Attributes:
      refused: what is wrong with the first pattern that a search vouched for in vain; empty as long
        as there was none. From then on that search proves nothing.
    """

    def __init__(self, cell: Cell, instance: Instance, question: CycleQuestion) -> None:
        self.cell, self.instance, self.question = cell, instance, question
        self.refused: tuple[str, ...] = ()

    def vouched(self, pattern: Pattern, length: int) -> Admitted | None:
        """The pattern of these starts, launched every `length` ticks; None, which is remembered,
        when it breaks the cell or the limits.
        """
        instance, asked = self.instance, self.question
        periodic = PeriodicSchedule(instance.schedule(pattern), instance.seconds(length))
        wrong = faults(
            self.cell,
            periodic,
            max_in_process=asked.max_in_process,
            max_cycle_time=asked.takt,
            max_stress=asked.max_stress,
        )
        if wrong:
            self.refused = self.refused or tuple(wrong)
            return None
        return Admitted(
            length,
            int(exact(stress(self.cell, periodic.schedule)) * instance.per_stress),
            int(exact(periodic.makespan) * instance.per_second),
            pattern,
            periodic,
        )

    def apology(self) -> str:
        """What the user is told about what was refused. Assumes that something was."""
        return (
            f"the checker refused a pattern that the search took for sound: {self.refused[0]} It"
            " counts for nothing, and nothing is proven. This is a bug in Tandem, not in your"
            " input: please report it with the command and the cell file."
        )
