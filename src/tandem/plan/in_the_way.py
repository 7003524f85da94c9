"""Why no plan leaves everything where it is: what cannot stay, or which limit can no longer be
kept, each confirmed by planning without it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from time import monotonic
from typing import Any

from ortools.sat.python import cp_model

from tandem.cell.measures import OWN
from tandem.cell.written import number
from tandem.errors import InfeasibleError, NothingFoundError
from tandem.plan import exact
from tandem.plan.change_terms import rules
from tandem.plan.cpsat import formulate
from tandem.plan.infeasible import Core, Limit, infeasible, minimal_core, on_people
from tandem.plan.question import Question
from tandem.plan.standing import Standing

EACH_S = 3.0
"""Seconds for one question "is there a plan without this?"."""
ALL_S = 20.0
"""Seconds for all of them."""


def in_the_way(standing: Standing) -> InfeasibleError:
    """What is said when no plan exists: the cell's own limits where they leave none, else the tasks
    to keep that cannot all stay, else the limits that what is done and has started no longer lets
    be kept; each time a minimal set (`infeasible.minimal_core`), as far as time allows.
    """
    if not _cell_has_a_plan(standing):
        own = "no schedule keeps the cell's own limits; this is proven."
        return infeasible(own, standing.cell, Question())
    what = "no plan leaves what is done, started or kept where it is; this is proven."
    until = monotonic() + ALL_S
    kept = [task for task, fixed in standing.fixed.items() if fixed.why == "kept"]
    if kept and _has_a_plan(standing.freed(kept)):
        return InfeasibleError(what, *_cannot_stay(standing, kept, until))
    return InfeasibleError(what, *_no_longer_kept(standing.freed(kept), until))


def _cannot_stay(
    standing: Standing, kept: list[int], until: float
) -> tuple[list[str], dict[str, Any]]:
    """The tasks to keep that cannot all stay, and what leaving out each would give."""
    names = standing.stated.tasks
    limits = [Limit(standing.words(task), ("keep", names[task])) for task in kept]
    tasks = dict(zip(limits, kept, strict=True))

    def possible(some: Sequence[Limit]) -> bool | None:
        left_out = [tasks[limit] for limit in limits if limit not in some]
        return _has_a_plan(standing.freed(left_out)) if monotonic() < until else None

    core = minimal_core(limits, possible)
    words = [limit.words for limit in core.items]
    together = (
        f"{words[0]} cannot stay where it is."
        if len(words) == 1
        else f"{', '.join(words[:-1])} and {words[-1]} cannot all stay where they are."
    )
    helping = _helping(core, lambda limit: standing.freed([tasks[limit]]), until)
    said = [f"Without --keep {x.where[-1]} there is a plan." for x, helps in helping if helps]
    return [together, *core.doubt(), *said], _document(core, helping)


def _no_longer_kept(standing: Standing, until: float) -> tuple[list[str], dict[str, Any] | None]:
    """The limits that can no longer be kept together, although nothing is kept."""
    stated, lifts = standing.stated, dict(_liftable(standing))
    begun = [standing.words(task) for task in standing.fixed]
    moment = number(stated.seconds(standing.now))
    after = f" after {', '.join(begun)}" if begun else ""
    what = f"What has not begun cannot begin at {moment} s or later and keep all limits{after}."

    def without(some: Iterable[Limit]) -> Standing:
        left = standing
        for limit in some:
            left = lifts[limit](left)
        return left

    def possible(some: Sequence[Limit]) -> bool | None:
        lifted = without(limit for limit in lifts if limit not in some)
        return _has_a_plan(lifted) if monotonic() < until else None

    core = minimal_core(list(lifts), possible)
    if not core.items:
        none = "No deadline, wait or stress limit can be lifted so that there is a plan."
        return [what, none], None
    words = [limit.words for limit in core.items]
    together = (
        f"{words[0]} cannot be kept any more."
        if len(words) == 1
        else f"{', '.join(words[:-1])} and {words[-1]} cannot be kept together any more."
    )
    helping = _helping(core, lambda limit: without([limit]), until)
    said = [f"Without {limit.words} there is a plan." for limit, helps in helping if helps]
    alone = [] if said else ["Lifting one of them alone does not help."]
    return [what, together, *core.doubt(), *said, *alone], _document(core, helping)


def _helping(
    core: Core, without: Callable[[Limit], Standing], until: float
) -> list[tuple[Limit, bool | None]]:
    """Whether there is a plan without each of the limits alone; None when time was too short."""
    return [
        (limit, _has_a_plan(without(limit)) if monotonic() < until else None)
        for limit in core.items
    ]


def _document(core: Core, helping: Iterable[tuple[Limit, bool | None]]) -> dict[str, Any]:
    """As `infeasible.Conflict` holds it; what a plan without a limit is worth is not asked."""
    without = [{**limit.to_dict(), "helps": helps} for limit, helps in helping]
    return {**core.to_dict(), "least": [], "without": without}


Lift = Callable[[Standing], Standing]


def _liftable(standing: Standing) -> Iterator[tuple[Limit, Lift]]:
    """Each limit, and what takes it off."""
    stated = standing.stated
    for task, deadline in enumerate(stated.deadline):
        if deadline is not None and task not in standing.fixed:
            seconds = number(stated.seconds(deadline))
            words = f"the deadline of task {stated.tasks[task]} ({seconds} s)"
            where = ("tasks", stated.tasks[task], "deadline")
            yield Limit(words, where), partial(_without_deadline, task)
    for place, lag in enumerate(stated.lags):
        if lag.most is not None and lag.task not in standing.fixed:
            first, seconds = stated.tasks[lag.before], number(stated.seconds(lag.most))
            words = (
                f"the wait of task {stated.tasks[lag.task]} (at most {seconds} s after task"
                f" {first} has {'started' if lag.from_start else 'ended'})"
            )
            wait = ("tasks", stated.tasks[lag.task], "wait", first, "at_most")
            yield Limit(words, wait), partial(_without_wait, place)
    of_people = {limit.where: limit for limit in on_people(standing.cell)}
    for place, allowance in enumerate(stated.allowances):
        whose = ("operators", stated.operators[allowance.operator])
        key = ("stress_limit",) if allowance.measure == OWN else ("limits", allowance.measure)
        yield of_people[(*whose, *key)], partial(_without_allowance, place)


def _without_deadline(task: int, standing: Standing) -> Standing:
    deadlines = _with_none(standing.stated.deadline, task)
    return replace(standing, stated=replace(standing.stated, deadline=deadlines))


def _without_wait(place: int, standing: Standing) -> Standing:
    lags = standing.stated.lags
    kept = (*lags[:place], lags[place]._replace(most=None), *lags[place + 1 :])
    return replace(standing, stated=replace(standing.stated, lags=kept))


def _without_allowance(place: int, standing: Standing) -> Standing:
    return replace(standing, stated=standing.stated.without_allowance(place))


def _with_none(limits: tuple[int | None, ...], place: int) -> tuple[int | None, ...]:
    return (*limits[:place], None, *limits[place + 1 :])


def _cell_has_a_plan(standing: Standing) -> bool:
    """Whether the cell has a schedule at all, unless time is too short to tell."""
    try:
        exact.solve(standing.cell, Question("makespan"), time_limit=EACH_S)
    except InfeasibleError:
        return False
    except NothingFoundError:
        return True
    return True


def _has_a_plan(standing: Standing) -> bool | None:
    """Whether there is a plan as things stand; None when time was too short."""
    plan = formulate(standing.instance, standing.instance.horizon, rules(standing))
    solver = cp_model.CpSolver()
    solver.parameters.max_time_in_seconds = EACH_S
    solver.parameters.num_workers = 1
    status: int = int(solver.solve(plan.model))  # type: ignore[call-overload]
    if status == cp_model.INFEASIBLE:
        return False
    return True if status in (cp_model.OPTIMAL, cp_model.FEASIBLE) else None
