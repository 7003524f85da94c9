"""The plan for the stated times, executed robustly: who does what in which order stays, only the clock times give way."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter

from tandem.cell.model import Cell
from tandem.dispatch.deciders.policy import Decision, Options
from tandem.dispatch.deciders.reply import phrase, reply
from tandem.dispatch.deciders.seen import Models, position
from tandem.dispatch.situation.model import Situation
from tandem.dispatch.values.moves import Moves, Position
from tandem.dispatch.values.objective import Objective
from tandem.dispatch.values.rest import rest, solve
from tandem.errors import InfeasibleError

PLANNING_S = 10.0
"""The plan is made once, before the shift; so many seconds at the most."""


def fixed(cell: Cell, objective: Objective, options: Options) -> Fixed:
    """Plans the cell by CP-SAT, once.

    Raises:
      CellError: as `Moves.of` does.
      InfeasibleError: no plan keeps the limits.
    """
    models = Models(cell, objective.max_stress)
    moves = models.of(Situation.of(cell), 1.0)
    left = rest(moves, moves.root())
    weights = (objective.time / moves.per_second, objective.stress / moves.instance.per_stress)
    plan = None if left is None else solve(left, weights, seconds=PLANNING_S, seed=options.seed, ties=True)
    if plan is None:
        raise InfeasibleError("no plan keeps the cell's limits and the objective's.")
    return Fixed(models, tuple(way for _, way in plan.begins))


@dataclass(frozen=True)
class Fixed:
    """A fixed plan: `order` holds its ways in order of start."""

    models: Models
    order: tuple[int, ...]
    name: str = "fixed"

    def decide(self, situation: Situation) -> Decision:
        """Each operator's next task of the plan, as soon as it may begin."""
        began = perf_counter()
        moves = self.models.of(situation, 1.0)
        here = position(moves, situation, {})
        choice = self.choose(moves, here)
        why = f"{phrase(moves, choice)}: the next in the fixed plan."
        return reply(self.name, moves, situation, here, choice, [(choice, None)], began=began, why=why)

    def choose(self, moves: Moves, here: Position) -> tuple[int, ...]:
        """The ways of the plan that are next for all their operators and legal; wrong work first; somebody else's when its operator refuses."""
        begun = moves.begun(here) & ~here.wrong
        blocked = moves.busy(here)
        chosen: list[int] = []
        for planned in self.order:
            task = moves.task[planned]
            if begun >> task & 1:
                continue
            way = planned if planned in moves.ways[task] else min(moves.ways[task], key=lambda other: moves.ticks[other])
            wanted = way + moves.count if here.wrong >> task & 1 else way
            if not moves.who[way] & blocked and wanted in moves.legal(here):
                here = moves.begin(here, wanted)
                chosen.append(wanted)
            blocked |= moves.who[way]
        return tuple(sorted(chosen))
