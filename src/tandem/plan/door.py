"""The one door by which schedules come into a search: nothing counts that the checker has not
accepted.

Values come before proofs. What a search calls its best so far, what it cuts off at and what it
calls proven is the value of a schedule that came in here, measured as the checker sees it. A model
or a state space may be wrong; then its schedule is refused, and its value is nobody's.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import NamedTuple

from tandem.cell.model import Cell
from tandem.plan.instance import Instance
from tandem.plan.question import Question
from tandem.schedule.checker import faults
from tandem.schedule.measures import exact, makespan, stress
from tandem.schedule.model import Schedule


class RefusedScheduleWarning(RuntimeWarning):
    """A search took a schedule for sound that breaks its cell: the search is wrong, and proves
    nothing.
    """


class Admitted(NamedTuple):
    """A schedule that the checker has accepted; only a `Door` makes one.

    Attributes:
      makespan: ticks; `stress` units: what the schedule is worth.
      starts: per task `(way, start in ticks)`, of which the schedule is the same in names.
    """

    makespan: int
    stress: int
    starts: tuple[tuple[int, int], ...]
    schedule: Schedule

    @property
    def point(self) -> tuple[int, int]:
        """Makespan in ticks and stress in units."""
        return self.makespan, self.stress


class Door:
    """Lets in the schedules that keep the cell, the limits of the question, and what was promised
    besides.

    Attributes:
      promises: what else is wrong with a schedule, in sentences; the checker is asked first.
      refused: what is wrong with the first schedule that a search vouched for in vain; empty as
        long as there was none. From then on that search proves nothing.
    """

    def __init__(
        self,
        cell: Cell,
        instance: Instance,
        question: Question,
        promises: Callable[[Schedule], Iterable[str]] = lambda schedule: (),
    ) -> None:
        self.cell, self.instance, self.question = cell, instance, question
        self.promises = promises
        self.refused: tuple[str, ...] = ()

    def admit(self, starts: Iterable[tuple[int, int]]) -> Admitted | None:
        """The schedule of these starts; None when it breaks the cell or the question's limits."""
        starts = tuple(starts)
        schedule = self.instance.schedule(starts)
        return None if self._faults(schedule) else self._admitted(starts, schedule)

    def vouched(self, starts: Iterable[tuple[int, int]]) -> Admitted | None:
        """As `admit`, for starts that a search vouches for: a refusal is remembered."""
        starts = tuple(starts)
        schedule = self.instance.schedule(starts)
        if wrong := self._faults(schedule):
            self.refuse(wrong)
            return None
        return self._admitted(starts, schedule)

    def refuse(self, wrong: Iterable[str]) -> None:
        """Remembers what is wrong with a schedule that a search vouched for."""
        self.refused = self.refused or tuple(wrong)

    def hinted(self, schedule: Schedule) -> Admitted | None:
        """A schedule from outside, its starts cut down to whole ticks; None when it breaks the cell
        or the limits.
        """
        return None if self._faults(schedule) else self.admit(self.instance.starts(schedule))

    def apology(self) -> str:
        """What the user is told about what was refused. Assumes that something was."""
        return (
            f"the checker refused a schedule that the search took for sound: {self.refused[0]} It"
            " counts for nothing, and nothing is proven. This is a bug in Tandem, not in your"
            " input: please report it with the command and the cell file."
        )

    def _faults(self, schedule: Schedule) -> list[str]:
        limits = self.question
        wrong = faults(
            self.cell, schedule, max_makespan=limits.max_makespan, max_stress=limits.max_stress
        )
        return wrong or list(self.promises(schedule))

    def _admitted(self, starts: tuple[tuple[int, int], ...], schedule: Schedule) -> Admitted:
        ticks = exact(makespan(schedule)) * self.instance.per_second
        units = exact(stress(self.cell, schedule)) * self.instance.per_stress
        return Admitted(int(ticks), int(units), starts, schedule)
