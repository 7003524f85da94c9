"""Why no plan leaves everything where it is: what cannot stay, or which limit can no longer be
kept, each confirmed by planning without it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from time import monotonic

from ortools.sat.python import cp_model

from tandem.cell.written import number
from tandem.errors import InfeasibleError, NothingFoundError
from tandem.plan import exact
from tandem.plan.change_terms import rules
from tandem.plan.cpsat import formulate
from tandem.plan.infeasible import reasons
from tandem.plan.question import Question
from tandem.plan.standing import Standing

EACH_S = 3.0
"""Seconds for one question "is there a plan without this?"."""
ALL_S = 20.0
"""Seconds for all of them."""


def in_the_way(standing: Standing) -> tuple[str, list[str]]:
    """What is said when no plan exists, and the reasons: the cell's own limits where they leave
    none, else the tasks to keep that cannot all stay (a deletion filter, as in `plan.infeasible`),
    else the limits that what is done and has started no longer lets be kept.
    """
    if not _cell_has_a_plan(standing):
        return (
            "no schedule keeps the cell's own limits; this is proven.",
            reasons(standing.cell, Question()),
        )
    what = "no plan leaves what is done, started or kept where it is; this is proven."
    until = monotonic() + ALL_S
    kept = [task for task, fixed in standing.fixed.items() if fixed.why == "kept"]
    if kept and _has_a_plan(standing.freed(kept)):
        return what, list(_cannot_stay(standing, kept, until))
    return what, list(_no_longer_kept(standing.freed(kept), until))


def _cannot_stay(standing: Standing, kept: list[int], until: float) -> Iterator[str]:
    """The smallest group of tasks to keep that cannot all stay, and what leaving out each would
    give.
    """
    group = list(kept)
    for task in kept:
        rest = [other for other in group if other != task]
        freed = standing.freed([other for other in kept if other not in rest])
        if monotonic() < until and _has_a_plan(freed) is False:
            group = rest
    words = [standing.words(task) for task in group]
    if len(words) == 1:
        yield f"{words[0]} cannot stay where it is."
    else:
        yield f"{', '.join(words[:-1])} and {words[-1]} cannot all stay where they are."
    for task in group:
        if monotonic() < until and _has_a_plan(standing.freed([task])):
            yield f"Without --keep {standing.stated.tasks[task]} there is a plan."


def _no_longer_kept(standing: Standing, until: float) -> Iterator[str]:
    """The limits without one of which there would be a plan, although nothing is kept."""
    stated, found = standing.stated, False
    begun = [standing.words(task) for task in standing.fixed]
    moment = number(stated.seconds(standing.now))
    after = f" after {', '.join(begun)}" if begun else ""
    yield f"What has not begun cannot begin at {moment} s or later and keep all limits{after}."
    for words, lifted in _lifted(standing):
        if monotonic() < until and _has_a_plan(lifted):
            found = True
            yield f"Without {words} there is a plan."
    if not found:
        yield "No single deadline, wait or stress limit can be lifted so that there is a plan."


def _lifted(standing: Standing) -> Iterator[tuple[str, Standing]]:
    """Each limit in words, and how things stand without it."""
    stated = standing.stated
    for task, deadline in enumerate(stated.deadline):
        if deadline is not None and task not in standing.fixed:
            rest = (*stated.deadline[:task], None, *stated.deadline[task + 1 :])
            free = replace(standing, stated=replace(stated, deadline=rest))
            seconds = number(stated.seconds(deadline))
            yield f"the deadline of task {stated.tasks[task]} ({seconds} s)", free
    for place, lag in enumerate(stated.lags):
        if lag.most is not None and lag.task not in standing.fixed:
            kept = (*stated.lags[:place], lag._replace(most=None), *stated.lags[place + 1 :])
            free = replace(standing, stated=replace(stated, lags=kept))
            first, seconds = stated.tasks[lag.before], number(stated.seconds(lag.most))
            yield (
                f"the wait of task {stated.tasks[lag.task]} (at most {seconds} s after task"
                f" {first} has {'started' if lag.from_start else 'ended'})",
                free,
            )
    for operator, limit in enumerate(stated.stress_limit):
        if limit is not None:
            limits = (*stated.stress_limit[:operator], None, *stated.stress_limit[operator + 1 :])
            free = replace(standing, stated=replace(stated, stress_limit=limits))
            stress = number(stated.stress(limit))
            yield f"the stress limit of {stated.operators[operator]} ({stress})", free


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
