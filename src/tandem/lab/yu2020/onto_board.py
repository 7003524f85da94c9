"""A cell as a chessboard, or every reason why it cannot be one."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from tandem.lab.yu2020.board import Board, Piece, Who
from tandem.lab.yu2020.columns import MOST_SETS, TooManyError, clash, rows, spans
from tandem.cell.model import Cell
from tandem.cell.parts import Task
from tandem.errors import CellError, Fault

LONGEST_S = 100_000


def board_of(cell: Cell) -> Board:
    """The cell as a board with the same schedules: one piece a task, in the cell's order; the columns are found by `columns.spans`.

    What plays no part in planning (labels, parts, difficulty, spread, who the operators are called) is left out.

    Raises:
      CellError: with every reason why the game cannot hold the cell. "No arrangement of columns" is proven, except where the message says that
        the search was given up.
    """
    if faults := [fault for rule in RULES for fault in rule(cell)]:
        raise CellError(faults)
    after = {name: task.after for name, task in cell.tasks.items()}
    columns = spans(after)
    assert columns is not None
    row = rows(after, columns)
    pieces = [Piece(name, row[name], *columns[name], _who(cell, task), int(min(task.time.values()))) for name, task in cell.tasks.items()]
    height, width = max(row.values()), max(last for _, last in columns.values())
    return Board(cell.name, height, width, tuple(sorted(pieces, key=lambda piece: (piece.row, piece.first))))


def one_robot_and_one_human(cell: Cell) -> Iterator[Fault]:
    """Two players."""
    if (len(cell.robots), len(cell.humans)) != (1, 1):
        yield Fault(f"the chessboard is played by one robot and one human; this cell has {len(cell.robots)} and {len(cell.humans)}.", ("operators",))


def only_what_the_board_knows(cell: Cell) -> Iterator[Fault]:
    """Time and precedence, nothing else."""
    for name, operator in cell.operators.items():
        for key, given in (("breaks", bool(operator.breaks)), ("stress_limit", operator.stress_limit is not None)):
            if given:
                yield Fault(_unknown(key), ("operators", name, key))
    for name, task in cell.tasks.items():
        for key in ("together", "tool", "zone", "release", "deadline", "stress"):
            if getattr(task, key) != Task.model_fields[key].default:
                yield Fault(_unknown(key), ("tasks", name, key))
    for key, given in (("same_operator", bool(cell.same_operator)), ("stress_of_set", cell.stress_of_set is not None)):
        if given:
            yield Fault(_unknown(key), (key,))


def times_are_whole_and_do_not_depend_on_who(cell: Cell) -> Iterator[Fault]:
    """One whole number a piece."""
    for name, task in cell.tasks.items():
        if len(set(task.time.values())) > 1:
            times = " and ".join(f"{who} {seconds:g} s" for who, seconds in task.time.items())
            yield Fault(f"a piece takes the same time whoever does it; this one takes {times}. Give both the same.", ("tasks", name, "time"))
        for who, seconds in task.time.items():
            if seconds % 1 or seconds > LONGEST_S:
                yield Fault(
                    f"{seconds:g} s: the chessboard counts whole seconds up to {LONGEST_S}. Round it, or take another unit.",
                    ("tasks", name, "time", who),
                )
        if not task.time and not task.together:
            yield Fault("nobody can do it.", ("tasks", name, "time"))


def precedence_is_overlap(cell: Cell) -> Iterator[Fault]:
    """There are columns for the tasks."""
    after = {name: task.after for name, task in cell.tasks.items()}
    if (pair := clash(after)) is not None:
        yield Fault(
            "no arrangement of columns has this precedence. A piece waits for all pieces below it in its columns and for no other; "
            f"here tasks {pair[0]!r} and {pair[1]!r} would each have to lie to the left of the other, because of what waits for them or what they "
            "wait for. (The smallest such case: two tasks that both wait for the same two.) Leave out one wait, or plan the cell without a board.",
            ("tasks", pair[1], "after"),
        )
        return
    try:
        if spans(after) is None:
            yield Fault("no arrangement of columns has this precedence: all have been tried. Plan the cell without a board.", ("tasks",))
    except TooManyError:
        yield Fault(
            f"no arrangement of columns was found among {MOST_SETS:,} beginnings of one; it is open whether there is one. "
            "Plan the cell without a board.",
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
    what = {"together": "joint tasks", "stress": "stress: only completion time counts"}.get(key, key.replace("_", " "))
    return f"the chessboard knows no {what}. Leave it out to play."
