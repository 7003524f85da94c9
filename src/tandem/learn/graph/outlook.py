"""A cell as the network sees it before anything is placed: tasks and operators as nodes, what they
have to do with each other as relations, every number a ratio.

Nothing here depends on how large a cell is, in which unit its times are or in which order its tasks
and operators stand.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from tandem.plan.list_scheduling import Layout, Step

Array = np.ndarray[Any, np.dtype[np.float32]]

TASK, OPERATOR, PAIR, FIXED = 10, 4, 4, 11
"""Features of a task, of an operator, of the two together, and of a step."""
ROUNDS = 60
MOST_RATIO = 8.0
"""Ratios are cut off here: what lies beyond says no more than much."""


@dataclass(frozen=True)
class Steps:
    """Every step of every task in one list of `S`, task by task: what of it never changes.

    Attributes:
      first: per task, the index of its first step in the list.
      task: `[S]` its task; `who`: `[S, O]`, 1 where the operator takes part.
      ticks, quickest, chain, stress, easiest: `[S]` its own ticks, those of its task's quickest
        step, of the longest chain behind its task; the ticks that its stress is worth, and that of
        its task's easiest step; `dear`: what it costs at the operators' prices, see `priced`.
      fixed: `[S, FIXED]` the features of a choice that never change.
      table: `[5, S]` in mean task times: own ticks; the chain behind; stress above the easiest
        step's; what a bound by prices grows by when the step is taken; own ticks and the chain.
      people: `[4, S, O]`: `who`; in mean task times the step's task where nobody else can do it,
        and where they do it at the least price; `who` with each row summing up to 1.
    """

    first: tuple[int, ...]
    task: np.ndarray[Any, np.dtype[np.int64]]
    who: Array
    ticks: Array
    quickest: Array
    chain: Array
    stress: Array
    easiest: Array
    dear: Array
    fixed: Array
    table: np.ndarray[Any, Any]
    people: np.ndarray[Any, Any]

    @classmethod
    def of(cls, layout: Layout, exchange: float, scale: float, human: Array) -> tuple[Steps, Array]:
        """The layout's steps, and the price of each operator's time. `human`: `[O]`."""
        flat = [(task, step) for task, row in enumerate(layout.steps) for step in row]
        sizes = [len(row) for row in layout.steps]
        who = np.zeros((len(flat), len(human)), np.float32)
        for row, (_, step) in enumerate(flat):
            who[row, list(step.operators)] = 1.0
        task = np.array([task for task, _ in flat])
        ticks = np.array([step.ticks for _, step in flat], np.float32)
        quickest = np.array(layout.quickest, np.float32)[task]
        stress = np.array([exchange * step.stress for _, step in flat], np.float32)
        easiest = np.array([exchange * layout.easiest[task] for task, _ in flat], np.float32)
        size = who.sum(1)
        first = np.cumsum([0, *sizes[:-1]])
        price, dear = priced(who * ticks[:, None], stress, first)
        prices = price * len(human)
        cheapest = np.minimum.reduceat(dear, first)
        over = dear - cheapest[task]
        chain = np.array(layout.behind, float)[task]
        # of steps at the same price each counts
        suited = (over <= dear * 1e-6)[:, None] * who * ticks[:, None]
        suits = (
            np.add.reduceat(suited, first) / np.add.reduceat(over <= dear * 1e-6, first)[:, None]
        )
        able = np.logical_or.reduceat(who > 0, first)
        alone = able & (able.sum(1, keepdims=True) == 1)
        owned = alone * np.array(layout.quickest, float)[:, None]
        fixed = np.stack(
            [
                ticks / scale,
                np.log(np.maximum(ticks, 1) / np.maximum(quickest, 1)),
                stress / scale,
                (stress - easiest) / scale,
                who @ prices / size - 1,
                np.array([len(layout.instance.begun_behind[task]) for task, _ in flat]) / 4,
                size - 1,
                1 / np.array(sizes, np.float32)[task],
                who @ human / size,
                over / scale,
                dear / scale,
            ],
            -1,
        )
        return cls(
            tuple(first.tolist()),
            task,
            who,
            ticks,
            quickest,
            np.asarray(chain, np.float32),
            stress,
            easiest,
            dear,
            _whole(fixed),
            np.stack([ticks, chain, stress - easiest, stress - cheapest[task], ticks + chain])
            / scale,
            np.stack([who, owned[task] / scale, suits[task] / scale, who / size[:, None]]),
        ), price


@dataclass(frozen=True)
class Outlook:
    """What stays the same while a schedule is made.

    Attributes:
      layout: the cell's steps, as list scheduling wants them.
      exchange: ticks that a unit of stress is worth; 0 where time alone counts.
      tasks: `[N, TASK]`; `operators`: `[O, OPERATOR]`; `pairs`: `[N, O, PAIR]`, the last of
        which is 1 where the operator can take part in the task.
      before: `[N, N]`, 1 where the row's task waits for the column's.
      steps: what can be said of each step.
      scale: ticks, the mean of the tasks' quickest times: what times are divided by.
      price: `[O]` of an operator's time, sums up to 1; `cheapest`: `[N]` ticks, what each task
        costs at least at these prices, stress included. See `priced`.
    """

    layout: Layout
    exchange: float
    tasks: Array
    operators: Array
    pairs: Array
    before: Array
    steps: Steps
    scale: float
    price: Array
    cheapest: Array

    @classmethod
    def of(cls, layout: Layout, exchange: float) -> Outlook:
        """The cell's outlook. Assumes that every task has a step."""
        instance = layout.instance
        count, operators = len(layout.steps), len(instance.operators)
        quickest = np.array(layout.quickest, float)
        scale = max(float(quickest.mean()), 1e-9)
        tail = np.array(layout.tail, float)
        before = np.zeros((count, count), np.float32)
        for task, firsts in enumerate(instance.before):
            before[task, list(firsts)] = 1.0
        pairs = np.zeros((count, operators, PAIR), np.float32)
        for task, row in enumerate(layout.steps):
            for step in row:
                for operator, load in zip(step.operators, step.load, strict=True):
                    over = step.ticks / max(quickest[task], 1.0)
                    if not pairs[task, operator, 2] or over < pairs[task, operator, 0]:
                        own = exchange * load / scale
                        pairs[task, operator, :3] = _cut(np.log(max(over, 1e-6))), _cut(own), 1.0
        steps, price = Steps.of(layout, exchange, scale, _whole(instance.human))
        cheapest = np.minimum.reduceat(steps.dear, steps.first)
        first = np.array(steps.first)[steps.task]
        for place, task in enumerate(steps.task):
            for operator in layout.steps[task][place - first[place]].operators:
                over = (steps.dear[place] - cheapest[task]) / scale
                pairs[task, operator, 3] = _cut(over)
        able = pairs[..., 2]
        tasks = np.stack(
            [
                quickest / scale,
                tail / max(tail.max(), 1.0),
                np.array(layout.head) / max(tail.max(), 1.0),
                before.sum(1) / 4,
                before.sum(0) / 4,
                1 / np.maximum(able.sum(1), 1),
                exchange * np.array(layout.easiest) / scale,
                np.array([len(row) == 1 for row in layout.steps]),
                np.array([all(len(step.operators) > 1 for step in row) for row in layout.steps]),
                cheapest / scale,
            ],
            -1,
        )
        alone = able * (able.sum(1, keepdims=True) == 1)
        people = np.stack(
            [
                np.array(instance.human, float),
                price * operators,
                able.mean(0),
                (alone * quickest[:, None]).sum(0) / max(quickest.sum(), 1.0) * operators,
            ],
            -1,
        )
        return cls(
            layout,
            exchange,
            _whole(tasks),
            _whole(people),
            pairs,
            before,
            steps,
            scale,
            price,
            cheapest,
        )

    @property
    def share(self) -> Array:
        """`[S, O]`: who takes part in each step, each row summing up to 1."""
        return self.steps.people[3]

    @cached_property
    def row_of(self) -> tuple[dict[int, int], ...]:
        """Per task, the row of each way."""
        return tuple(
            {step.way: first + at for at, step in enumerate(row)}
            for first, row in zip(self.steps.first, self.layout.steps, strict=True)
        )

    @cached_property
    def step_of(self) -> tuple[tuple[int, Step], ...]:
        """Per row, its task and its step."""
        return tuple((task, step) for task, row in enumerate(self.layout.steps) for step in row)

    @cached_property
    def owned(self) -> Array:
        """`[N, O]` mean task times of each task where nobody else can do it."""
        return self.steps.people[1, list(self.steps.first)]

    @cached_property
    def harder(self) -> Array:
        """`[S]` units of stress of each step above those of its task's easiest one."""
        easiest = self.layout.easiest
        return np.array([step.stress - easiest[task] for task, step in self.step_of], float)

    @cached_property
    def easiest(self) -> tuple[float, ...]:
        """Per task, what the stress of its easiest step is worth in mean task times."""
        return tuple(self.exchange * easy / self.scale for easy in self.layout.easiest)

    @cached_property
    def cheap(self) -> tuple[float, ...]:
        """`cheapest` in mean task times."""
        return tuple((self.cheapest / self.scale).tolist())


