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

from tandem.plan.bounds import load_prices
from tandem.plan.list_scheduling import Layout

Array = np.ndarray[Any, np.dtype[np.float32]]

TASK, OPERATOR, PAIR, FIXED = 9, 4, 3, 9
"""Features of a task, of an operator, of the two together, and of a step."""
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
        its task's easiest step.
      fixed: `[S, FIXED]` the features of a choice that never change.
    """

    first: tuple[int, ...]
    task: np.ndarray[Any, np.dtype[np.int64]]
    who: Array
    ticks: Array
    quickest: Array
    chain: Array
    stress: Array
    easiest: Array
    fixed: Array

    @cached_property
    def share(self) -> Array:
        """`[S, O]`: `who`, each row summing up to 1."""
        return self.who / self.who.sum(1, keepdims=True)

    @classmethod
    def of(
        cls, layout: Layout, exchange: float, scale: float, prices: Array, human: Array
    ) -> Steps:
        """The layout's steps. `prices` and `human`: `[O]`."""
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
            ],
            -1,
        )
        return cls(
            tuple(np.cumsum([0, *sizes[:-1]]).tolist()),
            task,
            who,
            ticks,
            quickest,
            np.array(layout.behind, np.float32)[task],
            stress,
            easiest,
            _whole(fixed),
        )


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
    """

    layout: Layout
    exchange: float
    tasks: Array
    operators: Array
    pairs: Array
    before: Array
    steps: Steps
    scale: float

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
                        pairs[task, operator] = _cut(np.log(max(over, 1e-6))), _cut(own), 1.0
        prices = np.array(load_prices(layout)[1])
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
            ],
            -1,
        )
        alone = able * (able.sum(1, keepdims=True) == 1)
        people = np.stack(
            [
                np.array(instance.human, float),
                prices,
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
            Steps.of(layout, exchange, scale, _whole(prices), _whole(instance.human)),
            scale,
        )

    @cached_property
    def shares(self) -> Array:
        """`[N, O]` ticks of each task, shared out among those who can do it."""
        able = self.pairs[..., 2]
        ticks = np.exp(self.pairs[..., 0]) * np.array(self.layout.quickest)[:, None] * able
        return (ticks / np.maximum(able.sum(1, keepdims=True), 1)).astype(np.float32)

    @cached_property
    def owned(self) -> Array:
        """`[N, O]` ticks of each task where nobody else can do it."""
        able = self.pairs[..., 2]
        return (self.shares * (able.sum(1, keepdims=True) == 1)).astype(np.float32)


def _cut(value: float) -> float:
    return float(min(max(value, -MOST_RATIO), MOST_RATIO))


def _whole(array: Any) -> Array:
    return np.clip(np.asarray(array, float), -MOST_RATIO, MOST_RATIO).astype(np.float32)
