"""What nobody foresaw: once in an episode, in the middle of the work. Drawn beforehand as plain
numbers; what they mean depends on how things stand.

An ability is lost: the robot can do nothing more with one tool, or one task that needs no tool.
Only where the human (or both) can still do it. A part is redone: a task that was done is open
again, such as after a scratched part. Only where nothing that comes after it has begun. A tool is
missing: work with it begins only when it is back. Who has it in hand goes on.

So whatever happens, the rest can still be finished.
"""

from __future__ import annotations

from enum import IntEnum
from typing import Any, NamedTuple

from tandem.lab.zhang2022.setting import Duo
from tandem.world.arrays import NEVER, Array, namespace
from tandem.world.state import State as Assembly
from tandem.world.state import mounted


class Kind(IntEnum):
    """What happened."""

    NOTHING = 0
    ABILITY_LOST = 1
    PART_REDONE = 2
    TOOL_MISSING = 3


class Change(NamedTuple):
    """at: `[]` int32, the tick at which it comes; NEVER for none. of_kinds, of_those: `[]` float32
    in [0, 1), which kind of those that are possible then, and which of that kind.
    """

    at: Array
    of_kinds: Array
    of_those: Array


class Happened(NamedTuple):
    """kind: `[]` int32, a `Kind`. which: `[]` int32, the ability, task or tool; -1 before. back_at:
    `[U]` int32, a tool is missing until then; 0.
    """

    kind: Array
    which: Array
    back_at: Array


def nothing_yet(duo: Duo) -> Happened:
    """Before anything has happened."""
    xp = namespace(duo.row)
    return Happened(
        xp.zeros((), xp.int32),
        xp.full((), -1, xp.int32),
        xp.zeros(duo.arrays.tool_places.shape[0], xp.int32),
    )


def possible(duo: Duo, assembly: Assembly) -> tuple[Array, Array, Array]:
    """`[G]`, `[T]`, `[U]` bool: abilities that may be lost now, tasks that may have to be redone,
    tools that may go missing.
    """
    xp, arrays = namespace(duo.row), duo.arrays
    open_ = assembly.way < 0
    of_open = xp.any(arrays.of_task & open_[None, :], axis=1)
    usable = arrays.way_open & ~assembly.refused & of_open
    kept = usable[None, :] & ~duo.ability
    finishable = xp.all(
        xp.any(kept[:, :, None] & arrays.of_task[None, :, :], axis=1) | ~open_[None, :], axis=1
    )
    ability = finishable & xp.any(duo.ability & usable[None, :], axis=1)
    begun_after = xp.any(arrays.needs & ~open_[:, None], axis=0)
    return (
        ability,
        mounted(assembly) & ~begun_after,
        xp.any(duo.of_tool & open_[:, None], axis=0),
    )


def happen(
    duo: Duo, assembly: Assembly, change: Change, search: Array
) -> tuple[Assembly, Happened]:
    """The change comes now, if any is possible. `search`: `[]` int32, ticks until a missing tool is
    back.
    """
    xp, arrays = namespace(duo.row), duo.arrays
    masks = possible(duo, assembly)
    some = xp.stack([xp.any(mask) if mask.shape[0] else xp.zeros((), bool) for mask in masks])
    index = _nth(xp, some, change.of_kinds)
    kind = xp.where(xp.any(some), index + 1, 0).astype(xp.int32)
    picks = [
        _nth(xp, mask, change.of_those) if mask.shape[0] else xp.full((), -1, xp.int32)
        for mask in masks
    ]
    which = xp.where(
        kind == 0, -1, xp.sum(xp.where(xp.arange(3) == kind - 1, xp.stack(picks), 0))
    ).astype(xp.int32)

    def chosen(wanted: Kind, number: int) -> Any:
        return (xp.arange(number) == which) & (kind == wanted)

    lost = xp.any(duo.ability & chosen(Kind.ABILITY_LOST, duo.ability.shape[0])[:, None], axis=0)
    redone = chosen(Kind.PART_REDONE, arrays.release.shape[0])
    missing = chosen(Kind.TOOL_MISSING, arrays.tool_places.shape[0])
    after = assembly._replace(
        refused=assembly.refused | lost,
        way=xp.where(redone, -1, assembly.way),
        start_at=xp.where(redone, NEVER, assembly.start_at),
        end_at=xp.where(redone, NEVER, assembly.end_at),
    )
    return after, Happened(
        kind, which, xp.where(missing, assembly.clock + search, 0).astype(xp.int32)
    )


def _nth(xp: Any, mask: Array, share: Array) -> Array:
    """`[]` int32, the index of one of the True entries of `mask`; `share` in [0, 1) says which. 0
    when there is none.
    """
    count = xp.cumsum(mask)
    return xp.minimum(xp.sum(count <= share * count[-1]), mask.shape[0] - 1).astype(xp.int32)
