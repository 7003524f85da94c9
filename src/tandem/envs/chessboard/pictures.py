"""Moments of a game for `tandem.draw.board`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from tandem.cell.chessboard import Board, Who
from tandem.draw.board import Frame
from tandem.envs.chessboard.layout import by_place, layout
from tandem.envs.chessboard.play import Game
from tandem.envs.chessboard.world import HUMAN, ROBOT, State, levels

WHO = {ROBOT: Who.ROBOT, HUMAN: Who.HUMAN}


def frame(board: Board, state: State, title: str) -> Frame:
    """What lies where in the state, and who has what in hand."""
    lies = levels(layout(board), state)
    names = by_place(board)
    rows = {piece.name: int(lies[place]) for place, piece in names.items() if lies[place]}
    doing = {names[row, column].name: WHO[agent] for agent in WHO for row, column in zip(*np.nonzero(state.doing[agent]), strict=True)}
    return Frame(title, rows, doing)


def film(game: Game, count: int = 12) -> list[Frame]:
    """About `count` moments of the game, evenly over its clock: each as it looks when the last move of that moment has been made."""
    return [frame(game.board, state, f"{state.clock} s") for state in _at_rest(game, count)]


def _at_rest(game: Game, count: int) -> Sequence[State]:
    wanted = np.linspace(0, game.makespan, count, endpoint=False)
    moments = list(_moments(game))
    clocks = np.array([int(state.clock) for state in moments])
    places = sorted({int(np.searchsorted(clocks, moment, side="right")) - 1 for moment in wanted})
    return [moments[place] for place in places]


def _moments(game: Game) -> Iterator[State]:
    """The states before the moves, without those in which the other agent moves at the same second."""
    states = [move.state for move in game.moves]
    for state, following in zip(states, [*states[1:], None], strict=True):
        if following is None or following.clock > state.clock:
            yield state
