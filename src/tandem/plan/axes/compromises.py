"""Compromises between the makespan and several measures, looked for with many schedules at once.

A schedule is drawn as who does each task and in which order tasks are appended. What no other one
is as good as is kept; from these the next are drawn, with a few tasks given to others or moved in
the order. All of a round are worked out together (`arrays.py`), some 300,000 of 20 tasks a second.
Nothing here is proven, and what is found are proposals: whoever takes them works them out exactly
(`starts.append`) and asks the door.

Keeping what nothing beats and changing it at random: Paquete, Chiarandini and Stützle (2004),
Pareto local optimum sets, Lecture Notes in Economics and Mathematical Systems 535:177-199.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from tandem.plan.axes.arrays import Arrays, Bools, Floats, Ints
from tandem.plan.starts import Starts

DRAWN = 400
"""Schedules of a round."""
OTHERS = (0.75, 0.4, 0.15)
"""Chances that a first, second and third task is given to others."""
MOVED = (0.5, 0.3)
"""Chances that a first and second task is moved in the order; the same for two that change
places.
"""


class Kept(NamedTuple):
    """`N` schedules of `T` tasks that none of them beats.

    Attributes:
      ways: `[N, T]`, per task an index of its ways.
      keys: `[N, T]`, tasks are appended in their order.
      worth: `[N, 1 + M]`, ticks of the makespan and units of each measure.
    """

    ways: Ints
    keys: Floats
    worth: Ints

    def among(self, places: Bools) -> Kept:
        """Those that are true."""
        return Kept(self.ways[places], self.keys[places], self.worth[places])


class Compromises:
    """The search: what is kept so far."""

    def __init__(self, arrays: Arrays, seed: int) -> None:
        self.arrays, self.rng = arrays, np.random.default_rng(seed)
        self.tasks = len(arrays.each)
        self.choices = np.flatnonzero([len(row) > 1 for row in arrays.possible])
        self.kept = Kept(
            np.zeros((0, self.tasks), np.int64),
            np.zeros((0, self.tasks)),
            np.zeros((0, 1 + len(arrays.counted)), np.int64),
        )

    def begin(self, known: Iterable[Starts]) -> None:
        """Keeps the best of random schedules, and of those known."""
        ways = np.stack([self.rng.choice(row, DRAWN) for row in self.arrays.possible], axis=1)
        self.judge(ways, self.rng.random(ways.shape))
        self.know(known)

    def know(self, known: Iterable[Starts]) -> None:
        """Goes on from these schedules too."""
        rows = np.array(list(known), np.int64).reshape(-1, self.tasks, 2)
        if len(rows):
            self.judge(rows[:, :, 0], rows[:, :, 1].astype(float))

    def round(self) -> bool:
        """Draws anew from what is kept; whether that found anything."""
        count, rng = DRAWN, self.rng
        if not len(self.kept.worth) or not len(self.choices):
            return False
        parents = rng.integers(len(self.kept.worth), size=count)
        ways, keys = self.kept.ways[parents].copy(), self.kept.keys[parents].copy()
        lot = rng.random(count)
        for chance in OTHERS:
            mine = np.flatnonzero(lot < chance)
            for_task = self.choices[rng.integers(len(self.choices), size=len(mine))]
            share = rng.random(len(mine))
            for task in np.unique(for_task):
                here = for_task == task
                row = self.arrays.possible[task]
                ways[mine[here], task] = row[(share[here] * len(row)).astype(np.int64)]
        span = self.kept.worth[parents, 0]
        for chance in MOVED:
            mine = np.flatnonzero(rng.random(count) < chance)
            task = rng.integers(self.tasks, size=len(mine))
            keys[mine, task] = rng.random(len(mine)) * span[mine] - 1
            mine = np.flatnonzero(rng.random(count) < chance)
            one, other = rng.integers(self.tasks, size=(2, len(mine)))
            keys[mine, one], keys[mine, other] = keys[mine, other], keys[mine, one]
        # tasks that begin at once come in a random order
        return self.judge(ways, keys + rng.random(keys.shape) / 100)

    def judge(self, ways: Ints, keys: Floats) -> bool:
        """Keeps those that nothing kept is as good as; whether there were any."""
        arrays = self.arrays
        units = arrays.units(ways)
        chance = arrays.allowed(ways)
        # before the order is looked at, the busiest operator says how quick it can be at best
        ticks = arrays.ticks[arrays.each, ways]
        load = (arrays.busy[arrays.each, ways] * ticks[:, :, None]).sum(1)
        at_best = np.column_stack([load.max(1), units])
        chance &= ~_beaten(at_best, self.kept.worth)
        ways, keys, units = ways[chance], keys[chance], units[chance]
        if not len(ways):
            return False
        starts, makespan = arrays.played(ways, keys)
        drawn = Kept(ways, starts.astype(float), np.column_stack([makespan, units]))
        fresh = drawn.among(~_beaten(drawn.worth, self.kept.worth))
        if not len(fresh.worth):
            return False
        fresh = fresh.among(_first_of_least(fresh.worth))
        old = self.kept.among(~_beaten(self.kept.worth, fresh.worth))
        self.kept = Kept(*(np.concatenate(pair) for pair in zip(old, fresh, strict=True)))
        return True


def _beaten(points: Ints, by: Ints) -> Bools:
    """`[N]`: one of the others is as good in everything."""
    if not len(by):
        return np.zeros(len(points), bool)
    found = np.ones((len(points), len(by)), bool)
    for axis in range(points.shape[1]):
        found &= by[:, axis] <= points[:, axis, None]
    return np.asarray(found.any(1))


def _first_of_least(points: Ints) -> Bools:
    """`[N]`: no other one is as good in everything, but for equal ones behind it."""
    found = np.ones((len(points), len(points)), bool)
    for axis in range(points.shape[1]):
        found &= points[:, axis] <= points[:, axis, None]
    equal = found & found.T
    found &= ~np.triu(equal)
    return np.asarray(~found.any(1))
