"""From an order and a choice of ways to times: list scheduling with every feature of a cell.

Each task is appended: it starts as early as it can behind what its operators have been given
before, when its predecessors have ended, its tool and its place in the zone are given back, and no
break is in the way. Appending the tasks of any schedule in the order of their starts, in the same
ways, gives a schedule in which no task ends later; so some order leads to an optimum of makespan
and stress.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from tandem.plan.instance import Instance, Preparation, Way


class Step(NamedTuple):
    """A way of doing a task that can be part of a schedule.

    Attributes:
      way: its index in `Instance.ways`.
      operators: indices; `ticks` its duration; `stress` the sum of `load`, the stress per operator.
      preparations: `(operator, what it needs before the task)`, of those who need a tool or a place
        for it that may cost time.
      scarce: `(tool, how many of it)`, of the tools that not all can have at once.
    """

    way: int
    operators: tuple[int, ...]
    ticks: int
    stress: int
    load: tuple[int, ...]
    preparations: tuple[tuple[int, Preparation], ...]
    scarce: tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class Layout:
    """An instance with those of its ways that a search may take.

    Attributes:
      steps: per task, its ways without those that need more of a tool or a zone than there is,
        without those that a partner in `same_operator` lacks, and without those that differ from
        another one in more stress alone.
    """

    instance: Instance
    steps: tuple[tuple[Step, ...], ...]

    @classmethod
    def of(cls, instance: Instance) -> Layout:
        """The instance's layout. A task that nobody can do has no steps."""
        steps = [_steps(instance, task) for task in range(len(instance.tasks))]
        return cls(instance, tuple(map(tuple, _shared_by_teams(instance.team, steps))))

    @cached_property
    def quickest(self) -> tuple[int, ...]:
        """Per task, ticks of its quickest step."""
        return tuple(min((step.ticks for step in row), default=0) for row in self.steps)

    @cached_property
    def tail(self) -> tuple[int, ...]:
        """Per task, ticks on the longest chain that starts with it, each task at its quickest."""
        return self.instance.chains(self.quickest)

    @cached_property
    def behind(self) -> tuple[int, ...]:
        """Per task, ticks on the longest chain behind it."""
        return tuple(tail - own for tail, own in zip(self.tail, self.quickest, strict=True))

    @cached_property
    def easiest(self) -> tuple[int, ...]:
        """Per task, units of stress of its easiest step."""
        return tuple(min((step.stress for step in row), default=0) for row in self.steps)

    @cached_property
    def must(self) -> tuple[tuple[int, ...], ...]:
        """Per task and operator, the least stress that any step of the task puts on them."""
        operators = range(len(self.instance.operators))
        return tuple(
            tuple(min((_load(step, o) for step in row), default=0) for o in operators)
            for row in self.steps
        )

    def latest_ends(self, most: int) -> list[int]:
        """Per task, ticks by which it must have ended so that deadlines and `most` can be kept."""
        instance, latest = self.instance, [most] * len(self.steps)
        for task in reversed(instance.order):
            deadline = instance.deadline[task]
            afters = (latest[after] - self.quickest[after] for after in instance.behind[task])
            latest[task] = min([most if deadline is None else min(deadline, most), *afters])
        return latest

    def with_humans_at(self, tasks: Collection[int]) -> Layout:
        """The layout in which humans take part in these tasks and in no other."""
        human = self.instance.human
        steps = tuple(
            tuple(step for step in row if any(human[o] for o in step.operators) == (task in tasks))
            for task, row in enumerate(self.steps)
        )
        return Layout(self.instance, steps)

    def impossible(self) -> list[int]:
        """Tasks without any step: nobody can do them here."""
        return [task for task, row in enumerate(self.steps) if not row]


