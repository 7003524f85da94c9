"""The station that repeats as a CP-SAT model: periodic scheduling, one product launched a cycle.

A task starts `lap * cycle_time + place` after its own product's launch, `0 <= place < cycle_time`.
What operators, tools and zones see is the place alone: each task is there once a cycle, around the
end of the cycle where it is longer than what is left of it. What a product sees is the start. The
two hang together by whole laps; how many there may be is how many products are in process.

As long as nothing limits the products in process, a task can always wait for a lap more, and the
laps say nothing about the cycle time: then the places alone are asked (`laps` None). The form is
that of Serafini and Ukovich (1989), A mathematical model for periodic scheduling problems.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import combinations, permutations

from ortools.sat.python import cp_model

from tandem.plan import cpsat
from tandem.plan.cpsat import Decisions, Rule
from tandem.plan.cycle.pattern import Pattern
from tandem.plan.instance import Instance

ALLOCATION: tuple[Rule, ...] = (
    cpsat.a_human_stays_within_the_stress_limit,
    cpsat.some_tasks_have_the_same_operators,
    cpsat.stress_is_counted,
)
"""The rules of a cell that ask for no time."""


@dataclass
class Cycle:
    """The variables of the model, and how to read them back.

    Attributes:
      allocation: who does what; its `chosen` and `stress` are used here.
      length: the cycle time, ticks.
      place: per task, where in the cycle it starts, ticks.
      start: per task, ticks since its product's launch; empty when the laps are not asked.
      makespan: of one product; None when the laps are not asked.
      at: per operator, the intervals that occupy it, each once a cycle and once more in the next.
    """

    instance: Instance
    model: cp_model.CpModel
    allocation: Decisions
    length: cp_model.IntVar
    laps: int | None
    place: list[cp_model.IntVar] = field(default_factory=list)
    start: list[cp_model.IntVar] = field(default_factory=list)
    makespan: cp_model.IntVar | None = None
    intervals: list[list[tuple[cp_model.IntervalVar, ...]]] = field(default_factory=list)
    at: dict[int, list[cp_model.IntervalVar]] = field(default_factory=lambda: defaultdict(list))

    @property
    def chosen(self) -> list[list[cp_model.IntVar]]:
        """Per task and way, a literal; exactly one per task is true."""
        return self.allocation.chosen

    @property
    def stress(self) -> cp_model.IntVar:
        """Units, of one product."""
        return self.allocation.stress

    @property
    def has_copies(self) -> bool:
        """Something may reach over the end of the cycle, so that the next one is looked at too."""
        return self.laps != 1 or self.instance.has_swaps

    def read(self, value: Callable[[cp_model.IntVar], int]) -> Pattern:
        """The pattern that the values describe; by places when the laps are not asked."""
        when = self.start or self.place
        return tuple(
            (next(w for w, x in enumerate(self.chosen[t]) if value(x)), value(when[t]))
            for t in range(len(when))
        )

    def end(self, task: int) -> cp_model.LinearExprT:
        """Ticks since its product's launch."""
        return self.start[task] + self.ticks_of(task)  # type: ignore[operator]

    def ticks_of(self, task: int) -> cp_model.LinearExprT:
        """How long the task takes in the way that is chosen."""
        ways = self.instance.ways[task]
        if len(ways) == 1:
            return ways[0].ticks
        ticks: cp_model.LinearExprT = sum(
            way.ticks * x for way, x in zip(ways, self.chosen[task], strict=True)
        )
        return ticks


def allocation(instance: Instance, high: int) -> Cycle:
    """The part that asks for no order: who does what, and the cycle time that the work of each
    operator needs.
    """
    model = cp_model.CpModel()
    plan = Decisions(model, instance, high)
    for task, ways in enumerate(instance.ways):
        if len(ways) > 1:
            plan.chosen.append([model.new_bool_var(f"way {task} {w}") for w in range(len(ways))])
            model.add_exactly_one(plan.chosen[task])
        else:
            plan.chosen.append([model.new_constant(1)])
    for rule in ALLOCATION:
        rule(plan)
    length = model.new_int_var(1, high, "cycle time")
    cycle = Cycle(instance, model, plan, length, None)
    _work_fits_the_cycle(cycle)
    return cycle


def formulate(instance: Instance, low: int, high: int, laps: int | None) -> Cycle:
    """The whole model for cycle times from `low` to `high` ticks.

    Args:
      laps: a product is in the station for at most so many cycles; None when nothing limits that
        and no start is asked for.
    """
    cycle = allocation(instance, high)
    cycle.laps = laps
    if low == high:
        cycle.model.add(cycle.length == low)
    cycle.model.add(cycle.length >= low)
    _places(cycle, low, high)
    for operator in range(len(instance.operators)):
        _take_up_tools(cycle, operator)
        if len(cycle.at[operator]) > 1:
            cycle.model.add_no_overlap(cycle.at[operator])
    _share(cycle, instance.tool, instance.tool_places)
    _share(cycle, instance.zone, instance.zone_places)
    if laps is not None:
        _laps(cycle, low, high, laps)
        _predecessors_end_first(cycle)
    else:
        # any turn of a pattern is as good
        cycle.model.add(cycle.place[0] == 0)
    return cycle


