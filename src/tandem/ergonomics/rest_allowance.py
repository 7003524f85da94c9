"""How long one must rest after work of a known power, or of a held force.

Sources: the balance of power as in Murrell (1965), read with its example at engineeringtoolbox.com;
its usual constants (5 and 1.5 kcal/min), Price (1990) Applied Ergonomics 21(1):63-70 and Rohmert's
formulas in the form of Niebel and Freivalds were recalled, and are marked so.
"""

from __future__ import annotations

from typing import Any, Self

from pydantic import model_validator

from tandem.ergonomics.facts import Facts, fact
from tandem.ergonomics.outcome import Outcome, Published, Reason, Step

METHOD = "rest_allowance"


class PowerFacts(Facts):
    """A stretch of work and its mean power, in one unit of power throughout (kcal/min or W)."""

    T_min: float = fact("stretch of work", "min", above=0, high=1440, cautious=480.0)
    W: float = fact("mean power of the work", "", 0, 3000)
    S: float = fact("power that can be kept up all day", "", above=0, high=3000, default=5.0)
    R: float = fact("power at rest", "", 0, 3000, default=1.5)

    @model_validator(mode="after")
    def _rest_is_easier(self) -> Self:
        if self.S <= self.R:
            raise ValueError(
                f"S is {self.S:g} and R {self.R:g}: what can be kept up all day must be more than"
                " the power at rest. Are both in the unit of W?"
            )
        if self.W > 30 and self.S == 5.0 and self.R == 1.5:
            raise ValueError(
                f"W is {self.W:g}, which is no power in kcal/min. State S and R in the unit of W,"
                " such as 350 and 100 W."
            )
        return self


class StaticFacts(Facts):
    """A force that is held."""

    f: float = fact("share of the greatest force", "", above=0, high=1)
    t_min: float = fact("how long it is held", "min", above=0, high=60)


class EnergyFacts(Facts):
    """Mean power of work."""

    E: float = fact("mean power", "kcal/min", 0, 30)


def rest(facts: PowerFacts) -> Outcome:
    """Minutes of rest: T (W - S) / (W - R), none below S."""
    over = facts.W - facts.S
    minutes = max(0.0, facts.T_min * over / (facts.W - facts.R)) if over > 0 else 0.0
    steps = (
        Step("W", facts.W, (Reason("power", facts.W),), weight=max(over, 0.0)),
        Step("rest_min", minutes, (Reason("rest_after", facts.T_min),)),
    )
    return Outcome(METHOD, minutes, int(minutes > 0), {"rest_min": minutes}, steps)


def static(facts: StaticFacts) -> dict[str, Any]:
    """Endurance and rest of a held force, after Rohmert; no limit up to 15 % of the greatest."""
    over = facts.f - 0.15
    if over <= 0:
        return {"T_min": None, "RA_percent": 0.0}
    endurance = 1.2 / over**0.618 - 1.21
    if endurance <= 0:
        return {"T_min": 0.0, "RA_percent": None}
    return {
        "T_min": endurance,
        "RA_percent": 1800 * (facts.t_min / endurance) ** 1.4 * over**0.5,
    }


def share(facts: EnergyFacts) -> dict[str, Any]:
    """Rest as a share of work: (E - 4.3) / (4.3 - 1.86), none below 4.3 kcal/min."""
    return {"RA": max(0.0, (facts.E - 4.3) / (4.3 - 1.86))}


FUNCTIONS: dict[str, Published] = {
    "rest_murrell": Published(rest, PowerFacts),
    "rohmert_niebel": Published(static, StaticFacts, unverified=True),
    "rest_price": Published(share, EnergyFacts, unverified=True),
}
"""The published steps that can be asked for alone."""
