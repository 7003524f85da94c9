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

from typing import Any, NamedTuple

import numpy as np
from numba import njit

from tandem.learn.graph.candidates import Making
from tandem.learn.graph.outlook import Outlook
from tandem.plan import insertion_moves
from tandem.plan.insertion import count_of_resources, knows, parts
from tandem.plan.insertion_moves import Parts

MOST_LEFT = 60
"""Tasks that may be left: a set of them is kept as bits."""
SLOTS, WIDE = 1 << 12, 4
"""Nodes that are remembered: so many sets of tasks, so many of each."""
EXACT = 1e-9
"""Ticks that make no difference."""

compiled: Any = njit(cache=True)
_from_compiled: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
inner: Any = njit(cache=True, **_from_compiled)
"""What is compiled: called from here, and from compiled code alone."""


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


def start_of(making: Making) -> Start:
    """Where the search begins: what the schedule in the making leaves free, and when."""
    state = making.state
    instance = state.instance
    free = np.zeros(count_of_resources(instance), np.int64)
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


class Search:
    """Exact ends of schedules of one cell."""

    def __init__(self, outlook: Outlook) -> None:
        """Assumes `can(outlook)`."""
        layout = outlook.layout
        self.outlook = outlook
        self.parts: Parts = parts(layout, insertion_moves)
        price = np.zeros(count_of_resources(layout.instance))
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

    def losses(
        self, making: Making, rows: np.ndarray, starts: np.ndarray, most: float, nodes: int
    ) -> np.ndarray | None:
        """`[K]` ticks that each choice loses against the best one; `inf` where it is more than
        `most`. None when that takes more than `nodes` nodes in all, or more than `MOST_LEFT`
        tasks are left.
        """
        start, found, left = start_of(making), np.full(len(rows), np.inf), nodes
        if start.left.sum() > MOST_LEFT:
            return None
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


class _Todo(NamedTuple):
    """Which tasks are left: `order` their numbers, `place` of each task among them; `gone` those
    that are placed by now; `task_of` each way.
    """

    order: np.ndarray
    place: np.ndarray
    gone: np.ndarray
    task_of: np.ndarray


class _Stack(NamedTuple):
    """The nodes from the first to the one in hand, a row each.

    Attributes:
      free, ready, waiting, clock: as in `Start`.
      work, easy: what the tasks not placed cost at least by prices, and in stress. paid: stress of
        those that are placed. Ticks.
      mask: bits of the tasks placed.
      kid, kid_start, kid_bound: what may be placed next, by bound; `kids` so many, `at` so many of
        them have been looked at.
    """

    free: np.ndarray
    ready: np.ndarray
    waiting: np.ndarray
    clock: np.ndarray
    work: np.ndarray
    easy: np.ndarray
    paid: np.ndarray
    mask: np.ndarray
    kid: np.ndarray
    kid_start: np.ndarray
    kid_bound: np.ndarray
    kids: np.ndarray
    at: np.ndarray


class _Memory(NamedTuple):
    """Nodes that were looked at: of each slot `WIDE`, the oldest leaves first."""

    mask: np.ndarray
    numbers: np.ndarray
    paid: np.ndarray
    turn: np.ndarray


@compiled
def _best(parts, bounds, begin, first, first_start, most, nodes):  # type: ignore[no-untyped-def]
    """Ticks that the rest of the makespan and the stress come to at best when way `first` starts at
    `first_start`, `most` or more where that is no less; and how many nodes were looked at.
    """
    todo = _todo(parts, begin)
    count, resources = len(todo.order), len(begin.free)
    stack = _stack(bounds, begin, todo, len(parts.ticks))
    stack.kid[0, 0], stack.kid_start[0, 0], stack.kids[0] = first, first_start, 1
    stack.kid_bound[0, 0] = -1.0
    memory = _memory(1 + resources + count)
    level, used, best = 0, 0, most
    while level >= 0:
        at = stack.at[level]
        # sorted by bound: what comes behind is no better
        if at == stack.kids[level] or stack.kid_bound[level, at] >= best - EXACT:
            level = _back(todo, stack, level)
            continue
        stack.at[level] += 1
        used += 1
        if used > nodes:
            return best, used
        task = _place(parts, bounds, todo, stack, level)
        below = level + 1
        if below == count:
            value = stack.free[below].max() + stack.paid[below]
            if value < best - EXACT:
                best = value
        elif not _was_seen(todo, stack, memory, below) and _branch(
            parts, bounds, todo, stack, below, best
        ):
            level = below
            continue
        todo.gone[task] = False
    return best, used


