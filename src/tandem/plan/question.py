"""What is asked of a cell: the whole front, or one best schedule, within limits."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal, get_args, get_type_hints

from tandem.cell.model import plain
from tandem.cell.written import number
from tandem.errors import UsageError


@dataclass(frozen=True)
class Question:
    """What is asked.

    Attributes:
      minimize: "front" for every compromise; "makespan" or "stress" for the one schedule that is
        best in it and, among those, best in the other; "weighted" for the least `weights[0] *
        makespan + weights[1] * stress`; "worst-stress" for the least stress of the human who has
        most and, of those schedules, the quickest (`worst_stress.solve`). "change" is what
        `least_change.replan` asks: fewest changes to an old plan.
      weights: used by "weighted" only.
      max_makespan, max_stress: limits on every schedule, seconds and the cell's measure of stress.
    """

    minimize: Literal["front", "makespan", "stress", "worst-stress", "weighted", "change"] = "front"
    weights: tuple[float, float] = (1.0, 1.0)
    max_makespan: float | None = None
    max_stress: float | None = None

    def __post_init__(self) -> None:
        if self.minimize not in get_args(get_type_hints(Question)["minimize"]):
            raise UsageError(
                f"cannot minimize {self.minimize!r}: choose front, makespan, stress, worst-stress"
                " or weighted."
            )
        if any(not math.isfinite(w) or w < 0 for w in self.weights) or not any(self.weights):
            raise UsageError(
                f"weights {','.join(map(number, self.weights))}: both must be 0 or more, and one of"
                " them more than 0."
            )
        for name in ("max_makespan", "max_stress"):
            limit = getattr(self, name)
            if limit is not None and not (math.isfinite(limit) and limit >= 0):
                raise UsageError(f"{name} {number(limit)}: must be a number, 0 or more.")

    @property
    def limits(self) -> tuple[str, ...]:
        """The limits on every schedule, as messages and reports say them."""
        return (
            *(
                [f"a makespan of at most {number(self.max_makespan)} s"]
                if self.max_makespan is not None
                else []
            ),
            *(
                [f"a stress of at most {number(self.max_stress)}"]
                if self.max_stress is not None
                else []
            ),
        )

    def to_dict(self) -> dict[str, Any]:
        """As the `question` of a result document."""
        weights = {"weights": plain(self.weights)} if self.minimize == "weighted" else {}
        return {
            "minimize": self.minimize,
            **weights,
            "max_makespan": plain(self.max_makespan),
            "max_stress": plain(self.max_stress),
        }
