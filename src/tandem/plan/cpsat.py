"""The cell as a CP-SAT model: the decisions, and one function for each rule of the cell.

The engine's types stay behind this door; `exact.py` and `neighbourhoods.py` ask questions of the
model.

Alternatives share one start and one end per task, every alternative has an interval of fixed size.
OR-Tools is pinned to 9.14 because 9.15.6755 answers such models wrongly;
`tests/plan/test_ortools_pin.py` tells the story.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from importlib.metadata import version
from itertools import combinations, permutations
from typing import NamedTuple

from ortools.sat.python import cp_model

from tandem.plan.instance import Instance
from tandem.plan.starts import Starts

SOLVER = f"cp-sat {version('ortools')}"
"""What proves, by name and version."""
Literal = cp_model.LiteralT


class Preparation(NamedTuple):
    """The operator walks to the task's place or takes up its tool, or both, for so many ticks
    directly before it, when the literal is true; then the interval is present.
    """

    operator: int
    task: int
    ticks: cp_model.IntVar | int
    literal: cp_model.IntVar
    interval: cp_model.IntervalVar


@dataclass
class Decisions:
    """The variables of the model, and how to read them back.

    Attributes:
      start, end: per task, ticks.
      chosen: per task and way, a literal; exactly one per task is true.
      intervals: per task and way, present when the way is chosen.
      at: per operator, the intervals that occupy it.
      preparations: those that may take place.
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
    preparations: list[Preparation] = field(default_factory=list)
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
            if isinstance(end := self.end[task], cp_model.IntVar):
                self.model.add_hint(end, start + self.instance.ways[task][way].ticks)
            for w, x in enumerate(self.chosen[task]):
                if w or len(self.chosen[task]) > 1:
                    self.model.add_hint(x, w == way)


