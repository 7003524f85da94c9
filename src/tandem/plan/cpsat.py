"""The cell as a CP-SAT model: the decisions, and one function for each rule of the cell.

The engine's types stay behind this door; `exact.py` and `neighbourhoods.py` ask questions of the
model.

Alternatives share one start and one end per task, every alternative has an interval of fixed size.
OR-Tools is pinned to 9.14 because 9.15.6755 answers such models wrongly;
`tests/plan/test_ortools_pin.py` tells the story.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from importlib.metadata import version
from itertools import combinations
from typing import NamedTuple

from ortools.sat.python import cp_model

from tandem.plan.instance import Instance
from tandem.plan.starts import Starts

SOLVER = f"cp-sat {version('ortools')}"
"""What proves, by name and version."""
Literal = cp_model.LiteralT


class Changeover(NamedTuple):
    """The operator takes up the task's tool, for so many ticks directly before it, when the literal
    is true.
    """

    operator: int
    task: int
    ticks: int
    literal: cp_model.IntVar


@dataclass
class Decisions:
    """The variables of the model, and how to read them back.

    Attributes:
      start, end: per task, ticks.
      chosen: per task and way, a literal; exactly one per task is true.
      intervals: per task and way, present when the way is chosen.
      at: per operator, the intervals that occupy it.
      changeovers: those that may take place; `swaps`: operator, task and interval of
        each.
      makespan: ticks; stress: units, in the cell's measure.
    """

    model: cp_model.CpModel
    instance: Instance
    upper: int
    start: list[cp_model.IntVar] = field(default_factory=list)
    end: list[cp_model.LinearExprT] = field(default_factory=list)
    chosen: list[list[cp_model.IntVar]] = field(default_factory=list)
    intervals: list[list[cp_model.IntervalVar]] = field(default_factory=list)
    at: dict[int, list[cp_model.IntervalVar]] = field(default_factory=lambda: defaultdict(list))
    changeovers: list[Changeover] = field(default_factory=list)
    swaps: list[tuple[int, int, cp_model.IntervalVar]] = field(default_factory=list)
    makespan: cp_model.IntVar = None  # type: ignore[assignment]
    stress: cp_model.IntVar = None  # type: ignore[assignment]

    def does(self, task: int, operator: int) -> list[cp_model.IntVar]:
        """The literals under which the operator takes part in the task; at most one is true."""
        return [
            x
            for x, way in zip(self.chosen[task], self.instance.ways[task], strict=True)
            if operator in way.operators
        ]

    def read(self, value: Callable[[cp_model.IntVar], int]) -> Starts:
        """The schedule that the values describe."""
        return tuple(
            (next(w for w, x in enumerate(self.chosen[t]) if value(x)), value(self.start[t]))
            for t in range(len(self.start))
        )

    def hint(self, starts: Starts) -> None:
        """Tells the solver a schedule to begin with."""
        self.model.clear_hints()  # type: ignore[no-untyped-call]
        for task, (way, start) in enumerate(starts):
            self.model.add_hint(self.start[task], start)
            for w, x in enumerate(self.chosen[task]):
                if w or len(self.chosen[task]) > 1:
                    self.model.add_hint(x, w == way)


def formulate(instance: Instance, upper: int, rules: Iterable[Rule] | None = None) -> Decisions:
    """The model of the cell for schedules that end by `upper` ticks: its decisions, and every rule
    in `rules` (default: all).
    """
    model = cp_model.CpModel()
    plan = Decisions(model, instance, upper)
    model_is_trivially_false = False
    for task, ways in enumerate(instance.ways):
        # an empty domain would be an error of the modeller; a model without a solution is an answer
        latest = _latest_start(instance, task, upper)
        if latest < instance.head[task]:
            model_is_trivially_false, latest = True, instance.head[task]
        start = model.new_int_var(instance.head[task], latest, f"start {task}")
        chosen = (
            [model.new_bool_var(f"way {task} {w}") for w in range(len(ways))]
            if len(ways) > 1
            else [model.new_constant(1)]
        )
        if len(ways) > 1:
            model.add_exactly_one(chosen)
        # a task with one way needs no literal
        intervals = []
        for way, literal in zip(ways, chosen, strict=True):
            interval = (
                model.new_optional_fixed_size_interval_var(start, way.ticks, literal, "")
                if len(ways) > 1
                else model.new_fixed_size_interval_var(start, way.ticks, "")
            )
            intervals.append(interval)
            for operator in way.operators:
                plan.at[operator].append(interval)
        plan.start.append(start)
        plan.chosen.append(chosen)
        plan.intervals.append(intervals)
        plan.end.append(
            start
            + (
                sum(way.ticks * x for way, x in zip(ways, chosen, strict=True))
                if len(ways) > 1
                else ways[0].ticks
            )
        )
    plan.makespan = model.new_int_var(0, upper, "makespan")
    # whatever has a successor ends before it does, so the last ones are enough
    for task in range(len(instance.tasks)):
        if not instance.behind[task]:
            model.add(plan.end[task] <= plan.makespan)
    if model_is_trivially_false:
        model.add_bool_or([])
    for rule in RULES if rules is None else rules:
        rule(plan)
    return plan


def _latest_start(instance: Instance, task: int, upper: int) -> int:
    """Ticks; the task cannot start later in any way. In a slow way it may have to start sooner:
    `deadlines_are_kept` says that.
    """
    quickest = min(way.ticks for way in instance.ways[task])
    deadline = instance.deadline[task]
    latest = upper - instance.tail[task]
    return latest if deadline is None else min(latest, deadline - quickest)


Rule = Callable[[Decisions], None]


def deadlines_are_kept(plan: Decisions) -> None:
    """A task ends by its deadline in whatever way it is done; in the quickest the bounds of its
    start see to it.
    """
    for task, deadline in enumerate(plan.instance.deadline):
        if deadline is not None and len({way.ticks for way in plan.instance.ways[task]}) > 1:
            plan.model.add(plan.end[task] <= deadline)


def predecessors_end_first(plan: Decisions) -> None:
    """A task starts when all that it comes after have ended."""
    for task, firsts in enumerate(plan.instance.before):
        for first in firsts:
            plan.model.add(plan.end[first] <= plan.start[task])


def an_operator_does_one_thing_at_a_time(plan: Decisions) -> None:
    """Tasks, breaks and changeovers of an operator do not overlap."""
    for operator in range(len(plan.instance.operators)):
        busy = [*plan.at[operator], *_changeovers(plan, operator)]
        busy += [
            plan.model.new_fixed_size_interval_var(begin, end - begin, "")
            for begin, end in plan.instance.breaks[operator]
        ]
        if len(busy) > 1:
            plan.model.add_no_overlap(busy)


def _changeovers(plan: Decisions, operator: int) -> list[cp_model.IntervalVar]:
    """The intervals in which the operator takes up another tool, directly before the task that
    needs it.
    """
    instance, model = plan.instance, plan.model
    tasks = [
        t for t, tool in enumerate(instance.tool) if tool is not None and plan.does(t, operator)
    ]
    cost = {t: instance.changeover[instance.tool[t]][operator] for t in tasks}  # type: ignore[index]
    in_hand = instance.in_hand[operator]
    kinds = {instance.tool[t] for t in tasks} | ({in_hand} if in_hand is not None else set())
    # nothing to take up, or at no cost: no order needs to be decided
    if len(kinds) < 2 or not any(cost.values()):
        return []
    arcs: list[tuple[int, int, Literal]] = []
    into: dict[int, list[cp_model.IntVar]] = {t: [] for t in tasks}
    # the circuit is the order in which the operator does its tasks with tools; it leaves out, by a
    # loop, those that others do, and all of them when there are none
    nobody = model.new_bool_var("no tool used")
    arcs.append((0, 0, nobody))
    for index, task in enumerate(tasks, start=1):
        does = any_of(plan, plan.does(task, operator))
        arcs.append((index, index, does.negated()))
        first, last = model.new_bool_var(""), model.new_bool_var("")
        arcs += [(0, index, first), (index, 0, last)]
        # what is in hand at the beginning is laid down as if a task had needed it
        if in_hand is not None and in_hand != instance.tool[task]:
            into[task].append(first)
        model.add_implication(does, nobody.negated())
    for (i, first_task), (j, second_task) in combinations(enumerate(tasks, start=1), 2):
        for a, one, b, two in ((i, first_task, j, second_task), (j, second_task, i, first_task)):
            follows = model.new_bool_var("")
            arcs.append((a, b, follows))
            model.add(plan.end[one] <= plan.start[two]).only_enforce_if(follows)
            if instance.tool[one] != instance.tool[two]:
                into[two].append(follows)
    model.add_circuit(arcs)
    # a changeover lies directly before its task and occupies the operator like work
    swaps = []
    for task, causes in into.items():
        if causes and cost[task]:
            swap = any_of(plan, causes)
            plan.changeovers.append(Changeover(operator, task, cost[task], swap))
            model.add(plan.start[task] >= cost[task]).only_enforce_if(swap)
            interval = model.new_optional_fixed_size_interval_var(
                plan.start[task] - cost[task], cost[task], swap, ""
            )
            plan.swaps.append((operator, task, interval))
            swaps.append(interval)
    return swaps


def a_machine_that_holds_a_part_does_nothing_else(plan: Decisions) -> None:
    """From the start of the first task of a hold to the end of its last the machine does nothing
    but what lies within it, changes no tool for anything else and takes up no other part.
    """
    instance, model = plan.instance, plan.model
    spans: list[cp_model.IntervalVar] = []
    for hold, (operator, first, last) in enumerate(instance.holds):
        end = model.new_int_var(0, plan.upper, "")
        model.add(end == (plan.end[last] if last >= 0 else plan.upper))
        length = model.new_int_var(0, plan.upper, "")
        span = model.new_interval_var(plan.start[first] if first >= 0 else 0, length, end, "")
        others = [
            interval
            for task, ways in enumerate(instance.ways)
            for way, interval in zip(ways, plan.intervals[task], strict=True)
            if instance.barred[hold] >> task & 1 and operator in way.operators
        ]
        others += [
            interval
            for who, task, interval in plan.swaps
            if who == operator and instance.barred[hold] >> task & 1
        ]
        if others:
            model.add_no_overlap([span, *others])
        for other, its in enumerate(spans):
            if instance.rivals[hold] >> other & 1:
                model.add_no_overlap([span, its])
        spans.append(span)


def any_of(plan: Decisions, literals: list[cp_model.IntVar]) -> cp_model.IntVar:
    """A literal that is true when one of these, of which at most one is true, is true."""
    if len(literals) == 1:
        return literals[0]
    either = plan.model.new_bool_var("")
    plan.model.add(sum(literals) == either)
    return either


def a_tool_is_used_as_often_as_it_exists(plan: Decisions) -> None:
    """At most `capacity` operators work with a tool at once."""
    _share(plan, plan.instance.tool, plan.instance.tool_places)


def a_zone_holds_as_many_as_it_has_places(plan: Decisions) -> None:
    """At most `capacity` operators are in a zone at once."""
    _share(plan, plan.instance.zone, plan.instance.zone_places)


def kinds_are_kept_apart(plan: Decisions) -> None:
    """In a zone that keeps kinds of operators apart, two tasks by operators of different kinds do
    not overlap, and no task is done by both together.
    """
    instance = plan.instance
    sides: dict[int, list[tuple[int, int, cp_model.IntervalVar]]] = defaultdict(list)
    for task, ways in enumerate(instance.ways if instance.has_apart else ()):
        for way, literal, interval in zip(
            ways, plan.chosen[task], plan.intervals[task], strict=True
        ):
            kinds = instance.sides(task, way)
            if len(kinds) > 1:
                plan.model.add(literal == 0)
            elif kinds:
                zone = instance.zone[task]
                assert zone is not None
                sides[zone].append((task, min(kinds), interval))
    for there in sides.values():
        for (one, kind, first), (two, other, second) in combinations(there, 2):
            if one != two and kind != other:
                plan.model.add_no_overlap([first, second])


def _share(plan: Decisions, needs: tuple[int | None, ...], places: tuple[int, ...]) -> None:
    for thing, capacity in enumerate(places):
        users = [t for t, need in enumerate(needs) if need == thing]
        intervals = [interval for t in users for interval in plan.intervals[t]]
        demands = [len(way.operators) for t in users for way in plan.instance.ways[t]]
        if (
            len(
                {
                    operator
                    for t in users
                    for way in plan.instance.ways[t]
                    for operator in way.operators
                }
            )
            <= capacity
        ):
            continue
        if capacity == 1 and max(demands) == 1:
            plan.model.add_no_overlap(intervals)
        else:
            plan.model.add_cumulative(intervals, demands, capacity)


def a_human_stays_within_the_stress_limit(plan: Decisions) -> None:
    """The stress of all that a human does, alone or with others, is at most their limit."""
    for operator, limit in enumerate(plan.instance.stress_limit):
        if limit is not None:
            plan.model.add(sum(load * x for load, x in loads_of(plan, operator)) <= limit)


def loads_of(plan: Decisions, operator: int) -> list[tuple[int, cp_model.IntVar]]:
    """Units of stress on the operator, and the literal under which they come."""
    return [
        (load, x)
        for chosen, ways in zip(plan.chosen, plan.instance.ways, strict=True)
        for x, way in zip(chosen, ways, strict=True)
        for who, load in zip(way.operators, way.load, strict=True)
        if who == operator and load
    ]


def some_tasks_have_the_same_operators(plan: Decisions) -> None:
    """Tasks of a `same_operator` pair are done by the very same operators."""
    for one, two in plan.instance.same_operator:
        groups: dict[tuple[int, ...], tuple[list[cp_model.IntVar], list[cp_model.IntVar]]] = (
            defaultdict(lambda: ([], []))
        )
        for side, task in enumerate((one, two)):
            for x, way in zip(plan.chosen[task], plan.instance.ways[task], strict=True):
                groups[way.operators][side].append(x)
        for mine, yours in groups.values():
            plan.model.add(sum(mine) == sum(yours))


def stress_is_counted(plan: Decisions) -> None:
    """Stress is the sum over the tasks done by humans, or the value of that set of tasks in the
    cell's table.
    """
    instance, model = plan.instance, plan.model
    table = instance.stress_of_set
    if table is None:
        low = sum(min(way.stress for way in ways) for ways in instance.ways)
        high = sum(max(way.stress for way in ways) for ways in instance.ways)
        plan.stress = model.new_int_var(low, high, "stress")
        model.add(
            plan.stress
            == sum(
                way.stress * x
                for ways, xs in zip(instance.ways, plan.chosen, strict=True)
                for way, x in zip(ways, xs, strict=True)
                if way.stress
            )
        )
        return
    # stress depends on the set as a whole, so a table of whole assignments is the only exact form
    by_human = []
    for ways, chosen in zip(instance.ways, plan.chosen, strict=True):
        human = [
            x
            for x, way in zip(chosen, ways, strict=True)
            if any(instance.human[o] for o in way.operators)
        ]
        literal = model.new_bool_var("")
        model.add(sum(human) == literal)
        by_human.append(literal)
    plan.stress = model.new_int_var(min(table.values()), max(table.values()), "stress")
    rows = [
        [*(int(t in tasks) for t in range(len(instance.tasks))), value]
        for tasks, value in table.items()
    ]
    model.add_allowed_assignments([*by_human, plan.stress], rows)


def the_work_of_an_operator_fits_before_the_end(plan: Decisions) -> None:
    """Implied by the others, but it is what proves optimality: all that an operator does lies
    between the first head and the last tail.
    """
    instance = plan.instance
    for operator in range(len(instance.operators)):
        work = _work_of(plan, operator, range(len(instance.tasks)))
        mine = [t for t in range(len(instance.tasks)) if plan.does(t, operator)]
        if len(mine) > 1:
            earliest = min(instance.head[t] for t in mine)
            after = min(instance.tail[t] - min(way.ticks for way in instance.ways[t]) for t in mine)
            plan.model.add(sum(ticks * x for ticks, x in work) + earliest + after <= plan.makespan)


def work_before_and_behind_a_task_fits(plan: Decisions) -> None:
    """Implied too: what an operator does before a task fits before its start, what it does behind
    the task fits behind its end.
    """
    instance = plan.instance
    ancestors, descendants = (
        closure(instance.before, instance.order),
        closure(instance.behind, instance.order[::-1]),
    )
    if sum(map(len, ancestors)) > MOST_CLOSURE_TERMS:
        return
    for task in range(len(instance.tasks)):
        for operator in range(len(instance.operators)):
            if len(work := _work_of(plan, operator, sorted(ancestors[task]))) > 1:
                plan.model.add(sum(ticks * x for ticks, x in work) <= plan.start[task])
            if len(work := _work_of(plan, operator, sorted(descendants[task]))) > 1:
                plan.model.add(
                    sum((ticks * x for ticks, x in work), plan.end[task]) <= plan.makespan
                )


MOST_CLOSURE_TERMS = 4_000
"""Above so many pairs of a task and one that comes before it, the rows cost more time than they
save.
"""


def _work_of(
    plan: Decisions, operator: int, tasks: Iterable[int]
) -> list[tuple[int, cp_model.IntVar]]:
    return [
        (way.ticks, x)
        for task in tasks
        for x, way in zip(plan.chosen[task], plan.instance.ways[task], strict=True)
        if operator in way.operators
    ]


def closure(direct: tuple[tuple[int, ...], ...], order: Iterable[int]) -> list[set[int]]:
    """Per task, all that is reached by following `direct`, given an order in which what is followed
    comes first.
    """
    reached: list[set[int]] = [set() for _ in direct]
    for task in order:
        for other in direct[task]:
            reached[task] |= {other} | reached[other]
    return reached


RULES: tuple[Rule, ...] = (
    deadlines_are_kept,
    predecessors_end_first,
    an_operator_does_one_thing_at_a_time,
    a_machine_that_holds_a_part_does_nothing_else,
    a_tool_is_used_as_often_as_it_exists,
    a_zone_holds_as_many_as_it_has_places,
    kinds_are_kept_apart,
    a_human_stays_within_the_stress_limit,
    some_tasks_have_the_same_operators,
    stress_is_counted,
    the_work_of_an_operator_fits_before_the_end,
    work_before_and_behind_a_task_fits,
)

ALLOCATION: tuple[Rule, ...] = (
    a_human_stays_within_the_stress_limit,
    some_tasks_have_the_same_operators,
    stress_is_counted,
    the_work_of_an_operator_fits_before_the_end,
)
"""The rules that do not ask for an order: what is left when operators may do several things at
once.
"""
