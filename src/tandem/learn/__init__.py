"""Policies from experience: independent PPO, its recipes, its runs, and the players that decide without JAX."""

from tandem.learn.agents import PPO
from tandem.learn.policy import Policy
from tandem.learn.recipes import RECIPES, Recipe

__all__ = ["PPO", "RECIPES", "Policy", "Recipe"]
