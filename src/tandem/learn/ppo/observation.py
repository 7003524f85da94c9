"""What a learner sees of an assembly beside people: the work, the operators and how fast each has
turned out to be. Nothing that is still to show.

One function of the world's arrays, in NumPy and under JAX alike, so that what was trained decides
on a PC without JAX. Everything is in units of the cell: ticks are divided by `scale`, so that a
policy of one cell can begin to learn another of the same shape.
"""

from __future__ import annotations

from typing import NamedTuple

from tandem.world.arrays import Array, Arrays, namespace
from tandem.world.state import State, legal_of, may_wait, mounted

PRIOR = 0.25
"""How much seen work, in units of `scale`, weighs as much as the stated times do."""


class Pace(NamedTuple):
    """How fast the operators have turned out to be.

    factor: `[O]` float32, estimated factor on the stated times; 1 before anything was seen.
    seen: `[O]` float32, stated time of the work that tells it, in units of `scale`.
    """

    factor: Array
    seen: Array


def scale(arrays: Arrays) -> Array:
    """`[]` float32, ticks: the tasks' quickest times, summed and shared among all operators; the
    unit of time of what is seen.
    """
    xp = namespace(arrays.way_ticks)
    quickest = xp.min(
        xp.where(
            arrays.of_task & arrays.way_open[:, None],
            arrays.way_ticks[:, None],
            arrays.way_ticks.max(),
        ),
        axis=0,
    )
    return xp.maximum(1.0, xp.sum(quickest) / arrays.human.shape[0]).astype(xp.float32)


def pace(arrays: Arrays, state: State) -> Pace:
    """The operators' paces as they have shown. Work in hand that takes longer than it should
    already counts.
    """
    return _shown(arrays, state, _work(arrays, state))


def observation_size(arrays: Arrays) -> int:
    """How many numbers `observe` gives, `D`."""
    (ways, operators), tasks = arrays.way_uses.shape[-2:], arrays.needs.shape[-1]
    return 6 * tasks + 6 * operators + 2 * ways + 1


def observe(arrays: Arrays, state: State, mask: Array, turn: Array) -> Array:
    """`[D]` float32: how it stands, seen by whose turn it is.

    Per task: open, ready to begin, in hand, done, how long the work in hand has taken, and how long
    it should still take at the paces that have shown. Per operator: whose turn it is, present,
    working, the logarithm of its pace, how much was seen of it, its time since the start of what it
    does. Per way: whether it may begin, by anybody and by whose turn it is. And the time gone by.

    Args:
      mask: `[W]` bool, what may begin now. turn: `[]` int, whose turn it is.
    """
    xp = namespace(state.way)
    unit, work = scale(arrays), _work(arrays, state)
    shown, team, done, begun = _shown(arrays, state, work), work.team, work.done, state.way >= 0
    in_hand = begun & ~done
    elapsed = work.elapsed / unit
    slowest = xp.max(xp.where(team, shown.factor[None, :], 0.0), axis=1)
    left = xp.where(in_hand, xp.maximum(0.0, slowest * work.stated / unit - elapsed), 0.0)
    ready = ~begun & ~xp.any(arrays.needs & ~done[None, :], axis=1)
    busy = team & in_hand[:, None]
    tasks = [~begun, ready, in_hand, done, elapsed, left]
    operators = [
        xp.arange(arrays.human.shape[0]) == turn,
        state.away_until <= state.clock,
        xp.any(busy, axis=0),
        xp.log(shown.factor),
        shown.seen,
        xp.max(xp.where(busy, elapsed[:, None], 0.0), axis=0),
    ]
    ways = [mask, legal_of(arrays, mask, turn)]
    clock = xp.reshape(state.clock / unit, (1,))
    return xp.concatenate(
        [xp.asarray(part, dtype=xp.float32) for part in (*tasks, *operators, *ways, clock)]
    )


def choices(arrays: Arrays, state: State, mask: Array, turn: Array) -> Array:
    """`[W + 1]` bool, what whose turn it is may do: a way, or the last one, waiting. Waiting is
    open when nothing else is.
    """
    xp = namespace(mask)
    mine = legal_of(arrays, mask, turn)
    wait = may_wait(arrays, state, mask, turn) | ~xp.any(mine)
    return xp.concatenate([mine, xp.reshape(wait, (1,))])


class _Work(NamedTuple):
    """What the tasks' work is.

    stated: `[T]` int32, what work in hand or done should take by the stated times; 0 for what is
    open. team: `[T, O]` bool, who does or did it. done: `[T]` bool. elapsed: `[T]` int32, ticks
    since work in hand began; 0 for what is open or done.
    """

    stated: Array
    team: Array
    done: Array
    elapsed: Array


def _work(arrays: Arrays, state: State) -> _Work:
    xp = namespace(state.way)
    in_use = state.way[:, None] == xp.arange(arrays.way_ticks.shape[0], dtype=xp.int32)[None, :]
    done = mounted(state)
    in_hand = (state.way >= 0) & ~done
    ticks = arrays.way_ticks[None, :]
    if arrays.undo.shape[0]:
        ticks = xp.where((state.undoing & ~done)[:, None], arrays.undo[None, :], ticks)
    return _Work(
        stated=xp.sum(xp.where(in_use, ticks, 0), axis=1),
        team=xp.any(in_use[:, :, None] & arrays.way_uses[None, :, :], axis=1),
        done=done,
        elapsed=xp.where(
            in_hand, xp.maximum(0, state.clock - xp.where(in_hand, state.start_at, 0)), 0
        ),
    )


def _shown(arrays: Arrays, state: State, work: _Work) -> Pace:
    xp = namespace(state.way)
    unit, mine = scale(arrays), work.team & work.done[:, None]
    worked = xp.where(work.done, state.end_at - state.start_at, 0)
    seen = xp.sum(xp.where(mine, work.stated[:, None], 0), axis=0) / unit
    took = xp.sum(xp.where(mine, worked[:, None], 0), axis=0) / unit
    overdue = work.elapsed / xp.maximum(work.stated, 1)
    at_least = xp.max(xp.where(work.team & ~work.done[:, None], overdue[:, None], 0.0), axis=0)
    factor = (PRIOR + took) / (PRIOR + seen)
    return Pace(xp.maximum(factor, at_least).astype(xp.float32), seen.astype(xp.float32))
