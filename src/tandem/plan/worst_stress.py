"""The least stress of whoever has most: fairness as an objective.

The same limit of stress is put on every human, and the least limit with a schedule is found by
halving; each limit is proven to have one, or to have none, by the method that plans. At that limit
the least makespan is asked for, and of the schedules that have it the canonical one is taken, whose
stress is spread least.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from time import monotonic

from tandem.cell.model import Cell
from tandem.errors import InfeasibleError, NothingFoundError
from tandem.plan.instance import Instance
from tandem.plan.question import Question
from tandem.plan.result import Front, Status
from tandem.schedule.measures import exact

Solve = Callable[[Cell, Question, float | None], Front]
"""Plans a cell within so many seconds, with the method, seed and threads that were asked for."""


def solve(cell: Cell, question: Question, solve: Solve, time_limit: float | None) -> Front:
    """One schedule whose hardest-worked human has the least stress and which, among those, is the
    quickest; within the question's limits. Its cell has that limit on every human, so that it may
    be exchanged for another schedule that keeps it; `unlimited` takes the limit off.

    Raises as the method does: InfeasibleError, NothingFoundError.
    """
    began = monotonic()
    until = None if time_limit is None else began + time_limit
    search = _Search(cell, replace(question, minimize="makespan"), solve, until)
    best, proven = search.least()
    status = Status.OPTIMAL if proven and best[0].status == Status.OPTIMAL else Status.FEASIBLE
    return replace(
        best,
        results=(replace(best[0], status=status),),
        complete=status == Status.OPTIMAL,
        question=question,
        wall_s=monotonic() - began,
        out_of_time=until is not None and monotonic() > until,
    )


def unlimited(front: Front, cell: Cell) -> Front:
    """The front for the cell as it was asked about."""
    return replace(
        front, cell=cell, results=tuple(replace(result, cell=cell) for result in front.results)
    )


class _Search:
    def __init__(self, cell: Cell, asked: Question, solve: Solve, until: float | None) -> None:
        self.cell, self.asked, self.solve, self.until = cell, asked, solve, until
        self.per_stress = Instance.of(cell).per_stress

    def least(self) -> tuple[Front, bool]:
        """The schedule of the least worst stress that was found, and whether that is proven."""
        best = self._within(None)
        low, high = 0, self._worst(best)
        while low < high:
            middle = (low + high) // 2
            try:
                found = self._within(middle)
            except InfeasibleError:
                low = middle + 1
            except NothingFoundError:
                break
            else:
                best, high = found, self._worst(found)
            if self.until is not None and monotonic() > self.until:
                break
        return best, low >= high

    def _within(self, units: int | None) -> Front:
        """The quickest schedule in which no human has more than so many units of stress."""
        left = None if self.until is None else max(0.05, (self.until - monotonic()) / 2)
        return self.solve(self._limited(units), self.asked, left)

    def _limited(self, units: int | None) -> Cell:
        if units is None:
            return self.cell
        limit = float(exact(units) / self.per_stress)
        document = self.cell.to_dict()
        for name in self.cell.humans:
            operator = document["operators"][name]
            operator["stress_limit"] = min(limit, operator.get("stress_limit", limit))
        return Cell.model_validate(document)

    def _worst(self, front: Front) -> int:
        return int(exact(front[0].worst_stress) * self.per_stress)
