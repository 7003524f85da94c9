"""The precedence graph: what must be done before what, and who can do it."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from tandem.cell.model import Cell
from tandem.draw.figure import NODE, PITCH, axes_or_new, graph_size, legend_below
from tandem.draw.language import Words, words
from tandem.draw.layers import Layers, layers
from tandem.draw.style import INK, Look, looks, task_label

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

ARROW = "#8A929A"
HALF_WIDTH, HALF_HEIGHT = NODE[0] / PITCH[0] / 2, NODE[1] / PITCH[1] / 2
"""Half a node, where columns and rows are one apart."""
MOST_CHIPS = 4


@dataclass(frozen=True)
class Chip:
    """One way of doing a task, as a node shows it: who, in letters, and how long. `looks` has one
    entry for each who takes part.
    """

    words: str
    looks: tuple[Look, ...]


def chips(cell: Cell, task: str, t: Words) -> tuple[Chip, ...]:
    """Every way of doing the task; when there are too many for a node, letters without times, then
    only how many.
    """
    shown = looks(cell)
    modes = cell.modes(task)
    timed = tuple(
        Chip(
            f"{'+'.join(shown[o].letters for o in m.operators)} {t.number(m.time)}",
            tuple(shown[o] for o in m.operators),
        )
        for m in modes
    )
    if len(timed) <= MOST_CHIPS:
        return timed
    first = timed[: MOST_CHIPS - 1]
    return (*first, Chip(f"+{len(timed) - len(first)}", ()))


def plot_graph(
    cell: Cell, ax: Axes | None = None, *, legend: bool = True, language: str = "en"
) -> Axes:
    """Draws the precedence graph in layers from left to right and returns the axes.

    Each task shows who can do it and in how many seconds: an operator's colour, hatch and letters.
    Arrows that follow from others are left out. Bold outlines and arrows mark the longest chain in
    the quickest modes, which no schedule can beat. Tasks without any precedence stand below the
    others. Raises UsageError when pictures do not speak the language.
    """
    drawn, t = layers(cell), words(language)
    ax = axes_or_new(ax, graph_size(drawn))
    columns, rows = drawn.extent
    ax.set_xlim(-0.5 - 0.04, columns - 0.5 + 0.04)
    ax.set_ylim(rows - 0.45, -0.55)
    ax.set_axis_off()
    _arrows(ax, drawn)
    for task in cell.tasks:
        _node(ax, cell, task, drawn.at[task], t, critical=task in drawn.critical)
    count = t.count("picture.tasks", len(cell.tasks))
    ax.set_title(
        t("picture.chain", tasks=count, seconds=t.seconds(drawn.critical_s)),
        loc="left",
        fontsize=11,
        fontweight="bold",
    )
    if legend:
        _legend(ax, cell, t)
    return ax


def arrow_curve(points: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Control points of cubic curves from the right side of the first node to the left side of the
    last: start, then threes.

    Where the arrow passes a column it runs level, so that it bends only between columns, where no
    node is in the way.
    """
    path = [(points[0][0] + HALF_WIDTH, points[0][1])]
    for x, y in points[1:-1]:
        path += [(x - HALF_WIDTH, y), (x + HALF_WIDTH, y)]
    path.append((points[-1][0] - HALF_WIDTH, points[-1][1]))
    curve = [path[0]]
    for (x0, y0), (x1, y1) in itertools.pairwise(path):
        bend = (x1 - x0) / 2
        curve += [(x0 + bend, y0), (x1 - bend, y1), (x1, y1)]
    return curve


