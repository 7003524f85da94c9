"""What a plan puts on each person in a shift: the tasks that the plan gives to them, as often as
the shift has cycles.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from tandem.cell.assessed import Assessed, assessed
from tandem.cell.exposures import by_person
from tandem.cell.model import Cell
from tandem.ergonomics.tasks import TaskFacts, Total, in_a_shift, scored, totals
from tandem.schedule.model import Schedule


@dataclass(frozen=True)
class Peak:
    """The highest number from outside that one person meets by one method, and in which task."""

    method: str
    value: float
    task: str


@dataclass(frozen=True)
class Person:
    """One person's shift.

    Attributes:
      tasks: done by them in one cycle, in order.
      unassessed: those of these of which nothing is stated.
      minutes: at work in the shift.
      totals: of all methods by which their tasks are assessed.
      peaks: of numbers from outside.
    """

    who: str
    tasks: tuple[str, ...]
    unassessed: tuple[str, ...]
    minutes: float
    totals: tuple[Total, ...]
    peaks: tuple[Peak, ...]


@dataclass(frozen=True)
class Shift:
    """A shift by one plan.

    Attributes:
      cycles: products in the shift.
      hours: that it has; None when the number of products was stated instead.
      each_s: seconds from one product to the next.
      people: the humans of the cell, in its order.
    """

    cycles: float
    hours: float | None
    each_s: float
    people: tuple[Person, ...]


def shift(
    cell: Cell,
    schedule: Schedule,
    *,
    each_s: float,
    hours: float | None = 8.0,
    cycles: float | None = None,
) -> Shift:
    """What each human of the cell collects in a shift that repeats the plan.

    Args:
      each_s: seconds from one product to the next: the makespan, or a cycle time.
      hours: of work, breaks not counted; whole products only. Not asked where `cycles` says it.

    Raises:
      FactsError: so many repetitions a day are out of a method's range.
    """
    times = float(math.floor((hours or 0.0) * 3600 / each_s)) if cycles is None else cycles
    holds = by_person(assessed(cell))
    people = tuple(_person(cell, schedule, who, times, holds) for who in cell.humans)
    return Shift(times, hours if cycles is None else None, each_s, people)


def _person(
    cell: Cell,
    schedule: Schedule,
    who: str,
    times: float,
    holds: Mapping[tuple[str, str, str], list[Assessed]],
) -> Person:
    mine = schedule.of(who)
    seconds = {one.task: one.end - one.start for one in mine}
    rows = [
        row
        for one in mine
        for (task, human, _), found in holds.items()
        if (task, human) == (one.task, who)
        for row in found
    ]
    in_shift = [
        scored(in_a_shift(row.given, times, seconds[row.task] * times / 60))
        for row in rows
        if row.given is not None
    ]
    told = {row.task for row in rows}
    return Person(
        who,
        tuple(seconds),
        tuple(task for task in seconds if task not in told),
        math.fsum(seconds.values()) * times / 60,
        tuple(totals(in_shift)),
        tuple(_peaks(row for row in rows if row.given is None)),
    )


def _peaks(rows: Iterable[Assessed]) -> list[Peak]:
    best: dict[str, Peak] = {}
    for row in rows:
        known = best.get(row.method)
        if known is None or row.value > known.value:
            best[row.method] = Peak(row.method, row.value, row.task)
    return list(best.values())


def rows_of(cell: Cell, cycles: float) -> list[TaskFacts]:
    """The facts of every task as those of a shift of so many products. What was assessed for some
    people only names them.
    """
    return [
        replace(
            in_a_shift(one.given, cycles, None),
            task=f"{one.task} [{', '.join(one.operators)}]" if one.own else one.task,
        )
        for one in assessed(cell)
        if one.given is not None
    ]


def from_outside(cell: Cell) -> list[Assessed]:
    """The numbers that were not computed here."""
    return [one for one in assessed(cell) if one.given is None]
