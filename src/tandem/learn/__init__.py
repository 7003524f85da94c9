"""Policies from experience: PPO, deep Q-learning, self-play with a search, best responses to people; their recipes, runs and players without JAX."""

from tandem.learn.agents import PPO
from tandem.learn.policy import Policy
from tandem.learn.recipes import RECIPES, Recipe

__all__ = ["PPO", "RECIPES", "Policy", "Recipe"]
