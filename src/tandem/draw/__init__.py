"""Pictures of schedules, fronts and precedence graphs: `ax` in, `ax` out. matplotlib is loaded when
something is drawn, not before.
"""

from tandem.draw.compare import plot_compare
from tandem.draw.figure import figure_for
from tandem.draw.front import plot_front
from tandem.draw.gantt import plot_gantt
from tandem.draw.graph import plot_graph
from tandem.draw.overview import overview
from tandem.draw.saving import save

__all__ = [
    "figure_for",
    "overview",
    "plot_compare",
    "plot_front",
    "plot_gantt",
    "plot_graph",
    "save",
]
