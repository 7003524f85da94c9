"""The assembly chessboards of Yu, Huang and Chang (IEEE Access 2020; arXiv 2007.04140).

A board has rows and columns; a piece is a task that covers some columns of one row. The bottom row
can be played, and a piece falls when everything below its whole width is gone. So a task needs
every task of a lower row whose columns overlap its own, and a board is a cell with one human and
one robot who take the same time for a task. Only completion time counts.

The random boards repeat the authors' draws for a seed. The optima of seeds 0 to 19 that are known
for their boards tell one order of the draws from all others that were tried; a test keeps them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import IntEnum

from tandem.cell.beyond import beyond
from tandem.cell.model import Cell
from tandem.cell.parts import Task
from tandem.errors import CellError, Fault
from tandem.files.validate import cell_of
from tandem.lab.refusal import enumerated_crew
from tandem.lab.yu2020.columns import MOST_SETS, TooManyError, clash, rows, spans

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
        """The cell with the same schedules: precedence by overlap of columns, without what follows
        from the rest of it.
        """
        able = {Who.ROBOT: (ROBOT,), Who.EITHER: (ROBOT, HUMAN), Who.HUMAN: (HUMAN,)}
        after = _reduced(
            {piece.name: [lower.name for lower in self._below(piece)] for piece in self.pieces}
        )
        tasks = {
            piece.name: {
                "time": dict.fromkeys(able[piece.who], piece.time),
                "after": after[piece.name],
            }
            for piece in self.pieces
        }
        return cell_of(
            {
                "name": self.name,
                "operators": {ROBOT: {"kind": "robot"}, HUMAN: {"kind": "human"}},
                "tasks": tasks,
            }
        )

    @classmethod
    def of(cls, cell: Cell) -> Board:
        """The cell as a board with the same schedules, whatever board it came from.

        Raises CellError, with every reason, when the game cannot hold it.
        """
        return board_of(cell)

    def _below(self, piece: Piece) -> Iterator[Piece]:
        return (
            lower
            for lower in self.pieces
            if lower.row < piece.row and lower.first <= piece.last and piece.first <= lower.last
        )


def random_board(
    height: int = 15,
    width: int = 12,
    human: int = 15,
    joint: int = 10,
    robot: int = 20,
    max_time: int = 10,
    *,
    seed: int,
) -> Board:
    """A board drawn as the authors draw theirs; the default sizes are those of their demonstration.

    In each row a piece starts in the first column; the others start in cells drawn without
    replacement from the rest, and each piece reaches to the next start. The pieces are shuffled;
    the first `robot` of them are for the robot, the next `joint` for either, the next `human` for
    the human. Times are whole and uniform on 1 to `max_time - 1`.

    Raises:
      ValueError: fewer pieces than rows, more than cells, or `max_time` below 2.
    """
    import numpy as np

    count = human + joint + robot
    if not 1 <= height <= count <= height * width or max_time < 2 or min(human, joint, robot) < 0:
        raise ValueError(
            f"{count} pieces on a board of {height} rows and {width} columns: at least one a row,"
            " at most one a cell, times of 1 or more."
        )
    draws = np.random.RandomState(seed)  # the authors seed numpy's legacy generator
    rest = [(row, column) for row in range(1, height + 1) for column in range(2, width + 1)]
    further = draws.choice(len(rest), count - height, replace=False)
    starts = [rest[index] for index in further] + [(row, 1) for row in range(1, height + 1)]
    order = np.arange(count)
    draws.shuffle(order)
    times = draws.randint(1, max_time, size=count)
    who = [Who.ROBOT] * robot + [Who.EITHER] * joint + [Who.HUMAN] * human
    drawn = sorted(
        (*starts[index], who[rank], int(times[rank])) for rank, index in enumerate(order)
    )
    pieces = []
    for number, (row, column, able, time) in enumerate(drawn, 1):
        following = drawn[number] if number < count else (0, 0)
        last = following[1] - 1 if following[0] == row else width
        pieces.append(Piece(str(number), row, column, last, able, time))
    return Board(
        f"Chessboard {height}x{width} (Yu 2020), seed {seed}", height, width, tuple(pieces)
    )


def desk() -> Board:
    """The height-adjustable desk: 53 tasks on 15 rows and 8 columns. The authors use the name B12
    twice; the second is B12b here.
    """
    halves, pairs, columns = (
        ((1, 4), (5, 8)),
        ((1, 2), (3, 4), (5, 6), (7, 8)),
        tuple((column, column) for column in range(1, 9)),
    )
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
    """Predecessors without those that already go before another one. Tasks come after their
    predecessors in the dictionary.
    """
    all_before: dict[str, set[str]] = {}
    kept: dict[str, list[str]] = {}
    for name, firsts in after.items():
        implied = set().union(*(all_before[first] for first in firsts))
        kept[name] = [first for first in firsts if first not in implied]
        all_before[name] = implied.union(firsts)
    return kept


# --- A cell as a board, or every reason why it cannot be one ---

LONGEST_S = 100_000


def board_of(cell: Cell) -> Board:
    """The cell as a board with the same schedules: one piece a task, in the cell's order; the
    columns are found by `columns.spans`.

    What plays no part in planning (labels, parts, difficulty, spread, who the operators are called)
    is left out.

    Raises:
      CellError: with every reason why the game cannot hold the cell. "No arrangement of columns" is
        proven, except where the message says that the search was given up.
    """
    if faults := [fault for rule in RULES for fault in rule(cell)]:
        raise CellError(faults)
    after = {name: task.after for name, task in cell.tasks.items()}
    columns = spans(after)
    assert columns is not None
    row = rows(after, columns)
    pieces = [
        Piece(name, row[name], *columns[name], _who(cell, task), int(min(task.time.values())))
        for name, task in cell.tasks.items()
    ]
    height, width = max(row.values()), max(last for _, last in columns.values())
    return Board(
        cell.name, height, width, tuple(sorted(pieces, key=lambda piece: (piece.row, piece.first)))
    )


def one_robot_and_one_human(cell: Cell) -> Iterator[Fault]:
    """Two players."""
    if (len(cell.robots), len(cell.humans)) != (1, 1) or cell.machines:
        yield Fault(
            f"the chessboard is played by one robot and one human; this cell has"
            f" {enumerated_crew(cell)}.",
            ("operators",),
        )


def only_what_the_board_knows(cell: Cell) -> Iterator[Fault]:
    """Time and precedence, nothing else."""
    task = ("time", "after", "difficulty", "spread")
    yield from (
        Fault(_unknown(path[-1]), path) for path in beyond(cell, operator=("tool",), task=task)
    )


def times_are_whole_and_do_not_depend_on_who(cell: Cell) -> Iterator[Fault]:
    """One whole number a piece."""
    for name, task in cell.tasks.items():
        if len(set(task.time.values())) > 1:
            times = " and ".join(f"{who} {seconds:g} s" for who, seconds in task.time.items())
            yield Fault(
                f"a piece takes the same time whoever does it; this one takes {times}. Give both"
                " the same.",
                ("tasks", name, "time"),
            )
        for who, seconds in task.time.items():
            if seconds % 1 or seconds > LONGEST_S:
                yield Fault(
                    f"{seconds:g} s: the chessboard counts whole seconds up to {LONGEST_S}. Round"
                    " it, or take another unit.",
                    ("tasks", name, "time", who),
                )
        if not task.time and not task.together:
            yield Fault("nobody can do it.", ("tasks", name, "time"))


def precedence_is_overlap(cell: Cell) -> Iterator[Fault]:
    """There are columns for the tasks."""
    after = {name: task.after for name, task in cell.tasks.items()}
    if (pair := clash(after)) is not None:
        yield Fault(
            "no arrangement of columns has this precedence. A piece waits for all pieces below it"
            f" in its columns and for no other; here tasks {pair[0]!r} and {pair[1]!r} would each"
            " have to lie to the left of the other, because of what waits for them or what they"
            " wait for. (The smallest such case: two tasks that both wait for the same two.) Leave"
            " out one wait, or plan the cell without a board.",
            ("tasks", pair[1], "after"),
        )
        return
    try:
        if spans(after) is None:
            yield Fault(
                "no arrangement of columns has this precedence: all have been tried. Plan the cell"
                " without a board.",
                ("tasks",),
            )
    except TooManyError:
        yield Fault(
            f"no arrangement of columns was found among {MOST_SETS:,} beginnings of one; it is open"
            " whether there is one. Plan the cell without a board.",
            ("tasks",),
        )


RULES: tuple[Callable[[Cell], Iterator[Fault]], ...] = (
    one_robot_and_one_human,
    only_what_the_board_knows,
    times_are_whole_and_do_not_depend_on_who,
    precedence_is_overlap,
)


def _who(cell: Cell, task: Task) -> Who:
    if len(task.time) == 2:
        return Who.EITHER
    return Who.ROBOT if next(iter(task.time)) in cell.robots else Who.HUMAN


def _unknown(key: str) -> str:
    what = {"together": "joint tasks", "stress": "stress: only completion time counts"}.get(
        key, key.replace("_", " ")
    )
    return f"the chessboard knows no {what}. Leave it out to play."
