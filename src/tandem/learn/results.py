"""How far a learned result is above the exact optimum, under what the agents are paid for."""

from __future__ import annotations

from typing import Any

from tandem.plan.result import Front


def cost(makespan: float, stress: float, *, step: float, per_second: int, stress_factor: float) -> float:
    """What an agent loses by time and stress: |step reward| x ticks + factor x stress. The robot's loss differs by a constant."""
    return abs(step) * per_second * makespan + stress_factor * stress


def relative_gap(front: Front | None, makespan: float | None, stress: float | None, **paid: Any) -> float | None:
    """How far the cost is above the least on the front, as a share of that; None without a front or an end.

    Every least cost with weights of 0 or more lies on the complete front, so the gap of a complete front is exact.
    """
    if front is None or makespan is None or stress is None:
        return None
    least = min(cost(*point, **paid) for point in front.points)
    return round((cost(makespan, stress, **paid) - least) / least, 6)
