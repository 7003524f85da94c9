"""How a world that refuses a cell names its crew."""

from __future__ import annotations

from tandem.cell.model import Cell


def enumerated_crew(cell: Cell) -> str:
    """How many of each kind the cell has, as in "1 robot and 2 humans"; machines where there are
    some.
    """
    counts = [("robot", len(cell.robots)), ("human", len(cell.humans))]
    counts += [("machine", len(cell.machines))] if cell.machines else []
    *most, last = (f"{count} {kind}{'s' * (count != 1)}" for kind, count in counts)
    return f"{', '.join(most)} and {last}"