def formulate(
    instance: Instance, upper: int, rules: Iterable[Rule] | None = None, *, own_ends: bool = False
) -> Decisions:
    """The model of the cell for schedules that end by `upper` ticks: its decisions, and every rule
    in `rules` (default: all).

    With `own_ends` an end is a variable of its own, which each alternative ties to the start, so
    that precedence lies between two variables. Else it is the start and a sum over the ways, which
    the linear relaxation sees.
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
        end = _end(plan, task, start, chosen, own_ends)
        intervals = []
        for way, literal in zip(ways, chosen, strict=True):
            # a task with one way needs no literal
            interval = (
                model.new_fixed_size_interval_var(start, way.ticks, "")
                if len(ways) == 1
                else model.new_optional_interval_var(start, way.ticks, end, literal, "")
                if isinstance(end, cp_model.IntVar)
                else model.new_optional_fixed_size_interval_var(start, way.ticks, literal, "")
            )
            intervals.append(interval)
            for operator in way.operators:
                plan.at[operator].append(interval)
        plan.start.append(start)
        plan.chosen.append(chosen)
        plan.intervals.append(intervals)
        plan.end.append(end)
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


def _end(
    plan: Decisions,
    task: int,
    start: cp_model.IntVar,
    chosen: Sequence[cp_model.IntVar],
    own_ends: bool,
) -> cp_model.LinearExprT:
    """When the task ends; a variable where asked for and its ways take unlike times."""
    instance, ways = plan.instance, plan.instance.ways[task]
    quickest, slowest = min(way.ticks for way in ways), max(way.ticks for way in ways)
    if quickest == slowest:
        return start + quickest
    if not own_ends:
        return start + sum(way.ticks * x for way, x in zip(ways, chosen, strict=True))
    first, last = instance.head[task] + quickest, plan.upper - instance.rest[task]
    # where nothing fits, the model is false anyway
    return plan.model.new_int_var(first, max(first, last), f"end {task}")


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


def waits_are_kept(plan: Decisions) -> None:
    """A task starts at least, and at most, so long after what it waits for has ended or started."""
    for lag in plan.instance.lags:
        moment = plan.start[lag.before] if lag.from_start else plan.end[lag.before]
        if lag.least or lag.from_start:
            plan.model.add(moment + lag.least <= plan.start[lag.task])
        if lag.most is not None:
            plan.model.add(plan.start[lag.task] <= moment + lag.most)


def an_operator_does_one_thing_at_a_time(plan: Decisions) -> None:
    """Tasks, breaks, and what an operator needs directly before its tasks do not overlap."""
    for operator in range(len(plan.instance.operators)):
        busy = [*plan.at[operator], *_preparations(plan, operator)]
        busy += [
            plan.model.new_fixed_size_interval_var(begin, end - begin, "")
            for begin, end in plan.instance.breaks[operator]
        ]
        if len(busy) > 1:
            plan.model.add_no_overlap(busy)


Causes = dict[int, list[tuple[int, cp_model.IntVar]]]
"""Task -> (ticks that the operator needs before it, literal under which it does so)."""


def _preparations(plan: Decisions, operator: int) -> list[cp_model.IntervalVar]:
    """The intervals in which the operator walks and takes up other tools, each directly before the
    task for which it does so.
    """
    changes = _changes(plan, operator)
    walks = _walks(plan, operator) if plan.instance.walks[operator] else {}
    found = []
    for task in sorted(changes.keys() | walks.keys()):
        if task in walks:
            found.append(_walked(plan, operator, task, [*walks[task], *changes.get(task, ())]))
            continue
        # a way of doing the task has one tool, so that at most one of these takes place
        for ticks, swap in changes[task]:
            plan.model.add(plan.start[task] >= ticks).only_enforce_if(swap)
            interval = plan.model.new_optional_fixed_size_interval_var(
                plan.start[task] - ticks, ticks, swap, ""
            )
            plan.preparations.append(Preparation(operator, task, ticks, swap, interval))
            found.append(interval)
    return found


def _walked(
    plan: Decisions, operator: int, task: int, causes: list[tuple[int, cp_model.IntVar]]
) -> cp_model.IntervalVar:
    """One interval for all that the operator needs before the task; walking and taking up a tool
    add up.
    """
    model, start = plan.model, plan.start[task]
    some = model.new_bool_var(f"prepares {task} {operator}")
    model.add_max_equality(some, [literal for _, literal in causes])
    ticks = model.new_int_var(0, plan.instance.longest_preparation[operator], "")
    model.add(ticks == sum(ticks * literal for ticks, literal in causes))
    begin = model.new_int_var(0, plan.upper, "")
    interval = model.new_optional_interval_var(begin, ticks, start, some, "")
    plan.preparations.append(Preparation(operator, task, ticks, some, interval))
    return interval


def _changes(plan: Decisions, operator: int) -> Causes:
    """What taking up another tool than the one in hand costs, where it costs anything."""
    instance = plan.instance
    needs = [
        (task, tool, does)
        for task in range(len(instance.tasks))
        for tool, does in _by_tool(plan, task, operator).items()
    ]
    cost = {tool: instance.changeover[tool][operator] for _, tool, _ in needs}
    in_hand = instance.in_hand[operator]
    kinds = cost.keys() | ({in_hand} if in_hand is not None else set())
    # nothing to take up, or at no cost: no order needs to be decided
    if len(kinds) < 2 or not any(cost.values()):
        return {}
    first, follows = _order(plan, [(task, does) for task, _, does in needs])
    found: Causes = defaultdict(list)
    for mine, (task, tool, _) in enumerate(needs):
        causes = [
            follows[before, mine]
            for before, (_, other, _) in enumerate(needs)
            if other != tool and (before, mine) in follows
        ]
        # what is in hand at the beginning is laid down as if a task had needed it
        if in_hand is not None and in_hand != tool:
            causes.append(first[mine])
        if causes and cost[tool]:
            found[task].append((cost[tool], any_of(plan, causes)))
    return found


def _walks(plan: Decisions, operator: int) -> Causes:
    """What the way from the place before costs, where it costs anything."""
    instance = plan.instance
    visits = [
        (task, place, does)
        for task, place in enumerate(instance.place)
        if place is not None and (does := plan.does(task, operator))
    ]
    walk, stands = instance.walk[operator], instance.stands[operator]
    places = {place for _, place, _ in visits} | ({stands} if stands is not None else set())
    if not any(walk[one][other] for one, other in permutations(places, 2)):
        return {}
    first, follows = _order(plan, [(task, does) for task, _, does in visits])
    found: Causes = defaultdict(list)
    for (before, mine), literal in follows.items():
        (_, one, _), (task, other, _) = visits[before], visits[mine]
        if walk[one][other]:
            found[task].append((walk[one][other], literal))
    for (task, place, _), literal in zip(visits, first, strict=True):
        if stands is not None and walk[stands][place]:
            found[task].append((walk[stands][place], literal))
    return found


def _by_tool(plan: Decisions, task: int, operator: int) -> dict[int, list[cp_model.IntVar]]:
    """Tool -> the literals under which the operator needs it for the task."""
    found: dict[int, list[cp_model.IntVar]] = defaultdict(list)
    for x, way in zip(plan.chosen[task], plan.instance.ways[task], strict=True):
        if operator in way.operators and (tool := way.tool(operator)) is not None:
            found[tool].append(x)
    return found


def _order(
    plan: Decisions, visits: Sequence[tuple[int, list[cp_model.IntVar]]]
) -> tuple[list[cp_model.IntVar], dict[tuple[int, int], cp_model.IntVar]]:
    """The order in which an operator makes its visits: literals that say which is the first, and
    which follows directly on which.

    A visit is a task and the literals, of which at most one is true, under which it is made. The
    circuit leaves out, by a loop, those that are not made, and all of them when none is.
    """
    model = plan.model
    nobody = model.new_bool_var("no visit made")
    arcs: list[tuple[int, int, Literal]] = [(0, 0, nobody)]
    first = []
    for index, (_, literals) in enumerate(visits, start=1):
        does = any_of(plan, literals)
        arcs.append((index, index, does.negated()))
        begins, ends = model.new_bool_var(""), model.new_bool_var("")
        arcs += [(0, index, begins), (index, 0, ends)]
        first.append(begins)
        model.add_implication(does, nobody.negated())
    follows = {}
    for (a, (one, _)), (b, (two, _)) in permutations(enumerate(visits), 2):
        if one != two:
            literal = follows[a, b] = model.new_bool_var("")
            arcs.append((a + 1, b + 1, literal))
            model.add(plan.end[one] <= plan.start[two]).only_enforce_if(literal)
    model.add_circuit(arcs)
    return first, follows


def a_machine_that_holds_a_part_does_nothing_else(plan: Decisions) -> None:
    """From the start of the first task of a hold to the end of its last the machine does nothing
    but what lies within it, prepares for nothing else and takes up no other part.
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
            preparation.interval
            for preparation in plan.preparations
            if preparation.operator == operator and instance.barred[hold] >> preparation.task & 1
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
    uses: list[list[Use]] = [[] for _ in plan.instance.tool_places]
    for task, ways in enumerate(plan.instance.ways):
        for way, interval in zip(ways, plan.intervals[task], strict=True):
            for tool, count in way.units:
                who = [o for o, own in zip(way.operators, way.tools, strict=True) if own == tool]
                uses[tool].append(Use(interval, count, who))
    _share(plan, uses, plan.instance.tool_places)


