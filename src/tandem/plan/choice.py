"""Which point of a front is meant."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

from tandem.cell.written import number
from tandem.errors import UsageError
from tandem.plan.cycle.result import CycleFront
from tandem.plan.knee import knee_index
from tandem.plan.result import Front

CLOSE = 1e-6
"""What a limit may be exceeded by, seconds or stress: people type what was printed for them."""


def point_of(
    front: Front | CycleFront,
    point: int | None = None,
    makespan: float | None = None,
    stress: float | None = None,
) -> int:
    """Index of the point that is meant: the one of this number, counted from 1; the one of least
    stress within so many seconds; the quickest of at most so much stress; else the knee.

    Raises UsageError when more than one is given, or no point is so.
    """
    if point is None and makespan is None and stress is None:
        return front.knee_place
    return chosen(front.points, point, makespan, stress)


def chosen(
    points: Sequence[tuple[float, float]],
    point: int | None = None,
    makespan: float | None = None,
    stress: float | None = None,
) -> int:
    """The same of the (makespan, stress) of points, sorted by makespan."""
    if sum(given is not None for given in (point, makespan, stress)) > 1:
        raise UsageError("--point, --makespan and --stress exclude each other: give one of them.")
    if point is not None and not 1 <= point <= len(points):
        raise UsageError(f"--point {point}: {_has(points)}")
    if point is not None:
        return point - 1
    if makespan is None and stress is None:
        return knee_index(list(points))
    latest, hardest = (inf if given is None else given for given in (makespan, stress))
    fit = [
        place
        for place, (time, load) in enumerate(points)
        if time <= latest + CLOSE and load <= hardest + CLOSE
    ]
    if not fit:
        given = f"--makespan {number(latest)}" if stress is None else f"--stress {number(hardest)}"
        raise UsageError(f"{given}: no point of the front keeps this; {_has(points)}")
    return fit[-1] if stress is None else fit[0]


def _has(points: Sequence[tuple[float, float]]) -> str:
    listed = ", ".join(f"({number(time)} s, {number(load)})" for time, load in points)
    return f"the front has {len(points)} point{'s' * (len(points) != 1)}, counted from 1: {listed}."
