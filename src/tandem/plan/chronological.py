"""Partial schedules along the clock, for exhaustive search: what can be appended next, and which of
two is no worse.

Schedules are built in the order of their starts: the next task, in one of its steps, starts as
early as it can but not before the one appended last.

Why nothing is lost. Take any sound schedule, its tasks in order of start. Suppose its first k tasks
are appended and no number of the node (last start, end of each operator's work, ends that others
wait for, places of tools and zones, stress) is above what the schedule itself has. Task k+1 can
start where the schedule starts it, for that is possible and not before the last start; so its
earliest start is no later, and again no number is above. After the last task neither makespan nor
stress is above the schedule's.

Why nodes can be merged. Two nodes in which the same tasks are appended, the same tools are in hand,
the same tasks are with humans (where a table of sets counts stress) and the same operators are
bound to teams differ in their numbers alone; whatever completes one completes, at the same times,
another that has no larger number.
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
      free: per operator, the end of their last task. `stance`: what they have in hand, see
        `Instance.stance`.
      ends: per task appended, its end; of others 0.
      tools, zones: per tool or zone, the moments at which its places are free, sorted; empty where
        the capacity never binds.
      loads: stress per operator. `stress`: their sum.
      humans: bits of the tasks in which humans take part.
      teams: `(team, operators)` of the teams that have begun, sorted.
      step: `(task, step, start)` that was appended, to `before`; None at the root.
    """

    mask: int
    last: int
    free: tuple[int, ...]
    stance: tuple[int, ...]
    ends: tuple[int, ...]
    tools: tuple[tuple[int, ...], ...]
    zones: tuple[tuple[int, ...], ...]
    loads: tuple[int, ...]
    stress: int
    humans: int
    teams: tuple[tuple[int, tuple[int, ...]], ...]
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
        self.full, self.needs = instance.all_tasks, instance.needs
        self.latest_end = latest_end
        self.latest_start = [
            end - own for end, own in zip(latest_end, layout.quickest, strict=True)
        ]
        self.prepares = instance.has_preparations
        self.limited = [o for o in self.operators if instance.stress_limit[o] is not None]
        self.human = [
            [any(instance.human[o] for o in step.operators) for step in row] for row in layout.steps
        ]
        self.harmless = [
            [self._is_harmless(task, step) for step in row] for task, row in enumerate(layout.steps)
        ]
        self._waited_for: dict[int, tuple[int, ...]] = {}
        self._candidates: dict[int, tuple[int, ...]] = {}

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
            loads=(0,) * operators,
            stress=0,
            humans=0,
            teams=(),
            step=None,
            before=None,
        )

    def children(self, node: Node, horizon: int) -> Iterator[Node]:
        """Every node with one task more that can still end by `horizon`, but for those that a shift
        to the left makes needless.

        A task that starts when another one could already have ended can be left for later, if that
        other one costs nothing to take first: it is in its step of least stress, belongs to no
        team, and nobody needs time to get ready for a task.
        """
        moves, cutoff = [], horizon + 1
        for task in self.candidates(node.mask):
            ready = max(
                [
                    node.last,
                    self.instance.release[task],
                    *(node.ends[first] for first in self.instance.before[task]),
                ]
            )
            soonest = None
            # each step is a child of its own: the one that ends first need not be the one to take
            for index, step in enumerate(self.layout.steps[task]):
                start = self._start(node, task, step, ready)
                if start is None:
                    continue
                soonest = start if soonest is None else min(soonest, start)
                end = start + step.ticks
                if end <= self.latest_end[task] and end + self.layout.behind[task] <= horizon:
                    moves.append((task, index, step, start))
                    if end < cutoff and self.harmless[task][index]:
                        cutoff = end
            # a task that can no longer come in time rules out the node, not only the child
            if soonest is None or soonest > min(
                self.latest_start[task], horizon - self.layout.tail[task]
            ):
                return
        # only now, because the earliest end is known after all have been looked at
        for task, index, step, start in moves:
            if start < cutoff:
                yield self._appended(node, task, index, step, start)

    def candidates(self, mask: int) -> tuple[int, ...]:
        """Tasks not yet appended whose predecessors are."""
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

    def key(self, node: Node) -> Key:
        """What two nodes must have in common to be compared."""
        table = node.humans if self.instance.stress_of_set is not None else 0
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
        for places in node.tools:
            numbers += [max(place, last) for place in places]
        for places in node.zones:
            numbers += [max(place, last) for place in places]
        numbers += [node.loads[o] for o in self.limited]
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
        for operator, load in zip(step.operators, step.load, strict=True):
            limit = self.instance.stress_limit[operator]
            if limit is not None and node.loads[operator] + load > limit:
                return None
        start, zone = ready, self.instance.timed_zone[task]
        before = {o: preparation[node.stance[o]][0] for o, preparation in step.preparations}
        needs = [(operator, before.get(operator, 0)) for operator in step.operators]
        for operator, need in needs:
            start = max(start, node.free[operator] + need)
        for tool, count in step.scarce:
            start = max(start, node.tools[tool][count - 1])
        if zone >= 0 and node.zones[zone]:
            start = max(start, node.zones[zone][len(step.operators) - 1])
        moved = self.instance.has_breaks
        while moved:
            moved = False
            for operator, need in needs:
                for off, back in self.instance.breaks[operator]:
                    if off < start + step.ticks and start - need < back:
                        start, moved = back + need, True
        return start

    def _appended(self, node: Node, task: int, index: int, step: Step, start: int) -> Node:
        instance, end, who = self.instance, start + step.ticks, step.operators
        zone, team = instance.timed_zone[task], instance.team[task]
        # nodes share what did not change: the tuples of the parent are taken over
        free, loads, ends, stance = list(node.free), list(node.loads), list(node.ends), node.stance
        for operator, load in zip(who, step.load, strict=True):
            free[operator] = end
            loads[operator] += load
        ends[task] = end
        if step.preparations:
            taken_up = dict(step.preparations)
            stance = tuple(
                taken_up[operator][held][1] if operator in taken_up else held
                for operator, held in enumerate(stance)
            )
        tools = node.tools
        for tool, count in step.scarce:
            tools = _taken(tools, tool, count, end)
        # the first task of those that need the same operators settles them for the others
        teams = node.teams
        if team >= 0 and all(other != team for other, _ in teams):
            teams = tuple(sorted([*teams, (team, who)]))
        return Node(
            mask=node.mask | 1 << task,
            last=start,
            free=tuple(free),
            stance=stance,
            ends=tuple(ends),
            tools=tools,
            zones=_taken(node.zones, zone, len(who), end),
            loads=tuple(loads),
            stress=node.stress + step.stress,
            humans=node.humans | self.human[task][index] << task,
            teams=teams,
            step=(task, step, start),
            before=node,
        )

    def _is_harmless(self, task: int, step: Step) -> bool:
        others = self.layout.steps[task]
        least = all(_is_no_harder(step, other) for other in others)
        return (
            least
            and not self.prepares
            and self.instance.team[task] < 0
            and (self.instance.stress_of_set is None or len(others) == 1)
        )


def _is_no_harder(step: Step, other: Step) -> bool:
    """Whether no operator has more stress in the first than in the second."""
    loads = dict(zip(other.operators, other.load, strict=True))
    return all(
        load <= loads.get(operator, 0)
        for operator, load in zip(step.operators, step.load, strict=True)
    )


def _taken(
    places: tuple[tuple[int, ...], ...], which: int, count: int, end: int
) -> tuple[tuple[int, ...], ...]:
    """The places after `count` of those that are free first are taken until `end`."""
    if which < 0 or not places[which]:
        return places
    row = tuple(sorted([*places[which][count:], *[end] * count]))
    return (*places[:which], row, *places[which + 1 :])
