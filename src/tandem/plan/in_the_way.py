"""Why no plan leaves everything where it is: the smallest group of tasks that cannot stay, each
confirmed by planning without it.
"""

from __future__ import annotations

from collections.abc import Collection
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
"""Seconds for one question "is there a plan when these need not stay?"."""
ALL_S = 20.0
"""Seconds for all of them."""


def in_the_way(standing: Standing) -> tuple[str, list[str]]:
    """What is said when no plan exists, and the reasons: the cell's own limits where they leave
    none, else what is done, started and kept (a deletion filter, as in `plan.infeasible`).
    """
    if not _cell_has_a_plan(standing):
        return (
            "no schedule keeps the cell's own limits; this is proven.",
            reasons(standing.cell, Question()),
        )
    what = "no plan leaves what is done, started or kept where it is; this is proven."
    until = monotonic() + ALL_S
    group = list(standing.fixed)
    for task in list(group):
        rest = [other for other in group if other != task]
        if monotonic() < until and _has_a_plan(standing, rest) is False:
            group = rest
    moment = number(standing.stated.seconds(standing.now))
    if not group:
        late = f"what has not begun cannot begin as late as {moment} s and keep the cell's limits."
        return what, [late]
    words = [standing.words(task) for task in group]
    if len(words) == 1:
        said = [f"{words[0]} cannot stay where it is."]
    else:
        said = [f"{', '.join(words[:-1])} and {words[-1]} cannot all stay where they are."]
    for task in group:
        if standing.fixed[task].why == "kept":
            name = standing.stated.tasks[task]
            free = [other for other in standing.fixed if other != task]
            if _has_a_plan(standing, free):
                said.append(f"Without --keep {name} there is a plan.")
    return what, said


def _cell_has_a_plan(standing: Standing) -> bool:
    """Whether the cell has a schedule at all, unless time is too short to tell."""
    try:
        exact.solve(standing.cell, Question("makespan"), time_limit=EACH_S)
    except InfeasibleError:
        return False
    except NothingFoundError:
        return True
    return True


def _has_a_plan(standing: Standing, fixed: Collection[int]) -> bool | None:
    """Whether there is a plan when only these tasks have to stay; None when time was too short."""
    free = standing.freed([task for task in standing.fixed if task not in fixed])
    plan = formulate(free.instance, free.instance.horizon, rules(free))
    solver = cp_model.CpSolver()
    solver.parameters.max_time_in_seconds = EACH_S
    solver.parameters.num_workers = 1
    status: int = int(solver.solve(plan.model))  # type: ignore[call-overload]
    if status == cp_model.INFEASIBLE:
        return False
    return True if status in (cp_model.OPTIMAL, cp_model.FEASIBLE) else None
