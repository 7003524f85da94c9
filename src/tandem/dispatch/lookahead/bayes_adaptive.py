"""The exact Bayes-adaptive value: the best that a decider can reach who knows the humans' pace only
as a prior, and learns it by watching.

What has been seen rules hypotheses out: times are certain, so a task that ends tells the pace, and
one that is still going on rules out every pace at which it would be over. The value weighs what a
choice brings now against what it tells (Duff 2002, chapter 1: a decision process over positions and
beliefs).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import inf

from tandem.cell.model import Cell
from tandem.dispatch.lookahead.dynamic_programming import (
    COMPLIANT,
    MOST_POSITIONS,
    Human,
    Values,
    may_wait,
    values,
)
from tandem.dispatch.lookahead.objective import SECONDS, Objective
from tandem.dispatch.lookahead.transitions import Moves, Position
from tandem.errors import NothingFoundError

Belief = tuple[tuple[int, Position], ...]
"""The hypotheses that are left, each with the position as it would be under it. All look alike from
outside: the same tasks have ended and are being done; only how much is left of them differs.
"""


@dataclass
class BeliefValues:
    """The value function over beliefs, filled as it is asked.

    Attributes:
      under: per hypothesis, the values for who knows that it holds.
      prior: per hypothesis, its probability.
      watches: the decider may also act at a moment at which a human could have finished and has
        not; else only when something happens.
    """

    under: tuple[Values, ...]
    prior: tuple[float, ...]
    watches: bool = False
    most: int = MOST_POSITIONS
    known: dict[Belief, float] = field(default_factory=dict)

    def root(self) -> Belief:
        """Nothing has begun, every hypothesis with a probability above 0 is open."""
        return tuple(
            (number, values.moves.root())
            for number, values in enumerate(self.under)
            if self.prior[number] > 0
        )

    def value(self, belief: Belief) -> float:
        """Expected cost still to come when everybody idle may decide now.

        Raises NothingFoundError when the cell is too large.
        """
        if len(belief) == 1:
            number, position = belief[0]
            return self.under[number].value(position)
        moves = self.moves
        if moves.is_over(belief[0][1]):
            return 0.0
        known = self.known.get(belief)
        if known is None:
            if len(self.known) >= self.most:
                raise NothingFoundError(
                    f"Bayes-adaptive values: more than {self.most:,} beliefs; take a smaller cell"
                    " or fewer hypotheses."
                )
            known = self.known[belief] = self.of_human(belief, 0)
        return known

    def of_human(self, belief: Belief, turn: int) -> float:
        """The same when the humans from number `turn` on are still to move, and then the robots."""
        model, moves, position = self.under[0], self.moves, belief[0][1]
        while turn < len(model.humans) and moves.busy(position) >> model.humans[turn] & 1:
            turn += 1
        if turn == len(model.humans):
            return min((value for _, value in self.robot_choices(belief)), default=inf)
        legal = moves.legal(position, 1 << model.humans[turn])
        if not legal:
            return self.of_human(belief, turn + 1)
        return min(value for _, value in self.wishes(belief, turn, legal))

    def wishes(
        self, belief: Belief, turn: int, legal: Sequence[int]
    ) -> list[tuple[int | None, float]]:
        """What can be asked of the human of that turn (a legal way, or None for waiting), each with
        the value that it comes to.
        """
        model, moves, position = self.under[0], self.moves, belief[0][1]
        can_wait = may_wait(moves, position, model.humans[turn])
        by_choice: dict[int | None, float] = {
            way: self.if_human(belief, turn, way) for way in legal
        }
        by_choice[None] = self.of_human(belief, turn + 1) if can_wait else inf
        found: list[tuple[int | None, float]] = []
        for asked in [*legal, None] if can_wait else legal:
            answers = model.human.answers(moves, legal, asked, can_wait)
            found.append((asked, sum(share * by_choice[choice] for share, choice in answers)))
        return found

    def if_human(self, belief: Belief, turn: int, way: int) -> float:
        """The value when the human of that turn begins this way."""
        return self.under[0].weights[1] * self.moves.units[way] + self.of_human(
            self.begun(belief, way), turn + 1
        )

    def robot_choices(self, belief: Belief) -> Iterator[tuple[tuple[int, ...], float]]:
        """Every set of ways that the robots can begin now, with its value."""
        moves = self.moves
        for chosen in moves.choices(
            belief[0][1], moves.instance.everybody & ~moves.instance.humans
        ):
            after, units = belief, 0
            for way in chosen:
                after, units = self.begun(after, way), units + moves.units[way]
            yield chosen, self.under[0].weights[1] * units + self.run(after)

    def begun(self, belief: Belief, way: int) -> Belief:
        """The way begins now under every hypothesis."""
        return tuple(
            (number, self.under[number].moves.begin(position, way)) for number, position in belief
        )

    def run(self, belief: Belief) -> float:
        """The value when everybody has decided and time runs on, over what may then be seen."""
        total = sum(self.prior[number] for number, _ in belief)
        value = 0.0
        for ticks, after in self.sights(belief):
            if ticks is None:
                return inf
            share = sum(self.prior[number] for number, _ in after) / total
            value += share * (self.under[0].weights[0] * ticks + self.value(after))
        return value

    def sights(self, belief: Belief) -> list[tuple[int | None, Belief]]:
        """What may be seen next: after how many ticks (None: nothing, ever), and the belief it
        leaves.
        """
        waits = {
            number: self.under[number].moves.next_event(position) for number, position in belief
        }
        if any(ticks is None for ticks in waits.values()):
            return [(None, belief)]
        soonest = min(ticks for ticks in waits.values() if ticks is not None)
        groups: dict[tuple[int, int], list[tuple[int, Position]]] = {}
        for number, position in belief:
            ticks = soonest if self.watches else waits[number]
            after = self.under[number].moves.after(position, ticks)  # type: ignore[arg-type]
            groups.setdefault((ticks, after.done), []).append((number, after))  # type: ignore[arg-type]
        return [(ticks, tuple(group)) for (ticks, _), group in groups.items()]

    def played(self, truth: int) -> float:
        """The cost when the best policy for the prior is carried out beside compliant humans, and
        hypothesis number `truth` is true.
        """
        belief, cost, model = self.root(), 0.0, self.under[0]
        while not self.moves.is_over(belief[0][1]):
            # people take their pick before the robots are told, as on the floor
            for turn, human in enumerate(model.humans):
                here = belief[0][1]
                legal = (
                    [] if self.moves.busy(here) >> human & 1 else self.moves.legal(here, 1 << human)
                )
                if (
                    legal
                    and (way := min(self.wishes(belief, turn, legal), key=lambda wish: wish[1])[0])
                    is not None
                ):
                    belief, cost = (
                        self.begun(belief, way),
                        cost + model.weights[1] * self.moves.units[way],
                    )
            for way in min(self.robot_choices(belief), key=lambda choice: choice[1])[0]:
                belief, cost = (
                    self.begun(belief, way),
                    cost + model.weights[1] * self.moves.units[way],
                )
            # of all that could be seen next, what is seen is what the true hypothesis brings about
            ticks, belief = next(
                (ticks, after)
                for ticks, after in self.sights(belief)
                if any(number == truth for number, _ in after)
            )
            cost += model.weights[0] * (ticks or 0)
        return cost

    @property
    def moves(self) -> Moves:
        """Of the first hypothesis: what is legal is the same under all."""
        return self.under[0].moves


def belief_values(
    cell: Cell,
    prior: Mapping[float, float],
    human: Human = COMPLIANT,
    objective: Objective = SECONDS,
    *,
    watches: bool = False,
) -> BeliefValues:
    """The values of the cell when all its humans need an unknown factor times the stated time,
    `prior`: factor -> probability.

    Raises CellError as `exact.values` does; cells with releases or breaks are held, but a release
    or break is an event under every hypothesis.
    """
    total = sum(prior.values())
    under = tuple(
        values(cell, human, objective, pace=dict.fromkeys(cell.humans, factor)) for factor in prior
    )
    return BeliefValues(under, tuple(share / total for share in prior.values()), watches)


def bayes_adaptive(
    cell: Cell,
    prior: Mapping[float, float],
    *,
    objective: Objective = SECONDS,
    watches: bool = False,
) -> float:
    """The least expected cost (seconds, when only time counts) beside compliant humans of unknown
    pace.
    """
    found = belief_values(cell, prior, objective=objective, watches=watches)
    return found.value(found.root())
