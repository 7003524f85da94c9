"""What is proven about boards: the search over states, with and without waiting, against the
planner and against trying everything.
"""

from __future__ import annotations

from dataclasses import replace

import pytest
from tests.lab.yu2020.overlap_port import OverlapGame

from tandem.errors import NothingFoundError
from tandem.lab.yu2020.board import Board, Piece, Who, desk, random_board
from tandem.lab.yu2020.optimal import optimum, replanning
from tandem.lab.yu2020.play import follow, play
from tandem.plan.methods import plan
from tandem.schedule.checker import faults
from tandem.schedule.measures import makespan

NO_WAITING = (
    135, 129, 142, 159, 141, 145, 137, 123, 123, 136, 139, 138, 127, 135, 136, 141, 131, 152, 132,
    128,
)  # fmt: skip
"""The game's optimum on the authors' boards with seeds 0 to 19, known from elsewhere."""
WAITING = (
    135, 126, 142, 158, 141, 145, 137, 123, 122, 136, 139, 138, 125, 135, 135, 138, 131, 152, 132,
    128,
)  # fmt: skip
"""The same boards as cells."""


@pytest.mark.parametrize("seed", range(20))
def test_the_optima_of_the_authors_boards(seed):
    board = random_board(seed=seed)
    found = optimum(board)
    assert found.makespan == NO_WAITING[seed]
    assert play(board, follow(found.columns)).makespan == found.makespan
    assert optimum(board, waiting=True).makespan == WAITING[seed]


@pytest.mark.parametrize("waiting", [False, True])
def test_the_desk_takes_94_with_and_without_waiting(waiting):
    found = optimum(desk(), waiting=waiting)
    assert found.makespan == makespan(found.schedule) == 94
    assert faults(desk().to_cell(), found.schedule) == []
    if not waiting:
        assert play(desk(), follow(found.columns)).schedule == found.schedule


def least(game: OverlapGame, taken: tuple[int, ...]) -> int:
    """The least makespan, by trying every game; games are played again from the start."""
    if not game.columns():
        return game.now
    return min(
        least(replayed(game, (*taken, column)), (*taken, column)) for column in game.columns()
    )


def replayed(game: OverlapGame, columns: tuple[int, ...]) -> OverlapGame:
    again = OverlapGame(game.board)
    for column in columns:
        again.take(column)
    return again


@pytest.mark.parametrize("seed", range(8))
def test_trying_every_game_finds_nothing_better(seed):
    board = random_board(3, 4, 2, 2, 3, 6, seed=seed)
    game = OverlapGame(board)
    assert optimum(board).makespan == least(game, ())


@pytest.mark.parametrize("seed", range(6))
def test_with_waiting_the_planner_agrees(seed):
    board = random_board(5, 5, 5, 3, 5, 8, seed=seed)
    found = optimum(board, waiting=True)
    assert faults(board.to_cell(), found.schedule) == []
    assert (
        found.makespan
        == makespan(found.schedule)
        == plan(board.to_cell(), minimize="makespan", workers=1).results[0].makespan
    )
    assert found.makespan <= optimum(board).makespan


def halves(turn):
    """A random board of three columns and beside it the same again, shifted or mirrored, under one
    piece over all six.
    """
    left = random_board(4, 3, 3, 2, 4, 6, seed=5).pieces
    right = [
        replace(piece, name=piece.name + "b", first=turn(piece)[0], last=turn(piece)[1])
        for piece in left
    ]
    return Board("two halves", 5, 6, (*left, *right, Piece("lid", 5, 1, 6, Who.ROBOT, 2)))


TURNS = {
    "shifted": lambda piece: (piece.first + 3, piece.last + 3),
    "mirrored": lambda piece: (7 - piece.last, 7 - piece.first),
}


@pytest.mark.parametrize("turn", TURNS)
def test_symmetric_halves_are_folded_and_nothing_is_lost(turn):
    """An empty column more takes the symmetry away and changes nothing else."""
    board = halves(TURNS[turn])
    found, unfolded = optimum(board), optimum(replace(board, width=7))
    assert play(board, follow(found.columns)).makespan == found.makespan == unfolded.makespan
    assert found.states < 0.6 * unfolded.states


def test_a_proof_that_needs_too_many_states_is_given_up():
    with pytest.raises(NothingFoundError, match="needs more than 10 states"):
        optimum(desk(), limit=10)


def test_who_plans_anew_plays_the_optimum_when_nothing_goes_wrong():
    board = random_board(seed=3)
    assert play(board, replanning(board)).makespan == NO_WAITING[3]
