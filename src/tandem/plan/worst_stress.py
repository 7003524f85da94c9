"""The least stress of whoever has most: fairness as an objective.

The same limit of stress is put on every human, and the least limit with a schedule is found by
halving (`least_limits.halved`). At that limit the least makespan is asked for, and of the schedules
that have it the canonical one is taken, whose stress is spread least.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from time import monotonic

from tandem.cell.model import Cell
from tandem.plan.least_limits import halved, limited
from tandem.plan.question import Question
from tandem.plan.result import Front, Status

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
    asked = replace(question, minimize="makespan")

    def within(variant: Cell) -> Front:
        left = None if until is None else max(0.05, (until - monotonic()) / 2)
        return solve(variant, asked, left)

    best, limit, proven = halved(cell, cell.humans, within, until)
    kept = limited(cell, cell.humans, limit)
    status = Status.OPTIMAL if proven and best[0].status == Status.OPTIMAL else Status.FEASIBLE
    return replace(
        best,
        cell=kept,
        results=(replace(best[0], cell=kept, status=status),),
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
