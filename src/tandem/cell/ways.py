"""What the ways between places must be: known pairs, speeds with coordinates, and no detour that is
shorter.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from decimal import Decimal
from itertools import permutations
from operator import add
from typing import TYPE_CHECKING

from tandem.cell.names import Known, clean
from tandem.cell.walking import SPEED, Pair, pairs_of
from tandem.cell.written import number
from tandem.errors import Fault

if TYPE_CHECKING:
    from tandem.cell.parts import Fields

Path = tuple[str | int, ...]


def walks_name_pairs_of_places(cell: Fields) -> Iterator[Fault]:
    """Each key under an operator's `walk` means one pair of known, different places, and each pair
    is stated once.
    """
    names = dict.fromkeys(cell.place_names)
    for who, table in cell.walk.items():
        seen: dict[Pair, str] = {}
        for key in table:
            if key == SPEED:
                continue
            path: Path = ("walk", who, key)
            pairs = pairs_of(key, names)
            if len(pairs) != 1:
                yield Fault(f"walk of {who!r}: {_no_pair(key, pairs, names)}", path)
                continue
            [(one, other)] = pairs
            first = seen.setdefault((one, other), key)
            if one == other:
                yield Fault(
                    f"walk of {who!r}: {key!r} leads from {one!r} to itself, which takes no time."
                    " Leave it out.",
                    path,
                )
            elif first != key:
                yield Fault(
                    f"walk of {who!r} states the way from {one!r} to {other!r} twice, as {first!r}"
                    f" and {key!r}. Keep one of them.",
                    path,
                )


def _no_pair(key: str, pairs: list[Pair], known: Collection[str]) -> str:
    if pairs:
        meant = " or ".join(f"from {one!r} to {other!r}" for one, other in pairs)
        return f"{key!r} can mean {meant}. Rename one of the places."
    if "-" not in key:
        return (
            f"{key!r} is no pair of places. Write FROM-TO, as in `bench-fixture: 3`, or `speed: 1`."
        )
    start, _, end = key.partition("-")
    strange = next((name for name in (clean(start), clean(end)) if name not in known), key)
    hint = Known(known).hint(strange) if known else "Give tasks a `place` first."
    return f"{key!r} names {strange!r}, which is no place of the cell. {hint}"


def speeds_lead_between_coordinates(cell: Fields) -> Iterator[Fault]:
    """A speed is more than 0, and every place that is named has coordinates."""
    unknown = [name for name in cell.place_names if name not in cell.places]
    for who, table in cell.walk.items():
        speed = table.get(SPEED)
        path: Path = ("walk", who, SPEED)
        if speed == 0:
            yield Fault(
                f"walk of {who!r}: speed is 0, but must be more than 0 metres a second. Leave it"
                " out if walking takes no time.",
                path,
            )
        elif speed is not None and unknown:
            listed = ", ".join(map(repr, unknown))
            yield Fault(
                f"walk of {who!r} is a speed, but the cell does not say where {listed}"
                f" {'is' if len(unknown) == 1 else 'are'}. Give coordinates in metres:"
                f" `places: {{{unknown[0]}: [0, 0]}}`.",
                path,
            )


def no_detour_is_shorter(cell: Fields) -> Iterator[Fault]:
    """Walking straight never takes longer than by another place: times keep the triangle
    inequality.
    """
    names = cell.place_names
    known = all(name in cell.places for name in names)
    for who, times in cell.walking.items():
        # other rules say what is wrong there
        if who not in cell.operators or (SPEED in cell.walk[who] and not known):
            continue
        rows = [[_micro(times.get((one, other), 0.0)) for other in names] for one in names]
        columns = list(zip(*rows, strict=True))
        told: set[frozenset[int]] = set()
        for one, other in permutations(range(len(names)), 2):
            by_others = list(map(add, rows[one], columns[other]))
            if (least := min(by_others)) < rows[one][other] and {one, other} not in told:
                told.add(frozenset((one, other)))
                yield _detour(cell, who, names[one], names[by_others.index(least)], names[other])


def _detour(cell: Fields, who: str, start: str, by: str, end: str) -> Fault:
    times, known = cell.walking[who], dict.fromkeys(cell.place_names)
    first, second = times.get((start, by), 0.0), times.get((by, end), 0.0)
    zero = [f"{a}-{b}" for (a, b), s in (((start, by), first), ((by, end), second)) if not s]
    remedy = (
        f" State {' and '.join(map(repr, zero))} too: a way that is not stated takes 0 s."
        if zero
        else " Give the right time of each of the three ways."
    )
    key = next(
        (key for key in cell.walk[who] if pairs_of(key, known) in ([(start, end)], [(end, start)])),
        SPEED,
    )
    total = float(Decimal(repr(first)) + Decimal(repr(second)))
    return Fault(
        f"walk of {who!r}: walking from {start!r} to {end!r} takes"
        f" {number(times[start, end])} s, but by {by!r} {number(total)} s.{remedy}",
        ("walk", who, key),
    )


def _micro(seconds: float) -> int:
    return round(seconds * MICRO)


MICRO = 1_000_000
"""Times have six decimals at most."""

RULES: tuple[Callable[[Fields], Iterator[Fault]], ...] = (
    walks_name_pairs_of_places,
    speeds_lead_between_coordinates,
    no_detour_is_shorter,
)
