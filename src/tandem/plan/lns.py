"""Large-neighbourhood search: a stretch of the schedule is taken out and planned anew, exactly, by
CP-SAT; the rest keeps its order.

Source: Shaw (1998), "Using constraint programming and local search methods to solve vehicle routing
problems", for the idea; the stretches, and the tails that stand for what comes behind them, are
ours.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from ortools.sat.python import cp_model

from tandem.plan.cpsat import formulate
from tandem.plan.instance import Instance
from tandem.plan.starts import Starts


@dataclass(frozen=True)
class Stretch:
    """Tasks that follow each other in order of start, what is fixed before them and what keeps its
    order behind them.

    Attributes:
      tasks: indices into the whole instance; task `i` of `instance` is `tasks[i]`.
      instance: the stretch as a cell of its own; operators come in when they are free.
      ways: per task, the index of its ways in the whole instance.
      tails: per task and way, ticks of the longest chain behind it.
      floor: ticks; whatever the stretch does, the whole cannot end before.
    """

    tasks: tuple[int, ...]
    instance: Instance
    ways: tuple[tuple[int, ...], ...]
    tails: tuple[tuple[int, ...], ...]
    floor: int


def take_out(
    instance: Instance,
    starts: Starts,
    order: Sequence[int],
    first: int,
    count: int,
    movers: frozenset[int],
) -> Stretch:
    """The stretch of `count` tasks from place `first` of `order`, which sorts the tasks by start.

    Only tasks that now belong to operators in `movers` are planned anew, among them; the others
    keep their operators and their order.
    """
    before, free, behind = order[:first], order[first : first + count], order[first + count :]
    place = {task: i for i, task in enumerate(free)}
    end = {task: starts[task][1] + instance.ways[task][starts[task][0]].ticks for task in before}
    fixed = _Fixed.of(instance, starts, before, end)
    tail, first_of, floor = _tails_behind(instance, starts, behind, end, fixed)
    ways = tuple(_still_open(instance, starts, task, place, movers) for task in free)
    chain = _chains(instance, starts, free, movers)
    release = [
        max(
            [
                instance.release[t],
                *(end[p] for p in instance.before[t] if p in end),
                fixed.tool_free(instance.tool[t]),
                fixed.zone_free(instance.zone[t]),
            ]
        )
        for t in free
    ]
    tails = tuple(
        tuple(
            max(
                [tail[b] for b in instance.behind[t] if b not in place]
                + [first_of.get(o, 0) for o in instance.ways[t][w].operators],
                default=0,
            )
            for w in ways[i]
        )
        for i, t in enumerate(free)
    )
    inside = replace(
        instance,
        tasks=tuple(instance.tasks[t] for t in free),
        ways=tuple(tuple(instance.ways[t][w] for w in ways[i]) for i, t in enumerate(free)),
        before=tuple(
            tuple(place[p] for p in {*instance.before[t], *chain.get(t, ())} if p in place)
            for t in free
        ),
        behind=tuple(tuple(place[b] for b in instance.behind[t] if b in place) for t in free),
        order=tuple(place[t] for t in instance.order if t in place),
        release=tuple(release),
        deadline=tuple(instance.deadline[t] for t in free),
        tool=tuple(instance.tool[t] for t in free),
        zone=tuple(instance.zone[t] for t in free),
        in_hand=fixed.in_hand,
        breaks=fixed.breaks(instance),
        stress_limit=_limits_left(instance, starts, place),
        same_operator=tuple(
            (place[a], place[b]) for a, b in instance.same_operator if a in place and b in place
        ),
        stress_of_set=None,
    )
    return Stretch(tuple(free), inside, ways, tails, floor)


@dataclass(frozen=True)
class _Fixed:
    """What the tasks before a stretch leave behind: when operators, tools and zones are free, and
    the tools in hand.
    """

    free: tuple[int, ...]
    in_hand: tuple[int | None, ...]
    tools: dict[int, int]
    zones: dict[int, int]

    @classmethod
    def of(
        cls, instance: Instance, starts: Starts, before: Sequence[int], end: dict[int, int]
    ) -> _Fixed:
        free, hand = [0] * len(instance.operators), list(instance.in_hand)
        tools: dict[int, int] = {}
        zones: dict[int, int] = {}
        for task in before:
            tool, zone = instance.tool[task], instance.zone[task]
            for operator in instance.ways[task][starts[task][0]].operators:
                free[operator] = max(free[operator], end[task])
                hand[operator] = hand[operator] if tool is None else tool
            if tool is not None and instance.tool_places[tool] < len(instance.operators):
                tools[tool] = max(tools.get(tool, 0), end[task])
            if zone is not None and instance.zone_places[zone] < len(instance.operators):
                zones[zone] = max(zones.get(zone, 0), end[task])
        return cls(tuple(free), tuple(hand), tools, zones)

    def tool_free(self, tool: int | None) -> int:
        return 0 if tool is None else self.tools.get(tool, 0)

    def zone_free(self, zone: int | None) -> int:
        return 0 if zone is None else self.zones.get(zone, 0)

    def breaks(self, instance: Instance) -> tuple[tuple[tuple[int, int], ...], ...]:
        """The operators' breaks, with the time before they are free as one more."""
        return tuple(
            tuple(
                [(0, free)] * (free > 0)
                + [(max(off, free), back) for off, back in breaks if back > free]
            )
            for free, breaks in zip(self.free, instance.breaks, strict=True)
        )


