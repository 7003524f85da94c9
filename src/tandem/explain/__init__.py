"""Answers about a plan: why it is so, what else would cost, what changed, and what would help. Each
stated number comes from planning anew.
"""
