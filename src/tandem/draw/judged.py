"""What the judge found, as pictures: how times are distributed, regret by how far people deviate,
and differences pair by pair.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from tandem.draw.curves import COLOURS
from tandem.draw.figure import axes_or_new
from tandem.draw.style import FAINT_INK, INK, RULE, shorten

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Judged = Mapping[str, Any]
"""A document of `tandem simulate --json`."""

MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*")
"""One for each policy, so that they differ without colour too."""
ROW = 0.42
"""Inches for one policy."""


def judged_figure(documents: Sequence[Judged]) -> Figure:
    """All that can be drawn of these documents of one cell: for one, distribution and differences;
    for several, regret by deviation as well.
    """
    from matplotlib.figure import Figure

    first = documents[0]
    rows = max(2.4, 1.3 + ROW * len(first["policies"]))
    strips = [rows] * len(documents) if len(documents) <= 3 else [rows] * 3
    shows_regret = len(documents) > 1 and any(
        document["optimum"] is not None for document in documents
    )
    heights = [*([4.4] if shows_regret else []), *strips]
    figure = Figure(figsize=(11.0, sum(heights) + 0.4), layout="constrained")
    figure.suptitle(
        shorten(first["cell"] or "cell", 100),
        x=0.01,
        ha="left",
        fontsize=13,
        fontweight="bold",
        parse_math=False,
    )
    grid = figure.add_gridspec(len(heights), 2, height_ratios=heights)
    if shows_regret:
        plot_regret(documents, figure.add_subplot(grid[0, :]))
    for place, document in enumerate(documents[: len(strips)], start=int(shows_regret)):
        plot_distribution(document, figure.add_subplot(grid[place, 0]))
        plot_differences(document, figure.add_subplot(grid[place, 1]))
    return figure


def plot_distribution(document: Judged, ax: Axes | None = None) -> Axes:
    """Per policy the makespan: a line from 5 to 95 %, a box from 25 to 75 %, a stroke at the
    median, the mean as a dot. Returns the axes.
    """
    rows = document["policies"]
    ax = axes_or_new(ax, (6.0, 1.3 + ROW * len(rows)))
    for place, row in enumerate(rows):
        time, colour = row["makespan"], COLOURS[place % len(COLOURS)]
        ax.plot([time["p5"], time["p95"]], [place, place], color=colour, lw=1.4)
        ax.barh(
            place,
            time["p75"] - time["p25"],
            0.5,
            time["p25"],
            color=colour,
            alpha=0.35,
            edgecolor=colour,
        )
        ax.plot([time["p50"]] * 2, [place - 0.25, place + 0.25], color=colour, lw=2)
        ax.plot(time["mean"], place, MARKERS[place % len(MARKERS)], color=INK, ms=4.5)
    if document["optimum"] is not None and document["weights"] == [1, 0]:
        ax.axvline(document["optimum"], color=FAINT_INK, lw=1, ls=(0, (6, 3)), zorder=0)
    return _by_policy(
        ax,
        rows,
        "makespan, s (5 to 95 %, middle half, mean; dashed: exact optimum)",
        f"beside {shorten(document['people'], 40)}",
    )


def plot_differences(document: Judged, ax: Axes | None = None) -> Axes:
    """Per policy, how much more it costs than the first one in the same episodes, with the 95 %
    interval. Returns the axes.
    """
    rows = document["policies"]
    ax = axes_or_new(ax, (6.0, 1.3 + ROW * len(rows)))
    for place, row in enumerate(rows):
        difference = row.get("difference", {"mean": 0.0, "ci95": [0.0, 0.0]})
        low, high = difference["ci95"]
        colour = COLOURS[place % len(COLOURS)]
        ax.plot([low, high], [place, place], color=colour, lw=2.4, solid_capstyle="butt")
        ax.plot(difference["mean"], place, MARKERS[place % len(MARKERS)], color=colour, ms=6)
    ax.axvline(0, color=INK, lw=0.8, zorder=0)
    return _by_policy(
        ax,
        rows,
        f"cost above {document['compared_with']}, same episodes (mean, 95 %)",
        "pair by pair",
    )


def plot_regret(documents: Sequence[Judged], ax: Axes | None = None) -> Axes:
    """Per policy, how far it is above the exact optimum beside each of the people, in %, with 95 %
    intervals. Returns the axes.

    People who are the same kind with another number lie at their numbers; others side by side.
    """
    ax = axes_or_new(ax, (9.0, 4.4))
    known = [document for document in documents if document["optimum"] is not None]
    places = _places([document["people"] for document in known])
    names = list(dict.fromkeys(row["policy"] for document in known for row in document["policies"]))
    for number, name in enumerate(names):
        x, y, low, high = [], [], [], []
        for place, document in zip(places, known, strict=True):
            row = next((row for row in document["policies"] if row["policy"] == name), None)
            if row is not None:
                x.append(place)
                y.append(100 * row["regret"] / document["optimum"])
                low.append(100 * row["regret_ci95"][0] / document["optimum"])
                high.append(100 * row["regret_ci95"][1] / document["optimum"])
        colour, mark = COLOURS[number % len(COLOURS)], MARKERS[number % len(MARKERS)]
        ax.plot(
            x,
            y,
            "-" if number < len(COLOURS) else "--",
            marker=mark,
            color=colour,
            lw=1.6,
            ms=5.5,
            label=name,
        )
        ax.vlines(x, low, high, color=colour, lw=1.2)
    ax.set_xticks(
        places,
        [shorten(document["people"], 24) for document in known],
        rotation=20 if len(known) > 5 else 0,
        ha="right" if len(known) > 5 else "center",
    )
    ax.axhline(0, color=FAINT_INK, lw=0.8)
    ax.set_ylabel("above the exact optimum, %")
    ax.set_title("Regret by who works there", loc="left", fontsize=11)
    ax.grid(axis="y", color=RULE, lw=0.6)
    ax.spines[["top", "right"]].set_visible(False)
    ax.legend(frameon=False, fontsize=9, ncols=2)
    return ax


def _places(people: Sequence[str]) -> list[float]:
    """Where each of the people stands on the axis: at its number when all are one kind with one
    number, else in order.
    """
    parts = [re.fullmatch(r"(\w+):([\d.]+)", one) for one in people]
    if all(parts) and len({part[1] for part in parts if part}) == 1:
        numbers = [float(part[2]) for part in parts if part]
        if len(set(numbers)) == len(numbers):
            return numbers
    return [float(place) for place in range(len(people))]


def _by_policy(ax: Axes, rows: Sequence[Mapping[str, Any]], xlabel: str, title: str) -> Axes:
    ax.set_yticks(range(len(rows)), [row["policy"] for row in rows])
    ax.set_ylim(len(rows) - 0.5, -0.5)
    ax.set_xlabel(xlabel)
    ax.set_title(title, loc="left", fontsize=11)
    ax.grid(axis="x", color=RULE, lw=0.6)
    ax.set_axisbelow(True)
    ax.use_sticky_edges = False
    ax.margins(x=0.08)
    ax.spines[["top", "right", "left"]].set_visible(False)
    ax.tick_params(axis="y", length=0)
    return ax
