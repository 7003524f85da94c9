"""Pictures of Antonelli et al. (2021) run here: time against p, from where the goal is reached, how
precise the learned values are, the product.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from tandem.draw.curves import COLOURS, DASHES
from tandem.draw.figure import blank, figure_for
from tandem.draw.graph import plot_graph
from tandem.draw.style import FAINT_INK, INK, RULE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def figures(document: Mapping[str, Any]) -> Iterator[tuple[str, Figure]]:
    """Name and figure, one after the other."""
    from tandem.lab.antonelli2021.cells import own_cell

    cell = own_cell()
    figure = figure_for(cell, kind="graph")
    plot_graph(cell, ax=figure.axes[0])
    yield "product", figure
    for name, found in document["cells"].items():
        yield f"time-{name}", times(found)
        yield f"reached-{name}", reached(found)
    yield "precision", precision(document["precision"])


def times(found: Mapping[str, Any]) -> Figure:
    """Expected time against p, from the empty table: the exact curve, and the median of each
    player's seeds.

    A seed that may go on for ever counts as infinite; where that is so for half of them, the
    player's line ends.
    """
    ax = _axes()
    chances = [row["p"] for row in found["exact"]]
    ax.plot(
        chances,
        [row["expected_s"] for row in found["exact"]],
        color=INK,
        lw=5,
        alpha=0.25,
        label="exact (value iteration)",
        solid_capstyle="round",
    )
    for index, player in enumerate(_players(found)):
        rows = [row for row in found["players"] if row["player"] == player]
        median = [
            float(np.median([np.inf if value is None else value for value in row["expected_s"]]))
            for row in rows
        ]
        kept = [
            (row["p"], value) for row, value in zip(rows, median, strict=True) if np.isfinite(value)
        ]
        ax.plot(
            *zip(*kept, strict=True),
            DASHES[index % 4],
            marker="o",
            ms=4,
            color=COLOURS[index],
            lw=1.8,
            label=player,
        ) if kept else None
    return _dressed(ax, found, "expected time from the empty table, s", log=True)


def reached(found: Mapping[str, Any]) -> Figure:
    """The share of episodes from any state that end within 200 operations, mean over seeds with its
    95 % interval, against p.
    """
    ax = _axes()
    for index, player in enumerate(_players(found)):
        rows = [row for row in found["players"] if row["player"] == player]
        shares = np.array([row["finished_from_anywhere"] for row in rows])
        mean = shares.mean(axis=1)
        half = (
            1.96 * shares.std(axis=1, ddof=1) / np.sqrt(shares.shape[1])
            if shares.shape[1] > 1
            else np.zeros(len(mean))
        )
        chances = [row["p"] for row in rows]
        ax.plot(
            chances,
            mean,
            DASHES[index % 4],
            marker="o",
            ms=4,
            color=COLOURS[index],
            lw=1.8,
            label=player,
        )
        ax.fill_between(
            chances, mean - half, np.minimum(mean + half, 1), color=COLOURS[index], alpha=0.15, lw=0
        )
    ax.set_ylim(0, 1.03)
    return _dressed(ax, found, "share that ends within 200 operations, from any state")


def precision(rows: list[Mapping[str, Any]]) -> Figure:
    """The largest difference of a learned value from the exact one, against the updates made."""
    chances = list(dict.fromkeys(row["p"] for row in rows))
    figure = blank(4.6 * len(chances), 4.4)
    figure.clear()
    panels = figure.subplots(1, len(chances), squeeze=False, sharey=True)[0]
    for ax, p in zip(panels, chances, strict=True):
        for index, row in enumerate(row for row in rows if row["p"] == p):
            error = np.maximum(row["error_s"], 1e-6)
            ax.plot(
                row["updates"],
                error,
                DASHES[index % 4],
                color=COLOURS[index],
                lw=1.6,
                label=row["way"],
            )
        ax.axhline(1e-3, color=FAINT_INK, lw=1.0, ls=(0, (6, 3)), zorder=0)
        ax.set(xscale="log", yscale="log", xlabel="updates")
        ax.set_title(f"p = {p:g}", loc="left", fontsize=11)
        _plain(ax)
        # the first panel's legend serves all but the ways that are of this p alone
        only_here = [line for line in ax.get_lines() if line.get_label() in own_ways(rows, p)]
        if only_here:
            ax.legend(handles=only_here, frameon=False, fontsize=8, loc="lower left")
    panels[0].set_ylabel("largest difference from the exact value, s")
    panels[0].legend(frameon=False, fontsize=8, loc="upper right")
    return figure


def own_ways(rows: list[Mapping[str, Any]], p: float) -> set[str]:
    """The ways of learning that were tried at this p and not at the first."""
    first = rows[0]["p"]
    return {row["way"] for row in rows if row["p"] == p} - {
        row["way"] for row in rows if row["p"] == first
    }


def _players(found: Mapping[str, Any]) -> list[str]:
    return list(dict.fromkeys(row["player"] for row in found["players"]))


def _axes() -> Axes:
    return blank(7.4, 4.6).axes[0]


def _dressed(ax: Axes, found: Mapping[str, Any], label: str, *, log: bool = False) -> Figure:
    ax.set_xlabel("p: how often the human does something else than what was asked for")
    ax.set_ylabel(label)
    if log:
        ax.set_yscale("log")
        ax.yaxis.set_major_formatter("{x:,.0f}")
        ax.yaxis.set_minor_formatter("{x:,.0f}")
        ax.tick_params(axis="y", which="minor", labelsize=8)
    ax.set_title(found["cell"], loc="left", fontsize=11)
    _plain(ax)
    ax.legend(frameon=False, fontsize=9)
    figure = ax.get_figure(root=True)
    assert figure is not None
    return figure


def _plain(ax: Axes) -> None:
    ax.grid(True, color=RULE, lw=0.6)
    ax.spines[["top", "right"]].set_visible(False)
