"""LiFFT, DUET and the Shoulder Tool once more, for arrays, in other units than the authors' sheets:
newton metres, natural logarithms.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

NEWTON = 9.80665
NM_PER_FTLB = 0.3048 * 0.45359237 * NEWTON

# OMNI-RES 0 to 10: cycles to failure as the paper prints them
CYCLES = np.array(
    [3842605, 2231607, 729651, 242301, 79223, 26308, 8602, 2856, 949, 310, 103], dtype=float
)


def lifft(f: Mapping[str, Array]) -> Array:
    """`[N]` doses of metric facts."""
    newton_metres = f["lever_cm"] / 100 * f["load_kg"] * NEWTON
    exponent = -5.81636221052493 + 0.0222878437409416 * newton_metres / NM_PER_FTLB
    return f["reps"] * np.exp(exponent * np.log(10))


def duet(f: Mapping[str, Array]) -> Array:
    """`[N]` doses by the printed cycles to failure; the printed damage per cycle is rounded."""
    return f["reps"] / CYCLES[f["omni_res"].astype(int)]


def shoulder(f: Mapping[str, Array]) -> Array:
    """`[N]` doses of metric facts; type 0 handling, 1 horizontal push or pull, 2 downward."""
    inches, pounds = f["lever_cm"] / 2.54, f["load_kg"] / 0.45359237
    load = inches * pounds
    arm = np.select([inches < 1.715, inches < 27], [0.0, 4.8223 * inches - 8.27], 121.9)
    inch_pounds = np.select([f["type"] == 0, f["type"] == 1], [load + arm, load], load - arm)
    percent = inch_pounds / 6.81
    return f["reps"] * np.exp((percent - 101.25) / 14.83 * np.log(10))


def logistic(dose: Array, intercept: float, slope: float) -> Array:
    """`[N]` chances, by odds."""
    odds = np.exp(intercept) * dose ** (slope / np.log(10))
    return odds / (1 + odds)
