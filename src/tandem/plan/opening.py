"""Schedules that the exact planner begins from beside those of the dispatch rules. Who makes them
stands above this room, as what was learned does, and is known by a table alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from math import inf
from time import monotonic

from tandem.errors import UsageError
from tandem.extensions import Table
from tandem.plan.goal import Meter
from tandem.plan.list_scheduling import Layout
from tandem.plan.question import Question
from tandem.plan.starts import Starts

Opening = Callable[[Layout, Question, Callable[[], bool]], Iterator[Starts]]
"""`(layout, question, is_late)` -> schedules, those that matter most first, until it `is_late`."""

OPENINGS: Table[Opening] = Table("openings", {})
"""Name -> who makes schedules to begin from. A new one is a line here, that is an entry point of
the group `tandem.openings`.
"""

OF_ONE, OF_FRONT = range(200, 1001), range(100, 2001)
"""Tasks of the cells for which they are asked, for one schedule and for a front. With fewer a
search for one schedule ends as well without (from where on fronts gain is not measured); with more
the policy for any cell is behind the rules, or takes too long.
"""
LEAST_S, LEAST_OF_FRONT_S = 0.002, 0.004
"""Seconds of the limit that each task has to have, for one schedule and for a front."""
SHARE = 0.4
"""Of the limit they take no more, once the first is made."""
EACH_S, WORK_S = 0.0004, 3.0
"""Seconds that a schedule takes for each task, and a deterministic second of CP-SAT; reckoned with
where work is limited and no clock is asked.
"""


def opened(
    layout: Layout, question: Question, until: float | None, meter: Meter | None
) -> Iterator[Starts]:
    """What they make. Of one that cannot be loaded nothing is said: who plans does not depend on
    it.

    Args:
      until: `monotonic()` seconds at which to stop; None for never.
      meter: how much work is left; None for no limit.
    """
    tasks, began, made = len(layout.steps), monotonic(), 0
    left = inf if until is None else until - began
    if meter is not None:
        left = WORK_S * meter.left
    if not _are_asked(tasks, question, left):
        return

    def is_late() -> bool:
        return until is not None and monotonic() > until

    for name in OPENINGS:
        with suppress(UsageError):
            for starts in OPENINGS[name](layout, question, is_late):
                made += 1
                taken = monotonic() - began
                if meter is not None:
                    taken = made * EACH_S * tasks
                    meter.spend(EACH_S * tasks / WORK_S)
                yield starts
                if taken * (made + 1) / made > SHARE * left:
                    return


def _are_asked(tasks: int, question: Question, left: float) -> bool:
    """Whether it is worth it in a cell of so many tasks, with so many seconds left."""
    if question.minimize == "front":
        return tasks in OF_FRONT and left >= LEAST_OF_FRONT_S * tasks
    return tasks in OF_ONE and left >= LEAST_S * tasks
