"""What a schedule in the making can still come to at best: an exact search along the clock,
compiled, for the last dozen tasks or so of a cell. It says of every choice how much it loses, which
is what the policy learns from.

Branches are those of `plan.chronological`: the next task starts as early as it can, but not before
the one placed last, and none starts when another one could already have ended that costs nothing to
take first. A node is left when the bounds of `prices`, or of the longest chain, show that it ends
no better than what is known, or when another one with the same tasks was no later in any number.

This file imports Numba, so it is itself imported only where the policy is trained.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from tandem.learn.graph.candidates import Making
from tandem.learn.graph.outlook import Outlook
from tandem.plan import insertion_moves
from tandem.plan.insertion import knows, parts
from tandem.plan.insertion_moves import Parts

MOST_LEFT = 60
"""Tasks that may be left: a set of them is kept as bits."""
SLOTS, WIDE = 1 << 12, 4
"""Nodes that are remembered: so many sets of tasks, so many of each."""


class Bounds(NamedTuple):
    """What bounds need: `price` per resource, `cheapest` work and `easiest` stress per task in
    ticks, `chain` behind its end, `stress` per way in ticks.
    """

    price: np.ndarray
    cheapest: np.ndarray
    easiest: np.ndarray
    chain: np.ndarray
    stress: np.ndarray


class Start(NamedTuple):
    """A schedule in the making: `free` per resource, `ready`, `waiting` and `left` per task."""

    free: np.ndarray
    ready: np.ndarray
    waiting: np.ndarray
    left: np.ndarray
    clock: int


class Search:
    """Exact ends of schedules of one cell."""

    def __init__(self, outlook: Outlook) -> None:
        """Assumes `can(outlook)`."""
        layout = outlook.layout
        self.outlook = outlook
        self.parts: Parts = parts(layout, insertion_moves)
        price = np.zeros(len(self.parts.limit))
        price[: len(outlook.price)] = outlook.price
        self.bounds = Bounds(
            price,
            np.array(outlook.cheapest, float),
            outlook.exchange * np.array(layout.easiest, float),
            np.array(layout.behind, float),
            outlook.exchange * np.array(self.parts.stress, float),
        )

    @staticmethod
    def can(outlook: Outlook) -> bool:
        """Whether the search holds every rule of the cell."""
        instance = outlook.layout.instance
        return knows(instance) and not instance.has_limits and max(instance.team, default=-1) < 0

    def losses(self, making: Making, rows: np.ndarray, starts: np.ndarray, most: float,
               nodes: int) -> np.ndarray | None:
        """`[K]` ticks that each choice loses against the best one; `inf` where it is more than
        `most`. None when that takes more than `nodes` nodes in all.
        """
        start, found, left = self._start(making), np.full(len(rows), np.inf), nodes
        best = np.inf
        order = np.argsort(starts + self.parts.ticks[rows], kind="stable")
        for at in order:
            value, used = _best(
                self.parts, self.bounds, start, int(rows[at]), int(starts[at]), best + most, left
            )
            left -= used
            if left <= 0:
                return None
            found[at] = value
            best = min(best, value)
        found -= best
        found[found > most] = np.inf
        return found

    def _start(self, making: Making) -> Start:
        state = making.state
        instance = state.instance
        free = np.zeros(len(self.parts.limit), np.int64)
        operators = len(state.free)
        free[:operators] = state.free
        for zone, places in enumerate(state.zone_free):
            if len(places) == 1:
                free[operators + zone] = places[0]
        for tool, places in enumerate(state.tool_free):
            if len(places) == 1:
                free[operators + len(instance.zones) + tool] = places[0]
        left = np.array([one < 0 for one in state.start], np.bool_)
        return Start(
            free,
            np.array(state.ready, np.int64),
            np.array(state.waiting, np.int64),
            left,
            making.clock,
        )


@njit(cache=True)
def _best(parts, bounds, begin, first, first_start, most, nodes):  # type: ignore[no-untyped-def]
    """Ticks that the rest of the makespan and the stress come to at best when way `first` starts at
    `first_start`, `most` or more where that is no less; and how many nodes were looked at.
    """
    tasks, resources, ways = len(begin.ready), len(begin.free), len(parts.ticks)
    task_of = np.empty(ways, np.int64)
    for task in range(tasks):
        for way in range(parts.way_of[task], parts.way_of[task + 1]):
            task_of[way] = task
    place = np.full(tasks, -1, np.int64)
    todo = np.empty(tasks, np.int64)
    count = 0
    work = easy = 0.0
    for task in range(tasks):
        if begin.left[task]:
            place[task] = count
            todo[count] = task
            count += 1
            work += bounds.cheapest[task]
            easy += bounds.easiest[task]
    prices = bounds.price.sum()
    depth = count + 1
    free = np.zeros((depth, resources), np.int64)
    ready = np.zeros((depth, tasks), np.int64)
    waiting = np.zeros((depth, tasks), np.int64)
    clock = np.zeros(depth, np.int64)
    work_left, easy_left, paid = np.zeros(depth), np.zeros(depth), np.zeros(depth)
    mask = np.zeros(depth, np.int64)
    kid = np.zeros((depth, ways), np.int64)
    kid_start = np.zeros((depth, ways), np.int64)
    kid_bound = np.zeros((depth, ways))
    kids, at = np.zeros(depth, np.int64), np.zeros(depth, np.int64)
    gone = ~begin.left
    # what is remembered
    wide = 1 + resources + count
    seen_mask = np.full((SLOTS, WIDE), -1, np.int64)
    seen = np.empty((SLOTS, WIDE, wide), np.int64)
    seen_paid = np.empty((SLOTS, WIDE))
    seen_next = np.zeros(SLOTS, np.int64)
    vector = np.zeros(wide, np.int64)

    free[0], ready[0], waiting[0], clock[0] = begin.free, begin.ready, begin.waiting, begin.clock
    work_left[0], easy_left[0] = work, easy
    kid[0, 0], kid_start[0, 0], kids[0], at[0] = first, first_start, 1, 0
    kid_bound[0, 0] = -1.0
    level, used, best = 0, 0, most
    while level >= 0:
        if at[level] == kids[level]:
            # back to where this node came from
            level -= 1
            if level >= 0:
                gone[task_of[kid[level, at[level] - 1]]] = False
            continue
        way, start = kid[level, at[level]], kid_start[level, at[level]]
        bound = kid_bound[level, at[level]]
        at[level] += 1
        if bound >= best - 1e-9:
            at[level] = kids[level]  # sorted: the others are no better
            if level == 0:
                break
            # the last taken was not entered
            level -= 1
            gone[task_of[kid[level, at[level] - 1]]] = False
            continue
        used += 1
        if used > nodes:
            return best, used
        task, below = task_of[way], level + 1
        end = start + parts.ticks[way]
        for r in range(resources):
            free[below, r] = free[level, r]
        for index in range(parts.who_of[way], parts.who_of[way + 1]):
            free[below, parts.who[index]] = end
        for index in range(count):
            other = todo[index]
            ready[below, other] = ready[level, other]
            waiting[below, other] = waiting[level, other]
        for index in range(parts.after_of[task], parts.after_of[task + 1]):
            after = parts.afters[index]
            moment = end + parts.wait_after[index]
            if moment > ready[below, after]:
                ready[below, after] = moment
            waiting[below, after] -= 1
        clock[below] = start
        work_left[below] = work_left[level] - bounds.cheapest[task]
        easy_left[below] = easy_left[level] - bounds.easiest[task]
        paid[below] = paid[level] + bounds.stress[way]
        mask[below] = mask[level] | (1 << place[task])
        gone[task] = True
        if below == count:
            last = 0
            for r in range(resources):
                last = max(last, free[below, r])
            value = last + paid[below]
            if value < best - 1e-9:
                best = value
            gone[task] = False
            continue
        # looked at before, and no later in any number?
        vector[0] = start
        for r in range(resources):
            vector[1 + r] = max(free[below, r], start)
        for index in range(count):
            other = todo[index]
            vector[1 + resources + index] = 0 if gone[other] else max(ready[below, other], start)
        slot = (mask[below] * 0x9E3779B97F4A7C1 >> 20) & (SLOTS - 1)
        beaten = False
        for one in range(WIDE):
            if seen_mask[slot, one] == mask[below] and seen_paid[slot, one] <= paid[below] + 1e-9:
                no_later = True
                for index in range(wide):
                    if seen[slot, one, index] > vector[index]:
                        no_later = False
                        break
                if no_later:
                    beaten = True
                    break
        if beaten:
            gone[task] = False
            continue
        one = seen_next[slot]
        seen_next[slot] = (one + 1) % WIDE
        seen_mask[slot, one] = mask[below]
        seen_paid[slot, one] = paid[below]
        for index in range(wide):
            seen[slot, one, index] = vector[index]
        # what may come next
        many, soonest = 0, 1 << 60
        floor = 0.0
        for r in range(resources):
            floor = max(floor, free[below, r])
        for index in range(count):
            other = todo[index]
            if gone[other] or waiting[below, other] > 0:
                continue
            chain = 1e18
            for option in range(parts.way_of[other], parts.way_of[other + 1]):
                moment = max(ready[below, other], start)
                for who in range(parts.who_of[option], parts.who_of[option + 1]):
                    moment = max(moment, free[below, parts.who[who]])
                ends = moment + parts.ticks[option]
                kid[below, many], kid_start[below, many] = option, moment
                many += 1
                chain = min(chain, ends + bounds.chain[other])
                if bounds.stress[option] <= bounds.easiest[other] + 1e-9 and ends < soonest:
                    soonest = ends
            floor = max(floor, chain)
        if floor + paid[below] + easy_left[below] >= best - 1e-9:
            gone[task] = False
            continue
        kept = 0
        for number in range(many):
            option, moment = kid[below, number], kid_start[below, number]
            if moment >= soonest:
                continue
            other = task_of[option]
            ends = moment + parts.ticks[option]
            # work that is left takes operators' time at its price, none of it before they are free
            total = work_left[below] - bounds.cheapest[other] + bounds.stress[option]
            for r in range(resources):
                total += bounds.price[r] * max(free[below, r], moment)
            for who in range(parts.who_of[option], parts.who_of[option + 1]):
                r = parts.who[who]
                total += bounds.price[r] * (ends - max(free[below, r], moment))
            value = max(
                paid[below] + total / prices,
                paid[below]
                + bounds.stress[option]
                + easy_left[below]
                - bounds.easiest[other]
                + max(floor, ends + bounds.chain[other]),
            )
            # sorted by bound, then by end
            spot = kept
            while spot > 0 and (
                kid_bound[below, spot - 1] > value + 1e-9
                or (
                    kid_bound[below, spot - 1] > value - 1e-9
                    and kid_start[below, spot - 1] + parts.ticks[kid[below, spot - 1]] > ends
                )
            ):
                kid[below, spot] = kid[below, spot - 1]
                kid_start[below, spot] = kid_start[below, spot - 1]
                kid_bound[below, spot] = kid_bound[below, spot - 1]
                spot -= 1
            kid[below, spot], kid_start[below, spot], kid_bound[below, spot] = option, moment, value
            kept += 1
        kids[below], at[below] = kept, 0
        level = below
    return best, used
