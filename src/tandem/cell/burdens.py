"""What one execution of a task adds to each measure of what work does to a person."""

from __future__ import annotations

from decimal import Decimal

from tandem.cell.measures import OWN, Measure, cost, decimal, read
from tandem.cell.model import Cell
from tandem.cell.parts import Mode


def named(name: str, cell: Cell) -> Measure:
    """The measure of this name for the cell. Raises UsageError when there is none, or the cell has
    nothing on its scale.
    """
    return read(name, scales(cell), is_by_set=cell.stress_of_set is not None)


def scales(cell: Cell) -> list[str]:
    """The scales on which some task of the cell has a value; the cell's own stress is the first."""
    return [OWN, *cell.exposures]


def worth(cell: Cell, scale: str, task: str, mode: Mode) -> dict[str, Decimal]:
    """Human -> what one execution of the task in this mode is on the scale; who has no value there
    is left out.
    """
    if scale == OWN:
        return {human: decimal(load) for human, load in mode.stress.items()}
    stated = cell.exposures.get(scale, {})
    return {who: stated[task, who] for who in mode.stress if (task, who) in stated}


def costs(cell: Cell, measure: Measure, task: str, mode: Mode) -> dict[str, Decimal]:
    """Human -> what the task in this mode adds to the measure of a cycle, or of `peak` what it is.

    Of `time-weighted` it is value x seconds, of `fatigue` RISE x value x minutes: the exponent of
    its envelope, see `envelope`.
    """
    seconds = decimal(mode.time)
    found = worth(cell, measure.scale, task, mode)
    counted = {who: cost(measure, value, seconds) for who, value in found.items()}
    return {who: each for who, each in counted.items() if each is not None}
