"""A robot and a human side by side: separate and joint operations, tools, difficulty, fatigue, and
a change that nobody foresaw.
"""

from tandem.lab.zhang2022.change import Change, Kind, happen, possible
from tandem.lab.zhang2022.setting import Duo, Setting, duo, setting
from tandem.lab.zhang2022.world import State, choices, is_done, narrow, observe, reset, step

__all__ = [
    "Change",
    "Duo",
    "Kind",
    "Setting",
    "State",
    "choices",
    "duo",
    "happen",
    "is_done",
    "narrow",
    "observe",
    "possible",
    "reset",
    "setting",
    "step",
]
