"""How good deciders are: many simulated episodes beside people who deviate, held against the exact
optimum.
"""
