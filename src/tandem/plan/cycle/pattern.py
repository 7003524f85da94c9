"""Patterns in whole numbers: when the tasks of a product start, and where in the cycle that is."""

from __future__ import annotations

from collections.abc import Sequence

from tandem.plan.instance import Instance

Pattern = tuple[tuple[int, int], ...]
"""Per task `(way, start in ticks since its product's launch)`."""


def lifted(instance: Instance, places: Pattern, length: int) -> Pattern:
    """The pattern in which each task keeps its place in the cycle and starts in the first cycle in
    which all that it comes after have ended, and its waits are over; the first start is at the
    launch. Where something must follow in time, the places alone do not say when that is.

    Args:
      places: per task `(way, place in the cycle)`.
      length: the cycle time, ticks.
    """
    starts = [0] * len(places)
    for task in instance.order:
        ends = [
            starts[first] + instance.ways[first][places[first][0]].ticks
            for first in instance.before[task]
        ]
        for lag in instance.lags_into[task] if instance.has_lags else ():
            own = 0 if lag.from_start else instance.ways[lag.before][places[lag.before][0]].ticks
            ends.append(starts[lag.before] + own + lag.least)
        ready = max(ends, default=0)
        place = places[task][1]
        starts[task] = place + length * max(0, -((place - ready) // length))
    return launched(tuple((way, start) for (way, _), start in zip(places, starts, strict=True)))


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


def is_tied(instance: Instance) -> bool:
    """Whether laps of tasks hang together: something must follow in time, or a machine holds a part
    from one task to another.
    """
    return instance.has_most_lags or instance.has_holds


def most_laps(instance: Instance) -> int:
    """A product need not stay for more cycles than this: from one task to the next it waits at most
    for its place in the next cycle, and no cycle is shorter than the longest of the tasks that it
    must hold.
    """
    shortest = max(min(way.ticks for way in ways) for ways in instance.ways)
    return len(instance.ways) + -(-instance.horizon // shortest)


def makespan(instance: Instance, pattern: Pattern) -> int:
    """How long one product is in the station, ticks."""
    return max(start + instance.ways[task][way].ticks for task, (way, start) in enumerate(pattern))


def stress(instance: Instance, pattern: Pattern) -> int:
    """Units of stress of one product."""
    table = instance.stress_of_set
    if table is None:
        return sum(instance.ways[task][way].stress for task, (way, _) in enumerate(pattern))
    return table[
        frozenset(
            task
            for task, (way, _) in enumerate(pattern)
            if any(instance.human[o] for o in instance.ways[task][way].operators)
        )
    ]
