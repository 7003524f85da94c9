"""The grid in pictures: as text, and as the path that robot and human took."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from tandem.draw.figure import axes_or_new
from tandem.draw.style import ACCENT, FAINT_INK, HUMAN_COLOURS, INK, ROBOT_COLOURS, RULE, tint
from tandem.lab.alessio2022.layout import FREE, OBSTACLE, RIGHT, WRONG, Layout
from tandem.lab.alessio2022.world import HUMAN, ROBOT, State

if TYPE_CHECKING:
    from matplotlib.axes import Axes

OF_ROBOT, OF_HUMAN = ROBOT_COLOURS[2], HUMAN_COLOURS[2]


def text(layout: Layout, state: State) -> str:
    """The grid as lines: `R` and `H` where they stand, `r` and `h` where they have been."""
    letters = [letter if letter in OBSTACLE + RIGHT + WRONG else FREE for letter in layout.text]
    for agent, (been, stands) in ((ROBOT, "rR"), (HUMAN, "hH")):
        for place in state.path[agent].nonzero()[0]:
            letters[place] = stands if place == state.position[agent] else been
    return "\n".join(
        "".join(letters[row * layout.width : (row + 1) * layout.width])
        for row in range(layout.height)
    )


def plot_paths(
    layout: Layout,
    line: Sequence[tuple[int, int]],
    ax: Axes | None = None,
    *,
    title: str = "",
    upto: int | None = None,
) -> Axes:
    """Draws the squares that robot and human went over and returns the axes.

    Args:
      line: squares (robot, human) after each move, the starts first.
      upto: only the first so many moves; all when absent.
    """
    from matplotlib.patches import Rectangle

    ax = axes_or_new(ax, (0.55 * layout.width + 0.4, 0.55 * layout.height + 0.7))
    for place, letter in enumerate(layout.text):
        row, column = divmod(place, layout.width)
        fill = {OBSTACLE: INK, RIGHT: tint("#009E73"), WRONG: tint(ACCENT, 0.3)}.get(
            letter, "white"
        )
        ax.add_patch(
            Rectangle((column - 0.5, row - 0.5), 1, 1, facecolor=fill, edgecolor=RULE, lw=0.8)
        )
        if letter in RIGHT + WRONG:
            ax.text(
                column - 0.44,
                row - 0.24,
                "right" if letter == RIGHT else "wrong",
                fontsize=6.5,
                color=INK,
                zorder=4,
            )
    shown = line[: None if upto is None else upto + 1]
    for agent, colour, letter, aside in (
        (ROBOT, OF_ROBOT, "R", -0.07),
        (HUMAN, OF_HUMAN, "H", 0.07),
    ):
        places = [pair[agent] for pair in shown]
        stops = [
            place for turn, place in enumerate(places) if turn == 0 or place != places[turn - 1]
        ]
        xs, ys = (
            [place % layout.width + aside for place in stops],
            [place // layout.width + aside for place in stops],
        )
        ax.plot(xs, ys, color=colour, lw=2.2, ls="-" if agent == ROBOT else (0, (3, 1.2)), zorder=2)
        ax.plot(xs[0], ys[0], "o", ms=5, color=colour, zorder=3)
        ax.text(
            xs[-1], ys[-1], letter, ha="center", va="center", fontsize=9, fontweight="bold",
            color="white", zorder=5,
            bbox={"boxstyle": "circle,pad=0.22" if agent == ROBOT else "square,pad=0.25",
            "facecolor": colour, "edgecolor": "white"},
        )  # fmt: skip
    ax.set_xlim(-0.5, layout.width - 0.5)
    ax.set_ylim(layout.height - 0.5, -0.5)
    ax.set_aspect("equal")
    ax.set_xticks([])
    ax.set_yticks([])
    ax.spines[:].set_color(FAINT_INK)
    ax.set_title(title, loc="left", fontsize=9)
    return ax
