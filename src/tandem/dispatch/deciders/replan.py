"""Planning the rest anew at each event: list schedules, and CP-SAT from the best of them on.
`replan` does it with the stated times and carries out the first plan found; `replan-robust` where
too much is open for the choices to be valued.

The work is counted and no clock is looked at: what is decided follows from the situation and what
was set, now as in a replay, in a new process as in an old one.
"""

from __future__ import annotations

from collections.abc import Sequence, Set
from dataclasses import dataclass
from time import perf_counter
from typing import Protocol

from tandem.cell.model import Cell
from tandem.dispatch.deciders.beliefs import (
    Models,
    allowed,
    cost_so_far,
    position,
    start_by,
)
from tandem.dispatch.deciders.by_rule import ByRule
from tandem.dispatch.deciders.policy import Decision, Options
from tandem.dispatch.deciders.reply import reply
from tandem.dispatch.lookahead.objective import Objective
from tandem.dispatch.lookahead.residual import FIRST, Plan, keeps, rest, resumed, sketch, solve
from tandem.dispatch.lookahead.transitions import Moves, Position
from tandem.dispatch.lookahead.work import Work
from tandem.dispatch.situation.model import Situation

SKETCH, MODEL = 2.0, 12.0
"""Steps that are counted: for each list schedule, for each task; for putting CP-SAT's model
together and taking it up, for each way.
"""
CPSAT_S = 2e-6
"""CP-SAT's deterministic seconds for a step."""
LEAST_S = 0.001
"""With less than so many of them CP-SAT finds nothing, and is not asked."""
DRAFTING, MOST_SKETCHES = 0.05, 60
"""Share of the work for list schedules where CP-SAT searches from the best of them; and the most
that are made.
"""


def plain(cell: Cell, objective: Objective, options: Options) -> Replan:
    """Re-planning by the stated times. Raises CellError as `Moves.of` does."""
    models = models_of(cell, objective)
    return Replan(
        models, objective, options, ByRule("longest-tail", models, objective, options.seed)
    )


class Planner(Protocol):
    """Who plans the rest: what it is called, what it makes small, with how much work, and the rule
    that answers where no plan is found.
    """

    @property
    def name(self) -> str: ...
    @property
    def objective(self) -> Objective: ...
    @property
    def options(self) -> Options: ...
    @property
    def rule(self) -> ByRule: ...


@dataclass(frozen=True)
class Replan:
    """Plans the rest anew at each event, with the stated times; the first plan found is carried
    out.
    """

    models: Models
    objective: Objective
    options: Options
    rule: ByRule
    name: str = "replan"

    def decide(self, situation: Situation) -> Decision:
        """What begins now in the plan."""
        began = perf_counter()
        moves = self.models.of(situation, 1.0)
        here = position(moves, situation, {})
        return by_plan(self, moves, situation, here, Work(self.options.work), began)


def by_plan(
    policy: Planner,
    moves: Moves,
    situation: Situation,
    here: Position,
    work: Work,
    began: float,
    guides: Sequence[Plan] = (),
) -> Decision:
    """The decision of the best plan that the work which is left finds: what is left of the guides,
    list schedules, and CP-SAT from the best of them on where there is work enough for it. The
    rule's where they find none.

    Args:
      began: the `perf_counter` moment at which deciding began.
      guides: plans of the whole cell, made before the shift.
    """
    plan = planned(policy, moves, situation, here, work, guides)
    return told(policy, moves, situation, here, plan, began)


def told(
    policy: Planner,
    moves: Moves,
    situation: Situation,
    here: Position,
    plan: Plan | None,
    began: float,
    found: str = "the best plan found",
) -> Decision:
    """The decision to begin what begins now in the plan; the rule's where there is none, or it
    begins nothing although nothing runs.

    Args:
      found: what the plan is where it is not proven.
    """
    choice = None if plan is None else starting(moves, here, plan, allowed(moves, situation))
    # there is always an answer: the rule's, when no plan is found or it begins nothing
    if plan is None or choice is None:
        choice = policy.rule.choose(moves, here, situation)
        because = "by a rule, because no plan was found"
        return reply(
            policy.name,
            moves,
            situation,
            here,
            choice,
            [(choice, None)],
            began=began,
            because=because,
        )
    # costs are told of the whole assembly, from its beginning
    look = _put_off(moves, here, plan) if moves.instance.has_most_lags else None
    cost = cost_so_far(policy.objective, situation) + _cost(policy.objective, moves, plan)
    end = situation.now + plan.ticks / moves.instance.per_second
    because = f"so that all is done at {end:.4g} s, {'at the earliest' if plan.proven else found}"
    return reply(
        policy.name,
        moves,
        situation,
        here,
        choice,
        [(choice, cost)],
        began=began,
        because=because,
        later=next_tasks(moves, here, plan),
        look_again=None if look is None else situation.now + look / moves.instance.per_second,
    )


