"""RULA once more, as one fills in the printed score sheet, for arrays of postures.

Written from the paper's sheet and not from the tables of `tandem.ergonomics`, which it knows
nothing of.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def sheet(text: str) -> NDArray[np.int64]:
    """Rows of a printed table, without rules."""
    rows = [line.replace("|", " ").split() for line in text.strip().splitlines()]
    return np.array(rows, dtype=np.int64)


# a line for upper arm and lower arm, in it wrist 1 to 4, each without and with twist
ARM_AND_WRIST = sheet("""
    1 2 | 2 2 | 2 3 | 3 3
    2 2 | 2 2 | 3 3 | 3 3
    2 3 | 3 3 | 3 3 | 4 4
    2 3 | 3 3 | 3 4 | 4 4
    3 3 | 3 3 | 3 4 | 4 4
    3 4 | 4 4 | 4 4 | 5 5
    3 3 | 4 4 | 4 4 | 5 5
    3 4 | 4 4 | 4 4 | 5 5
    4 4 | 4 4 | 4 5 | 5 5
    4 4 | 4 4 | 4 5 | 5 5
    4 4 | 4 4 | 4 5 | 5 5
    4 4 | 4 5 | 5 5 | 6 6
    5 5 | 5 5 | 5 6 | 6 7
    5 6 | 6 6 | 6 7 | 7 7
    6 6 | 6 7 | 7 7 | 7 8
    7 7 | 7 7 | 7 8 | 8 9
    8 8 | 8 8 | 8 9 | 9 9
    9 9 | 9 9 | 9 9 | 9 9
""")
# a line for the neck, in it trunk 1 to 6, each with legs 1 and 2
NECK_TRUNK_LEGS = sheet("""
    1 3 | 2 3 | 3 4 | 5 5 | 6 6 | 7 7
    2 3 | 2 3 | 4 5 | 5 5 | 6 7 | 7 7
    3 3 | 3 4 | 4 5 | 5 6 | 6 7 | 7 7
    5 5 | 5 6 | 6 7 | 7 7 | 7 7 | 8 8
    7 7 | 7 7 | 7 8 | 8 8 | 8 8 | 8 8
    8 8 | 8 8 | 8 8 | 8 9 | 9 9 | 9 9
""")
# a line for the score of arm and wrist, 1 to 8 and more; neck, trunk and legs 1 to 7 and more
GRAND = sheet("""
    1 2 3 3 4 5 5
    2 2 3 4 4 5 5
    3 3 3 4 4 5 6
    3 3 3 4 5 6 6
    4 4 4 5 6 7 7
    4 4 5 6 6 7 7
    5 5 6 6 7 7 7
    5 5 6 7 7 7 7
""")


def grand(f: Mapping[str, Array]) -> NDArray[np.int64]:
    """`[N]` grand scores of `[N]` facts each, by the names of the worked examples; patterns of the
    load are 0 intermittent, 1 static, 2 repeated, 3 shock.
    """
    arm = f["upper_arm_flexion_deg"]
    step_1 = np.select([arm < -20, arm <= 20, arm <= 45, arm <= 90], [2, 1, 2, 3], 4)
    step_1 = step_1 + f["shoulder_raised"] + f["arm_abducted"] - f["arm_supported_or_leaning"]
    elbow = f["lower_arm_flexion_deg"]
    step_2 = np.where((elbow < 60) | (elbow > 100), 2, 1) + f["across_midline"]
    bend = np.abs(f["wrist_flexion_deg"])
    step_3 = np.select([bend == 0, bend <= 15], [1, 2], 3) + f["wrist_deviated"]
    line = 3 * (np.clip(step_1, 1, 6) - 1) + step_2 - 1
    posture_a = ARM_AND_WRIST[line.astype(int), (2 * (step_3 - 1) + f["wrist_twist"]).astype(int)]

    use = (f["static"] > 0) | (f["repeats_per_min"] > 4)
    kg, pattern = f["load_kg"], f["load_pattern"]
    force = np.select(
        [pattern == 3, kg < 2, (kg <= 10) & (pattern == 0), kg <= 10, pattern == 0],
        [3, 0, 1, 2, 2],
        3,
    )

    nod = f["neck_flexion_deg"]
    step_9 = np.select([nod < 0, nod <= 10, nod <= 20], [4, 1, 2], 3)
    step_9 = step_9 + f["neck_twisted"] + f["neck_side_bent"]
    bow, seated = f["trunk_flexion_deg"], f["trunk_supported_seated"] > 0
    step_10 = np.select([seated | (bow <= 0), bow <= 20, bow <= 60], [1, 2, 3], 4)
    step_10 = step_10 + f["trunk_twisted"] + f["trunk_side_bent"]
    legs = 1 - f["legs_supported"]
    posture_b = NECK_TRUNK_LEGS[(step_9 - 1).astype(int), (2 * (step_10 - 1) + legs).astype(int)]

    wrist_and_arm = np.minimum(posture_a + use + force, 8)
    neck_and_rest = np.minimum(posture_b + use + force, 7)
    return GRAND[wrist_and_arm - 1, neck_and_rest - 1]
