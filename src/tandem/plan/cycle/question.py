"""What is asked of a station that repeats: every compromise of cycle time and stress, or one."""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import ROUND_FLOOR
from typing import Any, Literal

from tandem.cell.model import plain
from tandem.cell.written import number
from tandem.errors import UsageError
from tandem.schedule.measures import exact


@dataclass(frozen=True)
class CycleQuestion:
    """What is asked.

    Attributes:
      minimize: "front" for every compromise; "cycle_time" or "stress" for the one pattern that is
        best in it and, among those, best in the other. With a takt "front" is not asked: the least
        stress that keeps it is, then the fewest in process, then the least cycle time.
      takt: seconds; a limit on the cycle time.
      max_in_process: at most so many products in the station at once; None for as many as help.
      max_stress: a limit on the stress of each product.
    """

    minimize: Literal["front", "cycle_time", "stress"] = "front"
    takt: float | None = None
    max_in_process: int | None = None
    max_stress: float | None = None

    def __post_init__(self) -> None:
        if self.minimize not in ("front", "cycle_time", "stress"):
            raise UsageError(
                f"cannot minimize {self.minimize!r} of a cycle: choose front, cycle_time or stress."
            )
        if self.takt is not None and not (math.isfinite(self.takt) and self.takt > 0):
            raise UsageError(f"takt {number(self.takt)}: must be a number of more than 0 seconds.")
        if self.max_in_process is not None and self.max_in_process < 1:
            raise UsageError(f"max_in_process {self.max_in_process}: must be 1 or more.")
        if self.max_stress is not None and not (
            math.isfinite(self.max_stress) and self.max_stress >= 0
        ):
            raise UsageError(f"max_stress {number(self.max_stress)}: must be a number, 0 or more.")

    @property
    def is_front(self) -> bool:
        """Every compromise is asked for."""
        return self.minimize == "front" and self.takt is None

    @property
    def limits(self) -> tuple[str, ...]:
        """The limits on every pattern, as messages and reports say them."""
        said = []
        if self.takt is not None:
            said.append(f"a takt of {number(self.takt)} s")
        if self.max_in_process is not None:
            said.append(f"at most {self.max_in_process} in process")
        if self.max_stress is not None:
            said.append(f"a stress of at most {number(self.max_stress)}")
        return tuple(said)

    def to_dict(self) -> dict[str, Any]:
        """As the `question` of a result document."""
        asked: dict[str, Any] = {"minimize": self.minimize}
        for name in ("takt", "max_in_process", "max_stress"):
            if (value := getattr(self, name)) is not None:
                asked[name] = plain(value)
        return asked


def whole(limit: float | None, scale: int) -> int | None:
    """A limit in ticks or units of stress, cut down; None for none."""
    if limit is None:
        return None
    return int((exact(limit) * scale).to_integral_value(ROUND_FLOOR))


FRONT = CycleQuestion()
"""Every compromise, within no limits but the cell's."""
