"""Results for people: tables and charts in the terminal, files to pass on."""

from tandem.report.files import check_ending, export
from tandem.report.html import write_html
from tandem.report.progress import SolveProgress
from tandem.report.terminal import FrontView, GanttText, front_table

__all__ = ["FrontView", "GanttText", "SolveProgress", "check_ending", "export", "front_table", "write_html"]
