"""Exact fronts of small cells by dynamic programming. Shares nothing with the constraint solver, so
that each can judge the other.

Partial schedules grow task by task along the clock (`along_clock.py` says why nothing is lost). Of
those with the same tasks only the ones are kept that no other equals or beats in every number, and
none is kept that bounds show to end no better than what is known.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from importlib.metadata import version
from itertools import chain
from math import floor
from operator import gt
from random import Random
from time import perf_counter

from tandem.cell.model import Cell
from tandem.cell.written import number
from tandem.errors import InfeasibleError, NothingFoundError
from tandem.plan.bounds import least_makespan, least_stress, load_prices
from tandem.plan.chronological import Branching, Key, Node
from tandem.plan.door import Admitted, Door, RefusedScheduleWarning
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout
from tandem.plan.method import Hint, Progress, schedules_in
from tandem.plan.provers import Prover, Step
from tandem.plan.question import Question
from tandem.plan.result import Bound, Front, Result, Status
from tandem.plan.rules import SPECS, attempts
from tandem.plan.weights import whole
from tandem.schedule.measures import exact
from tandem.schedule.model import Schedule

MOST_NODES = 1_000_000
"""Nodes kept at once before the search gives up as if its time had run out: about 1 GiB."""


def solve(
    cell: Cell,
    question: Question = Question(),
    *,
    time_limit: float | None = None,
    work: float | None = None,
    seed: int = 0,
    workers: int | None = None,
    hint: Hint = None,
    on_solution: Callable[[Progress], None] | None = None,
) -> Front:
    """The exact front, or one best schedule, of a small cell (a dozen tasks or so); see
    `plan.question.Method`.

    When time or memory runs out, what was found is given with bounds and `complete` is False.
    `workers` plays no part; `work` counts `NODES_A_SECOND` partial schedules as one.

    Raises:
      InfeasibleError: no schedule answers the question; all have been ruled out.
      NothingFoundError: none was found within the limit.
    """
    search = ExhaustiveSearch(cell, question, time_limit, on_solution, work)
    interrupted = False
    try:
        search.begin(seed, hint)
        search.run()
    except KeyboardInterrupt:
        interrupted = True
    # a schedule that the checker refuses is a bug of ours: it is said, and nothing is called proven
    if search.door.refused:
        if not search.best.found:
            raise NothingFoundError(
                f"no schedule that keeps {limits(question)} was found: {search.door.apology()}"
            )
        warnings.warn(search.door.apology(), RefusedScheduleWarning, stacklevel=2)
    # all was searched, so this is a proof and no lack of time
    if not search.best.found and search.done:
        raise InfeasibleError(
            f"no schedule keeps {limits(question)}: every order and every allocation has been ruled"
            " out."
        )
    if not search.best.found:
        raise NothingFoundError(
            f"no schedule that keeps {limits(question)} was found within the limit; it is open"
            " whether there is one."
        )
    return Front(
        cell,
        search.results(),
        search.done,
        "exhaustive",
        f"tandem {version('tandem')}",
        seed,
        search.wall_s(),
        interrupted,
        question,
        out_of_time=search.is_late,
    )


def limits(question: Question) -> str:
    """The limits of a question in words, with the cell's own."""
    words = ["the cell's own limits"]
    if question.max_makespan is not None:
        words.append(f"a makespan of at most {number(question.max_makespan)} s")
    if question.max_stress is not None:
        words.append(f"a stress of at most {number(question.max_stress)}")
    return " and ".join(words)


NODES_A_SECOND = 4_000
"""Partial schedules taken a task further that count as a unit of work: about what a second is
worth.
"""


@dataclass(frozen=True)
class Best:
    """The schedules known that answer a question and that no other one beats, by (makespan, stress)
    in ticks and units.
    """

    rank: Callable[[int, int], tuple[int, ...]] | None
    found: dict[tuple[int, int], Admitted]

    def beats(self, ticks: int, units: int) -> bool:
        """Whether nothing that is at least so long and so hard is wanted any more."""
        if self.rank is not None:
            return any(self.rank(*point) <= self.rank(ticks, units) for point in self.found)
        return any(time <= ticks and load <= units for time, load in self.found)

    def take(self, schedule: Admitted) -> None:
        """Keeps the schedule instead of those that it beats. Assumes that none beats it."""
        ticks, units = schedule.point
        for time, load in list(self.found):
            if self.rank is not None or (ticks <= time and units <= load):
                del self.found[time, load]
        self.found[ticks, units] = schedule