@inner
def _todo(parts, begin):  # type: ignore[no-untyped-def]
    tasks = len(begin.ready)
    task_of = np.empty(len(parts.ticks), np.int64)
    place, order, count = np.full(tasks, -1, np.int64), np.empty(tasks, np.int64), 0
    for task in range(tasks):
        task_of[parts.way_of[task] : parts.way_of[task + 1]] = task
        if begin.left[task]:
            place[task] = count
            order[count] = task
            count += 1
    return _Todo(order[:count], place, ~begin.left, task_of)


@inner
def _stack(bounds, begin, todo, ways):  # type: ignore[no-untyped-def]
    depth = len(todo.order) + 1
    stack = _Stack(
        np.zeros((depth, len(begin.free)), np.int64),
        np.zeros((depth, len(begin.ready)), np.int64),
        np.zeros((depth, len(begin.ready)), np.int64),
        np.zeros(depth, np.int64),
        np.zeros(depth),
        np.zeros(depth),
        np.zeros(depth),
        np.zeros(depth, np.int64),
        np.zeros((depth, ways), np.int64),
        np.zeros((depth, ways), np.int64),
        np.zeros((depth, ways)),
        np.zeros(depth, np.int64),
        np.zeros(depth, np.int64),
    )
    stack.free[0], stack.ready[0] = begin.free, begin.ready
    stack.waiting[0], stack.clock[0] = begin.waiting, begin.clock
    for task in todo.order:
        stack.work[0] += bounds.cheapest[task]
        stack.easy[0] += bounds.easiest[task]
    return stack


@inner
def _memory(numbers):  # type: ignore[no-untyped-def]
    return _Memory(
        np.full((SLOTS, WIDE), -1, np.int64),
        np.empty((SLOTS, WIDE, numbers), np.int64),
        np.empty((SLOTS, WIDE)),
        np.zeros(SLOTS, np.int64),
    )


@inner
def _back(todo, stack, level):  # type: ignore[no-untyped-def]
    """To the node that this one came from; its task is not placed any more."""
    level -= 1
    if level >= 0:
        todo.gone[todo.task_of[stack.kid[level, stack.at[level] - 1]]] = False
    return level


@inner
def _place(parts, bounds, todo, stack, level):  # type: ignore[no-untyped-def]
    """Places what the node looks at, into the row below; gives its task."""
    at, below = stack.at[level] - 1, level + 1
    way, start = stack.kid[level, at], stack.kid_start[level, at]
    task, end = todo.task_of[way], start + parts.ticks[way]
    stack.free[below] = stack.free[level]
    for index in range(parts.who_of[way], parts.who_of[way + 1]):
        stack.free[below, parts.who[index]] = end
    for other in todo.order:
        stack.ready[below, other] = stack.ready[level, other]
        stack.waiting[below, other] = stack.waiting[level, other]
    for index in range(parts.after_of[task], parts.after_of[task + 1]):
        after = parts.afters[index]
        moment = end + parts.wait_after[index]
        stack.ready[below, after] = max(stack.ready[below, after], moment)
        stack.waiting[below, after] -= 1
    stack.clock[below] = start
    stack.work[below] = stack.work[level] - bounds.cheapest[task]
    stack.easy[below] = stack.easy[level] - bounds.easiest[task]
    stack.paid[below] = stack.paid[level] + bounds.stress[way]
    stack.mask[below] = stack.mask[level] | (1 << todo.place[task])
    todo.gone[task] = True
    return task


