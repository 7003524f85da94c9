"""A chessboard as a board, and a game as a strip of them: pieces with name and time, coloured and
hatched by who can do them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from tandem.draw.figure import axes_or_new
from tandem.draw.style import (
    FAINT_INK,
    HUMAN_COLOURS,
    INK,
    ROBOT_COLOURS,
    ROBOT_HATCHES,
    RULE,
    tint,
)
from tandem.lab.yu2020.board import Board, Piece, Who

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.patches import Polygon

COLOURS = {Who.HUMAN: HUMAN_COLOURS[0], Who.ROBOT: ROBOT_COLOURS[0]}
HATCHES = {Who.HUMAN: "", Who.ROBOT: ROBOT_HATCHES[0]}
CELL = (0.82, 0.42)
"""Inches of one place on the board, across and up."""
GAP = 0.06
"""Shares of a place that stay free around a piece."""


class Frame(NamedTuple):
    """A board in the middle of a game.

    title: what stands above it.
    rows: piece -> the row in which it lies now; a piece that is not named is gone.
    doing: piece -> who is executing it, `Who.ROBOT` or `Who.HUMAN`.
    """

    title: str
    rows: Mapping[str, int]
    doing: Mapping[str, Who]


def plot_board(
    board: Board,
    ax: Axes | None = None,
    *,
    frame: Frame | None = None,
    legend: bool = True,
    times: bool = True,
) -> Axes:
    """Draws the board and returns the axes: row 1, which can be played, at the bottom.

    Robot pieces are hatched, human ones plain, those for either are both, corner to corner. A piece
    in hand has a bold edge and the colour of who has it.

    Args:
      frame: a moment of a game; the untouched board when absent.
      times: whether a piece shows its seconds beside its name.
    """
    from tandem.draw.fitted import fitted_text

    ax = axes_or_new(ax, board_size(board))
    now = frame or Frame(board.name, {piece.name: piece.row for piece in board.pieces}, {})
    ax.set_xlim(0.5, board.width + 0.5)
    ax.set_ylim(0.5, board.height + 0.5)
    for column in range(1, board.width):
        ax.axvline(column + 0.5, color=RULE, lw=0.4, zorder=0)
    for piece in board.pieces:
        if piece.name in now.rows:
            box = _box(piece, now.rows[piece.name])
            _fill(ax, box, piece.who, now.doing.get(piece.name))
            wordings = (
                [f"{piece.name}  {piece.time} s", f"{piece.name} {piece.time}", piece.name]
                if times
                else [piece.name]
            )
            weight = "bold" if piece.name in now.doing else "normal"
            fitted_text(ax, box, wordings, turn=False, fontweight=weight)
    ax.axhline(1.5, color=FAINT_INK, lw=0.8, ls=(0, (4, 3)), zorder=1)
    ax.set_title(now.title, loc="left", fontsize=11)
    ax.set_xticks(range(1, board.width + 1))
    ax.set_yticks(range(1, board.height + 1))
    ax.set_xlabel("column")
    ax.set_ylabel("row")
    ax.tick_params(length=0, labelsize=8, colors=FAINT_INK)
    ax.spines[["top", "right"]].set_visible(False)
    if legend:
        _put_legend(ax, bool(now.doing))
    return ax


def plot_film(board: Board, frames: Sequence[Frame], *, columns: int = 4) -> Figure:
    """A game as a strip: the frames from left to right, line by line, in a figure of its own."""
    from matplotlib.figure import Figure

    lines = math.ceil(len(frames) / columns)
    across, up = board.width * 0.33 + 0.25, board.height * 0.2 + 0.45
    figure = Figure(figsize=(columns * across, lines * up + 0.6), layout="constrained")
    axes = figure.subplots(lines, columns, squeeze=False).flat
    for ax, frame in zip(axes, frames, strict=False):
        plot_board(board, ax, frame=frame, legend=False, times=False)
        ax.set(xlabel="", ylabel="", xticks=[], yticks=[])
        ax.title.set_fontsize(9)
    for ax in list(figure.axes)[len(frames) :]:
        ax.set_axis_off()
    _put_legend(figure, True)
    return figure


def board_size(board: Board) -> tuple[float, float]:
    """Inches for a board on which the names of single columns can be read."""
    return max(4.5, board.width * CELL[0] + 0.9), board.height * CELL[1] + 1.4


Box = tuple[float, float, float, float]


def _box(piece: Piece, row: int) -> Box:
    """Left, bottom, right, top."""
    return piece.first - 0.5 + GAP, row - 0.5 + GAP, piece.last + 0.5 - GAP, row + 0.5 - GAP


def _fill(ax: Axes, box: Box, who: Who, by: Who | None) -> None:
    import matplotlib
    from matplotlib.patches import Polygon

    left, bottom, right, top = box
    with matplotlib.rc_context({"hatch.linewidth": 0.6}):
        for shape, kind in _shapes(box, who if by is None else by):
            strength = 0.45 if by is None else 0.85
            ax.add_patch(_patch(shape, kind, strength))
    edge = INK if by is not None else COLOURS.get(who, FAINT_INK)
    outline = [(left, bottom), (right, bottom), (right, top), (left, top)]
    ax.add_patch(
        Polygon(
            outline,
            closed=True,
            fill=False,
            edgecolor=edge,
            lw=2.2 if by is not None else 1.0,
            zorder=4,
        )
    )


def _shapes(box: Box, who: Who) -> list[tuple[list[tuple[float, float]], Who]]:
    """The corners to fill, and as whose."""
    left, bottom, right, top = box
    if who is Who.EITHER:
        return [
            ([(left, bottom), (right, bottom), (left, top)], Who.HUMAN),
            ([(right, top), (left, top), (right, bottom)], Who.ROBOT),
        ]
    return [([(left, bottom), (right, bottom), (right, top), (left, top)], who)]


def _patch(corners: Sequence[tuple[float, float]], kind: Who, strength: float) -> Polygon:
    from matplotlib.patches import Polygon

    colour = COLOURS[kind]
    return Polygon(
        corners,
        closed=True,
        facecolor=tint(colour, strength),
        edgecolor=colour,
        hatch=HATCHES[kind],
        lw=0,
        zorder=2,
    )


def _put_legend(target: Axes | Figure, in_hand: bool) -> None:
    """Below the axes, or at the bottom of the figure."""
    from matplotlib.figure import Figure
    from matplotlib.legend_handler import HandlerTuple
    from matplotlib.patches import Patch
    from matplotlib.transforms import ScaledTranslation

    human, robot = (
        Patch(facecolor=tint(COLOURS[who]), edgecolor=COLOURS[who], hatch=HATCHES[who])
        for who in (Who.HUMAN, Who.ROBOT)
    )
    entries: dict[str, Patch | tuple[Patch, ...]] = {
        "human": human,
        "robot": robot,
        "either": (human, robot),
    }
    if in_hand:
        entries["in hand, in the colour of who has it"] = Patch(
            facecolor="white", edgecolor=INK, lw=2.2
        )
    style: dict[str, Any] = {
        "ncols": 4,
        "frameon": False,
        "fontsize": 9,
        "handler_map": {tuple: HandlerTuple(ndivide=None, pad=0)},
    }
    handles: list[Any] = list(entries.values())
    if isinstance(target, Figure):
        target.legend(handles, list(entries), loc="outside lower left", **style)
    else:
        below = target.transAxes + ScaledTranslation(0, -0.5, target.figure.dpi_scale_trans)
        target.legend(
            handles,
            list(entries),
            loc="upper left",
            bbox_to_anchor=(0, 0),
            bbox_transform=below,
            **style,
        )
