"""Figures of the chessboard experiment: the boards, games on the desk as film strips, gaps,
learning curves, troubles.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from tandem.draw.curves import COLOURS, plot_curves
from tandem.draw.figure import blank
from tandem.draw.style import FAINT_INK, RULE
from tandem.lab.yu2020.board import desk, random_board
from tandem.lab.yu2020.board_picture import board_size, plot_board, plot_film
from tandem.lab.yu2020.pictures import film
from tandem.lab.yu2020.play import follow, play
from tandem.lab.yu2020.runs import RECIPES

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Document = Mapping[str, Any]
DEMONSTRATION = 34
"""The seed of the authors' demonstration."""


def figures(document: Document) -> Iterator[tuple[str, Figure]]:
    """Name and figure, one after the other."""
    for name, board in (
        ("board-desk", desk()),
        ("board-demonstration", random_board(seed=DEMONSTRATION)),
    ):
        figure = blank(*board_size(board))
        plot_board(board, figure.axes[0])
        yield name, figure
    for who, columns in document["films"].items():
        game = play(desk(), follow(columns))
        figure = plot_film(desk(), film(game))
        figure.suptitle(
            f"The desk, played by: {who} ({game.makespan} s)", x=0.01, ha="left", fontsize=11
        )
        yield "film-" + who.replace(", ", "-").replace(" ", "-"), figure
    yield "gaps", gaps(document)
    yield "troubles", troubles(document)
    yield "learning-curves", curves(document)


def gaps(document: Document) -> Figure:
    """Mean gap to the optimum with waiting, a bar a player."""
    rows = [row for row in document["summary"] if "gap" in row]
    rows.sort(key=lambda row: -row["gap"]["mean"])
    names = [_named(row) for row in rows]
    figure = blank(8.2, 0.32 * len(rows) + 1.3)
    _bars(
        figure.axes[0],
        names,
        [100 * row["gap"]["mean"] for row in rows],
        [100 * (row["gap"]["ci95"] or 0) for row in rows],
        "%",
    )
    number = len(document["exact"]["test"]["seeds"])
    figure.axes[0].set_xlabel(f"gap to the proven optimum with waiting, mean of {number} boards, %")
    return figure


def troubles(document: Document) -> Figure:
    """Seconds that each decider loses, a panel a degree of trouble."""
    degrees = list(dict.fromkeys(row["troubles"] for row in document["troubles"]))
    deciders = list(dict.fromkeys(row["decider"] for row in document["troubles"]))
    figure = blank(9.5, 0.34 * len(deciders) + 1.5)
    figure.clear()
    for ax, degree in zip(
        figure.subplots(1, len(degrees), squeeze=False).flat, degrees, strict=True
    ):
        own = {
            row["decider"]: np.mean(row["rough"])
            for row in document["troubles"]
            if row["troubles"] == degree
        }
        calm = {
            row["decider"]: np.mean(row["calm"])
            for row in document["troubles"]
            if row["troubles"] == degree
        }
        ax.barh(
            deciders,
            [calm[name] for name in deciders],
            color=COLOURS[0],
            label="nothing goes wrong",
        )
        ax.barh(
            deciders,
            [own[name] - calm[name] for name in deciders],
            left=[calm[name] for name in deciders],
            color=COLOURS[1],
            label="lost",
        )
        _dressed(ax)
        ax.set_xlim(0, 1.02 * max(own.values()))
        ax.set_title(f"{degree} trouble", loc="left", fontsize=11)
        ax.set_xlabel("seconds, mean")
    figure.axes[-1].set_yticklabels([])
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower left", ncols=2, frameon=False, fontsize=9)
    return figure


def curves(document: Document) -> Figure:
    """What each recipe takes over its games of self-play, by the network alone and with its search:
    mean over seeds, and its 95 % interval. Left random boards that it does not train on, right the
    desk.
    """
    figure = blank(11.0, 4.6)
    figure.clear()
    rules, exact = (
        {row["player"]: row for row in document["plain"]},
        document["exact"]["desk"]["no_waiting"]["makespan"],
    )
    for ax, place in zip(figure.subplots(1, 2), ("boards", "desk"), strict=True):
        lines: dict[str, tuple[list[list[float]], list[list[float]]]] = {}
        for recipe in RECIPES:
            own = [
                record["curve"]
                for record in document["records"]
                if (record["recipe"], record["trained_on"]) == (recipe, place) and record["curve"]
            ]
            if own:
                lines |= {
                    f"{recipe}, {player}": _line(own, seen)
                    for player, seen in (("network", "held"), ("search", "searched"))
                }
        levels = (
            {"longest tail": rules["longest-tail"]["desk"], "optimum": exact}
            if place == "desk"
            else {}
        )
        title = "on the desk" if place == "desk" else "on boards it does not train on"
        plot_curves(
            lines, ax, xlabel="games of self-play", ylabel="seconds", title=title, levels=levels
        )
    return figure


def _named(row: Mapping[str, Any]) -> str:
    trained = {None: "", "nothing": ", untrained"}.get(
        row["trained_on"], f", trained on {row['trained_on']}"
    )
    return f"{row['player']}{trained}"


def _line(
    curves: Sequence[Sequence[Mapping[str, Any]]], seen: str
) -> tuple[list[list[float]], list[list[float]]]:
    """Games and makespan, a list a seed."""
    return [[point["games"] for point in curve] for curve in curves], [
        [point[seen] for point in curve] for curve in curves
    ]


def _bars(
    ax: Axes, names: Sequence[str], values: Sequence[float], halves: Sequence[float], unit: str
) -> None:
    kinds = {"ours": COLOURS[1], "as described": COLOURS[2]}
    colours = [kinds.get(name.split(",")[0], COLOURS[0]) for name in names]
    ax.barh(
        names, values, xerr=halves, color=colours, error_kw={"elinewidth": 0.8, "ecolor": FAINT_INK}
    )
    for index, (value, half) in enumerate(zip(values, halves, strict=True)):
        ax.annotate(
            f"{value:.1f} {unit}",
            (value + half, index),
            xytext=(4, 0),
            textcoords="offset points",
            va="center",
            fontsize=8,
        )
    ax.margins(x=0.12)
    _dressed(ax)


def _dressed(ax: Axes) -> None:
    ax.invert_yaxis()
    ax.tick_params(labelsize=8.5)
    ax.grid(True, axis="x", color=RULE, lw=0.6)
    ax.set_axisbelow(True)
    ax.spines[["top", "right"]].set_visible(False)
