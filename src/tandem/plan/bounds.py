"""Bounds that need no search: no schedule of the cell can be quicker, or put less stress on
humans.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from heapq import heapify, heappop, heappush

from tandem.plan.list_scheduling import Layout
from tandem.plan.provers import Prover, Step, rising
from tandem.plan.result import Bound


def least_makespan(layout: Layout) -> int:
    """Ticks: the longest chain, each operator's own work between heads and tails, and the work of
    all shared out at its best.
    """
    return max(chain_bound(layout), one_operator_bound(layout), load_bound(layout))


def closed_forms(layout: Layout) -> tuple[Step, ...]:
    """The parts of `least_makespan`, ticks, each with its name, as far as it says more than those
    before.
    """
    return rising(
        [
            Step(chain_bound(layout), Prover.CHAIN),
            Step(one_operator_bound(layout), Prover.LOAD),
            Step(load_bound(layout), Prover.SHARED),
        ]
    )


def reckoned(layout: Layout) -> Bound:
    """What holds of every schedule of the cell and needs no search."""
    instance, times = layout.instance, closed_forms(layout)
    stress = instance.stress(least_stress(layout) or 0)
    return Bound(
        instance.seconds(int(times[-1].value)),
        stress,
        tuple(Step(instance.seconds(int(ticks)), by) for ticks, by in times),
        (Step(stress, Prover.LEAST_STRESS),),
    )


@dataclass(frozen=True)
class WorkPrices:
    """Prices of the operators' time at which the tasks' cheapest work bounds a makespan best.

    The makespan times `total` is at least the sum of `work` over the tasks.

    Attributes:
      of_operator: whole numbers above 0; `total` is their sum.
      work: per task, ticks of its cheapest step, each operator's at their price.
    """

    of_operator: tuple[int, ...]
    total: int
    work: tuple[int, ...]

    @classmethod
    def of(cls, layout: Layout) -> WorkPrices:
        """The layout's prices, by `load_prices`."""
        return cls.at(layout, [max(1, round(_SCALE * price)) for price in load_prices(layout)[1]])

    @classmethod
    def at(cls, layout: Layout, of_operator: Sequence[int]) -> WorkPrices:
        """The layout at given prices above 0. All of them bound its makespan; those of a layout
        that is much alike do so nearly as well as its own.
        """
        prices = tuple(of_operator)
        work = tuple(
            min((step.ticks * sum(prices[o] for o in step.operators) for step in row), default=0)
            for row in layout.steps
        )
        return cls(prices, sum(prices), work)


def least_stress(layout: Layout) -> int | None:
    """Units of stress that no schedule falls below; None when `stress_of_set` lists no set that the
    operators' skills allow.
    """
    table = layout.instance.stress_of_set
    if table is None:
        return sum(layout.easiest)
    always = {
        task
        for task, row in enumerate(layout.steps)
        if row and all(_has_human(layout, step.operators) for step in row)
    }
    never = {
        task
        for task, row in enumerate(layout.steps)
        if row and not any(_has_human(layout, step.operators) for step in row)
    }
    return min(
        (value for tasks, value in table.items() if always <= tasks and not never & tasks),
        default=None,
    )


def chain_bound(layout: Layout) -> int:
    """Ticks on the longest chain of tasks, releases included, every task in its quickest step."""
    return max(head + tail for head, tail in zip(layout.head, layout.tail, strict=True))


def longest_chain(layout: Layout) -> list[int]:
    """The tasks, in order, of a chain that takes as long as `chain_bound` says."""
    instance, head = layout.instance, layout.head
    length = chain_bound(layout)
    left = [task for task, ticks in enumerate(head) if ticks + layout.tail[task] == length]
    chain = left and [min(left, key=head.__getitem__)]
    while chain:
        last = chain[-1]
        followers = {*instance.behind[last], *(lag.task for lag in instance.lags_from[last])}
        later = [task for task in left if task in followers and head[task] > head[last]]
        if not later:
            break
        chain.append(min(later, key=head.__getitem__))
    return chain


def one_operator_bound(layout: Layout) -> int:
    """Ticks: for each operator, the tasks that only they can do or take part in, one at a time,
    between their heads and tails.
    """
    return max(own_loads(layout), default=0)


def own_loads(layout: Layout) -> list[int]:
    """The same for each operator."""
    head = layout.head
    return [
        preemptive([(head[task], layout.quickest[task], layout.behind[task]) for task in mine])
        for mine in own_work(layout)
    ]


