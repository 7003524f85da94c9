"""Results for people: tables and charts in the terminal, files to pass on."""

from tandem.report.files import ready_to_write, write
from tandem.report.html import write_html
from tandem.report.progress import SolveProgress
from tandem.report.terminal import FrontView, GanttText, front_table

__all__ = [
    "FrontView",
    "GanttText",
    "SolveProgress",
    "front_table",
    "ready_to_write",
    "write",
    "write_html",
]
