"""Large-neighbourhood search: a stretch of the schedule is taken out and planned anew, exactly, by
CP-SAT; the rest keeps its order.

Source: Shaw (1998), "Using constraint programming and local search methods to solve vehicle routing
problems", for the idea; the stretches, and the tails that stand for what comes behind them, are
ours.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from ortools.sat.python import cp_model

from tandem.plan.cpsat import formulate
from tandem.plan.instance import Instance, Lag, Way, bits
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
      start_by: per task, ticks by which it must start, for what is fixed before it; or None.
      floor: ticks; whatever the stretch does, the whole cannot end before.
    """

    tasks: tuple[int, ...]
    instance: Instance
    ways: tuple[tuple[int, ...], ...]
    tails: tuple[tuple[int, ...], ...]
    start_by: tuple[int | None, ...]
    floor: int


def take_out(
    instance: Instance,
    starts: Starts,
    order: Sequence[int],
    first: int,
    count: int,
    movers: frozenset[int],
) -> Stretch:
    """The stretch of `count` tasks from index `first` of `order`, which sorts the tasks by start.

    Only tasks that now belong to operators in `movers` are planned anew, among them; the others
    keep their operators and their order.
    """
    cut = _Cut(
        instance,
        starts,
        before=tuple(order[:first]),
        free=tuple(order[first : first + count]),
        behind=tuple(order[first + count :]),
    )
    fixed = _Fixed.of(cut)
    ways = tuple(_still_open(cut, task, movers) for task in cut.free)
    # What is behind the stretch keeps its order, and follows it as a chain of known length.
    tail, first_of = _tails_behind(cut)
    tails = tuple(
        tuple(_longest_behind(cut, task, way, tail, first_of) for way in row)
        for task, row in zip(cut.free, ways, strict=True)
    )
    # Who does not move keeps the order of their tasks: one comes before the next.
    chain = _chains(cut, movers)
    inside = instance.restricted(
        cut.free,
        [[instance.ways[t][w] for w in row] for t, row in zip(cut.free, ways, strict=True)],
        [fixed.release(cut, task) for task in cut.free],
        before=[dict.fromkeys((*instance.before[t], *chain.get(t, ()))) for t in cut.free],
        in_hand=fixed.in_hand,
        stands=fixed.stands,
        breaks=fixed.breaks(instance),
        allowances=instance.allowances_left(
            instance.taken(cut.way(task) for task in (*cut.before, *cut.behind))
        ),
        **instance.still_held(cut.free, bits(cut.before)),
    )
    start_by = tuple(cut.start_by(task) for task in cut.free)
    return Stretch(cut.free, inside, ways, tails, start_by, _floor(cut, fixed, tail))


@dataclass(frozen=True)
class _Cut:
    """A schedule in three parts: tasks before the stretch, those in it, and those behind it."""

    instance: Instance
    starts: Starts
    before: tuple[int, ...]
    free: tuple[int, ...]
    behind: tuple[int, ...]

    def way(self, task: int) -> Way:
        """The way in which the schedule does the task."""
        return self.instance.ways[task][self.starts[task][0]]

    @cached_property
    def end(self) -> dict[int, int]:
        """Ticks of each task before the stretch."""
        return {task: self.starts[task][1] + self.way(task).ticks for task in self.before}

    @cached_property
    def stretch(self) -> frozenset[int]:
        """The tasks in the stretch."""
        return frozenset(self.free)

    def predecessors_end(self, task: int) -> int:
        """Ticks by which its predecessors before the stretch have ended, and the least waits after
        them are over.
        """
        ends = [self.end[p] for p in self.instance.before[task] if p in self.end]
        return max([*ends, *(moment + lag.least for lag, moment in self.waits(task))], default=0)

    def waits(self, task: int) -> list[tuple[Lag, int]]:
        """The task's waits after tasks before the stretch, and the ticks they are counted from."""
        if not self.instance.has_lags:
            return []
        return [
            (lag, self.starts[lag.before][1] if lag.from_start else self.end[lag.before])
            for lag in self.instance.lags_into[task]
            if lag.before in self.end
        ]

    def start_by(self, task: int) -> int | None:
        """Ticks by which the task must start, for its waits after tasks before the stretch."""
        return min(
            (moment + lag.most for lag, moment in self.waits(task) if lag.most is not None),
            default=None,
        )


