"""Hand activity level and the threshold limit of normalised peak force.

    HAL = 6.56 ln(D) F^1.31 / (1 + 3.18 F^1.31)

Source: Radwin RG et al. (2015) A frequency-duty cycle equation for the ACGIH hand activity level.
Ergonomics 58(2):173-183; limit lines of 2001: worksheet of Bernard (2002), NPF/(10 - HAL) of 0.56
and 0.78; doses of several tasks: Armstrong et al. (ICOH 2012). The lines of 2018 were recalled, and
are marked so. For work of one kind of 4 h and more.
"""

from __future__ import annotations

import math
from typing import Any, Self

from pydantic import model_validator

from tandem.ergonomics.facts import Facts, Several, fact
from tandem.ergonomics.outcome import Outcome, Published, Reason, Step

METHOD = "hal_tlv"
ACTION_LIMIT, THRESHOLD = 0.56, 0.78
LEVELS = ("below_AL", "AL_to_TLV", "above_TLV")


class RateFacts(Facts):
    """How often a hand exerts itself, and for what share of the time."""

    F_hz: float = fact("exertions per second", "1/s", above=0, high=5)
    duty_pct: float = fact("duty cycle, work of work and recovery", "%", 1, 100)


class HalFacts(Facts):
    """A task of a hand: peak force, and activity as observed or from rate and duty cycle."""

    npf: float = fact(
        "normalised peak force 0 to 10 (% of the greatest / 10)", "", 0, 10, cautious=7.0
    )
    hal: float | None = fact("hand activity level, observed", "", 0, 10, default=None)
    F_hz: float | None = fact("exertions per second", "1/s", above=0, high=5, default=None)
    duty_pct: float | None = fact("duty cycle", "%", 1, 100, default=None)

    @model_validator(mode="after")
    def _activity(self) -> Self:
        if self.hal is None and None in (self.F_hz, self.duty_pct):
            raise ValueError(
                "hal is missing, and so is F_hz or duty_pct, from which it follows. State hal (0 to"
                " 10; a cautious value would be 8), or F_hz and duty_pct."
            )
        return self


class ObservedFacts(Facts):
    """Peak force and hand activity level."""

    npf: float = fact("normalised peak force", "", 0, 10)
    hal: float = fact("hand activity level", "", 0, 10)


class Shared(ObservedFacts):
    """One of several tasks of a day."""

    hal: float = fact("hand activity level", "", 0, 9.99)
    hours: float = fact("hours a day", "h", 0, 24)


class DoseFacts(Facts):
    """The tasks of a day."""

    tasks: Several[Shared]


def activity_level(facts: RateFacts) -> dict[str, Any]:
    """HAL of frequency and duty cycle."""
    power = facts.F_hz**1.31
    return {"HAL": 6.56 * math.log(facts.duty_pct) * power / (1 + 3.18 * power)}


def by_2001(facts: ObservedFacts) -> Outcome:
    """Peak force over 10 - HAL, and where that lies between action limit and threshold."""
    room = 10 - facts.hal
    ratio = facts.npf / room if room > 0 else math.inf
    level = (ratio >= ACTION_LIMIT) + (ratio >= THRESHOLD)
    shown = ratio if math.isfinite(ratio) else None
    steps = (
        Step("HAL", facts.hal, (Reason("hal", facts.hal),), weight=facts.hal),
        Step("NPF", facts.npf, (Reason("npf", facts.npf),), weight=facts.npf),
        Step("ratio", shown, (Reason("npf_over_room", room),)),
    )
    outputs = {"HAL": facts.hal, "ratio": shown, "level": LEVELS[level]}
    return Outcome(METHOD, shown, level, outputs, steps)


def by_2018(facts: ObservedFacts) -> dict[str, Any]:
    """The lines of 2018, recalled: limits of the peak force that fall with HAL."""
    action, threshold = 3.6 - 0.56 * facts.hal, 5.6 - 0.56 * facts.hal
    level = (facts.npf > action) + (facts.npf > threshold)
    index = facts.npf / threshold if threshold > 0 else None
    return {"AL": action, "TLV": threshold, "PFI": index, "level": LEVELS[level]}


def dose(facts: DoseFacts) -> dict[str, Any]:
    """The sum of each task's force over its limit of 2001, by hours of 4; 1 is the limit."""
    return {
        "dose": math.fsum(
            task.npf / (THRESHOLD * (10 - task.hal)) * task.hours / 4 for task in facts.tasks
        )
    }


def assess(facts: HalFacts) -> Outcome:
    """The ratio of 2001; HAL as observed, else from frequency and duty cycle."""
    hal = facts.hal
    if hal is None:
        rate = RateFacts.model_validate({"F_hz": facts.F_hz, "duty_pct": facts.duty_pct})
        hal = min(max(float(activity_level(rate)["HAL"]), 0.0), 10.0)
    return by_2001(ObservedFacts(npf=facts.npf, hal=hal))


FUNCTIONS: dict[str, Published] = {
    "hal": Published(activity_level, RateFacts),
    "hal_2001": Published(by_2001, ObservedFacts),
    "hal_2018": Published(by_2018, ObservedFacts, unverified=True),
    "hal_dose": Published(dose, DoseFacts),
    "hal_task": Published(assess, HalFacts),
}
"""The published steps that can be asked for alone."""
