"""Pictures of Zhang et al. (2022) run here: the front with what was learned, noise, recovery,
training curves, two assemblies.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from tandem.draw.curves import COLOURS, plot_curves
from tandem.draw.figure import blank, figure_for
from tandem.draw.gantt import plot_gantt
from tandem.draw.style import FAINT_INK, RULE
from tandem.lab.zhang2022.runs import FACTORS, alternator
from tandem.schedule.model import Schedule

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Document = Mapping[str, Any]
MARKS = ("s", "D", "o", "^", "v")


def figures(document: Document) -> Iterator[tuple[str, Figure]]:
    """Name and figure, one after the other."""
    yield "front", front(document)
    yield "noise", noise(document)
    yield "recovery", recovery(document)
    yield "curves", curves(document)
    guide = document["display"]
    yield (
        "schedule",
        schedule(
            guide["assignments"],
            f"Learned: {guide['arm']}, factor {guide['factor']:g}, seed {guide['seed']}",
        ),
    )
    change = guide["change"]
    if change["happened"]:
        yield (
            "schedule-after-change",
            schedule(change["assignments"], f"At {change['at']:g} s {change['happened']}"),
        )


def front(document: Document) -> Figure:
    """The exact front as steps, its matching points ringed, and where the greedy policies of every
    seed lie.
    """
    figure = blank(8.6, 5.0)
    ax = _bare(figure)
    points = document["exact_front"]
    ax.step(
        [t for t, _ in points],
        [d for _, d in points],
        where="post",
        color=FAINT_INK,
        lw=1.2,
        label="exact front",
    )
    ax.plot([t for t, _ in points], [d for _, d in points], "o", color=FAINT_INK, ms=4)
    for factor, (t, d) in document["matching"].items():
        ax.plot([t], [d], "o", ms=17, mfc="none", mec=FAINT_INK, mew=1.4)
        ax.annotate(
            f"factor {factor}",
            (t, d),
            (-11, -14),
            textcoords="offset points",
            ha="right",
            fontsize=8.5,
            color=FAINT_INK,
        )
    for index, arm in enumerate(dict.fromkeys(row["arm"] for row in document["records"])):
        own = [row["greedy"] for row in document["records"] if row["arm"] == arm]
        x, y = [one["makespan"] for one in own], [one["difficulty"] for one in own]
        ax.plot(
            x,
            y,
            MARKS[index % len(MARKS)],
            color=COLOURS[index % len(COLOURS)],
            ms=6,
            alpha=0.65,
            mew=0,
            label=arm,
        )
    ax.margins(x=0.12)
    ax.set_xlabel("makespan [s]")
    ax.set_ylabel("difficulty")
    ax.set_title(
        "Greedy joint policies of every seed beside the exact front (rings: what a factor asks"
        " for)",
        loc="left",
        fontsize=11,
    )
    ax.legend(frameon=False, fontsize=9)
    return figure


def noise(document: Document) -> Figure:
    """Cost beside a noisy human, an arm a bar, above the exact optimum without noise."""
    figure, factor = blank(8.6, 3.8), FACTORS[0]
    ax = figure.axes[0]
    rows = [row for row in document["summary"] if row["factor"] == factor]
    _bars(
        ax,
        [row["arm"] for row in rows],
        [row["noisy_gap"] for row in rows],
        "cost above the calm optimum [%]",
    )
    best = document["matching"][f"{factor:g}"]
    chance = document["random"][f"{factor:g}"]["noisy_cost"] / (best[0] + factor * best[1]) - 1
    ax.axvline(100 * chance, color=FAINT_INK, lw=1, ls=(0, (6, 3)))
    ax.annotate(
        "random player",
        (100 * chance, 1.0),
        xycoords=("data", "axes fraction"),
        ha="right",
        va="bottom",
        fontsize=8,
        color=FAINT_INK,
    )
    ax.set_title(f"Beside a noisy human, factor {factor:g}", loc="left", fontsize=11, pad=16)
    return figure


def recovery(document: Document) -> Figure:
    """Losses against the re-planned optimum after a change, every sampled episode a dot, the mean a
    bar; our arms.
    """
    figure = blank(8.6, 4.2)
    ax = _bare(figure)
    arms = list(dict.fromkeys(row["arm"] for row in document["records"]))
    for index, arm in enumerate(arms):
        losses = [
            100 * loss
            for row in document["records"]
            if row["arm"] == arm
            for loss in row["changed"]["losses"]
        ]
        jitter = [index + 0.28 * ((7 * number) % 11 - 5) / 5 for number in range(len(losses))]
        ax.plot(losses, jitter, ".", color=COLOURS[index % len(COLOURS)], ms=5, alpha=0.5)
        if losses:
            ax.plot(
                [sum(losses) / len(losses)] * 2,
                [index - 0.38, index + 0.38],
                color=COLOURS[index % len(COLOURS)],
                lw=2.5,
            )
    ax.set_yticks(range(len(arms)), arms)
    ax.invert_yaxis()
    ax.set_xlabel("cost of the rest above its re-planned optimum [%]")
    ax.set_title("After a change that nobody foresaw (lines: means)", loc="left", fontsize=11)
    return figure


def curves(document: Document) -> Figure:
    """Mean cost of training episodes at the first factor."""
    figure = blank(8.6, 4.6)
    rows = [
        row for row in document["records"] if row["factor"] == FACTORS[0] and row["curve"]["steps"]
    ]
    lines = {
        arm: ([row["curve"]["steps"] for row in own], [row["curve"]["cost"] for row in own])
        for arm in dict.fromkeys(row["arm"] for row in rows)
        if (own := [row for row in rows if row["arm"] == arm])
    }
    best = document["matching"][f"{FACTORS[0]:g}"]
    plot_curves(
        lines,
        figure.axes[0],
        xlabel="joint steps",
        ylabel="cost of a training episode",
        title=f"Training at factor {FACTORS[0]:g}: exploration, noise and changes included",
        levels={"exact optimum": best[0] + FACTORS[0] * best[1]},
    )
    return figure


def schedule(rows: Sequence[Mapping[str, Any]], title: str) -> Figure:
    """Who did what when."""
    cell, made = alternator(), Schedule.from_list(list(rows))
    figure = figure_for(cell, made)
    plot_gantt(cell, made, ax=figure.axes[0], title=title, critical=False)
    return figure


def _bare(figure: Figure) -> Axes:
    ax = figure.axes[0]
    ax.grid(True, color=RULE, lw=0.6)
    ax.set_axisbelow(True)
    ax.spines[["top", "right"]].set_visible(False)
    return ax


def _bars(
    ax: Axes, names: Sequence[str], values: Sequence[Mapping[str, float | None]], label: str
) -> None:
    for index, value in enumerate(values):
        half = 100 * (value["ci95"] or 0.0)
        ax.barh(
            index,
            100 * (value["mean"] or 0.0),
            xerr=half,
            color=COLOURS[index % len(COLOURS)],
            height=0.62,
            error_kw={"lw": 1.2, "capsize": 3},
        )
    ax.set_yticks(range(len(names)), names)
    ax.invert_yaxis()
    ax.set_xlabel(label)
    ax.grid(True, axis="x", color=RULE, lw=0.6)
    ax.set_axisbelow(True)
    ax.spines[["top", "right"]].set_visible(False)
