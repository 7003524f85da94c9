"""From a cell to a product that can be taken apart: its parts, what each must sit on, and how long
mounting and taking off take.

The system of Antonelli et al. (2021) knows joint operations only, one after the other, and minds
nothing but time. What of a cell it cannot express is refused by name, everything at once; what
makes no difference when one operation is done at a time (a zone, stress, difficulty, who else could
do it) is let through.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from tandem.cell.beyond import beyond
from tandem.cell.model import Cell
from tandem.errors import CellError, Fault, UsageError

UNMOUNT_SHARE = 0.5
"""ASSUMPTION: taking a part off takes half the time of mounting it."""


@dataclass(frozen=True)
class Product:
    """What is mounted. Axis: parts, in the cell's order of tasks.

    Attributes:
      names: of the parts (the cell's tasks).
      below: per part, the parts that must sit rightly before it can: everything that comes before
        it in the cell's precedence.
      above: per part, the parts that have it below them: while one of them is in place, the part
        can neither be mounted nor taken off.
      mount, unmount: seconds.
    """

    names: tuple[str, ...]
    below: tuple[frozenset[int], ...]
    above: tuple[frozenset[int], ...]
    mount: tuple[float, ...]
    unmount: tuple[float, ...]


def product(cell: Cell, *, unmount_share: float = UNMOUNT_SHARE) -> Product:
    """The cell's product. Each task mounts one part, in the quickest of its ways.

    Args:
      unmount_share: how long taking a part off takes, as a share of the time of mounting it.

    Raises:
      CellError: with everything that the system cannot express.
      UsageError: `unmount_share` is not above 0.
    """
    if not unmount_share > 0:
        raise UsageError(
            f"unmount_share is {unmount_share!r}: taking a part off takes time; give a number"
            " above 0."
        )
    if faults := list(_beyond_it(cell)):
        raise CellError(faults)
    numbers = {name: number for number, name in enumerate(cell.tasks)}
    below: dict[str, frozenset[int]] = {}

    def all_below(name: str) -> frozenset[int]:
        if name not in below:
            direct = cell.tasks[name].after
            below[name] = frozenset(numbers[other] for other in direct).union(
                *(all_below(other) for other in direct)
            )
        return below[name]

    rows = tuple(all_below(name) for name in cell.tasks)
    mount = tuple(min(mode.time for mode in cell.modes(name)) for name in cell.tasks)
    return Product(
        names=tuple(cell.tasks),
        below=rows,
        above=tuple(
            frozenset(other for other, row in enumerate(rows) if part in row)
            for part in range(len(rows))
        ),
        mount=mount,
        unmount=tuple(unmount_share * seconds for seconds in mount),
    )


def _beyond_it(cell: Cell) -> Iterator[Fault]:
    """Operators are always there and remembered by nobody; tasks know no clock and no tool."""
    task = ("time", "together", "stress", "after", "zone", "difficulty", "spread")
    yield from (
        Fault(_unknown(path[-1]), path) for path in beyond(cell, operator=("tool",), task=task)
    )


def _unknown(key: str) -> str:
    what = "zone that keeps kinds apart" if key == "apart" else key.replace("_", " ")
    return (
        f"the product of Antonelli et al. knows no {what}: its states say which"
        " parts sit how, and nothing else. Leave it out."
    )