@inner
def _was_seen(todo, stack, memory, level):  # type: ignore[no-untyped-def]
    """Whether a node with the same tasks was no later in any number; else this one is kept."""
    resources, clock, mask = stack.free.shape[1], stack.clock[level], stack.mask[level]
    vector = np.empty(1 + resources + len(todo.order), np.int64)
    vector[0] = clock
    for r in range(resources):
        vector[1 + r] = max(stack.free[level, r], clock)
    for index, task in enumerate(todo.order):
        ready = 0 if todo.gone[task] else max(stack.ready[level, task], clock)
        vector[1 + resources + index] = ready
    slot = (mask * 0x9E3779B97F4A7C1 >> 20) & (SLOTS - 1)
    for one in range(WIDE):
        same = memory.mask[slot, one] == mask
        cheaper = memory.paid[slot, one] <= stack.paid[level] + EXACT
        if same and cheaper and (memory.numbers[slot, one] <= vector).all():
            return True
    one = memory.turn[slot]
    memory.turn[slot] = (one + 1) % WIDE
    memory.mask[slot, one], memory.paid[slot, one] = mask, stack.paid[level]
    memory.numbers[slot, one] = vector
    return False


@inner
def _branch(parts, bounds, todo, stack, level, best):  # type: ignore[no-untyped-def]
    """What may come next, by bound; false when nothing that is better than `best` can."""
    many, soonest, floor = 0, 1 << 60, float(stack.free[level].max())
    for task in todo.order:
        if todo.gone[task] or stack.waiting[level, task] > 0:
            continue
        chain = 1e18
        for way in range(parts.way_of[task], parts.way_of[task + 1]):
            moment = _earliest(parts, stack, level, task, way)
            end = moment + parts.ticks[way]
            stack.kid[level, many], stack.kid_start[level, many] = way, moment
            many += 1
            chain = min(chain, end + bounds.chain[task])
            if bounds.stress[way] <= bounds.easiest[task] + EXACT:
                soonest = min(soonest, end)
        floor = max(floor, chain)
    if floor + stack.paid[level] + stack.easy[level] >= best - EXACT:
        return False
    kept = 0
    for number in range(many):
        way, moment = stack.kid[level, number], stack.kid_start[level, number]
        if moment < soonest:
            bound = _bound(parts, bounds, todo, stack, level, way, moment, floor)
            _sort_in(parts, stack, level, kept, way, moment, bound)
            kept += 1
    stack.kids[level], stack.at[level] = kept, 0
    return True


@inner
def _earliest(parts, stack, level, task, way):  # type: ignore[no-untyped-def]
    moment = max(stack.ready[level, task], stack.clock[level])
    for index in range(parts.who_of[way], parts.who_of[way + 1]):
        moment = max(moment, stack.free[level, parts.who[index]])
    return moment


@inner
def _bound(parts, bounds, todo, stack, level, way, moment, floor):  # type: ignore[no-untyped-def]
    """Ticks that no end is below when the way starts at this moment."""
    task, end, free = todo.task_of[way], moment + parts.ticks[way], stack.free[level]
    # work that is left takes operators' time at its price, none of it before they are free
    work = stack.work[level] - bounds.cheapest[task] + bounds.stress[way]
    for r in range(len(free)):
        work += bounds.price[r] * max(free[r], moment)
    for index in range(parts.who_of[way], parts.who_of[way + 1]):
        r = parts.who[index]
        work += bounds.price[r] * (end - max(free[r], moment))
    stress = bounds.stress[way] + stack.easy[level] - bounds.easiest[task]
    return stack.paid[level] + max(work, stress + max(floor, end + bounds.chain[task]))


@inner
def _sort_in(parts, stack, level, kept, way, moment, bound):  # type: ignore[no-untyped-def]
    """Among the first `kept`, by bound and then by end."""
    kid, start, bounds = stack.kid[level], stack.kid_start[level], stack.kid_bound[level]
    end, spot = moment + parts.ticks[way], kept
    while spot > 0:
        above = bounds[spot - 1] - bound
        later = start[spot - 1] + parts.ticks[kid[spot - 1]] > end
        if not (above > EXACT or (above > -EXACT and later)):
            break
        kid[spot], start[spot], bounds[spot] = kid[spot - 1], start[spot - 1], bounds[spot - 1]
        spot -= 1
    kid[spot], start[spot], bounds[spot] = way, moment, bound
