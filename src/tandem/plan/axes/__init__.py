"""Fronts over any measures: cell and names of axes in, every compromise between them out."""
