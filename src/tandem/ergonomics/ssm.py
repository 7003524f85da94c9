"""How far apart a person and a moving robot must be: speed and separation monitoring.

    S_p = S_h + S_r + S_s + C + Z_d + Z_r,    S_h = v_h (T_r + T_s),    S_r = v_r T_r

Source: ISO/TS 15066:2016 clause 5.5.4, now ISO 10218-2:2025. The standards were not read; the sum
was, as equation 2 of a paper (scitepress.org/PublishedPapers/2020/94464), with 1.6 m/s for a person
who walks and 2 m/s for a hand at less than 0.5 m, after ISO 13855; so were ISO 13855's S = K T + C
and its values of K (gt-engineering.it).

Advice for laying out work, and no safety function: whoever builds the cell judges its risks.
"""

from __future__ import annotations

from typing import Any

from tandem.ergonomics.facts import Facts, fact
from tandem.ergonomics.outcome import Published

METHOD = "ssm"
CLOSE_M, HAND = 0.5, 2.0
"""Below this distance ISO 13855 counts with the speed of a hand, m/s."""


class SeparationFacts(Facts):
    """A person, and a robot that moves towards them and stops."""

    v_h: float = fact("speed of the person", "m/s", above=0, high=5, default=1.6, cautious=2.0)
    v_r: float = fact("speed of the robot towards the person", "m/s", 0, 10, cautious=1.0)
    T_r: float = fact("until the robot begins to stop", "s", 0, 5, cautious=0.2)
    T_s: float = fact("that the robot takes to stop", "s", 0, 10, cautious=0.5)
    S_s: float = fact("way that the robot takes to stop", "m", 0, 10, cautious=0.5)
    C: float = fact("reach of a body part before it is seen", "m", 0, 2, cautious=0.85)
    Z_d: float = fact("doubt where the person is", "m", 0, 2, cautious=0.2)
    Z_r: float = fact("doubt where the robot is", "m", 0, 2, cautious=0.05)


class DistanceFacts(SeparationFacts):
    """The same, and how far the two are from each other."""

    distance: float = fact("between person and robot", "m", 0, 100, cautious=0.0)


class StopFacts(Facts):
    """A protective device before a machine that stops, in one unit of length throughout."""

    K: float = fact("speed of approach, a unit of length a second", "", above=0, high=10_000)
    T_s: float = fact("until the machine has stopped", "s", 0, 60)
    C: float = fact("intrusion before the device sees it", "", 0, 10_000)


def separation(facts: SeparationFacts) -> dict[str, Any]:
    """The protective separation distance in metres, and each of its terms."""
    terms = {
        "S_h": facts.v_h * (facts.T_r + facts.T_s),
        "S_r": facts.v_r * facts.T_r,
        "S_s": facts.S_s,
        "C": facts.C,
        "Z_d": facts.Z_d,
        "Z_r": facts.Z_r,
    }
    return {**terms, "S_p": sum(terms.values())}


def slowed(facts: DistanceFacts) -> dict[str, Any]:
    """The speed at which the distance is just enough, and how much longer motions take then.

    The stopping way is taken in proportion to the speed, and the stopping time as it is at full
    speed. Brakes of constant force do better (a way in proportion to the speed squared), so that
    the answer is rather too slow.

    Returns:
      `S_p` at full speed, `S_0` of a robot that stands still, `v_max` in m/s and `factor`: 1 where
      the distance is enough at full speed, None (and `v_max` 0) where it is not even at a
      standstill.
    """
    found = separation(facts)
    moving = found["S_r"] + found["S_s"]
    still = found["S_p"] - moving
    answer = {"S_p": found["S_p"], "S_0": still}
    if facts.distance >= found["S_p"]:
        return {**answer, "v_max": facts.v_r, "factor": 1.0}
    if facts.distance <= still or moving <= 0:
        return {**answer, "v_max": 0.0, "factor": None}
    share = (facts.distance - still) / moving
    return {**answer, "v_max": facts.v_r * share, "factor": 1 / share}


def device(facts: StopFacts) -> dict[str, Any]:
    """The distance of a protective device by ISO 13855: K T + C."""
    return {"S": facts.K * facts.T_s + facts.C}


FUNCTIONS: dict[str, Published] = {
    "ssm_sp": Published(separation, SeparationFacts),
    "ssm_slowed": Published(slowed, DistanceFacts),
    "iso13855": Published(device, StopFacts),
}
"""The published steps that can be asked for alone; `ssm_slowed` is ours."""
