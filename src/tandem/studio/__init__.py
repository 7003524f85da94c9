"""The studio: a local web page on which a cell is edited, planned and questioned.

Everything that the page shows comes from the rooms below as the documents of the command line.
"""
