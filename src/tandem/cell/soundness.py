"""What the parts of a cell must be to each other: one rule a function, every fault reported."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from tandem.errors import Fault

if TYPE_CHECKING:
    from tandem.cell.model import Cell


def faults(cell: Cell) -> Iterator[Fault]:
    """Everything that keeps the cell from being sound, rule by rule."""
    for rule in RULES:
        yield from rule(cell)


RULES: tuple[Callable[[Cell], Iterator[Fault]], ...] = ()
