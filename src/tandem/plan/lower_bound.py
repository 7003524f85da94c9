"""Proofs that no schedule is quicker, for cells with few operators, by search over partial
schedules along the clock.

To refute "the makespan is at most u", partial schedules are grown task by task in order of start
(see `along_clock`), all of one size at a time. A partial schedule is dropped when bounds show that
it cannot end by u, or when another one with the same tasks is as early in every respect that later
tasks can notice. When none is left, u is refuted; when one is complete, it is a quicker schedule.

What is kept of a cell: operators, ways, precedence, releases, deadlines, and a limit on the sum of
stress. Tools, zones, breaks, teams, limits per human and tables of stress are left out. So what is
refuted here is refuted for the cell, and what is found may break it: the checker decides. Of waits
the least ones count in how long at least a chain of tasks takes, and nowhere else.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from heapq import heappop, heappush, heapreplace
from operator import gt, mul
from time import perf_counter
from typing import NamedTuple

from tandem.plan.bounds import WorkPrices, least_makespan
from tandem.plan.instance import Instance, bits
from tandem.plan.list_scheduling import Layout, Step

MOST_NODES = 400_000
"""Nodes of one size kept at once before the proof is given up."""


@dataclass(frozen=True)
class Proof:
    """How far it went.

    Attributes:
      bound: ticks; no schedule is quicker. Equal to `upper` when that is proven to be the least
        makespan.
      upper: ticks; the makespan asked about, or of the better schedule that was found.
      starts: that better schedule, per task `(way, start)`; None when none was found. It may break
        rules of the cell that are left out here.
      nodes: partial schedules that were kept, in all.
      wall_s: time spent.
    """

    bound: int
    upper: int
    starts: list[tuple[int, int]] | None
    nodes: int
    wall_s: float


def prove_makespan(
    instance: Instance,
    upper: int,
    deadline_s: float,
    *,
    most_units: int | None = None,
    width: int = 40,
    stop: Callable[[], bool] = lambda: False,
) -> Proof:
    """Proves that no schedule is quicker than `upper` ticks, or finds one that is and goes on from
    there.

    Args:
      deadline_s: seconds that it may take.
      most_units: of schedules with at most this sum of stress; all when None.
      width: before the proof, a search that keeps only so many of the best partial schedules of
        each size looks for something quicker.
      stop: asked now and then; true ends the search as if its time were up.
    """
    began = perf_counter()
    layout = Layout.of(instance)
    prices, bound, best, nodes = WorkPrices.of(layout), least_makespan(layout), None, 0

    def is_over() -> bool:
        return stop() or perf_counter() - began > deadline_s

    # each round asks for something quicker; a narrow search first, since what it finds makes the
    # wide one, which alone can prove, smaller
    while bound < upper:
        for narrow in (width, None):
            growth = _Growth(Ground.of(layout, prices, upper - 1, most_units), narrow, is_over)
            found = growth.run()
            nodes += growth.nodes
            if found is not None or growth.cut_short:
                break
        # a quicker schedule is no proof: the next round asks below it
        if found is not None:
            best, upper = (
                found,
                max(
                    start + layout.instance.ways[task][way].ticks
                    for task, (way, start) in enumerate(found)
                ),
            )
        elif growth.cut_short:
            break
        else:
            bound = upper
    return Proof(bound, upper, best, nodes, perf_counter() - began)


class Node(NamedTuple):
    """A partial schedule: tasks appended as bits, start of the last one, operators' and tasks'
    ends, stress, and what it grew from.
    """

    mask: int
    last: int
    free: tuple[int, ...]
    ends: tuple[int, ...]
    units: int
    step: tuple[int, int, int] | None
    before: Node | None


@dataclass(frozen=True)
class Ground:
    """One question, "is there a schedule of at most `most` ticks?", and what answers it quickly.

    Attributes:
      most_units: the most stress that such a schedule may have; None for any.
      kinds: the different sets of operator groups that tasks can be done by; `kind`: each task's.
      needs: per task, bits of its predecessors, and of the twin before it: of tasks that nothing
        tells apart the first goes first.
      latest_end: per task, ticks so that deadlines and `most` are kept; `latest_start` likewise.
      own: per operator, tasks that all ways need them for. `can`: that some way needs them for.
    """

    layout: Layout
    prices: WorkPrices
    most: int
    most_units: int | None
    kinds: list[tuple[tuple[int, ...], ...]]
    kind: list[int]
    needs: list[int]
    latest_end: list[int]
    latest_start: list[int]
    own: list[list[int]]
    can: list[list[int]]

    @classmethod
    def of(cls, layout: Layout, prices: WorkPrices, most: int, most_units: int | None) -> Ground:
        """Reads the layout."""
        instance = layout.instance
        ends = layout.latest_ends(most)
        # tasks that the same operators can do, in any way, are alike to the bounds
        groups = [tuple(sorted({step.operators for step in row})) for row in layout.steps]
        kinds = sorted(set(groups))
        operators = range(len(instance.operators))
        who = [[bits(group) for group in kind] for kind in groups]
        return cls(
            layout=layout,
            prices=prices,
            most=most,
            most_units=most_units,
            kinds=kinds,
            kind=[kinds.index(group) for group in groups],
            needs=[
                own | bits(twin) for own, twin in zip(instance.needs, _twins(instance), strict=True)
            ],
            latest_end=ends,
            latest_start=[end - own for end, own in zip(ends, layout.quickest, strict=True)],
            own=[
                [t for t, row in enumerate(who) if row and all(w >> o & 1 for w in row)]
                for o in operators
            ],
            can=[
                [t for t, row in enumerate(who) if any(w >> o & 1 for w in row)] for o in operators
            ],
        )

    @property
    def instance(self) -> Instance:
        """The cell's numbers."""
        return self.layout.instance

    def root(self) -> Node:
        """Nothing is appended, and nobody is free before they come."""
        # Who comes after the end asked about does nothing, and must not seem to work until then.
        free = tuple(min(at, self.most) for at in self.instance.arrival)
        return Node(0, 0, free, (0,) * len(self.kind), 0, None, None)

    def children(self, node: Node) -> Iterator[Node]:
        """Every node with one task more, but for those in which a task starts when another could
        already have ended, at no cost.
        """
        mask, _, free, ends, units, _, _ = node
        moves, cutoff = self._moves(node)
        for start, task, step in moves:
            if start < cutoff:
                end = start + step.ticks
                fresh = list(free)
                for operator in step.operators:
                    fresh[operator] = end
                grown = (*ends[:task], end, *ends[task + 1 :])
                chosen = (task, step.way, start)
                yield Node(
                    mask | 1 << task, start, tuple(fresh), grown, units + step.stress, chosen, node
                )

    def _moves(self, node: Node) -> tuple[list[tuple[int, int, Step]], int]:
        """What can be appended, as `(start, task, step)`; and the moment from which on no start is
        needed, because something else could have ended by then at no cost.
        """
        mask, last, free, ends, _, _, _ = node
        moves: list[tuple[int, int, Step]] = []
        cutoff = self.most + 1
        instance, steps, easiest = self.instance, self.layout.steps, self.layout.easiest
        for task, needs in enumerate(self.needs):
            if mask >> task & 1 or needs & mask != needs:
                continue
            # The task cannot start before the one appended last, its release and predecessors.
            ready = max(last, instance.release[task])
            for first in instance.before[task]:
                if ends[first] > ready:
                    ready = ends[first]
            for step in steps[task]:
                start = ready
                for operator in step.operators:
                    if free[operator] > start:
                        start = free[operator]
                end = start + step.ticks
                if end <= self.latest_end[task]:
                    moves.append((start, task, step))
                    # What starts when this one could have ended can as well come behind it.
                    if end < cutoff and (self.most_units is None or step.stress == easiest[task]):
                        cutoff = end
        return moves, cutoff


