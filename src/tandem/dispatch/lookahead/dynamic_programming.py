"""Exact values of small cells by dynamic programming: the best that a decider can reach beside a
human as modelled, times certain.

The decider controls the robots and asks the humans. Whenever something has happened, idle humans
move first, in the cell's order, each seeing those before; then the idle robots; then time runs to
the next event. (Were the robots to move first, a human who picks at random would cost nothing on
the thesis's cell, for the robot could leave it nothing to pick wrongly.)

Values are the cost still to come, `weights[0]` per tick and `weights[1]` per unit of stress;
positions that lie alike before the decider have one value. Times are certain here: what scatters is
left to simulation.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import inf

from tandem.cell.model import Cell
from tandem.dispatch.lookahead.objective import SECONDS, Objective
from tandem.dispatch.lookahead.transitions import Moves, Position
from tandem.errors import CellError, Fault, NothingFoundError

MOST_POSITIONS = 400_000
"""So many positions are valued before the cell is called too large: about half a minute and 300
MiB.
"""

Answers = list[tuple[float, int | None]]
"""What a human may do, each with its probability: a way, or None for waiting."""

SLIGHTLY = 1e-4
"""Between two ways that a human likes the same, what was asked decides."""


@dataclass(frozen=True)
class Human:
    """How a human decides, as the exact methods model it: the persons of `tandem.world.people` that
    change nothing about themselves.

    Attributes:
      random: the share of decisions in which any legal task is picked, each as likely as the
        others; never waiting.
      taste: per way, how much it is liked; empty for a human who likes all the same. Unless at
        random, the legal way liked most is taken.
      follows: what being asked for a way is worth, on the same scale.
      obeys: waits when asked to; else takes the legal way liked most.
      postpones: the share of requests that are put off: nothing until the next event.
      spoils: does, of all that is legal, what costs most; nothing else counts then.
    """

    random: float = 0.0
    taste: tuple[float, ...] = ()
    follows: float = 1.0
    obeys: bool = True
    postpones: float = 0.0
    spoils: bool = False

    def answers(
        self, moves: Moves, legal: Sequence[int], asked: int | None, can_wait: bool
    ) -> Answers:
        """What follows from asking for a legal way, or for waiting (None). `legal` is not empty."""
        shares: dict[int | None, float] = {}
        if self.random:
            tasks = [moves.task[way] for way in legal]
            for way, task in zip(legal, tasks, strict=True):
                shares[way] = self.random / len(set(tasks)) / tasks.count(task)
        sober = 1.0 - self.random
        if sober > 0:
            taste = self.taste or (0.0,) * moves.count
            own = max(
                legal,
                key=lambda way: (
                    taste[way % moves.count] + (self.follows + SLIGHTLY) * (way == asked),
                    -way,
                ),
            )
            rests = (
                0.0 if not can_wait else self.postpones if asked is not None else float(self.obeys)
            )
            for choice, share in ((None, sober * rests), (own, sober * (1.0 - rests))):
                if share > 0:
                    shares[choice] = shares.get(choice, 0.0) + share
        return [(share, choice) for choice, share in shares.items()]


COMPLIANT = Human()


def may_wait(moves: Moves, position: Position, operator: int) -> bool:
    """Whether the operator may let its turn pass: something is still to happen, or another one can
    begin something without it.
    """
    return moves.next_event(position) is not None or any(
        not moves.who[way] >> operator & 1 for way in moves.legal(position)
    )


@dataclass
class Values:
    """The value function of one cell beside one kind of human, filled as it is asked.

    Attributes:
      moves: the cell's moves, with the humans' paces in them.
      human: how each human decides.
      weights: cost per tick and per unit of stress.
      known: position (a moment at which all idle humans are about to move) -> cost still to come.
    """

    moves: Moves
    human: Human = COMPLIANT
    weights: tuple[float, float] = (1.0, 0.0)
    most: int = MOST_POSITIONS
    known: dict[Position, float] = field(default_factory=dict)

    def value(self, position: Position) -> float:
        """Cost still to come when everybody idle may decide now; infinite when the decider cannot
        get it done.

        Raises NothingFoundError when the cell is too large.
        """
        if self.moves.is_over(position):
            return 0.0
        known = self.known.get(position)
        if known is None:
            if len(self.known) >= self.most:
                raise NothingFoundError(
                    f"exact values: more than {self.most:,} positions; take a smaller cell, or"
                    " `replan-robust`."
                )
            known = self.known[position] = self.of_human(position, 0)
        return known

    def prepare(self, position: Position) -> None:
        """Makes sure that `value` is right for the position and what follows from it; here it is so
        without.
        """

    def of_human(self, position: Position, turn: int) -> float:
        """The same when the humans from number `turn` on are still to move, and then the robots."""
        moves = self.moves
        while turn < len(self.humans) and moves.busy(position) >> self.humans[turn] & 1:
            turn += 1
        if turn == len(self.humans):
            return self.of_robots(position)
        legal = moves.legal(position, 1 << self.humans[turn])
        if not legal:
            return self.of_human(position, turn + 1)
        if self.human.spoils:
            wait = self.of_human(position, turn + 1)
            return max(
                [self.if_human(position, turn, way) for way in legal]
                + ([wait] if wait < inf else [])
            )
        return min(value for _, value in self.wishes(position, turn, legal))

    def wishes(
        self, position: Position, turn: int, legal: Sequence[int]
    ) -> list[tuple[int | None, float]]:
        """What can be asked of the human of that turn (a legal way, or None for waiting), each with
        the value that it comes to.
        """
        can_wait = may_wait(self.moves, position, self.humans[turn])
        by_choice: dict[int | None, float] = {
            way: self.if_human(position, turn, way) for way in legal
        }
        by_choice[None] = self.of_human(position, turn + 1) if can_wait else inf
        found: list[tuple[int | None, float]] = []
        for asked in [*legal, None] if can_wait else legal:
            answers = self.human.answers(self.moves, legal, asked, can_wait)
            found.append((asked, sum(share * by_choice[choice] for share, choice in answers)))
        return found

    def if_human(self, position: Position, turn: int, way: int) -> float:
        """The value when the human of that turn begins this way."""
        return self.weights[1] * self.moves.units[way] + self.of_human(
            self.moves.begin(position, way), turn + 1
        )

    def of_robots(self, position: Position) -> float:
        """The value when the humans have moved and the robots are to."""
        return min((value for _, value in self.robot_choices(position)), default=inf)

    def robot_choices(self, position: Position) -> Iterator[tuple[tuple[int, ...], float]]:
        """Every set of ways that the robots can begin now, with its value."""
        moves = self.moves
        for chosen in moves.choices(position, moves.instance.everybody & ~moves.instance.humans):
            after, units = position, 0
            for way in chosen:
                after, units = moves.begin(after, way), units + moves.units[way]
            yield chosen, self.weights[1] * units + self.run(after)

    def run(self, position: Position) -> float:
        """The value when everybody has decided and time runs on; infinite when nothing would ever
        happen.
        """
        ticks = self.moves.next_event(position)
        return (
            inf
            if ticks is None
            else self.weights[0] * ticks + self.value(self.moves.after(position, ticks))
        )

    @cached_property
    def humans(self) -> list[int]:
        """The humans' numbers, in the order in which they move."""
        return [o for o, human in enumerate(self.moves.instance.human) if human]


