"""Figures without a display, and how large they must be so that everything on them can be read."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from tandem.cell.model import Cell
from tandem.draw.language import Words
from tandem.draw.layers import Layers, layers
from tandem.schedule.model import Schedule

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

NODE = (1.5, 0.62)
"""Inches that one task takes in the precedence graph, box only."""
PITCH = (2.1, 0.84)
"""Inches from one task to the next, across and down."""
MOST_INCHES = 40.0
MARK, LETTER, BESIDE = 0.62, 0.07, 1.3
"""Inches that a legend's mark and one letter of its words take, and what lies to the left of the
axes under which it stands.
"""


def figure_for(cell: Cell, schedule: Schedule | None = None, *, kind: str = "gantt") -> Figure:
    """An empty figure with one axes, large enough for this cell: `figure_for(cell,
    schedule).axes[0]`.

    Args:
      kind: "gantt" for one schedule, "compare" for two, "graph" for the precedence graph, "front"
        for the trade-off.
    """
    sizes = {"gantt": gantt_size, "compare": compare_size}
    if kind == "graph":
        return blank(*graph_size(layers(cell)))
    return blank(*(sizes[kind](cell, schedule) if kind in sizes else (7.0, 4.8)))


def blank(width: float, height: float) -> Figure:
    """A figure of that many inches with one axes. It belongs to nobody: no window, no pyplot
    state.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    figure.add_subplot()
    return figure


def gantt_size(cell: Cell, schedule: Schedule | None = None) -> tuple[float, float]:
    """Inches for a Gantt chart: so wide that nearly every bar can hold an upright name, so high as
    there are lanes.
    """
    spans = sorted(a.end - a.start for a in schedule or ())
    narrow = spans[len(spans) // 16] / max(a.end for a in schedule) if schedule and spans else 1.0
    return min(max(10.0, 2.2 + 0.18 / max(narrow, 1e-6)), MOST_INCHES), 1.7 + 0.72 * len(
        cell.operators
    )


def compare_size(cell: Cell, schedule: Schedule | None = None) -> tuple[float, float]:
    """Inches for two Gantt charts over each other."""
    width, height = gantt_size(cell, schedule)
    return width, 2 * height - 0.2


def graph_size(drawn: Layers) -> tuple[float, float]:
    """Inches for the precedence graph: every task gets the same room, however many there are."""
    columns, rows = drawn.extent
    return max(5.0, columns * PITCH[0] + 0.6), max(2.6, rows * PITCH[1] + 1.1)


def axes_or_new(ax: Axes | None, size: tuple[float, float]) -> Axes:
    """The given axes, or those of a new figure of that size in inches."""
    return ax if ax is not None else blank(*size).axes[0]


def numbers_in(axis: Axis, t: Words) -> None:
    """Writes the numbers along an axis as the language does."""
    axis.set_major_formatter(lambda value, _: t.number(value))


def legend_below(ax: Axes, entries: Sequence[tuple[Artist, str]], *, inches: float = 0.52) -> None:
    """A legend that far under the axes, in as many columns as its figure is wide for."""
    from matplotlib.transforms import ScaledTranslation

    figure = ax.figure
    wide = MARK + LETTER * max((len(label) for _, label in entries), default=0)
    columns = max(1, min(len(entries), int((figure.bbox.width / figure.dpi - BESIDE) / wide)))
    below = ax.transAxes + ScaledTranslation(0, -inches, figure.dpi_scale_trans)
    handles, labels = [handle for handle, _ in entries], [label for _, label in entries]
    ax.legend(
        handles,
        labels,
        loc="upper left",
        bbox_to_anchor=(0, 0),
        bbox_transform=below,
        ncols=columns,
        frameon=False,
        fontsize=9,
        borderpad=0,
    )
