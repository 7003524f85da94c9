"""What a player reached in an episode, what that costs, and how far it is above the exact
optimum.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from tandem.plan.result import Front
from tandem.schedule.model import Schedule

SECOND = 10.0
"""What a second costs beside a unit of stress times the stress factor, as in the thesis's
rewards.
"""


@dataclass(frozen=True)
class Reached:
    """One episode.

    Attributes:
      makespan, stress: seconds and stress; None when the assembly was not finished.
      illegal: rules broken.
      cost: what all agents together were paid, negated: of several finished episodes the best has
        the least.
      schedule: what was done, when it was finished.
    """

    makespan: float | None
    stress: float | None
    illegal: int
    cost: float
    schedule: Schedule | None

    @property
    def done(self) -> bool:
        """Whether the assembly was finished."""
        return self.makespan is not None


def paid(stress_factor: float) -> dict[str, Any]:
    """What time and stress cost where a second costs `SECOND`, for `cost`."""
    return {"step": -SECOND, "per_second": 1, "stress_factor": stress_factor}


def cost(
    makespan: float, stress: float, *, step: float, per_second: int, stress_factor: float
) -> float:
    """What an agent loses by time and stress: |step reward| x ticks + factor x stress. The robot's
    loss differs by a constant.
    """
    return abs(step) * per_second * makespan + stress_factor * stress


def relative_gap(
    front: Front | None, makespan: float | None, stress: float | None, **paid: Any
) -> float | None:
    """How far the cost is above the least on the front, as a share of that; None without a front or
    an end.

    Every least cost with weights of 0 or more lies on the complete front, so the gap of a complete
    front is exact.
    """
    if front is None or makespan is None or stress is None:
        return None
    least = min(cost(*point, **paid) for point in front.points)
    return round((cost(makespan, stress, **paid) - least) / least, 6)


def dominating(
    front: Front | None, makespan: float | None, stress: float | None
) -> tuple[float, float] | None:
    """The quickest point of the front that is at least as good in both and better in one; None
    where there is none. What costs as little as can be, at weights of which one is 0, may have one.
    """
    if front is None or makespan is None or stress is None:
        return None
    better = [
        point
        for point in front.points
        if point[0] <= makespan and point[1] <= stress and point != (makespan, stress)
    ]
    return min(better, default=None)
