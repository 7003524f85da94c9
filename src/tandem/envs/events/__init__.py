"""The event world's standard faces: a robot beside a human for Gymnasium, every operator an agent for PettingZoo."""

from tandem.envs.game import Game, Options
from tandem.envs.observations import observe

__all__ = ["Game", "Options", "observe"]
