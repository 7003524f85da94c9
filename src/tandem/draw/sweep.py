"""What a sweep found, as pictures: performance profiles, and interquartile means with intervals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from tandem.draw.curves import COLOURS, DASHES
from tandem.draw.figure import axes_or_new
from tandem.draw.judged import MARKERS
from tandem.draw.style import FAINT_INK, RULE, shorten

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

TITLES = {"plan": "Planning", "dispatch": "Dispatch beside people"}
ROW = 0.36
"""Inches for one who was asked."""


def sweep_figure(document: Mapping[str, Any]) -> Figure:
    """Both pictures of each kind that was swept, side by side.

    Args:
      document: of `tandem bench show --json`.
    """
    from matplotlib.figure import Figure

    parts = document["tables"]
    heights = [max(3.6, 1.4 + ROW * len(part["rows"])) for part in parts]
    figure = Figure(figsize=(12.0, sum(heights, 0.5)), layout="constrained")
    figure.suptitle(
        shorten(document["name"] or "Sweep", 100),
        x=0.01,
        ha="left",
        fontsize=13,
        fontweight="bold",
        parse_math=False,
    )
    grid = figure.add_gridspec(len(parts), 2, height_ratios=heights)
    for place, part in enumerate(parts):
        title = TITLES[part["kind"]]
        plot_intervals(part["rows"], figure.add_subplot(grid[place, 0]), title=title)
        names = [row["who"] for row in part["rows"]]
        plot_profiles(part["profiles"], names, figure.add_subplot(grid[place, 1]), title=title)
    return figure


def plot_intervals(
    rows: Sequence[Mapping[str, Any]], ax: Axes | None = None, *, title: str = ""
) -> Axes:
    """Per row the interquartile mean of its proximity with the 95 % interval; the optimum is at 1.
    Returns the axes.
    """
    ax = axes_or_new(ax, (6.0, 1.4 + ROW * len(rows)))
    for place, row in enumerate(rows):
        if row["iqm"] is None:
            continue
        colour = COLOURS[place % len(COLOURS)]
        low, high = row["iqm_ci95"]
        ax.plot([low, high], [place, place], color=colour, lw=5, alpha=0.45, solid_capstyle="butt")
        ax.plot(row["iqm"], place, MARKERS[place % len(MARKERS)], color=colour, ms=6)
    ax.axvline(1.0, color=FAINT_INK, lw=1, ls=(0, (6, 3)), zorder=0)
    names = [shorten(row["who"], 32) for row in rows]
    ax.set_yticks(range(len(rows)), names, parse_math=False)
    ax.set_ylim(len(rows) - 0.5, -0.5)
    ax.set_xlabel("proximity to the optimum (interquartile mean, 95 %; dashed: optimum)")
    ax.set_title(title, loc="left", fontsize=11)
    ax.grid(axis="x", color=RULE, lw=0.6)
    ax.set_axisbelow(True)
    ax.use_sticky_edges = False
    ax.margins(x=0.06)
    ax.spines[["top", "right", "left"]].set_visible(False)
    ax.tick_params(axis="y", length=0)
    return ax


def plot_profiles(
    profiles: Mapping[str, Any],
    names: Sequence[str],
    ax: Axes | None = None,
    *,
    title: str = "",
) -> Axes:
    """Per name the share of its jobs that are within a gap of the optimum, with 95 % bands; the
    higher the better. Returns the axes.
    """
    ax = axes_or_new(ax, (6.0, 3.6))
    gaps = [100 * gap for gap in profiles["gaps"]]
    for place, name in enumerate(names):
        if name not in profiles["lines"]:
            continue
        line, colour = profiles["lines"][name], COLOURS[place % len(COLOURS)]
        ax.plot(
            gaps,
            line["share"],
            DASHES[place % len(DASHES)],
            drawstyle="steps-post",
            color=colour,
            lw=1.8,
            label=shorten(name, 32),
        )
        ax.fill_between(
            gaps, line["low"], line["high"], step="post", color=colour, alpha=0.15, lw=0
        )
    ax.set_ylim(-0.02, 1.02)
    ax.set_xlabel("gap to the optimum, %")
    ax.set_ylabel("share of jobs within the gap")
    ax.set_title("Performance profile" + (f": {title}" if title else ""), loc="left", fontsize=11)
    ax.grid(color=RULE, lw=0.6)
    ax.spines[["top", "right"]].set_visible(False)
    if profiles["lines"]:
        ax.legend(frameon=False, fontsize=9, loc="lower right")
    return ax