def _put_off(moves: Moves, here: Position, plan: Plan) -> int | None:
    """Ticks after which something begins in the plan that could begin now, but that is put off so
    that another task follows it in time; None where nothing is.
    """
    legal = set(moves.legal(here))
    return min((start for start, way in plan.begins if start > 0 and way in legal), default=None)


def planned(
    policy: Planner,
    moves: Moves,
    situation: Situation,
    here: Position,
    work: Work,
    guides: Sequence[Plan] = (),
) -> Plan | None:
    """The best plan that the work finds; it makes one list schedule at least. It keeps what waits
    may last at most where it still can.
    """
    instance = moves.instance
    by = start_by(instance, situation) if instance.has_most_lags else None
    left = rest(moves, here, due=by)
    if left is None:
        return None
    weights, seed = weights_in_ticks(policy.objective, moves), policy.options.seed
    each = SKETCH * len(left.tasks)
    free = work.left - len(guides) * each
    drafting = max(DRAFTING * free, len(FIRST) * each)
    searching_s = CPSAT_S * (free - MODEL * sum(map(len, left.ways)) - drafting)
    searches = searching_s > LEAST_S
    samples = round(min(max((drafting if searches else free) / each, 1), MOST_SKETCHES))
    drafts = [sketch(moves, here, weights, samples=samples, seed=seed, due=by)]
    drafts += [resumed(left, guide) for guide in guides]
    drafted = min(
        (one for one in drafts if one is not None),
        key=lambda one: weights[0] * one.ticks + weights[1] * one.units,
        default=None,
    )
    if not searches:
        return drafted
    plan = solve(left, weights, work_s=searching_s, hint=drafted, seed=seed)
    if by is None or plan is None or keeps(left, plan):
        return plan
    late = rest(moves, here)
    return plan if late is None else solve(late, weights, work_s=searching_s, seed=seed) or plan


def starting(moves: Moves, here: Position, plan: Plan, legal: Set[int]) -> tuple[int, ...] | None:
    """Of the legal ways those that the plan begins now, taking apart first; None when it would
    begin nothing although nothing runs.
    """
    chosen: list[int] = []
    preparation = max(moves.instance.longest_preparation)
    for start, way in plan.begins:
        first = way + moves.count if here.wrong >> moves.task[way] & 1 else way
        if start <= preparation and first in legal and first in moves.legal(here):
            here = moves.begin(here, first)
            chosen.append(first)
    return tuple(sorted(chosen)) if chosen or here.running else None


def next_tasks(moves: Moves, here: Position, plan: Plan) -> dict[str, str]:
    """Busy human -> the first task that the plan holds for it."""
    found: dict[str, str] = {}
    busy = moves.busy(here)
    for _, way in plan.begins:
        for o, name in enumerate(moves.instance.operators):
            if (
                moves.who[way] >> o & 1
                and moves.instance.humans >> o & 1
                and busy >> o & 1
                and name not in found
            ):
                found[name] = moves.named(way)[0]
    return found


def models_of(cell: Cell, objective: Objective) -> Models:
    """The cell's models of what may begin and what follows, the one of the stated times made.

    Raises CellError as `Moves.of` does.
    """
    models = Models(cell, objective.max_stress)
    models.of(Situation.of(cell), 1.0)
    return models


def weights_in_ticks(objective: Objective, moves: Moves) -> tuple[float, float]:
    """What a tick and a unit of stress in whole numbers weigh."""
    return objective.time / moves.instance.per_second, objective.stress / moves.instance.per_stress


def _cost(objective: Objective, moves: Moves, plan: Plan) -> float:
    return objective.cost(plan.ticks / moves.instance.per_second, moves.instance.stress(plan.units))
