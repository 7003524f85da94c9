"""`expected` and `minimax`: the exact value functions of small cells as deciders. What has been
valued once is looked up.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from time import perf_counter

from tandem.cell.model import Cell
from tandem.dispatch.deciders.beliefs import Models, allowed, cost_so_far, position
from tandem.dispatch.deciders.policy import Decision, Options
from tandem.dispatch.deciders.reply import reply
from tandem.dispatch.lookahead.dynamic_programming import Human, Values, values
from tandem.dispatch.lookahead.mistakes import repair_values
from tandem.dispatch.lookahead.objective import SECONDS, Objective
from tandem.dispatch.lookahead.transitions import Moves, Position
from tandem.dispatch.situation.model import Situation
from tandem.errors import NothingFoundError, UsageError

TIES = 1e-6
"""Where time alone counts, a unit of stress weighs so many seconds: of equally quick choices the
easiest is taken.
"""
MOST_TASKS = 14
"""Cells with more tasks are refused at once: their values would take minutes."""


def expected(cell: Cell, objective: Objective, options: Options) -> Table:
    """Beside a human who picks any legal task with probability `options.random`, and else does what
    it is asked; in the stated times.

    Raises:
      CellError: as `exact.values` does.
      UsageError: the cell is too large.
    """
    return _table("expected", cell, Human(options.random), objective)


def minimax(cell: Cell, objective: Objective, options: Options) -> Table:
    """Beside a human who does, of all that is legal, what costs most. Raises as `expected` does."""
    return _table("minimax", cell, Human(spoils=True), objective)


def repairing(cell: Cell, forgets: float, *, taking_apart: float = 1.0) -> Table:
    """The optimal decider beside a compliant human who errs, as value iteration has it. For small
    cells.
    """
    found = repair_values(cell, forgets, taking_apart=taking_apart)
    found.prepare(found.moves.root())
    return Table("repairing", Models(cell), found, SECONDS)


def _table(name: str, cell: Cell, human: Human, objective: Objective) -> Table:
    if len(cell.tasks) > MOST_TASKS:
        raise UsageError(
            f"{name}: exact values are for cells of at most {MOST_TASKS} tasks, this one has"
            f" {len(cell.tasks)}; take replan-robust."
        )
    found = values(cell, human, objective)
    if not objective.stress:
        found.weights = (found.weights[0], TIES / found.moves.instance.per_stress)
    try:
        found.value(found.moves.root())
    except NothingFoundError as error:
        raise UsageError(f"{name}: {error}") from error
    return Table(name, Models(cell), found, objective)


STATED = 1.0
"""Everybody needs the stated times: a table knows no other."""


@dataclass
class Table:
    """A value function as a decider."""

    name: str
    models: Models
    values: Values
    objective: Objective
    _by_moves: dict[int, Values] = field(default_factory=dict)

    def decide(self, situation: Situation) -> Decision:
        """What is best now by the table. Positions that it has not met, because a time was not as
        stated, are valued when they come.
        """
        began = perf_counter()
        moves = self.models.of(situation, STATED)
        here = position(moves, situation, dict.fromkeys(situation.cell.humans, STATED))
        found = self.values if moves.ways == self.values.moves.ways else self._with(moves)
        found.prepare(here)
        choice, ranked = best(found, here, allowed(moves, situation))
        base = cost_so_far(self.objective, situation)
        ground = "whatever the human does" if found.human.spoils else "on average"
        because = f"the least cost {ground}, {self.objective.words(base + ranked[0][1])}"
        return reply(
            self.name,
            moves,
            situation,
            here,
            choice,
            [(ways, base + cost) for ways, cost in ranked],
            began=began,
            because=because,
        )

    def _with(self, moves: Moves) -> Values:
        """The same values where somebody refuses something."""
        if id(moves) not in self._by_moves:
            self._by_moves[id(moves)] = replace(self.values, moves=moves, known={})
        return self._by_moves[id(moves)]


def best(
    found: Values, here: Position, may: frozenset[int]
) -> tuple[tuple[int, ...], list[tuple[tuple[int, ...], float]]]:
    """The best choice among the allowed ways, humans asked first and then the robots.

    With it, what the humans can be asked for, or else what the robots can begin, with the values.
    """
    asked: list[int] = []
    ranked: list[tuple[tuple[int, ...], float]] = []
    moves, after = found.moves, here
    for turn, operator in enumerate(found.humans):
        legal = (
            []
            if moves.busy(after) >> operator & 1
            else [way for way in moves.legal(after, 1 << operator) if way in may]
        )
        if not legal:
            continue
        # a human who follows the advice takes the best; one who spoils it is reckoned with at each
        # task
        wishes = (
            found.wishes(after, turn, legal)
            if not found.human.spoils
            else [(way, found.if_human(after, turn, way)) for way in legal]
        )
        way, _ = min(wishes, key=lambda wish: wish[1])
        # alternatives are those of the first decision: later ones depend on it
        ranked = ranked or _sorted(
            [(() if one is None else (one,), value) for one, value in wishes]
        )
        if way is not None:
            after = moves.begin(after, way)
            asked.append(way)
    # the robots choose knowing what the humans have been asked for
    options = _sorted(
        [(ways, value) for ways, value in found.robot_choices(after) if may.issuperset(ways)]
    )
    return (*asked, *options[0][0]), ranked or options


def _sorted(rows: Sequence[tuple[tuple[int, ...], float]]) -> list[tuple[tuple[int, ...], float]]:
    return sorted(rows, key=lambda row: row[1])
