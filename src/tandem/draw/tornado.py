"""A tornado chart: how far each change moves a number, the largest on top."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from tandem.cell.written import number
from tandem.draw.figure import axes_or_new, legend_below
from tandem.draw.style import INK, RULE, shorten

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FILLS = (("#0072B2", ""), ("#E69F00", "///"))
"""Colour and hatch of the first and the second change, so that they differ without colour too."""
MOST_BARS = 25
ROW = 0.34
"""Inches for one row."""


def tornado_size(rows: int) -> tuple[float, float]:
    """Inches for a chart of so many rows."""
    return 8.0, 1.6 + ROW * min(max(rows, 1), MOST_BARS)


def plot_tornado(
    rows: Sequence[tuple[str, Mapping[str, float]]],
    ax: Axes | None = None,
    *,
    xlabel: str = "",
    title: str = "",
) -> Axes:
    """Draws one row for each label, with a bar from 0 for each of its changes, and returns the
    axes.

    Args:
      rows: label and the value of each change ("-10 %": -2.0), in the order in which they are
        drawn, the first on top; at most `MOST_BARS`.
    """
    ax = axes_or_new(ax, tornado_size(len(rows)))
    shown = list(rows[:MOST_BARS])
    changes = list(dict.fromkeys(change for _, values in shown for change in values))
    height = 0.78 / max(len(changes), 1) if _same_side(shown) else 0.62
    for place, (_, values) in enumerate(shown):
        for which, change in enumerate(changes):
            if change in values:
                y = place + (which - (len(changes) - 1) / 2) * height * _same_side(shown)
                _bar(ax, y, values[change], height, which)
    ax.axvline(0, color=INK, lw=1)
    ax.set_yticks(range(len(shown)), [shorten(label, 40) for label, _ in shown])
    ax.set_ylim(len(shown) - 0.5, -0.5)
    ax.set_xlabel(xlabel)
    ax.grid(axis="x", color=RULE, lw=0.6)
    ax.set_axisbelow(True)
    ax.margins(x=0.16)
    for side in ("top", "right", "left"):
        ax.spines[side].set_visible(False)
    ax.tick_params(axis="y", length=0)
    rest = len(rows) - len(shown)
    ax.set_title(
        title + (f" (the first {len(shown)} of {len(rows)})" if rest else ""),
        loc="left",
        fontsize=11,
        fontweight="bold",
    )
    if len(changes) > 1:
        _legend(ax, changes)
    return ax


def _same_side(rows: Sequence[tuple[str, Mapping[str, float]]]) -> bool:
    """Two bars of a row point the same way, so that they must lie side by side."""
    return any(
        sum(value > 0 for value in values.values()) > 1
        or sum(value < 0 for value in values.values()) > 1
        for _, values in rows
    )


def _bar(ax: Axes, y: float, value: float, height: float, which: int) -> None:
    colour, hatch = FILLS[which % len(FILLS)]
    ax.barh(
        y,
        value,
        height,
        color=colour,
        hatch=hatch,
        edgecolor="white" if hatch else colour,
        lw=0.5,
        gid="effect",
    )
    if value:
        ax.annotate(
            number(value),
            (value, y),
            xytext=(4 if value > 0 else -4, 0),
            textcoords="offset points",
            va="center",
            ha="left" if value > 0 else "right",
            fontsize=9,
        )


def _legend(ax: Axes, changes: Sequence[str]) -> None:
    from matplotlib.patches import Patch

    legend_below(
        ax,
        [
            (Patch(facecolor=FILLS[i % 2][0], hatch=FILLS[i % 2][1], edgecolor="white"), change)
            for i, change in enumerate(changes)
        ],
    )
