"""The revised NIOSH lifting equation once more, for arrays of lifts; the frequency table as the
manual prints it: a line for each frequency.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# F | up to 1 h: V < 75, V >= 75 | up to 2 h | up to 8 h (table 5)
PRINTED = """
    0.2 | 1.00 1.00 | .95 .95 | .85 .85
    0.5 |  .97  .97 | .92 .92 | .81 .81
    1   |  .94  .94 | .88 .88 | .75 .75
    2   |  .91  .91 | .84 .84 | .65 .65
    3   |  .88  .88 | .79 .79 | .55 .55
    4   |  .84  .84 | .72 .72 | .45 .45
    5   |  .80  .80 | .60 .60 | .35 .35
    6   |  .75  .75 | .50 .50 | .27 .27
    7   |  .70  .70 | .42 .42 | .22 .22
    8   |  .60  .60 | .35 .35 | .18 .18
    9   |  .52  .52 | .30 .30 | .00 .15
    10  |  .45  .45 | .26 .26 | .00 .13
    11  |  .41  .41 | .00 .23 | .00 .00
    12  |  .37  .37 | .00 .21 | .00 .00
    13  |  .00  .34 | .00 .00 | .00 .00
    14  |  .00  .31 | .00 .00 | .00 .00
    15  |  .00  .28 | .00 .00 | .00 .00
"""
LINES = np.array([line.replace("|", " ").split() for line in PRINTED.strip().splitlines()], float)


def frequency_multiplier(rate: Array, duration: Array, height: Array) -> Array:
    """`[N]` multipliers; duration 0 short, 1 moderate, 2 long; height at the origin, cm."""
    column = (1 + 2 * duration + (height >= 75)).astype(int)
    found = np.zeros(len(rate))
    for number in range(1, 7):
        here = column == number
        still = LINES[:, number] > 0
        last = LINES[still, 0].max()
        value = np.interp(rate[here], LINES[still, 0], LINES[still, number])
        found[here] = np.where(rate[here] > last, 0.0, value)
    return found


def rwl(f: Mapping[str, Array]) -> Array:
    """`[N]` recommended weights, kg; coupling 0 good, 1 fair, 2 poor."""
    free = free_of_frequency(f)
    return free * frequency_multiplier(f["F"], f["duration"], f["V"])


def free_of_frequency(f: Mapping[str, Array]) -> Array:
    """The same with a frequency multiplier of 1."""
    reach = np.where(f["H"] > 63, 0.0, np.minimum(1.0, 25 / np.maximum(f["H"], 1e-9)))
    height = np.where(f["V"] > 175, 0.0, 1 - 0.003 * np.abs(f["V"] - 75))
    travel = np.where(f["D"] > 175, 0.0, np.minimum(1.0, 0.82 + 4.5 / np.maximum(f["D"], 1e-9)))
    turn = np.where(f["A"] > 135, 0.0, 1 - 0.0032 * f["A"])
    below = f["V"] < 75
    grip = np.select(
        [f["coupling"] == 0, f["coupling"] == 1], [1.0, np.where(below, 0.95, 1.0)], 0.9
    )
    return 23 * reach * height * travel * turn * grip


def cli(loads: Sequence[float], lifts: Sequence[Mapping[str, float]]) -> float | None:
    """The composite index of one job, lift by lift as the manual's worksheet has it."""
    rows = []
    for load, lift in zip(loads, lifts, strict=True):
        one = {key: np.array([float(value)]) for key, value in lift.items()}
        free, single = float(free_of_frequency(one)[0]), float(rwl(one)[0])
        if single <= 0:
            return None
        rows.append((load / single, load / free, lift))
    rows.sort(key=lambda row: (-row[0], -row[2]["F"]))
    total, rate = rows[0][0], rows[0][2]["F"]
    for _, free_index, lift in rows[1:]:
        before, after = (
            float(
                frequency_multiplier(
                    np.array([r]), np.array([lift["duration"]]), np.array([lift["V"]])
                )[0]
            )
            for r in (rate, rate + lift["F"])
        )
        if before <= 0 or after <= 0:
            return None
        total, rate = total + free_index * (1 / after - 1 / before), rate + lift["F"]
    return total
