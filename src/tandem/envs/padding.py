"""Cells of several sizes as arrays of one: what is added can be done by nobody, holds nobody up,
and weighs nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from tandem.envs.cells import Room
from tandem.errors import UsageError
from tandem.world.arrays import NEVER, Array, Arrays
from tandem.world.people import Person

AXES = {
    "way_task": ("W", 0),
    "of_task": ("WT", False),
    "way_uses": ("WO", False),
    "way_size": ("W", 0),
    "way_ticks": ("W", 0),
    "way_load": ("WO", 0),
    "way_open": ("W", False),
    "spread": ("W", 0),
    "needs": ("TT", False),
    "release": ("T", 0),
    "deadline": ("T", NEVER),
    "tail": ("T", 0),
    "human": ("O", False),
    "rank": ("O", NEVER),
    "way_tool": ("WO", -1),
    "swap": ("WO", 0),
    "takes": ("WU", 0),
    "tool_places": ("U", NEVER),
    "of_zone": ("TZ", False),
    "zone_places": ("Z", NEVER),
    "apart": ("WW", False),
    "holds": ("H2", 0),
    "hold_of": ("HO", False),
    "hold_bars": ("HW", False),
    "hold_rivals": ("HH", False),
    "hold_ahead": ("HT", False),
    "in_hand": ("O", -1),
    "stands": ("O", -1),
    "place": ("T", -1),
    "walk": ("OPP", 0),
    "break_from": ("OB", NEVER),
    "break_to": ("OB", NEVER),
    "limit": ("A", NEVER),
    "due": ("WA", 0),
    "owes": ("WA", False),
    "must": ("TA", 0),
    "same": ("TT", False),
    "sets": ("ST", False),
    "set_stress": ("S", 0),
    "undo": ("W", 1),
    "lag_task": ("LT", False),
    "lag_before": ("LT", False),
    "lag_from_start": ("L", False),
    "lag_least": ("L", 0),
    "lag_most": ("L", NEVER),
    "above": ("TT", False),
}
"""Field of `Arrays` -> its axes, in the letters of `tandem.world.arrays`, and what fills them up.
`P` places, `H` holds of a machine.
"""


def padded(cells: Sequence[Arrays], room: Room) -> list[Arrays]:
    """The cells with as many tasks, ways and operators as there is room for. A rule that one of
    them has is in force for all; it binds only those that have it.

    Raises UsageError for several cells of which one has `stress_of_set`: a cell without has no
    listed sets that could stand beside its own.
    """
    if len(cells) > 1 and any(one.sets.shape[0] for one in cells):
        raise UsageError(
            "a cell with `stress_of_set` cannot be padded to others. Make an environment of it"
            " alone."
        )
    sizes = {"T": room.tasks, "W": room.ways, "O": room.operators}
    return [
        Arrays(
            **{
                name: _filled(
                    getattr(one, name),
                    _shape([np.shape(getattr(other, name)) for other in cells], axes, sizes),
                    fill,
                )
                for name, (axes, fill) in AXES.items()
            }
        )
        for one in cells
    ]


def padded_person(person: Person, ways: int) -> Person:
    """The person where there are so many ways."""
    return Person(
        *(
            np.pad(np.asarray(part), (0, ways - part.shape[0])) if np.ndim(part) else part
            for part in person
        )
    )


def _shape(shapes: list[tuple[int, ...]], axes: str, sizes: dict[str, int]) -> tuple[int, ...]:
    """The most that any cell has; of tasks, ways and operators as many as there is room for, or
    none where the length 0 says that no cell has the rule.
    """
    most = [max(lengths) for lengths in zip(*shapes, strict=True)]
    return tuple(
        sizes.get(letter, length) if length else 0
        for letter, length in zip(axes, most, strict=True)
    )


def _filled(part: Array, shape: tuple[int, ...], fill: Any) -> Array:
    part = np.asarray(part)
    after = [(0, more - have) for have, more in zip(part.shape, shape, strict=True)]
    return np.pad(part, after, constant_values=fill)
