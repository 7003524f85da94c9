"""What the rest of an assembly comes to: the cell and its moves in whole numbers, a search, CP-SAT,
and exact values of small cells.
"""
