"""Deep Q-learning by agents that take turns, any number of them."""
