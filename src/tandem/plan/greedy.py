"""Three ways of building a schedule in one go, task by task, from a priority per task and a score
per way of doing it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from heapq import heapify, heappop, heappush

from tandem.plan.list_scheduling import Layout, PartialSchedule, Step

Score = Callable[[int, Step], float]
"""`(end in ticks, step) -> how unwelcome it is`: of a task's steps the one with the least is
taken.
"""

LOOKAHEAD = 24
"""So many waiting tasks are looked at per moment; it bounds the time per task, whatever the size of
the cell.
"""


def clockwise(layout: Layout, priority: Sequence[float], score: Score) -> PartialSchedule | None:
    """Along the clock: whenever an operator is free, the tasks that are ready are looked at by
    priority (least first).

    A task that would rather wait for an operator who is busy waits, and its work is reckoned to
    that operator for the tasks looked at after it. None when a task is left without a step: limits
    or teams stand in the way, or a part that a machine holds never comes out.
    """
    state = PartialSchedule(layout)
    future = [(state.ready[task], task) for task, count in enumerate(state.waiting) if not count]
    heapify(future)
    now: list[tuple[float, int]] = []
    clock, left = 0, len(state.ready)
    while left:
        while future and future[0][0] <= clock:
            task = heappop(future)[1]
            heappush(now, (priority[task], task))
        placed, deferred, moment = _scan(state, now, future, clock, score)
        if placed is None:
            return None
        left -= placed
        for item in deferred:
            heappush(now, item)
        later = [free for free in state.free if free > clock]
        if future:
            later.append(future[0][0])
        if moment is not None:
            later.append(moment)
        if left and not placed and not later:
            return None  # a part that a machine holds never comes out
        clock = max(clock + 1, min(later, default=clock + 1)) if left else clock
    return state


def _scan(
    state: PartialSchedule,
    now: list[tuple[float, int]],
    future: list[tuple[int, int]],
    clock: int,
    score: Score,
) -> tuple[int | None, list[tuple[float, int]], int | None]:
    """Places what starts now. Gives the number placed (None: a task has no step), the tasks looked
    at in vain, and when one of them can start.
    """
    reckoned = list(state.free)
    deferred: list[tuple[float, int]] = []
    held_up: list[tuple[float, int]] = []
    placed, moment = 0, None
    while now and len(deferred) < LOOKAHEAD and min(state.free) <= clock:
        item = heappop(now)
        task = item[1]
        best = _best(state, task, score, reckoned)
        if best is None and state.is_held_up(task):
            held_up.append(item)
            continue
        if best is None:
            return None, deferred, moment
        step, start = best
        if start > clock:
            if not deferred or moment is None or start < moment:
                moment = state.earliest(task, step)
            deferred.append(item)
            for operator in step.operators:
                reckoned[operator] = start + step.ticks
            continue
        for after in state.put(task, step, state.earliest(task, step)):
            heappush(future, (state.ready[after], after))
        for operator in step.operators:
            reckoned[operator] = max(reckoned[operator], state.free[operator])
        placed += 1
    return placed, deferred + held_up, moment


def by_rank(layout: Layout, priority: Sequence[float], score: Score) -> PartialSchedule | None:
    """Down the list: of the tasks whose predecessors are placed always the one of least priority,
    at whatever time. None as `clockwise`.
    """
    state = PartialSchedule(layout)
    ready = [(priority[task], task) for task, count in enumerate(state.waiting) if not count]
    held_up: list[int] = []
    heapify(ready)
    while ready:
        task = heappop(ready)[1]
        best = _best(state, task, score, state.free)
        if best is None and state.is_held_up(task):
            held_up.append(task)
            continue
        if best is None:
            return None
        for after in [*state.put(task, *best), *held_up]:
            heappush(ready, (priority[after], after))
        held_up = []
    return None if held_up else state


def by_score(layout: Layout, priority: Sequence[float], score: Score) -> PartialSchedule | None:
    """Always the task whose best step has the least score now; equal ones by priority. None as
    `clockwise`.

    Scores grow as operators fill up, so one that was right when it was pushed is looked at again
    only when it comes to the top; of many that have grown alike, `LOOKAHEAD` at a time.
    """
    state = PartialSchedule(layout)
    ready: list[tuple[float, float, int]] = [
        (0.0, priority[task], task) for task, count in enumerate(state.waiting) if not count
    ]
    heapify(ready)
    while ready:
        looked_at: list[tuple[float, float, int]] = []
        held_up: list[tuple[float, float, int]] = []
        found: dict[int, tuple[Step, int]] = {}
        while ready and len(looked_at) < LOOKAHEAD and (not looked_at or ready[0] < min(looked_at)):
            value, rank, task = heappop(ready)
            best = _best(state, task, score, state.free)
            if best is None and state.is_held_up(task):
                held_up.append((value, rank, task))
                continue
            if best is None:
                return None
            looked_at.append((score(best[1] + best[0].ticks, best[0]), rank, task))
            found[task] = best
        if not looked_at:
            return None
        chosen = min(looked_at)
        for item in looked_at + held_up:
            if item is not chosen:
                heappush(ready, item)
        for after in state.put(chosen[2], *found[chosen[2]]):
            heappush(ready, (0.0, priority[after], after))
    return state


def _best(
    state: PartialSchedule, task: int, score: Score, reckoned: Sequence[int]
) -> tuple[Step, int] | None:
    """The step of least score, and its start; operators are not free before they are reckoned to
    be.
    """
    best, least = None, 0.0
    for step in state.steps(task):
        start = state.earliest(task, step)
        for operator in step.operators:
            if reckoned[operator] > start:
                start = reckoned[operator]
        value = score(start + step.ticks, step)
        if best is None or value < least:
            best, least = (step, start), value
    return best
