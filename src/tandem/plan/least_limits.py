"""The least limits of stress that people can be given, when those that are stated cannot be kept:
found and proven by CP-SAT on the cell without them, each judged by the checker.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import floor

from ortools.sat.python import cp_model

from tandem.cell.model import Cell
from tandem.plan.cpsat import formulate, loads_of
from tandem.plan.instance import Instance
from tandem.plan.question import Question
from tandem.schedule.checker import faults
from tandem.schedule.measures import exact


def with_limits(cell: Cell, people: Sequence[str], limit: float | None) -> Cell:
    """The cell in which each of these people has this limit of stress, or none."""
    operators = {
        name: operator.model_copy(update={"stress_limit": limit}) if name in people else operator
        for name, operator in cell.operators.items()
    }
    return cell.replace(operators=operators)


def least_limit(
    cell: Cell, question: Question, people: Sequence[str], *, seconds: float
) -> float | None:
    """The least limit of stress that all of these people can keep at once, all other limits of the
    cell and of the question kept, in the cell's measure; None when there is none, or time was too
    short to prove one.
    """
    free = with_limits(cell, people, None)
    instance = Instance.of(free)
    upper = _units(question.max_makespan, instance.per_second, instance.horizon)
    plan = formulate(instance, upper)
    most = plan.model.new_int_var(0, 1 << 50, "the most that one of them has")
    for name in people:
        loads = loads_of(plan, instance.operators.index(name))
        plan.model.add(sum(load * x for load, x in loads) <= most)
    if question.max_stress is not None:
        plan.model.add(plan.stress <= floor(exact(question.max_stress) * instance.per_stress))
    plan.model.minimize(most)
    solver = cp_model.CpSolver()
    solver.parameters.max_time_in_seconds = seconds
    solver.parameters.num_workers = 1
    solver.parameters.random_seed = 0
    solver.parameters.catch_sigint_signal = False
    if solver.status_name(solver.solve(plan.model)) != "OPTIMAL":
        return None
    limit = instance.stress(round(solver.objective_value))
    found = faults(
        with_limits(cell, people, limit),
        instance.schedule(plan.read(solver.value)),
        max_makespan=question.max_makespan,
        max_stress=question.max_stress,
    )
    return None if found else limit


def _units(limit: float | None, scale: int, otherwise: int) -> int:
    return otherwise if limit is None else min(otherwise, floor(exact(limit) * scale))
