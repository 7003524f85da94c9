"""Results for people: tables and charts in the terminal, files to pass on."""

from tandem.report.progress import SolveProgress
from tandem.report.terminal import FrontView, GanttText, front_table

__all__ = ["FrontView", "GanttText", "SolveProgress", "front_table"]
