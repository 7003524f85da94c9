"""The chessboard game of Yu, Huang and Chang (2020): pieces fall, the human chooses first, nobody waits."""

from tandem.envs.chessboard.chance import Chance, fate
from tandem.envs.chessboard.layout import layout, stacked
from tandem.envs.chessboard.players import PLAYERS
from tandem.envs.chessboard.world import HUMAN, ROBOT, Fate, Layout, State, is_over, legal, observe, reset, step, to_play

__all__ = [
    "HUMAN",
    "PLAYERS",
    "ROBOT",
    "Chance",
    "Fate",
    "Layout",
    "State",
    "fate",
    "is_over",
    "layout",
    "legal",
    "observe",
    "reset",
    "stacked",
    "step",
    "to_play",
]