def _arrows(ax: Axes, drawn: Layers) -> None:
    from matplotlib.patches import FancyArrowPatch
    from matplotlib.path import Path

    bold = critical_pairs(drawn)
    for pair, points in drawn.arrows.items():
        curve = arrow_curve(points)
        codes = [Path.MOVETO, *[Path.CURVE4] * (len(curve) - 1)]
        strong = pair in bold
        style: dict[str, Any] = {
            "color": INK if strong else ARROW,
            "lw": 2.0 if strong else 1.0,
            "zorder": 2 if strong else 1,
        }
        arrow = FancyArrowPatch(
            path=Path(curve, codes),
            arrowstyle="-|>,head_length=5,head_width=2.6",
            shrinkA=0,
            shrinkB=0,
            mutation_scale=1,
            **style,
        )
        arrow.set_gid(f"arrow {pair[0]} {pair[1]}")
        ax.add_patch(arrow)


def critical_pairs(drawn: Layers) -> set[tuple[str, str]]:
    """The arrows of the longest chain."""
    return set(itertools.pairwise(drawn.critical))


def _node(
    ax: Axes, cell: Cell, task: str, at: tuple[float, float], t: Words, *, critical: bool
) -> None:
    import matplotlib
    from matplotlib.patches import Rectangle

    from tandem.draw.fitted import fitted_text

    left, top = at[0] - HALF_WIDTH, at[1] - HALF_HEIGHT
    width, height = 2 * HALF_WIDTH, 2 * HALF_HEIGHT
    box = Rectangle(
        (left, top),
        width,
        height,
        facecolor="white",
        edgecolor=INK if critical else "#5F6770",
        lw=2.2 if critical else 0.9,
        zorder=3,
    )
    box.set_gid(f"task {task}")
    ax.add_patch(box)
    label = task_label(cell, task)
    middle = top + 0.52 * height
    fitted_text(
        ax,
        (left, top, left + width, middle),
        [f"{task}: {label}" if label != task else task, task],
        size=9.5,
        turn=False,
        fontweight="bold",
    )
    found = chips(cell, task, t)
    gap, inner = 0.03 * width, 0.94 * width
    each = (inner - gap * (len(found) - 1)) / len(found)
    for place, chip in enumerate(found):
        x = left + gap + place * (each + gap)
        part = each / max(len(chip.looks), 1)
        for i, look in enumerate(chip.looks):
            with matplotlib.rc_context({"hatch.linewidth": 0.5}):
                corner = (x + i * part, middle)
                ax.add_patch(
                    Rectangle(
                        corner,
                        part,
                        0.4 * height,
                        facecolor=look.tint,
                        edgecolor=look.colour,
                        hatch=look.hatch,
                        lw=0,
                        zorder=3.2,
                    )
                )
        backing = (
            {"boxstyle": "round,pad=0.08", "facecolor": "white", "edgecolor": "none", "alpha": 0.75}
            if any(look.hatch for look in chip.looks)
            else None
        )
        fitted_text(
            ax,
            (x, middle, x + each, middle + 0.4 * height),
            [chip.words, chip.words.split()[0]],
            size=8.5,
            turn=False,
            bbox=backing,
        )


def _legend(ax: Axes, cell: Cell, t: Words) -> None:
    from matplotlib.patches import Patch

    entries: list[tuple[Artist, str]] = [
        (
            Patch(facecolor=look.tint, edgecolor=look.colour, hatch=look.hatch, lw=0),
            legend_words(look),
        )
        for look in looks(cell).values()
    ]
    longest = (Patch(fill=False, edgecolor=INK, lw=2.2), t("picture.longest"))
    legend_below(ax, [*entries, longest], inches=0.05)


def legend_words(look: Look) -> str:
    """What a legend says of an operator: letters and label."""
    name = look.label if len(look.label) <= 18 else look.label[:17] + "…"
    return f"{look.letters}: {name}".replace("$", r"\$")


def who_can(cell: Cell) -> Mapping[str, tuple[str, ...]]:
    """Task -> the operators that take part in any way of doing it, in the cell's order."""
    return {
        task: tuple(
            o for o in cell.operators if any(o in mode.operators for mode in cell.modes(task))
        )
        for task in cell.tasks
    }
