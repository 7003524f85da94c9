"""Who proved a bound, and the steps by which it was raised.

A bound is as good as what proved it. Closed forms can be reckoned on paper, dynamic programming and
the state search are Tandem's own and call no solver, and CP-SAT is a large program that nobody
checks line by line. So every bound says whose it is.
"""

from __future__ import annotations

from collections.abc import Iterable
from enum import StrEnum
from typing import NamedTuple


class Prover(StrEnum):
    """What proved a bound; where several give the same one it is the first of these.

    The first four are closed forms (`bounds.py`), which need no search.
    """

    CHAIN = "critical path"
    LOAD = "load of one operator"
    SHARED = "load shared out"
    LEAST_STRESS = "least stress"
    DYNAMIC = "dynamic programming"
    STATES = "state search"
    ALLOCATION = "allocation relaxation"
    CONFIRMED = "cp-sat, confirmed by dynamic programming"
    CP_SAT = "cp-sat"

    @property
    def rank(self) -> int:
        """Its place in the order above."""
        return _ORDER[self]

    @property
    def needs_cp_sat(self) -> bool:
        """Whether nothing but CP-SAT vouches for it. The allocation relaxation is solved by CP-SAT
        too, as a small linear model.
        """
        return self in (Prover.CP_SAT, Prover.ALLOCATION)


_ORDER = {prover: place for place, prover in enumerate(Prover)}


class Step(NamedTuple):
    """The most that one prover has proven: ticks or units in a search, seconds or the cell's
    measure of stress in a result.
    """

    value: float
    by: Prover


def rising(steps: Iterable[Step]) -> tuple[Step, ...]:
    """The most of each prover, where it says more than all before it; the last one proves."""
    most: dict[Prover, Step] = {}
    for step in steps:
        most[step.by] = max(step, most.get(step.by, step))
    kept: list[Step] = []
    for step in sorted(most.values(), key=lambda step: (step.value, step.by.rank)):
        if not kept or step.value > kept[-1].value:
            kept.append(step)
    return tuple(kept)
