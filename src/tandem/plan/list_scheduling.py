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
      dues: what it takes of allowances, as those of a way.
      side: which of the kinds that the task's zone keeps apart its operators are; -1 for none.
    """

    way: int
    operators: tuple[int, ...]
    ticks: int
    stress: int
    load: tuple[int, ...]
    preparations: tuple[tuple[int, Preparation], ...]
    scarce: tuple[tuple[int, int], ...]
    side: int = -1
    dues: tuple[tuple[int, int], ...] = ()


@dataclass(frozen=True)
class Layout:
    """An instance with those of its ways that a search may take.

    Attributes:
      steps: per task, its ways without those that need more of a tool or a zone than there is,
        without those by operators whom the zone keeps apart,
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
    def head(self) -> tuple[int, ...]:
        """Per task, ticks before which it cannot start: because of releases, predecessors in their
        quickest steps, and operators who come later.
        """
        instance, quickest, head = self.instance, self.quickest, [0] * len(self.steps)
        for task in instance.order:
            ends = [head[first] + quickest[first] for first in instance.before[task]]
            head[task] = max([instance.release[task], self._arrival(task), *ends])
            for lag in instance.lags_into[task] if instance.has_lags else ():
                own = 0 if lag.from_start else quickest[lag.before]
                head[task] = max(head[task], head[lag.before] + own + lag.least)
        return tuple(head)

    def _arrival(self, task: int) -> int:
        """Ticks before which nobody is there for the task."""
        arrival = self.instance.arrival
        if not any(arrival):
            return 0
        groups = (step.operators for step in self.steps[task])
        return min((max(arrival[operator] for operator in group) for group in groups), default=0)

    @cached_property
    def tail(self) -> tuple[int, ...]:
        """Per task, ticks on the longest chain that starts with it, each task at its quickest."""
        return self.instance.chains(self.quickest)

    @cached_property
    def behind(self) -> tuple[int, ...]:
        """Per task, ticks on the longest chain behind its end."""
        return self.instance.behind_ends(self.tail, self.quickest, self.slowest)

    @cached_property
    def slowest(self) -> tuple[int, ...]:
        """Per task, ticks of its slowest step."""
        return tuple(max((step.ticks for step in row), default=0) for row in self.steps)

    @cached_property
    def easiest(self) -> tuple[int, ...]:
        """Per task, units of stress of its easiest step."""
        return tuple(min((step.stress for step in row), default=0) for row in self.steps)

    @cached_property
    def must(self) -> tuple[tuple[int, ...], ...]:
        """Per task and allowance, the least that any step of the task takes of it."""
        numbers = range(len(self.instance.allowances))
        return tuple(
            tuple(min((dict(step.dues).get(n, 0) for step in row), default=0) for n in numbers)
            for row in self.steps
        )

    def latest_ends(self, most: int) -> list[int]:
        """Per task, ticks by which it must have ended so that deadlines and `most` can be kept."""
        instance, latest = self.instance, [most] * len(self.steps)
        for task in reversed(instance.order):
            deadline = instance.deadline[task]
            afters = (latest[after] - self.quickest[after] for after in instance.behind[task])
            latest[task] = min([most if deadline is None else min(deadline, most), *afters])
            for lag in instance.lags_from[task] if instance.has_lags else ():
                moment = latest[lag.task] - self.quickest[lag.task] - lag.least
                own = self.slowest[task] if lag.from_start else 0
                latest[task] = min(latest[task], moment + own)
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
      free: per operator, the end of the last task, or of the last part that a machine has held.
      begun: bits of the tasks that are placed.
      apart_free: per zone and kind that it keeps apart, when the last of them leaves.
      stance: per operator, what it has in hand, see `Instance.stance`.
      ready: per task, the latest of its release and the ends of its placed predecessors, waits
        after them included; `waiting` counts the others.
      stress: units so far, of all operators.
      taken: per allowance, what the placed tasks take of it; `need` what those not yet placed take
        at least.
    """

    __slots__ = (
        "apart_free",
        "begun",
        "end",
        "free",
        "instance",
        "layout",
        "need",
        "operators_of",
        "ready",
        "stance",
        "start",
        "stress",
        "taken",
        "tool_free",
        "waiting",
        "way",
        "zone_free",
    )

    def __init__(self, layout: Layout, release: Sequence[int] | None = None) -> None:
        """Nothing is placed. `release` in ticks per task; those of the instance when None."""
        instance = layout.instance
        tasks, operators = len(instance.tasks), len(instance.operators)
        self.layout, self.instance = layout, instance
        self.start, self.end, self.way = [-1] * tasks, [-1] * tasks, [-1] * tasks
        self.free = [0] * operators
        self.stance = list(instance.stances)
        self.ready = list(instance.release if release is None else release)
        self.waiting = list(instance.waits_for)
        self.tool_free = [[0] * places for places in instance.tool_room]
        self.zone_free = [[0] * places for places in instance.zone_room]
        self.begun = 0
        self.apart_free = [[0] * (max(row, default=-1) + 1) for row in instance.zone_apart]
        self.operators_of: dict[int, tuple[int, ...]] = {}
        self.stress = 0
        self.taken = [0] * len(instance.allowances)
        self.need = [sum(column) for column in zip(*layout.must, strict=True)]

    def steps(self, task: int) -> tuple[Step, ...]:
        """The task's steps that keep people's limits, stay with the operators of its team and are
        not barred by a part that a machine holds. May be empty; `is_held_up` says whether that can
        change.
        """
        steps = self._allowed(task)
        if self.instance.has_holds:
            steps = tuple(step for step in steps if not self.is_barred(task, step))
        return steps

    def is_barred(self, task: int, step: Step) -> bool:
        """Whether a machine holds a part that must be taken out first."""
        who = sum(1 << operator for operator in step.operators)
        return self.instance.is_barred(self.begun, self.begun, task, who)

    def is_held_up(self, task: int) -> bool:
        """Whether parts that machines hold are all that keeps the task from being placed."""
        return self.instance.has_holds and bool(self._allowed(task)) and not self.steps(task)

    def _allowed(self, task: int) -> tuple[Step, ...]:
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
        if instance.has_holds or step.side >= 0:
            start = max(start, self._given_back(task, step))
        return self._behind_breaks(step, start) if instance.has_breaks else start

    def put(self, task: int, step: Step, start: int) -> list[int]:
        """Places the task; returns the tasks that have become ready, all that they wait for being
        placed. Assumes `earliest(task, step) <= start`.
        """
        instance, end = self.instance, start + step.ticks
        self.start[task], self.end[task], self.way[task] = start, end, step.way
        team = instance.team[task]
        for operator in step.operators:
            self.free[operator] = end
        if step.preparations:
            stance = self.stance
            for operator, preparation in step.preparations:
                stance[operator] = preparation[stance[operator]][1]
        if instance.has_holds:
            self._take_out_parts(task, end)
        self.stress += step.stress
        self._take_places(task, step, end)
        # the first task of those that need the same operators settles them for the others
        if team >= 0:
            self.operators_of[team] = step.operators
        if instance.has_limits:
            self._take_allowances(task, step)
        for after in instance.behind[task]:
            if self.ready[after] < end:
                self.ready[after] = end
        if instance.has_lags:
            self._pass_on_waits(task, start, end)
        # told to the caller, who would otherwise have to look at all tasks again
        released = []
        for after in instance.begun_behind[task]:
            self.waiting[after] -= 1
            if not self.waiting[after]:
                released.append(after)
        return released

    def _take_places(self, task: int, step: Step, end: int) -> None:
        """Tools and zones with room for all are never full, so nobody counts their places."""
        for tool, count in step.scarce:
            _take(self.tool_free[tool], count, end)
        zone = self.instance.timed_zone[task]
        if zone >= 0:
            _take(self.zone_free[zone], len(step.operators), end)
        if step.side >= 0:
            kinds = self.apart_free[self.instance.zone[task]]  # type: ignore[index]
            kinds[step.side] = max(kinds[step.side], end)

    def _take_allowances(self, task: int, step: Step) -> None:
        """What the task takes whoever does it was set aside; now it is taken."""
        for number, due in step.dues:
            self.taken[number] += due
        must = self.layout.must[task]
        self.need = [need - own for need, own in zip(self.need, must, strict=True)]

    def _pass_on_waits(self, task: int, start: int, end: int) -> None:
        for lag in self.instance.lags_from[task]:
            moment = (start if lag.from_start else end) + lag.least
            self.ready[lag.task] = max(self.ready[lag.task], moment)

    @property
    def makespan(self) -> int:
        """The latest end so far, ticks."""
        return max(self.end)

    def starts(self) -> list[tuple[int, int]]:
        """Per task `(way, start)`, as `Instance.schedule` takes them. Assumes that every task is
        placed.
        """
        return list(zip(self.way, self.start, strict=True))

    def _take_out_parts(self, task: int, end: int) -> None:
        """Machines that held a part until the end of this task are free then."""
        self.begun |= 1 << task
        for hold in self.instance.held_until[task]:
            machine = self.instance.holds[hold][0]
            self.free[machine] = max(self.free[machine], end)

    def _given_back(self, task: int, step: Step) -> int:
        """When the machines are free that are to hold a part, and those have left the task's zone
        whom it keeps apart from the step's operators.
        """
        machines = (self.instance.holds[hold][0] for hold in self.instance.held_from[task])
        moments = [0, *(self.free[machine] for machine in machines)]
        if step.side >= 0:
            kinds = self.apart_free[self.instance.zone[task]]  # type: ignore[index]
            moments += [end for side, end in enumerate(kinds) if side != step.side]
        return max(moments)

    def _within_limits(self, task: int, step: Step) -> bool:
        must, allowances = self.layout.must[task], self.instance.allowances
        return all(
            self.taken[number] + due + self.need[number] - must[number] <= allowances[number].most
            for number, due in step.dues
        )

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


def append_in_order(
    layout: Layout, order: Sequence[int], steps: Sequence[Step]
) -> PartialSchedule | None:
    """The tasks appended in this order, task `t` as `steps[t]`. Assumes that predecessors, and what
    is waited for, come first; limits of people and teams are not looked at.

    A task that a machine's part bars comes when it has been taken out; None when some never can.
    A task that another one must follow within a time is put off as long as that one comes too
    late: what comes out is the earliest of all schedules of this order that keep such waits. Where
    there is none they are broken.
    """
    state = _appended(layout, order, steps, layout.instance.release)
    begin = list(layout.instance.release)
    most_lags = layout.instance.most_lags
    # a chain of waits needs as many rounds as it has links; breaks and places may need some more
    for _ in range(4 * len(most_lags) + 4 if most_lags else 0):
        if state is None:
            return None
        moved = False
        for lag, most in most_lags:
            own = 0 if lag.from_start else steps[lag.before].ticks
            soonest = state.start[lag.task] - most - own
            if state.start[lag.before] < soonest:
                begin[lag.before], moved = soonest, True
        if not moved:
            break
        state = _appended(layout, order, steps, begin)
    return state


def by_start(instance: Instance, starts: Sequence[tuple[int, int]]) -> list[int]:
    """The tasks by their starts; of those that start together, one comes behind what it waits
    for.
    """
    if not instance.has_lags:
        return sorted(range(len(starts)), key=lambda task: (starts[task][1], task))
    place = {task: index for index, task in enumerate(instance.order)}
    return sorted(range(len(starts)), key=lambda task: (starts[task][1], place[task]))


def _appended(
    layout: Layout, order: Sequence[int], steps: Sequence[Step], release: Sequence[int]
) -> PartialSchedule | None:
    state = PartialSchedule(layout, release)
    earliest, put = state.earliest, state.put
    if layout.instance.has_holds:
        return state if _append_around_parts(state, order, steps) else None
    for task in order:
        put(task, steps[task], earliest(task, steps[task]))
    return state


def _append_around_parts(
    state: PartialSchedule, order: Sequence[int], steps: Sequence[Step]
) -> bool:
    """Appends always the first task that is ready and not barred; says whether all could be."""
    left = list(order)
    while left:
        task = next(
            (
                task
                for task in left
                if not state.waiting[task] and not state.is_barred(task, steps[task])
            ),
            None,
        )
        if task is None:
            return False
        left.remove(task)
        state.put(task, steps[task], state.earliest(task, steps[task]))
    return True


def _take(places: list[int], count: int, end: int) -> None:
    """Occupies the places that are free first until `end`."""
    places[:count] = [end] * count
    places.sort()


def _steps(instance: Instance, task: int) -> list[Step]:
    best: dict[tuple[tuple[int, ...], int], Step] = {}
    for index, way in enumerate(instance.ways[task]):
        key, sides = (way.operators, way.ticks), instance.sides(task, way)
        if len(sides) > 1 or not _has_room(instance, task, way):
            continue
        if key not in best or way.stress < best[key].stress:
            best[key] = Step(
                way=index,
                operators=way.operators,
                ticks=way.ticks,
                stress=way.stress,
                load=way.load,
                preparations=instance.prepared(task, way),
                scarce=instance.scarce(way),
                side=max(sides, default=-1),
                dues=way.dues,
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
