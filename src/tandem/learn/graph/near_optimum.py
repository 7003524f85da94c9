"""What a schedule in the making can still come to, nearly, where too many tasks are left for an
exact search: each choice is placed, and the rest is searched by insertion, compiled, from the best
schedule that is known.

What is left is a cell of its own: no task starts before the clock, and what a resource has been
given before is a task that comes first on it. So the search by insertion of `plan` does the work.

This file imports Numba, so it is itself imported only where the policy is trained.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tandem.learn.graph.candidates import Making
from tandem.learn.graph.optimum import Start, compiled, inner, start_of
from tandem.learn.graph.outlook import Outlook
from tandem.plan import insertion_moves
from tandem.plan.insertion import MOST_OUT, WARMTH_OF_FEW, parts
from tandem.plan.insertion_moves import INFINITE, Aim, Parts, Plan, Walk, rounds, take

FINE = 1000
"""Whole parts of a tick that costs are counted in."""
AGAIN, CLOSE = 4, 1.0
"""Choices that lose less than so many mean task times are searched for so many times as long."""


class NearSearch:
    """Good ends of schedules of one cell. It remembers the best schedule of what is left.

    Attributes:
      order, way: `[T]` tasks in the order of that schedule, and per task the row of its step.
    """

    def __init__(self, outlook: Outlook, starts: Sequence[tuple[int, int]], seed: int) -> None:
        """Assumes `Search.can(outlook)`. `starts`: a schedule, per task `(way, start)`."""
        layout = outlook.layout
        self.outlook = outlook
        self.parts: Parts = parts(layout, insertion_moves)
        self.order = np.array(sorted(range(len(starts)), key=lambda task: starts[task][1]))
        self.way = np.array([outlook.row_of[task][way] for task, (way, _) in enumerate(starts)])
        spread = [
            max(step.stress for step in row) - min(step.stress for step in row)
            for row in layout.steps
        ]
        stress = round(FINE * outlook.exchange)
        mean = (FINE * sum(layout.quickest) + stress * sum(spread)) / len(spread)
        self.aim = Aim(FINE, stress, INFINITE, INFINITE, max(1e-9, WARMTH_OF_FEW * mean), 3)
        self.draws = np.array([2 * seed + 1], np.uint64)

    def improve(self, making: Making, visits: int) -> None:
        """Searches for a better schedule of what is left, so many visits for each task of it."""
        start = start_of(making)
        self._search(start, -1, 0, self.order, self.way, visits)

    def losses(
        self, making: Making, rows: np.ndarray, starts: np.ndarray, visits: int
    ) -> np.ndarray:
        """`[K]` ticks that each choice loses against the best one, as far as the search sees: so
        many visits for each task that is left.
        """
        start, found = start_of(making), np.empty(len(rows))
        kept = list[tuple[np.ndarray, np.ndarray]]()
        for at, (row, moment) in enumerate(zip(rows, starts, strict=True)):
            order, way = self.order.copy(), self.way.copy()
            found[at] = self._search(start, int(row), int(moment), order, way, visits)
            kept.append((order, way))
        close = CLOSE * FINE * self.outlook.scale
        for at in np.flatnonzero(found <= found.min() + close).tolist():
            row, moment = int(rows[at]), int(starts[at])
            found[at] = min(found[at], self._search(start, row, moment, *kept[at], AGAIN * visits))
        self.order, self.way = kept[int(found.argmin())]
        return (found - found.min()) / FINE

    def _search(
        self, start: Start, row: int, moment: int, order: np.ndarray, way: np.ndarray, visits: int
    ) -> int:
        return int(_end(self.parts, self.aim, start, row, moment, order, way, visits, self.draws))


@compiled
def _end(parts, aim, start, row, moment, order, way, visits, draws):  # type: ignore[no-untyped-def]
    """Parts of ticks that makespan and stress come to when the step `row` starts at `moment` (none
    where it is below 0) and the rest is searched, from `order` and `way` on, which are then those
    of the best schedule found.
    """
    tasks, paid, clock = len(order), 0, start.clock
    free, ready, left = start.free.copy(), start.ready.copy(), start.left.copy()
    placed = -1
    if row >= 0:
        placed = _task_of(parts, row)
        paid, clock = parts.stress[row], moment
        _place(parts, placed, row, moment, free, ready)
        left[placed] = False
        way[placed] = row
    old, number = np.empty(tasks, np.int64), np.full(tasks, -1, np.int64)
    count = 0
    for task in range(tasks):
        if left[task]:
            old[count] = task
            number[task] = count
            count += 1
    if count == 0:
        return aim.time * free.max() + aim.stress * paid
    held = np.flatnonzero(free > clock)
    rest = _rest(parts, old[:count], number, held, free, ready, clock)
    walk = _walk(rest, len(free), draws)
    source, units = _known(parts, rest, old[:count], number, len(held), order, way)
    take(rest, walk, source, units, 0)
    walk.worth[0] = walk.worth[1] = aim.time * walk.worth[2] + aim.stress * units
    walk.best_order[:], walk.best_way[:] = source.order, source.way
    rounds(rest, walk, aim, visits * count)
    _remember(parts, rest, walk, old[:count], placed, left, order, way)
    return walk.worth[1] + aim.stress * paid


@inner
def _task_of(parts, row):  # type: ignore[no-untyped-def]
    return np.searchsorted(parts.way_of, row, side="right") - 1


@inner
def _place(parts, task, row, moment, free, ready):  # type: ignore[no-untyped-def]
    """Notes what the step leaves free and makes ready, and when."""
    end = moment + parts.ticks[row]
    for j in range(parts.who_of[row], parts.who_of[row + 1]):
        free[parts.who[j]] = end
    for j in range(parts.after_of[task], parts.after_of[task + 1]):
        after = parts.afters[j]
        ready[after] = max(ready[after], end + parts.wait_after[j])


@inner
def _rest(parts, old, number, held, free, ready, clock):  # type: ignore[no-untyped-def]
    """The cell of what is left: its tasks, and behind them one for each resource that is `held`,
    which comes before all that may start now but keeps only its resource busy.
    """
    whole, release = len(old) + len(held), np.zeros(len(old) + len(held), np.int64)
    for new in range(len(old)):
        release[new] = max(ready[old[new]], clock)
    first_of, firsts, wait_of, source = _firsts(parts, old, number, held, free)
    after_of, afters, wait_after = _afters(parts, old, number, held, free, source)
    way_of, ticks, stress, who_of, who = _ways(parts, old, held, free)
    none = np.zeros(0, np.int64)
    return Parts(
        first_of,
        firsts,
        wait_of,
        after_of,
        afters,
        wait_after,
        release,
        way_of,
        ticks,
        stress,
        who_of,
        who,
        np.zeros(len(ticks) + 1, np.int64),
        none,
        none,
        np.zeros(len(ticks), np.int64),
        np.zeros(whole, np.bool_),
        none,
        False,
    )


@inner
def _firsts(parts, old, number, held, free):  # type: ignore[no-untyped-def]
    """Predecessors and the waits after them, as `Parts` has them; which tasks have none left. What
    comes after a held resource starts no later for it.
    """
    count, extra, at = len(old), len(held), 0
    first_of, source = np.zeros(count + extra + 1, np.int64), np.zeros(count, np.bool_)
    room = len(parts.firsts) + extra + count
    firsts, wait_of = np.empty(room, np.int64), np.empty(room, np.int64)
    for new in range(count):
        for j in range(parts.first_of[old[new]], parts.first_of[old[new] + 1]):
            if number[parts.firsts[j]] >= 0:
                firsts[at], wait_of[at] = number[parts.firsts[j]], parts.wait_of[j]
                at += 1
        source[new] = at == first_of[new]
        if source[new] and extra:
            firsts[at], wait_of[at] = count + extra - 1, -free[held[extra - 1]]
            at += 1
        first_of[new + 1] = at
    for one in range(extra):
        if one:
            firsts[at], wait_of[at] = count + one - 1, -free[held[one - 1]]
            at += 1
        first_of[count + one + 1] = at
    return first_of, firsts[:at], wait_of[:at], source


@inner
def _afters(parts, old, number, held, free, source):  # type: ignore[no-untyped-def]
    """Successors and the waits before them, as `Parts` has them."""
    count, extra, at = len(old), len(held), 0
    after_of = np.zeros(count + extra + 1, np.int64)
    room = len(parts.afters) + extra + count
    afters, wait_after = np.empty(room, np.int64), np.empty(room, np.int64)
    for new in range(count):
        # of what is left no successor is placed
        for j in range(parts.after_of[old[new]], parts.after_of[old[new] + 1]):
            afters[at], wait_after[at] = number[parts.afters[j]], parts.wait_after[j]
            at += 1
        after_of[new + 1] = at
    for one in range(extra):
        if one + 1 < extra:
            afters[at], wait_after[at] = count + one + 1, -free[held[one]]
            at += 1
        else:
            for ready in np.flatnonzero(source):
                afters[at], wait_after[at] = ready, -free[held[one]]
                at += 1
        after_of[count + one + 1] = at
    return after_of, afters[:at], wait_after[:at]


@inner
def _ways(parts, old, held, free):  # type: ignore[no-untyped-def]
    """Ways, their ticks, stress and resources, as `Parts` has them."""
    count, extra, many, users = len(old), len(held), 0, 0
    for task in old:
        begin, end = parts.way_of[task], parts.way_of[task + 1]
        many += end - begin
        users += parts.who_of[end] - parts.who_of[begin]
    way_of = np.zeros(count + extra + 1, np.int64)
    ticks, stress = np.zeros(many + extra, np.int64), np.zeros(many + extra, np.int64)
    who_of, who = np.zeros(many + extra + 1, np.int64), np.empty(users + extra, np.int64)
    at = place = 0
    for new in range(count):
        for way in range(parts.way_of[old[new]], parts.way_of[old[new] + 1]):
            ticks[at], stress[at] = parts.ticks[way], parts.stress[way]
            for j in range(parts.who_of[way], parts.who_of[way + 1]):
                who[place] = parts.who[j]
                place += 1
            at += 1
            who_of[at] = place
        way_of[new + 1] = at
    for one, resource in enumerate(held):
        ticks[at], who[place] = free[resource], resource
        at, place = at + 1, place + 1
        who_of[at], way_of[count + one + 1] = place, at
    return way_of, ticks, stress, who_of, who


@inner
def _walk(rest, resources, draws):  # type: ignore[no-untyped-def]
    tasks = len(rest.release)
    return Walk(
        _plan(tasks),
        _plan(tasks),
        np.zeros(tasks, np.int64),
        np.zeros(tasks, np.int64),
        np.zeros(4, np.int64),
        draws,
        np.zeros(tasks, np.int64),
        np.zeros(MOST_OUT, np.int64),
        np.zeros(tasks, np.bool_),
        np.zeros(len(rest.ticks), np.bool_),
        np.zeros(resources, np.int64),
        np.zeros((tasks + 1, resources), np.int64),
        np.zeros(0, np.int64),
    )


@inner
def _plan(tasks):  # type: ignore[no-untyped-def]
    return Plan(
        np.full(tasks, -1, np.int64),
        np.full(tasks, -1, np.int64),
        np.full(tasks, -1, np.int64),
        np.full(tasks, -1, np.int64),
    )


@inner
def _known(parts, rest, old, number, extra, order, way):  # type: ignore[no-untyped-def]
    """What is left of the known schedule, behind what resources are busy with; and its stress."""
    plan, count, at, units = _plan(len(rest.release)), len(old), extra, 0
    for one in range(extra):
        plan.order[one] = count + one
        plan.way[count + one] = rest.way_of[count + one]
    for task in order:
        new = number[task]
        if new >= 0:
            plan.order[at] = new
            plan.way[new] = rest.way_of[new] + way[task] - parts.way_of[task]
            units += rest.stress[plan.way[new]]
            at += 1
    return plan, units


@inner
def _remember(parts, rest, walk, old, placed, left, order, way):  # type: ignore[no-untyped-def]
    """Writes the best schedule into `order`, behind all that is placed, and `way`."""
    tasks, count, at = len(order), len(old), 0
    before = np.empty(tasks, np.int64)
    for task in order:
        if not left[task]:
            before[at] = task
            at += 1
    for new in walk.best_order:
        if new < count:
            task = old[new]
            before[at] = task
            way[task] = parts.way_of[task] + walk.best_way[new] - rest.way_of[new]
            at += 1
    order[:] = before