class _Rest(NamedTuple):
    """Of one set of appended tasks: the other tasks in order, per operator those that only they and
    that they can do, the tasks waited for, and of what is to come the cheapest work and the least
    stress.
    """

    tasks: tuple[int, ...]
    own: list[list[int]]
    can: list[list[int]]
    waited_for: list[tuple[int, list[int]]]
    work: int
    units: int


class _Growth:
    """One search on one ground. `width` bounds how many nodes of each size are grown further; None
    keeps all, and proves.
    """

    def __init__(self, ground: Ground, width: int | None, is_over: Callable[[], bool]) -> None:
        self.ground, self.width, self.is_over = ground, width, is_over
        self.layout, self.instance, self.prices = ground.layout, ground.instance, ground.prices
        self.nodes = 0
        self.cut_short = False
        self._rests: dict[int, _Rest] = {}

    def run(self) -> list[tuple[int, int]] | None:
        """A schedule, per task `(way, start)`; None when there is none, or none among what was
        kept, or when it was cut short.
        """
        level = [self.ground.root()]
        while level:
            kept: dict[int, list[tuple[tuple[int, ...], int, Node]]] = {}
            self._rests.clear()
            count = 0
            for index, node in enumerate(level):
                if index % 32 == 0 and (self.is_over() or count > MOST_NODES):
                    self.cut_short = True
                    return None
                for child in self.ground.children(node):
                    if self.ground.most_units is not None and child.units > self.ground.most_units:
                        continue
                    if child.mask == self.instance.all_tasks:
                        return self._starts(child)
                    count += self._keep(kept, child)
            self.nodes += count
            items = [item for row in kept.values() for item in row]
            if self.width is not None and len(items) > self.width:
                items = sorted(items, key=lambda item: (item[1], sum(item[0])))[: self.width]
            level = [node for _, _, node in items]
        return None

    def _keep(self, kept: dict[int, list[tuple[tuple[int, ...], int, Node]]], node: Node) -> int:
        """Merges the node into those with the same tasks unless it is hopeless; gives by how many
        they have grown.
        """
        # the cheap reasons first: stress and weighted work take a few sums
        rest = self._rest(node.mask)
        most_units = self.ground.most_units
        if most_units is not None and node.units + rest.units > most_units:
            return 0
        head = self._heads(node, rest)
        if head is None:
            return 0
        numbers = self._numbers(node, rest, head)
        work = rest.work + sum(map(mul, self.prices.of_operator, numbers))
        if work > self.ground.most * self.prices.total:
            return 0
        # whoever has the same tasks and is nowhere later can do whatever this node can
        row = kept.setdefault(node.mask, [])
        for item in row:
            if not any(map(gt, item[0], numbers)):
                return 0
        # each operator's own work, with interruptions allowed, is dearer to reckon: only survivors
        # come here
        bound = max(*node.free, -(-work // self.prices.total))
        for operator, tasks in enumerate(rest.own):
            if tasks:
                free, quickest, behind = (
                    node.free[operator],
                    self.layout.quickest,
                    self.layout.behind,
                )
                jobs = sorted(
                    [
                        (head[task] if head[task] > free else free, -behind[task], quickest[task])
                        for task in tasks
                    ]
                )
                bound = max(bound, _interrupted(jobs))
                if bound > self.ground.most:
                    return 0
        # and the other way round: those that this node dominates go
        before = len(row)
        row[:] = [item for item in row if any(map(gt, numbers, item[0]))]
        row.append((numbers, bound, node))
        return len(row) - before

    def _heads(self, node: Node, rest: _Rest) -> list[int] | None:
        """Per task to come, ticks before which it cannot start; None when one of them is too
        late.
        """
        ground, last, free = self.ground, node.last, node.free
        release, before, quickest = (
            self.instance.release,
            self.instance.before,
            self.layout.quickest,
        )
        base = [
            max(last, min([max([free[o] for o in group]) for group in kind], default=last))
            for kind in ground.kinds
        ]
        head, ends = [0] * len(ground.kind), list(node.ends)
        for task in rest.tasks:
            start = base[ground.kind[task]]
            if release[task] > start:
                start = release[task]
            for first in before[task]:
                if ends[first] > start:
                    start = ends[first]
            if start > ground.latest_start[task]:
                return None
            head[task] = start
            ends[task] = start + quickest[task]
        return head

    def _numbers(self, node: Node, rest: _Rest, head: list[int]) -> tuple[int, ...]:
        """What later tasks can notice: when each operator can be used again, and when what they
        wait for has ended.

        An operator is of no use before some task can start that they can do; the end of a task
        plays no part before an operator is free for what comes after it. Raised so far, the numbers
        of equal futures become equal.
        """
        ground, ends = self.ground, node.ends
        free = [
            max(node.free[operator], min([head[task] for task in tasks]))
            if tasks
            else node.free[operator]
            for operator, tasks in enumerate(rest.can)
        ]
        base = [
            min([max([free[o] for o in group]) for group in kind], default=0)
            for kind in ground.kinds
        ]
        numbers = free
        for task, kinds in rest.waited_for:
            floor = min([base[kind] for kind in kinds])
            numbers.append(ends[task] if ends[task] > floor else floor)
        if ground.most_units is not None:
            numbers.append(node.units)
        return tuple(numbers)

    def _rest(self, mask: int) -> _Rest:
        known = self._rests.get(mask)
        if known is None:
            ground, instance = self.ground, self.instance
            waited_for = []
            for task in instance.order:
                if mask >> task & 1 and (
                    kinds := [
                        ground.kind[after]
                        for after in instance.behind[task]
                        if not mask >> after & 1
                    ]
                ):
                    waited_for.append((task, kinds))
            tasks = tuple(task for task in instance.order if not mask >> task & 1)
            known = self._rests[mask] = _Rest(
                tasks,
                [[task for task in own if not mask >> task & 1] for own in ground.own],
                [[task for task in can if not mask >> task & 1] for can in ground.can],
                waited_for,
                sum(self.prices.work[task] for task in tasks),
                sum(self.layout.easiest[task] for task in tasks),
            )
        return known

    def _starts(self, node: Node) -> list[tuple[int, int]]:
        starts = [(0, 0)] * len(self.instance.tasks)
        here: Node | None = node
        while here is not None and here.step is not None:
            task, way, start = here.step
            starts[task] = (way, start)
            here = here.before
        return starts


def _interrupted(jobs: Sequence[tuple[int, int, int]]) -> int:
    """As `bounds.preemptive`, for tasks `(head, -tail, ticks)` sorted by head: one operator who may
    interrupt, ticks.
    """
    open_: list[tuple[int, int]] = []
    clock = best = 0
    for head, tail, ticks in jobs:
        while open_ and clock < head:
            first, work = open_[0]
            if clock + work <= head:
                heappop(open_)
                clock += work
                if clock - first > best:
                    best = clock - first
            else:
                heapreplace(open_, (first, work - head + clock))
                clock = head
        if clock < head:
            clock = head
        heappush(open_, (tail, ticks))
    while open_:
        first, work = heappop(open_)
        clock += work
        if clock - first > best:
            best = clock - first
    return best


def _twins(instance: Instance) -> list[tuple[int, ...]]:
    """Per task, the task before it that nothing tells apart from it: same ways, release, deadline,
    predecessors and successors, and neither waits; or none.
    """
    latest: dict[tuple[object, ...], int] = {}
    twins: list[tuple[int, ...]] = []
    for task, ways in enumerate(instance.ways):
        before, behind = frozenset(instance.before[task]), frozenset(instance.behind[task])
        key = (ways, before, behind, instance.release[task], instance.deadline[task])
        if instance.has_lags and (instance.lags_into[task] or instance.lags_from[task]):
            twins.append(())
            continue
        twins.append((latest[key],) if key in latest else ())
        latest[key] = task
    return twins
