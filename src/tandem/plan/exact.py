"""Exact planning with CP-SAT: the complete front, or the one best schedule, with proof.

The dispatch rules give the first schedules. `sweep` works through a front; a question for one schedule is a race or two, each with all workers.
When time runs out, every point carries the bounds that were proven for it.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from decimal import ROUND_FLOOR, Decimal
from fractions import Fraction
from importlib.metadata import version
from itertools import islice
from math import inf, lcm
from random import Random
from time import monotonic

from tandem.cell.model import Cell
from tandem.errors import InfeasibleError, NothingFoundError
from tandem.plan.archive import Archive
from tandem.plan.bounds import load_prices
from tandem.plan.decode import Layout
from tandem.plan.instance import Instance
from tandem.plan.question import Progress, Question
from tandem.plan.race import SMALL, Answer, Effort, Goal, Race
from tandem.plan.result import Bound, Front, Result, Status
from tandem.plan.rules import SPECS, attempts, build
from tandem.plan.starts import Starts, measures
from tandem.plan.sweep import Sweep
from tandem.schedule.checker import faults
from tandem.schedule.model import Schedule

SOLVER = f"cp-sat {version('ortools')}"
SAMPLING = ("longest-tail", "balanced", "random", "best-of-n", "weighted")
"""Rules that are not tried once more at the beginning: two have been, the others draw many schedules."""


def solve(
    cell: Cell,
    question: Question = Question(),
    *,
    time_limit: float | None = None,
    seed: int = 0,
    workers: int | None = None,
    hint: Schedule | None = None,
    on_solution: Callable[[Progress], None] | None = None,
) -> Front:
    """The front or the one best schedule that the question asks for, proven as far as time allows; see `plan.question.Method`.

    Raises:
      InfeasibleError: it is proven that no schedule answers the question.
      NothingFoundError: none was found within the limit.
    """
    search = _Search(cell, question, time_limit, seed, workers or os.cpu_count() or 1, on_solution)
    interrupted = False
    try:
        search.begin(hint)
        search.run()
    except KeyboardInterrupt:
        interrupted = True
    return search.front(interrupted)


class _Search:
    def __init__(
        self,
        cell: Cell,
        question: Question,
        time_limit: float | None,
        seed: int,
        workers: int,
        on_solution: Callable[[Progress], None] | None,
    ) -> None:
        self.began = monotonic()
        self.until = None if time_limit is None else self.began + time_limit
        self.cell, self.question, self.seed, self.workers, self.on_solution = cell, question, seed, workers, on_solution
        self.asked = question
        self.instance = Instance.of(cell)
        self.layout = Layout.of(self.instance)
        self.limits = Goal(1, 0, _floor(question.max_makespan, self.instance.per_second), _floor(question.max_stress, self.instance.per_stress))
        self.archive = Archive(cell, self.layout, self.limits)
        self.infeasible = False
        self.optimal = False

    def begin(self, hint: Schedule | None) -> None:
        """The first schedules: the hint, and what the dispatch rules give; what costs more than a moment comes after the first."""
        if self.layout.impossible():
            return
        if hint is not None and not faults(self.cell, hint):
            self._offer(_starts_of(self.instance, hint), 0)
        random = Random(self.seed)
        if self.instance.stress_of_set is None:
            self._by_rule("longest-tail", random, None)
            bound, prices = load_prices(self.layout)
            self._note(inf, bound)
            for name in ("balanced", *(name for name in SPECS if name not in SAMPLING)):
                self._by_rule(name, random, prices)
        few = islice(attempts(self.layout, SPECS["weighted"], random, self.question, lambda: bool(self.archive.found)), 40)
        if len(self.instance.tasks) < 100 or not self.archive.found:
            for attempt in few:
                if attempt is not None:
                    self._offer(tuple(attempt.starts()), 0)

    def _by_rule(self, name: str, random: Random, prices: list[float] | None) -> None:
        if (state := build(self.layout, SPECS[name], random, prices=prices)) is not None:
            self._offer(tuple(state.starts()), 0)

    def run(self) -> None:
        """Answers the question as far as time allows."""
        if self.question.minimize == "front":
            self._front()
        elif self.question.minimize == "weighted":
            self._weighted()
        else:
            self._lexicographic()

    def front(self, interrupted: bool) -> Front:
        """What was found. Raises as `solve` says."""
        wall = monotonic() - self.began
        if not self.archive.found:
            if self.infeasible:
                raise InfeasibleError(f"no schedule keeps {_limits(self.question)}; this is proven.")
            if interrupted:
                raise KeyboardInterrupt
            raise NothingFoundError(f"no schedule that keeps {_limits(self.question)} was found in {wall:.1f} s; whether there is one is open.")
        results = self._results()
        complete = self.archive.complete if self.question.minimize == "front" else results[0].status == Status.OPTIMAL
        return Front(self.cell, results, complete, "exact", SOLVER, self.seed, wall, interrupted, self.asked)

    def _results(self) -> tuple[Result, ...]:
        if self.question.minimize == "front":
            return self.archive.results()
        best = min(self.archive.points, key=self._rank)
        result = self.archive.result(best, proven=True if self.optimal else None)
        if self.question.minimize == "weighted" and not self.optimal:
            low = Bound(self.instance.seconds(int(self.archive.least_makespan(inf))), self.instance.stress(self.archive.least_stress))
            result = Result(self.cell, result.schedule, Status.FEASIBLE, low)
        return (result,)

    def _rank(self, point: tuple[int, int]) -> tuple[Fraction | int, ...]:
        if self.question.minimize == "weighted":
            return (_weighted_goal(self.question, self.instance, self.limits).value(*point), *point)
        return point[::-1] if self.question.minimize == "stress" else point

    def _front(self) -> None:
        """Gap by gap."""
        Sweep(self.archive, Effort(self.until, self.seed, self.workers, self._offer)).run()
        self.infeasible = not self.archive.found and not self.archive.gaps

    def _quickest(self, cap: int | None) -> Answer:
        """The least makespan under the cap on stress and, at that makespan, the least stress; facts are learned on the way."""
        limits = self.limits
        top = inf if cap is None else cap
        if len(self.instance.tasks) <= SMALL:
            factor = self._most_stress() + 1
            both = self._race(Goal(factor, 1, limits.max_makespan, cap))
            if both.starts is None:
                self._note(top, inf if both.proven else both.bound // factor)
                return both
            makespan, stress = self._point(both.starts)
            self._note(top, both.bound // factor)
            if both.proven:
                self._note(stress - 1, makespan + 1)
            return both
        first = self._race(Goal(1, 0, limits.max_makespan, cap))
        if first.starts is None:
            self._note(top, inf if first.proven else first.bound)
            return first
        self._note(top, first.bound)
        makespan = self._point(first.starts)[0]
        second = self._race(Goal(0, 1, makespan, cap))
        self._note(second.bound - 1, makespan + 1)
        return Answer(second.starts, first.bound, first.proven and second.proven)

    def _lexicographic(self) -> None:
        """The least of one objective and, at that value, the least of the other."""
        limits = self.limits
        if self.question.minimize == "makespan":
            best = self._quickest(limits.max_stress)
            self.optimal = best.proven
        else:
            first = self._race(Goal(0, 1, limits.max_makespan, limits.max_stress))
            if first.starts is not None:
                self._note(first.bound - 1, inf)
                stress = self._point(first.starts)[1]
                best = self._race(Goal(1, 0, limits.max_makespan, stress))
                self._note(stress, best.bound)
                self.optimal = first.proven and best.proven
            best = first
        self.infeasible = best.starts is None and best.proven

    def _weighted(self) -> None:
        goal = _weighted_goal(self.question, self.instance, self.limits)
        if not goal.time or not goal.stress:
            self.question = Question(
                "makespan" if goal.time else "stress", self.question.weights, self.question.max_makespan, self.question.max_stress
            )
            return self._lexicographic()
        answer = self._race(goal)
        self.optimal = answer.proven
        self.infeasible = answer.starts is None and answer.proven
        return None

    def _race(self, goal: Goal) -> Answer:
        """Works on one goal, from the best schedule known and the best bound known."""
        top = inf if goal.max_stress is None else goal.max_stress
        floor = self.archive.least_makespan(top)
        if floor == inf or (goal.max_makespan is not None and floor > goal.max_makespan):
            return Answer(None, 0, True)
        stress = self.archive.least_stress if goal.max_makespan is None else self.archive.least_stress_within(goal.max_makespan)
        known = goal.time * int(floor) + goal.stress * max(int(stress), 0)
        effort = Effort(self.until, self.seed, self.workers, self._offer)
        race = Race(self.instance, self.layout, goal, effort, self.archive.best(goal), known)
        try:
            return race.run()
        finally:
            if goal.stress == 0:
                self._note(top, race.bound)

    def _note(self, stress: float, makespan: float) -> None:
        self.archive.learn(stress, makespan)

    def _offer(self, starts: Starts, bound: int) -> None:
        if self.archive.offer(starts) and self.on_solution is not None:
            floor = self.instance.seconds(int(self.archive.least_makespan(inf)))
            self.on_solution(Progress(self.archive.results(), floor, monotonic() - self.began))

    def _point(self, starts: Starts) -> tuple[int, int]:
        self.archive.offer(starts)
        return measures(self.instance, starts)

    def _most_stress(self) -> int:
        table = self.instance.stress_of_set
        return sum(max(way.stress for way in ways) for ways in self.instance.ways) if table is None else max(table.values())


def _floor(limit: float | None, scale: int) -> int | None:
    return None if limit is None else int((Decimal(repr(float(limit))) * scale).to_integral_value(ROUND_FLOOR))


def _weighted_goal(question: Question, instance: Instance, limits: Goal) -> Goal:
    """The question's weights as whole numbers: nothing is rounded."""
    time = Fraction(Decimal(repr(question.weights[0]))) / instance.per_second
    stress = Fraction(Decimal(repr(question.weights[1]))) / instance.per_stress
    scale = lcm(time.denominator, stress.denominator)
    return Goal(int(time * scale), int(stress * scale), limits.max_makespan, limits.max_stress)


def _starts_of(instance: Instance, schedule: Schedule) -> Starts:
    """A sound schedule in the instance's numbers."""
    by_task = {a.task: a for a in schedule}
    starts = []
    for task, ways in enumerate(instance.ways):
        row = by_task[instance.tasks[task]]
        start, end = (int(Decimal(repr(moment)) * instance.per_second) for moment in (row.start, row.end))
        team = tuple(sorted(instance.operators.index(name) for name in row.operators))
        starts.append((next(w for w, way in enumerate(ways) if way.operators == team and way.ticks == end - start), start))
    return tuple(starts)


def _limits(question: Question) -> str:
    return " and ".join([*question.limits, "the cell's own limits"])
