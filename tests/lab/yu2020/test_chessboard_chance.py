"""Robot failures and human errors: what they do to a game, and that all deciders meet the same
ones.
"""

from __future__ import annotations

import jax
import numpy as np
import pytest

from tandem.errors import UsageError
from tandem.lab.yu2020 import (
    HUMAN,
    PLAYERS,
    ROBOT,
    Chance,
    Fate,
    fate,
    layout,
    reset,
    stacked,
    step,
    to_play,
)
from tandem.lab.yu2020.board import Board, Piece, Who, random_board
from tandem.lab.yu2020.optimal import replanning
from tandem.lab.yu2020.play import by_rule, makespans, play

BOARD = Board(
    "two",
    2,
    2,
    (
        Piece("h", 1, 1, 1, Who.EITHER, 3),
        Piece("r", 1, 2, 2, Who.ROBOT, 2),
        Piece("top", 2, 1, 2, Who.ROBOT, 4),
    ),
)


def fate_of(repair=(0, 0, 0), mistakes=(0, 0, 0)):
    """Of the pieces h, r, top."""
    repairs, wrong = np.zeros((2, 2), np.int32), np.zeros((2, 2), np.int32)
    for row, column, more, times in zip((0, 0, 1), (0, 1, 0), repair, mistakes, strict=True):
        repairs[row, column], wrong[row, column] = more, times
    return Fate(repairs, wrong)


def test_a_robot_that_fails_repairs_before_it_is_free():
    laid = layout(BOARD)
    state = step(
        laid,
        step(laid, reset(laid), np.int32(0), fate_of((0, 5, 0))),
        np.int32(1),
        fate_of((0, 5, 0)),
    )
    assert (state.clock, to_play(laid, state)) == (7, ROBOT)  # h ends at 3, r at 2 + 5
    assert play(BOARD, by_rule(PLAYERS["leftmost"]), fate=fate_of((0, 5, 0))).makespan == 11


def test_what_the_human_did_wrong_stays_and_whoever_can_does_it_again():
    wrong = fate_of(mistakes=(2, 0, 0))
    game = play(BOARD, by_rule(PLAYERS["leftmost"]), fate=wrong)
    assert [(move.piece, move.agent, move.at) for move in game.moves] == [
        ("h", HUMAN, 0), ("r", ROBOT, 0), ("h", HUMAN, 3), ("h", HUMAN, 6), ("top", ROBOT, 9),
    ]  # fmt: skip
    assert game.makespan == 13
    laid = layout(BOARD)
    state = step(laid, step(laid, reset(laid), np.int32(0), wrong), np.int32(1), wrong)
    assert state.clock == 3
    assert to_play(laid, state) == HUMAN
    assert state.on[0, 0]


def test_what_the_robot_does_is_never_a_humans_mistake():
    board = Board("one", 1, 1, (Piece("e", 1, 1, 1, Who.ROBOT, 3),))
    assert (
        play(
            board,
            by_rule(PLAYERS["leftmost"]),
            fate=Fate(np.zeros((1, 1), np.int32), np.full((1, 1), 4, np.int32)),
        ).makespan
        == 3
    )


def test_the_compiled_batch_meets_the_same_troubles_as_a_game_in_numpy():
    boards = [random_board(5, 5, 4, 4, 6, 5, seed=seed) for seed in range(2)]
    laid, numbers = stacked(boards), np.random.default_rng(0).random((2, 3, 3, 5, 5))
    each = [
        [fate(layout(board), Chance(0.3, 5, 0.3), draw) for draw in draws]
        for board, draws in zip(boards, numbers, strict=True)
    ]
    each[0][0] = Fate(*(np.zeros((5, 5), np.int32) for _ in range(2)))
    together = Fate(
        *(np.array([[getattr(one, name) for one in row] for row in each]) for name in Fate._fields)
    )
    expected = [
        [play(board, by_rule(PLAYERS["longest-tail"]), fate=one).makespan for one in row]
        for board, row in zip(boards, each, strict=True)
    ]
    np.testing.assert_array_equal(
        makespans(laid, PLAYERS["longest-tail"], jax.random.key(0), games=3, fates=together),
        expected,
    )
    assert expected[0][0] == play(boards[0], by_rule(PLAYERS["longest-tail"])).makespan


def test_troubles_come_as_often_as_they_should_and_more_likely_ones_bring_more():
    board = layout(random_board(15, 12, 60, 40, 80, 10, seed=0))
    numbers = np.random.default_rng(0).random((3, 200, *board.time.shape)).swapaxes(0, 1)
    seldom, often = (
        [fate(board, chance, draw) for draw in numbers]
        for chance in (Chance(0.05, 10, 0.1), Chance(0.2, 10, 0.3))
    )
    starts = board.who > 0
    repairs = np.array([one.repair[starts] for one in seldom])
    assert np.mean(repairs > 0) == pytest.approx(0.05, abs=0.005)
    assert repairs[repairs > 0].mean() == pytest.approx(10.5, abs=0.5)  # rounded up
    assert np.mean([one.mistakes[starts] > 0 for one in seldom]) == pytest.approx(0.1, abs=0.005)
    assert np.mean([one.mistakes[starts] > 1 for one in seldom]) == pytest.approx(0.01, abs=0.003)
    for few, many in zip(seldom, often, strict=True):
        assert (few.repair <= many.repair).all()
        assert (few.mistakes <= many.mistakes).all()
        assert not many.repair[~starts].any()
    assert not fate(board, Chance(0, 10, 0), numbers[0]).mistakes.any()


def test_who_plans_anew_finishes_a_game_in_which_much_goes_wrong():
    board = random_board(5, 5, 4, 4, 6, 5, seed=1)
    troubled = fate(layout(board), Chance(0.4, 5, 0.4), np.random.default_rng(1).random((3, 5, 5)))
    assert (
        play(board, replanning(board), fate=troubled).makespan
        > play(board, replanning(board)).makespan
    )


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"robot_fails": 1.0}, "robot_fails=1.0: a probability"),
        ({"repair_s": 0.0}, "more than 0 seconds"),
    ],
)
def test_impossible_chances_are_refused(wrong, said):
    with pytest.raises(UsageError, match=said):
        Chance(**wrong)
