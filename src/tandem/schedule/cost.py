"""What a piece costs: the hour of the station, spread over the pieces that it makes in it."""

from __future__ import annotations

from decimal import Decimal

from tandem.cell.model import Cell
from tandem.schedule.measures import exact

SECONDS_AN_HOUR = 3600
PLACES = Decimal("0.0001")
"""Costs are rounded to a hundredth of a cent."""


def cost_of_an_hour(cell: Cell) -> float | None:
    """Operators, station and the invested money, spread over its hours; None when the cell states
    no cost.
    """
    if cell.cost is None:
        return None
    cost = cell.cost
    hour = sum(map(exact, cost.operators.values()), exact(cost.station))
    if cost.hours is not None:
        hour += exact(cost.invest) / exact(cost.hours)
    return float(hour)


def cost_of_a_piece(cell: Cell, seconds: float) -> float | None:
    """What a piece costs that comes out every so many seconds: the cycle time, or the makespan
    where the station makes one piece at a time. None when the cell states no cost.
    """
    hour = cost_of_an_hour(cell)
    if hour is None:
        return None
    return float((exact(hour) * exact(seconds) / SECONDS_AN_HOUR).quantize(PLACES))