def own_work(layout: Layout) -> list[list[int]]:
    """Per operator, the tasks that only they can do or take part in."""
    return [
        [
            task
            for task, row in enumerate(layout.steps)
            if row and all(operator in step.operators for step in row)
        ]
        for operator in range(len(layout.instance.operators))
    ]


def preemptive(jobs: Sequence[tuple[int, int, int]]) -> int:
    """Ticks: the best makespan of one operator who may interrupt tasks; a task is (head, ticks,
    tail).

    Jackson's rule, of those that have arrived always the one with the longest tail, is optimal then
    (Carlier 1982, European Journal of Operational Research 11, section 2). 0 without tasks.
    """
    arrivals = sorted(jobs)
    open_: list[list[int]] = []
    clock = index = best = 0
    while index < len(arrivals) or open_:
        if not open_:
            clock = max(clock, arrivals[index][0])
        while index < len(arrivals) and arrivals[index][0] <= clock:
            _, ticks, tail = arrivals[index]
            heappush(open_, [-tail, ticks])
            index += 1
        until = arrivals[index][0] if index < len(arrivals) else None
        work = open_[0][1] if until is None else min(open_[0][1], until - clock)
        clock += work
        open_[0][1] -= work
        if not open_[0][1]:
            best = max(best, clock - open_[0][0])
            heappop(open_)
            heapify(open_)
    return best


def load_bound(layout: Layout) -> int:
    """Ticks: the work of all tasks, shared out among the operators as if it could be split."""
    return load_prices(layout)[0]


def load_prices(layout: Layout) -> tuple[int, list[float]]:
    """The load bound in ticks, and the price of each operator's time that gives it; prices sum up
    to the number of operators.

    For any prices, no makespan is below the sum over tasks of the cheapest step's price, divided by
    the sum of the prices (every operator's work is at most the makespan). Prices are searched as
    whole numbers, so nothing is rounded the wrong way.
    """
    operators = len(layout.instance.operators)
    rows = [[(step.operators, step.ticks) for step in row] for row in layout.steps if row]
    prices = _two_operators(rows) if operators == 2 else _many_operators(rows, operators)
    return -(-_weighted(rows, prices)[0] // sum(prices)), [
        operators * price / sum(prices) for price in prices
    ]


_SCALE = 1 << 10


def _many_operators(rows: list[list[tuple[tuple[int, ...], int]]], operators: int) -> list[int]:
    """Prices by thirty rounds in which whoever has more work than the mean becomes dearer, by less
    each round.
    """
    prices, best, bound = [_SCALE] * operators, [_SCALE] * operators, 0.0
    for turn in range(1, 31):
        total, loads = _weighted(rows, prices)
        if total / sum(prices) > bound:
            best, bound = prices, total / sum(prices)
        mean = max(sum(loads) / operators, 1e-9)
        prices = [
            max(1, min(100 * _SCALE, round(price * max(load / mean, 0.1) ** (1 / turn))))
            for price, load in zip(prices, loads, strict=True)
        ]
    return best


def _two_operators(rows: list[list[tuple[tuple[int, ...], int]]]) -> list[int]:
    """The bound is concave in the first operator's price: its top is where the first stops having
    more work than the second.
    """
    low, high, best, bound = 0, _SCALE, [_SCALE // 2, _SCALE // 2], -1
    while low <= high:
        prices = [(low + high) // 2, _SCALE - (low + high) // 2]
        total, (first, second) = _weighted(rows, prices)
        if total > bound:
            best, bound = prices, total
        if first > second:
            low = prices[0] + 1
        else:
            high = prices[0] - 1
    return best


def _weighted(
    rows: list[list[tuple[tuple[int, ...], int]]], weights: Sequence[int]
) -> tuple[int, list[int]]:
    """The least weighted work in all, and each operator's ticks in it."""
    total, loads = 0, [0] * len(weights)
    for row in rows:
        value, operators, ticks = min(
            (sum(weights[o] for o in operators) * ticks, operators, ticks)
            for operators, ticks in row
        )
        total += value
        for operator in operators:
            loads[operator] += ticks
    return total, loads


def _has_human(layout: Layout, operators: tuple[int, ...]) -> bool:
    return any(layout.instance.human[operator] for operator in operators)
