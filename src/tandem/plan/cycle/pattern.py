"""Patterns in whole numbers: when the tasks of a product start, and where in the cycle that is."""

from __future__ import annotations

from collections.abc import Sequence

from tandem.plan.instance import Instance

Pattern = tuple[tuple[int, int], ...]
"""Per task `(way, start in ticks since its product's launch)`."""


def lifted(instance: Instance, pattern: Pattern, length: int) -> Pattern:
    """The pattern in which each task keeps its place in the cycle and starts in the first cycle in
    which all that it comes after have ended, and its waits are over; the first start is at the
    launch. Tasks that are tied keep the laps between them.

    Args:
      pattern: per task `(way, start)`, of which the place in the cycle counts and, between tasks
        that are tied, the laps.
      length: the cycle time, ticks.
    """
    ticks = [instance.ways[task][way].ticks for task, (way, _) in enumerate(pattern)]
    edges = [
        (first, task, ticks[first]) for task, row in enumerate(instance.before) for first in row
    ]
    for lag in instance.lags:
        own = 0 if lag.from_start else ticks[lag.before]
        edges.append((lag.before, lag.task, own + lag.least))
    tied = instance.tied
    starts = [start if task in tied else start % length for task, (_, start) in enumerate(pattern)]
    late = True
    while late:  # at most as often as tasks and groups lie behind each other
        late = False
        for first, task, apart in edges:
            missing = starts[first] + apart - starts[task]
            if missing > 0:
                late = True
                for other in tied.get(task, (task,)):
                    starts[other] += length * -(-missing // length)
    return launched(tuple((way, start) for (way, _), start in zip(pattern, starts, strict=True)))


def launched(pattern: Pattern) -> Pattern:
    """The same with its first start at the launch."""
    first = min(start for _, start in pattern)
    return tuple((way, start - first) for way, start in pattern)


def stacked(instance: Instance, ways: Sequence[int]) -> Pattern:
    """Per task `(way, place)` when each operator does what is theirs one after the other, from the
    beginning of the cycle on; for ways of one operator each where nothing else is shared.
    """
    load = [0] * len(instance.operators)
    places = [(0, 0)] * len(ways)
    for task in instance.order:
        way = instance.ways[task][ways[task]]
        (operator,) = way.operators
        places[task] = (ways[task], load[operator])
        load[operator] += way.ticks
    return tuple(places)


def most_laps(instance: Instance, group: Sequence[int]) -> int:
    """Tasks that are tied lie no more cycles apart than this: from one to the next a product waits
    at most for its place in the next cycle, and no cycle is shorter than the longest of the tasks
    that it must hold.
    """
    shortest = max(min(way.ticks for way in ways) for ways in instance.ways)
    work = sum(max(way.ticks for way in instance.ways[task]) for task in group)
    waits = sum(lag.least for lag in instance.lags if {lag.before, lag.task} <= set(group))
    return len(group) + -(-(work + waits) // shortest)


def makespan(instance: Instance, pattern: Pattern) -> int:
    """How long one product is in the station, ticks."""
    return max(start + instance.ways[task][way].ticks for task, (way, start) in enumerate(pattern))
