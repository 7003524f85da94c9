"""The OCRA index and the sum of the OCRA checklist, from multipliers that the user states.

    ATA = sum 60 n / cycle t,  RTA = sum 30 FoM PoM ReM AdM t, times RcM DuM,  index = ATA / RTA

Source: Occhipinti E (1998) Ergonomics 41(9):1290-1311; ISO 11228-3:2007. The structure was read;
the tables of multipliers and the zones were recalled, so that no table is shipped and every answer
is marked as unverified.
"""

from __future__ import annotations

import math
from typing import Any

from tandem.ergonomics.facts import Facts, Several, fact
from tandem.ergonomics.outcome import Published, banded

METHOD = "ocra"
ZONES = ("green", "yellow", "red")
CHECKLIST_ZONES = ("green", "yellow", "light_red", "medium_red", "violet")


class Repeated(Facts):
    """One repetitive task of a limb, with its multipliers."""

    actions_per_cycle: float = fact("technical actions per cycle", "", above=0, high=500)
    cycle_s: float = fact("cycle", "s", above=0, high=3600)
    minutes: float = fact("net repetitive minutes", "min", above=0, high=1440)
    FoM: float = fact("force multiplier", "", above=0, high=1)
    PoM: float = fact("posture multiplier", "", above=0, high=1)
    ReM: float = fact("repetitiveness multiplier", "", above=0, high=1)
    AdM: float = fact("additional multiplier", "", above=0, high=1)


class IndexFacts(Facts):
    """The repetitive tasks of a day and what holds for all of it."""

    tasks: Several[Repeated]
    RcM: float = fact("recovery multiplier", "", above=0, high=1)
    DuM: float = fact("duration multiplier", "", above=0, high=2)


class ChecklistFacts(Facts):
    """Scores and multipliers of the checklist."""

    recovery_multiplier: float = fact("recovery multiplier", "", 1, 2)
    frequency: float = fact("frequency score", "", 0, 10)
    force: float = fact("force score", "", 0, 32)
    posture: float = fact("posture score", "", 0, 14)
    additional: float = fact("additional score", "", 0, 10)
    duration_multiplier: float = fact("duration multiplier", "", above=0, high=2)


def index(facts: IndexFacts) -> dict[str, Any]:
    """Actual and recommended technical actions, their ratio, and its zone."""
    actual = math.fsum(60 * t.actions_per_cycle / t.cycle_s * t.minutes for t in facts.tasks)
    each = (30 * t.FoM * t.PoM * t.ReM * t.AdM * t.minutes for t in facts.tasks)
    recommended = math.fsum(each) * facts.RcM * facts.DuM
    ratio = actual / recommended
    zone = ZONES[banded(ratio, (2.2, 3.5))]
    return {"ATA": actual, "RTA": recommended, "index": ratio, "zone": zone}


def checklist(facts: ChecklistFacts) -> dict[str, Any]:
    """The scores added, times recovery and duration, and the zone of that."""
    f = facts
    total = (
        (f.frequency + f.force + f.posture + f.additional)
        * f.recovery_multiplier
        * f.duration_multiplier
    )
    return {"score": total, "zone": CHECKLIST_ZONES[banded(total, (7.5, 11, 14, 22.5))]}


FUNCTIONS: dict[str, Published] = {
    "ocra_index": Published(index, IndexFacts, unverified=True),
    "ocra_checklist": Published(checklist, ChecklistFacts, unverified=True),
}
"""The published steps that can be asked for alone."""
