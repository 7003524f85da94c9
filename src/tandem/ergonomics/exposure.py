"""What scores of tasks say of a shift. Ordinal scores are never added: a peak, minutes above a
level, and a time-weighted mean that is a heuristic and said to be one.

Source: our own synthesis of how the authors of the methods use them.
"""

from __future__ import annotations

import math
from typing import Any

from tandem.ergonomics.facts import Facts, Several, fact
from tandem.ergonomics.outcome import Published

METHOD = "exposure_aggregation"
LEVELS = (4, 5, 8)


class Scored(Facts):
    """A score of an ordinal method, and how long it lasts a shift."""

    score: float = fact("score of one method", "", 0, 100)
    minutes: float = fact("minutes a shift", "min", 0, 1440)


class ScoresFacts(Facts):
    """The scores of a shift, all of one method."""

    tasks: Several[Scored]


def over_a_shift(facts: ScoresFacts) -> dict[str, Any]:
    """Time-weighted mean, peak, and minutes at or above scores of 4, 5 and 8."""
    minutes = math.fsum(task.minutes for task in facts.tasks)
    weighted = math.fsum(task.score * task.minutes for task in facts.tasks)
    return {
        "TWA": weighted / minutes if minutes > 0 else None,
        "peak": max(task.score for task in facts.tasks),
        "minutes_at_or_above": {
            str(level): math.fsum(task.minutes for task in facts.tasks if task.score >= level)
            for level in LEVELS
        },
    }


FUNCTIONS: dict[str, Published] = {"twa": Published(over_a_shift, ScoresFacts)}
"""The published steps that can be asked for alone."""