def values(
    cell: Cell,
    human: Human = COMPLIANT,
    objective: Objective = SECONDS,
    *,
    pace: Mapping[str, float] | None = None,
    most: int = MOST_POSITIONS,
) -> Values:
    """The value function of the cell; nothing is reckoned before it is asked.

    Raises CellError when a feature of the cell cannot be valued exactly: a table of stress,
    changeovers and walking (their moment depends on what was idle), or a limit on stress in the
    objective.
    """
    if objective.max_stress is not None:
        raise CellError(
            [
                Fault(
                    "exact values know weights of stress and each operator's own stress_limit; a"
                    " limit over all humans needs `replan`."
                )
            ]
        )
    moves = Moves.of(cell, pace)
    if moves.instance.has_preparations:
        raise CellError(
            [
                Fault(
                    f"exact values cannot hold {what}; take them out, or decide by `replan`.",
                    (key,),
                )
                for has, what, key in (
                    (moves.instance.has_swaps, "changeovers of tools", "tools"),
                    (any(moves.instance.walks), "ways to walk between places", "walk"),
                )
                if has
            ]
        )
    return Values(moves, human, weights(moves, objective), most)


def weights(moves: Moves, objective: Objective) -> tuple[float, float]:
    """The objective's weights per tick and per unit of stress, scaled so that a cost is in seconds
    where time alone counts.
    """
    return objective.time / moves.instance.per_second, objective.stress / moves.instance.per_stress


def expected(
    cell: Cell,
    *,
    random: float = 0.0,
    objective: Objective = SECONDS,
    pace: Mapping[str, float] | None = None,
) -> float:
    """The least expected cost (seconds, when only time counts) beside humans who pick at random
    with probability `random`, and else comply.
    """
    found = values(cell, Human(random), objective, pace=pace)
    return found.value(found.moves.root())


def minimax(
    cell: Cell, *, objective: Objective = SECONDS, pace: Mapping[str, float] | None = None
) -> float:
    """The least cost that no human can spoil, as long as it keeps doing what is legal: it may pick
    any legal way, or wait while somebody works.
    """
    found = values(cell, Human(spoils=True), objective, pace=pace)
    return found.value(found.moves.root())
