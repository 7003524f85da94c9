"""Which compromise of a front is recommended, by what is known of the front.

Of a complete front it is the knee: the point farthest below the straight line between the two ends,
both axes scaled to the front's own range (Das 1999, On characterizing the knee of the Pareto curve
based on normal-boundary intersection, Structural Optimization 18, 107-115).

Of a front that was cut short some points are proven and others are only the best that was found. A
point that is not proven may turn out to be dominated, and two runs may have found two such points.
So a proven point is recommended whenever one is nearly as good a compromise as the knee of what was
found: it stays on the front whatever is learned later. And what is recommended is *certain* when no
point that may still be there could be the knee instead.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

Point = tuple[float, float]
"""Makespan in seconds, or another time, and stress."""

NEARLY = 0.9
"""A proven point with so much of the knee's distance to the line is recommended in its place. With
less of it the proven one would be a worse compromise than what is in hand.
"""
CLOSE = 1e-12
"""Distances to the line that differ by less are the same."""


class Recommended(NamedTuple):
    """A point of a front.

    Attributes:
      place: its index.
      certain: whatever is learned later, it stays the recommended one.
    """

    place: int
    certain: bool


def recommended(
    points: Sequence[Point], proven: Sequence[bool], bound_front: Sequence[Point]
) -> Recommended:
    """The point to recommend of a front that is not complete.

    Args:
      points: what was found and nothing found beats, sorted by makespan.
      proven: of each, that it is on the front.
      bound_front: each schedule there may be is at least as great in both as one of these, sorted
        by makespan; empty when nothing is known.
    """
    below, knee = _below(points), knee_index(points)
    place = knee
    if points and not proven[knee]:
        least = NEARLY * max(below[knee], 0.0) - CLOSE
        safe = [i for i, value in enumerate(below) if proven[i] and value >= least]
        place = max(safe, key=below.__getitem__, default=knee)
    return Recommended(place, _is_certain(place, points, proven, bound_front))


def _is_certain(
    place: int, points: Sequence[Point], proven: Sequence[bool], bound_front: Sequence[Point]
) -> bool:
    """Whether the point would be the knee of every front that is still possible: the two ends are
    proven, and so is the point, and nothing that may lie between can be farther below the line.
    """
    if len(points) < 3 or not bound_front or not proven[place]:
        return False
    if bound_front[0] != points[0] or bound_front[-1] != points[-1]:
        return False
    own = _distance(points[place], points)
    if place and own <= CLOSE:
        return False
    most = max(own, CLOSE)
    return not any(
        value > most + CLOSE or (value > most - CLOSE and place and time < points[place][0])
        for value, (time, _) in ((_distance(corner, points), corner) for corner in bound_front)
    )


def knee_index(points: Sequence[Point]) -> int:
    """Index of the knee of points sorted by makespan: the quickest when there are fewer than three
    or none lies below the line.
    """
    if len(points) < 3:
        return 0
    below = _below(points)
    best = max(range(len(points)), key=below.__getitem__)
    return best if below[best] > CLOSE else 0


def _below(points: Sequence[Point]) -> list[float]:
    """How far each point lies below the line, in ranges of the front."""
    return [_distance(point, points) for point in points]


def _distance(point: Point, points: Sequence[Point]) -> float:
    """How far it lies below the line between the ends of the points; 0 where there is no trade-off
    of the two: what was asked is another one.
    """
    (first, most), (last, least) = points[0], points[-1]
    if not (last > first and least < most):
        return 0.0
    return 1 - (point[0] - first) / (last - first) - (point[1] - least) / (most - least)