@dataclass(frozen=True)
class _Fixed:
    """What the tasks before a stretch leave behind.

    Attributes:
      free: per operator, when they are free. `in_hand`: their tools; `stands`: where they are.
      tools, zones: when those are free that do not have room for all, or keep operators apart.
    """

    free: tuple[int, ...]
    in_hand: tuple[int | None, ...]
    stands: tuple[int | None, ...]
    tools: dict[int, int]
    zones: dict[int, int]

    @classmethod
    def of(cls, cut: _Cut) -> _Fixed:
        instance = cut.instance
        free, hand = [0] * len(instance.operators), list(instance.in_hand)
        stands = list(instance.stands)
        tools: dict[int, int] = {}
        zones: dict[int, int] = {}
        for task in cut.before:
            way, zone, end = cut.way(task), instance.zone[task], cut.end[task]
            place = instance.place[task]
            for operator, tool in zip(way.operators, way.tools, strict=True):
                free[operator] = max(free[operator], end)
                hand[operator] = hand[operator] if tool is None else tool
                stands[operator] = stands[operator] if place is None else place
            for hold in instance.held_until[task]:
                free[instance.holds[hold][0]] = max(free[instance.holds[hold][0]], end)
            for tool, _ in instance.scarce(way):
                tools[tool] = max(tools.get(tool, 0), end)
            if zone is not None and (instance.zone_room[zone] or instance.keeps_apart[zone]):
                zones[zone] = max(zones.get(zone, 0), end)
        return cls(tuple(free), tuple(hand), tuple(stands), tools, zones)

    def release(self, cut: _Cut, task: int) -> int:
        """Ticks before which a task of the stretch finds no room, or waits for what is before."""
        zone = cut.instance.zone[task]
        return max(
            cut.instance.release[task],
            cut.predecessors_end(task),
            # in some way its tools are there
            min(
                max((self.tools.get(tool, 0) for tool, _ in way.units), default=0)
                for way in cut.instance.ways[task]
            ),
            0 if zone is None else self.zones.get(zone, 0),
            *(self.free[cut.instance.holds[hold][0]] for hold in cut.instance.held_from[task]),
        )

    def breaks(self, instance: Instance) -> tuple[tuple[tuple[int, int], ...], ...]:
        """The operators' breaks, with the time before they are free as one more."""
        return tuple(
            tuple(
                [(0, free)] * (free > 0)
                + [(max(off, free), back) for off, back in breaks if back > free]
            )
            for free, breaks in zip(self.free, instance.breaks, strict=True)
        )


def _tails_behind(cut: _Cut) -> tuple[dict[int, int], dict[int, int]]:
    """Ticks from the start of a task behind the stretch to the end of all, the order kept.

    Per task, and per operator of their first task there.
    """
    tail: dict[int, int] = {}
    first_of: dict[int, int] = {}
    for task in reversed(cut.behind):
        way = cut.way(task)
        tail[task] = way.ticks + _longest_behind(cut, task, cut.starts[task][0], tail, first_of)
        for operator in way.operators:
            first_of[operator] = tail[task]
    return tail, first_of


def _longest_behind(
    cut: _Cut, task: int, way: int, tail: dict[int, int], first_of: dict[int, int]
) -> int:
    """Ticks of the longest chain behind the task, done in this way, of tasks behind the stretch."""
    successors = [tail[b] for b in cut.instance.behind[task] if b in tail]
    if cut.instance.has_lags:
        waits = (lag for lag in cut.instance.lags_from[task] if not lag.from_start)
        successors += [lag.least + tail[lag.task] for lag in waits if lag.task in tail]
    same_operators = [first_of.get(o, 0) for o in cut.instance.ways[task][way].operators]
    return max([*successors, *same_operators], default=0)


def _floor(cut: _Cut, fixed: _Fixed, tail: dict[int, int]) -> int:
    """Ticks before which the whole cannot end, for the sake of what is not in the stretch."""
    floor = max(cut.end.values(), default=0)
    for task in cut.behind:
        operators = [fixed.free[o] for o in cut.way(task).operators]
        early = max(cut.instance.release[task], cut.predecessors_end(task), *operators)
        floor = max(floor, early + tail[task])
    return floor


def _still_open(cut: _Cut, task: int, movers: frozenset[int]) -> tuple[int, ...]:
    """The ways in which the task may be done.

    Those among the movers that agree with its `same_operator` partners outside the stretch.
    """
    if not movers.issuperset(cut.way(task).operators):
        return (cut.starts[task][0],)
    pairs = [pair for pair in cut.instance.same_operator if task in pair]
    outside = [other for pair in pairs for other in pair if other not in cut.stretch]
    teams = [cut.way(partner).operators for partner in outside]
    return tuple(
        number
        for number, way in enumerate(cut.instance.ways[task])
        if movers.issuperset(way.operators) and all(way.operators == team for team in teams)
    )


def _chains(cut: _Cut, movers: frozenset[int]) -> dict[int, list[int]]:
    """Per task, those that come before it because an operator who does not move keeps his order."""
    last: dict[int, int] = {}
    chain: dict[int, list[int]] = {}
    for task in cut.free:
        for operator in cut.way(task).operators:
            if operator not in movers:
                if operator in last:
                    chain.setdefault(task, []).append(last[operator])
                last[operator] = task
    return chain


def plan_anew(
    stretch: Stretch, upper: int, *, most_stress: int | None, weights: tuple[int, int], seed: int
) -> tuple[Starts | None, float]:
    """The stretch's best starts for `weights[0] * makespan + weights[1] * stress` such that the
    whole ends by `upper` ticks.

    `most_stress` limits the stress of the stretch. The starts are None when none were found within
    the work allowed, which is `WORK`; how much of it was done is said, too. Work is counted, not
    timed, so that a run repeats.
    """
    plan = formulate(stretch.instance, upper)
    for task, tails in enumerate(stretch.tails):
        plan.model.add(
            sum(
                (tail * x for tail, x in zip(tails, plan.chosen[task], strict=True)), plan.end[task]
            )
            <= plan.makespan
        )
    for start, latest in zip(plan.start, stretch.start_by, strict=True):
        if latest is not None:
            plan.model.add(start <= latest)
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
    found = status in (cp_model.OPTIMAL, cp_model.FEASIBLE)  # type: ignore[comparison-overlap]
    return plan.read(solver.value) if found else None, solver.response_proto.deterministic_time


WORK = 0.1
"""CP-SAT's deterministic seconds for one stretch."""