def priced(work: Array, stress: Array, first: Any) -> tuple[Array, Array]:
    """Prices of the operators' time, `[O]`, and what each step costs at them, `[S]` ticks. No
    makespan plus stress is below the sum of the tasks' cheapest steps, whatever prices that sum up
    to 1: each operator's work is at most the makespan. These are the best of `ROUNDS` rounds in
    which whoever has more work than the mean becomes dearer.

    Args:
      work: `[S, O]` ticks. stress: `[S]` ticks that it is worth. first: `[N]` first step of each
        task.
    """
    operators = work.shape[1]
    price = np.full(operators, 1 / operators)
    sizes = np.diff([*first, len(stress)])
    best, bound = price, -1.0
    for turn in range(ROUNDS):
        dear = work @ price + stress
        least = np.minimum.reduceat(dear, first)
        if (total := least.sum()) > bound:
            best, bound = price, total
        taken = dear <= np.repeat(least, sizes) * (1 + 1e-9)
        # of steps that cost the same each takes its share, so that their order does not matter
        load = (taken / np.repeat(np.add.reduceat(taken, first), sizes)) @ work
        off = load / max(load.mean(), 1e-9) - 1
        price = price * np.exp(np.clip(off, -2, 2) / (1 + turn / 2))
        price /= price.sum()
    return best, work @ best + stress


def _cut(value: float) -> float:
    return float(min(max(value, -MOST_RATIO), MOST_RATIO))


def _whole(array: Any) -> Array:
    return np.clip(np.asarray(array, float), -MOST_RATIO, MOST_RATIO).astype(np.float32)
