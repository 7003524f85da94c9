"""Schedules in whole numbers: what can be said of one, and how one is made from an order or from
who does what.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from random import Random

from tandem.plan.instance import Instance, Lag
from tandem.plan.list_scheduling import Layout, Step, append_in_order, by_start
from tandem.plan.rules import SPECS, build

Starts = tuple[tuple[int, int], ...]
"""Per task, in the instance's order: the way it is done and the tick at which it starts."""


def measures(instance: Instance, starts: Starts) -> tuple[int, int]:
    """(makespan in ticks, stress in units) of a schedule; a set that `stress_of_set` does not list
    counts as unbearable.
    """
    ways = [instance.ways[task][way] for task, (way, _) in enumerate(starts)]
    makespan = max(start + way.ticks for way, (_, start) in zip(ways, starts, strict=True))
    if instance.stress_of_set is None:
        return makespan, sum(way.stress for way in ways)
    tasks = frozenset(
        task for task, way in enumerate(ways) if any(instance.human[o] for o in way.operators)
    )
    return makespan, instance.stress_of_set.get(tasks, 1 << 60)


def in_time(instance: Instance, starts: Starts) -> bool:
    """Whether every task ends by its deadline, and starts within its waits."""
    return all(
        deadline is None or start + instance.ways[task][way].ticks <= deadline
        for task, ((way, start), deadline) in enumerate(zip(starts, instance.deadline, strict=True))
    ) and all(
        starts[lag.task][1] <= _moment(instance, starts, lag) + most
        for lag, most in instance.most_lags
    )


def _moment(instance: Instance, starts: Starts, lag: Lag) -> int:
    """The tick from which the wait is counted."""
    way, start = starts[lag.before]
    return start if lag.from_start else start + instance.ways[lag.before][way].ticks


def append(layout: Layout, order: Sequence[int], ways: Sequence[int]) -> Starts | None:
    """The tasks appended in this order in these ways, or equal ones of less stress; None when a way
    is none that can be part of a schedule, or a part that a machine holds never comes out.
    """
    steps = [_step(layout, task, way) for task, way in enumerate(ways)]
    if any(step is None for step in steps):
        return None
    state = append_in_order(layout, order, [step for step in steps if step is not None])
    return None if state is None else tuple(state.starts())


def appended(layout: Layout, starts: Starts) -> Starts:
    """The schedule with its tasks appended in the order of their starts, in the same ways: none
    comes later, and none waits for nothing but its turn.
    """
    fresh = append(layout, by_start(layout.instance, starts), [way for way, _ in starts])
    return fresh if fresh is not None and in_time(layout.instance, fresh) else starts


def list_schedule(layout: Layout, ways: Sequence[int]) -> Starts | None:
    """The list schedule by longest tail in which every task is done in the way given; None when
    limits, deadlines or waits are broken.
    """
    steps = [_step(layout, task, way) for task, way in enumerate(ways)]
    if any(step is None for step in steps):
        return None
    narrow = replace(layout, steps=tuple((step,) for step in steps if step is not None))
    state = build(narrow, SPECS["longest-tail"], Random(0))
    starts = None if state is None else tuple(state.starts())
    return starts if starts is not None and in_time(layout.instance, starts) else None


def _step(layout: Layout, task: int, way: int) -> Step | None:
    wanted = layout.instance.ways[task][way]
    return next(
        (
            step
            for step in layout.steps[task]
            if step.operators == wanted.operators and step.ticks == wanted.ticks
        ),
        None,
    )


def moved_up(layout: Layout, starts: Starts) -> Starts:
    """The schedule with every task as early as it can be, in the same way, while none comes later:
    then none can start earlier while the others stay.

    Tasks are appended in the order of their starts, and put into gaps that have room for them, over
    and over. Of more than `MOST_GAPS_SOUGHT` tasks only the first. Assumes a sound schedule.
    """
    while True:
        starts = appended(layout, starts)
        if len(starts) > MOST_GAPS_SOUGHT or (earlier := _into_a_gap(layout, starts)) is None:
            return starts
        starts = earlier


MOST_GAPS_SOUGHT = 300
"""Tasks; beyond, every task is as early as its place in the order allows, and no gap is looked
for.
"""


def _into_a_gap(layout: Layout, starts: Starts) -> Starts | None:
    """The schedule in which one task has gone into a gap before it and none starts later; None when
    there is no such gap.
    """
    instance, ways = layout.instance, [way for way, _ in starts]
    begin = [start for _, start in starts]
    end = [start + instance.ways[task][way].ticks for task, (way, start) in enumerate(starts)]
    in_order = by_start(instance, starts)
    for task in in_order:
        for moment in _moments_before(instance, task, ways, begin, end):
            order = sorted(in_order, key=lambda one: moment if one == task else begin[one])
            trial = append(layout, order, ways)
            if trial is None or trial[task][1] >= begin[task]:
                continue
            earlier = all(new[1] <= old for new, old in zip(trial, begin, strict=True))
            if earlier and in_time(instance, trial):
                return trial
    return None


def _moments_before(
    instance: Instance, task: int, ways: Sequence[int], begin: Sequence[int], end: Sequence[int]
) -> list[int]:
    """The moments before its start at which the task might begin: something that could be in its
    way has just ended, and its operators have nothing to do until it would end.
    """
    way = instance.ways[task][ways[task]]
    ready = max([instance.release[task], *(end[first] for first in instance.before[task])])
    for lag in instance.lags_into[task] if instance.has_lags else ():
        ready = max(ready, (begin if lag.from_start else end)[lag.before] + lag.least)
    busy = [
        (begin[other], end[other])
        for other in range(len(begin))
        if other != task and instance.ways[other][ways[other]].who & way.who
    ]
    busy += [off for operator in way.operators for off in instance.breaks[operator]]
    zone, tools = instance.zone[task], {tool for tool, _ in way.units}
    if zone is not None and not (instance.zone_room[zone] or instance.keeps_apart[zone]):
        zone = None
    shared = [
        end[other]
        for other in range(len(begin))
        if (zone is not None and instance.zone[other] == zone)
        or (instance.has_tools and tools & {t for t, _ in instance.ways[other][ways[other]].units})
    ]
    for hold, (operator, first, last) in enumerate(instance.holds):
        if first == task or (operator in way.operators and instance.barred[hold] >> task & 1):
            shared.append(end[last])
            shared += [
                end[other]
                for other in range(len(begin))
                if operator in instance.ways[other][ways[other]].operators
            ]
    swaps = {0}.union(*(preparation.lengths for preparation in instance.preparations(task, way)))
    ends = [0, ready, *shared, *(off for _, off in busy)]
    moments = {moment + swap for moment in ends for swap in swaps}
    return sorted(
        moment
        for moment in moments
        if ready <= moment < begin[task]
        and not any(a < moment + way.ticks and moment < b for a, b in busy)
    )
