"""The Revised Strain Index, COSI and CUSI once more, for arrays, written from the papers' formulas:
the polynomials by Horner's rule, the composite as differences of cumulated multipliers.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def intensity(i: Array) -> Array:
    low = ((30 * i - 15.6) * i + 13) * i + 0.4
    high = ((36 * i - 33.3) * i + 24.77) * i - 1.86
    return np.where(i > 0.4, high, low)


def efforts(e: Array) -> Array:
    return np.where(e > 90, 0.00334 * np.exp(1.96 * np.log(np.maximum(e, 1))), 0.25 * e + 0.1)


def seconds(d: Array) -> Array:
    return np.where(d > 60, 19.17 * np.log(d) - 59.44, 0.31 * d + 0.45)


def wrist(p: Array) -> Array:
    bent_back = 1 + 0.00028 * np.clip(p - 30, 0, None) ** 2
    return np.where(p < 0, 1.2 * np.exp(0.009 * np.abs(p)) - 0.2, bent_back)


def hours(h: Array) -> Array:
    long = np.maximum(h, 0.05)
    return np.where(h > 0.05, 0.477 + 0.042 * long + 0.090 * np.log(long), 0.20)


def rsi(f: Mapping[str, Array]) -> Array:
    """`[N]` indices of `[N]` facts each."""
    return intensity(f["I"]) * efforts(f["E"]) * seconds(f["D"]) * wrist(f["P"]) * hours(f["H"])


def stacked(indices: Array, amounts: Array, multiplier: Callable[[Array], Array]) -> Array:
    """COSI by efforts, CUSI by hours: `[..., K]` indices and amounts to `[...]`. What is not there
    has an index and an amount of 0.
    """
    order = np.lexsort((-amounts, -indices), axis=-1)
    index = np.take_along_axis(indices, order, axis=-1)
    amount = np.take_along_axis(amounts, order, axis=-1)
    gained = np.diff(multiplier(np.cumsum(amount, axis=-1)), prepend=0.0, axis=-1)
    return np.sum(index * gained / multiplier(amount), axis=-1)
