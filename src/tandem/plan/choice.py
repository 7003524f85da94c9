"""Which point of a front is meant."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

from tandem.cell.written import number
from tandem.errors import UsageError
from tandem.plan.cycle.result import CycleFront
from tandem.plan.knee import knee_index
from tandem.plan.result import Front
from tandem.schedule.measures import exact

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
    fit = within(points, makespan, stress)
    if not fit:
        given = (
            f"--makespan {number(makespan or 0)}"
            if stress is None
            else f"--stress {number(stress)}"
        )
        raise UsageError(f"{given}: no point of the front keeps this; {_has(points)}")
    return fit[-1] if stress is None else fit[0]


def within(
    points: Sequence[tuple[float, float]], makespan: float | None, stress: float | None
) -> list[int]:
    """Indices of the points that keep these limits; None for no limit."""
    latest, hardest = (inf if given is None else given for given in (makespan, stress))
    return [
        place
        for place, (time, load) in enumerate(points)
        if time <= latest + CLOSE and load <= hardest + CLOSE
    ]


def _has(points: Sequence[tuple[float, float]]) -> str:
    listed = ", ".join(f"({number(time)} s, {number(load)})" for time, load in points)
    return f"the front has {len(points)} point{'s' * (len(points) != 1)}, counted from 1: {listed}."


def weights_of(points: Sequence[tuple[float, float]], share: float) -> tuple[float, float]:
    """Weights of a second and of a unit of stress, as `--weights` takes them, for a share of
    attention: 0 for time alone, 1 for stress alone, 0.5 where the whole range of the front in one
    counts as much as that in the other. Four digits are kept: what can be read can be typed.

    Args:
      points: (makespan, stress) sorted by makespan, at least one.

    Raises UsageError when the share is not from 0 to 1.
    """
    if not 0 <= share <= 1:
        raise UsageError(f"the share of stress is {number(share)}, but must be from 0 to 1.")
    if share == 1:
        return 0.0, 1.0
    (first, most), (last, least) = points[0], points[-1]
    ratio = (last - first) / (most - least) if last > first and most > least else 1.0
    return 1.0, float(f"{share / (1 - share) * ratio:.4g}")


def best_of(
    points: Sequence[tuple[float, float]],
    weights: tuple[float, float] | None = None,
    makespan: float | None = None,
    stress: float | None = None,
) -> int | None:
    """Index of the point to recommend among those that keep the limits, None where none does: the
    one of the least weighted sum, the quicker of equals; without weights the knee.

    Args:
      points: (makespan, stress) sorted by makespan.
      weights: of a second and of a unit of stress.
    """
    kept = within(points, makespan, stress)
    if not kept:
        return None
    if weights is None:
        return kept[knee_index([points[place] for place in kept])]
    of_time, of_stress = map(exact, weights)
    return min(
        kept,
        key=lambda i: (of_time * exact(points[i][0]) + of_stress * exact(points[i][1]), i),
    )
