"""The Strain Index of 1995: six rated properties of a task of one hand, as a product.

    SI = IE DE EM HWP SW DD

Source: Moore JS, Garg A (1995) The Strain Index. American Industrial Hygiene Association Journal
56(5):443-458, tables 1 to 3. `rsi` is its revision, and prefers measures to classes. The index
never falls with intensity, share of the cycle, efforts, speed or hours.
"""

from __future__ import annotations

import math
from typing import Literal

from tandem.ergonomics.facts import Facts, fact
from tandem.ergonomics.outcome import Outcome, Published, Reason, Step

METHOD = "strain_index_1995"
INTENSITY = {
    "light": 1.0,
    "somewhat_hard": 3.0,
    "hard": 6.0,
    "very_hard": 9.0,
    "near_maximal": 13.0,
}
POSTURE = {"very_good": 1.0, "good": 1.0, "fair": 1.5, "bad": 2.0, "very_bad": 3.0}
SPEED = {"very_slow": 1.0, "slow": 1.0, "fair": 1.0, "fast": 1.5, "very_fast": 2.0}
DURATION = ((10, 0.5), (30, 1.0), (50, 1.5), (80, 2.0), (math.inf, 3.0))
"""Per cent of the cycle below which a multiplier holds."""
EFFORTS = ((4, 0.5), (9, 1.0), (15, 1.5), (20, 2.0), (math.inf, 3.0))
"""Efforts per minute below which a multiplier holds; classes of whole numbers in the source."""
HOURS = ((1, 0.25), (2, 0.5), (4, 0.75), (8, 1.0), (math.inf, 1.5))
"""Hours a day up to which a multiplier holds."""


class Si1995Facts(Facts):
    """A task of one hand, by the classes of the scoring sheet."""

    borg_level: Literal["light", "somewhat_hard", "hard", "very_hard", "near_maximal"] = fact(
        "intensity of exertion", cautious="very_hard"
    )
    percent_duration: float = fact("exertion, % of the cycle", "%", 0, 100, cautious=80.0)
    efforts_per_min: float = fact("efforts per minute", "1/min", 0, 300, cautious=20.0)
    posture: Literal["very_good", "good", "fair", "bad", "very_bad"] = fact(
        "posture of hand and wrist", cautious="bad"
    )
    speed: Literal["very_slow", "slow", "fair", "fast", "very_fast"] = fact(
        "speed of work", cautious="fast"
    )
    hours: float = fact("hours a day", "h", above=0, high=24, cautious=8.0)


class Multipliers(Facts):
    """The six multipliers themselves."""

    IE: float = fact("intensity", "", above=0, high=13)
    DE: float = fact("duration of exertion", "", above=0, high=3)
    EM: float = fact("efforts per minute", "", above=0, high=3)
    HWP: float = fact("posture of hand and wrist", "", 1, 3)
    SW: float = fact("speed of work", "", 1, 2)
    DD: float = fact("duration per day", "", above=0, high=1.5)


def _below(value: float, table: tuple[tuple[float, float], ...]) -> float:
    return next(multiplier for limit, multiplier in table if value < limit)


def product(facts: Multipliers) -> Outcome:
    """The index of the six multipliers."""
    return _outcome(dict(facts), dict(facts))


def _outcome(found: dict[str, float], given: dict[str, float | str]) -> Outcome:
    index = math.prod(found.values())
    steps = [
        Step(
            f"si_{name}",
            value,
            (Reason(f"si_{name}", given[name], neutral=value <= 1),),
            weight=max(math.log(value), 0.0),
        )
        for name, value in found.items()
    ]
    steps.append(Step("SI", index, (Reason("product"),)))
    level = (index > 3) + (index >= 7)
    return Outcome(METHOD, index, level, {**found, "SI": index}, tuple(steps))


def assess(facts: Si1995Facts) -> Outcome:
    """The index of classes and measures."""
    f = facts
    given: dict[str, float | str] = {
        "IE": f.borg_level, "DE": f.percent_duration, "EM": f.efforts_per_min,
        "HWP": f.posture, "SW": f.speed, "DD": f.hours,
    }  # fmt: skip
    found = {
        "IE": INTENSITY[f.borg_level],
        "DE": _below(f.percent_duration, DURATION),
        "EM": _below(f.efforts_per_min, EFFORTS),
        "HWP": POSTURE[f.posture],
        "SW": SPEED[f.speed],
        "DD": next(multiplier for limit, multiplier in HOURS if f.hours <= limit),
    }
    return _outcome(found, given)


FUNCTIONS: dict[str, Published] = {
    "si1995": Published(product, Multipliers),
    "si1995_from_measures": Published(assess, Si1995Facts),
}
"""The published steps that can be asked for alone."""
