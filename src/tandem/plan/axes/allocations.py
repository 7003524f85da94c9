"""Who could do what so that a known front is improved: all allocations that no bound rules out.

Of a front of makespan and one or two measures the measures are decided by the allocation alone, and
the makespan is at least what the allocation's work comes to. So allocations are built up task by
task, all of a level together as arrays. One is dropped when, however quick it may be, a known
schedule is as good as it can become: for each stretch of makespans between those of known points,
what is left to do goes to robots and people so that a measure grows least while their time lasts (a
knapsack with two capacities, exact for whole ticks; Martello and Toth 1990, Knapsack problems).

Of the allocations left the makespan is bounded once more: by chains of tasks, and for each operator
by the tasks between a head and a tail (Carlier 1982, European Journal of Operational Research
11:42-47). These bounds hold for every cell, since its other rules only make things later.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from tandem.plan.axes.arrays import Arrays, Bools, Ints

MOST_OPEN = 200_000
"""Allocations of a level; above, the search gives up."""
MOST_CELLS = 150_000
"""Of a table of the least that is left; times are rounded down to stay below."""
TOGETHER = 8
"""Stretches of makespans that are asked at once."""
NEVER = 1 << 60
"""Units or ticks that stand for "not possible"."""


AT_ANY_TIME = 1 << 50
"""Ticks beyond every schedule."""


class Known:
    """What is known of a front, to be asked about many at once.

    Attributes:
      last: of each stretch of makespans between those of known points, its last tick.
    """

    def __init__(self, points: Sequence[tuple[int, ...]]) -> None:
        """Of one or two measures."""
        rows = np.array([(*point, 0)[:3] for point in points], np.int64).reshape(-1, 3)
        self.times, self.seconds = np.unique(rows[:, 0]), np.unique(rows[:, 2])
        self.last = [*(self.times - 1).tolist(), AT_ANY_TIME]
        self.best = np.full((len(self.times) + 1, len(self.seconds) + 1), NEVER)
        for ticks, first, second in rows:
            place = self.times.searchsorted(ticks) + 1, self.seconds.searchsorted(second) + 1
            self.best[place] = min(self.best[place], first)
        self.best = np.minimum.accumulate(np.minimum.accumulate(self.best, 0), 1)

    def stretch(self, ticks: Ints) -> Ints:
        """In which stretch each of the makespans lies."""
        return np.asarray(self.times.searchsorted(ticks, side="right"))

    def open(self, stretch: int | Ints, first: Ints, second: Ints) -> Bools:
        """Whether nothing known that is as quick is as good in both measures."""
        place = self.seconds.searchsorted(second, side="right")
        return np.asarray(first < self.best[stretch, place])


class Allocations:
    """The search for those that a known front leaves open."""

    def __init__(self, arrays: Arrays, is_late: Callable[[], bool]) -> None:
        self.arrays, self.is_late = arrays, is_late
        instance = arrays.instance
        self.operators = range(len(instance.operators))
        human = np.array(instance.human, bool)
        self.groups = [np.flatnonzero(~human), np.flatnonzero(human)]
        # what can be done by few is settled first
        self.order = sorted(
            range(len(arrays.each)),
            key=lambda t: (len(arrays.possible[t]), -int(arrays.ticks[t].max()), t),
        )
        self.around = np.array([self._around(operator) for operator in self.operators])
        most = [self._most_work(group) for group in self.groups]
        self.grain = 1
        while (most[0] // self.grain + 1) * (most[1] // self.grain + 1) > MOST_CELLS:
            self.grain += 1
        self.size = [work // self.grain + 1 for work in most]
        self.left = [self._tables(cost.sum(-1)) for cost in arrays.cost]
        self.peaks = [self._least_peaks(cost.max(-1)) for cost in arrays.cost]

    def open(self, points: Sequence[tuple[int, ...]]) -> Ints | None:
        """`[N, T]` ways of the allocations that may improve on these points; None when they are too
        many to list, or time is up.
        """
        known, shape = Known(points), (1, len(self.operators))
        ways = np.zeros((1, len(self.order)), np.int8)
        load, spent = np.zeros(shape, np.int64), np.zeros((1, 2), np.int64)
        own = np.zeros((len(self.arrays.cost), *shape), np.int64)
        for place, task in enumerate(self.order):
            rows = []
            for way in self.arrays.possible[task]:
                chosen = ways.copy()
                chosen[:, task] = way
                busy = self.arrays.busy[task, way] * self.arrays.ticks[task, way]
                cost = self.arrays.cost[:, task, way][:, None]
                grown = [
                    np.maximum(mine, more) if counted.measure.what == "peak" else mine + more
                    for counted, mine, more in zip(self.arrays.counted, own, cost, strict=True)
                ]
                rows.append((chosen, load + busy, spent + self._coarse(task, way), grown))
            ways = np.concatenate([row[0] for row in rows])
            load = np.concatenate([row[1] for row in rows])
            spent = np.concatenate([row[2] for row in rows])
            own = np.concatenate([np.stack(row[3]) for row in rows], axis=1)
            alive = self._alive(known, place + 1, load, spent, own)
            ways, load, spent, own = ways[alive], load[alive], spent[alive], own[:, alive]
            if len(ways) > MOST_OPEN or self.is_late():
                return None
        found = ways.astype(np.int64)
        return found[self.arrays.allowed(found)]

    def still_open(self, ways: Ints, bound: Ints, points: Sequence[tuple[int, ...]]) -> Bools:
        """`[N]`: with a makespan of at least the bound, they may improve on these points."""
        if not len(ways):
            return np.zeros(0, bool)
        known, units = Known(points), self.arrays.units(ways)
        second = units[:, 1] if units.shape[1] > 1 else np.zeros(len(ways), np.int64)
        return known.open(known.stretch(bound), units[:, 0], second)

    def _alive(self, known: Known, done: int, load: Ints, spent: Ints, own: Ints) -> Bools:
        """`[N]`: in some stretch of makespans nothing known is as good as what these can become.

        Several stretches are asked at once, as long as the last of them and as open as the first;
        only what that leaves is asked of each.
        """
        quickest = (load + self.around).max(1)
        alive = np.zeros(len(load), bool)

        def asked(rows: Ints, stretch: int, last: int) -> Ints:
            rows = rows[quickest[rows] <= last]
            room = np.array(
                [(last * len(g) - self.around[g].sum()) // self.grain for g in self.groups]
            )
            left = np.minimum(room - spent[rows], np.array(self.size) - 1)
            fits = (left >= 0).all(1)
            rows, left = rows[fits], left[fits]
            least = [
                self._least(measure, done, own[measure][rows], left) for measure in range(len(own))
            ]
            second = least[1] if len(least) > 1 else np.zeros(len(rows), np.int64)
            return rows[known.open(stretch, least[0], second)]

        for first in range(0, len(known.last), TOGETHER):
            together = known.last[first : first + TOGETHER]
            maybe = asked(np.flatnonzero(~alive), first, together[-1])
            for stretch, last in enumerate(together, first):
                alive[asked(maybe[~alive[maybe]], stretch, last)] = True
        return alive

    def _least(self, measure: int, done: int, own: Ints, left: Ints) -> Ints:
        """What the measure comes to at least, with so much time left to robots and people."""
        rest: Ints = self.left[measure][done][left[:, 0], left[:, 1]]
        asked = self.arrays.counted[measure].measure
        if asked.what == "peak":
            return np.where(rest < NEVER, np.maximum(own.max(1), self.peaks[measure][done]), NEVER)
        if not asked.of_highest:
            return np.asarray(own.sum(1) + rest)
        bearers = max(1, int(self.arrays.cost[measure].any((0, 1)).sum()))
        return np.asarray(np.maximum(own.max(1), -(-(own.sum(1) + rest) // bearers)))

    def _around(self, operator: int) -> int:
        """Ticks that lie before and behind all that the operator may do."""
        instance = self.arrays.instance
        mine = [
            task
            for task, row in enumerate(self.arrays.possible)
            if self.arrays.busy[task, row, operator].any()
        ]
        return min((instance.head[task] for task in mine), default=0) + min(
            (instance.rest[task] for task in mine), default=0
        )

    def _most_work(self, group: Ints) -> int:
        """Ticks of the group when every task is done in the way that takes most of it."""
        work = self.arrays.ticks * self.arrays.busy[:, :, group].sum(2)
        return int(work.max(1).sum())

    def _coarse(self, task: int, way: int) -> Ints:
        busy = self.arrays.busy[task, way]
        work = [int(busy[group].sum() * self.arrays.ticks[task, way]) for group in self.groups]
        return np.array(work, np.int64) // self.grain

    def _tables(self, cost: Ints) -> list[Ints]:
        """Of the tasks from each place in the order on: the least they add, by the time that robots
        and people have left.
        """
        tables = [np.zeros(self.size, np.int64)]
        for task in reversed(self.order):
            behind, best = tables[-1], np.full(self.size, NEVER)
            for way in self.arrays.possible[task]:
                robots, people = self._coarse(task, way)
                with_it = behind[: self.size[0] - robots, : self.size[1] - people]
                more = np.minimum(with_it + cost[task, way], NEVER)
                best[robots:, people:] = np.minimum(best[robots:, people:], more)
            tables.append(best)
        return tables[::-1]

    def _least_peaks(self, cost: Ints) -> list[int]:
        found = [0]
        for task in reversed(self.order):
            found.append(max(found[-1], int(cost[task, self.arrays.possible[task]].min())))
        return found[::-1]


class Between:
    """Heads and tails of the tasks of `N` allocations: ticks that lie before and behind them."""

    def __init__(self, arrays: Arrays, ways: Ints) -> None:
        self.arrays = arrays
        self.ticks = arrays.ticks[arrays.each, ways]
        self.busy = arrays.busy[arrays.each, ways]
        instance = arrays.instance
        ahead = _reached(instance.before, instance.order)
        self.heads = self._ends(instance.before, instance.order, ahead, arrays.release)
        beyond = _reached(instance.behind, instance.order[::-1])
        nothing = np.zeros(len(arrays.each), np.int64)
        self.tails = self._ends(instance.behind, instance.order[::-1], beyond, nothing)

    def by_chains(self) -> Ints:
        """`[N]` least makespans: a head, the task and a tail."""
        return np.asarray((self.heads + self.ticks + self.tails).max(1))

    def by_operators(self) -> Ints:
        """`[N]` least makespans: of each operator, the tasks that begin at a head or later and have
        a tail or more behind them, between the two.
        """
        found = np.zeros(len(self.ticks), np.int64)
        by_tail = np.argsort(-self.tails, axis=1, kind="stable")
        tails = np.take_along_axis(self.tails, by_tail, 1)
        heads = np.take_along_axis(self.heads, by_tail, 1)
        for operator in range(self.busy.shape[2]):
            mine = np.take_along_axis(self.busy[:, :, operator], by_tail, 1)
            work = np.take_along_axis(self.ticks, by_tail, 1) * mine
            for first in range(mine.shape[1]):
                begin = heads[:, first, None]
                late = work * (heads >= begin)
                reached = np.where(late > 0, begin + np.cumsum(late, axis=1) + tails, 0).max(1)
                found = np.maximum(found, np.where(mine[:, first], reached, 0))
        return found

    def _ends(
        self,
        direct: Sequence[Sequence[int]],
        order: Sequence[int],
        reached: Sequence[Sequence[int]],
        begin: Ints,
    ) -> Ints:
        """`[N, T]` ticks before each task: a chain that leads to it, or what one operator has to do
        among all that lead to it.
        """
        found = np.zeros_like(self.ticks)
        for task in order:
            moment = np.full(len(found), begin[task])
            for other in direct[task]:
                moment = np.maximum(moment, found[:, other] + self.ticks[:, other])
            if len(some := list(reached[task])) > 1:
                for operator in range(self.busy.shape[2]):
                    mine = self.busy[:, some, operator]
                    work = (self.ticks[:, some] * mine).sum(1)
                    soonest = np.where(mine, found[:, some], NEVER).min(1)
                    moment = np.maximum(moment, np.where(work > 0, soonest + work, 0))
            found[:, task] = moment
        return found


def _reached(direct: Sequence[Sequence[int]], order: Sequence[int]) -> list[list[int]]:
    """Per task, all that is reached by following `direct`; in the order what is followed comes
    first.
    """
    found: list[set[int]] = [set() for _ in direct]
    for task in order:
        for other in direct[task]:
            found[task] |= {other} | found[other]
    return [sorted(row) for row in found]
