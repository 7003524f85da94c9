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
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations, permutations
from typing import NamedTuple

from ortools.sat.python import cp_model

from tandem.plan import cpsat
from tandem.plan.cpsat import Decisions, Rule
from tandem.plan.cycle.pattern import Pattern, most_laps
from tandem.plan.instance import Instance

ALLOCATION: tuple[Rule, ...] = (
    cpsat.nobody_takes_more_than_allowed,
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
      then: per task, its place in the cycle after; empty where nothing reaches over the end.
      start: task -> ticks since its product's launch; when laps are not asked, of tied tasks alone,
        since the launch of their own group.
      group: of tied tasks, all whose laps hang together.
      makespan: of one product; None when the laps are not asked.
      at: per operator, the intervals that occupy it, each once a cycle and once more in the next.
      prepared: per operator and task, the intervals in which it gets ready for it; `readying`: how
        many ticks these take.
    """

    instance: Instance
    model: cp_model.CpModel
    allocation: Decisions
    length: cp_model.IntVar
    laps: int | None
    place: list[cp_model.IntVar] = field(default_factory=list)
    then: list[cp_model.LinearExprT] = field(default_factory=list)
    start: dict[int, cp_model.IntVar] = field(default_factory=dict)
    group: dict[int, tuple[int, ...]] = field(default_factory=dict)
    makespan: cp_model.IntVar | None = None
    intervals: list[list[tuple[cp_model.IntervalVar, ...]]] = field(default_factory=list)
    at: dict[int, list[cp_model.IntervalVar]] = field(default_factory=lambda: defaultdict(list))
    prepared: dict[tuple[int, int], list[cp_model.IntervalVar]] = field(
        default_factory=lambda: defaultdict(list)
    )
    readying: dict[tuple[int, int], cp_model.LinearExprT] = field(default_factory=dict)

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
        return self.laps != 1 or self.instance.has_preparations

    def read(self, value: Callable[[cp_model.IntVar], int]) -> Pattern:
        """The pattern that the values describe; by places where the laps are not asked."""
        return tuple(
            (next(w for w, x in enumerate(xs) if value(x)), value(self.start.get(task, place)))
            for task, (xs, place) in enumerate(zip(self.chosen, self.place, strict=True))
        )

    def on_one_clock(self, one: int, other: int) -> bool:
        """Whether the model knows the laps between two tasks."""
        return self.laps is not None or other in self.group.get(one, ())

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
    _no_way_mixes_what_is_kept_apart(plan)
    length = model.new_int_var(1, high, "cycle time")
    cycle = Cycle(instance, model, plan, length, None)
    _work_fits_the_cycle(cycle)
    return cycle


def formulate(instance: Instance, low: int, high: int, laps: int | None) -> Cycle:
    """The whole model for cycle times from `low` to `high` ticks.

    Args:
      laps: a product is in the station for at most so many cycles; None when nothing limits that
        and no start is asked for but those of tied tasks.
    """
    cycle = allocation(instance, high)
    cycle.laps = laps
    if low == high:
        cycle.model.add(cycle.length == low)
    cycle.model.add(cycle.length >= low)
    _places(cycle, low, high)
    for operator in range(len(instance.operators)):
        _get_ready(cycle, operator)
        if len(cycle.at[operator]) > 1:
            cycle.model.add_no_overlap(cycle.at[operator])
    _share(cycle, _uses_of_tools(cycle), instance.tool_places)
    _share(cycle, _uses_of_zones(cycle), instance.zone_places)
    _keep_apart(cycle)
    if laps is not None:
        _laps(cycle, low, high, laps)
    else:
        cycle.group = instance.tied
        for task, group in cycle.group.items():
            _starts(cycle, task, low, high, most_laps(instance, group))
        # any turn of a pattern is as good
        cycle.model.add(cycle.place[0] == 0)
    _predecessors_end_first(cycle)
    _waits_are_kept(cycle)
    _hold_parts(cycle)
    return cycle


# ---------------------------------------------------------------- what bounds the cycle


def _no_way_mixes_what_is_kept_apart(plan: Decisions) -> None:
    """No task is done together by kinds of operators that its zone keeps apart."""
    instance = plan.instance
    for task, ways in enumerate(instance.ways if instance.has_apart else ()):
        for way, literal in zip(ways, plan.chosen[task], strict=True):
            if len(instance.sides(task, way)) > 1:
                plan.model.add(literal == 0)


def _work_fits_the_cycle(cycle: Cycle) -> None:
    """What an operator does for a product fits into a cycle, with what it needs at least to get
    ready; so does what a tool or a zone is used for, by as many as it has room for.
    """
    instance, model = cycle.instance, cycle.model
    for operator in range(len(instance.operators)):
        if work := _work_of(cycle, operator):
            ready = [*_least_changes(cycle, operator), *_least_walks(cycle, operator)]
            model.add(sum([*work, *ready]) <= cycle.length)
    for uses, places in (
        (_taken_of_tools(cycle), instance.tool_places),
        (_taken_of_zones(cycle), instance.zone_places),
    ):
        for used, capacity in zip(uses, places, strict=True):
            if used and capacity < len(instance.operators):
                model.add(sum(used) <= capacity * cycle.length)


def _work_of(cycle: Cycle, operator: int) -> list[cp_model.LinearExprT]:
    """What the operator does for a product, in ticks; a term for each way."""
    return [
        way.ticks * x
        for ways, xs in zip(cycle.instance.ways, cycle.chosen, strict=True)
        for way, x in zip(ways, xs, strict=True)
        if operator in way.operators
    ]


def _taken_of_tools(cycle: Cycle) -> list[list[cp_model.LinearExprT]]:
    """Per tool, ticks times units of it that a product takes; a term for each way."""
    terms: list[list[cp_model.LinearExprT]] = [[] for _ in cycle.instance.tool_places]
    for ways, xs in zip(cycle.instance.ways, cycle.chosen, strict=True):
        for way, x in zip(ways, xs, strict=True):
            for tool, count in way.units:
                terms[tool].append(way.ticks * count * x)
    return terms


def _taken_of_zones(cycle: Cycle) -> list[list[cp_model.LinearExprT]]:
    """The same per zone."""
    terms: list[list[cp_model.LinearExprT]] = [[] for _ in cycle.instance.zone_places]
    for task, zone in enumerate(cycle.instance.zone):
        if zone is not None:
            for way, x in zip(cycle.instance.ways[task], cycle.chosen[task], strict=True):
                terms[zone].append(way.ticks * len(way.operators) * x)
    return terms


def _least_changes(cycle: Cycle, operator: int) -> list[cp_model.LinearExprT]:
    """What the operator needs at least to take up tools in a cycle, ticks."""
    visits = _with_tools(cycle, operator)
    cost = {visit.kind: cycle.instance.changeover[visit.kind][operator] for visit in visits}
    return _least_entries(cycle, visits, cost)


def _least_walks(cycle: Cycle, operator: int) -> list[cp_model.LinearExprT]:
    """What the operator needs at least to walk in a cycle: to each place from the nearest other."""
    visits, walk = _with_places(cycle, operator), cycle.instance.walk[operator]
    places = {visit.kind for visit in visits}
    nearest = {
        place: min((walk[other][place] for other in places - {place}), default=0)
        for place in places
    }
    return _least_entries(cycle, visits, nearest)


def _least_entries(
    cycle: Cycle, visits: Sequence[Visit], cost: Mapping[int, int]
) -> list[cp_model.LinearExprT]:
    """Of two or more kinds of visits that are made in a cycle, each is come to once at least."""
    model = cycle.model
    if len(cost) < 2 or not any(cost.values()):
        return []
    several = model.new_bool_var("")
    used = {kind: model.new_bool_var("") for kind in cost}
    for visit in visits:
        model.add_implication(visit.made, used[visit.kind])
    for one, two in combinations(used.values(), 2):
        model.add_bool_or([one.negated(), two.negated(), several])
    terms: list[cp_model.LinearExprT] = []
    for kind, ticks in cost.items():
        entered = model.new_bool_var("")
        model.add_bool_or([used[kind].negated(), several.negated(), entered])
        terms.append(ticks * entered)
    return terms


# ---------------------------------------------------------------- where in the cycle


def _places(cycle: Cycle, low: int, high: int) -> None:
    """Where in the cycle each task is, and whom it occupies there."""
    instance, model = cycle.instance, cycle.model
    for task, ways in enumerate(instance.ways):
        place = model.new_int_var(0, high - 1, f"place {task}")
        model.add(place < cycle.length)
        starts: list[cp_model.LinearExprT] = [place]
        if cycle.has_copies:
            cycle.then.append(_next_time(cycle, place, low, high))
            starts.append(cycle.then[task])
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


def _next_time(cycle: Cycle, place: cp_model.IntVar, low: int, high: int) -> cp_model.LinearExprT:
    """The same place in the next cycle."""
    if low == high:
        return place + low
    place_then = cycle.model.new_int_var(0, 2 * high, "")
    cycle.model.add(place_then == place + cycle.length)
    return place_then


class Use(NamedTuple):
    """The operators `who` take so many `places` of something while the intervals last."""

    intervals: tuple[cp_model.IntervalVar, ...]
    places: int
    who: Sequence[int]


def _uses_of_tools(cycle: Cycle) -> list[list[Use]]:
    uses: list[list[Use]] = [[] for _ in cycle.instance.tool_places]
    for ways, intervals in zip(cycle.instance.ways, cycle.intervals, strict=True):
        for way, both in zip(ways, intervals, strict=True):
            for tool, count in way.units:
                who = [o for o, own in zip(way.operators, way.tools, strict=True) if own == tool]
                uses[tool].append(Use(both, count, who))
    return uses


def _uses_of_zones(cycle: Cycle) -> list[list[Use]]:
    uses: list[list[Use]] = [[] for _ in cycle.instance.zone_places]
    for task, zone in enumerate(cycle.instance.zone):
        if zone is not None:
            ways = zip(cycle.instance.ways[task], cycle.intervals[task], strict=True)
            uses[zone] += (Use(both, len(way.operators), way.operators) for way, both in ways)
    return uses


def _share(cycle: Cycle, uses: list[list[Use]], places: tuple[int, ...]) -> None:
    """At most `capacity` operators are at a tool or in a zone at once.

    In the second cycle that is laid out each task stands once, with what reaches over from the
    first: there the count is whole.
    """
    for mine, capacity in zip(uses, places, strict=True):
        if len({operator for use in mine for operator in use.who}) <= capacity:
            continue
        intervals = [interval for use in mine for interval in use.intervals]
        demands = [use.places for use in mine for _ in use.intervals]
        if capacity == 1 and max(demands) == 1:
            cycle.model.add_no_overlap(intervals)
        else:
            cycle.model.add_cumulative(intervals, demands, capacity)


def _keep_apart(cycle: Cycle) -> None:
    """In a zone that keeps kinds of operators apart, tasks by different kinds do not overlap."""
    instance = cycle.instance
    there: dict[int, list[tuple[int, int, tuple[cp_model.IntervalVar, ...]]]] = defaultdict(list)
    for task, zone in enumerate(instance.zone if instance.has_apart else ()):
        for way, both in zip(instance.ways[task], cycle.intervals[task], strict=True):
            if zone is not None and len(kinds := instance.sides(task, way)) == 1:
                there[zone].append((task, min(kinds), both))
    for uses in there.values():
        for (one, kind, first), (two, other, second) in combinations(uses, 2):
            if one != two and kind != other:
                cycle.model.add_no_overlap([*first, *second])


# ---------------------------------------------------------------- walking and taking up tools


class Visit(NamedTuple):
    """The operator does the task with this tool, or at this place, when the literal is true."""

    task: int
    kind: int
    made: cp_model.IntVar


def _with_tools(cycle: Cycle, operator: int) -> list[Visit]:
    """The operator's tasks with tools; a task once for each tool that it may need there."""
    found: list[Visit] = []
    for task, ways in enumerate(cycle.instance.ways):
        by_tool: dict[int, list[cp_model.IntVar]] = defaultdict(list)
        for way, x in zip(ways, cycle.chosen[task], strict=True):
            if operator in way.operators and (tool := way.tool(operator)) is not None:
                by_tool[tool].append(x)
        found += (
            Visit(task, tool, cpsat.any_of(cycle.allocation, literals))
            for tool, literals in by_tool.items()
        )
    return found


def _with_places(cycle: Cycle, operator: int) -> list[Visit]:
    """The operator's tasks at places."""
    return [
        Visit(task, place, cpsat.any_of(cycle.allocation, literals))
        for task, place in enumerate(cycle.instance.place)
        if place is not None and (literals := cycle.allocation.does(task, operator))
    ]


Causes = dict[int, list[tuple[int, cp_model.IntVar]]]
"""Task -> (ticks that the operator needs before it, literal under which it does so)."""


def _get_ready(cycle: Cycle, operator: int) -> None:
    """The intervals in which the operator walks and takes up other tools, each directly before the
    task for which it does so; after the last task of a cycle comes the first of the next.
    """
    instance = cycle.instance
    causes: Causes = defaultdict(list)
    change, walk = instance.changeover, instance.walk[operator]
    if instance.has_swaps:
        _around(
            cycle,
            _with_tools(cycle, operator),
            lambda held, tool: 0 if held == tool else change[tool][operator],
            causes,
        )
    if instance.walks[operator]:
        _around(cycle, _with_places(cycle, operator), lambda at, to: walk[at][to], causes)
    work = _work_of(cycle, operator)
    for task, why in causes.items():
        work.append(_occupied_before(cycle, operator, task, why))
    # implied, and seen at once where times are fine
    if causes:
        cycle.model.add(sum(work) <= cycle.length)


def _around(
    cycle: Cycle, visits: Sequence[Visit], ticks: Callable[[int, int], int], causes: Causes
) -> None:
    """The order of the visits around the cycle, and what each costs behind the one before it. The
    circuit leaves out, by a loop, those that are not made, and all of them when none is.

    Args:
      ticks: of a visit of the second kind directly behind one of the first.
    """
    model = cycle.model
    kinds = {visit.kind for visit in visits}
    if not any(ticks(one, other) for one, other in permutations(kinds, 2)):
        return
    nobody = model.new_bool_var("no visit made")
    arcs: list[tuple[int, int, cpsat.Literal]] = [(0, 0, nobody)]
    first, last = [], []
    for index, visit in enumerate(visits, start=1):
        begins, ends = model.new_bool_var(""), model.new_bool_var("")
        arcs += [(index, index, visit.made.negated()), (0, index, begins), (index, 0, ends)]
        first.append(begins)
        last.append(ends)
        model.add_implication(visit.made, nobody.negated())
    for (a, one), (b, two) in permutations(enumerate(visits), 2):
        if one.task == two.task:
            continue
        follows = model.new_bool_var("")
        arcs.append((a + 1, b + 1, follows))
        ended = cycle.place[one.task] + cycle.ticks_of(one.task)  # type: ignore[operator]
        model.add(ended <= cycle.place[two.task]).only_enforce_if(follows)
        if cost := ticks(one.kind, two.kind):
            causes[two.task].append((cost, follows))
    model.add_circuit(arcs)
    _over_the_end(cycle, visits, ticks, first, last, causes)


def _over_the_end(
    cycle: Cycle,
    visits: Sequence[Visit],
    ticks: Callable[[int, int], int],
    first: Sequence[cp_model.IntVar],
    last: Sequence[cp_model.IntVar],
    causes: Causes,
) -> None:
    """The first visit of a cycle lies behind the last one of the cycle before."""
    model = cycle.model
    for begins, visit in zip(first, visits, strict=True):
        behind: dict[int, list[cp_model.IntVar]] = defaultdict(list)
        for ends, other in zip(last, visits, strict=True):
            behind[ticks(other.kind, visit.kind)].append(ends)
        for cost, ends_of in behind.items():
            if cost:
                literal = model.new_bool_var("")
                model.add(begins + sum(ends_of) <= 1 + literal)
                model.add_implication(literal, begins)
                causes[visit.task].append((cost, literal))


def _occupied_before(
    cycle: Cycle, operator: int, task: int, causes: Sequence[tuple[int, cp_model.IntVar]]
) -> cp_model.LinearExprT:
    """The operator's ticks directly before the task, as intervals that occupy it; walking and
    taking up a tool add up. Returns how many they are.
    """
    model, high = cycle.model, cycle.allocation.upper
    some = model.new_bool_var("")
    model.add_max_equality(some, [literal for _, literal in causes])
    spent: cp_model.LinearExprT = sum(ticks * literal for ticks, literal in causes)
    most = cycle.instance.longest_preparation[operator]
    lengths = {ticks for ticks, _ in causes}
    # of changeovers alone one takes place at most, since a way of doing the task has one tool
    is_fixed = len(lengths) == 1 and not cycle.instance.walks[operator]
    length: cp_model.LinearExprT = min(lengths) if is_fixed else model.new_int_var(0, most, "")
    if not is_fixed:
        model.add(length == spent)
    ends = [cycle.place[task], *([cycle.then[task]] if cycle.has_copies else [])]
    for end in ends:
        begin = model.new_int_var(-most, 2 * high, "")
        interval = model.new_optional_interval_var(begin, length, end, some, "")
        cycle.at[operator].append(interval)
        cycle.prepared[operator, task].append(interval)
    cycle.readying[operator, task] = spent
    return spent


# ---------------------------------------------------------------- what a product sees


def _laps(cycle: Cycle, low: int, high: int, laps: int) -> None:
    """Starts are places some laps later, and a product is done within so many cycles."""
    instance, model = cycle.instance, cycle.model
    cycle.makespan = model.new_int_var(0, laps * high, "makespan")
    model.add(cycle.makespan <= laps * cycle.length)
    for task in range(len(instance.tasks)):
        _starts(cycle, task, low, high, laps)
        if not instance.behind[task]:
            model.add(cycle.end(task) <= cycle.makespan)


def _starts(cycle: Cycle, task: int, low: int, high: int, laps: int) -> None:
    """The task's start, some of so many laps behind its place."""
    place = cycle.place[task]
    if laps == 1:
        cycle.start[task] = place
        return
    latest = max(laps * high - (0 if cycle.laps is None else cycle.instance.tail[task]), 0)
    start = cycle.start[task] = cycle.model.new_int_var(0, latest, f"start {task}")
    _is_some_laps_later(cycle, start, place, laps, fixed=low if low == high else None)


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
            if cycle.on_one_clock(first, task):
                cycle.model.add(cycle.end(first) <= cycle.start[task])


def _waits_are_kept(cycle: Cycle) -> None:
    """Within a product, a task starts at least, and at most, so long after what it waits for has
    ended or started.
    """
    for lag in cycle.instance.lags:
        if not cycle.on_one_clock(lag.before, lag.task):
            continue
        moment = cycle.start[lag.before] if lag.from_start else cycle.end(lag.before)
        if lag.least or lag.from_start:
            cycle.model.add(moment + lag.least <= cycle.start[lag.task])
        if lag.most is not None:
            cycle.model.add(cycle.start[lag.task] <= moment + lag.most)


def _hold_parts(cycle: Cycle) -> None:
    """From the start of the first task of a hold to the end of its last the machine does nothing
    but what lies within it, in this product, and takes up no other product's part.
    """
    instance, model = cycle.instance, cycle.model
    spans: list[list[cp_model.IntervalVar]] = []
    within: list[cp_model.IntervalVar] = []
    for hold, (machine, first, last) in enumerate(instance.holds):
        span = _span(cycle, first, last)
        for task, ways in enumerate(instance.ways):
            mine = [
                interval
                for way, both in zip(ways, cycle.intervals[task], strict=True)
                if machine in way.operators
                for interval in both
            ]
            mine += cycle.prepared[machine, task]
            if instance.barred[hold] >> task & 1:
                if mine:
                    model.add_no_overlap([*span, *mine])
            elif (ready := cycle.readying.get((machine, task))) is not None:
                # not while it holds the part of the product before
                begin = cycle.start[task] - ready  # type: ignore[operator]
                model.add(begin >= cycle.end(last) - cycle.length)  # type: ignore[operator]
        # implied: in one product the two do not overlap either, which is seen at once
        own = _own_span(cycle, first, last)
        for other, its in enumerate(spans):
            if instance.rivals[hold] >> other & 1:
                model.add_no_overlap([*span, *its])
                model.add_no_overlap([own, within[other]])
                if first == instance.holds[other][1] or last == instance.holds[other][2]:
                    model.add_bool_or([])  # both at once, however long
        spans.append(span)
        within.append(own)


def _own_span(cycle: Cycle, first: int, last: int) -> cp_model.IntervalVar:
    """The interval of a hold on the product's own clock."""
    laps = cycle.laps or most_laps(cycle.instance, cycle.group[first])
    model, most = cycle.model, (laps + 1) * cycle.allocation.upper
    end, length = model.new_int_var(0, most, ""), model.new_int_var(0, cycle.allocation.upper, "")
    model.add(end == cycle.end(last))
    return model.new_interval_var(cycle.start[first], length, end, "")


def _span(cycle: Cycle, first: int, last: int) -> list[cp_model.IntervalVar]:
    """The intervals of a hold on the cycle, no longer than it."""
    model, high = cycle.model, cycle.allocation.upper
    length = model.new_int_var(0, high, "")
    model.add(length == cycle.end(last) - cycle.start[first])  # type: ignore[operator]
    model.add(length <= cycle.length)
    span = []
    for begin in (cycle.place[first], *([cycle.then[first]] if cycle.has_copies else [])):
        end = model.new_int_var(0, 3 * high, "")
        span.append(model.new_interval_var(begin, length, end, ""))
    return span
