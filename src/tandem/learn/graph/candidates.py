"""What may be placed next, and what can be seen of each choice: the features that change while a
schedule is made.

Tasks are placed along the clock: none starts before the last one that was placed. The tasks of any
schedule, appended in the order of their starts, end no later; so some sequence of choices leads to
an optimum. A choice that starts later than another one is a wait.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from tandem.learn.graph.outlook import FIXED, MOST_RATIO, Array, Outlook
from tandem.plan.list_scheduling import PartialSchedule, Step

MOST = 48
"""So many choices are looked at, the earliest first: it bounds the time of a decision."""
FEATURES = 24


class Choice(NamedTuple):
    """A task that may be placed next, the step it is done by, its row among all steps, and when it
    would start, ticks.
    """

    start: int
    task: int
    step: Step
    row: int


@dataclass
class Making:
    """A schedule in the making, with what the features need to know of the rest.

    Attributes:
      ready: tasks not placed whose predecessors are.
      clock: ticks; nothing starts before.
      shared, owned: `[O]` ticks of the tasks not placed, shared out, and of each operator's own.
      left: how many tasks are not placed.
    """

    outlook: Outlook
    state: PartialSchedule
    ready: list[int]
    clock: int
    shared: Array
    owned: Array
    left: int

    @classmethod
    def of(cls, outlook: Outlook) -> Making:
        """Nothing is placed."""
        state = PartialSchedule(outlook.layout)
        ready = [task for task, count in enumerate(state.waiting) if not count]
        shared, owned = outlook.shares.sum(0), outlook.owned.sum(0)
        return cls(outlook, state, ready, 0, shared, owned, len(outlook.tasks))

    def choices(self) -> list[Choice]:
        """What may be placed next, the earliest first; empty where a limit, a team or a machine's
        part leaves nothing.
        """
        state, clock, found = self.state, self.clock, list[Choice]()
        for task in self.ready:
            first = self.outlook.steps.first[task]
            every = self.outlook.layout.steps[task]
            for step in state.steps(task):
                start = state.earliest(task, step)
                found.append(Choice(max(start, clock), task, step, first + every.index(step)))
        found.sort(key=lambda choice: (choice.start + choice.step.ticks, choice.start))
        return found[:MOST]

    def put(self, choice: Choice) -> None:
        """Places the task."""
        start, task, step, _ = choice
        self.ready.remove(task)
        self.ready += self.state.put(task, step, start)
        self.clock = start
        self.shared = self.shared - self.outlook.shares[task]
        self.owned = self.owned - self.outlook.owned[task]
        self.left -= 1


def features(making: Making, choices: Sequence[Choice]) -> Array:
    """`[K, FEATURES]`, a row for each choice: ratios of times to the tasks' mean time, to the
    longest chain that is left, and to the best of the other choices.
    """
    outlook, state = making.outlook, making.state
    steps, scale, operators = outlook.steps, outlook.scale, len(outlook.operators)
    rows = [choice.row for choice in choices]
    who, share, task = steps.who[rows], steps.share[rows], steps.task[rows]
    start = np.array([choice.start for choice in choices], np.float32)
    free = np.array(state.free, np.float32)
    end = start + steps.ticks[rows]
    critical = end + steps.chain[rows]
    now, worst, soonest = start.min(), critical.max(), end.min()
    horizon = max(float(worst - now), 1.0)
    # how the operators stand with the rest of the work shared out
    rest = free + making.shared
    # what the same task would come to by its other steps
    best = np.full(len(outlook.tasks), np.inf, np.float32)
    np.minimum.at(best, task, end)
    waiting, behind = state.waiting, outlook.layout.instance.begun_behind
    opened = [sum(waiting[after] == 1 for after in behind[choice.task]) for choice in choices]
    found = np.empty((len(choices), FEATURES), np.float32)
    found[:, :FIXED] = steps.fixed[rows]
    changing = found[:, FIXED:].T
    changing[0] = (start - now) / scale
    changing[1] = (start - (who * free).max(1)) / scale
    changing[2] = (critical - now) / horizon
    changing[3] = (critical - worst) / scale
    changing[4] = (end - soonest) / scale
    changing[5] = (end - best[task]) / scale
    changing[6] = (share @ rest - rest.max()) / scale
    changing[7] = (share @ (free + making.owned) - now) / horizon
    changing[8] = (end - free.max()) / scale
    changing[9] = opened
    changing[9] /= operators
    changing[10] = making.left / len(outlook.tasks)
    changing[11] = len(making.ready) / operators / 4
    changing[12] = making.shared.sum() / operators / horizon
    changing[13] = (free.max() - now) / scale
    changing[14] = 1 / operators
    return np.clip(found, -MOST_RATIO, MOST_RATIO, out=found)
