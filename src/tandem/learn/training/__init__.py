"""Trainings that can be followed, stopped and taken up again; what they found, held against the
exact front.
"""
