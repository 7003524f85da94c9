"""RULA, the rapid upper limb assessment: postures of arm, wrist, neck and trunk to a score 1 to 7.

Source: McAtamney L, Corlett EN (1993) RULA: a survey method for the investigation of work-related
upper limb disorders. Applied Ergonomics 24(2):91-99, tables 1 to 3. The score tables are facts that
a journal published; they are given here in our own words. The paper does not say what a value
exactly on a limit of two bands takes: the lower, less severe one. Extension of the trunk is not
defined in the paper and counts as upright, 1.

The score never falls when a load or a repetition rises, nor when a flexion moves away from the
middle of its best band. It falls where a wrong sign would make it seem so: leaning on the arm, or a
supported seat, takes a point away.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Field

from tandem.ergonomics.facts import Facts, fact
from tandem.ergonomics.outcome import Band, Outcome, Published, Reason, Step, banded

METHOD = "rula"

# upper arm 1-6, lower arm 1-3, then wrist 1-4 by twist 1-2 in one row (table 1 of the paper)
TABLE_A = (
    ("12222333", "22223333", "23333344"),
    ("23333444", "33333444", "34444455"),
    ("33444455", "34444455", "44444555"),
    ("44444555", "44444555", "44455566"),
    ("55555667", "56666777", "66677778"),
    ("77777889", "88888999", "99999999"),
)
# neck 1-6, then trunk 1-6 by legs 1-2 in one row (table 2)
TABLE_B = (
    "132334556677",
    "232345556777",
    "333445566777",
    "555667777788",
    "777778888888",
    "888888899999",
)
# score C 1-8, score D 1-7 (table 3)
TABLE_C = ("1233455", "2234455", "3334456", "3334566", "4445677", "4456677", "5566777", "5567777")

ACTION = (2, 4, 6)
"""The highest scores of action levels 1, 2 and 3."""

Wrist = Literal["mid", "end"]
Pattern = Literal["intermittent", "static", "repeated", "shock"]


class RulaFacts(Facts):
    """A posture, and what is held in it; one side of the body at a time. Angles in degrees, flexion
    positive, extension negative; loads in kg.
    """

    upper_arm_flexion_deg: float = fact(
        "upper arm against the trunk, flexion positive", "deg", -90, 180, cautious=91.0
    )
    lower_arm_flexion_deg: float = fact("flexion of the elbow", "deg", 0, 160, cautious=101.0)
    wrist_flexion_deg: float = fact(
        "wrist, flexion positive, extension negative", "deg", -90, 90, cautious=16.0
    )
    neck_flexion_deg: float = fact(
        "neck against the trunk, flexion positive", "deg", -70, 90, cautious=-1.0
    )
    trunk_flexion_deg: float = fact(
        "trunk against the vertical, flexion positive", "deg", -45, 150, cautious=61.0
    )
    load_kg: float = fact(
        "load or force of the hand, as kg", "kg", 0, 100, default=0.0, cautious=10.1, asked=True
    )
    load_pattern: Pattern = fact(
        "intermittent, static, repeated, or shock (rapid build-up)",
        default="intermittent",
        cautious="repeated",
    )
    repeats_per_min: float = fact(
        "repetitions of the posture", "1/min", 0, 300, default=0.0, cautious=5.0
    )
    static: bool = fact("held longer than 1 min", default=False, cautious=True)
    shoulder_raised: bool = fact("the shoulder is raised", default=False, cautious=True)
    arm_abducted: bool = fact("the upper arm is abducted", default=False, cautious=True)
    arm_supported_or_leaning: bool = fact("the arm is supported", default=False, cautious=False)
    across_midline: bool = fact(
        "the lower arm works across the midline or out to the side", default=False, cautious=True
    )
    wrist_deviated: bool = fact("radial or ulnar deviation", default=False, cautious=True)
    wrist_twist: Wrist = fact(
        "twist of the wrist: mid range, or at or near the end", default="mid", cautious="end"
    )
    neck_twisted: bool = fact("the neck is twisted", default=False, cautious=True)
    neck_side_bent: bool = fact("the neck is bent to a side", default=False, cautious=True)
    trunk_twisted: bool = fact("the trunk is twisted", default=False, cautious=True)
    trunk_side_bent: bool = fact("the trunk is bent to a side", default=False, cautious=True)
    trunk_supported_seated: bool = fact(
        "seated and well supported, hip and trunk at 90 degrees or more",
        default=False,
        cautious=False,
    )
    legs_supported: bool = fact(
        "legs and feet supported, weight even", default=True, cautious=False
    )


# --- published steps ------------------------------------------------------------------------------


def table_a(
    *,
    ua: Annotated[int, Field(ge=1, le=6)],
    la: Annotated[int, Field(ge=1, le=3)],
    w: Annotated[int, Field(ge=1, le=4)],
    wt: Annotated[int, Field(ge=1, le=2)],
) -> int:
    """Posture score A of the scores of upper arm, lower arm, wrist and wrist twist (table 1)."""
    return int(TABLE_A[ua - 1][la - 1][2 * (w - 1) + wt - 1])


def table_b(
    *,
    neck: Annotated[int, Field(ge=1, le=6)],
    trunk: Annotated[int, Field(ge=1, le=6)],
    legs: Annotated[int, Field(ge=1, le=2)],
) -> int:
    """Posture score B of the scores of neck, trunk and legs (table 2)."""
    return int(TABLE_B[neck - 1][2 * (trunk - 1) + legs - 1])


def table_c(*, c: Annotated[int, Field(ge=1)], d: Annotated[int, Field(ge=1)]) -> int:
    """The grand score of scores C and D (table 3), which counts 8 and 7 for more."""
    return int(TABLE_C[min(c, 8) - 1][min(d, 7) - 1])


def action_level(grand: int) -> int:
    """Action level 1 to 4 of a grand score of 1 to 7 (section "Action levels")."""
    return 1 + banded(grand, ACTION)


# --- from facts to a score ------------------------------------------------------------------------


def upper_arm_band(angle: float) -> Reason:
    """Flexion or extension of the upper arm to 1-4: 20, 45 and 90 degrees, extension over 20."""
    if angle < -20:
        return Reason("extended", -angle, (20, None), 2)
    points = 1 + banded(angle, (20, 45, 90))
    band: Band = ((-20, 20), (20, 45), (45, 90), (90, None))[points - 1]
    return Reason("flexed", angle, band, points, neutral=points == 1)


def lower_arm_band(angle: float) -> Reason:
    """Flexion of the elbow to 1 (60 to 100 degrees) or 2."""
    if 60 <= angle <= 100:
        return Reason("flexed", angle, (60, 100), 1, neutral=True)
    return Reason("flexed", angle, (None, 60) if angle < 60 else (100, None), 2)


def _wrist(angle: float) -> Reason:
    points = 1 if angle == 0 else 2 if abs(angle) <= 15 else 3
    band: Band = ((0, 0), (0, 15), (15, None))[points - 1]
    return Reason(
        "extended" if angle < 0 else "flexed", abs(angle), band, points, neutral=points == 1
    )


def _neck(angle: float) -> Reason:
    if angle < 0:
        return Reason("extended", -angle, (0, None), 4)
    points = 1 + banded(angle, (10, 20))
    band: Band = ((0, 10), (10, 20), (20, None))[points - 1]
    return Reason("flexed", angle, band, points, neutral=points == 1)


def _trunk(facts: RulaFacts) -> Reason:
    angle = facts.trunk_flexion_deg
    if facts.trunk_supported_seated:
        return Reason("seated", None, None, 1, neutral=True)
    if angle <= 0:
        return Reason("upright", angle, None, 1, neutral=True)
    points = 2 + banded(angle, (20, 60))
    band: Band = ((0, 20), (20, 60), (60, None))[points - 2]
    return Reason("flexed", angle, band, points)


def _force(facts: RulaFacts) -> Reason:
    load, pattern = facts.load_kg, facts.load_pattern
    if pattern == "shock":
        return Reason("shock", load, None, 3)
    if load < 2:
        return Reason("load", load, (0, 2), 0, neutral=True)
    lasting = pattern != "intermittent"
    band: Band = (2, 10) if load <= 10 else (10, None)
    return Reason(f"load_{pattern}", load, band, 1 + (load > 10) + lasting)


def _muscle(facts: RulaFacts) -> Reason:
    if facts.static:
        return Reason("held", None, None, 1)
    if facts.repeats_per_min > 4:
        return Reason("repeated", facts.repeats_per_min, (4, None), 1)
    return Reason("neither_held_nor_repeated", None, None, 0, neutral=True)


def part(
    name: str, best: int, worst: int, base: Reason, adjusted: Mapping[str, tuple[bool, int]]
) -> Step:
    """The score of a part of the body: the band of its angle, and what is added or taken away,
    within the rows that the tables have.
    """
    more = [
        Reason(key, None, None, points, added=True, neutral=points < 0)
        for key, (holds, points) in adjusted.items()
        if holds
    ]
    total = int(base.points or 0) + sum(int(reason.points or 0) for reason in more)
    value = min(max(total, best), worst)
    return Step(name, value, (base, *more), weight=value - best)


def assess(facts: RulaFacts) -> Outcome:
    """The grand score 1 to 7 of one side, its action level, and every step."""
    f = facts
    upper_arm = part(
        "upper_arm", 1, 6, upper_arm_band(f.upper_arm_flexion_deg),
        {
            "shoulder_raised": (f.shoulder_raised, 1),
            "abducted": (f.arm_abducted, 1),
            "arm_supported": (f.arm_supported_or_leaning, -1),
        },
    )  # fmt: skip
    lower_arm = part(
        "lower_arm", 1, 3, lower_arm_band(f.lower_arm_flexion_deg),
        {"across_midline": (f.across_midline, 1)},
    )  # fmt: skip
    wrist = part("wrist", 1, 4, _wrist(f.wrist_flexion_deg), {"deviated": (f.wrist_deviated, 1)})
    twist = Step(
        "wrist_twist",
        2 if f.wrist_twist == "end" else 1,
        (Reason(f"twist_{f.wrist_twist}", neutral=f.wrist_twist == "mid"),),
        weight=f.wrist_twist == "end",
    )
    neck = part(
        "neck", 1, 6, _neck(f.neck_flexion_deg),
        {"twisted": (f.neck_twisted, 1), "side_bent": (f.neck_side_bent, 1)},
    )  # fmt: skip
    trunk = part(
        "trunk", 1, 6, _trunk(f),
        {"twisted": (f.trunk_twisted, 1), "side_bent": (f.trunk_side_bent, 1)},
    )  # fmt: skip
    legs = Step(
        "legs",
        1 if f.legs_supported else 2,
        (Reason("legs_even" if f.legs_supported else "legs_uneven", neutral=f.legs_supported),),
        weight=not f.legs_supported,
    )
    why_muscle, why_force = _muscle(f), _force(f)
    muscle, force = int(why_muscle.points or 0), int(why_force.points or 0)
    scores = {
        step.part: int(step.value or 0)
        for step in (upper_arm, lower_arm, wrist, twist, neck, trunk, legs)
    }
    posture_a = table_a(
        ua=scores["upper_arm"], la=scores["lower_arm"], w=scores["wrist"], wt=scores["wrist_twist"]
    )
    posture_b = table_b(neck=scores["neck"], trunk=scores["trunk"], legs=scores["legs"])
    score_c, score_d = posture_a + muscle + force, posture_b + muscle + force
    grand = table_c(c=score_c, d=score_d)
    level = action_level(grand)
    outputs: dict[str, Any] = {
        **scores,
        "muscle": muscle,
        "force": force,
        "posture_a": posture_a,
        "posture_b": posture_b,
        "score_c": score_c,
        "score_d": score_d,
        "grand": grand,
        "action_level": level,
    }
    steps = (
        upper_arm, lower_arm, wrist, twist,
        Step("posture_a", posture_a, (Reason("table", "A"),)),
        neck, trunk, legs,
        Step("posture_b", posture_b, (Reason("table", "B"),)),
        Step("muscle", muscle, (why_muscle,), weight=muscle),
        Step("force", force, (why_force,), weight=force),
        Step("score_c", score_c, (Reason("sum", f"{posture_a} + {muscle} + {force}"),)),
        Step("score_d", score_d, (Reason("sum", f"{posture_b} + {muscle} + {force}"),)),
        Step("grand", grand, (Reason("table", "C"),)),
    )  # fmt: skip
    return Outcome(METHOD, grand, level - 1, outputs, steps)


FUNCTIONS = {
    "rula_from_angles": Published(assess, RulaFacts),
    "rula_table_a": Published(table_a),
    "rula_table_b": Published(table_b),
    "rula_table_c": Published(table_c),
}
"""The published steps that can be asked for alone."""
