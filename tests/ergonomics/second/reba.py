"""REBA once more, as one fills in the printed score sheet, for arrays of postures.

Written from the paper's sheet and not from the tables of `tandem.ergonomics`, which it knows
nothing of.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from tests.ergonomics.second.rula import Array, sheet

# a line for the trunk, in it the neck 1 to 3, each with legs 1 to 4
TRUNK_NECK_LEGS = sheet("""
    1 2 3 4 | 1 2 3 4 | 3 3 5 6
    2 3 4 5 | 3 4 5 6 | 4 5 6 7
    2 4 5 6 | 4 5 6 7 | 5 6 7 8
    3 5 6 7 | 5 6 7 8 | 6 7 8 9
    4 6 7 8 | 6 7 8 9 | 7 8 9 9
""")
# a line for the upper arm, in it the lower arm 1 and 2, each with the wrist 1 to 3
ARMS_AND_WRIST = sheet("""
    1 2 2 | 1 2 3
    1 2 3 | 2 3 4
    3 4 5 | 4 5 5
    4 5 5 | 5 6 7
    6 7 8 | 7 8 8
    7 8 8 | 8 9 9
""")
# a line for score B, in it score A 1 to 12
SCORE_B_THEN_A = sheet("""
    1 1 2 3 4 6 7 8 9 10 11 12
    1 2 3 4 4 6 7 8 9 10 11 12
    1 2 3 4 4 6 7 8 9 10 11 12
    2 3 3 4 5 7 8 9 10 11 11 12
    3 4 4 5 6 8 9 10 10 11 12 12
    3 4 5 6 7 8 9 10 10 11 12 12
    4 5 6 7 8 9 9 10 11 11 12 12
    5 6 7 8 8 9 10 10 11 12 12 12
    6 6 7 8 9 10 10 10 11 12 12 12
    7 7 8 9 9 10 11 11 12 12 12 12
    7 7 8 9 9 10 11 11 12 12 12 12
    7 8 8 9 9 10 11 11 12 12 12 12
""")


def reba(f: Mapping[str, Array]) -> NDArray[np.int64]:
    """`[N]` scores of `[N]` facts each, by the names of the worked examples; coupling 0 to 3."""
    nod = f["neck_flexion_deg"]
    neck = np.where((nod < 0) | (nod > 20), 2, 1) + f["neck_twist_or_side"]
    bow = f["trunk_flexion_deg"]
    trunk = np.select([bow == 0, np.abs(bow) <= 20, bow <= 60], [1, 2, 3], 4)
    trunk = trunk + f["trunk_twist_or_side"]
    knee = f["knee_flexion_deg"]
    deep = np.where(f["sitting"] > 0, 0, 2)
    legs = 1 + f["unilateral_or_unstable"] + np.select([knee <= 30, knee <= 60], [0, 1], deep)
    posture_a = TRUNK_NECK_LEGS[(trunk - 1).astype(int), (4 * (neck - 1) + legs - 1).astype(int)]
    kg = f["load_kg"]
    score_a = posture_a + np.select([kg < 5, kg <= 10], [0, 1], 2) + f["shock"]

    raised = f["upper_arm_flexion_deg"]
    upper = np.select([raised < -20, raised <= 20, raised <= 45, raised <= 90], [2, 1, 2, 3], 4)
    upper = upper + f["arm_abducted_or_rotated"] + f["shoulder_raised"]
    upper = np.clip(upper - f["arm_supported_or_gravity_assisted"], 1, 6)
    elbow = f["lower_arm_flexion_deg"]
    lower = np.where((elbow >= 60) & (elbow <= 100), 1, 2)
    wrist = np.where(np.abs(f["wrist_flexion_deg"]) <= 15, 1, 2) + f["wrist_deviated_or_twisted"]
    posture_b = ARMS_AND_WRIST[(upper - 1).astype(int), (3 * (lower - 1) + wrist - 1).astype(int)]
    score_b = posture_b + f["coupling"]

    score_c = SCORE_B_THEN_A[
        np.minimum(score_b, 12).astype(int) - 1, np.minimum(score_a, 12).astype(int) - 1
    ]
    activity = f["static"] + (f["repeats_per_min"] > 4) + f["rapid_large_changes"]
    return (score_c + activity).astype(np.int64)
