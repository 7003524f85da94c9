"""Boards as arrays: one, or many of one size so that a single compiled function plays them all."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tandem.errors import UsageError
from tandem.lab.yu2020.board import Board, Piece
from tandem.lab.yu2020.world import Layout


def layout(board: Board, *, height: int | None = None, width: int | None = None) -> Layout:
    """The board as NumPy arrays, with empty rows above and empty columns to the right up to
    `height` and `width`.

    Raises UsageError when it is larger than that.
    """
    rows, columns = height or board.height, width or board.width
    if board.height > rows or board.width > columns:
        raise UsageError(
            f"board {board.name!r}: {board.height} rows and {board.width} columns do not fit on"
            f" {rows} rows and {columns} columns. Give more."
        )
    time, who, across, tail = (np.zeros((rows, columns), np.int32) for _ in range(4))
    joined = np.zeros((rows, columns, columns), bool)
    chains = tails(board)
    for piece in board.pieces:
        row, first, last = piece.row - 1, piece.first - 1, piece.last
        time[row, first], who[row, first], across[row, first], tail[row, first] = (
            piece.time,
            piece.who,
            last - first,
            chains[piece.name],
        )
        joined[row, first:last, first:last] = True
    return Layout(time, who, across, tail, joined)


def stacked(
    boards: Sequence[Board], *, height: int | None = None, width: int | None = None
) -> Layout:
    """The boards with a leading axis, all padded to the largest or to the size given. Raises
    UsageError when there is none, or one is larger.
    """
    if not boards:
        raise UsageError("no boards to play on: give at least one.")
    rows = height or max(board.height for board in boards)
    columns = width or max(board.width for board in boards)
    parts = [layout(board, height=rows, width=columns) for board in boards]
    return Layout(*(np.stack(part) for part in zip(*parts, strict=True)))


def tails(board: Board) -> dict[str, int]:
    """Per piece the seconds of the longest chain of pieces that begins with it."""
    found: dict[str, int] = {}
    for piece in sorted(board.pieces, key=lambda piece: -piece.row):
        found[piece.name] = piece.time + max(
            (found[other.name] for other in board.pieces if waits(other, piece)), default=0
        )
    return found


def waits(high: Piece, low: Piece) -> bool:
    """Whether `high` lies above `low` in some column, and so cannot be played before it."""
    return high.row > low.row and high.first <= low.last and low.first <= high.last


def by_place(board: Board) -> dict[tuple[int, int], Piece]:
    """Row and column, from 0, in which a piece starts in a layout's arrays -> the piece."""
    return {(piece.row - 1, piece.first - 1): piece for piece in board.pieces}
