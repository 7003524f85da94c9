"""Exact values of small cells by dynamic programming: the best that a decider can reach beside a human as modelled, times certain.

The decider controls the robots and asks the humans. Whenever something has happened, idle humans move first, in the cell's order, each
seeing those before; then the idle robots; then time runs to the next event. (Were the robots to move first, a human who picks at
random would cost nothing on the thesis's cell, for the robot could leave it nothing to pick wrongly.)

Values are the cost still to come, `weights[0]` per tick and `weights[1]` per unit of stress; positions that lie alike before the decider
have one value. Times are certain here: what scatters is left to simulation.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import inf

from tandem.cell.model import Cell
from tandem.dispatch.moves import Moves, Position
from tandem.dispatch.policy import Objective
from tandem.errors import CellError, Fault, NothingFoundError

MOST_POSITIONS = 400_000
"""So many positions are valued before the cell is called too large: about half a minute and 300 MiB."""

Picks = Callable[[Moves, Position, int, Sequence[int]], list[tuple[float, int]]]
"""`(moves, position, human, legal ways) -> (probability, way)` of the ways that the human picks by itself; what is left to 1, it complies."""


@dataclass(frozen=True)
class Human:
    """How a human decides, as the exact methods model it.

    Attributes:
      random: the share of decisions in which any legal way is picked, each as likely as the others; never waiting.
      prefers: tasks, the dearest first: of the legal ones always the first in this list is picked; a task that is not in it is done when asked.
      spoils: does, of all that is legal, what costs most; random and preference play no part then.
    """

    random: float = 0.0
    prefers: tuple[str, ...] = ()
    spoils: bool = False

    def picks(self, moves: Moves, legal: Sequence[int]) -> list[tuple[float, int]]:
        """(probability, way) of what is picked unasked; nothing when nothing is legal."""
        if not legal:
            return []
        shares = [(self.random / len(legal), way) for way in legal] if self.random else []
        rank = {task: place for place, task in enumerate(self.prefers)}
        liked = [(rank[name], way) for way in legal if (name := moves.instance.tasks[moves.task[way]]) in rank]
        if liked:
            shares.append((1.0 - self.random, min(liked)[1]))
        return shares


COMPLIANT = Human()


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
        """Cost still to come when everybody idle may decide now; infinite when the decider cannot get it done.

        Raises NothingFoundError when the cell is too large.
        """
        if position.done & self.moves.full == self.moves.full:
            return 0.0
        known = self.known.get(position)
        if known is None:
            if len(self.known) >= self.most:
                raise NothingFoundError(f"exact values: more than {self.most:,} positions; take a smaller cell, or `replan-robust`.")
            known = self.known[position] = self.of_human(position, 0)
        return known

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
        by_way = {way: self.if_human(position, turn, way) for way in legal}
        wait = self.of_human(position, turn + 1)
        if self.human.spoils:
            return max([*by_way.values(), *([wait] if wait < inf else [])])
        picks = self.human.picks(moves, legal)
        obeys = 1.0 - sum(share for share, _ in picks)
        value = sum(share * by_way[way] for share, way in picks)
        return value + obeys * min(wait, *by_way.values()) if obeys > 1e-12 else value

    def if_human(self, position: Position, turn: int, way: int) -> float:
        """The value when the human of that turn begins this way."""
        return self.weights[1] * self.moves.units[way] + self.of_human(self.moves.begin(position, way), turn + 1)

    def of_robots(self, position: Position) -> float:
        """The value when the humans have moved and the robots are to."""
        return min((value for _, value in self.robot_choices(position)), default=inf)

    def robot_choices(self, position: Position) -> Iterator[tuple[tuple[int, ...], float]]:
        """Every set of ways that the robots can begin now, with its value."""
        moves = self.moves
        for chosen in moves.choices(position, moves.everybody & ~moves.human):
            after, units = position, 0
            for way in chosen:
                after, units = moves.begin(after, way), units + moves.units[way]
            yield chosen, self.weights[1] * units + self.run(after)

    def run(self, position: Position) -> float:
        """The value when everybody has decided and time runs on; infinite when nothing would ever happen."""
        ticks = self.moves.next_event(position)
        return inf if ticks is None else self.weights[0] * ticks + self.value(self.moves.after(position, ticks))

    def wishes(self, position: Position, turn: int) -> list[tuple[int | None, float]]:
        """What can be asked of the human of that turn (None: wait), each with its value, best first; equal ones as the ways are numbered."""
        legal = self.moves.legal(position, 1 << self.humans[turn])
        options: list[tuple[int | None, float]] = [(way, self.if_human(position, turn, way)) for way in legal]
        options.append((None, self.of_human(position, turn + 1)))
        return sorted(options, key=lambda option: option[1])

    @property
    def humans(self) -> list[int]:
        """The humans' numbers, in the order in which they move."""
        found = self.__dict__.get("_humans")
        if found is None:
            found = self.__dict__["_humans"] = [o for o, human in enumerate(self.moves.instance.human) if human]
        return found


def values(
    cell: Cell, human: Human = COMPLIANT, objective: Objective = Objective(), *, pace: Mapping[str, float] | None = None, most: int = MOST_POSITIONS
) -> Values:
    """The value function of the cell; nothing is reckoned before it is asked.

    Raises CellError when a feature of the cell cannot be valued exactly: a table of stress, changeovers (their moment depends on what was idle),
    or a limit on stress in the objective.
    """
    if objective.max_stress is not None:
        raise CellError([Fault("exact values know weights of stress and each operator's own stress_limit; a limit over all humans needs `replan`.")])
    moves = Moves.of(cell, pace)
    if moves.swaps:
        raise CellError([Fault("exact values cannot hold changeovers of tools; take them out, or decide by `replan`.", ("tools",))])
    return Values(moves, human, weights(moves, objective), most)


def weights(moves: Moves, objective: Objective) -> tuple[float, float]:
    """The objective's weights per tick and per unit of stress, scaled so that a cost is in seconds where time alone counts."""
    return objective.time / moves.per_second, objective.stress / moves.instance.per_stress


def expected(cell: Cell, *, random: float = 0.0, objective: Objective = Objective(), pace: Mapping[str, float] | None = None) -> float:
    """The least expected cost (seconds, when only time counts) beside humans who pick at random with probability `random`, and else comply."""
    found = values(cell, Human(random), objective, pace=pace)
    return found.value(found.moves.root())


def minimax(cell: Cell, *, objective: Objective = Objective(), pace: Mapping[str, float] | None = None) -> float:
    """The least cost that no human can spoil, as long as it keeps doing what is legal: it may pick any legal way, or wait while somebody works."""
    found = values(cell, Human(spoils=True), objective, pace=pace)
    return found.value(found.moves.root())
