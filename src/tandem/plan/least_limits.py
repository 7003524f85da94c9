"""The least limit of stress that people can be given: found by halving, each limit proven to have a
schedule, or to have none, by the method that plans.

With all humans it is fairness as an objective (`worst_stress.py`); with those whose limits cannot
be kept together it is the limit that could be (`infeasible.py`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from time import monotonic

from tandem.cell.model import Cell
from tandem.errors import InfeasibleError, NothingFoundError
from tandem.plan import exact
from tandem.plan.instance import Instance
from tandem.plan.method import Progress
from tandem.plan.question import Question
from tandem.plan.result import Front
from tandem.schedule.measures import exact as decimal
from tandem.schedule.measures import stress_by_human

Within = Callable[[Cell], Front]
"""Plans a cell; raises InfeasibleError or NothingFoundError where it has nothing."""


def halved(
    cell: Cell, people: Sequence[str], solve: Within, until: float | None
) -> tuple[Front, float, bool]:
    """A schedule in which the most that one of these people has is as little as was found; that
    limit, in the cell's measure; and whether a lower one is ruled out. Limits that the cell has
    stay. The first question is the cell as it is, and raises what `solve` raises.

    Args:
      until: `monotonic()` seconds after which no further question is begun; None for never.
    """
    per_stress = Instance.of(cell).per_stress

    def worst(front: Front) -> int:
        loads = stress_by_human(cell, front[0].schedule)
        return max((int(decimal(loads[name]) * per_stress) for name in people), default=0)

    best = solve(cell)
    low, high = 0, worst(best)
    while low < high and (until is None or monotonic() < until):
        middle = (low + high) // 2
        try:
            found = solve(limited(cell, people, float(decimal(middle) / per_stress)))
        except InfeasibleError:
            low = middle + 1
        except NothingFoundError:
            break
        else:
            best, high = found, worst(found)
    return best, float(decimal(high) / per_stress), low >= high


def limited(cell: Cell, people: Sequence[str], limit: float | None) -> Cell:
    """The cell in which none of these people may have more stress than this, or than their own
    limit where that is less; None takes their limits off.
    """
    operators = dict(cell.operators)
    for name in people:
        own = operators[name].stress_limit
        least = limit if limit is None or own is None else min(limit, own)
        operators[name] = operators[name].model_copy(update={"stress_limit": least})
    return cell.replace(operators=operators)


def least_limit(
    cell: Cell, question: Question, people: Sequence[str], *, seconds: float
) -> float | None:
    """The least limit of stress that all of these people can keep at once instead of their own, all
    other limits of the cell and of the question kept, in the cell's measure; None when there is
    none, or time was too short to prove one.
    """
    until = monotonic() + seconds

    def solve(variant: Cell) -> Front:
        return first_schedule(variant, question, max(until - monotonic(), 0.05))

    try:
        _, limit, proven = halved(limited(cell, people, None), people, solve, until)
    except (InfeasibleError, NothingFoundError):
        return None
    return limit if proven else None


def first_schedule(cell: Cell, question: Question, seconds: float) -> Front:
    """The first schedule that is found within the question's limits. Raises InfeasibleError when it
    is proven that there is none, NothingFoundError when time was too short.
    """

    def enough(progress: Progress) -> None:
        raise KeyboardInterrupt

    minimize = "stress" if question.max_stress is not None else "makespan"
    asked = Question(minimize, (1.0, 1.0), question.max_makespan, question.max_stress)  # type: ignore[arg-type]
    return exact.solve(cell, asked, time_limit=seconds, on_solution=enough)
