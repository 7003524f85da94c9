"""What is made small: time and stress, weighed."""

from __future__ import annotations

import math
from dataclasses import dataclass

from tandem.errors import UsageError
from tandem.plan.question import Question
from tandem.plan.result import Front, Result, Status


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

    @classmethod
    def of_point(cls, front: Front, index: int) -> Objective:
        """Weights by which this point of the front is the best of it: a second weighs 1, and a unit
        of stress the geometric mean of the least and the most that it may weigh for that.

        To be so quick costs seconds per unit of stress on one side, and to be so easy on the other:
        with points `(m, s)` the weight lies between the most of `(m - m') / (s' - s)` over the
        quicker ones and the least of `(m' - m) / (s - s')` over the slower ones. Where the front is
        not convex at the point no weights make it the best; then they make it nearly so.
        """
        time, load = front.points[index]
        quicker, slower = front.points[:index], front.points[index + 1 :]
        least = max(((time - m) / (s - load) for m, s in quicker), default=None)
        most = min(((m - time) / (load - s) for m, s in slower), default=None)
        if least is None and most is None:
            return cls._of_one(front, time, load)
        if least is None:
            weight = (most or 0.0) / 2
        elif most is None:
            weight = least * 2
        else:
            weight = math.sqrt(least * most)
        return cls(1.0, _short(weight, least or 0.0, math.inf if most is None else most))

    @classmethod
    def _of_one(cls, front: Front, time: float, load: float) -> Objective:
        """Of a front of one point: what was asked of it; where all compromises were, a share of
        the stress weighs as much as the same share of the seconds.
        """
        match front.question.minimize:
            case "makespan":
                return cls()
            case "weighted":
                return cls(*front.question.weights)
            case "stress":
                return cls(1.0, max(_short(time), 1.0))  # a unit of it weighs as the whole plan
        return cls(1.0, _short(time / load)) if load else cls()

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


def _short(weight: float, least: float = 0.0, most: float = math.inf) -> float:
    """The weight in three digits, where these lie within its bounds."""
    rounded = float(f"{weight:.3g}")
    return rounded if least <= rounded <= most else weight


SECONDS = Objective()
"""Time alone."""
