"""What a player reached in one episode, whoever played."""

from __future__ import annotations

from dataclasses import dataclass

from tandem.schedule.model import Schedule


@dataclass(frozen=True)
class Reached:
    """One episode.

    Attributes:
      makespan, stress: seconds and stress; None when the assembly was not finished.
      illegal: rules broken.
      cost: what all agents together were paid, negated: of several finished episodes the best has the least.
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
