"""What may be placed next, and what can be seen of each choice: the features that change while a
schedule is made.

Tasks are placed along the clock: none starts before the last one that was placed. The tasks of any
schedule, appended in the order of their starts, end no later; so some sequence of choices leads to
an optimum. A choice that starts later than another one is a wait.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from tandem.learn.graph.outlook import MOST_RATIO, Array, Outlook
from tandem.plan.list_scheduling import PartialSchedule

MOST = 48
"""So many choices are looked at, the earliest first: it bounds the time of a decision."""
OF_CHOICE, OF_LENGTH, MORE = 14, 4, 10
OF_ALL = OF_CHOICE + MORE
FEATURES = OF_CHOICE + OF_LENGTH + OF_ALL
"""Features of a choice beside the least of all choices, some of them as shares of what is left; of
all choices the least, and what else can be seen of the state.
"""
LENGTHS = np.array([2, 3, 5, 8])
MOMENTS = np.array([1.0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 0, 0, 0, 0])
"""Which of them count as shares too, and which are moments, so that they count from now."""
FEW, EXACT = 12, 1e-9
GROUPS = {"bounds": (5, 6, 7, 8), "what suits whom": (9, 10), "the chain behind": (3, 12)}
"""Some of the values of a choice by what they say of it."""
ABOUT = 4
"""What can be seen of each operator once a choice is placed."""

Rows = np.ndarray[Any, np.dtype[np.int64]]


class Choices(NamedTuple):
    """The steps that may come next, task by task: `[K]` their rows among all steps, and the ticks
    at which they would start; per task that is ready, the place of its first choice, and for each
    choice the place of its task among these.
    """

    rows: Rows
    starts: Rows
    first: Rows
    group: Rows


@dataclass
class Making:
    """A schedule in the making, with what the features need to know of the rest.

    Attributes:
      ready: tasks not placed whose predecessors are.
      clock: ticks; nothing starts before.
      owned: `[O]` mean task times, each operator's own work that is not placed.
      cheap, easy: mean task times of the tasks not placed at the operators' prices, and that their
        least stress is worth.
      left: how many tasks are not placed; unplaced: `[N]`, 1 for each of them.
    """

    outlook: Outlook
    state: PartialSchedule
    ready: list[int]
    clock: int
    owned: Array
    cheap: float
    easy: float
    left: int
    unplaced: Array

    @classmethod
    def of(cls, outlook: Outlook) -> Making:
        """Nothing is placed."""
        state = PartialSchedule(outlook.layout)
        ready = [task for task, count in enumerate(state.waiting) if not count]
        cheap, easy = sum(outlook.cheap), sum(outlook.easiest)
        count = len(outlook.tasks)
        owned, unplaced = outlook.owned.sum(0), np.ones(count, np.float32)
        return cls(outlook, state, ready, 0, owned, cheap, easy, count, unplaced)

    def choices(self) -> Choices:
        """What may be placed next; nothing where a limit, a team or a machine's part stands in the
        way of all.
        """
        rows, starts, first, group = list[int](), list[int](), list[int](), list[int]()
        state, clock, table, count = self.state, self.clock, self.outlook.row_of, 0
        for task in self.ready:
            numbers, begin = table[task], len(rows)
            for step in state.steps(task):
                start = state.earliest(task, step)
                rows.append(numbers[step.way])
                starts.append(start if start > clock else clock)
                group.append(count)
            if len(rows) > begin:
                first.append(begin)
                count += 1
        found = Choices(*map(np.array, (rows, starts, first, group)))
        return found if len(rows) <= MOST else self._earliest(found)

    def _earliest(self, choices: Choices) -> Choices:
        rows, starts, _, group = choices
        ends = starts + self.outlook.steps.ticks[rows]
        kept = np.sort(np.lexsort((starts, ends))[:MOST])
        _, first, group = np.unique(group[kept], return_index=True, return_inverse=True)
        return Choices(rows[kept], starts[kept], first, group)

    def put(self, row: int, start: int) -> None:
        """Places a task by the step of this row."""
        outlook = self.outlook
        task, step = outlook.step_of[row]
        self.ready.remove(task)
        self.ready += self.state.put(task, step, start)
        self.clock = start
        self.owned = self.owned - outlook.owned[task]
        self.cheap -= outlook.cheap[task]
        self.easy -= outlook.easiest[task]
        self.left -= 1
        self.unplaced[task] = 0.0


def columns(values: Sequence[int]) -> tuple[int, ...]:
    """The features that say something of these values: beside the best choice, as shares, and of
    the best.
    """
    shares = [OF_CHOICE + at for at, value in enumerate(LENGTHS.tolist()) if value in values]
    return (*values, *shares, *(OF_CHOICE + OF_LENGTH + value for value in values))


class Sight(NamedTuple):
    """What can be seen of the choices, all in mean task times.

    Attributes:
      features: `[K, FEATURES]`, times also as shares of what is left at least, beside the best of
        the choices.
      makespan, worth: `[K]` what no schedule behind the choice comes below: makespan, and makespan
        plus what stress is worth, from this step on, above that of the easiest steps.
      about: `[K, O, ABOUT]` of each operator once the choice is placed: when it could begin
        something else, from now on, also as a share of what is left at least; its own work that is
        left; 1 where it takes part in the choice.
    """

    features: Array
    about: Array
    makespan: Array
    worth: Array


def sight(making: Making, choices: Choices) -> Sight:
    """What can be seen of the choices."""
    outlook, state = making.outlook, making.state
    steps, operators, rows = outlook.steps, len(outlook.operators), choices.rows
    count, first, group = len(rows), choices.first, choices.group
    ticks, chain, extra, base, tail = steps.table.take(rows, 1)
    who, owned, suits, share = steps.people.take(rows, 1)
    mine = who > 0
    clock = np.array([*state.free, *choices.starts.tolist()]) / outlook.scale
    free, start = clock[:operators], clock[operators:]
    end = start + ticks
    critical = end + chain
    now, latest, soonest = least(start), most(free), least(end)
    column, from_start = end[:, None], start[:, None]
    # when operators could begin something else once the choice is placed
    begin = np.where(mine, column, np.maximum(free, from_start))
    # bounds of makespan and stress once it is placed: by the price of the work that is left, by
    # each operator's own, by the chains of all tasks that are ready
    load = begin @ outlook.price + base + (making.cheap - making.easy)
    still = making.owned - owned
    own = most(begin + still, 1) + extra
    later = np.maximum(np.where(who @ who.T > 0, column, from_start), start) + tail
    later = np.minimum.reduceat(later, first, axis=1)
    later[np.arange(count), group] = critical
    alone = most(later, 1) + extra
    bound = np.maximum(np.maximum(load, own), np.maximum(alone, latest + extra))
    # how much of what is ready suits whom, and what is left of it for the others meanwhile
    rest = total(suits.take(first, 0), 0) - suits
    idle = np.where(mine, 0.0, rest - np.maximum(column - np.maximum(free, now), 0.0))
    waiting, behind = state.waiting, outlook.layout.instance.begun_behind
    tasks = making.ready if len(first) == len(making.ready) else steps.task[rows[first]]
    opened = [[waiting[after] for after in behind[task]].count(1) / operators for task in tasks]
    values = np.array(
        (
            start,
            start - most(who * free, 1),
            end,
            critical,
            end - np.minimum.reduceat(end, first).take(group),
            load,
            own,
            alone,
            bound,
            least(idle, 1),
            total(share * rest, 1),
            np.array(opened).take(group),
            chain,
            start > soonest - EXACT,
        )
    )
    lowest = least(values, 1)
    over = values - lowest[:, None]
    horizon = max(float(lowest[8] - now), 1.0)
    longest = most(over, 1)
    more = (
        latest - now,
        latest - least(free),
        longest[3],
        longest[12],
        4 / horizon,
        making.cheap / horizon,
        making.left / len(outlook.tasks),
        min(making.left, FEW) / FEW,
        len(first) / operators / 4,
        1 / operators,
    )
    found = np.empty((FEATURES, count), np.float32)
    found[:OF_CHOICE] = over
    found[OF_CHOICE : OF_CHOICE + OF_LENGTH] = over.take(LENGTHS, 0) * (5 / horizon)
    found[-OF_ALL:-MORE] = (lowest - now * MOMENTS)[:, None]
    found[-MORE:] = np.array(more)[:, None]
    np.minimum(found, MOST_RATIO, out=found)
    np.maximum(found, -MOST_RATIO, out=found)
    about = np.empty((count, operators, ABOUT), np.float32)
    about[..., 0] = begin - now
    about[..., 1] = about[..., 0] * (5 / horizon)
    about[..., 2] = still
    about[..., 3] = who
    np.minimum(about, MOST_RATIO, out=about)
    return Sight(found.T, about, np.maximum(np.maximum(own, alone) - extra, latest), bound)


least, most, total = np.minimum.reduce, np.maximum.reduce, np.add.reduce
