"""Many schedules of one cell at once, as arrays: who does what, what that comes to, and when tasks
end when they are appended in an order.

Axes: `N` schedules, `T` tasks, `W` ways of a task (as many as the task of most has), `O` operators,
`M` measures. Ends count precedence, releases and operators, and nothing else of a cell: waits,
breaks, tools, zones and ways to walk can only make them later.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from tandem.plan.axes.counted import Budget, Counted
from tandem.plan.list_scheduling import Layout

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


class Arrays:
    """The cell.

    Attributes:
      ticks: `[T, W]` durations. `busy`: `[T, W, O]`, who takes part.
      cost: `[M, T, W, O]` units that a task adds to a measure for an operator.
      possible: per task, the ways that can be part of a schedule.
      caps: `[T, W]` what each way takes of what one person may have, and how much there is.
    """

    def __init__(
        self, layout: Layout, counted: Sequence[Counted], budgets: Sequence[Budget]
    ) -> None:
        self.layout, self.instance, self.counted = layout, layout.instance, counted
        ways = self.instance.ways
        shape = (len(ways), max(map(len, ways)), len(self.instance.operators))
        self.ticks = np.zeros(shape[:2], np.int64)
        self.busy = np.zeros(shape, bool)
        self.cost = np.zeros((len(counted), *shape), np.int64)
        self.before = np.zeros((len(ways), len(ways)), bool)
        self.release = np.array(self.instance.release)
        for task, row in enumerate(ways):
            self.before[task, list(self.instance.before[task])] = True
            for place, way in enumerate(row):
                self.ticks[task, place] = way.ticks
                self.busy[task, place, list(way.operators)] = True
                for number, measure in enumerate(counted):
                    for who, units in measure.units_of(self.instance, task, place):
                        self.cost[number, task, place, who] += units
        self.possible = [np.array([step.way for step in row]) for row in layout.steps]
        self.caps = [*self._allowances(), *(cap for one in budgets for cap in self._caps(one))]
        self.each = np.arange(len(ways))

    @staticmethod
    def fit(layout: Layout, counted: Iterable[Counted]) -> bool:
        """Whether arrays can hold all that is asked. Assumes that every task can be done."""
        return not any(one.by_set(layout.instance) for one in counted)

    def units(self, ways: Ints) -> Ints:
        """`[N, M]` of `[N, T]` ways."""
        found = []
        for measure, cost in zip(self.counted, self.cost, strict=True):
            chosen = cost[self.each, ways]
            if measure.measure.what == "peak":
                found.append(chosen.max((1, 2)))
            else:
                own = chosen.sum(1)
                found.append(own.max(1) if measure.measure.of_highest else own.sum(1))
        return np.stack(found, axis=1)

    def allowed(self, ways: Ints) -> Bools:
        """`[N]`: nobody has more than allowed, and teams stay together."""
        allowed = np.ones(len(ways), bool)
        for cost, most in self.caps:
            allowed &= cost[self.each, ways].sum(1) <= most
        for one, other in self.instance.same_operator:
            mine, yours = self.busy[one, ways[:, one]], self.busy[other, ways[:, other]]
            allowed &= (mine == yours).all(1)
        return allowed

    def played(self, ways: Ints, keys: Floats) -> tuple[Ints, Ints]:
        """`[N, T]` starts and `[N]` makespans of the tasks appended in the order of their `[N, T]`
        keys, no task before what it waits for.
        """
        keys = keys.copy()
        for first in self.instance.order:
            for later in self.instance.begun_behind[first]:
                keys[:, later] = np.maximum(keys[:, later], keys[:, first] + 1e-6)
        order, row = np.argsort(keys, axis=1, kind="stable"), np.arange(len(ways))
        starts, ends = np.zeros_like(ways), np.zeros_like(ways)
        free = np.zeros((len(ways), self.busy.shape[2]), np.int64)
        for place in range(len(self.each)):
            task = order[:, place]
            way = ways[row, task]
            busy = self.busy[task, way]
            ready = np.maximum((ends * self.before[task]).max(1), self.release[task])
            start = np.maximum(ready, (free * busy).max(1))
            end = np.asarray(start + self.ticks[task, way])
            starts[row, task], ends[row, task] = start, end
            free = np.where(busy, end[:, None], free)
        return starts, ends.max(1)

    def _allowances(self) -> Iterable[tuple[Ints, int]]:
        """`[T, W]` what each way takes of each person's allowances, and how much there is."""
        for number, allowance in enumerate(self.instance.allowances):
            cost = np.zeros_like(self.ticks)
            for task, row in enumerate(self.instance.ways):
                for place, way in enumerate(row):
                    cost[task, place] = sum(due for which, due in way.dues if which == number)
            yield cost, allowance.most

    def _caps(self, budget: Budget) -> Iterable[tuple[Ints, int]]:
        """The same of a limit of the question; a peak allows no way that is above it."""
        for person in budget.people:
            cost = np.zeros_like(self.ticks)
            for task, row in enumerate(budget.cost):
                for place, way in enumerate(row):
                    cost[task, place] = sum(units for who, units in way if who == person)
            if budget.is_peak:
                yield (cost > budget.most).astype(np.int64), 0
            else:
                yield cost, budget.most
