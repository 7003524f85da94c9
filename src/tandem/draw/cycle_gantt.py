"""A station that repeats as a Gantt chart: the steady state over two cycles, with every product
that is in the station then.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from tandem.cell.model import Cell
from tandem.draw.figure import axes_or_new, gantt_size, legend_below
from tandem.draw.gantt import draw_lanes, dress, joint_links, legend_entries
from tandem.draw.lanes import Lane, product_mark, products_shown, steady_lanes
from tandem.draw.language import Words, words
from tandem.draw.style import FAINT_INK, INK, SHADES, shade_of, tint
from tandem.schedule.cycle import PeriodicSchedule
from tandem.schedule.measures import stress
from tandem.schedule.model import Assignment, Schedule

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

CYCLES = 2


def plot_cycle(
    cell: Cell,
    periodic: PeriodicSchedule,
    ax: Axes | None = None,
    *,
    cycles: int = CYCLES,
    title: str | None = None,
    legend: bool = True,
    language: str = "en",
) -> Axes:
    """Draws the steady state over so many cycles and returns the axes.

    A product has one shade, and a mark in its bars: "#1" is launched with the first cycle that is
    shown, "-1" a cycle before. Lines say where a cycle ends and the next product is launched. What
    runs over an edge of the chart goes on there: the pattern repeats.

    Args:
      periodic: a sound periodic schedule of the cell.
      title: what stands above; cycle time and stress when absent, nothing when empty.
      legend: whether marks are explained below the chart; only those that occur.
      language: of the words and the decimal mark.

    Raises UsageError when pictures do not speak the language.
    """
    t = words(language)
    ax = axes_or_new(ax, cycle_size(cell, periodic, cycles))
    rows = steady_lanes(cell, periodic, cycles)
    ax.set_xlim(0, cycles * periodic.cycle_time)
    ax.set_ylim(len(rows) - 0.45, -0.55)
    draw_lanes(ax, rows, t)
    joint_links(ax, rows)
    _boundaries(ax, periodic.cycle_time, cycles, t)
    if title is None:
        title = t(
            "cycle.picture",
            cycle_time=t.seconds(periodic.cycle_time),
            stress=t.number(stress(cell, periodic.schedule)),
        )
    dress(ax, rows, title, t)
    if legend:
        entries = legend_entries(rows, t, critical=False)
        legend_below(ax, [*entries, *_products(rows, periodic.cycle_time, t)])
    return ax


def cycle_size(cell: Cell, periodic: PeriodicSchedule, cycles: int = CYCLES) -> tuple[float, float]:
    """Inches for the chart: as wide as a Gantt chart of that many seconds has to be."""
    spans = [(a.end - a.start, a) for a in periodic]
    end = cycles * periodic.cycle_time
    cut = Schedule(
        tuple(Assignment(max(end - span, 0.0), end, a.task, a.operators) for span, a in spans)
    )
    return gantt_size(cell, cut)


def _boundaries(ax: Axes, length: float, cycles: int, t: Words) -> None:
    """A line where a cycle ends, with its time; above, which cycle it is."""
    for cycle in range(1, cycles + 1):
        # under the bars: one that runs on into the next cycle hides it, and its name stays legible
        ax.axvline(cycle * length, color=INK, lw=1.8, ls=(0, (6, 2)), zorder=1.9, gid="boundary")
        ax.annotate(
            t.seconds(cycle * length),
            (cycle * length, 1),
            (-3, 3),
            xycoords=("data", "axes fraction"),
            textcoords="offset points",
            ha="right",
            va="bottom",
            fontsize=9.5,
        )
        ax.annotate(
            t("cycle.number", n=cycle),
            ((cycle - 0.5) * length, 1),
            (0, 3),
            xycoords=("data", "axes fraction"),
            textcoords="offset points",
            ha="center",
            va="bottom",
            fontsize=9.5,
            color=FAINT_INK,
        )


def _products(rows: Sequence[Lane], length: float, t: Words) -> list[tuple[Artist, str]]:
    """The shades of the products, and when each was launched."""
    from matplotlib.patches import Patch

    entries: list[tuple[Artist, str]] = []
    for product in products_shown(rows):
        fill = tint(FAINT_INK, SHADES[shade_of(product)])
        told = t(
            "cycle.product",
            mark=product_mark(product),
            moment=t.seconds(product * length),
        )
        entries.append((Patch(facecolor=fill, edgecolor=FAINT_INK), told))
    return entries
