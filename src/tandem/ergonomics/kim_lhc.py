"""The key indicator method for lifting, holding and carrying: points times a rating of time.

Source: BAuA and LASI, KIM-LHC 2001 (LV 9), and BAuA, KIM-LHC 2019; forms free on baua.de. Time
ratings and women's loads of 2001 were read, men's loads were recalled, so that every answer is
marked as unverified. Of 2019 only the total is computed, from points that the user states.
"""

from __future__ import annotations

from typing import Any, Literal

from tandem.ergonomics.facts import Facts, fact
from tandem.ergonomics.outcome import Published

METHOD = "kim_lhc"
TIMES = ((10, 1), (40, 2), (200, 4), (500, 6), (1000, 8))
"""Lifts a day below which a time rating holds; 10 above."""
LOADS = {
    "male": ((10, 1), (20, 2), (30, 4), (40, 7)),
    "female": ((5, 1), (10, 2), (15, 4), (25, 7)),
}
"""Loads in kg below which a load rating holds; 25 above."""


class Facts2001(Facts):
    """Lifts of one kind, 2001."""

    n_lifts: float = fact("lifts a day", "1/day", 0, 10_000)
    load_kg: float = fact("load", "kg", 0, 200)
    sex: Literal["male", "female"] = fact("whose load classes")
    posture: Literal[1, 2, 4, 8] = fact("posture rating: 1, 2, 4 or 8")
    conditions: Literal[0, 1, 2] = fact("rating of conditions: 0, 1 or 2")


class Facts2019(Facts):
    """Points and time rating, 2019."""

    rating_points_sum: float = fact("sum of all points", "", 0, 200)
    time_rating: float = fact("time rating", "", 1, 10)


def _below(value: float, table: tuple[tuple[int, int], ...], otherwise: int) -> int:
    return next((rating for limit, rating in table if value < limit), otherwise)


def by_2001(facts: Facts2001) -> dict[str, Any]:
    """Time rating by the sum of load, posture and conditions, and the range of risk."""
    time = _below(facts.n_lifts, TIMES, 10)
    load = _below(facts.load_kg, LOADS[facts.sex], 25)
    score = time * (load + facts.posture + facts.conditions)
    risk = 1 + (score >= 10) + (score >= 25) + (score >= 50)
    return {"time_rating": time, "load_rating": load, "score": score, "risk_range": risk}


def total_2019(facts: Facts2019) -> dict[str, Any]:
    """Points by the time rating, and the category of risk."""
    score = facts.rating_points_sum * facts.time_rating
    category = 1 + (score >= 20) + (score >= 50) + (score >= 100)
    return {"score": score, "risk_category": category}


FUNCTIONS: dict[str, Published] = {
    "kim_lhc_2001": Published(by_2001, Facts2001, unverified=True),
    "kim_lhc_2019_total": Published(total_2019, Facts2019, unverified=True),
}
"""The published steps that can be asked for alone."""
