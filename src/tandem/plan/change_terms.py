"""What CP-SAT's model of a cell is told besides the cell's own rules when an old plan is carried
over: what lies in the past, and what counts as a change.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from ortools.sat.python import cp_model

from tandem.plan import cpsat
from tandem.plan.cpsat import Decisions, any_of
from tandem.plan.standing import Standing

Aim = Literal["makespan", "stress", "operator", "order", "start", "changed"]
"""What a question makes small: ticks, units, numbers of tasks; "changed" is the sum of the three
numbers.
"""


def rules(standing: Standing) -> tuple[cpsat.Rule, ...]:
    """The rules of the cell, and that nothing is begun in the past."""
    return (*cpsat.RULES, lambda plan: nothing_is_begun_in_the_past(plan, standing))


def nothing_is_begun_in_the_past(plan: Decisions, standing: Standing) -> None:
    """Walking and changeovers too begin now or later, unless they had begun; and a task that may
    stay where the old plan had it, before now, stays there or begins later.
    """
    now, model = standing.now, plan.model
    for before in plan.preparations:
        if not standing.may_be_prepared_early(before.operator, before.task):
            begin = plan.start[before.task] - before.ticks
            model.add(begin >= now).only_enforce_if(before.literal)
    if not standing.may_stay:
        return
    for task, old in standing.old.items():
        if task in standing.fixed or old.start >= now:
            continue
        later = model.new_bool_var("")
        model.add(plan.start[task] >= now).only_enforce_if(later)
        model.add(plan.start[task] == old.start).only_enforce_if(later.negated())
        same = _same(plan, task, old.team)
        model.add_bool_or([later, *([] if same is None else [same])])


def _same(plan: Decisions, task: int, team: tuple[int, ...] | None) -> cp_model.IntVar | None:
    """A literal: the old plan's operators do the task; None when they cannot."""
    literals = [
        x
        for x, way in zip(plan.chosen[task], plan.instance.ways[task], strict=True)
        if way.operators == team
    ]
    return any_of(plan, literals) if literals else None


def what_changes(
    plan: Decisions, standing: Standing, tolerance: int
) -> dict[Aim, cp_model.LinearExprT]:
    """The numbers of changed tasks as terms of the model, `tolerance` in ticks.

    Per task three literals, each of which needs the one before: its operators are the same, its
    order is the same, its start is about the same. They are only bound to tell the truth when they
    say that nothing has changed, which is what questions want of them.
    """
    model = plan.model
    same: dict[int, cp_model.IntVar] = {}
    for task, old in standing.old.items():
        literal = _same(plan, task, old.team)
        if literal is not None:
            same[task] = literal
    keep = {task: model.new_bool_var(f"keeps order {task}") for task in same}
    near = {task: model.new_bool_var(f"keeps start {task}") for task in same}
    for task, literal in same.items():
        model.add_implication(keep[task], literal)
        model.add_implication(near[task], keep[task])
        moment = standing.old[task].start
        model.add(plan.start[task] >= moment - tolerance).only_enforce_if(near[task])
        model.add(plan.start[task] <= moment + tolerance).only_enforce_if(near[task])
    _orders_are_kept(plan, standing, keep)
    others: Any = len(standing.old) - sum(same.values())
    order: Any = sum(same.values()) - sum(keep.values())
    start: Any = sum(keep.values()) - sum(near.values())
    changed: Any = len(standing.old) - sum(near.values())
    return {"operator": others, "order": order, "start": start, "changed": changed}


def _orders_are_kept(
    plan: Decisions, standing: Standing, keep: Mapping[int, cp_model.IntVar]
) -> None:
    """A task that keeps its order stays before, or behind, whatever else its operators did then and
    do now.
    """
    in_time = sorted(standing.old, key=lambda task: (standing.old[task].start, task))
    for place, first in enumerate(in_time):
        for second in in_time[place + 1 :]:
            _order_is_kept(plan, standing, keep, first, second)


def _order_is_kept(
    plan: Decisions,
    standing: Standing,
    keep: Mapping[int, cp_model.IntVar],
    first: int,
    second: int,
) -> None:
    model = plan.model
    shared = set(standing.old[first].team or ()) & set(standing.old[second].team or ())
    literal = None
    for keeps, other in ((first, second), (second, first)):
        for operator in shared if keeps in keep else ():
            does = plan.does(other, operator)
            if not does:
                continue
            if literal is None:
                literal = model.new_bool_var("")
                model.add(plan.end[first] <= plan.start[second]).only_enforce_if(literal)
            for way in does:
                model.add_bool_or([keep[keeps].negated(), way.negated(), literal])
