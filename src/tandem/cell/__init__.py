"""The ground: what a cell is made of, the rules that it keeps, and what is known of its work."""

from tandem.cell.model import Cell
from tandem.cell.parts import Mode, Operator, Task, Together, Tool, Zone

__all__ = ["Cell", "Mode", "Operator", "Task", "Together", "Tool", "Zone"]
