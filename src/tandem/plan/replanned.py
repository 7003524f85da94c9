"""What `least_change.replan` gives: plans of a changed cell, and how far each is from the old
one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from tandem.cell.model import plain
from tandem.plan.result import Front, Result
from tandem.schedule.changes import Changes
from tandem.schedule.model import Schedule


@dataclass(frozen=True, kw_only=True)
class Replan(Result):
    """A plan, and how far it is from the old one."""

    changes: Changes

    def to_dict(self) -> dict[str, Any]:
        """One entry of `front` in a result document."""
        return {
            **super().to_dict(),
            "changed": [changed.to_dict() for changed in self.changes.changed],
            "new": list(self.changes.new),
            "gone": list(self.changes.gone),
        }


@dataclass(frozen=True)
class Optimum:
    """The best plan of the changed cell, measured by what the old one was chosen for.

    Attributes:
      makespan: the least among plans of at most `stress`, seconds; `bound`, what is proven of it.
      stress: that of the old plan, or the least there is when that can no longer be reached; None
        when the old plan's stress is not known.
      reachable: whether any plan has as little stress as the old one; None while that is open.
      proven: nothing of at most this stress is quicker, and where it is the least that there is,
        that is proven too.
    """

    makespan: float
    bound: float
    stress: float | None
    reachable: bool | None
    proven: bool

    def to_dict(self) -> dict[str, Any]:
        """As `optimum` in the result document."""
        return {
            "makespan": plain(self.makespan),
            "bound": plain(self.bound),
            "stress": plain(self.stress),
            "reachable": self.reachable,
            "proven": self.proven,
        }


@dataclass(frozen=True, kw_only=True)
class Replanned(Front):
    """The plan that changes least or, if asked for, one for each number of changed tasks that
    gains time, sorted by makespan.

    Attributes:
      before: the old plan.
      optimum: what the limits are measured by; they stand in `question`.
      allow: percent above it.
      tolerance: seconds by which a start may move and still be the same.
      kept: what did not move, and why: "done", "started" or "kept".
      at_least: proven bounds of the numbers of the one plan; each holds for plans with no more of
        the numbers before it.
    """

    before: Schedule
    optimum: Optimum
    allow: float
    tolerance: float
    kept: tuple[tuple[str, str], ...]
    at_least: Mapping[str, int]

    @property
    def changes(self) -> Changes:
        """What the first plan changes."""
        first = self.results[0]
        assert isinstance(first, Replan)
        return first.changes

    def to_dict(self) -> dict[str, Any]:
        """The result document of `tandem replan --json`."""
        document = super().to_dict()
        rest = {key: document.pop(key) for key in ("front", "source", "cell_document")}
        replan = {
            "from": self.before.digest,
            "optimum": self.optimum.to_dict(),
            "allow": plain(self.allow),
            "tolerance": plain(self.tolerance),
            "kept": [{"task": task, "why": why} for task, why in self.kept],
            "at_least": dict(self.at_least),
        }
        return {**document, "replan": replan, **rest}
