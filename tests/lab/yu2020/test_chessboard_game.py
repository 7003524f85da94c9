"""The chessboard game: two tellings of its rules agree move by move, and each rule does what it
says.
"""

from __future__ import annotations

import jax
import numpy as np
import pytest
from tests.lab.yu2020.overlap_port import OverlapGame

from tandem.errors import UsageError
from tandem.lab.yu2020 import (
    HUMAN,
    PLAYERS,
    ROBOT,
    is_over,
    layout,
    legal,
    observe,
    reset,
    stacked,
    step,
    to_play,
)
from tandem.lab.yu2020.board import Board, Piece, Who, desk, random_board
from tandem.lab.yu2020.pictures import film
from tandem.lab.yu2020.play import by_rule, follow, makespans, play
from tandem.lab.yu2020.world import bottom, levels
from tandem.schedule.checker import faults

R, E, H = Who.ROBOT, Who.EITHER, Who.HUMAN


def board_of(*pieces, height=3, width=3):
    return Board(
        "tiny",
        height,
        width,
        tuple(
            Piece(name, row, first, last, who, time) for name, row, first, last, who, time in pieces
        ),
    )


@pytest.fixture(scope="module")
def tiny():
    """A robot piece under a wide shared one, a human piece beside it."""
    return board_of(
        ("r", 1, 1, 1, R, 2), ("h", 1, 2, 2, H, 3), ("wide", 2, 1, 2, E, 4), ("top", 3, 3, 3, R, 1)
    )


@pytest.mark.parametrize("seed", range(20))
def test_a_game_on_a_random_board_replays_in_the_other_telling_with_identical_times(seed):
    """Sizes vary with the seed, random play, every move: who chooses, among which columns, which
    piece it is, and the clock.
    """
    rng = np.random.default_rng(seed)
    board = (
        random_board(int(rng.integers(4, 9)), int(rng.integers(5, 9)), 6, 4, 8, 7, seed=seed)
        if seed
        else random_board(seed=34)
    )
    port, laid = OverlapGame(board), layout(board)

    def choose(_, state):
        assert port.now == state.clock
        assert port.columns() == list(np.flatnonzero(legal(laid, state)))
        assert port.player() == ("human" if to_play(laid, state) == HUMAN else "robot")
        column = int(rng.choice(port.columns()))
        names.append(port.take(column))
        return column

    names: list[str] = []
    game = play(board, choose)
    assert [move.piece for move in game.moves] == names
    assert port.columns() == []
    assert game.makespan == port.now
    assert faults(board.to_cell(), game.schedule) == []


@pytest.mark.parametrize(
    ("player", "seconds"),
    {"leftmost": 105, "rightmost": 102, "spt": 97, "lpt": 103, "longest-tail": 95}.items(),
)
def test_plain_players_on_the_desk_take_what_is_known_of_them(player, seconds):
    assert play(desk(), by_rule(PLAYERS[player])).makespan == seconds


def test_the_tensor_is_the_authors(tiny):
    laid = layout(tiny)
    state = reset(laid)
    time, code, width = np.moveaxis(observe(laid, state), -1, 0)
    # 'top' has fallen through two empty rows
    np.testing.assert_array_equal(time, [[2, 3, 1], [4, 0, 0], [0, 0, 0]])
    np.testing.assert_array_equal(code, [[2, 4, 2], [3, -1, -2], [-2, -2, -2]])
    np.testing.assert_array_equal(width, [[1, 1, 1], [2, 0, 0], [0, 0, 0]])
    # the human takes 'h', the robot 'r'; 'r' ends at 2
    state = step(laid, step(laid, state, np.int32(1)), np.int32(0))
    time, code, _ = np.moveaxis(observe(laid, state), -1, 0)
    assert state.clock == 2
    np.testing.assert_array_equal(code, [[-2, 1, 2], [3, -1, -2], [-2, -2, -2]])
    np.testing.assert_array_equal(time[0], [0, 1, 1])
    assert to_play(laid, state) == ROBOT
    np.testing.assert_array_equal(legal(laid, state), [False, False, True])


def test_the_human_chooses_first_and_must_choose(tiny):
    both = board_of(("a", 1, 1, 1, E, 2), ("b", 1, 2, 2, E, 2), ("c", 1, 3, 3, R, 1))
    laid = layout(both)
    state = reset(laid)
    assert to_play(laid, state) == HUMAN
    np.testing.assert_array_equal(legal(laid, state), [True, True, False])
    state = step(laid, state, np.int32(0))
    assert (to_play(laid, state), state.clock) == (ROBOT, 0)
    np.testing.assert_array_equal(legal(laid, state), [False, True, True])


