"""Moments of a game for `tandem.lab.yu2020.board_picture`."""

from __future__ import annotations

import numpy as np

from tandem.lab.yu2020.board import Board, Who
from tandem.lab.yu2020.board_picture import Frame
from tandem.lab.yu2020.layout import by_place, layout
from tandem.lab.yu2020.play import Game
from tandem.lab.yu2020.world import HUMAN, ROBOT, State, begin, levels

WHO = {ROBOT: Who.ROBOT, HUMAN: Who.HUMAN}


def frame(board: Board, state: State, title: str) -> Frame:
    """What lies where in the state, and who has what in hand."""
    lies = levels(layout(board), state)
    names = by_place(board)
    rows = {piece.name: int(lies[place]) for place, piece in names.items() if lies[place]}
    doing = {
        names[row, column].name: WHO[agent]
        for agent in WHO
        for row, column in zip(*np.nonzero(state.doing[agent]), strict=True)
    }
    return Frame(title, rows, doing)


def film(game: Game, count: int = 12) -> list[Frame]:
    """About `count` moments of the game, evenly over its clock: each as it looks when everybody has
    chosen who could.
    """
    moments = _moments(game)
    clocks = np.array([int(state.clock) for state in moments])
    wanted = np.linspace(0, game.makespan, count, endpoint=False)
    places = sorted({int(np.searchsorted(clocks, moment, side="right")) - 1 for moment in wanted})
    return [frame(game.board, moments[place], f"{clocks[place]} s") for place in places]


def _moments(game: Game) -> list[State]:
    """The states after the last move of each second in which there were moves, before time runs
    on.
    """
    laid, found = layout(game.board), []
    for move, following in zip(game.moves, [*game.moves[1:], None], strict=True):
        if following is None or following.at > move.at:
            found.append(begin(laid, move.state, np.int32(move.column)))
    return found
