"""The package `tests`. Without this file another package of that name would win, and pychoco leaves
one in site-packages.
"""
