"""From an order and a choice of ways to times: list scheduling with every feature of a cell.

Each task is appended: it starts as early as it can behind what its operators have been given
before, when its predecessors have ended, its tool and its place in the zone are given back, and no
break is in the way. Appending the tasks of any schedule in the order of their starts, in the same
ways, gives a schedule in which no task ends later; so some order leads to an optimum of makespan
and stress.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

from tandem.plan.instance import Instance


class Step(NamedTuple):
    """A way of doing a task that can be part of a schedule.

    Attributes:
      way: its place in `Instance.ways`.
      operators: indices; `ticks` its duration; `stress` the sum of `load`, the stress per operator.
    """

    way: int
    operators: tuple[int, ...]
    ticks: int
    stress: int
    load: tuple[int, ...]


@dataclass(frozen=True)
class Layout:
    """An instance laid out for quick appending.

    Attributes:
      steps: per task, its ways without those that need more of a tool or a zone than there is,
        without those that a partner in `same_operator` lacks, and without those that differ from
        another one in more stress alone.
      team: per task, the number of its group of tasks that the same operators must do; -1 when it
        is in none.
      tool: per task, the index of its tool when that matters for time, else -1. `zone` likewise.
      changeover: per tool, ticks per operator; None when none costs any.
      tool_places, zone_places: capacity, or 0 when there are as many as operators, so that it never
        binds.
      must: per task and operator, the least stress that the task puts on the operator in any of its
        steps.
    """

    instance: Instance
    steps: tuple[tuple[Step, ...], ...]
    team: tuple[int, ...]
    tool: tuple[int, ...]
    zone: tuple[int, ...]
    changeover: tuple[tuple[int, ...] | None, ...]
    tool_places: tuple[int, ...]
    zone_places: tuple[int, ...]
    has_breaks: bool
    has_limits: bool
    must: tuple[tuple[int, ...], ...]

    @classmethod
    def of(cls, instance: Instance) -> Layout:
        """The instance's layout. A task that nobody can do has no steps."""
        operators = len(instance.operators)
        tool_places = tuple(places if places < operators else 0 for places in instance.tool_places)
        zone_places = tuple(places if places < operators else 0 for places in instance.zone_places)
        changeover = tuple(row if any(row) else None for row in instance.changeover)
        swaps = any(changeover)
        team = _teams(instance)
        steps = _shared_by_teams(
            team, [_steps(instance, task) for task in range(len(instance.tasks))]
        )
        return cls(
            instance=instance,
            steps=tuple(map(tuple, steps)),
            team=team,
            tool=tuple(
                -1 if tool is None or not (swaps or tool_places[tool]) else tool
                for tool in instance.tool
            ),
            zone=tuple(
                -1 if zone is None or not zone_places[zone] else zone for zone in instance.zone
            ),
            changeover=changeover,
            tool_places=tool_places,
            zone_places=zone_places,
            has_breaks=any(instance.breaks),
            has_limits=any(limit is not None for limit in instance.stress_limit),
            must=_must(steps, operators),
        )

    @cached_property
    def plain(self) -> bool:
        """Tools, zones and breaks play no part in times."""
        return (
            not self.has_breaks
            and all(tool < 0 for tool in self.tool)
            and all(zone < 0 for zone in self.zone)
        )

    @cached_property
    def tail(self) -> tuple[int, ...]:
        """Per task, ticks on the longest chain that starts with it, every task in its quickest
        step.
        """
        quickest = [min((step.ticks for step in row), default=0) for row in self.steps]
        tail = [0] * len(quickest)
        for task in reversed(self.instance.order):
            tail[task] = quickest[task] + max(
                (tail[after] for after in self.instance.behind[task]), default=0
            )
        return tuple(tail)

    def with_humans_at(self, tasks: Collection[int]) -> Layout:
        """The layout in which humans take part in these tasks and in no other."""
        human = self.instance.human
        steps = tuple(
            tuple(
                step
                for step in row
                if any(human[operator] for operator in step.operators) == (task in tasks)
            )
            for task, row in enumerate(self.steps)
        )
        return replace(self, steps=steps, must=_must(steps, len(human)))

    def impossible(self) -> list[int]:
        """Tasks without any step: nobody can do them here."""
        return [task for task, row in enumerate(self.steps) if not row]


