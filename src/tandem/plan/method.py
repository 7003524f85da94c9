"""What every method of planning is: a cell and a question in, a front out, and what it tells while
it works.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

from tandem.cell.model import Cell
from tandem.plan.question import Question
from tandem.plan.result import Front, Result
from tandem.schedule.model import Schedule

Hint = Schedule | Sequence[Schedule] | None
"""A schedule to begin with, or several; those that the checker refuses are left aside."""


def schedules_in(hint: Hint) -> Sequence[Schedule]:
    """The schedules of a hint."""
    if hint is None:
        return ()
    return (hint,) if isinstance(hint, Schedule) else hint


@dataclass(frozen=True)
class Progress:
    """What a method knows so far.

    Attributes:
      found: the results so far that nothing found beats, sorted by makespan.
      bound: no schedule that answers the question now being worked on can be below this makespan,
        seconds.
      wall_s: since the method began.
      open_area: of a front, the share of its area that is neither reached by what was found nor
        ruled out by what was proven; it only shrinks. None where that is not told.
    """

    found: tuple[Result, ...]
    bound: float
    wall_s: float
    open_area: float | None = None


class Method(Protocol):
    """Every method of planning: a cell and a question in, a front out.

    `time_limit` in seconds (None: until done), `work` a limit on work instead (CP-SAT's
    deterministic seconds, or what takes about as long): no clock is asked then, so that a run
    repeats; None for no such limit. `workers` threads or processes (None: as many as
    there are cores; 1 repeats exactly for a seed), `hint` a schedule to begin with, or several,
    `on_solution` is called with each improvement and may raise `KeyboardInterrupt` to stop: the
    front found so far is then returned with `interrupted` set.

    Raises:
      InfeasibleError: it is proven that no schedule answers the question.
      NothingFoundError: none was found within the limit.
    """

    def __call__(
        self,
        cell: Cell,
        question: Question = Question(),
        *,
        time_limit: float | None = None,
        work: float | None = None,
        seed: int = 0,
        workers: int | None = None,
        hint: Hint = None,
        on_solution: Callable[[Progress], None] | None = None,
    ) -> Front: ...
