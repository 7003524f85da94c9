"""The table of methods for a station that repeats, and `plan_cycle`, which hides which one runs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from difflib import get_close_matches
from typing import Literal, Protocol

from tandem.cell.model import Cell
from tandem.cell.written import number
from tandem.errors import CellError, Fault, InfeasibleError, NothingFoundError, UsageError
from tandem.plan.cycle import exact, network
from tandem.plan.cycle.question import CycleQuestion
from tandem.plan.cycle.result import CycleFront
from tandem.plan.infeasible import infeasible
from tandem.plan.methods import MOST_TASKS, check_effort
from tandem.plan.question import Question
from tandem.schedule.cycle_checker import not_periodic


class CycleMethod(Protocol):
    """Every method: a cell and a question in, a front of cycle time and stress out; arguments and
    errors as `exact.solve` has them.
    """

    def __call__(
        self,
        cell: Cell,
        question: CycleQuestion,
        *,
        time_limit: float | None,
        work: float | None,
        seed: int,
        workers: int | None,
        on_point: Callable[[int], None] | None,
    ) -> CycleFront: ...


CYCLE_METHODS: dict[str, CycleMethod] = {
    "exact": exact.solve,
    "exhaustive": network.solve,
}
"""Name -> method. What each does, `tandem.plan.methods.METHODS` says: the ideas are the same."""


def plan_cycle(
    cell: Cell,
    *,
    minimize: Literal["front", "cycle_time", "stress"] = "front",
    takt: float | None = None,
    max_in_process: int | None = None,
    max_stress: float | None = None,
    method: str = "exact",
    time_limit: float | None = 60.0,
    work: float | None = None,
    seed: int = 0,
    workers: int | None = None,
    on_point: Callable[[int], None] | None = None,
) -> CycleFront:
    """The complete trade-off between cycle time (seconds) and stress of a station that makes one
    product after the other, each point with a pattern and what is proven about it.

    Tasks before and behind each other in one product may lie in different cycles; operators, tools
    and zones are used by all products in process. The cycle time is a whole number of the cell's
    ticks: the last decimal place in which its times are given. Breaks play no part: the cycle time
    holds between them. Neither does what is so at the start of a day only, `setup` and the tool in
    hand.

    Args:
      minimize: "front" for every compromise; "cycle_time" or "stress" for the one pattern that is
        best in it and, among those, in the other.
      takt: seconds; asks for the least stress that keeps it, then the fewest products in process,
        then the least cycle time.
      max_in_process: at most so many products in the station at once; with 1 the station is empty
        between two products. None for as many as help.
      max_stress: of each product.
      time_limit, work, seed, workers: as of `tandem.plan`.
      on_point: called with the number of points found, with each new one.

    Raises:
      UsageError: an unknown method, or an option out of range.
      CellError: the cell has something at a fixed time, or too many tasks.
      InfeasibleError: it is proven that no pattern answers the question; its `reasons` say why.
      NothingFoundError: none was found within the limit.
    """
    question = CycleQuestion(minimize, takt, max_in_process, max_stress)
    _check(method)
    check_effort(time_limit, work, workers)
    if wrong := _cannot_repeat(cell):
        raise CellError(wrong)
    try:
        return CYCLE_METHODS[method](
            cell,
            question,
            time_limit=time_limit if work is None else None,
            work=work,
            seed=seed,
            workers=workers,
            on_point=on_point,
        )
    except InfeasibleError as error:
        raise _explained(error, cell, question, time_limit) from error


def _check(method: str) -> None:
    if method not in CYCLE_METHODS:
        near = get_close_matches(method, CYCLE_METHODS, 1, 0.5)
        hint = f"Did you mean {near[0]!r}? " if near else ""
        raise UsageError(
            f"no method {method!r} plans a cycle. {hint}There are {', '.join(CYCLE_METHODS)}."
        )


def _cannot_repeat(cell: Cell) -> list[Fault]:
    wrong = [Fault(sentence, place) for place, sentence in not_periodic(cell)]
    if len(cell.tasks) > MOST_TASKS:
        said = f"the cell has {len(cell.tasks):,} tasks, and at most {MOST_TASKS:,} can be planned."
        wrong.append(Fault(said, ("tasks",)))
    return wrong


def _explained(
    error: InfeasibleError, cell: Cell, question: CycleQuestion, time_limit: float | None
) -> InfeasibleError:
    """What could be had instead of a takt that cannot be kept; else what stands in the way of any
    schedule.
    """
    if question.takt is None:
        return infeasible(str(error), cell, Question(max_stress=question.max_stress))
    without = replace(question, takt=None, minimize="cycle_time")
    try:
        best = exact.solve(cell, without, time_limit=time_limit)[0]
    except NothingFoundError:
        return error
    except InfeasibleError:
        return infeasible(str(error), cell, Question(max_stress=question.max_stress))
    quickest = number(best.cycle_time)
    least = f"{quickest} s" if best.gap == 0 else f"at most {quickest} s"
    said = f"the least cycle time that can be kept is {least} (stress {number(best.stress)})."
    return InfeasibleError(str(error), [said])