class State:
    """A schedule in the making: tasks are put behind each other and never moved.

    Attributes:
      start, end: ticks per task, -1 while it is not placed; `way` its way in `Instance.ways`.
      free: per operator, the end of the last task.
      hand: per operator, the tool in hand, -1 while the first one costs nothing.
      ready: per task, the latest of its release and the ends of its placed predecessors; `waiting`
        counts the others.
      load: stress per operator so far; `stress` their sum.
      need: per operator, stress that the tasks not yet placed put on them at least.
    """

    __slots__ = (
        "end",
        "free",
        "hand",
        "layout",
        "load",
        "need",
        "operators_of",
        "ready",
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
        self.layout = layout
        self.start, self.end, self.way = [-1] * tasks, [-1] * tasks, [-1] * tasks
        self.free = [0] * operators
        self.hand = [-1 if tool is None else tool for tool in instance.in_hand]
        self.ready = list(instance.release)
        self.waiting = [len(before) for before in instance.before]
        self.tool_free = [[0] * places for places in layout.tool_places]
        self.zone_free = [[0] * places for places in layout.zone_places]
        self.operators_of: dict[int, tuple[int, ...]] = {}
        self.load = [0] * operators
        self.stress = 0
        self.need = (
            [sum(row[o] for row in layout.must) for o in range(operators)]
            if layout.has_limits
            else [0] * operators
        )

    def steps(self, task: int) -> Sequence[Step]:
        """The task's steps that keep stress limits and stay with the operators of its team. May be
        empty.
        """
        layout = self.layout
        steps: Sequence[Step] = layout.steps[task]
        if (
            layout.team[task] >= 0
            and (operators := self.operators_of.get(layout.team[task])) is not None
        ):
            steps = [step for step in steps if step.operators == operators]
        if layout.has_limits:
            steps = [step for step in steps if self._within_limits(task, step)]
        return steps

    def earliest(self, task: int, step: Step) -> int:
        """The earliest tick at which the task can start in this way, appended to what is placed."""
        start, free, layout = self.ready[task], self.free, self.layout
        if layout.plain:
            for operator in step.operators:
                if free[operator] > start:
                    start = free[operator]
            return start
        tool, zone = layout.tool[task], layout.zone[task]
        row = layout.changeover[tool] if tool >= 0 else None
        for operator in step.operators:
            begin = free[operator]
            if row is not None and self.hand[operator] != tool and self.hand[operator] >= 0:
                begin += row[operator]
            if begin > start:
                start = begin
        if tool >= 0 and layout.tool_places[tool]:
            start = max(start, self.tool_free[tool][len(step.operators) - 1])
        if zone >= 0:
            start = max(start, self.zone_free[zone][len(step.operators) - 1])
        return self._behind_breaks(tool, row, step, start) if layout.has_breaks else start

    def put(self, task: int, step: Step, start: int) -> list[int]:
        """Places the task; returns the tasks that have become ready, all their predecessors being
        placed. Assumes `earliest(task, step) <= start`.
        """
        layout, end = self.layout, start + step.ticks
        self.start[task], self.end[task], self.way[task] = start, end, step.way
        tool, zone = layout.tool[task], layout.zone[task]
        for operator, load in zip(step.operators, step.load, strict=True):
            self.free[operator] = end
            self.load[operator] += load
            if tool >= 0:
                self.hand[operator] = tool
        self.stress += step.stress
        if tool >= 0 and layout.tool_places[tool]:
            _take(self.tool_free[tool], len(step.operators), end)
        if zone >= 0:
            _take(self.zone_free[zone], len(step.operators), end)
        if layout.team[task] >= 0:
            self.operators_of[layout.team[task]] = step.operators
        if layout.has_limits:
            self.need = [
                need - must for need, must in zip(self.need, layout.must[task], strict=True)
            ]
        released = []
        for after in layout.instance.behind[task]:
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
        must, limits = self.layout.must[task], self.layout.instance.stress_limit
        for operator, load in zip(step.operators, step.load, strict=True):
            limit = limits[operator]
            if (
                limit is not None
                and self.load[operator] + load + self.need[operator] - must[operator] > limit
            ):
                return False
        return True

    def _behind_breaks(self, tool: int, row: tuple[int, ...] | None, step: Step, start: int) -> int:
        breaks, moved = self.layout.instance.breaks, True
        while moved:
            moved = False
            for operator in step.operators:
                change = (
                    row[operator]
                    if row is not None and self.hand[operator] != tool and self.hand[operator] >= 0
                    else 0
                )
                for off, back in breaks[operator]:
                    if off < start + step.ticks and start - change < back:
                        start, moved = back + change, True
        return start


def append_in_order(layout: Layout, order: Sequence[int], steps: Sequence[Step]) -> State:
    """The tasks appended in this order, task `t` as `steps[t]`. Assumes that predecessors come
    first; stress limits and teams are not looked at.
    """
    state = State(layout)
    earliest, put = state.earliest, state.put
    for task in order:
        put(task, steps[task], earliest(task, steps[task]))
    return state


def _take(places: list[int], count: int, end: int) -> None:
    """Occupies the places that are free first until `end`."""
    places[:count] = [end] * count
    places.sort()


def _steps(instance: Instance, task: int) -> list[Step]:
    tool, zone = instance.tool[task], instance.zone[task]
    places = min([instance.tool_places[tool]] if tool is not None else [len(instance.operators)])
    places = min(places, instance.zone_places[zone]) if zone is not None else places
    best: dict[tuple[tuple[int, ...], int], Step] = {}
    for index, way in enumerate(instance.ways[task]):
        key = (way.operators, way.ticks)
        if len(way.operators) <= places and (key not in best or way.stress < best[key].stress):
            best[key] = Step(index, way.operators, way.ticks, way.stress, way.load)
    return list(best.values())


def _teams(instance: Instance) -> tuple[int, ...]:
    """Per task, the number of its connected group of `same_operator` pairs, or -1."""
    root = list(range(len(instance.tasks)))

    def find(task: int) -> int:
        while root[task] != task:
            task = root[task]
        return task

    for one, other in instance.same_operator:
        root[find(one)] = find(other)
    paired = {task for pair in instance.same_operator for task in pair}
    return tuple(find(task) if task in paired else -1 for task in range(len(root)))


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


def _must(steps: Sequence[Sequence[Step]], operators: int) -> tuple[tuple[int, ...], ...]:
    return tuple(
        tuple(min((_load(step, o) for step in row), default=0) for o in range(operators))
        for row in steps
    )


def _load(step: Step, operator: int) -> int:
    return step.load[step.operators.index(operator)] if operator in step.operators else 0
