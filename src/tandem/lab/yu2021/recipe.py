"""The recipe of Yu, Huang and Chang (2021), as far as it is known."""

from tandem.learn.dqn.config import Config
from tandem.learn.dqn.recipes import ValueRecipe

YU_2021 = ValueRecipe(
    Config(), waiting=False, what="Yu, Huang and Chang 2021: a deep Q-network for each agent"
)
"""Yu, Huang and Chang (2021): a DQN for each agent on the same game, nobody waits. All numbers are
ASSUMPTION: none is public.
"""
