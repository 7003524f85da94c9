"""Figures to Alessio et al. (2022): the blocked wrong terminal state, the success rates, and what a
guarantee costs on cells.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from tandem.draw.figure import blank
from tandem.draw.style import FAINT_INK, HUMAN_COLOURS, ROBOT_COLOURS, RULE
from tandem.lab.alessio2022.grid_runs import ADVERSARIAL, PLAIN
from tandem.lab.alessio2022.layout import HUMAN_START, RIGHT, ROBOT_START, Layout
from tandem.lab.alessio2022.pictures import plot_paths

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

HUMANS = {
    "random": "random",
    "random goal": "pursues a random goal",
    "wrong goal": "pursues a wrong goal",
    "adversary": "learned adversary",
}
COLOURS = (ROBOT_COLOURS[0], ROBOT_COLOURS[1], HUMAN_COLOURS[0], HUMAN_COLOURS[2])
HATCHES = ("", "//", "..", "xx")


def figures(document: Mapping[str, Any]) -> Iterator[tuple[str, Figure]]:
    """Name and figure, one after the other."""
    for grid in document["grids"]:
        name = grid["grid"]
        yield f"blocked-{name}", blocked(grid)
        if grid["records"]:
            yield f"film-{name}", film(grid)
            yield f"success-{name}", success(grid)
    yield "price-of-robustness", price(document["cells"])


def blocked(grid: Mapping[str, Any]) -> Figure:
    """A human goes straight for the wrong terminal state, beside a robot trained without an
    adversary and one trained with one; and minimax.

    Where nothing was trained, the quickest robot stands for both.
    """
    drawn = Layout(tuple(grid["rows"]))
    panels = [
        (
            _typical(grid["records"], training)["greedy"],
            f"trained {said}",
            _count(grid["records"], training),
        )
        for training, said in (
            (PLAIN, "beside a random human"),
            (ADVERSARIAL, "against an adversary"),
        )
        if grid["records"]
    ] or [(grid["exact"]["quickest"], "the quickest way", "")]
    figure = blank((len(panels) + 1) * (0.45 * drawn.width + 0.5), 0.45 * drawn.height + 1.2)
    figure.clear()
    axes = figure.subplots(1, len(panels) + 1)
    for ax, (greedy, said, count) in zip(axes, panels, strict=False):
        line = _pairs(greedy["pursued"])
        plot_paths(drawn, line, ax, title=f"{said}:\n{_end(drawn, line)}\n{count}")
    start = (drawn.squares(ROBOT_START)[0], drawn.squares(HUMAN_START)[0])
    line = [start, *_pairs(grid["exact"]["line"])]
    plot_paths(drawn, line, axes[-1], title=f"exact minimax, worst human:\n{_end(drawn, line)}\n")
    return figure


def _count(records: Sequence[Mapping[str, Any]], training: str) -> str:
    own = [record for record in records if record["training"] == training]
    return f"(right one in {sum(record['greedy']['barred'] for record in own)} of {len(own)} seeds)"


def film(grid: Mapping[str, Any]) -> Figure:
    """The game of the adversarially trained robot in pictures, from left to right."""
    drawn = Layout(tuple(grid["rows"]))
    line = _pairs(_typical(grid["records"], ADVERSARIAL)["greedy"]["pursued"])
    moves = sorted({round(place * (len(line) - 1) / 5) for place in range(6)})
    figure = blank(len(moves) * (0.34 * drawn.width + 0.2), 0.34 * drawn.height + 0.6)
    figure.clear()
    for ax, upto in zip(figure.subplots(1, len(moves), squeeze=False)[0], moves, strict=True):
        plot_paths(drawn, line, ax, title=f"after {upto} moves", upto=upto)
    return figure


def success(grid: Mapping[str, Any]) -> Figure:
    """Success rates against each human, by training, with 95 % intervals over seeds."""
    rows = grid["summary"]
    figure = blank(9.0, 1.6 + 0.62 * len(rows))
    ax = figure.axes[0]
    for index, (human, label) in enumerate(HUMANS.items()):
        means = [100 * row["success"][human]["mean"] for row in rows]
        ends = [[100 * end for end in row["success"][human]["ci95"]] for row in rows]
        reach = [
            [mean - low for mean, (low, _) in zip(means, ends, strict=True)],
            [high - mean for mean, (_, high) in zip(means, ends, strict=True)],
        ]
        heights = [row + 0.2 * (index - 1.5) for row in range(len(rows))]
        ax.barh(
            heights,
            means,
            0.18,
            color=COLOURS[index],
            hatch=HATCHES[index],
            edgecolor="white",
            label=label,
            xerr=reach,
            ecolor=FAINT_INK,
        )
    ax.set_yticks(range(len(rows)), [row["training"] for row in rows])
    ax.invert_yaxis()
    ax.set_xlim(0, 102)
    ax.set_xlabel("games in which the right terminal state is reached, %")
    ax.set_title(
        f"Grid {grid['grid']}: who was it trained beside, and who is the human?",
        loc="left",
        fontsize=11,
    )
    ax.grid(True, axis="x", color=RULE, lw=0.6)
    ax.set_axisbelow(True)
    ax.spines[["top", "right"]].set_visible(False)
    ax.legend(
        frameon=False,
        fontsize=9,
        loc="upper center",
        bbox_to_anchor=(0.4, -0.9 / (1.6 + 0.62 * len(rows))),
        ncols=4,
    )
    return figure


def price(cells: Sequence[Mapping[str, Any]]) -> Figure:
    """Per cell: nominal time against guaranteed time of every robot, and the exact front."""
    figure = blank(3.6 * len(cells), 3.6)
    figure.clear()
    for ax, row in zip(figure.subplots(1, len(cells), squeeze=False)[0], cells, strict=True):
        _price(ax, row)
    return figure


def _price(ax: Axes, row: Mapping[str, Any]) -> None:
    for kind, colour, mark, label in (
        ("untrained", FAINT_INK, "x", "untrained"),
        ("plain", ROBOT_COLOURS[0], "o", "learned without adversary"),
        ("adversarial", HUMAN_COLOURS[2], "^", "learned against adversary"),
    ):
        ax.scatter(
            [pair[1] for pair in row[kind]],
            [pair[0] for pair in row[kind]],
            s=34,
            marker=mark,
            color=colour,
            alpha=0.6,
            label=label,
            zorder=3,
        )
    ax.scatter(
        [row["optimiser"][1]],
        [row["optimiser"][0]],
        s=60,
        marker="s",
        facecolor="none",
        edgecolor=FAINT_INK,
        label="optimiser",
        zorder=4,
    )
    ax.plot(
        [p[0] for p in row["trade"]],
        [p[1] for p in row["trade"]],
        "k*-",
        ms=11,
        lw=1,
        label="exact front",
        zorder=5,
    )
    ax.set_xlabel("guaranteed, s (worst human)")
    ax.set_ylabel("nominal, s (best human)")
    ax.set_title(row["cell"], loc="left", fontsize=9)
    ax.grid(True, color=RULE, lw=0.6)
    ax.spines[["top", "right"]].set_visible(False)
    ax.legend(frameon=False, fontsize=7)


def _typical(records: Sequence[Mapping[str, Any]], training: str) -> Mapping[str, Any]:
    """The first seed that ends as most seeds of that training do."""
    own = [record for record in records if record["training"] == training]
    most = sum(record["greedy"]["barred"] for record in own) * 2 >= len(own)
    return next(record for record in own if record["greedy"]["barred"] == most)


def _pairs(line: Sequence[Sequence[int]]) -> list[tuple[int, int]]:
    return [(robot, human) for robot, human in line]


def _end(drawn: Layout, line: Sequence[tuple[int, int]]) -> str:
    where = next((drawn.text[place] for place in line[-1] if drawn.text[place] in "GW"), "")
    return (
        f"{ {RIGHT: 'right', '': 'no'}.get(where, 'wrong') } terminal state after {len(line) - 1}"
        " moves"
    )
