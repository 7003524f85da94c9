"""Schedules by the policy: always the choice that it likes best, or drawn from what it likes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from tandem.learn.graph.candidates import Choice, Making, features
from tandem.learn.graph.network import Weights, lasting, nodes, scores
from tandem.learn.graph.outlook import Array, Outlook
from tandem.plan.list_scheduling import PartialSchedule


@dataclass(frozen=True)
class Maker:
    """The policy in one cell, in NumPy.

    Attributes:
      steps: `[S, HIDDEN]`: what each step's task and operators, as the network found them, add to
        the first layer of each decision. Worked out once a cell.
    """

    weights: Weights
    outlook: Outlook
    steps: Array

    @classmethod
    def of(cls, weights: Weights, outlook: Outlook) -> Maker:
        """Looks at the cell once."""
        task, operator = nodes(
            np, weights, outlook.tasks, outlook.operators, outlook.pairs, outlook.before
        )
        table = outlook.steps
        return cls(weights, outlook, lasting(np, weights, task[table.task], table.share @ operator))

    def likes(self, making: Making, choices: Sequence[Choice]) -> Array:
        """`[K]` logits of the choices."""
        rows = [choice.row for choice in choices]
        found: Array = scores(np, self.weights, features(making, choices), self.steps[rows])
        return found

    def build(
        self, random: np.random.Generator | None = None, temperature: float = 1.0
    ) -> PartialSchedule | None:
        """A schedule: greedy without `random`, else each choice drawn from the softmax of the
        logits over `temperature`. None when it runs into a limit that leaves a task without a step.
        """
        making = Making.of(self.outlook)
        while making.left:
            choices = making.choices()
            if not choices:
                return None
            making.put(choices[self._chosen(making, choices, random, temperature)])
        return making.state

    def _chosen(
        self,
        making: Making,
        choices: Sequence[Choice],
        random: np.random.Generator | None,
        temperature: float,
    ) -> int:
        if len(choices) == 1:
            return 0
        likes = self.likes(making, choices)
        if random is None:
            return int(likes.argmax())
        # the largest of logits with Gumbel noise is a draw from their softmax
        return int((likes / temperature + random.gumbel(size=len(choices))).argmax())


def retold(outlook: Outlook, starts: Sequence[tuple[int, int]]) -> Iterator[tuple[Any, ...]]:
    """A schedule as the decisions that lead to it: `(making, choices, which)`, `which` of the
    choices may come next, a list of indices. All that start at the same moment may, whichever comes
    first. Ends early where a choice of the schedule is not among those that are looked at.

    Args:
      starts: per task `(way, start)`. Only who does what in which order counts; tasks are appended
        as early as they can be.
    """
    making = Making.of(outlook)
    order = sorted(range(len(starts)), key=lambda task: starts[task][1])
    waits = set(order)
    while making.left:
        choices = making.choices()
        mine = [
            (choice.start, starts[choice.task][1], row)
            for row, choice in enumerate(choices)
            if choice.step.way == starts[choice.task][0]
        ]
        due = next(task for task in order if task in waits)
        first = next((row for *_, row in mine if choices[row].task == due), None)
        if first is None:
            return
        moment, planned = choices[first].start, starts[due][1]
        which = [row for start, at, row in mine if start == moment and at == planned]
        yield making, choices, which
        making.put(choices[first])
        waits.remove(due)
