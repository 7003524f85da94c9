"""Ways of breaking a sound schedule, each of which certainly breaks it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import replace

from tandem.cell.model import Cell
from tandem.cell.precedence import between
from tandem.schedule.measures import exact, made_ready, makespan, stress
from tandem.schedule.model import Assignment, Schedule

Damaged = Iterator[tuple[Cell, Schedule, dict[str, float]]]
"""The cell, the schedule and the limits that no longer go together."""


def left_out(cell: Cell, plan: Schedule) -> Damaged:
    for a in plan:
        yield cell, _without(plan, a), {}


def done_twice(cell: Cell, plan: Schedule) -> Damaged:
    later = makespan(plan)
    for a in plan:
        yield cell, Schedule((*plan, _at(a, later))), {}


def given_another_name(cell: Cell, plan: Schedule) -> Damaged:
    for a in plan:
        yield cell, _with(plan, a, replace(a, task=a.task + "x")), {}


def made_shorter_or_longer(cell: Cell, plan: Schedule) -> Damaged:
    for a in plan:
        yield cell, _with(plan, a, replace(a, end=float((exact(a.start) + exact(a.end)) / 2))), {}
        yield cell, _with(plan, a, replace(a, end=float(exact(a.end) + exact(0.001)))), {}
        yield cell, _with(plan, a, replace(a, start=a.end, end=a.start)), {}


def given_to_someone_who_cannot(cell: Cell, plan: Schedule) -> Damaged:
    for a in plan:
        groups = [set(mode.operators) for mode in cell.modes(a.task)]
        for name in cell.operators:
            if {name} not in groups:
                yield cell, _with(plan, a, replace(a, operators=(name,))), {}
        yield cell, _with(plan, a, replace(a, operators=(*a.operators, "stranger"))), {}
        yield cell, _with(plan, a, replace(a, operators=())), {}


def given_to_someone_of_another_pace(cell: Cell, plan: Schedule) -> Damaged:
    for a in plan:
        for mode in cell.modes(a.task):
            if exact(mode.time) != exact(a.end) - exact(a.start):
                yield cell, _with(plan, a, replace(a, operators=mode.operators)), {}


def begun_before_zero(cell: Cell, plan: Schedule) -> Damaged:
    for a in plan:
        yield cell, _with(plan, a, _at(a, -0.5)), {}


def begun_before_a_predecessor_has_ended(cell: Cell, plan: Schedule) -> Damaged:
    rows = {a.task: a for a in plan}
    for a in plan:
        for first in cell.tasks[a.task].predecessors:
            yield (
                cell,
                _with(
                    plan, a, _at(a, float((exact(rows[first].start) + exact(rows[first].end)) / 2))
                ),
                {},
            )


def begun_outside_a_wait(cell: Cell, plan: Schedule) -> Damaged:
    rows = {a.task: a for a in plan}
    for a in plan:
        for wait in cell.tasks[a.task].wait:
            first = rows[wait.after]
            moment = exact(first.start if wait.between == "start-start" else first.end)
            if wait.at_least:
                half = float(moment + exact(wait.at_least) / 2)
                yield cell, _with(plan, a, _at(a, half)), {}
            if wait.between == "start-start":
                yield cell, _with(plan, a, _at(a, float(moment - exact(0.001)))), {}
            if wait.at_most is not None:
                yield cell, _with(plan, a, _at(a, float(moment + exact(wait.at_most + 0.001)))), {}


def two_tasks_of_an_operator_at_once(cell: Cell, plan: Schedule) -> Damaged:
    for name in cell.operators:
        for a in plan.of(name):
            for other in plan.of(name):
                if a != other:
                    yield (
                        cell,
                        _with(plan, a, _at(a, float((exact(other.start) + exact(other.end)) / 2))),
                        {},
                    )


def begun_before_the_release(cell: Cell, plan: Schedule) -> Damaged:
    for a in plan:
        if release := cell.tasks[a.task].release:
            yield cell, _with(plan, a, _at(a, float(exact(release) / 2))), {}


def ended_after_the_deadline(cell: Cell, plan: Schedule) -> Damaged:
    for a in plan:
        deadline = cell.tasks[a.task].deadline
        if deadline is not None:
            yield cell, _with(plan, a, _at(a, deadline)), {}


def put_into_a_break(cell: Cell, plan: Schedule) -> Damaged:
    for a in plan:
        for name in a.operators:
            for start, end in cell.operators[name].breaks:
                yield cell, _with(plan, a, _at(a, float((exact(start) + exact(end)) / 2))), {}


def begun_before_all_is_at_hand(cell: Cell, plan: Schedule) -> Damaged:
    """Right behind the task before, with half the time in between that walking and the changeover
    take.
    """
    for name in cell.operators:
        rows = plan.of(name)
        for place, ready in enumerate(made_ready(cell, name, rows)):
            if ready.seconds:
                free = exact(rows[place - 1].end) if place else exact(0)
                half = float(free + exact(ready.seconds) / 2)
                yield cell, _with(plan, rows[place], _at(rows[place], half)), {}


def crowded(cell: Cell, plan: Schedule) -> Damaged:
    for kind, places in (("tool", cell.tools), ("zone", cell.zones)):
        for a in plan:
            for other in plan:
                mine, theirs = (
                    Counter(cell.takes(kind, row.task, row.operators).values())
                    for row in (a, other)
                )
                if a != other and any(
                    mine[name] + theirs[name] > getattr(places.get(name), "capacity", 1)
                    for name in mine.keys() & theirs.keys()
                ):
                    yield cell, _with(plan, a, _at(a, other.start)), {}


def mixed_in_a_zone(cell: Cell, plan: Schedule) -> Damaged:
    for a in plan:
        for other in plan:
            zone = cell.zones.get(cell.tasks[a.task].zone or "")
            if a != other and zone and cell.tasks[a.task].zone == cell.tasks[other.task].zone:
                kinds = [
                    {cell.operators[who].kind for who in row.operators} & set(zone.apart)
                    for row in (a, other)
                ]
                if len(kinds[0] | kinds[1]) > 1:
                    yield cell, _with(plan, a, _at(a, other.start)), {}


def done_while_a_part_is_held(cell: Cell, plan: Schedule) -> Damaged:
    rows = {a.task: a for a in plan}
    for machine, operator in cell.operators.items():
        for first, last in operator.holds:
            middle = (exact(rows[first].end) + exact(rows[last].start)) / 2
            inside = between(cell, first, last)
            for a in plan.of(machine):
                if a.task not in inside:
                    yield cell, _with(plan, a, _at(a, float(middle))), {}
            for other, its_last in operator.holds:
                if not (
                    {other, its_last} <= inside or {first, last} <= between(cell, other, its_last)
                ):
                    yield cell, _with(plan, rows[other], _at(rows[other], float(middle))), {}


def over_a_stress_limit(cell: Cell, plan: Schedule) -> Damaged:
    for human in cell.humans:
        loads = {
            (a.task, frozenset(mode.operators)): mode.stress
            for a in plan
            for mode in cell.modes(a.task)
        }
        total = sum(exact(loads[a.task, frozenset(a.operators)].get(human, 0)) for a in plan)
        if total:
            operators = {
                **cell.operators,
                human: cell.operators[human].model_copy(update={"stress_limit": float(total) / 2}),
            }
            yield cell.replace(operators=operators), plan, {}


def a_pair_apart(cell: Cell, plan: Schedule) -> Damaged:
    rows = {a.task: a for a in plan}
    for a in plan:
        for other in plan:
            common = {frozenset(mode.operators) for mode in cell.modes(a.task)} & {
                frozenset(mode.operators) for mode in cell.modes(other.task)
            }
            if common and set(a.operators) != set(rows[other.task].operators):
                yield cell.replace(same_operator=((a.task, other.task),)), plan, {}


def a_set_that_is_not_listed(cell: Cell, plan: Schedule) -> Damaged:
    if cell.stress_of_set is not None:
        done = {a.task for a in plan if set(a.operators) & set(cell.humans)}
        key = ",".join(name for name in cell.tasks if name in done)
        yield (
            cell.replace(
                stress_of_set={
                    name: value for name, value in cell.stress_of_set.items() if name != key
                }
            ),
            plan,
            {},
        )


def over_a_limit(cell: Cell, plan: Schedule) -> Damaged:
    yield cell, plan, {"max_makespan": makespan(plan) * 0.999}
    if stress(cell, plan):
        yield cell, plan, {"max_stress": stress(cell, plan) * 0.999}


DAMAGES: tuple[Callable[[Cell, Schedule], Damaged], ...] = (
    left_out,
    done_twice,
    given_another_name,
    made_shorter_or_longer,
    given_to_someone_who_cannot,
    given_to_someone_of_another_pace,
    begun_before_zero,
    begun_before_a_predecessor_has_ended,
    begun_outside_a_wait,
    two_tasks_of_an_operator_at_once,
    begun_before_the_release,
    ended_after_the_deadline,
    put_into_a_break,
    begun_before_all_is_at_hand,
    crowded,
    mixed_in_a_zone,
    done_while_a_part_is_held,
    over_a_stress_limit,
    a_pair_apart,
    a_set_that_is_not_listed,
    over_a_limit,
)


def _at(a: Assignment, start: float) -> Assignment:
    """The same assignment, moved."""
    return replace(a, start=start, end=float(exact(start) + exact(a.end) - exact(a.start)))


def _without(plan: Schedule, a: Assignment) -> Schedule:
    return Schedule(tuple(other for other in plan if other != a))


def _with(plan: Schedule, a: Assignment, instead: Assignment) -> Schedule:
    return Schedule((*_without(plan, a), instead))
