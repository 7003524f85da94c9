"""Generated cells: the same for a seed, of the asked shape, and Yu's boards as far as is known of
them.
"""

from __future__ import annotations

import statistics

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.boards import OPTIMA

from tandem.files.generators import HARDEST, LONGEST, SHORTEST, layered
from tandem.lab.yu2020.board import Who, desk, random_board

share = st.floats(0, 1)


@given(
    st.integers(1, 40),
    st.integers(0, 3),
    st.integers(1, 3),
    share,
    share,
    share,
    st.integers(0, 2**32),
)
def test_any_asked_cell_is_sound_and_repeats_for_its_seed(
    tasks, humans, robots, exclusive, density, heterogeneity, seed
):
    def make():
        return layered(
            tasks,
            humans,
            robots,
            exclusive=exclusive,
            density=density,
            heterogeneity=heterogeneity,
            seed=seed,
        )

    cell = make()
    assert cell == make()
    assert len(cell.tasks) == tasks
    assert (len(cell.humans), len(cell.robots)) == (humans, robots)
    for task in cell.tasks.values():
        assert all(time == int(time) and SHORTEST <= time <= LONGEST for time in task.time.values())
        assert 0 <= task.stress <= HARDEST


def test_the_shares_do_what_they_say():
    alike = layered(300, 2, 1, exclusive=0, heterogeneity=0, seed=1)
    assert all(
        len(set(task.time.values())) == 1 and len(task.time) == 3 for task in alike.tasks.values()
    )
    apart = layered(2000, exclusive=0, heterogeneity=1, seed=1)
    assert (
        abs(
            statistics.correlation(
                *zip(*(task.time.values() for task in apart.tasks.values()), strict=True)
            )
        )
        < 0.1
    )
    special = layered(2000, 2, 2, exclusive=0.3, seed=1)
    assert sum(len(task.time) == 2 for task in special.tasks.values()) / 2000 == pytest.approx(
        0.3, abs=0.05
    )
    single = layered(2000, 0, 4, exclusive=0.3, seed=1)
    assert sum(len(task.time) == 1 for task in single.tasks.values()) / 2000 == pytest.approx(
        0.3, abs=0.05
    )


def test_layers_are_the_longest_chain():
    cell = layered(60, layers=7, density=0.1, seed=4)
    depth: dict[str, int] = {}
    for name, task in cell.tasks.items():
        depth[name] = 1 + max((depth[first] for first in task.after), default=0)
    assert max(depth.values()) == 7
    assert all(not task.after for task in layered(9, layers=1, seed=4).tasks.values())


def test_seeds_differ():
    assert len({layered(12, seed=seed).digest for seed in range(20)}) == 20


@pytest.mark.parametrize(
    "wrong",
    [
        {"tasks": 0},
        {"tasks": 3, "humans": 0, "robots": 0},
        {"tasks": 3, "layers": 4},
        {"tasks": 3, "density": 1.5},
    ],
    ids=str,
)
def test_what_cannot_be_generated_is_said(wrong):
    with pytest.raises(ValueError, match=r"cell needs|layers is 4|density is 1\.5"):
        layered(**wrong, seed=0)


def test_the_desk_has_the_published_numbers():
    board = desk()
    totals = {who: sum(piece.time for piece in board.pieces if piece.who is who) for who in Who}
    counts = {who: sum(piece.who is who for piece in board.pieces) for who in Who}
    assert counts == {Who.ROBOT: 29, Who.EITHER: 4, Who.HUMAN: 20}
    assert totals == {Who.ROBOT: 86, Who.EITHER: 8, Who.HUMAN: 66}
    cell = board.to_cell()
    end: dict[str, float] = {}
    for name, task in cell.tasks.items():
        end[name] = min(task.time.values()) + max((end[first] for first in task.after), default=0)
    assert max(end.values()) == 56


@given(st.integers(1, 8), st.integers(1, 6), st.data())
def test_pieces_fill_their_board_without_overlap(height, width, data):
    count = data.draw(st.integers(height, height * width))
    human = data.draw(st.integers(0, count))
    joint = data.draw(st.integers(0, count - human))
    board = random_board(
        height, width, human, joint, count - human - joint, 5, seed=data.draw(st.integers(0, 99))
    )
    covered = [
        (piece.row, column)
        for piece in board.pieces
        for column in range(piece.first, piece.last + 1)
    ]
    assert sorted(covered) == [
        (row, column) for row in range(1, height + 1) for column in range(1, width + 1)
    ]
    assert sum(piece.who is Who.EITHER for piece in board.pieces) == joint
    assert all(1 <= piece.time <= 4 for piece in board.pieces)


@given(st.integers(0, 999))
def test_precedence_is_overlap_of_columns_and_says_nothing_twice(seed):
    board = random_board(6, 5, 4, 4, 6, 5, seed=seed)
    cell = board.to_cell()
    before: dict[str, set[str]] = {}
    for name, task in cell.tasks.items():
        before[name] = set(task.after).union(*(before[first] for first in task.after))
        assert all(first not in before[other] for first in task.after for other in task.after)
    pieces = {piece.name: piece for piece in board.pieces}
    for high in pieces.values():
        for low in pieces.values():
            if low.row < high.row and low.first <= high.last and high.first <= low.last:
                assert low.name in before[high.name]


def test_a_board_that_cannot_be_is_refused():
    with pytest.raises(ValueError, match="at least one a row, at most one a cell"):
        random_board(3, 3, 1, 0, 1, 5, seed=0)


@pytest.mark.parametrize("seed", range(20))
def test_the_boards_are_the_authors_own(seed):
    """A small model of its own here, so that the ground does not lean on the planner: 0.2 s a
    board.
    """
    from ortools.sat.python import cp_model

    cell = random_board(seed=seed).to_cell()
    model = cp_model.CpModel()
    horizon = int(sum(min(task.time.values()) for task in cell.tasks.values()))
    end = model.new_int_var(0, horizon, "")
    starts = {name: model.new_int_var(0, horizon, "") for name in cell.tasks}
    lanes: dict[str, list[tuple[object, object]]] = {"robot": [], "human": []}
    for name, task in cell.tasks.items():
        time = int(min(task.time.values()))
        by_robot = model.new_bool_var("") if len(task.time) == 2 else None
        for who in task.time:
            chosen = True if by_robot is None else by_robot if who == "robot" else ~by_robot
            lanes[who].append(
                (
                    model.new_optional_fixed_size_interval_var(starts[name], time, chosen, ""),
                    time * chosen,
                )
            )
        model.add(end >= starts[name] + time)
        for first in task.after:
            model.add(starts[name] >= starts[first] + int(min(cell.tasks[first].time.values())))
    for lane in lanes.values():
        model.add_no_overlap([interval for interval, _ in lane])
        model.add(sum(time for _, time in lane) <= end)
    model.minimize(end)
    solver = cp_model.CpSolver()
    assert solver.solve(model) == cp_model.OPTIMAL
    assert solver.objective_value == OPTIMA[seed]
