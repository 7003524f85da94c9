"""A shift, live: events in, decisions out, each in time and in the journal; its replay, and a
simulated floor to try it on.
"""

from tandem.dispatch.shift.live import Settings, Shift

__all__ = ["Settings", "Shift"]
