"""What one execution of a task puts on a human, scale by scale.

A scale is the name of a method whose numbers may be compared: `reba`, `rula`, `rsi`, `niosh`,
`eaws` and their like only rank, so that nobody may add them. Doses are added over tasks and cycles:
`duet`, `lifft`, `shoulder_tool` (damage) and `energy` (kcal).
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from decimal import Decimal
from typing import TYPE_CHECKING, Literal

from tandem.cell.assessed import Assessed, assessed
from tandem.cell.names import Known
from tandem.ergonomics.methods import LICENSED, METHODS
from tandem.errors import UsageError

if TYPE_CHECKING:
    from tandem.cell.parts import Fields

Kind = Literal["ordinal", "dose"]
HANDS = ("left", "right")
SCALE_OF = {"garg_energy": "energy"}
"""Methods whose scale has another name."""
METHOD_OF = {scale: method for method, scale in SCALE_OF.items()}


def scale_of(method: str) -> str:
    """The name of the scale on which a method's numbers are."""
    return SCALE_OF.get(method, method)


def scales() -> tuple[str, ...]:
    """Every scale that there is. A dose that is worked out for each side has three: `duet`,
    `duet-left` and `duet-right`.
    """
    names = [scale_of(method) for method in METHODS]
    sided = [
        f"{scale_of(name)}-{hand}"
        for name, method in METHODS.items()
        if method.scale == "dose" and method.sided
        for hand in HANDS
    ]
    return tuple(dict.fromkeys([*names, *sided, *LICENSED]))


def kind(scale: str) -> Kind:
    """Whether a scale's numbers only rank (`ordinal`, indices among them) or may be added (`dose`).

    Raises:
      UsageError: there is no such scale; with the nearest known one.
    """
    if scale not in scales():
        raise UsageError(f"there is no scale {scale!r}. {Known(scales()).hint(scale)}")
    base = scale.rpartition("-")[0] if scale.endswith(HANDS) else scale
    method = METHODS.get(METHOD_OF.get(base, base))
    return "dose" if method is not None and method.scale == "dose" else "ordinal"


def exposures(cell: Fields) -> Mapping[str, Mapping[tuple[str, str], Decimal]]:
    """Scale -> {(task, human): the value of one execution}. A task without an assessment on a scale
    is not in it. Worked out anew whenever it is asked for.

    Of sides the worse one counts. So `duet` and `shoulder_tool` are never below, and may be above,
    what either side collects; where a cell tells sides apart, `duet-left` and `duet-right` (each
    with what both hands do) are exact.
    """
    found: dict[str, dict[tuple[str, str], Decimal]] = {}
    everything = assessed(cell)
    told_apart = {one.method for one in everything if one.side in HANDS}
    for (task, who, method), rows in by_person(everything).items():
        scale, sides = scale_of(method), _by_side(rows)
        found.setdefault(scale, {})[task, who] = max(sides.values())
        if method in told_apart and kind(scale) == "dose":
            for hand in HANDS:
                found.setdefault(f"{scale}-{hand}", {})[task, who] = sides[hand]
    return found


def by_person(
    everything: Iterable[Assessed],
) -> Mapping[tuple[str, str, str], list[Assessed]]:
    """(task, human, method) -> what holds for that human: an assessment made for a person goes
    before one of the same side that holds for everybody.
    """
    found: dict[tuple[str, str, str], list[Assessed]] = defaultdict(list)
    for one in everything:
        for who in one.operators:
            found[one.task, who, one.method].append(one)
    for rows in found.values():
        own = {row.side for row in rows if row.own}
        rows[:] = [row for row in rows if row.own or row.side not in own]
    return found


def _by_side(rows: Iterable[Assessed]) -> dict[str, Decimal]:
    """What each hand collects in one execution; what both do, or no side is named for, counts for
    each. Ranks are not added: of several the worst.
    """
    sides = dict.fromkeys(HANDS, Decimal(0))
    for row in rows:
        value = Decimal(repr(row.value))
        for hand in HANDS if row.side not in HANDS else (row.side,):
            adds = kind(scale_of(row.method)) == "dose"
            sides[hand] = sides[hand] + value if adds else max(sides[hand], value)
    return sides
