"""The ground: operators, tasks, precedence; cell files and public formats; generators."""

from tandem.cell.model import Cell
from tandem.cell.parts import Mode, Operator, Task, Together, Tool, Zone

__all__ = ["Cell", "Mode", "Operator", "Task", "Together", "Tool", "Zone"]