def _tails_behind(
    instance: Instance, starts: Starts, behind: Sequence[int], end: dict[int, int], fixed: _Fixed
) -> tuple[dict[int, int], dict[int, int], int]:
    """Per task behind the stretch the longest chain from its start on, order kept; the same per
    operator; and what `before` makes of it.
    """
    tail: dict[int, int] = {}
    first_of: dict[int, int] = {}
    floor = max(end.values(), default=0)
    for task in reversed(behind):
        way = instance.ways[task][starts[task][0]]
        rest = [tail[b] for b in instance.behind[task]] + [
            first_of.get(o, 0) for o in way.operators
        ]
        tail[task] = way.ticks + max(rest, default=0)
        for operator in way.operators:
            first_of[operator] = tail[task]
        early = max(
            [
                instance.release[task],
                *(end[p] for p in instance.before[task] if p in end),
                *(fixed.free[o] for o in way.operators),
            ]
        )
        floor = max(floor, early + tail[task])
    return tail, first_of, floor


def _still_open(
    instance: Instance, starts: Starts, task: int, place: dict[int, int], movers: frozenset[int]
) -> tuple[int, ...]:
    """The ways in which the task may be done: those among the movers that agree with its
    `same_operator` partners outside the stretch.
    """
    now = starts[task][0]
    if not movers.issuperset(instance.ways[task][now].operators):
        return (now,)
    partners = [b if a == task else a for a, b in instance.same_operator if task in (a, b)]
    teams = [instance.ways[p][starts[p][0]].operators for p in partners if p not in place]
    return tuple(
        w
        for w, way in enumerate(instance.ways[task])
        if movers.issuperset(way.operators) and all(way.operators == team for team in teams)
    )


def _chains(
    instance: Instance, starts: Starts, free: Sequence[int], movers: frozenset[int]
) -> dict[int, list[int]]:
    """Per task, those that come before it because an operator who is not among the movers keeps his
    order.
    """
    last: dict[int, int] = {}
    chain: dict[int, list[int]] = {}
    for task in free:
        for operator in instance.ways[task][starts[task][0]].operators:
            if operator not in movers:
                if operator in last:
                    chain.setdefault(task, []).append(last[operator])
                last[operator] = task
    return chain


def _limits_left(
    instance: Instance, starts: Starts, place: dict[int, int]
) -> tuple[int | None, ...]:
    if not any(limit is not None for limit in instance.stress_limit):
        return instance.stress_limit
    used = [0] * len(instance.operators)
    for task, (way, _) in enumerate(starts):
        if task not in place:
            for operator, load in zip(
                instance.ways[task][way].operators, instance.ways[task][way].load, strict=True
            ):
                used[operator] += load
    return tuple(
        None if limit is None else limit - used[operator]
        for operator, limit in enumerate(instance.stress_limit)
    )


def plan_anew(
    stretch: Stretch, upper: int, *, most_stress: int | None, weights: tuple[int, int], seed: int
) -> tuple[Starts | None, bool]:
    """The stretch's best starts for `weights[0] * makespan + weights[1] * stress` such that the
    whole ends by `upper` ticks.

    `most_stress` limits the stress of the stretch. The starts are None when none were found within
    the work allowed; the flag says whether less than half of it was needed, so that a longer
    stretch may be tried. Work is counted, not timed, so that a run repeats.
    """
    plan = formulate(stretch.instance, upper)
    for task, tails in enumerate(stretch.tails):
        plan.model.add(
            sum(
                (tail * x for tail, x in zip(tails, plan.chosen[task], strict=True)), plan.end[task]
            )
            <= plan.makespan
        )
    plan.model.add(plan.makespan >= stretch.floor)
    if most_stress is not None:
        plan.model.add(plan.stress <= most_stress)
    plan.model.minimize(weights[0] * plan.makespan + weights[1] * plan.stress)
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    solver.parameters.max_deterministic_time = WORK
    solver.parameters.random_seed = seed
    solver.parameters.catch_sigint_signal = False
    solver.parameters.symmetry_level = 0
    status = solver.solve(plan.model)
    easy = solver.response_proto.deterministic_time < 0.5 * WORK
    return plan.read(solver.value) if status in (
        cp_model.OPTIMAL,
        cp_model.FEASIBLE,
    ) else None, easy  # type: ignore[comparison-overlap]


WORK = 0.1
"""CP-SAT's deterministic seconds for one stretch."""
