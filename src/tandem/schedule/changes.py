"""How far one plan is from another: which tasks change operator, which their order, which only
their start.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import Any, Literal

from tandem.schedule.measures import exact
from tandem.schedule.model import Assignment, Schedule

What = Literal["operator", "order", "start"]
TOLERANCE_S = 5.0
"""A start that moves by at most so many seconds has not changed, if nothing else is said."""


@dataclass(frozen=True)
class Changed:
    """A task that both plans hold and that is not as it was.

    Attributes:
      what: the first of these that is true. "operator": others do it. "order": on one of its
        operators other tasks come before it. "start": it begins earlier or later by more than the
        tolerance.
      before, after: the task in the two plans.
    """

    task: str
    what: What
    before: Assignment
    after: Assignment

    def to_dict(self) -> dict[str, Any]:
        """One entry of `changed` in a result document."""
        return {"task": self.task, "what": self.what}


@dataclass(frozen=True)
class Changes:
    """What differs between two plans.

    Attributes:
      changed: in order of their start in the second plan.
      new, gone: tasks that only the second plan holds, and only the first.
      same: how many tasks of both plans are as they were.
      tolerance: seconds.
    """

    changed: tuple[Changed, ...]
    new: tuple[str, ...]
    gone: tuple[str, ...]
    same: int
    tolerance: float

    def count(self, what: What) -> int:
        """How many tasks have changed so."""
        return sum(changed.what == what for changed in self.changed)

    @property
    def counts(self) -> tuple[int, int, int]:
        """Tasks that change operator, that change order, and that only begin at another time."""
        return self.count("operator"), self.count("order"), self.count("start")


def changes(before: Schedule, after: Schedule, tolerance: float = TOLERANCE_S) -> Changes:
    """What differs between two plans, task by task.

    A task changes its order when it keeps its operators and, on one of them, the set of tasks that
    come before it is another one. Only tasks count there that both plans give to that operator: one
    that is new, gone or now done by others changes nobody's order. Two neighbours that swap have
    both changed.

    Args:
      tolerance: seconds by which a start may move and still be the same.
    """
    first, second = ({a.task: a for a in schedule} for schedule in (before, after))
    both = [task for task in second if task in first]
    swapped = set(_swapped(first, second, both))
    found = []
    for task in both:
        what = _what(first[task], second[task], task in swapped, tolerance)
        if what is not None:
            found.append(Changed(task, what, first[task], second[task]))
    return Changes(
        tuple(found),
        tuple(task for task in second if task not in first),
        tuple(task for task in first if task not in second),
        len(both) - len(found),
        tolerance,
    )


def _what(before: Assignment, after: Assignment, swapped: bool, tolerance: float) -> What | None:
    if set(before.operators) != set(after.operators):
        return "operator"
    if swapped:
        return "order"
    moved = abs(exact(after.start) - exact(before.start))
    return "start" if moved > exact(tolerance) else None


def _swapped(
    first: dict[str, Assignment], second: dict[str, Assignment], both: list[str]
) -> Iterator[str]:
    """The tasks of every pair that an operator does in both plans, in another order."""
    shared = {task: set(first[task].operators) & set(second[task].operators) for task in both}
    for one, two in combinations(both, 2):
        was, now = ((plan[one].start, plan[two].start) for plan in (first, second))
        if shared[one] & shared[two] and (was[0] < was[1]) != (now[0] < now[1]):
            yield from (one, two)
