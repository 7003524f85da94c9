"""Policies from experience: independent PPO, its recipes, its runs, and the players that decide without JAX."""