def a_zone_holds_as_many_as_it_has_places(plan: Decisions) -> None:
    """At most `capacity` operators are in a zone at once."""
    uses: list[list[Use]] = [[] for _ in plan.instance.zone_places]
    for task, zone in enumerate(plan.instance.zone):
        if zone is not None:
            uses[zone] += (
                Use(interval, len(way.operators), way.operators)
                for way, interval in zip(
                    plan.instance.ways[task], plan.intervals[task], strict=True
                )
            )
    _share(plan, uses, plan.instance.zone_places)


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


class Use(NamedTuple):
    """The operators `who` take `places` while the interval lasts."""

    interval: cp_model.IntervalVar
    places: int
    who: Sequence[int]


def _share(plan: Decisions, uses: list[list[Use]], places: tuple[int, ...]) -> None:
    for mine, capacity in zip(uses, places, strict=True):
        if len({operator for use in mine for operator in use.who}) <= capacity:
            continue
        intervals = [use.interval for use in mine]
        if capacity == 1 and max(use.places for use in mine) == 1:
            plan.model.add_no_overlap(intervals)
        else:
            plan.model.add_cumulative(intervals, [use.places for use in mine], capacity)


def nobody_takes_more_than_allowed(plan: Decisions) -> None:
    """What all that a person does, alone or with others, takes of an allowance is at most it."""
    for number, allowance in enumerate(plan.instance.allowances):
        terms = [
            due * x
            for chosen, ways in zip(plan.chosen, plan.instance.ways, strict=True)
            for x, way in zip(chosen, ways, strict=True)
            for which, due in way.dues
            if which == number and due
        ]
        plan.model.add(sum(terms) <= allowance.most)


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
            after = min(instance.rest[t] for t in mine)
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
    waits_are_kept,
    an_operator_does_one_thing_at_a_time,
    a_machine_that_holds_a_part_does_nothing_else,
    a_tool_is_used_as_often_as_it_exists,
    a_zone_holds_as_many_as_it_has_places,
    kinds_are_kept_apart,
    nobody_takes_more_than_allowed,
    some_tasks_have_the_same_operators,
    stress_is_counted,
    the_work_of_an_operator_fits_before_the_end,
    work_before_and_behind_a_task_fits,
)

IMPLIED: tuple[Rule, ...] = (
    the_work_of_an_operator_fits_before_the_end,
    work_before_and_behind_a_task_fits,
)
"""The rules that follow from the others: where the load decides they are the proof, elsewhere they
slow the search down.
"""

ALLOCATION: tuple[Rule, ...] = (
    nobody_takes_more_than_allowed,
    some_tasks_have_the_same_operators,
    stress_is_counted,
    the_work_of_an_operator_fits_before_the_end,
)
"""The rules that do not ask for an order: what is left when operators may do several things at
once.
"""
