"""The exact plan for the stated times, carried out: who does what in which order stays, only the
clock gives way.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from time import perf_counter

from tandem.cell.model import Cell
from tandem.dispatch.deciders.beliefs import Models, numbered, position
from tandem.dispatch.deciders.policy import Basis, Decision, Options, Start
from tandem.dispatch.deciders.reply import reply
from tandem.dispatch.lookahead.objective import Objective
from tandem.dispatch.lookahead.transitions import Moves
from tandem.dispatch.situation.legal import legal, next_change
from tandem.dispatch.situation.model import Situation
from tandem.dispatch.situation.transitions import beginning
from tandem.plan.methods import plan
from tandem.plan.result import Result

PLANNING_S = 20.0
"""The plan is made once, before the shift, and takes until it is proven; so many seconds at the
most.
"""


def fixed(cell: Cell, objective: Objective, options: Options) -> Fixed:
    """Plans the cell as `tandem plan` does, once. One thread: a plan that is proven in time
    repeats.

    Raises:
      CellError: as `Moves.of` does.
      InfeasibleError: no plan keeps the limits and deadlines.
      NothingFoundError: none was found within `PLANNING_S`.
    """
    models = Models(cell, objective.max_stress)
    models.of(Situation.of(cell), 1.0)
    best = plan(cell, objective.question(), time_limit=PLANNING_S, seed=options.seed, workers=1)[0]
    order = tuple((one.task, one.operators) for one in best.schedule)
    return Fixed(models, order, _basis(best, objective))


def _basis(best: Result, objective: Objective) -> Basis:
    return Basis(
        best.makespan,
        best.stress,
        objective.is_proven(best),
        best.bound.makespan,
        best.bound.stress,
    )


@dataclass(frozen=True)
class Fixed:
    """A fixed plan, carried out as soon as it can be.

    A task waits until every task planned before it that wants one of its operators, its tool or its
    zone has begun. So, while times are as stated and people do as they are asked, each task
    begins no later than planned: by induction over the plan, what it needs is free by then.

    Attributes:
      order: the tasks with their operators, in order of their planned starts.
      basis: what the plan comes to.
    """

    models: Models
    order: tuple[Start, ...]
    basis: Basis
    name: str = "fixed"

    def decide(self, situation: Situation) -> Decision:
        """Each operator's next task of the plan, as soon as it may begin."""
        began = perf_counter()
        moves = self.models.of(situation, 1.0)
        begins, because = self._due(moves, situation), "the next in the fixed plan"
        if not begins and _stands_still(situation):
            begins, because = (
                self._anything(situation),
                "what the fixed plan leads to cannot begin, and nothing else would",
            )
        choice = numbered(moves, situation, begins)
        return reply(
            self.name,
            moves,
            situation,
            position(moves, situation, {}),
            choice,
            [(choice, None)],
            began=began,
            because=because,
        )

    def _due(self, moves: Moves, situation: Situation) -> list[Start]:
        """What is next for all that it needs, and may begin now; wrong work comes off first, last
        in the plan first.
        """
        order = [start for start in self.order if start[0] in situation.open]
        comes_off = [start for start in reversed(order) if start[0] in situation.wrong]
        begins: list[Start] = []
        awaited: set[Need] = set()
        for task, planned in [*comes_off, *(start for start in order if start not in comes_off)]:
            start = (task, _willing(situation, task, planned))
            needs = set(_needs(moves, *start))
            if not needs & awaited and beginning(situation, [*begins, start]) == [*begins, start]:
                begins.append(start)
            else:
                awaited |= needs
        return begins

    def _anything(self, situation: Situation) -> list[Start]:
        """The first of the plan's tasks that may begin at all, as planned or else."""
        may = legal(situation)
        return [start for task, _ in self.order for start in may if start[0] == task][:1]


Need = tuple[str, str | int]
"""Something that one task at a time, or only so many, can have: an operator by name, a tool or a
zone by number.
"""


def _willing(situation: Situation, task: str, planned: tuple[str, ...]) -> tuple[str, ...]:
    """Who is planned; where somebody of them refuses, the quickest others who can, if there are
    any.
    """

    def refuses(operators: tuple[str, ...]) -> bool:
        return any(situation.is_refused(who, task) for who in operators)

    if not refuses(planned):
        return planned
    others = [way for way in situation.facts.ways[task] if not refuses(way.operators)]
    return min(others, key=lambda way: way.time).operators if others else planned


def _needs(moves: Moves, task: str, operators: tuple[str, ...]) -> Iterator[Need]:
    """Its operators, and its tool and zone where these have fewer places than there are
    operators.
    """
    yield from (("operator", who) for who in operators)
    number, instance = moves.instance.tasks.index(task), moves.instance
    tool, zone = instance.tool[number], instance.zone[number]
    if tool is not None and moves.instance.tool_room[tool]:
        yield "tool", tool
    if zone is not None and moves.instance.zone_room[zone]:
        yield "zone", zone


def _stands_still(situation: Situation) -> bool:
    """Nothing is under way or to come, not even the return of somebody: people have done what the
    plan did not foresee.
    """
    return (
        not situation.running
        and not situation.absent
        and not situation.failed
        and next_change(situation) is None
    )