class ExhaustiveSearch:
    """One search: what is known, and the nodes that are still open. `states` counts those that were
    taken a task further.
    """

    def __init__(
        self,
        cell: Cell,
        question: Question,
        time_limit: float | None,
        on_solution: Callable[[Progress], None] | None,
        work: float | None = None,
    ) -> None:
        self.began = perf_counter()
        self.cell, self.question, self.on_solution = cell, question, on_solution
        self.until = None if time_limit is None else self.began + time_limit
        self.layout = Layout.of(Instance.of(cell))
        self.instance = self.layout.instance
        self.door = Door(cell, self.instance, question)
        self.best = Best(_rank(question, self.instance), {})
        self.most_ticks = _most(
            question.max_makespan, self.instance.per_second, self.instance.horizon
        )
        self.most_units = _most(question.max_stress, self.instance.per_stress, UNREACHABLE - 1)
        self.limits = Limits(self.layout, self.most_ticks)
        self.moves = Branching(self.layout, self.limits.latest_end)
        self.level = [self.moves.root()]
        self.kept: dict[Key, list[tuple[tuple[int, ...], Node]]] = {}
        self.done = False
        self.states = 0
        self.nodes_left = None if work is None else round(work * NODES_A_SECOND)

    def begin(self, seed: int, hint: Hint) -> None:
        """Takes the hints and a few dozen schedules by rules as a start, if they answer the
        question.
        """
        for schedule in schedules_in(hint):
            self.know(schedule)
        specs = ("balanced", "weighted")
        states = chain.from_iterable(
            attempts(
                self.layout, SPECS[name], Random(seed), self.question, lambda: bool(self.best.found)
            )
            for name in specs
        )
        for state in states:
            if state is not None:
                self._take(self.door.admit(state.starts()))
            if self.is_late and self.best.found:
                return

    def know(self, schedule: Schedule) -> None:
        """Begins with this schedule too, if it answers the question."""
        self._take(self.door.hinted(schedule))

    def run(self) -> None:
        """Level by level, one task more each, until nothing is open or time is up."""
        if not self.layout.impossible() and least_stress(self.layout) is not None:
            for _ in self.moves.tasks:
                if not self._grow():
                    return
                self.level, self.kept = [node for row in self.kept.values() for _, node in row], {}
                self.moves.forget()
                self.limits.forget()
        self.level, self.done = [], not self.door.refused

    def _grow(self) -> bool:
        """Takes every node of the level one task further, into what is kept; false when time or
        room is up. A node leaves when it is done with.
        """
        count = 0
        while self.level:
            if count > MOST_NODES or self.is_late or self.nodes_left == 0:
                return False
            self.states += 1
            if self.nodes_left is not None:
                self.nodes_left -= 1
            for child in self.moves.children(self.level[-1], self.most_ticks):
                if child.mask == self.moves.full:
                    self._finish(child)
                elif self._is_promising(child):
                    count += self._keep(child)
            self.level.pop()
        return True

    def results(self) -> tuple[Result, ...]:
        """What is known, by makespan, with the bounds that the open nodes leave; where a node was
        wrong, none but the root counts.
        """
        open_ = [*self.level, *(node for row in self.kept.values() for _, node in row)]
        return self._results(
            [self.limits.of(node) for node in ([self.moves.root()] if self.door.refused else open_)]
        )

    def _results(self, floors: list[tuple[int, int]]) -> tuple[Result, ...]:
        results = []
        for (ticks, units), kept in sorted(self.best.found.items()):
            time = min([ticks, *(time for time, load in floors if load <= units)])
            load = min([units, *(load for time, load in floors if time <= ticks)])
            status = Status.OPTIMAL if (time, load) == (ticks, units) else Status.FEASIBLE
            results.append(
                Result(
                    self.cell,
                    kept.schedule,
                    status,
                    self._bound(time, load),
                )
            )
        return tuple(results)

    def _bound(self, ticks: int, units: int) -> Bound:
        by = Prover.DYNAMIC
        seconds, stress = self.instance.seconds(ticks), self.instance.stress(units)
        return Bound(seconds, stress, (Step(seconds, by),), (Step(stress, by),))

    def wall_s(self) -> float:
        """Since the search began, seconds."""
        return perf_counter() - self.began

    @property
    def is_late(self) -> bool:
        """The time limit is over."""
        return self.until is not None and perf_counter() > self.until

    def _is_promising(self, node: Node) -> bool:
        ticks, units = self.limits.of(node)
        return (
            ticks <= self.most_ticks
            and units <= self.most_units
            and not self.best.beats(ticks, units)
        )

    def _keep(self, node: Node) -> int:
        """Merges the node into those of its key; gives by how many they have grown."""
        numbers = self.moves.numbers(node)
        row = self.kept.setdefault(self.moves.key(node), [])
        for other, _ in row:
            if not any(map(gt, other, numbers)):
                return 0
        before = len(row)
        row[:] = [item for item in row if any(map(gt, numbers, item[0]))]
        row.append((numbers, node))
        return len(row) - before

    def _finish(self, node: Node) -> None:
        units = self.limits.stress_of(node)
        ticks = max(node.free)
        if (
            units is None
            or ticks > self.most_ticks
            or units > self.most_units
            or self.best.beats(ticks, units)
        ):
            return
        schedule = self.door.vouched(self.moves.starts(node))
        if schedule is not None and schedule.point != (ticks, units):
            self.door.refuse([f"it is worth {schedule.point} instead of {(ticks, units)}."])
        self._take(schedule)

    def _take(self, schedule: Admitted | None) -> None:
        if schedule is None or self.best.beats(*schedule.point):
            return
        self.best.take(schedule)
        if self.on_solution is not None:
            floor = self.limits.of(self.moves.root())
            least = max(floor[0], self.limits.least_ticks)
            self.on_solution(
                Progress(
                    self._results([(least, floor[1])]), self.instance.seconds(least), self.wall_s()
                )
            )


