"""Iterated greedy search by insertion, compiled: tasks are taken out of a schedule and put back,
one by one, where the longest path through them is shortest.

A schedule is an order of the tasks and a way for each. Of every task the head (its start) and the
tail (from its start to the end of all) are known. With a task taken out, the longest path through
it at any place of the order, in any way, follows from the heads before the place and the tails
behind it: `head + ticks + tail`, exactly. So all places and ways of a task are looked at in one
walk along the order.

Sources: Ruiz and Stützle (2007), European Journal of Operational Research 177(3), section 2, for
iterated greedy search and its acceptance at a constant temperature; Mastrolilli and Gambardella
(2000), Journal of Scheduling 3(1), for insertion by heads and tails where tasks have several
ways. That places are those of an order of all tasks, so that joint tasks and any precedence fit, is
ours.

This file imports Numba, so it is itself imported only when a cell is large enough to need it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numba import njit

INFINITE = 1 << 60
"""Ticks or units that nothing comes near."""


def _entry(function: Callable[..., Any], **options: bool) -> Any:
    """The function compiled, and kept for the next process where there is room for it."""
    try:
        return njit(cache=True, nogil=True, **options)(function)  # type: ignore[call-overload]
    except RuntimeError:  # neither the package's folder nor the user's cache can be written
        return njit(nogil=True, **options)(function)  # type: ignore[call-overload]


def _inner(function: Callable[..., Any]) -> Any:
    """The same for what is called from compiled code alone."""
    return _entry(function, no_cpython_wrapper=True, no_cfunc_wrapper=True)


class Parts(NamedTuple):
    """A cell's numbers as arrays: `T` tasks, `W` ways of all tasks, `R` resources, of which each
    does one thing at a time.

    Attributes:
      first_of, firsts, wait_of: predecessors of task `t` are `firsts[first_of[t]:first_of[t + 1]]`,
        `wait_of` the ticks that must pass after each. `[T + 1]`, `[A]`, `[A]` int64.
      after_of, afters, wait_after: successors, likewise.
      release: `[T]` int64, ticks.
      way_of: ways of task `t` are `way_of[t]` to `way_of[t + 1] - 1`. `[T + 1]` int64.
      ticks, stress: `[W]` int64.
      who_of, who: resources of way `w` are `who[who_of[w]:who_of[w + 1]]`.
      due_of, owed, due: of allowance `owed[j]` way `w` takes `due[j]`, `j` from `due_of[w]` to
        `due_of[w + 1] - 1`.
      team: `[W]` int64, alike for ways with the same operators. stays: `[T]` bool, the task may not
        change its operators.
      most: `[A]` int64, what may be taken of each allowance. limited: there are some.
    """

    first_of: np.ndarray
    firsts: np.ndarray
    wait_of: np.ndarray
    after_of: np.ndarray
    afters: np.ndarray
    wait_after: np.ndarray
    release: np.ndarray
    way_of: np.ndarray
    ticks: np.ndarray
    stress: np.ndarray
    who_of: np.ndarray
    who: np.ndarray
    due_of: np.ndarray
    owed: np.ndarray
    due: np.ndarray
    team: np.ndarray
    stays: np.ndarray
    most: np.ndarray
    limited: bool


class Plan(NamedTuple):
    """An order of tasks that may leave some out, with what follows from it.

    Attributes:
      order: `[T]` int64, of which the first `count` count. way: `[T]` int64, index among all ways.
      head, tail: `[T]` int64, ticks; -1 for a task that is left out.
    """

    order: np.ndarray
    way: np.ndarray
    head: np.ndarray
    tail: np.ndarray


class Walk(NamedTuple):
    """A search under way.

    Attributes:
      now, trial: plans. best_order, best_way: of the best plan so far.
      worth: `[4]` int64: value of `now`, value of the best, makespan and stress of `now`.
      draws: `[1]` uint64, the state of the random numbers.
      place, out, is_out, may, free, behind, carried: scratch.
    """

    now: Plan
    trial: Plan
    best_order: np.ndarray
    best_way: np.ndarray
    worth: np.ndarray
    draws: np.ndarray
    place: np.ndarray
    out: np.ndarray
    is_out: np.ndarray
    may: np.ndarray
    free: np.ndarray
    behind: np.ndarray
    carried: np.ndarray


class Aim(NamedTuple):
    """The least `time * makespan + stress * stress` within limits; `warmth` is the loss that is
    accepted with probability 1/e, `most_out` how many tasks are taken out at once at most.
    """

    time: int
    stress: int
    most_ticks: int
    most_units: int
    warmth: float
    most_out: int


@_inner
def draw(draws: np.ndarray) -> float:
    """A random number from 0 up to 1 (Marsaglia 2003, Journal of Statistical Software 8(14))."""
    x = draws[0]
    x ^= x << np.uint64(13)
    x ^= x >> np.uint64(7)
    x ^= x << np.uint64(17)
    draws[0] = x
    return float(x >> np.uint64(11)) / 9007199254740992.0


@_inner
def _set_free(parts: Parts, plan: Plan, place: int, free: np.ndarray) -> None:
    """Per resource, when it is free of what comes before the place in the order."""
    unknown = free.shape[0]
    for resource in range(free.shape[0]):
        free[resource] = -1
    for i in range(place - 1, -1, -1):
        way = plan.way[plan.order[i]]
        end = plan.head[plan.order[i]] + parts.ticks[way]
        for j in range(parts.who_of[way], parts.who_of[way + 1]):
            if free[parts.who[j]] < 0:
                free[parts.who[j]] = end
                unknown -= 1
        if not unknown:
            return
    for resource in range(free.shape[0]):
        free[resource] = max(free[resource], 0)


@_inner
def _set_behind(parts: Parts, plan: Plan, place: int, count: int, behind: np.ndarray) -> None:
    """Per resource, the tail of its first task at the place in the order or behind it."""
    unknown = behind.shape[0]
    for resource in range(behind.shape[0]):
        behind[resource] = -1
    for i in range(place, count):
        task = plan.order[i]
        way = plan.way[task]
        for j in range(parts.who_of[way], parts.who_of[way + 1]):
            if behind[parts.who[j]] < 0:
                behind[parts.who[j]] = plan.tail[task]
                unknown -= 1
        if not unknown:
            return
    for resource in range(behind.shape[0]):
        behind[resource] = max(behind[resource], 0)


@_inner
def set_heads(parts: Parts, plan: Plan, begin: int, count: int, free: np.ndarray) -> int:
    """Every task appended in the plan's order: its head. Those before the place `begin` have theirs
    already. Gives the makespan.
    """
    _set_free(parts, plan, begin, free)
    for i in range(begin, count):
        task = plan.order[i]
        way = plan.way[task]
        start = parts.release[task]
        for j in range(parts.first_of[task], parts.first_of[task + 1]):
            first = parts.firsts[j]
            if plan.head[first] >= 0:
                end = plan.head[first] + parts.ticks[plan.way[first]] + parts.wait_of[j]
                start = max(start, end)
        for j in range(parts.who_of[way], parts.who_of[way + 1]):
            start = max(start, free[parts.who[j]])
        plan.head[task] = start
        end = start + parts.ticks[way]
        for j in range(parts.who_of[way], parts.who_of[way + 1]):
            free[parts.who[j]] = end
    makespan = 0  # every task has a resource, so the last of some resource ends last
    for resource in range(free.shape[0]):
        makespan = max(makespan, free[resource])
    return makespan


@_inner
def set_tails(parts: Parts, plan: Plan, end: int, count: int, free: np.ndarray) -> None:
    """Of every task the longest path from its start to the end of all. Those from the place `end`
    on have theirs already.
    """
    _set_behind(parts, plan, end, count, free)
    for i in range(end - 1, -1, -1):
        task = plan.order[i]
        way = plan.way[task]
        longest = 0
        for j in range(parts.after_of[task], parts.after_of[task + 1]):
            after = parts.afters[j]
            if plan.tail[after] >= 0:
                longest = max(longest, plan.tail[after] + parts.wait_after[j])
        for j in range(parts.who_of[way], parts.who_of[way + 1]):
            longest = max(longest, free[parts.who[j]])
        longest += parts.ticks[way]
        plan.tail[task] = longest
        for j in range(parts.who_of[way], parts.who_of[way + 1]):
            free[parts.who[j]] = longest


@_inner
def _sort(order: np.ndarray, key: np.ndarray, sign: int) -> None:
    """Sorts an order that is nearly sorted already."""
    for i in range(1, order.shape[0]):
        task = order[i]
        value = sign * key[task]
        j = i - 1
        while j >= 0 and sign * key[order[j]] > value:
            order[j + 1] = order[j]
            j -= 1
        order[j + 1] = task


@_inner
def _take_out(walk: Walk, most: int) -> tuple[int, int, int]:
    """Chooses a task on a longest path and some near it, writes them into `out` and leaves them
    out of the trial plan. Says how many, and of how many tasks in front the heads, in the rear the
    tails stay as they are.
    """
    now, trial, tasks = walk.now, walk.trial, walk.now.order.shape[0]
    wanted = min(tasks, 1 + int(draw(walk.draws) * most))
    centre = int(draw(walk.draws) * tasks)
    for _ in range(20):
        task = now.order[centre]
        if now.head[task] + now.tail[task] == walk.worth[2]:
            break
        centre = int(draw(walk.draws) * tasks)
    walk.out[0] = now.order[centre]
    walk.is_out[now.order[centre]] = True
    count = 1
    reach = 4 * wanted + 4
    for _ in range(8 * wanted):
        i = centre + int((2 * draw(walk.draws) - 1) * reach)
        if count < wanted and 0 <= i < tasks and not walk.is_out[now.order[i]]:
            walk.out[count] = now.order[i]
            walk.is_out[now.order[i]] = True
            count += 1
    kept, front, rear = 0, tasks, 0
    for i in range(tasks):
        task = now.order[i]
        trial.way[task] = now.way[task]
        if walk.is_out[task]:
            trial.head[task] = trial.tail[task] = -1
            front = min(front, kept)
            rear = tasks - 1 - i
        else:
            trial.head[task], trial.tail[task] = now.head[task], now.tail[task]
            trial.order[kept] = task
            kept += 1
    return count, front, rear


@_inner
def _before(parts: Parts, walk: Walk, task: int) -> tuple[int, int]:
    """The first place in the order that is behind all that the task waits for, and when that has
    ended. What is left out itself stands for what it waits for.
    """
    plan, place, ready = walk.trial, 0, parts.release[task]
    for j in range(parts.first_of[task], parts.first_of[task + 1]):
        first = parts.firsts[j]
        if walk.is_out[first]:
            its_place, end = _before(parts, walk, first)
            end += 1
        else:
            its_place, end = walk.place[first] + 1, plan.head[first]
            end += parts.ticks[plan.way[first]]
        place, ready = max(place, its_place), max(ready, end + parts.wait_of[j])
    return place, ready


@_inner
def _behind(parts: Parts, walk: Walk, task: int, count: int) -> tuple[int, int]:
    """The last place in the order that is before all that waits for the task, and the longest path
    from its end on.
    """
    plan, place, longest = walk.trial, count, 0
    for j in range(parts.after_of[task], parts.after_of[task + 1]):
        after = parts.afters[j]
        if walk.is_out[after]:
            its_place, tail = _behind(parts, walk, after, count)
            tail += 1
        else:
            its_place, tail = walk.place[after], plan.tail[after]
        place, longest = min(place, its_place), max(longest, tail + parts.wait_after[j])
    return place, longest


@_inner
def _set_free_and_behind(parts: Parts, walk: Walk, first: int, last: int, count: int) -> None:
    """Per resource, when it is free before the place `first` (`free`), and the tail of its next
    task at each place from there to `last` (`behind`).
    """
    plan = walk.trial
    _set_free(parts, plan, first, walk.free)
    _set_behind(parts, plan, last, count, walk.behind[last])
    for i in range(last - 1, first - 1, -1):
        task = plan.order[i]
        way = plan.way[task]
        for resource in range(walk.free.shape[0]):
            walk.behind[i, resource] = walk.behind[i + 1, resource]
        for j in range(parts.who_of[way], parts.who_of[way + 1]):
            walk.behind[i, parts.who[j]] = plan.tail[task]


@_inner
def _pass_by(parts: Parts, walk: Walk, task: int) -> None:
    """The resources of the task are free when it ends."""
    way = walk.trial.way[task]
    end = walk.trial.head[task] + parts.ticks[way]
    for j in range(parts.who_of[way], parts.who_of[way + 1]):
        walk.free[parts.who[j]] = end


@_inner
def _may(parts: Parts, walk: Walk, task: int, way: int) -> bool:
    """Whether limits of people and `same_operator` let the task be done in this way."""
    if parts.stays[task] and parts.team[way] != parts.team[walk.now.way[task]]:
        return False
    if not parts.limited:
        return True
    for j in range(parts.due_of[way], parts.due_of[way + 1]):
        if walk.carried[parts.owed[j]] + parts.due[j] > parts.most[parts.owed[j]]:
            return False
    return True


@_inner
def _best_place(
    parts: Parts, walk: Walk, aim: Aim, task: int, count: int, without: int, units: int
) -> tuple[int, int, int]:
    """Where and in which way the task is best put back, and the makespan then; a place of -1 when
    limits leave none. Of equal ones one by lot.

    `without` is the makespan of the plan without the task, `units` its stress.
    """
    first, ready = _before(parts, walk, task)
    last, rest = _behind(parts, walk, task, count)
    _set_free_and_behind(parts, walk, first, last, count)
    least, shortest = 4 * INFINITE, 4 * INFINITE
    place, chosen, ties = -1, -1, 0
    for way in range(parts.way_of[task], parts.way_of[task + 1]):
        # limits do not depend on the place
        fits = units + parts.stress[way] <= aim.most_units
        walk.may[way] = fits and _may(parts, walk, task, way)
    for i in range(first, last + 1):
        for way in range(parts.way_of[task], parts.way_of[task + 1]):
            if not walk.may[way]:
                continue
            start, tail = ready, rest
            for j in range(parts.who_of[way], parts.who_of[way + 1]):
                start = max(start, walk.free[parts.who[j]])
                tail = max(tail, walk.behind[i, parts.who[j]])
            through = start + parts.ticks[way] + tail
            makespan = max(without, through)
            if makespan > aim.most_ticks:
                continue
            value = aim.time * makespan + aim.stress * (units + parts.stress[way])
            if value < least or (value == least and through < shortest):
                least, shortest, place, chosen, ties = value, through, i, way, 1
            elif value == least and through == shortest:
                ties += 1
                if draw(walk.draws) * ties < 1.0:
                    place, chosen = i, way
        if i < last:
            _pass_by(parts, walk, walk.trial.order[i])
    return place, chosen, max(without, shortest)


@_inner
def _carry(parts: Parts, walk: Walk, way: int, sign: int) -> None:
    """Counts what a way takes of allowances in, or out."""
    for j in range(parts.due_of[way], parts.due_of[way + 1]):
        walk.carried[parts.owed[j]] += sign * parts.due[j]


@_inner
def _put_back(
    parts: Parts, walk: Walk, aim: Aim, out: int, front: int, rear: int
) -> tuple[bool, int, int]:
    """Puts the tasks in `out` back, in random order; says whether limits let them all be, and the
    makespan and stress then.
    """
    trial, tasks = walk.trial, walk.now.order.shape[0]
    count, units, makespan, sound = tasks - out, walk.worth[3], 0, True
    for i in range(out):
        units -= parts.stress[trial.way[walk.out[i]]]
        _carry(parts, walk, trial.way[walk.out[i]], -1)
    for x in range(out):
        y = x + int(draw(walk.draws) * (out - x))
        task = walk.out[y]
        walk.out[y], walk.out[x] = walk.out[x], task
        if sound:
            without = set_heads(parts, trial, front, count, walk.free)
            set_tails(parts, trial, count - rear, count, walk.free)
            for i in range(count):
                walk.place[trial.order[i]] = i
            place, way, makespan = _best_place(parts, walk, aim, task, count, without, units)
            sound = place >= 0
        if sound:
            for i in range(count, place, -1):
                trial.order[i] = trial.order[i - 1]
            trial.order[place] = task
            trial.way[task] = way
            front, rear = min(front, place), min(rear, count - place)
            count += 1
            units += parts.stress[way]
            _carry(parts, walk, way, 1)
        walk.is_out[task] = False
    return sound, makespan, units


@_entry
def take(parts: Parts, walk: Walk, source: Plan, units: int, sort: int) -> None:
    """Makes an order and its ways the present plan. Sorted by heads for a `sort` of 1, by tails for
    -1, and not for 0: each order offers other places.
    """
    now = walk.now
    for i in range(now.order.shape[0]):
        now.order[i] = source.order[i]
        now.way[i] = source.way[i]
    walk.worth[2] = set_heads(parts, now, 0, now.order.shape[0], walk.free)
    set_tails(parts, now, now.order.shape[0], now.order.shape[0], walk.free)
    walk.worth[3] = units
    if sort > 0:
        _sort(now.order, now.head, 1)
    elif sort < 0:
        _sort(now.order, now.tail, -1)


@_entry
def recount(parts: Parts, walk: Walk) -> None:
    """The stress on every resource in the present plan."""
    for allowance in range(walk.carried.shape[0]):
        walk.carried[allowance] = 0
    for task in range(walk.now.way.shape[0]):
        _carry(parts, walk, walk.now.way[task], 1)


@_entry
def rounds(parts: Parts, walk: Walk, aim: Aim, visits: int) -> int:
    """Takes tasks out and puts them back until so many tasks have been passed by; says how many.

    A plan that is worse by `d` is kept with probability `exp(-d / warmth)`.
    """
    spent, tasks = 0, walk.now.order.shape[0]
    while spent < visits:
        out, front, rear = _take_out(walk, aim.most_out)
        sound, makespan, units = _put_back(parts, walk, aim, out, front, rear)
        spent += (out + 1) * tasks
        value = aim.time * makespan + aim.stress * units
        loss = value - walk.worth[0]
        if not sound or (loss > 0 and draw(walk.draws) >= np.exp(-loss / aim.warmth)):
            if parts.limited:
                recount(parts, walk)
            continue
        take(parts, walk, walk.trial, units, 1 if draw(walk.draws) < 0.5 else -1)
        walk.worth[0] = aim.time * walk.worth[2] + aim.stress * units
        if walk.worth[0] < walk.worth[1]:
            walk.worth[1] = walk.worth[0]
            for i in range(tasks):
                walk.best_order[i] = walk.now.order[i]
                walk.best_way[i] = walk.now.way[i]
    return spent


def can_be_kept() -> bool:
    """Whether there is a place for compiled code."""
    return rounds.stats.cache_path is not None


def is_kept() -> bool:
    """Whether an earlier process has left what it compiled of this very file."""
    if not can_be_kept():
        return False
    since = Path(__file__).stat().st_mtime
    return any(index.stat().st_mtime >= since for index in _indices())


def _indices() -> Iterator[Path]:
    """The files that name what was kept of `rounds`."""
    return Path(rounds.stats.cache_path).glob("insertion_moves.rounds-*.nbi")


def _say_kept() -> None:
    """What was kept of the very text of this file counts, though the file may be newer: a checkout
    makes it so. Else every process would have it compiled again.
    """
    if can_be_kept() and rounds.stats.cache_hits and not is_kept():
        for index in _indices():
            with suppress(OSError):
                index.touch()


def warm() -> None:
    """Compiles everything, or loads what was compiled before: a search of one task."""
    some, none = np.array([0, 1], np.int64), np.zeros(0, np.int64)
    one = np.zeros(1, np.int64)

    def plan() -> Plan:
        return Plan(*(np.zeros(1, np.int64) for _ in range(4)))

    flat = np.zeros(2, np.int64)
    parts = Parts(
        flat, none, none, flat, none, none, one, some, one + 1, one, some, one, flat, none, none,
        one, np.zeros(1, np.bool_), none, False,
    )  # fmt: skip
    walk = Walk(
        plan(), plan(), one.copy(), one.copy(), np.zeros(4, np.int64), np.ones(1, np.uint64),
        one.copy(), one.copy(), np.zeros(1, np.bool_), np.zeros(1, np.bool_), one.copy(),
        np.zeros((2, 1), np.int64), one.copy(),
    )  # fmt: skip
    take(parts, walk, walk.now, 0, 0)
    recount(parts, walk)
    rounds(parts, walk, Aim(1, 0, INFINITE, INFINITE, 1.0, 1), 1)
    _say_kept()
