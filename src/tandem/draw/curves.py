"""Curves of a training: one line per quantity, the mean over seeds with its 95 % interval."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from tandem.draw.figure import axes_or_new
from tandem.draw.style import FAINT_INK, RULE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#D55E00", "#7F8FA6")
DASHES = ("-", "--", "-.", ":")


def plot_curves(
    lines: Mapping[str, tuple[Sequence[Sequence[float]], Sequence[Sequence[float]]]],
    ax: Axes | None = None,
    *,
    xlabel: str = "episodes",
    ylabel: str = "return",
    title: str = "",
    marks: Mapping[str, float] | None = None,
    levels: Mapping[str, float] | None = None,
) -> Axes:
    """Draws the lines and returns the axes.

    Args:
      lines: label -> (places, values), each one list per seed. Seeds may have points at different
        places: between its points a seed is read off its own straight lines, and the mean runs
        where all seeds have points.
      marks: label -> where on the x axis an upright line stands, such as the end of a stage.
      levels: label -> height of a level line, such as the exact optimum.
    """
    ax = axes_or_new(ax, (7.0, 4.2))
    for place, (label, (xs, ys)) in enumerate(lines.items()):
        colour, dash = (
            COLOURS[place % len(COLOURS)],
            DASHES[(place // len(COLOURS) + place) % len(DASHES)],
        )
        x, mean, half = band(xs, ys)
        ax.plot(x, mean, dash, color=colour, lw=1.8, label=label)
        if len(xs) > 1:
            ax.fill_between(x, mean - half, mean + half, color=colour, alpha=0.18, lw=0)
    for label, where in (marks or {}).items():
        ax.axvline(where, color=FAINT_INK, lw=0.8, ls=(0, (2, 3)), zorder=0)
        ax.annotate(
            label,
            (where, 0.02),
            xycoords=("data", "axes fraction"),
            rotation=90,
            ha="right",
            va="bottom",
            fontsize=8,
            color=FAINT_INK,
        )
    for label, height in (levels or {}).items():
        ax.axhline(height, color=FAINT_INK, lw=1.0, ls=(0, (6, 3)), zorder=0)
        ax.annotate(
            label,
            (1.0, height),
            xycoords=("axes fraction", "data"),
            ha="right",
            va="bottom",
            fontsize=8,
            color=FAINT_INK,
        )
    ax.set_xlabel(xlabel)
    ax.set_ylabel(ylabel)
    ax.set_title(title, loc="left", fontsize=11)
    ax.grid(True, color=RULE, lw=0.6)
    ax.spines[["top", "right"]].set_visible(False)
    if lines:
        ax.legend(frameon=False, fontsize=9)
    return ax


def band(
    xs: Sequence[Sequence[float]], ys: Sequence[Sequence[float]], points: int = 200
) -> tuple[Any, Any, Any]:
    """Places, mean over seeds and half width of its 95 % interval (normal approximation; 0 for one
    seed).
    """
    if len(xs) == 1:
        return np.asarray(xs[0]), np.asarray(ys[0]), np.zeros(len(ys[0]))
    x = np.linspace(max(min(seed) for seed in xs), min(max(seed) for seed in xs), points)
    read = np.array([np.interp(x, places, values) for places, values in zip(xs, ys, strict=True)])
    return x, read.mean(0), 1.96 * read.std(0, ddof=1) / len(xs) ** 0.5
