"""Who decides: a situation in, a decision out; the rules, the planners, the exact and the learned
ones, and one table of them all.
"""
