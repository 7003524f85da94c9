"""Every door for cells: YAML, JSON, public benchmark formats, planners' workbooks; what is wrong
with them in words.
"""
