"""Pictures of schedules, fronts and precedence graphs: `ax` in, `ax` out. matplotlib is loaded when something is drawn, not before."""

from tandem.draw.figure import figure_for
from tandem.draw.front import plot_front
from tandem.draw.gantt import plot_gantt
from tandem.draw.saving import save

__all__ = ["figure_for", "plot_front", "plot_gantt", "save"]
