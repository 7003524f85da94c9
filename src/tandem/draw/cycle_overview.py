"""One picture of a front of cycle times for a slide or a mail: the trade-off and the load of each
operator on top, two cycles of one pattern below.
"""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

from tandem.draw.cycle_gantt import cycle_size, plot_cycle
from tandem.draw.front import plot_front
from tandem.draw.imprint import imprint
from tandem.draw.language import words
from tandem.draw.style import FAINT_INK
from tandem.draw.yamazumi import plot_yamazumi, yamazumi_size
from tandem.plan.cycle.result import CycleFront

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FRONT = 6.4
"""Inches across for the trade-off."""


def cycle_overview(
    front: CycleFront, *, language: str = "en", point: int | None = None, stale: bool = False
) -> Figure:
    """The front, the Yamazumi chart and the Gantt chart of one point on one figure, with the
    pattern's digest at the foot; the front alone when it is empty.

    Args:
      point: counted from 1; the knee when not given.
      stale: the cell has changed since, which the foot says.

    Raises UsageError when pictures do not speak the language.
    """
    from matplotlib.figure import Figure

    t = words(language)
    if not len(front):
        figure = Figure(figsize=(10.0, 5.2), layout="constrained")
        plot_front(front, figure.add_subplot(), language=language)
        return figure
    result = front.shown(point)
    long, high = cycle_size(front.cell, result.periodic)
    load, tall = yamazumi_size(front.cell)
    width = max(long, FRONT + load)
    figure = Figure(figsize=(width, high + tall + 1.3), layout="constrained")
    figure.get_layout_engine().set(h_pad=0.12, w_pad=0.1, hspace=0.06)  # type: ignore[union-attr, call-arg]
    if front.cell.name:
        figure.suptitle(
            "\n".join(textwrap.wrap(front.cell.name, int(9 * width))),
            x=0.01,
            ha="left",
            fontsize=14,
            fontweight="bold",
            parse_math=False,
        )
    grid = figure.add_gridspec(2, 2, height_ratios=[tall, high], width_ratios=[width - load, load])
    plot_front(front, figure.add_subplot(grid[0, 0]), language=language, point=point)
    takt = front.question.takt
    plot_yamazumi(
        front.cell, result.periodic, figure.add_subplot(grid[0, 1]), takt=takt, language=language
    )
    kind = "recommended" if result is front.knee else "shown"
    plot_cycle(
        front.cell,
        result.periodic,
        figure.add_subplot(grid[1, :]),
        title=t(
            f"cycle.picture.{kind}" if len(front) > 1 else "cycle.picture",
            cycle_time=t.seconds(result.cycle_time),
            stress=t.number(result.stress),
        ),
        language=language,
    )
    foot = imprint(result, t, stale=stale)
    figure.supxlabel(foot, x=0.99, ha="right", fontsize=8, color=FAINT_INK)
    return figure
