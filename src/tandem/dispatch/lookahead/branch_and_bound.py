"""The least cost of what is left, when everybody does what is planned and times are as believed:
branch and bound over positions.

Depth first, the most promising continuation first, for so many steps of work and no more. What was
found before the shift can be given to it to read; beyond that it remembers within one search alone,
so that nothing depends on what was asked before. Shares nothing with the constraint solver.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from math import inf
from time import thread_time
from types import MappingProxyType
from typing import NamedTuple

from tandem.dispatch.lookahead.transitions import Moves, Position
from tandem.dispatch.lookahead.work import Work
from tandem.files.generators import layered

A_SET = 0.1
"""Steps that putting together one set of ways takes, before it is made a position."""
SLOWEST, QUICKEST = 5.0, 200.0
"""Steps that a millisecond buys: what is measured is kept between these, for a machine that is
slower is busy, not slow.
"""
CAUTION = 0.5
"""Of what is measured in peace so much is counted on: beside a floor there is other work."""


class Known(NamedTuple):
    """What is known of positions: `values` is the least cost still to come, `bounds` lie below
    it.
    """

    values: Mapping[Position, float] = MappingProxyType({})
    bounds: Mapping[Position, float] = MappingProxyType({})


NOTHING = Known()


@dataclass
class BranchAndBound:
    """The search in one cell, under one belief about paces.

    Attributes:
      moves: the cell's moves, with the paces in them.
      weights: cost per tick and per unit of stress.
      work: what may be done, and is counted.
      before: what was known before; never changed.
      known: position -> least cost still to come. `low`: position -> a bound below it.
    """

    moves: Moves
    weights: tuple[float, float]
    work: Work = field(default_factory=Work)
    before: Known = NOTHING
    known: dict[Position, float] = field(default_factory=dict)
    low: dict[Position, float] = field(default_factory=dict)

    def value(self, position: Position, cutoff: float = inf) -> float:
        """The least cost from here; when that is not below the cutoff, a bound below it that is not
        below the cutoff either.

        Infinite when limits leave no way to get it done. Raises OutOfWorkError.
        """
        moves = self.moves
        if moves.is_over(position):
            return 0.0
        known = self.known.get(position)
        if known is None:
            known = self.before.values.get(position)
        if known is not None:
            return known
        low = self.low.get(position)
        if low is None:
            low = self.before.bounds.get(position)
        if low is None:
            low = self.floor(position)
        if low >= cutoff:
            return low
        steps = sorted(self.steps(position), key=lambda step: step[0])
        best = inf
        for bound, paid, _, after in steps:
            limit = min(best, cutoff)
            if bound >= limit:
                best = min(best, bound)
                break
            best = min(best, paid + self.value(after, limit - paid))
        (self.known if best < cutoff or best == inf else self.low)[position] = best
        return best

    def steps(self, position: Position) -> Iterable[tuple[float, float, tuple[int, ...], Position]]:
        """(bound, cost until the next event, ways begun now, position then) of everything that can
        be begun together now.
        """
        legal = self.moves.legal(position) if self.moves.plain and not self.weights[1] else []
        spend = self.work.spend
        for chosen in self.moves.choices(position, look=self.look):
            spend()
            found = self.step(position, chosen)
            if found is not None and not (legal and self._wastes(legal, chosen, found[1])):
                yield found

    def _wastes(self, legal: Sequence[int], chosen: Sequence[int], paid: float) -> bool:
        """Somebody waits who could have done a task that nobody begins, and be free again by the
        next event: then doing it is no worse.
        """
        moves, most = self.moves, paid / self.weights[0] + 0.5
        who = task = 0
        for way in chosen:
            who |= moves.who[way]
            task |= 1 << moves.task[way]
        return any(
            moves.ticks[way] <= most
            and not moves.who[way] & who
            and not task >> moves.task[way] & 1
            for way in legal
            if way < moves.count
        )

    def step(
        self, position: Position, chosen: tuple[int, ...]
    ) -> tuple[float, float, tuple[int, ...], Position] | None:
        """One of `steps`; None when nothing would ever happen then."""
        after, units = position, 0
        for way in chosen:
            after, units = self.moves.begin(after, way), units + self.moves.units[way]
        ticks = self.moves.next_event(after)
        if ticks is None:
            return None
        paid = self.weights[0] * ticks + self.weights[1] * units
        after = self.moves.after(after, ticks)
        return paid + self.floor(after), paid, chosen, after

    def floor(self, position: Position) -> float:
        """A bound that needs no search."""
        ticks, units = self.moves.floor(position)
        return self.weights[0] * ticks + self.weights[1] * units

    def best(self, position: Position) -> tuple[tuple[int, ...], float]:
        """What to begin now, and the least cost. Raises OutOfWorkError."""
        least = inf
        choice: tuple[int, ...] = ()
        for bound, paid, chosen, after in sorted(self.steps(position), key=lambda step: step[0]):
            if bound >= least:
                break
            value = paid + self.value(after, least - paid)
            if value < least:
                least, choice = value, chosen
        return choice, least

    def look(self, sets: int) -> None:
        """Counts so many sets of ways that were put together. Raises OutOfWorkError."""
        self.work.spend(A_SET * sets)

    def learned(self) -> Known:
        """What this search has found out, for others to begin with."""
        return Known(self.known, self.low)


def measured() -> float:
    """Steps that a millisecond buys here: the best of a few runs over a cell made up for it, by
    this thread's own time on a core. Takes about a tenth of a second.
    """
    moves = Moves.of(layered(9, seed=0))
    quickest = inf
    for _ in range(8):
        search = BranchAndBound(moves, (1.0, 0.0))
        began = thread_time()
        search.value(moves.root())
        spent = 1000 * (thread_time() - began)
        if spent > 0:
            quickest = min(quickest, spent / search.work.done)
    return round(min(max(CAUTION / quickest, SLOWEST), QUICKEST), 1)
