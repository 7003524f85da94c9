"""A robot and a human side by side: separate and joint operations, tools, difficulty, fatigue, and a change that nobody foresaw."""

from tandem.envs.duo.change import Change, Kind, happen, possible
from tandem.envs.duo.setting import Duo, Setting, duo, setting
from tandem.envs.duo.world import State, choices, is_done, narrow, observe, reset, step

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
