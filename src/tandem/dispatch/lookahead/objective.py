"""What is made small: time and stress, weighed."""

from __future__ import annotations

import math
from dataclasses import dataclass

from tandem.errors import UsageError
from tandem.plan.question import Question
from tandem.plan.result import Result, Status


@dataclass(frozen=True)
class Objective:
    """What a decider makes small: `time * makespan + stress * stress`, within a limit of stress.

    Attributes:
      time, stress: weights, per second and per unit of the cell's stress.
      max_stress: the most stress of all humans together; None for no limit but the cell's own.
    """

    time: float = 1.0
    stress: float = 0.0
    max_stress: float | None = None

    def __post_init__(self) -> None:
        if (
            any(not math.isfinite(weight) or weight < 0 for weight in (self.time, self.stress))
            or not self.time + self.stress
        ):
            raise UsageError(
                f"weights {self.time:g}, {self.stress:g}: both must be 0 or more, and one of them"
                " more than 0."
            )
        if self.max_stress is not None and not (
            math.isfinite(self.max_stress) and self.max_stress >= 0
        ):
            raise UsageError(f"max_stress {self.max_stress:g}: must be a number, 0 or more.")

    @property
    def unit(self) -> str:
        """What a cost is counted in: "s", "of stress", or the weighted sum in words."""
        if not self.stress:
            return "s" if self.time == 1 else f"({self.time:g} × s)"
        if not self.time:
            return "of stress" if self.stress == 1 else f"({self.stress:g} × stress)"
        return f"({self.time:g} × s + {self.stress:g} × stress)"

    def words(self, cost: float, digits: int = 4) -> str:
        """A cost, or a difference of two, with its unit."""
        return f"{cost:.{digits}g} {self.unit}" if math.isfinite(cost) else "no end in sight"

    def question(self) -> Question:
        """What a planner is asked: the least of the objective; where one measure alone counts, the
        least of the other at that value.
        """
        if not self.stress:
            return Question("makespan", max_stress=self.max_stress)
        if not self.time:
            return Question("stress", max_stress=self.max_stress)
        return Question("weighted", (self.time, self.stress), max_stress=self.max_stress)

    def is_proven(self, found: Result) -> bool:
        """Whether no plan is better by the objective than this answer to its `question`."""
        low = found.bound
        return found.status == Status.OPTIMAL or self.cost(
            found.makespan, found.stress
        ) <= self.cost(low.makespan, low.stress)

    def cost(self, makespan: float, stress: float) -> float:
        """Seconds and stress as one number."""
        return self.time * makespan + self.stress * stress


SECONDS = Objective()
"""Time alone."""
