"""REBA, the rapid entire body assessment: posture, load, grip and activity to a score of 1 to 15.

Source: Hignett S, McAtamney L (2000) Rapid Entire Body Assessment (REBA). Applied Ergonomics
31(2):201-205, tables A, B and C and figures 2 to 4. The score tables are facts that a journal
published; they are given here in our own words. A value exactly on a limit takes the lower band.
Twist and side flexion count together once, as in the paper; some worksheets count them twice.

The score never falls when a load, a worse grip or more activity is stated, nor when a flexion moves
away from the middle of its best band; the knee of a seated person is the exception, since only
standing on a knee bent over 60 degrees counts 2.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from tandem.ergonomics.facts import Facts, fact
from tandem.ergonomics.outcome import Band, Outcome, Published, Reason, Step, banded
from tandem.ergonomics.rula import lower_arm_band, part, upper_arm_band

METHOD = "reba"

# neck 1-3, trunk 1-5, legs 1-4 (table A of the paper)
TABLE_A = (
    ("1234", "2345", "2456", "3567", "4678"),
    ("1234", "3456", "4567", "5678", "6789"),
    ("3356", "4567", "5678", "6789", "7899"),
)
# upper arm 1-6, lower arm 1-2, wrist 1-3 (table B)
TABLE_B = (
    ("122", "123"),
    ("123", "234"),
    ("345", "455"),
    ("455", "567"),
    ("678", "788"),
    ("788", "899"),
)
# score A 1-12, score B 1-12 (table C)
TABLE_C = (
    (1, 1, 1, 2, 3, 3, 4, 5, 6, 7, 7, 7),
    (1, 2, 2, 3, 4, 4, 5, 6, 6, 7, 7, 8),
    (2, 3, 3, 3, 4, 5, 6, 7, 7, 8, 8, 8),
    (3, 4, 4, 4, 5, 6, 7, 8, 8, 9, 9, 9),
    (4, 4, 4, 5, 6, 7, 8, 8, 9, 9, 9, 9),
    (6, 6, 6, 7, 8, 8, 9, 9, 10, 10, 10, 10),
    (7, 7, 7, 8, 9, 9, 9, 10, 10, 11, 11, 11),
    (8, 8, 8, 9, 10, 10, 10, 10, 10, 11, 11, 11),
    (9, 9, 9, 10, 10, 10, 11, 11, 11, 12, 12, 12),
    (10, 10, 10, 11, 11, 11, 11, 12, 12, 12, 12, 12),
    (11, 11, 11, 11, 12, 12, 12, 12, 12, 12, 12, 12),
    (12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 12),
)
ACTION = (1, 3, 7, 10)
"""The highest scores of action levels 0 to 3."""
COUPLING = {"good": 0, "fair": 1, "poor": 2, "unacceptable": 3}

Coupling = Literal["good", "fair", "poor", "unacceptable"]
Score = Annotated[int, Field(ge=1)]


class RebaFacts(Facts):
    """A posture of the whole body, one side's arm, and what is held. Angles in degrees, flexion
    positive, extension negative; loads in kg.
    """

    neck_flexion_deg: float = fact(
        "neck against the trunk, flexion positive", "deg", -70, 90, cautious=21.0
    )
    trunk_flexion_deg: float = fact(
        "trunk against the vertical, flexion positive", "deg", -45, 150, cautious=61.0
    )
    upper_arm_flexion_deg: float = fact(
        "upper arm against the trunk, flexion positive", "deg", -90, 180, cautious=91.0
    )
    lower_arm_flexion_deg: float = fact("flexion of the elbow", "deg", 0, 160, cautious=101.0)
    wrist_flexion_deg: float = fact(
        "wrist, flexion positive, extension negative", "deg", -90, 90, cautious=16.0
    )
    knee_flexion_deg: float = fact(
        "flexion of the knees", "deg", 0, 160, default=0.0, cautious=61.0, asked=True
    )
    load_kg: float = fact(
        "load or force, as kg", "kg", 0, 100, default=0.0, cautious=10.1, asked=True
    )
    coupling: Coupling = fact(
        "grip: good, fair, poor or unacceptable", default="good", cautious="poor", asked=True
    )
    neck_twist_or_side: bool = fact(
        "the neck is twisted or bent to a side", default=False, cautious=True
    )
    trunk_twist_or_side: bool = fact(
        "the trunk is twisted or bent to a side", default=False, cautious=True
    )
    unilateral_or_unstable: bool = fact(
        "the weight is on one leg, or the posture unstable", default=False, cautious=True
    )
    sitting: bool = fact("seated", default=False, cautious=False)
    arm_abducted_or_rotated: bool = fact(
        "the upper arm is abducted or rotated", default=False, cautious=True
    )
    shoulder_raised: bool = fact("the shoulder is raised", default=False, cautious=True)
    arm_supported_or_gravity_assisted: bool = fact(
        "leaning, the arm supported or helped by gravity", default=False, cautious=False
    )
    wrist_deviated_or_twisted: bool = fact(
        "the wrist is deviated or twisted", default=False, cautious=True
    )
    shock: bool = fact("shock or rapid build-up of force", default=False, cautious=True)
    static: bool = fact("body parts held longer than 1 min", default=False, cautious=True)
    repeats_per_min: float = fact(
        "repetitions of small range", "1/min", 0, 300, default=0.0, cautious=5.0
    )
    rapid_large_changes: bool = fact(
        "rapid large changes of posture, or an unstable base", default=False, cautious=True
    )


# --- published steps ------------------------------------------------------------------------------


def table_a(
    *,
    neck: Annotated[int, Field(ge=1, le=3)],
    trunk: Annotated[int, Field(ge=1, le=5)],
    legs: Annotated[int, Field(ge=1, le=4)],
) -> int:
    """Posture score A of neck, trunk and legs (table A)."""
    return int(TABLE_A[neck - 1][trunk - 1][legs - 1])


def table_b(
    *,
    upper_arm: Annotated[int, Field(ge=1, le=6)],
    lower_arm: Annotated[int, Field(ge=1, le=2)],
    wrist: Annotated[int, Field(ge=1, le=3)],
) -> int:
    """Posture score B of upper arm, lower arm and wrist (table B)."""
    return int(TABLE_B[upper_arm - 1][lower_arm - 1][wrist - 1])


def table_c(*, a: Score, b: Score) -> int:
    """Score C of scores A and B (table C), which counts 12 for more."""
    return TABLE_C[min(a, 12) - 1][min(b, 12) - 1]


def score_a(
    *,
    neck: Annotated[int, Field(ge=1, le=3)],
    trunk: Annotated[int, Field(ge=1, le=5)],
    legs: Annotated[int, Field(ge=1, le=4)],
    load: Annotated[int, Field(ge=0, le=3)] = 0,
) -> dict[str, int]:
    """Posture score A and, with the load score, score A."""
    posture = table_a(neck=neck, trunk=trunk, legs=legs)
    return {"posture_a": posture, "score_a": posture + load}


def score_b(
    *,
    upper_arm: Annotated[int, Field(ge=1, le=6)],
    lower_arm: Annotated[int, Field(ge=1, le=2)],
    wrist: Annotated[int, Field(ge=1, le=3)],
    coupling: Annotated[int, Field(ge=0, le=3)] = 0,
) -> dict[str, int]:
    """Posture score B and, with the coupling score, score B."""
    posture = table_b(upper_arm=upper_arm, lower_arm=lower_arm, wrist=wrist)
    return {"posture_b": posture, "score_b": posture + coupling}


def score(
    *,
    neck: Annotated[int, Field(ge=1, le=3)],
    trunk: Annotated[int, Field(ge=1, le=5)],
    legs: Annotated[int, Field(ge=1, le=4)],
    upper_arm: Annotated[int, Field(ge=1, le=6)],
    lower_arm: Annotated[int, Field(ge=1, le=2)],
    wrist: Annotated[int, Field(ge=1, le=3)],
    load: Annotated[int, Field(ge=0, le=3)] = 0,
    coupling: Annotated[int, Field(ge=0, le=3)] = 0,
    activity: Annotated[int, Field(ge=0, le=3)] = 0,
) -> dict[str, int]:
    """REBA of component scores: A and B by their tables, C of both, and activity on top."""
    a = score_a(neck=neck, trunk=trunk, legs=legs, load=load)
    b = score_b(upper_arm=upper_arm, lower_arm=lower_arm, wrist=wrist, coupling=coupling)
    c = table_c(a=a["score_a"], b=b["score_b"])
    reba = c + activity
    return {**a, **b, "score_c": c, "reba": reba, "action_level": action_level(reba)}


def action_level(reba: int) -> int:
    """Action level 0 to 4 of a score of 1 to 15 (table 4)."""
    return banded(reba, ACTION)


# --- from facts to a score ------------------------------------------------------------------------


def _neck(angle: float) -> Reason:
    if angle < 0:
        return Reason("extended", -angle, (0, None), 2)
    points = 1 + (angle > 20)
    return Reason(
        "flexed", angle, (0, 20) if angle <= 20 else (20, None), points, neutral=points == 1
    )


def _trunk(angle: float) -> Reason:
    if angle == 0:
        return Reason("upright", 0, None, 1, neutral=True)
    if angle < 0:
        return Reason(
            "extended", -angle, (0, 20) if angle >= -20 else (20, None), 2 + (angle < -20)
        )
    points = 2 + banded(angle, (20, 60))
    band: Band = ((0, 20), (20, 60), (60, None))[points - 2]
    return Reason("flexed", angle, band, points)


def _legs(f: RebaFacts) -> Step:
    base = (
        Reason("legs_unstable", None, None, 2)
        if f.unilateral_or_unstable
        else Reason("legs_both", None, None, 1, neutral=True)
    )
    knee = f.knee_flexion_deg
    more: tuple[Reason, ...] = ()
    if knee > 60 and not f.sitting:
        more = (Reason("knee_bent", knee, (60, None), 2, added=True),)
    elif 30 < knee <= 60:
        more = (Reason("knee_bent", knee, (30, 60), 1, added=True),)
    value = int(base.points or 0) + sum(int(reason.points or 0) for reason in more)
    return Step("legs", value, (base, *more), weight=value - 1)


def _wrist(angle: float) -> Reason:
    points = 1 + (abs(angle) > 15)
    band: Band = (0, 15) if points == 1 else (15, None)
    return Reason(
        "extended" if angle < 0 else "flexed", abs(angle), band, points, neutral=points == 1
    )


def _load(f: RebaFacts) -> Step:
    points = (f.load_kg >= 5) + (f.load_kg > 10)
    band: Band = ((0, 5), (5, 10), (10, None))[points]
    base = Reason("load", f.load_kg, band, points, neutral=points == 0)
    more = (Reason("shock_added", None, None, 1, added=True),) if f.shock else ()
    return Step("load", points + f.shock, (base, *more), weight=points + f.shock)


def _activity(f: RebaFacts) -> Step:
    found = [
        Reason(key, amount, None, 1, added=True)
        for key, amount, holds in (
            ("held", None, f.static),
            ("repeated", f.repeats_per_min, f.repeats_per_min > 4),
            ("rapid_changes", None, f.rapid_large_changes),
        )
        if holds
    ]
    none = (Reason("neither_held_nor_repeated", None, None, 0, neutral=True),)
    return Step("activity", len(found), tuple(found) or none, weight=len(found))


def assess(facts: RebaFacts) -> Outcome:
    """REBA 1 to 15 of one side, its action level, and every step."""
    f = facts
    neck = part(
        "neck", 1, 3, _neck(f.neck_flexion_deg), {"twisted_or_side": (f.neck_twist_or_side, 1)}
    )
    trunk = part(
        "trunk", 1, 5, _trunk(f.trunk_flexion_deg), {"twisted_or_side": (f.trunk_twist_or_side, 1)}
    )
    legs, load, activity = _legs(f), _load(f), _activity(f)
    upper_arm = part(
        "upper_arm", 1, 6, upper_arm_band(f.upper_arm_flexion_deg),
        {
            "abducted_or_rotated": (f.arm_abducted_or_rotated, 1),
            "shoulder_raised": (f.shoulder_raised, 1),
            "arm_supported": (f.arm_supported_or_gravity_assisted, -1),
        },
    )  # fmt: skip
    lower_arm = part("lower_arm", 1, 2, lower_arm_band(f.lower_arm_flexion_deg), {})
    wrist = part(
        "wrist", 1, 3, _wrist(f.wrist_flexion_deg),
        {"deviated_or_twisted": (f.wrist_deviated_or_twisted, 1)},
    )  # fmt: skip
    grip = COUPLING[f.coupling]
    coupling = Step(
        "coupling",
        grip,
        (Reason(f"coupling_{f.coupling}", None, None, grip, neutral=grip == 0),),
        weight=grip,
    )
    scores = {
        step.part: int(step.value or 0)
        for step in (neck, trunk, legs, upper_arm, lower_arm, wrist, load, coupling, activity)
    }
    found = score(**scores)
    level = found["action_level"]
    outputs: dict[str, Any] = {**scores, **found}
    steps = (
        neck, trunk, legs,
        Step("posture_a", found["posture_a"], (Reason("table", "A"),)),
        load,
        Step("score_a", found["score_a"], (Reason("sum", f"{found['posture_a']} + {load.value}"),)),
        upper_arm, lower_arm, wrist,
        Step("posture_b", found["posture_b"], (Reason("table", "B"),)),
        coupling,
        Step("score_b", found["score_b"], (Reason("sum", f"{found['posture_b']} + {grip}"),)),
        Step("score_c", found["score_c"], (Reason("table", "C"),)),
        activity,
        Step("reba", found["reba"], (Reason("sum", f"{found['score_c']} + {activity.value}"),)),
    )  # fmt: skip
    return Outcome(METHOD, found["reba"], level, outputs, steps)


FUNCTIONS = {
    "reba_from_angles": Published(assess, RebaFacts),
    "reba_score": Published(score),
    "reba_a": Published(score_a),
    "reba_b": Published(score_b),
}
"""The published steps that can be asked for alone."""
