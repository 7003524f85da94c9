"""The revised NIOSH lifting equation once more, for arrays of lifts; the frequency table as the
manual prints it: a line for each frequency.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

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


def cli(f: Mapping[str, Array], there: NDArray[np.bool_]) -> Array:
    """`[N]` composite indices of jobs, lift by lift as the manual's worksheet has it; not a number
    where the equation gives none.

    Args:
      f: `[N, K]` facts of up to K kinds of lift a job, the load as `L`; kinds that are not `there`
        count as lifts of nothing, never made.
    """
    flat = {key: values.ravel() for key, values in f.items()}
    free = free_of_frequency(flat).reshape(there.shape)
    single = rwl(flat).reshape(there.shape)
    with np.errstate(divide="ignore", invalid="ignore"):
        alone = np.where(there, f["L"] / single, 0.0)
        added = np.where(there, f["L"] / free, 0.0)
    often = np.where(there, f["F"], 0.0)
    order = np.lexsort((-often, -alone), axis=-1)

    def in_turn(values: NDArray[Any]) -> NDArray[Any]:
        return np.take_along_axis(values, order, axis=-1)

    alone, added, often, is_there = map(in_turn, (alone, added, often, there))
    duration, height = in_turn(f["duration"]), in_turn(f["V"])
    total, rate = alone[:, 0].copy(), often[:, 0].copy()
    impossible = np.any(there & ~(single > 0), axis=1)
    for place in range(1, there.shape[1]):
        before = frequency_multiplier(rate, duration[:, place], height[:, place])
        rate += often[:, place]
        after = frequency_multiplier(rate, duration[:, place], height[:, place])
        impossible |= is_there[:, place] & ((before <= 0) | (after <= 0))
        with np.errstate(divide="ignore", invalid="ignore"):
            more = added[:, place] * (1 / after - 1 / before)
        total += np.where(is_there[:, place], more, 0.0)
    return np.where(impossible, np.nan, total)
