"""Why a task starts when it does: what it waited for, and how far it could slip."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from tandem.cell.model import Cell, plain
from tandem.cell.written import number
from tandem.schedule.critical import Link, critical_path, links, slack
from tandem.schedule.model import Schedule


@dataclass(frozen=True)
class Waiting:
    """What holds a task where it stands.

    Attributes:
      links: everything that keeps it from starting a moment earlier; empty when it could.
      slack: seconds by which it may slip without a later makespan or a missed deadline.
      critical: it lies on the chain of tasks that takes the whole makespan.
    """

    links: tuple[Link, ...]
    slack: float
    critical: bool

    def __str__(self) -> str:
        reasons = list(dict.fromkeys(_reason(link) for link in self.links)) or [
            "could start earlier"
        ]
        free = (
            ", on the critical path"
            if self.critical
            else f", may slip by {number(self.slack)} s"
            if self.slack
            else ", cannot slip"
        )
        return " and ".join(reasons) + free

    def to_dict(self) -> dict[str, Any]:
        waits = [
            {"reason": link.reason, "by": link.by, "task": link.waited_for} for link in self.links
        ]
        return {"waits_for": waits, "slack": plain(self.slack), "critical": self.critical}


def waiting(cell: Cell, schedule: Schedule) -> Mapping[str, Waiting]:
    """Task -> what holds it. Assumes a sound schedule."""
    free = slack(cell, schedule)
    critical = {link.assignment.task for link in critical_path(cell, schedule)}
    held = links(cell, schedule)
    return {a.task: Waiting(held[a.task], free[a.task], a.task in critical) for a in schedule}


def _reason(link: Link) -> str:
    match link.reason:
        case "start":
            return "starts at the beginning"
        case "release":
            return f"starts at its release, {number(link.assignment.start)} s"
        case "predecessor":
            return f"waits for task {link.by}, its predecessor"
        case "operator":
            return f"waits for {link.by}, busy with {link.waited_for}"
        case "changeover":
            return f"waits for {link.by}, who changes tools after {link.waited_for}"
        case "tool" | "zone":
            return f"waits for {link.reason} {link.by}, held by {link.waited_for}"
        case "choice":
            return "could start earlier"
    return f"waits for the end of {link.by}'s {link.reason}"  # a time off