def _work_fits_the_cycle(cycle: Cycle) -> None:
    """What an operator does for a product fits into a cycle; so does what a tool or a zone is used
    for, by as many as it has room for.
    """
    instance, model = cycle.instance, cycle.model
    for operator in range(len(instance.operators)):
        if work := _work_of(cycle, operator):
            model.add(sum([*work, *_least_changes(cycle, operator)]) <= cycle.length)
    for needs, places in (
        (instance.tool, instance.tool_places),
        (instance.zone, instance.zone_places),
    ):
        for thing, capacity in enumerate(places):
            used = [
                way.ticks * len(way.operators) * x
                for task, need in enumerate(needs)
                if need == thing
                for way, x in zip(instance.ways[task], cycle.chosen[task], strict=True)
            ]
            if used and capacity < len(instance.operators):
                model.add(sum(used) <= capacity * cycle.length)


def _next_time(cycle: Cycle, place: cp_model.IntVar, low: int, high: int) -> cp_model.LinearExprT:
    """The same place in the next cycle."""
    if low == high:
        return place + low
    place_then = cycle.model.new_int_var(0, 2 * high, "")
    cycle.model.add(place_then == place + cycle.length)
    return place_then


def _work_of(cycle: Cycle, operator: int) -> list[cp_model.LinearExprT]:
    """What the operator does for a product, in ticks; a term for each way."""
    return [
        way.ticks * x
        for ways, xs in zip(cycle.instance.ways, cycle.chosen, strict=True)
        for way, x in zip(ways, xs, strict=True)
        if operator in way.operators
    ]


def _least_changes(cycle: Cycle, operator: int) -> list[cp_model.LinearExprT]:
    """What the operator needs at least to take up tools in a cycle: of two or more kinds, each is
    taken up once.
    """
    instance, model = cycle.instance, cycle.model
    kinds: dict[int, list[cp_model.IntVar]] = defaultdict(list)
    for task, tool in enumerate(instance.tool):
        if tool is not None:
            kinds[tool] += cycle.allocation.does(task, operator)
    kinds = {tool: literals for tool, literals in kinds.items() if literals}
    if len(kinds) < 2 or not any(instance.changeover[tool][operator] for tool in kinds):
        return []
    several = model.new_bool_var("")
    used = {tool: model.new_bool_var("") for tool in kinds}
    terms: list[cp_model.LinearExprT] = []
    for tool, literals in kinds.items():
        for literal in literals:
            model.add_implication(literal, used[tool])
        taken_up = model.new_bool_var("")
        model.add_bool_or([used[tool].negated(), several.negated(), taken_up])
        terms.append(instance.changeover[tool][operator] * taken_up)
    for one, two in combinations(used.values(), 2):
        model.add_bool_or([one.negated(), two.negated(), several])
    return terms


def _places(cycle: Cycle, low: int, high: int) -> None:
    """Where in the cycle each task is, and whom it occupies there."""
    instance, model = cycle.instance, cycle.model
    for task, ways in enumerate(instance.ways):
        place = model.new_int_var(0, high - 1, f"place {task}")
        model.add(place < cycle.length)
        starts: list[cp_model.LinearExprT] = [place]
        if cycle.has_copies:
            starts.append(_next_time(cycle, place, low, high))
        cycle.place.append(place)
        cycle.intervals.append([])
        for way, literal in zip(ways, cycle.chosen[task], strict=True):
            intervals = tuple(
                model.new_optional_fixed_size_interval_var(start, way.ticks, literal, "")
                for start in starts
            )
            cycle.intervals[task].append(intervals)
            for operator in way.operators:
                cycle.at[operator] += intervals


def _share(cycle: Cycle, needs: tuple[int | None, ...], places: tuple[int, ...]) -> None:
    """At most `capacity` operators are at a tool or in a zone at once.

    In the second cycle that is laid out each task stands once, with what reaches over from the
    first: there the count is whole.
    """
    instance = cycle.instance
    for thing, capacity in enumerate(places):
        users = [
            (intervals, way)
            for task, need in enumerate(needs)
            if need == thing
            for intervals, way in zip(cycle.intervals[task], instance.ways[task], strict=True)
        ]
        if len({operator for _, way in users for operator in way.operators}) <= capacity:
            continue
        intervals = [interval for both, _ in users for interval in both]
        demands = [len(way.operators) for both, way in users for _ in both]
        if capacity == 1 and max(demands) == 1:
            cycle.model.add_no_overlap(intervals)
        else:
            cycle.model.add_cumulative(intervals, demands, capacity)


