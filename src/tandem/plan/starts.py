"""Schedules in whole numbers: what can be said of one, and how one is made from an order or from
who does what.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from random import Random

from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout, Step, append_in_order
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


def keeps_deadlines(instance: Instance, starts: Starts) -> bool:
    """Whether every task ends by its deadline."""
    return all(
        deadline is None or start + instance.ways[task][way].ticks <= deadline
        for task, ((way, start), deadline) in enumerate(zip(starts, instance.deadline, strict=True))
    )


def append(layout: Layout, order: Sequence[int], ways: Sequence[int]) -> Starts | None:
    """The tasks appended in this order in these ways, or equal ones of less stress; None when a way
    is none that can be part of a schedule.
    """
    steps = [_step(layout, task, way) for task, way in enumerate(ways)]
    if any(step is None for step in steps):
        return None
    return tuple(append_in_order(layout, order, steps).starts())  # type: ignore[arg-type]


def list_schedule(layout: Layout, ways: Sequence[int]) -> Starts | None:
    """The list schedule by longest tail in which every task is done in the way given; None when
    limits or deadlines are broken.
    """
    steps = [_step(layout, task, way) for task, way in enumerate(ways)]
    if any(step is None for step in steps):
        return None
    narrow = replace(layout, steps=tuple((step,) for step in steps if step is not None))
    state = build(narrow, SPECS["longest-tail"], Random(0))
    starts = None if state is None else tuple(state.starts())
    return starts if starts is not None and keeps_deadlines(layout.instance, starts) else None


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
