"""Work instead of time: what a decision may cost is counted in steps, so that it comes out the same
on every machine and however busy it is.

A step is one position made by branch and bound; all else is counted in what it takes compared with
that. A budget in milliseconds is turned into steps once, before anything is decided, at
`STEPS_PER_MS` or at what `branch_and_bound.measured` found.
"""

from __future__ import annotations

from math import inf

from tandem.errors import TandemError

STEPS_PER_MS = 60.0
"""Steps that a millisecond buys where nothing was measured: a core of 2020 makes about 100."""


class OutOfWorkError(TandemError):
    """The work that was allowed is done, and what was asked is not."""


class Work:
    """So many steps may be done.

    Attributes:
      done: steps so far. `limit`: the most of them, inf for no end.
    """

    __slots__ = ("done", "limit")

    def __init__(self, limit: float = inf) -> None:
        self.done, self.limit = 0.0, limit

    def spend(self, steps: float = 1.0) -> None:
        """Counts the steps. Raises OutOfWorkError, and counts nothing, where they are too many."""
        if self.done + steps > self.limit:
            raise OutOfWorkError("the work that was allowed is done.")
        self.done += steps

    @property
    def left(self) -> float:
        """Steps that may still be done."""
        return self.limit - self.done
