"""The station of Kinat (2023): two agents, ticks of one second, rewards as data."""

from tandem.lab.kinat2023.decisions import after_human, choices, decide_step, deciding
from tandem.lab.kinat2023.observations import observe, observe_normalised, observe_scaled
from tandem.lab.kinat2023.rewards import REWARDS, reward_set
from tandem.lab.kinat2023.station import station, whole_ticks
from tandem.lab.kinat2023.world import (
    HUMAN,
    ROBOT,
    Info,
    Rewards,
    State,
    Station,
    is_done,
    legal,
    reset,
    step,
)

__all__ = [
    "HUMAN",
    "REWARDS",
    "ROBOT",
    "Info",
    "Rewards",
    "State",
    "Station",
    "after_human",
    "choices",
    "decide_step",
    "deciding",
    "is_done",
    "legal",
    "observe",
    "observe_normalised",
    "observe_scaled",
    "reset",
    "reward_set",
    "station",
    "step",
    "whole_ticks",
]
