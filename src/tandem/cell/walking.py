"""Walking between the places of a cell: how long each way takes each operator.

Times stand in `walk`, per operator: seconds for pairs of places, or a speed, by which the places'
coordinates say the rest.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from decimal import Decimal
from fractions import Fraction
from itertools import permutations
from math import ceil, isqrt

from tandem.cell.names import clean

Pair = tuple[str, str]
"""From one place to another."""
Metres = tuple[float, float]
"""Coordinates of a place."""

SPEED = "speed"
"""The key beside the pairs: metres a second."""
TENTHS = 10
"""Times by speed are whole tenths of a second, rounded up."""


def walking_times(
    walk: Mapping[str, Mapping[str, float]],
    places: Mapping[str, Metres],
    names: Collection[str],
) -> dict[str, dict[Pair, float]]:
    """Operator to the seconds that it needs from one place to another; pairs that take none are
    not in it. Keys that name no pair, or several, are stepped over.

    Args:
      walk, places: as a cell states them.
      names: all places that there are.
    """
    known = dict.fromkeys(names)
    return {who: _times_of(table, places, known) for who, table in walk.items()}


def _times_of(
    table: Mapping[str, float], places: Mapping[str, Metres], known: Collection[str]
) -> dict[Pair, float]:
    times: dict[Pair, float] = {}
    if table.get(SPEED):
        for one, other in permutations(places, 2):
            times[one, other] = seconds_at(table[SPEED], places[one], places[other])
    stated = {
        pairs[0]: seconds
        for key, seconds in table.items()
        if key != SPEED and len(pairs := pairs_of(key, known)) == 1
    }
    # both directions, unless the other one is stated too
    times |= {(b, a): seconds for (a, b), seconds in stated.items()} | stated
    return {pair: seconds for pair, seconds in times.items() if seconds}


def pairs_of(key: str, known: Collection[str]) -> list[Pair]:
    """The pairs of known places that `FROM-TO` can mean; names may hold hyphens, so there may be
    several.
    """
    cuts = (place for place, sign in enumerate(key) if sign == "-")
    pairs = ((clean(key[:cut]), clean(key[cut + 1 :])) for cut in cuts)
    return [pair for pair in pairs if known and pair[0] in known and pair[1] in known]


def seconds_at(speed: float, start: tuple[float, float], end: tuple[float, float]) -> float:
    """Seconds for the straight way at so many metres a second, rounded up to tenths, exactly.

    Args:
      start, end: coordinates in metres.
    """
    dx, dy = (_exact(b) - _exact(a) for a, b in zip(start, end, strict=True))
    # the least whole n with n / TENTHS * speed >= distance, both sides squared
    squared = (dx * dx + dy * dy) * TENTHS**2 / _exact(speed) ** 2
    tenths = isqrt(ceil(squared))
    return (tenths if tenths * tenths >= squared else tenths + 1) / TENTHS


def _exact(value: float) -> Fraction:
    return Fraction(Decimal(repr(value)))