class PartialSchedule:
    """A schedule in the making: tasks are put behind each other and never moved.

    Attributes:
      start, end: ticks per task, -1 while it is not placed; `way` its way in `Instance.ways`.
      free: per operator, the end of the last task.
      stance: per operator, what it has in hand, see `Instance.stance`.
      ready: per task, the latest of its release and the ends of its placed predecessors; `waiting`
        counts the others.
      load: stress per operator so far; `stress` their sum.
      need: per operator, stress that the tasks not yet placed put on them at least.
    """

    __slots__ = (
        "end",
        "free",
        "instance",
        "layout",
        "load",
        "need",
        "operators_of",
        "ready",
        "stance",
        "start",
        "stress",
        "tool_free",
        "waiting",
        "way",
        "zone_free",
    )

    def __init__(self, layout: Layout) -> None:
        instance = layout.instance
        tasks, operators = len(instance.tasks), len(instance.operators)
        self.layout, self.instance = layout, instance
        self.start, self.end, self.way = [-1] * tasks, [-1] * tasks, [-1] * tasks
        self.free = [0] * operators
        self.stance = list(instance.stances)
        self.ready = list(instance.release)
        self.waiting = [len(before) for before in instance.before]
        self.tool_free = [[0] * places for places in instance.tool_room]
        self.zone_free = [[0] * places for places in instance.zone_room]
        self.operators_of: dict[int, tuple[int, ...]] = {}
        self.load = [0] * operators
        self.stress = 0
        self.need = (
            [sum(row[o] for row in layout.must) for o in range(operators)]
            if instance.has_limits
            else [0] * operators
        )

    def steps(self, task: int) -> tuple[Step, ...]:
        """The task's steps that keep stress limits and stay with the operators of its team. May be
        empty.
        """
        instance, steps = self.instance, self.layout.steps[task]
        team = instance.team[task]
        if team >= 0 and (operators := self.operators_of.get(team)) is not None:
            steps = tuple(step for step in steps if step.operators == operators)
        if instance.has_limits:
            steps = tuple(step for step in steps if self._within_limits(task, step))
        return steps

    def earliest(self, task: int, step: Step) -> int:
        """The earliest tick at which the task can start in this way, appended to what is placed."""
        start, free, instance = self.ready[task], self.free, self.instance
        if instance.is_plain:
            for operator in step.operators:
                if free[operator] > start:
                    start = free[operator]
            return start
        stance, zone = self.stance, instance.timed_zone[task]
        for operator in step.operators:
            if free[operator] > start:
                start = free[operator]
        for operator, preparation in step.preparations:
            begin = free[operator] + preparation[stance[operator]][0]
            if begin > start:
                start = begin
        for tool, count in step.scarce:
            if (there := self.tool_free[tool][count - 1]) > start:
                start = there
        if zone >= 0:
            start = max(start, self.zone_free[zone][len(step.operators) - 1])
        return self._behind_breaks(step, start) if instance.has_breaks else start

    def put(self, task: int, step: Step, start: int) -> list[int]:
        """Places the task; returns the tasks that have become ready, all their predecessors being
        placed. Assumes `earliest(task, step) <= start`.
        """
        instance, end = self.instance, start + step.ticks
        self.start[task], self.end[task], self.way[task] = start, end, step.way
        zone, team = instance.timed_zone[task], instance.team[task]
        for operator, load in zip(step.operators, step.load, strict=True):
            self.free[operator] = end
            self.load[operator] += load
        if step.preparations:
            stance = self.stance
            for operator, preparation in step.preparations:
                stance[operator] = preparation[stance[operator]][1]
        self.stress += step.stress
        # tools and zones with room for all are never full, so nobody counts their places
        for tool, count in step.scarce:
            _take(self.tool_free[tool], count, end)
        if zone >= 0:
            _take(self.zone_free[zone], len(step.operators), end)
        # the first task of those that need the same operators settles them for the others
        if team >= 0:
            self.operators_of[team] = step.operators
        # what the task puts on operators whoever does it was set aside; now it stands in the load
        if instance.has_limits:
            must = self.layout.must[task]
            self.need = [need - own for need, own in zip(self.need, must, strict=True)]
        # told to the caller, who would otherwise have to look at all tasks again
        released = []
        for after in instance.behind[task]:
            if self.ready[after] < end:
                self.ready[after] = end
            self.waiting[after] -= 1
            if not self.waiting[after]:
                released.append(after)
        return released

    @property
    def makespan(self) -> int:
        """The latest end so far, ticks."""
        return max(self.end)

    def starts(self) -> list[tuple[int, int]]:
        """Per task `(way, start)`, as `Instance.schedule` takes them. Assumes that every task is
        placed.
        """
        return list(zip(self.way, self.start, strict=True))

    def _within_limits(self, task: int, step: Step) -> bool:
        must, limits = self.layout.must[task], self.instance.stress_limit
        for operator, load in zip(step.operators, step.load, strict=True):
            limit = limits[operator]
            if (
                limit is not None
                and self.load[operator] + load + self.need[operator] - must[operator] > limit
            ):
                return False
        return True

    def _behind_breaks(self, step: Step, start: int) -> int:
        breaks, moved = self.instance.breaks, True
        needs = [(operator, 0) for operator in step.operators]
        if step.preparations:
            stance = self.stance
            ready = {o: preparation[stance[o]][0] for o, preparation in step.preparations}
            needs = [(operator, ready.get(operator, 0)) for operator in step.operators]
        while moved:
            moved = False
            for operator, need in needs:
                for off, back in breaks[operator]:
                    if off < start + step.ticks and start - need < back:
                        start, moved = back + need, True
        return start


def append_in_order(layout: Layout, order: Sequence[int], steps: Sequence[Step]) -> PartialSchedule:
    """The tasks appended in this order, task `t` as `steps[t]`. Assumes that predecessors come
    first; stress limits and teams are not looked at.
    """
    state = PartialSchedule(layout)
    earliest, put = state.earliest, state.put
    for task in order:
        put(task, steps[task], earliest(task, steps[task]))
    return state


def _take(places: list[int], count: int, end: int) -> None:
    """Occupies the places that are free first until `end`."""
    places[:count] = [end] * count
    places.sort()


def _steps(instance: Instance, task: int) -> list[Step]:
    best: dict[tuple[tuple[int, ...], int], Step] = {}
    for index, way in enumerate(instance.ways[task]):
        key = (way.operators, way.ticks)
        if _has_room(instance, task, way) and (key not in best or way.stress < best[key].stress):
            best[key] = Step(
                way=index,
                operators=way.operators,
                ticks=way.ticks,
                stress=way.stress,
                load=way.load,
                preparations=instance.prepared(task, way),
                scarce=instance.scarce(way),
            )
    return list(best.values())


def _has_room(instance: Instance, task: int, way: Way) -> bool:
    zone = instance.zone[task]
    if zone is not None and len(way.operators) > instance.zone_places[zone]:
        return False
    return all(count <= instance.tool_places[tool] for tool, count in way.units)


def _shared_by_teams(team: Sequence[int], steps: list[list[Step]]) -> list[list[Step]]:
    shared: dict[int, set[tuple[int, ...]]] = {}
    for task, row in enumerate(steps):
        if team[task] >= 0:
            mine = {step.operators for step in row}
            shared[team[task]] = shared.get(team[task], mine) & mine
    return [
        row if team[task] < 0 else [step for step in row if step.operators in shared[team[task]]]
        for task, row in enumerate(steps)
    ]


def _load(step: Step, operator: int) -> int:
    return step.load[step.operators.index(operator)] if operator in step.operators else 0
