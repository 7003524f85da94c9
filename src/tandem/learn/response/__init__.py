"""A best response to people: one decider for all robots, trained beside people drawn from a population, whom it can ask but not steer."""
