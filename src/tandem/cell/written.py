"""Numbers as people write them: in messages, pages and pictures, everywhere alike."""

from __future__ import annotations

import math


def number(value: float) -> str:
    """The number to six decimals: no trailing zeros, no noise of binary fractions, no power of
    ten.
    """
    if isinstance(value, int):
        return str(value)  # also one that no float holds
    if not math.isfinite(value):
        return (
            "not a number" if math.isnan(value) else "infinite" if value > 0 else "minus infinite"
        )
    text = f"{value:.6f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def signed(value: float) -> str:
    """A difference with its sign: +3, -0.5, ±0."""
    text = number(value)
    return "±0" if text == "0" else text if value < 0 else f"+{text}"


def seconds(value: float) -> str:
    """A time with its unit."""
    return f"{number(value)} s"


def share(value: float) -> str:
    """A share of 1 as a percentage; below 10 % with one decimal. What is more than nothing is never
    shown as 0 %.
    """
    percent = 100 * value
    if 0 < percent < 0.05:
        return "< 0.1 %"
    return (
        f"{percent:.1f} %"
        if 0 < percent < 10 and round(percent, 1) != round(percent)
        else f"{percent:.0f} %"
    )
