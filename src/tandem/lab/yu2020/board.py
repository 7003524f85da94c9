"""The assembly chessboards of Yu, Huang and Chang (IEEE Access 2020; arXiv 2007.04140).

A board has rows and columns; a piece is a task that covers some columns of one row. The bottom row can be played, and a
piece falls when everything below its whole width is gone. So a task needs every task of a lower row whose columns overlap
its own, and a board is a cell with one human and one robot who take the same time for a task. Only completion time counts.

The random boards repeat the authors' draws for a seed. The optima of seeds 0 to 19 that are known for their boards tell one
order of the draws from all others that were tried; a test keeps them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import IntEnum

from tandem.cell.model import Cell

ROBOT, HUMAN = "robot", "human"


class Who(IntEnum):
    """Who can do a task, in the authors' numbers."""

    ROBOT = 2
    EITHER = 3
    HUMAN = 4


@dataclass(frozen=True)
class Piece:
    """One task on the board.

    Attributes:
      name: unique on its board.
      row: 1 is the bottom row, which can be played at once.
      first, last: the columns that it covers, counted from 1, both included.
      who: who can do it.
      time: seconds, whoever does it.
    """

    name: str
    row: int
    first: int
    last: int
    who: Who
    time: int


@dataclass(frozen=True)
class Board:
    """A whole board: pieces in order of row and column."""

    name: str
    height: int
    width: int
    pieces: tuple[Piece, ...]

    def to_cell(self) -> Cell:
        """The cell with the same schedules: precedence by overlap of columns, without what follows from the rest of it."""
        able = {Who.ROBOT: (ROBOT,), Who.EITHER: (ROBOT, HUMAN), Who.HUMAN: (HUMAN,)}
        after = _reduced({piece.name: [lower.name for lower in self._below(piece)] for piece in self.pieces})
        tasks = {piece.name: {"time": dict.fromkeys(able[piece.who], piece.time), "after": after[piece.name]} for piece in self.pieces}
        return Cell.of({"name": self.name, "operators": {ROBOT: {"kind": "robot"}, HUMAN: {"kind": "human"}}, "tasks": tasks})

    @classmethod
    def of(cls, cell: Cell) -> Board:
        """The cell as a board with the same schedules, whatever board it came from.

        Raises CellError, with every reason, when the game cannot hold it.
        """
        from tandem.lab.yu2020.board import board_of

        return board_of(cell)

    def _below(self, piece: Piece) -> Iterator[Piece]:
        return (lower for lower in self.pieces if lower.row < piece.row and lower.first <= piece.last and piece.first <= lower.last)


def random_board(height: int = 15, width: int = 12, human: int = 15, joint: int = 10, robot: int = 20, max_time: int = 10, *, seed: int) -> Board:
    """A board drawn as the authors draw theirs; the default sizes are those of their demonstration.

    In each row a piece starts in the first column; the others start in cells drawn without replacement from the rest, and
    each piece reaches to the next start. The pieces are shuffled; the first `robot` of them are for the robot, the next `joint`
    for either, the next `human` for the human. Times are whole and uniform on 1 to `max_time - 1`.

    Raises:
      ValueError: fewer pieces than rows, more than cells, or `max_time` below 2.
    """
    import numpy as np

    count = human + joint + robot
    if not 1 <= height <= count <= height * width or max_time < 2 or min(human, joint, robot) < 0:
        raise ValueError(
            f"{count} pieces on a board of {height} rows and {width} columns: at least one a row, at most one a cell, times of 1 or more."
        )
    draws = np.random.RandomState(seed)  # the authors seed numpy's legacy generator
    rest = [(row, column) for row in range(1, height + 1) for column in range(2, width + 1)]
    further = draws.choice(len(rest), count - height, replace=False)
    starts = [rest[place] for place in further] + [(row, 1) for row in range(1, height + 1)]
    order = np.arange(count)
    draws.shuffle(order)
    times = draws.randint(1, max_time, size=count)
    who = [Who.ROBOT] * robot + [Who.EITHER] * joint + [Who.HUMAN] * human
    drawn = sorted((*starts[place], who[rank], int(times[rank])) for rank, place in enumerate(order))
    pieces = []
    for number, (row, column, able, time) in enumerate(drawn, 1):
        following = drawn[number] if number < count else (0, 0)
        last = following[1] - 1 if following[0] == row else width
        pieces.append(Piece(str(number), row, column, last, able, time))
    return Board(f"Chessboard {height}x{width} (Yu 2020), seed {seed}", height, width, tuple(pieces))


def desk() -> Board:
    """The height-adjustable desk: 53 tasks on 15 rows and 8 columns. The authors use the name B12 twice; the second is B12b here."""
    halves, pairs, columns = ((1, 4), (5, 8)), ((1, 2), (3, 4), (5, 6), (7, 8)), tuple((column, column) for column in range(1, 9))
    robot, either, human = Who.ROBOT, Who.EITHER, Who.HUMAN
    rows: tuple[tuple[str, Who, tuple[int, ...], tuple[tuple[int, int], ...]], ...] = (
        ("A1 A2", robot, (2, 2), halves),
        ("A3 A4 A5 A6", robot, (1, 2, 3, 4), pairs),
        ("B1 B2 B3 B4", human, (1, 2, 3, 4), pairs),
        ("C1 C2", either, (2, 2), halves),
        ("A7 A8 A9 A10", robot, (1, 2, 3, 4), pairs),
        ("B5 B6 B7 B8", human, (1, 2, 3, 4), pairs),
        ("C3 C4", either, (2, 2), halves),
        ("A11 A12", robot, (2, 2), halves),
        ("A13 A14 A15 A16", robot, (1, 2, 3, 4), pairs),
        ("B9 B10 B11 B12", human, (1, 2, 3, 4), pairs),
        ("A17 A18", robot, (2, 2), halves),
        ("A19 A20 A21 A22 A23 A24 A25 A26", robot, (1, 2, 3, 4, 5, 6, 7, 8), columns),
        ("B12b B13 B14 B15 B16 B17 B18 B19", human, (1, 2, 3, 4, 5, 6, 7, 8), columns),
        ("A27 A28", robot, (2, 2), halves),
        ("A29", robot, (4,), ((1, 8),)),
    )
    pieces = tuple(
        Piece(name, row, first, last, who, time)
        for row, (names, who, times, spans) in enumerate(rows, 1)
        for name, time, (first, last) in zip(names.split(), times, spans, strict=True)
    )
    return Board("Height-adjustable desk (Yu 2020)", 15, 8, pieces)


def _reduced(after: dict[str, list[str]]) -> dict[str, list[str]]:
    """Predecessors without those that already go before another one. Tasks come after their predecessors in the dictionary."""
    all_before: dict[str, set[str]] = {}
    kept: dict[str, list[str]] = {}
    for name, firsts in after.items():
        implied = set().union(*(all_before[first] for first in firsts))
        kept[name] = [first for first in firsts if first not in implied]
        all_before[name] = implied.union(firsts)
    return kept
