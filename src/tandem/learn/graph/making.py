"""Schedules by the policy: always the choice that it likes best, or drawn from what it likes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from tandem.learn.graph.candidates import Choices, Making, Sight, sight
from tandem.learn.graph.network import Weights, ahead, crowd, lasting, nodes, scores
from tandem.learn.graph.outlook import Array, Outlook
from tandem.plan.list_scheduling import PartialSchedule

MOST_TEMPERATURE, WARMTH = 0.45, 6.75
"""What logits are divided by before a choice is drawn: the warmth shared out over the tasks, so
that a long schedule leaves the best choices as often as a short one. Tuned on cells of 10 to 50
tasks with seeds from 500,000 on, which are neither trained nor tested on.
"""


def temperature_of(tasks: int) -> float:
    """What the logits in a cell of so many tasks are divided by."""
    return min(MOST_TEMPERATURE, WARMTH / max(tasks, 1))


@dataclass(frozen=True)
class Maker:
    """The policy in one cell, in NumPy.

    Attributes:
      steps: `[S, HIDDEN]`: what each step's task and operators, as the network found them, add to
        the first layer of each decision. Worked out once a cell.
      ahead: `[N, O * CROWD]`, operators: `[O * CROWD]`, share: `[1, O]`, see `network.ahead`.
    """

    weights: Weights
    outlook: Outlook
    steps: Array
    ahead: Array
    operators: Array
    share: Array

    @classmethod
    def of(cls, weights: Weights, outlook: Outlook) -> Maker:
        """Looks at the cell once."""
        task, operator = nodes(
            np, weights, outlook.tasks, outlook.operators, outlook.pairs, outlook.before
        )
        table = outlook.steps
        found = lasting(np, weights, task[table.task], outlook.share @ operator, table.fixed)
        of_pairs, own, share = ahead(np, weights, task, operator, outlook.pairs)
        flat = of_pairs.reshape(len(task), -1)
        return cls(weights, outlook, found, flat, own.ravel(), share[None])

    def likes(self, making: Making, choices: Choices) -> Array:
        """`[K]` logits of the choices."""
        return self.judged(making, sight(making, choices), choices)

    def judged(self, making: Making, seen: Sight, choices: Choices) -> Array:
        """`[K]` logits of the choices, of which so much is seen."""
        own = self.operators + making.unplaced @ self.ahead / making.left
        own = own.reshape(1, self.share.shape[1], -1)
        steps = self.steps.take(choices.rows, 0)
        steps += crowd(np, self.weights, own, seen.about, self.share)
        found: Array = scores(np, self.weights, seen.features, steps)
        return found

    def build(
        self, random: np.random.Generator | None = None, temperature: float | None = None
    ) -> PartialSchedule | None:
        """A schedule: greedy without `random`, else each choice drawn from the softmax of the
        logits over `temperature`, that of `temperature_of` when None. None when it runs into a
        limit that leaves a task without a step. `Drawing` draws many.
        """
        making = Making.of(self.outlook)
        heat = temperature_of(len(self.outlook.tasks)) if temperature is None else temperature
        while making.left:
            choices = making.choices()
            if not len(choices.rows):
                return None
            at = self.chosen(making, choices, random, heat)
            making.put(int(choices.rows[at]), int(choices.starts[at]))
        return making.state

    def chosen(
        self,
        making: Making,
        choices: Choices,
        random: np.random.Generator | None,
        temperature: float,
    ) -> int:
        """Which of the choices is taken, as in `build`."""
        if len(choices.rows) == 1:
            return 0
        likes = self.likes(making, choices)
        if random is None:
            return int(likes.argmax())
        # the largest of logits with Gumbel noise is a draw from their softmax
        return int((likes / temperature + random.gumbel(size=len(likes))).argmax())


def retold(
    outlook: Outlook, starts: Sequence[tuple[int, int]]
) -> Iterator[tuple[Making, Choices, list[int]]]:
    """A schedule as the decisions that lead to it: `(making, choices, which)`, `which` of the
    choices may come next, a list of indices. All that start at the same moment may, whichever comes
    first. Ends early where a choice of the schedule is not among those that are looked at.

    Args:
      starts: per task `(way, start)`. Only who does what in which order counts; tasks are appended
        as early as they can be.
    """
    making = Making.of(outlook)
    order = sorted(range(len(starts)), key=lambda task: starts[task][1])
    rows = [outlook.row_of[task].get(way, -1) for task, (way, _) in enumerate(starts)]
    for due in order:
        choices = making.choices()
        at = {int(row): place for place, row in enumerate(choices.rows)}
        first = at.get(rows[due])
        if first is None:
            return
        moment, planned = choices.starts[first], starts[due][1]
        which = [
            at[rows[task]]
            for task in making.ready
            if starts[task][1] == planned
            and rows[task] in at
            and choices.starts[at[rows[task]]] == moment
        ]
        yield making, choices, which
        making.put(rows[due], int(moment))
