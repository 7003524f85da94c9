"""Fronts over other measures than the sum of stress as pictures: projections of three axes side by
side, and the fronts of several measures of one cell, in which plans can be told apart.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import combinations
from string import ascii_uppercase
from typing import TYPE_CHECKING

from tandem.draw.figure import blank
from tandem.draw.front import POINT
from tandem.draw.language import Words, words
from tandem.draw.style import FAINT_INK, RULE
from tandem.plan.axes.search import MAKESPAN, AxesFront, Point

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PANEL = (4.4, 3.9)
"""Inches of one panel."""
ACROSS = 3
MOST_LETTERS = 16
"""Points of a panel that have letters."""


def draw_axes(fronts: Sequence[AxesFront], *, language: str = "en") -> Figure:
    """One front of three axes as its three projections, the axis that a projection leaves out as
    colour; or fronts of two axes side by side, the same letter where the same people do the same
    tasks; of several cells with equally many fronts a row for each. Raises UsageError when pictures
    do not speak the language.
    """
    t = words(language)
    three = len(fronts) == 1 and len(fronts[0].axes) == 3
    count = 3 if three else sum(len(front.axes) - 1 for front in fronts)
    names = list(dict.fromkeys(front.cell.name for front in fronts))
    across = min(ACROSS, count) if len(names) == 1 else count // len(names)
    down = -(-count // across)
    figure = blank(PANEL[0] * across, PANEL[1] * down)
    figure.clear()
    panels = figure.subplots(down, across, squeeze=False).ravel()
    for empty in panels[count:]:
        empty.set_visible(False)
    if three:
        for panel, (x, y) in zip(panels, combinations(range(3), 2), strict=True):
            _projection(figure, panel, fronts[0], x, y, t)
    else:
        letters = {
            name: _letters(front for front in fronts if front.cell.name == name) for name in names
        }
        places = [(front, axis) for front in fronts for axis in range(1, len(front.axes))]
        for place, (panel, (front, axis)) in enumerate(zip(panels, places, strict=False)):
            _front(panel, front, axis, letters[front.cell.name], t)
            if len(names) > 1 and not place % across:
                under = panel.get_title("left")
                panel.set_title(f"{front.cell.name}\n{under}", loc="left", fontsize=10)
    figure.suptitle(
        names[0] if len(names) == 1 else "", x=0.01, ha="left", fontsize=12, fontweight="bold"
    )
    return figure


def allocation(point: Point) -> frozenset[tuple[str, tuple[str, ...]]]:
    """Who does what."""
    return frozenset((row.task, row.operators) for row in point.schedule)


def _letters(fronts: Iterable[AxesFront]) -> dict[frozenset[tuple[str, tuple[str, ...]]], str]:
    """Allocation -> its letters, in the order in which the panels show them."""
    found: dict[frozenset[tuple[str, tuple[str, ...]]], str] = {}
    for front in fronts:
        for point in front.points:
            place = len(found)
            again, letter = divmod(place, len(ascii_uppercase))
            found.setdefault(
                allocation(point), ascii_uppercase[letter] + (str(again) if again else "")
            )
    return found


def _front(
    ax: Axes,
    front: AxesFront,
    axis: int,
    letters: dict[frozenset[tuple[str, tuple[str, ...]]], str],
    t: Words,
) -> None:
    xs = [point.values[0] for point in front.points]
    ys = [point.values[axis] for point in front.points]
    _plain(ax, front, 0, axis, t)
    if len(front.axes) == 2:
        ax.step(xs, ys, where="post", color=RULE, lw=1.0, zorder=1)
    if len(set(ys)) == 1:
        ax.set_ylim(0, 2 * ys[0] or 1)
    for point, x, y in zip(front.points, xs, ys, strict=True):
        ax.scatter([x], [y], s=34, color=POINT if point.proven else "none", edgecolor=POINT)
        if len(front.points) <= MOST_LETTERS:
            ax.annotate(
                letters[allocation(point)],
                (x, y),
                (5, 4),
                textcoords="offset points",
                fontsize=9,
                color=FAINT_INK,
            )


def _projection(figure: Figure, ax: Axes, front: AxesFront, x: int, y: int, t: Words) -> None:
    other = next(place for place in range(3) if place not in (x, y))
    _plain(ax, front, x, y, t)
    shown = ax.scatter(
        [point.values[x] for point in front.points],
        [point.values[y] for point in front.points],
        c=[point.values[other] for point in front.points],
        cmap="viridis",
        s=40,
        edgecolor="white",
        linewidth=0.6,
    )
    bar = figure.colorbar(shown, ax=ax, location="bottom", pad=0.02, aspect=30)
    bar.set_label(_name(front.axes[other], t), fontsize=9)


def _plain(ax: Axes, front: AxesFront, x: int, y: int, t: Words) -> None:
    ax.set_xlabel(_name(front.axes[x], t))
    ax.set_ylabel(_name(front.axes[y], t))
    key = "picture.complete" if front.complete else "picture.open"
    title = t(key, points=t.count("picture.points", len(front.points)))
    ax.set_title(title, loc="left", fontsize=9, color=FAINT_INK)
    ax.grid(color=RULE, lw=0.6)
    ax.set_axisbelow(True)
    ax.margins(0.12)
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)


def _name(axis: str, t: Words) -> str:
    """What an axis is called: the makespan and the stress in the language, other measures by their
    name.
    """
    if axis == MAKESPAN:
        return t("front.makespan")
    return t("front.stress") if axis == "stress" else axis
