"""Why a task starts when it does: what it waited for, and how far it could slip."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from tandem.cell.model import Cell, plain
from tandem.explain.language import Words, words
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
        return self.sentence()

    def sentence(self, language: str = "en") -> str:
        """Every reason, and whether the task may slip."""
        t = words(language)
        reasons = list(dict.fromkeys(_reason(link, t) for link in self.links))
        said = t("wait.choice")
        for place, reason in enumerate(reasons):
            said = t("and", first=said, last=reason) if place else reason
        key = "critical" if self.critical else "slack" if self.slack else "fixed"
        return t(f"wait.{key}", reasons=said, seconds=t.seconds(self.slack))

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


def _reason(link: Link, t: Words) -> str:
    return t(
        f"wait.{link.reason}",
        by=link.by,
        task=link.waited_for,
        start=t.seconds(link.assignment.start),
    )
