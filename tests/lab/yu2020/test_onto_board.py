"""Any cell that a chessboard can hold gets one with exactly its precedence; any other is refused
with every reason.
"""

from __future__ import annotations

from itertools import permutations, product

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import tandem
from tandem.cell.model import Cell
from tandem.errors import CellError
from tandem.files.validate import cell_of as read
from tandem.lab.yu2020.board import Board, Who, desk, random_board
from tandem.lab.yu2020.columns import Order, clash, rows, spans


def cell_with(after, time=None, **more):
    able = {"robot": 3, "human": 3}
    tasks = {
        name: {"time": (time or {}).get(name, able), "after": list(firsts)}
        for name, firsts in after.items()
    }
    return read(
        {
            "operators": {"robot": {"kind": "robot"}, "human": {"kind": "human"}},
            "tasks": tasks,
            **more,
        }
    )


def order_on(board: Board) -> dict[str, set[str]]:
    """What must come before each piece."""
    return Order.of({name: task.after for name, task in board.to_cell().tasks.items()}).before


def order_in(cell: Cell) -> dict[str, set[str]]:
    return Order.of({name: task.after for name, task in cell.tasks.items()}).before


@pytest.mark.parametrize(
    "board",
    [desk(), *(random_board(seed=seed) for seed in range(12))],
    ids=lambda board: board.name,
)
def test_a_board_that_became_a_cell_becomes_a_board_with_the_same_cell(board):
    again = Board.of(board.to_cell())
    assert order_on(again) == order_on(board)
    assert {p.name: (p.who, p.time) for p in again.pieces} == {
        p.name: (p.who, p.time) for p in board.pieces
    }
    direct = [
        {name: set(task.after) for name, task in b.to_cell().tasks.items()} for b in (again, board)
    ]
    assert direct[0] == direct[1]


@st.composite
def precedence(draw):
    number = draw(st.integers(1, 7))
    pairs = [(i, j) for j in range(number) for i in range(j)]
    chosen = draw(st.lists(st.sampled_from(pairs), unique=True)) if pairs else []
    return {str(j): [str(i) for i, other in chosen if other == j] for j in range(number)}


@settings(max_examples=150)
@given(precedence())
def test_pieces_lie_apart_and_wait_for_exactly_what_their_tasks_wait_for(after):
    columns = spans(after)
    assume(columns is not None)
    board = Board.of(cell_with(after))
    cells = [
        (piece.row, column)
        for piece in board.pieces
        for column in range(piece.first, piece.last + 1)
    ]
    assert len(cells) == len(set(cells))
    assert order_on(board) == order_in(cell_with(after))
    assert clash(after) is None


def exists(after) -> bool:
    """Whether there is a board, by trying every order of beginnings and every set of ends: an
    interval a task on a line.
    """
    before, tasks = Order.of(after).before, list(after)
    for order in permutations(tasks):
        for lengths in product(*(range(len(tasks) - place) for place in range(len(tasks)))):
            lies = {
                task: (place, place + length)
                for place, (task, length) in enumerate(zip(order, lengths, strict=True))
            }
            meet = {
                (a, b)
                for a, b in permutations(tasks, 2)
                if lies[a][0] <= lies[b][1] and lies[b][0] <= lies[a][1]
            }
            if all(a in before[b] or b in before[a] for a, b in meet):
                met = {b: [a for a in before[b] if (a, b) in meet] for b in tasks}
                if Order.of(met).before == before:
                    return True
    return False


@settings(max_examples=40)
@given(precedence())
def test_what_is_refused_has_no_board_at_all(after):
    assume(len(after) <= 4)
    assert (spans(after) is not None) == exists(after)


TWO_WAIT_FOR_TWO = {"a": [], "b": [], "c": ["a", "b"], "d": ["a", "b"]}
SPIDER = {
    "hub": [],
    **{f"{leg}1": ["hub"] for leg in "xyz"},
    **{f"{leg}2": [f"{leg}1"] for leg in "xyz"},
}
UP_AND_DOWN = {
    "hub": ["x", "y", "z"],
    "x": [],
    "y": [],
    "z": [],
    "x2": ["x"],
    "y2": ["y"],
    "z2": ["z"],
}


def test_a_tree_of_assembly_always_has_a_board():
    assert spans(SPIDER) is not None
    assert rows(SPIDER, spans(SPIDER))["x2"] == 3


@pytest.mark.parametrize(
    "after",
    [TWO_WAIT_FOR_TWO, UP_AND_DOWN],
    ids=["two wait for two", "three arms with ends outside"],
)
def test_precedence_that_no_board_has_is_refused_with_the_tasks_that_show_it(after):
    """In the second, x, y and z lie side by side under the hub; what waits for the middle one alone
    finds no room of its own.
    """
    with pytest.raises(
        CellError,
        match=(
            r"tasks\.\w+\.after: no arrangement of columns .* each have to lie to the left of the"
            r" other"
        ),
    ):
        Board.of(cell_with(after))


def test_every_reason_is_given_at_once():
    cell = cell_with(
        TWO_WAIT_FOR_TWO,
        {"a": {"robot": 2, "human": 3}, "b": {"robot": 1.5}},
        operators={
            "robot": {"kind": "robot"},
            "human": {"kind": "human", "breaks": [[1, 2]]},
            "second": {"kind": "human"},
        },
    )
    tasks = {name: task.model_dump(exclude_defaults=True) for name, task in cell.tasks.items()}
    tasks["a"] |= {
        "stress": 2.0,
        "tool": "screwdriver",
        "zone": "table",
        "deadline": 99.0,
        "wait": [{"after": "b", "at_least": 1.0}],
        "release": 1.0,
    }
    tasks["c"] |= {"together": [{"operators": ["robot", "human"], "time": 2.0}]}
    cell = cell.replace(tasks=tasks, same_operator=[["a", "c"]])
    with pytest.raises(CellError) as caught:
        Board.of(cell)
    assert {".".join(map(str, fault.path)) for fault in caught.value.faults} == {
        "operators", "operators.human.breaks", "tasks.a.time", "tasks.b.time.robot",
        "tasks.a.stress", "tasks.a.tool", "tasks.a.zone",
        "tasks.a.deadline", "tasks.a.release", "tasks.a.wait", "tasks.c.together", "same_operator",
        "tasks.b.after",
    }  # fmt: skip
    assert "takes robot 2 s and human 3 s" in str(caught.value)
    assert "1.5 s: the chessboard counts whole seconds" in str(caught.value)


def test_the_thesis_cell_is_refused_for_times_and_stress_alone():
    with pytest.raises(CellError) as caught:
        Board.of(tandem.load("examples/thesis.yaml"))
    assert {fault.path[-1] for fault in caught.value.faults} == {"time", "stress"}


def test_who_can_do_it_is_told_by_the_kind_not_the_name():
    cell = read(
        {
            "operators": {"anna": {"kind": "human"}, "cobot": {"kind": "robot"}},
            "tasks": {"a": {"time": {"anna": 2}}, "b": {"time": {"cobot": 1}}},
        }
    )
    assert [piece.who for piece in Board.of(cell).pieces] == [Who.HUMAN, Who.ROBOT]
