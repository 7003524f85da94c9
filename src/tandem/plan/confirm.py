"""A second opinion on what CP-SAT has proven: on small cells the dynamic program, which calls no
solver, searches for what CP-SAT says does not exist.

It begins with the points that were found, each behind a schedule that the checker has accepted, so
it has only to rule out everything else. That is a proof of its own: what the points cut off is
worse than a schedule in hand.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

from tandem.cell.model import Cell
from tandem.errors import NothingFoundError
from tandem.plan.dynamic_programming import NODES_A_SECOND, ExhaustiveSearch, limits
from tandem.plan.provers import Prover, Step
from tandem.plan.question import Question
from tandem.plan.result import Bound, Confirmation, Front, Outcome
from tandem.schedule.model import Schedule

MOST_TASKS = 12
"""Up to so many tasks a cell is small enough to be asked for always."""
MOST_STATES = 30_000
"""Partial schedules after which the second opinion is given up, some 6 s of one core. Most cells of
12 tasks need a fifth of that, the cell of the thesis 32.
"""
SHARE = 0.5
"""And never more than this share of the time that the proof has left."""

Confirmable = ("front", "makespan", "stress", "weighted")
"""What the dynamic program can be asked."""


@dataclass(frozen=True)
class Opinion:
    """What the dynamic program says.

    Attributes:
      better: the points in ticks and units that it has instead; empty when it agrees or gave up.
    """

    confirmation: Confirmation
    better: tuple[tuple[int, int], ...] = ()


def is_asked(cell: Cell, question: Question) -> bool:
    """Whether the cell is small enough, and the question one that can be asked."""
    return len(cell.tasks) <= MOST_TASKS and question.minimize in Confirmable


def opinion(
    cell: Cell, question: Question, found: Iterable[Schedule], seconds: float | None
) -> Opinion:
    """What the dynamic program says of an answer that is said to be complete: of a front, of one
    best schedule, or that there is none.

    Args:
      seconds: when it gives up, besides `MOST_STATES`; None for never.
    """
    search = ExhaustiveSearch(cell, question, seconds, None, MOST_STATES / NODES_A_SECOND)
    for schedule in found:
        search.know(schedule)
    known = set(search.best.found)
    search.run()
    if search.done and set(search.best.found) != known:
        return Opinion(
            Confirmation(Outcome.DISAGREES, search.states), tuple(sorted(search.best.found))
        )
    outcome = Outcome.AGREES if search.done else Outcome.OPEN
    return Opinion(Confirmation(outcome, search.states))


def confirmed(front: Front, seconds: float | None, unproven: Callable[[Front], Front]) -> Front:
    """The proven front with what the dynamic program says of it: who proved, once it agrees;
    `unproven(front)` when it does not, and an apology to be shown.
    """
    said = opinion(front.cell, front.question, [r.schedule for r in front], seconds)
    if said.confirmation.outcome == Outcome.DISAGREES:
        return replace(unproven(front), confirmation=said.confirmation)
    if said.confirmation.outcome == Outcome.AGREES:
        results = (replace(result, bound=_confirmed(result.bound)) for result in front)
        front = replace(front, results=tuple(results))
    return replace(front, confirmation=said.confirmation)


def confirm_none(cell: Cell, question: Question, seconds: float | None) -> Confirmation:
    """What the dynamic program says of "no schedule answers this".

    Raises NothingFoundError when it has one: then nothing is proven.
    """
    said = opinion(cell, question, (), seconds)
    if said.confirmation.outcome == Outcome.DISAGREES:
        raise NothingFoundError(f"whether a schedule keeps {limits(question)} is open: {apology()}")
    return said.confirmation


def apology() -> str:
    """What the user is told when the two do not agree."""
    return (
        "two proofs contradict each other: the dynamic program has found what CP-SAT has ruled out."
        " So nothing is proven. This is a bug in Tandem, not in your input: please report it with"
        " the command and the cell file."
    )


def _confirmed(bound: Bound) -> Bound:
    return replace(
        bound, of_makespan=_signed(bound.of_makespan), of_stress=_signed(bound.of_stress)
    )


def _signed(steps: tuple[Step, ...]) -> tuple[Step, ...]:
    if not steps or steps[-1].by != Prover.CP_SAT:
        return steps
    return (*steps[:-1], Step(steps[-1].value, Prover.CONFIRMED))