def test_what_ends_at_the_same_time_ends_together():
    laid = layout(board_of(("a", 1, 1, 1, H, 2), ("b", 1, 2, 2, R, 2), ("c", 2, 1, 2, E, 1)))
    state = step(laid, step(laid, reset(laid), np.int32(0)), np.int32(1))
    assert state.clock == 2
    assert (to_play(laid, state), list(np.flatnonzero(legal(laid, state)))) == (HUMAN, [0])


def test_time_runs_on_when_who_is_free_first_has_nothing_to_take():
    laid = layout(board_of(("a", 1, 1, 1, H, 2), ("b", 1, 2, 2, R, 5), ("c", 2, 1, 2, H, 1)))
    state = step(laid, step(laid, reset(laid), np.int32(0)), np.int32(1))
    assert state.clock == 5
    assert to_play(laid, state) == HUMAN


def test_a_piece_falls_only_when_its_whole_span_is_empty():
    board = board_of(
        ("a", 1, 1, 1, R, 1), ("b", 1, 3, 3, R, 1), ("wide", 2, 1, 3, R, 1), ("c", 3, 2, 2, R, 1)
    )
    laid = layout(board)
    first = reset(laid)
    without_a = first._replace(on=first.on & ~np.array([[True, False, False]] + [[False] * 3] * 2))
    np.testing.assert_array_equal(levels(laid, without_a), [[0, 0, 1], [2, 2, 2], [0, 3, 0]])
    without_both = without_a._replace(
        on=without_a.on & ~np.array([[False, False, True]] + [[False] * 3] * 2)
    )
    np.testing.assert_array_equal(levels(laid, without_both), [[0, 0, 0], [1, 1, 1], [0, 2, 0]])


def test_what_can_be_taken_is_what_has_fallen_to_the_bottom_row():
    for seed in range(3):
        board = random_board(seed=seed)
        laid = layout(board)
        for move in play(board, by_rule(PLAYERS["random"], seed)).moves:
            np.testing.assert_array_equal(bottom(laid, move.state), levels(laid, move.state) == 1)


def test_after_the_end_and_in_an_illegal_column_nothing_happens(tiny):
    laid = layout(tiny)
    first = reset(laid)
    # the human cannot take 'r'
    for before, after in zip(first, step(laid, first, np.int32(0)), strict=True):
        np.testing.assert_array_equal(before, after)
    game = play(tiny, by_rule(PLAYERS["leftmost"]))
    last = step(laid, game.moves[-1].state, np.int32(game.moves[-1].column))
    assert is_over(last)
    assert not legal(laid, last).any()
    for before, after in zip(last, step(laid, last, np.int32(0)), strict=True):
        np.testing.assert_array_equal(before, after)
    with pytest.raises(UsageError, match=r"column 0 is not legal at 0 s; legal are 1\."):
        play(tiny, follow([0]))


def test_numpy_and_the_compiled_batch_of_different_boards_play_the_same_games():
    """Smaller boards are padded to the largest; padding changes nothing."""
    boards = [
        random_board(5, 4, 4, 4, 6, 5, seed=1),
        random_board(4, 3, 3, 2, 4, 9, seed=2),
        desk(),
    ]
    for name in ("longest-tail", "lpt"):
        took = makespans(stacked(boards), PLAYERS[name], jax.random.key(0))
        assert took[:, 0].tolist() == [
            play(board, by_rule(PLAYERS[name])).makespan for board in boards
        ]


def test_random_play_repeats_for_its_key_and_differs_between_games():
    laid = stacked([random_board(5, 4, 4, 4, 6, 5, seed=1)])
    first, again, other = (
        makespans(laid, PLAYERS["random"], jax.random.key(key), games=30) for key in (0, 0, 1)
    )
    np.testing.assert_array_equal(first, again)
    assert (first != other).any()
    assert len(np.unique(first)) > 1


def test_a_board_that_is_larger_than_the_padding_is_refused():
    with pytest.raises(
        UsageError, match="15 rows and 8 columns do not fit on 10 rows and 8 columns"
    ):
        layout(desk(), height=10)
    with pytest.raises(UsageError, match="give at least one"):
        stacked([])


def test_a_film_shows_the_whole_game_and_whoever_is_at_work():
    game = play(desk(), by_rule(PLAYERS["longest-tail"]))
    frames = film(game, 10)
    assert frames[0].title == "0 s"
    assert frames[0].rows == {piece.name: piece.row for piece in desk().pieces}
    assert len(frames) == 10
    assert [len(frame.rows) for frame in frames] == sorted(
        (len(frame.rows) for frame in frames), reverse=True
    )
    busy = {name for frame in frames for name in frame.doing}
    assert all(frame.rows[name] == 1 for frame in frames for name in frame.doing)
    assert any(len(frame.doing) == 2 for frame in frames)
    assert busy <= {piece.name for piece in desk().pieces}