class Limits:
    """What no completion of a node can fall below, and by when each task must end."""

    def __init__(self, layout: Layout, most_ticks: int) -> None:
        self.layout, self.instance = layout, layout.instance
        self.least_ticks = least_makespan(layout)
        self.latest_end = layout.latest_ends(most_ticks)
        self.head = layout.head
        _, prices = load_prices(layout)
        self.prices = [round(1024 * price) for price in prices]
        self.table = (
            None
            if self.instance.stress_of_set is None
            else [(_bits(tasks), units) for tasks, units in self.instance.stress_of_set.items()]
        )
        self.behind = layout.behind
        self._of_mask: dict[int, tuple[int, list[tuple[int, int, int]], int]] = {}
        self._of_table: dict[tuple[int, int], int | None] = {}

    def of(self, node: Node) -> tuple[int, int]:
        """Ticks and units that no completion of the node falls below; units beyond any limit when
        no listed set can be reached.
        """
        work, own, load = self._rest(node.mask)
        ticks = max(node.free)
        if node.step is not None:
            ticks = max(ticks, node.ends[node.step[0]] + self.behind[node.step[0]])
        # the work that is left takes operators' time, weighed by the prices, and none of it lies
        # before they are free
        if work:
            begin = [max(free, node.last) for free in node.free]
            ticks = max(
                ticks,
                -(
                    -(
                        work
                        + sum(price * free for price, free in zip(self.prices, begin, strict=True))
                    )
                    // sum(self.prices)
                ),
            )
            ticks = max(
                [
                    ticks,
                    *(
                        max(begin[operator], head) + ticks_ + tail
                        for operator, (head, ticks_, tail) in enumerate(own)
                        if ticks_
                    ),
                ]
            )
        # without a table stress adds up task by task
        if self.table is None:
            return ticks, node.stress + load
        least = self._least_listed(node.mask, node.humans)
        return ticks, UNREACHABLE if least is None else least

    def forget(self) -> None:
        """Lets go of what was remembered for the sets of tasks so far."""
        self._of_mask.clear()
        self._of_table.clear()

    def stress_of(self, node: Node) -> int | None:
        """The stress of a node in which every task is appended; None when its set of tasks with
        humans is not listed.
        """
        return node.stress if self.table is None else self._least_listed(node.mask, node.humans)

    def _rest(self, mask: int) -> tuple[int, list[tuple[int, int, int]], int]:
        """Of the tasks outside the mask: their cheapest work at the prices, per operator `(least
        head, ticks, least tail)` of what only they can do, and their least stress.
        """
        known = self._of_mask.get(mask)
        if known is None:
            # many nodes share a mask, so what depends on it alone is reckoned once
            tasks = [task for task in range(len(self.behind)) if not mask >> task & 1]
            rows = [self.layout.steps[task] for task in tasks]
            work = sum(
                min(step.ticks * sum(self.prices[o] for o in step.operators) for step in row)
                for row in rows
            )
            # work that only one operator can do needs no prices: it is a bound by itself
            own = []
            for operator in range(len(self.prices)):
                mine = [
                    task
                    for task, row in zip(tasks, rows, strict=True)
                    if all(operator in step.operators for step in row)
                ]
                ticks = sum(self.layout.quickest[task] for task in mine)
                own.append(
                    (
                        min((self.head[task] for task in mine), default=0),
                        ticks,
                        min((self.behind[task] for task in mine), default=0),
                    )
                )
            known = self._of_mask[mask] = (
                work,
                own,
                sum(min(step.stress for step in row) for row in rows),
            )
        return known

    def _least_listed(self, mask: int, humans: int) -> int | None:
        """The least stress of a listed set that holds, of the tasks in the mask, exactly those with
        humans.
        """
        if (mask, humans) not in self._of_table:
            self._of_table[mask, humans] = min(
                (units for tasks, units in self.table or () if tasks & mask == humans), default=None
            )
        return self._of_table[mask, humans]


UNREACHABLE = 1 << 200
"""Units of stress that stand for "no listed set can be reached"; a bound only, never shown."""


def _rank(question: Question, instance: Instance) -> Callable[[int, int], tuple[int, ...]] | None:
    """What the one best schedule has least of, in order; None for a front."""
    if question.minimize == "front":
        return None
    if question.minimize == "makespan":
        return lambda ticks, units: (ticks, units)
    if question.minimize == "stress":
        return lambda ticks, units: (units, ticks)
    per_tick, per_unit = whole(question, instance)
    return lambda ticks, units: (per_tick * ticks + per_unit * units, ticks, units)


def _most(limit: float | None, scale: int, otherwise: int) -> int:
    return otherwise if limit is None else floor(exact(limit) * scale)


def _bits(tasks: Iterable[int]) -> int:
    return sum(1 << task for task in tasks)
