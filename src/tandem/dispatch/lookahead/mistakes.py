"""Exact values where humans make mistakes: value iteration, for a task that was done wrongly may be
done wrongly again.

A task that a human takes part in goes wrong with a probability, and that is noticed when it ends.
Then it, and what stands on it, is taken apart and done again. Positions can come back, so values
are not found in one pass: they are swept until they no longer change (Bellman 1957; from below, so
that what has no end would grow without bound).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from tandem.cell.model import Cell
from tandem.dispatch.lookahead.dynamic_programming import COMPLIANT, Human, Values, values
from tandem.dispatch.lookahead.objective import SECONDS, Objective
from tandem.dispatch.lookahead.transitions import Moves, Position
from tandem.errors import NothingFoundError

SETTLED = 1e-9
"""Seconds by which no value may change any more."""
SWEEPS = 2_000


@dataclass
class RepairValues(Values):
    """`Values` beside humans whose work goes wrong with probability `forgets`. `value` is right for
    what `prepare` has seen.
    """

    forgets: float = 0.0

    def value(self, position: Position) -> float:
        """The cost still to come, as far as the sweeps have it; a position that is met for the
        first time counts as free until it is swept.
        """
        return 0.0 if self.moves.is_over(position) else self.known.setdefault(position, 0.0)

    def prepare(self, position: Position) -> None:
        """Values the position and all that can follow from it.

        Raises NothingFoundError when there are too many, or the values do not settle: nobody can
        get it done.
        """
        if position in self.known:
            return
        self.value(position)
        for _ in range(SWEEPS):
            before, change = len(self.known), 0.0
            for one in list(self.known)[::-1]:
                found = self.of_human(one, 0)
                change = max(change, abs(found - self.known[one]))
                self.known[one] = found
            if len(self.known) > self.most:
                raise NothingFoundError(
                    f"value iteration: more than {self.most:,} positions; take a smaller cell."
                )
            if len(self.known) == before and change < SETTLED:
                return
        raise NothingFoundError(
            f"value iteration: not settled after {SWEEPS:,} sweeps; is there a way to get it done?"
        )

    def run(self, position: Position) -> float:
        """The value when everybody has decided and time runs on, over what may turn out wrong."""
        ticks = self.moves.next_event(position)
        if ticks is None:
            return float("inf")
        return self.weights[0] * ticks + sum(
            share * self.value(after) for share, after in self.outcomes(position, ticks)
        )

    def outcomes(self, position: Position, ticks: int) -> Iterator[tuple[float, Position]]:
        """(probability, position) of what may be found when so many ticks have passed."""
        moves = self.moves
        ended = [
            way
            for way, left in position.running
            if left <= ticks and way < moves.count and moves.who[way] & moves.instance.humans
        ]
        right = moves.after(position, ticks)
        for wrong in range(1 << len(ended) if self.forgets else 1):
            share, after = 1.0, right
            for index, way in enumerate(ended):
                if wrong >> index & 1:
                    share, after = share * self.forgets, moves.spoiled(after, moves.task[way])
                else:
                    share *= 1 - self.forgets
            yield share, after


def repair_values(
    cell: Cell,
    forgets: float,
    human: Human = COMPLIANT,
    objective: Objective = SECONDS,
    *,
    taking_apart: float = 1.0,
) -> RepairValues:
    """The value function of a small cell whose humans err; raises as `exact.values`."""
    plain = values(cell, human, objective)
    return RepairValues(
        Moves.of(cell, taking_apart=taking_apart), human, plain.weights, plain.most, {}, forgets
    )
