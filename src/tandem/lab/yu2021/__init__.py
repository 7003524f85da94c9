"""Yu, Huang and Chang (2021): a deep Q-network for each agent, more than two agents."""
