"""What has been seen of a shift: where it stands, what is reported of it, and what may begin. Plain
Python; knows no decider.
"""
