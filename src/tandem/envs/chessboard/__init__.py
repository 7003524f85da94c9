"""The chessboard game of Yu, Huang and Chang (2020): pieces fall, the human chooses first, nobody waits."""

from tandem.envs.chessboard.chance import Chance, fate
from tandem.envs.chessboard.layout import layout, stacked
from tandem.envs.chessboard.players import PLAYERS
from tandem.envs.chessboard.world import HUMAN, ROBOT, Fate, Layout, State, bottom, is_over, legal, levels, observe, reset, step, to_play

__all__ = [
    "HUMAN",
    "PLAYERS",
    "ROBOT",
    "Chance",
    "Fate",
    "Layout",
    "State",
    "bottom",
    "fate",
    "is_over",
    "layout",
    "legal",
    "levels",
    "observe",
    "reset",
    "stacked",
    "step",
    "to_play",
]
