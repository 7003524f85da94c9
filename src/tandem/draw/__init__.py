"""Pictures of schedules, fronts and precedence graphs: `ax` in, `ax` out. matplotlib is loaded when
something is drawn, not before.
"""

from tandem.draw.compare import plot_compare
from tandem.draw.cycle_gantt import plot_cycle
from tandem.draw.cycle_overview import cycle_overview
from tandem.draw.figure import figure_for
from tandem.draw.front import plot_front
from tandem.draw.gantt import plot_gantt
from tandem.draw.graph import plot_graph
from tandem.draw.overview import overview
from tandem.draw.saving import save
from tandem.draw.yamazumi import plot_yamazumi

__all__ = [
    "cycle_overview",
    "figure_for",
    "overview",
    "plot_compare",
    "plot_cycle",
    "plot_front",
    "plot_gantt",
    "plot_graph",
    "plot_yamazumi",
    "save",
]
