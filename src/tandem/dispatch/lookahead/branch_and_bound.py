"""The least cost of what is left, when everybody does what is planned and times are as believed:
branch and bound over positions.

Depth first, the most promising continuation first. What has been valued stays known, so that a
shift's later decisions, and the next shift's, find most of it. Shares nothing with the constraint
solver.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from math import inf
from time import perf_counter

from tandem.dispatch.lookahead.transitions import Moves, Position
from tandem.errors import TandemError

MOST_KNOWN = 50_000
"""So many positions are remembered; beyond, the memory begins anew. Forgetting more at once takes
longer than a decision may.
"""
EVERY = 8
"""The clock is looked at whenever so many positions were made: about a third of a millisecond."""


class OutOfTimeError(TandemError):
    """The search has not ended in time; what it knows stays known."""


@dataclass
class BranchAndBound:
    """The search in one cell, under one belief about paces.

    Attributes:
      moves: the cell's moves, with the paces in them.
      weights: cost per tick and per unit of stress.
      known: position -> least cost still to come. `low`: position -> a bound below it.
      until: the moment by `clock` at which the search gives up.
    """

    moves: Moves
    weights: tuple[float, float]
    known: dict[Position, float] = field(default_factory=dict)
    low: dict[Position, float] = field(default_factory=dict)
    until: float = inf
    clock: Callable[[], float] = perf_counter
    _made: int = 0

    def value(self, position: Position, cutoff: float = inf) -> float:
        """The least cost from here; when that is not below the cutoff, a bound below it that is not
        below the cutoff either.

        Infinite when limits leave no way to get it done. Raises OutOfTimeError.
        """
        moves = self.moves
        if moves.is_over(position):
            return 0.0
        known = self.known.get(position)
        if known is not None:
            return known
        low = self.low.get(position)
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
        for chosen in self.moves.choices(position, look=self.look):
            self._look_at_times()
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
        """What to begin now, and the least cost. Raises OutOfTimeError."""
        least = inf
        choice: tuple[int, ...] = ()
        for bound, paid, chosen, after in sorted(self.steps(position), key=lambda step: step[0]):
            if bound >= least:
                break
            value = paid + self.value(after, least - paid)
            if value < least:
                least, choice = value, chosen
        return choice, least

    def by(self, until: float) -> BranchAndBound:
        """The same search, which gives up at this moment of its clock."""
        self.until = until
        if len(self.known) + len(self.low) > MOST_KNOWN:
            self.known.clear()
            self.low.clear()
        return self

    def look(self) -> None:
        """Raises OutOfTimeError when the time is over."""
        if self.clock() > self.until:
            raise OutOfTimeError("the search has not ended in time.")

    def _look_at_times(self) -> None:
        self._made += 1
        if self._made % EVERY == 0:
            self.look()
