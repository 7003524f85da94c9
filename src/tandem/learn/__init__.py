"""Policies from experience: PPO, deep Q-learning, self-play with a search, best responses to
people; their recipes, runs and players without JAX.
"""

from tandem.learn.policy import Policy
from tandem.learn.ppo.recipes import Recipe
from tandem.learn.training.agents import PPO
from tandem.learn.training.recipes import RECIPES

__all__ = ["PPO", "RECIPES", "Policy", "Recipe"]
