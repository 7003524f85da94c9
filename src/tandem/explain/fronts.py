"""How one front differs from another: point by point, and as an area."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from tandem.cell.model import plain
from tandem.plan.result import Front
from tandem.schedule.measures import exact

Point = tuple[float, float]


@dataclass(frozen=True)
class PointChange:
    """What becomes of one point of the base.

    Attributes:
      makespan, stress: of the base's point, seconds and the cell's measure.
      makespan_then: the least makespan of the other front at no more stress than here; None when
        none of its points has so little.
      stress_then: the least stress of the other front in no more time than here; None when none of
        its points is so quick.
    """

    makespan: float
    stress: float
    makespan_then: float | None
    stress_then: float | None

    @property
    def seconds(self) -> float | None:
        """Seconds more (less when negative) for the same stress."""
        return (
            None
            if self.makespan_then is None
            else float(exact(self.makespan_then) - exact(self.makespan))
        )

    @property
    def more_stress(self) -> float | None:
        """Stress more (less when negative) in the same time."""
        return (
            None
            if self.stress_then is None
            else float(exact(self.stress_then) - exact(self.stress))
        )

    def to_dict(self) -> dict[str, Any]:
        return {
            "makespan": plain(self.makespan),
            "stress": plain(self.stress),
            "makespan_then": plain(self.makespan_then),
            "stress_then": plain(self.stress_then),
            "seconds": plain(self.seconds),
            "more_stress": plain(self.more_stress),
        }


def changes(base: Front, other: Front) -> tuple[PointChange, ...]:
    """For each point of the base front, what the other front offers at the same stress and in the
    same time.
    """
    return changes_of(base.points, other.points)


def changes_of(base: Sequence[Point], other: Sequence[Point]) -> tuple[PointChange, ...]:
    """The same of the (makespan, stress) of points."""
    return tuple(_change(point, other) for point in base)


def _change(point: Point, others: Sequence[Point]) -> PointChange:
    makespan, stress = point
    times = [time for time, load in others if load <= stress]
    loads = [load for time, load in others if time <= makespan]
    return PointChange(makespan, stress, min(times, default=None), min(loads, default=None))


def reference(points: Iterable[Point]) -> Point:
    """The corner against which areas are taken: a tenth beyond the largest makespan and the largest
    stress, at least 1 beyond.
    """
    times, loads = zip(*points, strict=True)
    return max(times) + max(1.0, max(times) / 10), max(loads) + max(1.0, max(loads) / 10)


def area(points: Iterable[Point], corner: Point) -> float:
    """The area that the points dominate up to the corner, seconds times stress: the larger, the
    better the front (the hypervolume of Zitzler and Thiele 1999, IEEE Transactions on Evolutionary
    Computation 3(4), 257-271).
    """
    total, level = 0.0, corner[1]
    for makespan, stress in sorted(points):
        if makespan < corner[0] and stress < level:
            total += (corner[0] - makespan) * (level - stress)
            level = stress
    return total
