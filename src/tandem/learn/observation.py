"""What a network that knows no sizes sees of an assembly: a row of numbers for each move, and a row
for the whole.

Everything is a ratio (to the mean time of a task, or to the least time that is still to come), and
operators are "mine" and "the others'", so that the same network reads cells of any size and with
any number of operators. What lies behind a task never begins before it, so the sums over what is
behind a task that can begin now do not change during a game: they are made once, in NumPy.

Axes: `T` tasks, `W` ways to do them, `O` operators, `K` moves.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tandem.world.arrays import namespace

Array = Any

MOVE_FEATURES, WHOLE_FEATURES = 22, 14


class Observation(NamedTuple):
    """What a network that knows no sizes is shown. `K` moves, `F` and `G` features.

    moves: `[K, F]` float32, a row for each move. there: `[K]` bool, the rows that mean something
    now
      (also what only others may do). whole: `[G]` float32, of the state.
    """

    moves: Array
    there: Array
    whole: Array


class Ahead(NamedTuple):
    """What is known of an assembly before it begins. Times in units (mean least time of a task),
    stress in units of its weight in the cost.

    uses: `[W, O]` float32, 1 where the way occupies the operator. time, stress: `[W]`. task: `[W]`
    int32. needs: `[T, T]` float32, 1 where task i cannot start before task j has ended. least,
    least_stress: `[T]`, of the task's quickest and of its easiest way. tail: `[T]`, the longest
    chain from the task's start to the end. only: `[T, O]`, the task's least time where every way of
    doing it occupies the operator, else 0. open: `[T]`, what of it is nobody's. behind_only,
    behind_open: `[T, O]`, `[T]`, the sums of these over all tasks that need the task. human: `[O]`
    float32.
    """

    task: Array
    uses: Array
    time: Array
    stress: Array
    needs: Array
    least: Array
    least_stress: Array
    tail: Array
    only: Array
    open: Array
    behind_only: Array
    behind_open: Array
    human: Array


class AssemblyStatus(NamedTuple):
    """How far it is. begun, ended: `[T]` bool. left: `[T]`, time until a running task ends, else 0.
    busy: `[O]`, until the operator is free.
    """

    begun: Array
    ended: Array
    left: Array
    busy: Array


def ahead(
    task: Array, uses: Array, time: Array, stress: Array, needs: Array, human: Array
) -> Ahead:
    """From plain NumPy arrays: `task` `[W]`, `uses` `[W, O]` bool, `time` and `stress` `[W]` in
    units, `needs` `[T, T]` bool, `human` `[O]`.
    """
    tasks = needs.shape[0]
    behind = needs.T.copy()  # [i, j]: j comes after i
    for middle in range(tasks):
        behind |= behind[:, middle : middle + 1] & behind[middle]
    ways = [np.flatnonzero(task == index) for index in range(tasks)]
    least = np.array([time[rows].min() for rows in ways])
    always = np.array([uses[rows].all(0) for rows in ways])
    tail = np.zeros(tasks)
    for index in sorted(range(tasks), key=lambda index: behind[index].sum()):
        tail[index] = least[index] + max(tail[behind[index]], default=0.0)
    only = always * least[:, None]
    nobodys = np.where(always.any(1), 0.0, least)
    parts = {
        "uses": uses,
        "time": time,
        "stress": stress,
        "needs": needs,
        "least": least,
        "least_stress": [stress[rows].min() for rows in ways],
        "tail": tail,
        "only": only,
        "open": nobodys,
        "behind_only": behind @ only,
        "behind_open": behind @ nobodys,
        "human": human,
    }
    return Ahead(
        np.asarray(task, np.int32),
        **{name: np.asarray(part, np.float32) for name, part in parts.items()},
    )


def time_to_come(ahead: Ahead, now: AssemblyStatus) -> Array:
    """`[]` a time that is certainly still to come: the longest chain, the fullest operator, or all
    work shared out evenly.
    """
    xp, waiting = namespace(now.left), 1.0 - now.begun
    chain = xp.max(
        xp.where(
            now.begun, xp.where(now.ended, 0.0, now.left + ahead.tail - ahead.least), ahead.tail
        )
    )
    load = now.busy + waiting @ ahead.only
    shared = (xp.sum(now.busy) + waiting @ ahead.least) / now.busy.shape[0]
    return xp.maximum(xp.maximum(chain, xp.max(load)), shared)


def missing(ahead: Ahead, ended: Array) -> Array:
    """`[T]` how many tasks each one still waits for."""
    return ahead.needs @ (1.0 - ended)


def features(
    ahead: Ahead,
    now: AssemblyStatus,
    me: Array,
    way: Array,
    there: Array,
    mine: Array,
    waits: Array,
) -> Observation:
    """What the agent `me` sees.

    Args:
      me: `[]` int32, the operator whose turn it is; any when nobody's.
      way: `[K]` int32, the way that each move begins; any where `there` is False.
      there: `[K]` bool, the moves that someone could make now or when he is free: the task waits
        for no other.
      mine: `[K]` bool, legal for `me`.
      waits: `[K]` bool, the moves that begin nothing.
    """
    xp = namespace(now.left)
    # the operators are only mine and the others', so that any number of them has one shape
    my = (xp.arange(ahead.uses.shape[1]) == me).astype(xp.float32)
    others = 1.0 - my
    task = ahead.task[way]
    real = (there & ~waits).astype(xp.float32)
    # the measure of all times below: at the end of a game nothing is left to divide by
    to_come = xp.maximum(time_to_come(ahead, now), 1e-3)
    waiting = 1.0 - now.begun
    # whose work it is decides whom a move helps: mine alone, the others' alone, or anybody's
    # [T, 3]: mine alone, others' alone, open
    kinds = xp.stack([ahead.only @ my, ahead.only @ others, ahead.open], 1)
    behind = xp.stack(
        [ahead.behind_only[task] @ my, ahead.behind_only[task] @ others, ahead.behind_open[task]], 1
    )
    # what the move sets free now, and what it helps to set free once running tasks have ended
    after = ahead.needs[:, task].T  # [K, T]
    unlocks = after * (missing(ahead, now.ended) == 1)[None] @ kinds
    running = now.begun & ~now.ended
    helps = after * (missing(ahead, now.ended | running) == 1)[None] @ kinds
    # the move's own numbers, beside how long and how full the rest is
    loads = waiting @ kinds
    longest = xp.max(xp.where(now.begun, 0.0, ahead.tail))
    uses = ahead.uses[way]
    able = uses @ my
    starts = ahead.time[way]
    tail, later = ahead.tail[task], ahead.tail[task] - ahead.least[task]
    parts = [
        *(starts, ahead.stress[way], tail / to_come, (longest - tail) / to_come, later / to_come),
        *(behind.T / to_come),
        *unlocks.T,
        *helps.T,
        *(
            starts - ahead.least[task],
            able,
            xp.sum(uses, 1) - 1.0,
            xp.minimum(uses @ others, 1.0),
            ahead.open[task] > 0,
        ),
        *(mine, now.busy @ uses.T),
    ]
    # a move that nobody can make has stale numbers: they are wiped, so that no network learns them
    rows = xp.stack([xp.asarray(part, xp.float32) for part in parts], 1) * real[:, None]
    rows = xp.concatenate([rows, waits.astype(xp.float32)[:, None]], 1)
    # when others are free again tells whether it pays to leave work for them
    busy_others = xp.where(my > 0, 0.0, now.busy)
    soonest = (
        xp.min(xp.where(my > 0, xp.inf, now.busy)) if ahead.uses.shape[1] > 1 else xp.zeros(())
    )
    ready_mine, ready_others = xp.sum(real * able * starts), xp.sum(real * (1 - able) * starts)
    # tens and quarters bring all numbers to about 1, where a fresh network learns best
    whole = xp.stack([
        to_come / 10, *(loads / to_come), longest / to_come, xp.max(busy_others), soonest,
        ready_mine / 4, ready_others / 4,
        xp.sum(real) / 10, xp.sum(mine) / 10, ahead.human @ my, xp.max(now.left), xp.mean(waiting),
    ])  # fmt: skip
    return Observation(rows, there, whole.astype(xp.float32))
