"""One policy for any cell: a small network over tasks and operators that puts the tasks of a cell
behind each other, trained on many cells, shipped with its weights.
"""