def _take_up_tools(cycle: Cycle, operator: int) -> None:
    """The intervals in which the operator takes up another tool, directly before the task that
    needs it; after the last task of a cycle comes the first of the next.
    """
    instance, model = cycle.instance, cycle.model
    does = {
        task: cpsat.any_of(cycle.allocation, literals)
        for task, tool in enumerate(instance.tool)
        if tool is not None and (literals := cycle.allocation.does(task, operator))
    }
    cost = {task: instance.changeover[instance.tool[task]][operator] for task in does}  # type: ignore[index]
    if len({instance.tool[task] for task in does}) < 2 or not any(cost.values()):
        return
    tasks = list(does)
    nobody = model.new_bool_var("no tool used")
    arcs: list[tuple[int, int, cpsat.Literal]] = [(0, 0, nobody)]
    first, last, into = {}, {}, {task: [] for task in tasks}  # type: ignore[var-annotated]
    for index, task in enumerate(tasks, start=1):
        first[task], last[task] = model.new_bool_var(""), model.new_bool_var("")
        arcs += [(index, index, does[task].negated()), (0, index, first[task])]
        arcs.append((index, 0, last[task]))
        model.add_implication(does[task], nobody.negated())
    for (i, one), (j, two) in permutations(enumerate(tasks, start=1), 2):
        follows = model.new_bool_var("")
        arcs.append((i, j, follows))
        ended = cycle.place[one] + cycle.ticks_of(one)  # type: ignore[operator]
        model.add(ended <= cycle.place[two]).only_enforce_if(follows)
        if instance.tool[one] != instance.tool[two]:
            into[two].append(follows)
    model.add_circuit(arcs)
    _around_the_cycle(cycle, tasks, first, last, into)
    work = _work_of(cycle, operator)
    for task in tasks:
        if into[task] and cost[task]:
            swap = model.new_bool_var("")
            model.add(sum(into[task]) <= swap)
            _occupied_before(cycle, operator, task, cost[task], swap)
            work.append(cost[task] * swap)
    # implied, and seen at once where times are fine
    model.add(sum(work) <= cycle.length)


def _around_the_cycle(
    cycle: Cycle,
    tasks: list[int],
    first: dict[int, cp_model.IntVar],
    last: dict[int, cp_model.IntVar],
    into: dict[int, list[cp_model.IntVar]],
) -> None:
    """The first task with a tool in a cycle finds in hand what the last one of the cycle before
    needed.
    """
    model, tool = cycle.model, cycle.instance.tool
    for task in tasks:
        others = [last[other] for other in tasks if tool[other] != tool[task]]
        if others:
            swap = model.new_bool_var("")
            model.add(first[task] + sum(others) <= 1 + swap)
            model.add_implication(swap, first[task])
            into[task].append(swap)


def _occupied_before(
    cycle: Cycle, operator: int, task: int, ticks: int, literal: cp_model.IntVar
) -> None:
    """The operator has so many ticks to do directly before the task, when the literal is true."""
    model = cycle.model
    begin = cycle.place[task] - ticks
    for offset in (0, 1) if cycle.has_copies else (0,):
        start = model.new_int_var(-ticks, 2 * cycle.allocation.upper, "")
        model.add(start == begin + offset * cycle.length)
        cycle.at[operator].append(
            model.new_optional_fixed_size_interval_var(start, ticks, literal, "")
        )


def _laps(cycle: Cycle, low: int, high: int, laps: int) -> None:
    """Starts are places some laps later, and a product is done within so many cycles."""
    instance, model = cycle.instance, cycle.model
    cycle.makespan = model.new_int_var(0, laps * high, "makespan")
    model.add(cycle.makespan <= laps * cycle.length)
    for task in range(len(instance.tasks)):
        place = cycle.place[task]
        if laps == 1:
            start = place
        else:
            latest = max(laps * high - instance.tail[task], 0)
            start = model.new_int_var(0, latest, f"start {task}")
            _is_some_laps_later(cycle, start, place, laps, fixed=low if low == high else None)
        cycle.start.append(start)
        if not instance.behind[task]:
            model.add(cycle.end(task) <= cycle.makespan)


def _is_some_laps_later(
    cycle: Cycle, start: cp_model.IntVar, place: cp_model.IntVar, laps: int, fixed: int | None
) -> None:
    """`start = place + lap * cycle time`: linear for a fixed cycle time, and for each lap."""
    model = cycle.model
    if fixed is not None:
        model.add(start == place + fixed * model.new_int_var(0, laps - 1, ""))
        return
    each = [model.new_bool_var("") for _ in range(laps)]
    model.add_exactly_one(each)
    for lap, literal in enumerate(each):
        model.add(start == place + lap * cycle.length).only_enforce_if(literal)


def _predecessors_end_first(cycle: Cycle) -> None:
    """Within a product, a task starts when all that it comes after have ended."""
    for task, firsts in enumerate(cycle.instance.before):
        for first in firsts:
            cycle.model.add(cycle.end(first) <= cycle.start[task])
