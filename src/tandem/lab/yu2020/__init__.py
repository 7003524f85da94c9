"""The chessboard game of Yu, Huang and Chang (2020): pieces fall, the human chooses first, nobody
waits.
"""

from tandem.lab.yu2020.chance import Chance, fate
from tandem.lab.yu2020.layout import layout, stacked
from tandem.lab.yu2020.players import PLAYERS
from tandem.lab.yu2020.world import (
    HUMAN,
    ROBOT,
    Fate,
    Layout,
    State,
    bottom,
    is_over,
    legal,
    levels,
    observe,
    reset,
    step,
    to_play,
)

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
