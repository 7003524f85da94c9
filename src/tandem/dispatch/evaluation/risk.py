"""What a front's makespans become on the floor, where times scatter: each plan carried out as it
stands, and with the rest planned anew at every event.

People comply; a task takes its stated time on average, and scatters by the `spread` that the cell
states for it, else by a common coefficient of variation (lognormal). All points, and both ways of
carrying a plan out, meet the same durations (common random numbers).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache, partial
from typing import Any

import numpy as np

from tandem.dispatch.deciders.memory import settled_memory
from tandem.dispatch.deciders.policy import Basis, Chosen, Options
from tandem.dispatch.deciders.table import policy
from tandem.dispatch.evaluation.batch import EpisodeBatch
from tandem.dispatch.lookahead.objective import Objective
from tandem.errors import CellError, UsageError
from tandem.plan.result import Front, Quantiles, Result, Risk, Status
from tandem.world import people as crew
from tandem.world.arrays import Arrays, Names
from tandem.world.carried_out import Plan, carry_on
from tandem.world.episode import Played, play
from tandem.world.people import Person, compliant
from tandem.world.randomness import Chance, Draw, Scenario

EPISODES = 2_000
"""Assemblies in which each plan is carried out as it stands."""
MOST_REPLANNED, FEWEST_REPLANNED = 100, 20
"""Assemblies in which each plan is planned anew at every event."""
DECISIONS = 4_000
"""So many decisions, about, for all points of a front; larger cells and fronts get fewer
assemblies, down to `FEWEST_REPLANNED`.
"""
REPLANNED_BY = "replan-robust"


def with_risk(
    front: Front,
    *,
    cv: float = 0.0,
    robust: bool = False,
    replanned: bool = True,
    seed: int = 0,
    tell: Callable[[str], None] = lambda _: None,
) -> Front:
    """The front, each point with its risk.

    Args:
      cv: coefficient of variation of the times for which the cell states no spread.
      robust: recommend by the P95 of the makespan as carried out.
      replanned: tell too what comes of re-planning, which takes many decisions.
      seed: of chance.
      tell: hears how far the work has come.

    Raises:
      UsageError: no time scatters; or a cv out of range.
      CellError: the cell is too large to be simulated.
    """
    if not cv and not any(task.scatters for task in front.cell.tasks.values()):
        raise UsageError(
            "no time of this cell scatters, so that no risk can be told: give --cv 0.2, or a"
            " `spread` in the cell."
        )
    names = Names.of(front.cell)
    arrays = names.arrays()
    draw = Draw.of(names, arrays, Chance("lognormal", cv))
    persons = Person(*(np.stack([np.asarray(part)] * EPISODES) for part in compliant(arrays)))
    stage = EpisodeBatch.of(names, arrays, draw, persons, seed)
    count = DECISIONS // (2 * len(front.cell.tasks) * max(len(front), 1))
    count = min(MOST_REPLANNED, max(FEWEST_REPLANNED, count))
    found = []
    for place, result in enumerate(front):
        tell(f"carrying out point {place + 1} of {len(front)}")
        fixed = _quantiles(carried_out(stage, Plan.of(names, result.schedule)))
        objective = Objective.of_point(front, place)
        anew = _replanned(stage, result, objective, count, seed) if replanned else None
        found.append(replace(result, risk=Risk(fixed, anew)))
    return replace(front, results=tuple(found), robust=robust)


def _replanned(
    stage: EpisodeBatch, result: Result, objective: Objective, count: int, seed: int
) -> Quantiles | None:
    """The makespan under a decider that follows the plan while it is good; None when the cell has
    a rule that cannot be kept live.
    """
    basis = Basis.of(result, proven=result.status == Status.OPTIMAL)
    options = Options(seed=seed, plan=Chosen(result.schedule, basis))
    try:
        decider = policy(REPLANNED_BY, result.cell, objective, options)
    except CellError:
        return None
    with settled_memory() as settle:
        return _quantiles(stage.play(decider, count, between=settle).makespan)


def carried_out(stage: EpisodeBatch, plan: Plan) -> np.ndarray[Any, Any]:
    """`[E]`, the makespan in seconds of each episode under the plan."""
    played = _compiled()(stage.arrays, stage.scenarios, stage.people, plan)
    return np.asarray(played.makespan) / stage.names.per_second


@lru_cache(maxsize=1)
def _compiled() -> Callable[[Arrays, Scenario, Person, Plan], Played]:
    """Compiled once for all plans of a cell: the plan comes in as data."""
    import jax

    def one(arrays: Arrays, scenario: Scenario, person: Person, plan: Plan) -> Played:
        arrays = plan.held_back(arrays)
        return play(arrays, scenario, crew.crew(arrays, person), partial(carry_on, plan))

    return jax.jit(jax.vmap(one, in_axes=(None, 0, 0, None)))


def _quantiles(makespans: np.ndarray[Any, Any]) -> Quantiles:
    p50, p95 = (round(float(np.quantile(makespans, share)), 4) for share in (0.5, 0.95))
    return Quantiles(p50, p95, len(makespans))
