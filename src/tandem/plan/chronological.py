"""Partial schedules along the clock, for exhaustive search: what can be appended next, and which of
two is no worse.

Schedules are built in the order of their starts: the next task, in one of its steps, starts as
early as it can but not before the one appended last.

Why nothing is lost. Take any sound schedule, its tasks in order of start. Suppose its first k tasks
are appended and no number of the node (last start, end of each operator's work, ends that others
wait for, places of tools and zones, kinds kept apart, stress) is above what the schedule itself
has. Task k+1 can start where the schedule starts it, for that is possible and not before the last
start; so its earliest start is no later, and again no number is above. After the last task neither
makespan nor stress is above the schedule's.

Why nodes can be merged. Two nodes in which the same tasks are appended, the same tools are in hand,
the same tasks are with humans (where a table of sets counts stress) and the same operators are
bound to teams differ in their numbers alone; whatever completes one completes, at the same times,
another that has no larger number.

Where a task must start within a time after another one (a wait with a most), starting as early as
it can is not enough: the first must not start before the second can follow in time. So when a task
is appended that comes too late for what it waits for, that one is put off until it is in time, and
with it whatever was appended behind it, each again as early as it then can; over and over until
nothing is too early. Since the earliest start of each task only grows with the starts before it,
this ends with the earliest schedule of this order that keeps the waits, or there is none.
While such a wait is open, its first task appended and its second not, what was appended since may
still be put off. Then nothing is needless by a shift to the left, and nodes are merged only if
what was appended since nothing was open is the very same; no wait spans that moment, so that what
lies before it stays.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from tandem.plan.list_scheduling import Layout, Step

Key = tuple[object, ...]


class Node(NamedTuple):
    """A partial schedule.

    Attributes:
      mask: bits of the tasks appended.
      last: start of the task appended last.
      free: per operator, the end of their last task, or of the last part that a machine has held.
        `stance`: what they have in hand, see `Instance.stance`.
      ends: per task appended, its end; of others 0.
      tools, zones: per tool or zone, the moments at which its places are free, sorted; empty where
        the capacity never binds.
      apart: per zone, for each kind that it keeps apart, when the last of them leaves.
      stress: units of all operators. taken: per allowance, what the tasks appended take of it.
      humans: bits of the tasks in which humans take part.
      teams: `(team, operators)` of the teams that have begun, sorted.
      starts: per task appended, its start, of others 0; empty where no wait counts from starts.
      open: how many tasks were appended since no wait with a most was open; 0 when none is.
      step: `(task, step, start)` that was appended, to `before`; None at the root.
    """

    mask: int
    last: int
    free: tuple[int, ...]
    stance: tuple[int, ...]
    ends: tuple[int, ...]
    tools: tuple[tuple[int, ...], ...]
    zones: tuple[tuple[int, ...], ...]
    apart: tuple[tuple[int, ...], ...]
    taken: tuple[int, ...]
    stress: int
    humans: int
    teams: tuple[tuple[int, tuple[int, ...]], ...]
    starts: tuple[int, ...]
    open: int
    step: tuple[int, Step, int] | None
    before: Node | None


class Branching:
    """The moves of one layout.

    Args:
      latest_end: per task, ticks by which it must have ended; a move that would miss it, or leave
        no time for it, is not made.
    """

    def __init__(self, layout: Layout, latest_end: list[int]) -> None:
        instance = layout.instance
        self.layout, self.instance = layout, instance
        self.tasks = range(len(instance.tasks))
        self.operators = range(len(instance.operators))
        self.full, self.needs = instance.all_tasks, instance.begun_first
        self.from_starts = any(lag.from_start for lag in instance.lags)
        self.followed = {lag.before for lag, _ in instance.most_lags}
        self.latest_end = latest_end
        self.latest_start = [
            end - own for end, own in zip(latest_end, layout.quickest, strict=True)
        ]
        self.prepares = instance.has_preparations
        self.human = [
            [any(instance.human[o] for o in step.operators) for step in row] for row in layout.steps
        ]
        self.harmless = [
            [self._is_harmless(task, step) for step in row] for task, row in enumerate(layout.steps)
        ]
        self._waited_for: dict[int, tuple[int, ...]] = {}
        self._candidates: dict[int, tuple[int, ...]] = {}
        self._is_open: dict[int, bool] = {}

    def root(self) -> Node:
        """Nothing is appended yet."""
        operators = len(self.operators)
        return Node(
            mask=0,
            last=0,
            free=(0,) * operators,
            stance=self.instance.stances,
            ends=(0,) * len(self.tasks),
            tools=tuple((0,) * places for places in self.instance.tool_room),
            zones=tuple((0,) * places for places in self.instance.zone_room),
            apart=tuple((0,) * (max(row, default=-1) + 1) for row in self.instance.zone_apart),
            taken=(0,) * len(self.instance.allowances),
            stress=0,
            humans=0,
            teams=(),
            starts=(0,) * len(self.tasks) if self.from_starts else (),
            open=0,
            step=None,
            before=None,
        )

    def children(self, node: Node, horizon: int) -> Iterator[Node]:
        """Every node with one task more that can still end by `horizon`, but for those that a shift
        to the left makes needless.

        A task that starts when another one could already have ended can be left for later, if that
        other one costs nothing to take first: it is in its step of least stress, belongs to no
        team, nothing must follow it within a time, it puts no part into a machine that holds it,
        and nobody needs time to get ready for a task.
        """
        moves, cutoff = [], horizon + 1
        for task in self.candidates(node.mask):
            ready, soonest = self._ready(node, task), None
            # each step is a child of its own: the one that ends first need not be the one to take
            for index, step in enumerate(self.layout.steps[task]):
                start = self._start(node, task, step, ready)
                if start is None:
                    continue
                if self.instance.has_holds and self._is_barred(node, task, step):
                    # it can start when the part is out, and nobody knows yet when that is
                    soonest = start if soonest is None else min(soonest, start)
                    continue
                soonest = start if soonest is None else min(soonest, start)
                end = start + step.ticks
                if end <= self.latest_end[task] and end + self.layout.behind[task] <= horizon:
                    moves.append((task, index, step, start))
                    if end < cutoff and not node.open and self.harmless[task][index]:
                        cutoff = end
            # a task that can no longer come in time rules out the node, not only the child
            if soonest is None or soonest > min(
                self.latest_start[task], horizon - self.layout.tail[task]
            ):
                return
        # only now, because the earliest end is known after all have been looked at
        for task, index, step, start in moves:
            if start < cutoff:
                child = self._appended(node, task, index, step, start)
                if not node.open:
                    yield child
                elif (settled := self._drawn_together(child, node.open + 1)) is not None:
                    yield settled

    def _ready(self, node: Node, task: int) -> int:
        """The tick before which the task cannot start, whoever does it."""
        ends, instance = node.ends, self.instance
        firsts = (ends[first] for first in instance.before[task])
        ready = max([node.last, instance.release[task], *firsts])
        for lag in instance.lags_into[task] if instance.has_lags else ():
            moment = node.starts[lag.before] if lag.from_start else ends[lag.before]
            ready = max(ready, moment + lag.least)
        return ready

    def _drawn_together(self, node: Node, count: int) -> Node | None:
        """The node, the `count` tasks appended last put off where another one would follow too
        late; None when then one of them cannot end in time.
        """
        rows: list[tuple[int, int, Step, int]] = []
        base = node
        for _ in range(count):
            assert base.step is not None
            assert base.before is not None
            task, step, start = base.step
            rows.append((task, self.layout.steps[task].index(step), step, start))
            base = base.before
        rows.reverse()
        begin = {task: start for task, _, _, start in rows}
        rounds = 0
        while self._put_off(node, begin):
            # where starts depend on nothing but sums, a chain of waits has settled by then (the
            # rounds of Bellman and Ford), or goes round in a circle for ever
            rounds += 1
            if rounds == len(self.instance.most_lags) + 1 and self._goes_round(rows):
                return None
            node = base
            for task, index, step, _ in rows:
                ready = max(begin[task], self._ready(node, task))
                later = self._start(node, task, step, ready)
                if later is None or later + step.ticks > self.latest_end[task]:
                    return None
                begin[task] = later
                node = self._appended(node, task, index, step, later)
        return node

    def _goes_round(self, rows: list[tuple[int, int, Step, int]]) -> bool:
        """Whether these tasks, in this order, cannot keep their waits even if tools, zones and
        breaks stood in nobody's way: then each putting off calls for the next.
        """
        ticks = {task: step.ticks for task, _, step, _ in rows}
        begin = dict.fromkeys(ticks, 0)
        for _ in range(len(self.instance.most_lags) + 1):
            free, last = [0] * len(self.operators), 0
            for task, _, step, _ in rows:
                firsts = [f for f in self.instance.before[task] if f in ticks]
                start = max([begin[task], last, *(begin[f] + ticks[f] for f in firsts)])
                for lag in self.instance.lags_into[task]:
                    if lag.before in ticks:
                        own = 0 if lag.from_start else ticks[lag.before]
                        start = max(start, begin[lag.before] + own + lag.least)
                begin[task] = last = max([start, *(free[o] for o in step.operators)])
                for operator in step.operators:
                    free[operator] = last + step.ticks
            late = [
                (lag.before, begin[lag.task] - most - (0 if lag.from_start else ticks[lag.before]))
                for lag, most in self.instance.most_lags
                if lag.task in ticks and lag.before in ticks
            ]
            if not any(soonest > begin[task] for task, soonest in late):
                return False
            for task, soonest in late:
                begin[task] = max(begin[task], soonest)
        return True

    def _put_off(self, node: Node, begin: dict[int, int]) -> bool:
        """Puts off, in `begin`, what was appended and is followed too late; whether it found
        any.
        """
        found = False
        for lag, most in self.instance.most_lags:
            if lag.task in begin and lag.before in begin:
                first = begin[lag.before]
                moment = first if lag.from_start else node.ends[lag.before]
                late = begin[lag.task] - most - moment
                if late > 0:
                    begin[lag.before], found = max(begin[lag.before], first + late), True
        return found

    def candidates(self, mask: int) -> tuple[int, ...]:
        """Tasks not yet appended whose predecessors are, and what they wait for."""
        known = self._candidates.get(mask)
        if known is None:
            known = tuple(
                task
                for task in self.tasks
                if not mask >> task & 1 and self.needs[task] & mask == self.needs[task]
            )
            self._candidates[mask] = known
        return known

    def forget(self) -> None:
        """Lets go of what was remembered for the sets of tasks so far."""
        self._candidates.clear()
        self._waited_for.clear()
        self._is_open.clear()

    def key(self, node: Node) -> Key:
        """What two nodes must have in common to be compared."""
        table = node.humans if self.instance.stress_of_set is not None else 0
        if node.open:
            base, since = node, []
            for _ in range(node.open):
                assert base.step is not None
                assert base.before is not None
                since.append((base.step[0], base.step[1].way))
                base = base.before
            return (tuple(since), id(base))
        return (node.mask, node.stance if self.prepares else (), table, node.teams)

    def numbers(self, node: Node) -> tuple[int, ...]:
        """What decides between two nodes of one key: the one with no larger number is no worse.

        A time before the last start counts as the last start, since no later task can notice the
        difference; where preparations may lie before the last start, an operator's time counts
        that much further back. Without them the operators' times imply the last start.
        """
        last = node.last
        numbers = [
            max(free, last - preparation)
            for free, preparation in zip(node.free, self.instance.longest_preparation, strict=True)
        ]
        if self.prepares:
            numbers.append(last)
        numbers += [max(node.ends[task], last) for task in self.waited_for(node.mask)]
        if self.instance.has_lags:
            numbers += [
                max((node.starts if lag.from_start else node.ends)[lag.before] + lag.least, last)
                for lag in self.instance.lags
                if node.mask >> lag.before & 1 and not node.mask >> lag.task & 1
            ]
        for places in node.tools:
            numbers += [max(place, last) for place in places]
        for places in node.zones:
            numbers += [max(place, last) for place in places]
        if self.instance.has_apart:
            numbers += [max(end, last) for kinds in node.apart for end in kinds]
        numbers += node.taken
        if self.instance.stress_of_set is None:
            numbers.append(node.stress)
        return tuple(numbers)

    def waited_for(self, mask: int) -> tuple[int, ...]:
        """Tasks appended that others, not yet appended, come after."""
        known = self._waited_for.get(mask)
        if known is None:
            known = tuple(
                task
                for task in self.tasks
                if mask >> task & 1
                and any(not mask >> after & 1 for after in self.instance.behind[task])
            )
            self._waited_for[mask] = known
        return known

    def starts(self, node: Node) -> list[tuple[int, int]]:
        """Per task `(way, start)`, of a node in which every task is appended."""
        starts = [(0, 0)] * len(self.tasks)
        here: Node | None = node
        while here is not None and here.step is not None:
            task, step, start = here.step
            starts[task] = (step.way, start)
            here = here.before
        return starts

    def _start(self, node: Node, task: int, step: Step, ready: int) -> int | None:
        """The earliest start at or after `ready`; None when the step is not allowed here."""
        team = self.instance.team[task]
        if team >= 0 and any(
            other == team and operators != step.operators for other, operators in node.teams
        ):
            return None
        for number, due in step.dues:
            if node.taken[number] + due > self.instance.allowances[number].most:
                return None
        start = max(ready, self._given_back(node, task, step))
        before = {o: preparation[node.stance[o]][0] for o, preparation in step.preparations}
        needs = [(operator, before.get(operator, 0)) for operator in step.operators]
        for operator, need in needs:
            start = max(start, node.free[operator] + need)
        moved = self.instance.has_breaks
        while moved:
            moved = False
            for operator, need in needs:
                for off, back in self.instance.breaks[operator]:
                    if off < start + step.ticks and start - need < back:
                        start, moved = back + need, True
        return start

    def _given_back(self, node: Node, task: int, step: Step) -> int:
        """When the tools, a place in the zone, and the machines that are to hold a part are given
        back.
        """
        start, zone = 0, self.instance.timed_zone[task]
        for tool, count in step.scarce:
            start = max(start, node.tools[tool][count - 1])
        if zone >= 0 and node.zones[zone]:
            start = max(start, node.zones[zone][len(step.operators) - 1])
        for hold in self.instance.held_from[task] if self.instance.has_holds else ():
            start = max(start, node.free[self.instance.holds[hold][0]])
        if step.side >= 0:
            kinds = node.apart[self.instance.zone[task]]  # type: ignore[index]
            start = max([start, *(end for side, end in enumerate(kinds) if side != step.side)])
        return start

    def _is_barred(self, node: Node, task: int, step: Step) -> bool:
        """Whether a machine holds a part that must come out first. Which parts they hold follows
        from the tasks that are appended, so that nodes of one key hold the same.
        """
        who = sum(1 << operator for operator in step.operators)
        return self.instance.is_barred(node.mask, node.mask, task, who)

    def _appended(self, node: Node, task: int, index: int, step: Step, start: int) -> Node:
        instance, end, who = self.instance, start + step.ticks, step.operators
        zone, team = instance.timed_zone[task], instance.team[task]
        # nodes share what did not change: the tuples of the parent are taken over
        free, ends, stance, taken = list(node.free), list(node.ends), node.stance, node.taken
        for operator in who:
            free[operator] = end
        if taken:
            dues = dict(step.dues)
            taken = tuple(units + dues.get(number, 0) for number, units in enumerate(taken))
        ends[task] = end
        for hold in instance.held_until[task] if instance.has_holds else ():
            machine = instance.holds[hold][0]
            free[machine] = max(free[machine], end)
        if step.preparations:
            taken_up = dict(step.preparations)
            stance = tuple(
                taken_up[operator][held][1] if operator in taken_up else held
                for operator, held in enumerate(stance)
            )
        tools = node.tools
        for tool, count in step.scarce:
            tools = _taken(tools, tool, count, end)
        starts = node.starts
        if starts:
            starts = (*starts[:task], start, *starts[task + 1 :])
        mask = node.mask | 1 << task
        # the first task of those that need the same operators settles them for the others
        teams = node.teams
        if team >= 0 and all(other != team for other, _ in teams):
            teams = tuple(sorted([*teams, (team, who)]))
        return Node(
            mask=mask,
            last=start,
            free=tuple(free),
            stance=stance,
            ends=tuple(ends),
            tools=tools,
            zones=_taken(node.zones, zone, len(who), end),
            apart=self._with_its_kind(node, task, step, end),
            taken=taken,
            stress=node.stress + step.stress,
            humans=node.humans | self.human[task][index] << task,
            teams=teams,
            starts=starts,
            open=node.open + 1 if self.followed and self._waits_open(mask) else 0,
            step=(task, step, start),
            before=node,
        )

    def _waits_open(self, mask: int) -> bool:
        """Whether a task is appended that another one, not yet appended, must follow in time."""
        known = self._is_open.get(mask)
        if known is None:
            known = self._is_open[mask] = any(
                mask >> lag.before & 1 and not mask >> lag.task & 1
                for lag, _ in self.instance.most_lags
            )
        return known

    def _with_its_kind(
        self, node: Node, task: int, step: Step, end: int
    ) -> tuple[tuple[int, ...], ...]:
        """When the kinds that zones keep apart have left them, the step's own counted."""
        if step.side < 0:
            return node.apart
        zone = self.instance.zone[task]
        return tuple(
            tuple(max(at, end) if side == step.side else at for side, at in enumerate(kinds))
            if place == zone
            else kinds
            for place, kinds in enumerate(node.apart)
        )

    def _is_harmless(self, task: int, step: Step) -> bool:
        others = self.layout.steps[task]
        least = all(_is_no_harder(step, other) for other in others)
        return (
            least
            and not self.prepares
            and task not in self.followed
            and self.instance.team[task] < 0
            and not (self.instance.has_holds and self.instance.held_from[task])
            and (self.instance.stress_of_set is None or len(others) == 1)
        )


def _is_no_harder(step: Step, other: Step) -> bool:
    """Whether no operator has more stress in the first than in the second, nor takes more of an
    allowance.
    """
    loads, dues = dict(zip(other.operators, other.load, strict=True)), dict(other.dues)
    return all(
        load <= loads.get(operator, 0)
        for operator, load in zip(step.operators, step.load, strict=True)
    ) and all(due <= dues.get(number, 0) for number, due in step.dues)


def _taken(
    places: tuple[tuple[int, ...], ...], which: int, count: int, end: int
) -> tuple[tuple[int, ...], ...]:
    """The places after `count` of those that are free first are taken until `end`."""
    if which < 0 or not places[which]:
        return places
    row = tuple(sorted([*places[which][count:], *[end] * count]))
    return (*places[:which], row, *places[which + 1 :])
