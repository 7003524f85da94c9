"""The cell in motion, event by event: state, legal ways, time, chance, people. Pure functions over
an array namespace.
"""
