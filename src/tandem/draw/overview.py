"""One picture of a front for a slide or a mail: the trade-off on top, one plan below."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

from tandem.draw.figure import gantt_size
from tandem.draw.front import plot_front
from tandem.draw.gantt import plot_gantt
from tandem.draw.imprint import imprint
from tandem.draw.language import words
from tandem.draw.style import FAINT_INK
from tandem.plan.result import Front

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def overview(
    front: Front, *, language: str = "en", point: int | None = None, stale: bool = False
) -> Figure:
    """The front and the Gantt chart of one point on one figure, with the plan's digest at the foot;
    the front alone when it is empty.

    Args:
      point: counted from 1; the knee when not given.
      stale: the cell has changed since, which the foot says.

    Raises UsageError when pictures do not speak the language.
    """
    from matplotlib.figure import Figure

    width, height = (
        gantt_size(front.cell, front.shown(point).schedule) if len(front) else (10.0, 0.0)
    )
    figure = Figure(figsize=(width, height + 5.2), layout="constrained")
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
    if not len(front):
        plot_front(front, figure.add_subplot(), language=language)
        return figure
    grid = figure.add_gridspec(2, 1, height_ratios=[4.4, height])
    plot_front(front, figure.add_subplot(grid[0]), language=language, point=point)
    result, t = front.shown(point), words(language)
    kind = "recommended" if result is front.knee else "shown"
    key = f"picture.plan.{kind}" if len(front) > 1 else "picture.plan"
    plot_gantt(
        front.cell,
        result.schedule,
        figure.add_subplot(grid[1]),
        title=t(key, makespan=t.seconds(result.makespan), stress=t.number(result.stress)),
        language=language,
    )
    foot = imprint(result, t, stale=stale)
    figure.supxlabel(foot, x=0.99, ha="right", fontsize=8, color=FAINT_INK)
    return figure
