"""Small cells whose shifts a person can follow, and deciders that need no explanation."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import Any

from tandem.dispatch.deciders.policy import Decision
from tandem.dispatch.shift.deadline import InTime, plainly
from tandem.dispatch.situation.model import Situation
from tandem.files.validate import cell_of

GEARBOX = cell_of(
    {
        "name": "Small gearbox",
        "operators": {"cobot": {"kind": "robot"}, "anna": {"kind": "human"}},
        "tasks": {
            "base": {"time": {"cobot": 4, "anna": 6}, "stress": 3},
            "shaft": {"time": {"anna": 5}, "stress": 1, "after": ["base"]},
            "gear": {"time": {"cobot": 3}, "after": ["base"]},
            "cover": {
                "time": {"anna": 4},
                "together": [{"operators": ["cobot", "anna"], "time": 2, "stress": 1}],
                "after": ["shaft", "gear"],
            },
        },
    }
)
"""base, then shaft and gear side by side, then the cover."""


@dataclass(frozen=True)
class Plain:
    """Takes the first that is allowed."""

    name: str = "plain"

    def decide(self, situation: Situation) -> Decision:
        return plainly(situation)


@dataclass
class Saying:
    """Says what it is made to say; an exception is raised. Counts how often it was asked."""

    says: Decision | Exception
    name: str = "saying"
    asked: list[Situation] = field(default_factory=list)

    def decide(self, situation: Situation) -> Decision:
        self.asked.append(situation)
        if isinstance(self.says, Exception):
            raise self.says
        return self.says


def in_time(policy: Any = Plain(), budget_ms: float = 1000.0) -> InTime:
    """The decider with a rule that needs nothing, and time enough."""
    return InTime(policy, Plain("rule"), budget_ms)


def line(event: str, at: float, **rest: Any) -> str:
    """An event as a line of JSON."""
    return json.dumps({"event": event, "at": at, **rest})
