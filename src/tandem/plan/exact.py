"""Exact planning with CP-SAT: the complete front, or the one best schedule, with proof.

The dispatch rules give the first schedules. `sweep` works through a front; a question for one
schedule is a race or two, each with all workers. When time runs out, every point carries the bounds
that were proven for it.
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable
from dataclasses import replace
from decimal import ROUND_FLOOR
from itertools import islice
from math import inf
from random import Random
from time import monotonic
from typing import Any

from tandem.cell.model import Cell
from tandem.errors import InfeasibleError, NothingFoundError
from tandem.plan.archive import Archive
from tandem.plan.bounds import load_prices
from tandem.plan.cpsat import SOLVER
from tandem.plan.door import Admitted, Door, RefusedScheduleWarning
from tandem.plan.goal import Effort, Goal, GoalStatus, Meter
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout
from tandem.plan.method import Hint, Progress, schedules_in
from tandem.plan.opening import opened
from tandem.plan.portfolio import Portfolio
from tandem.plan.provers import Prover, Step
from tandem.plan.question import Question
from tandem.plan.race import SMALL
from tandem.plan.result import Bound, Front, Result, Status
from tandem.plan.rules import SPECS, attempts, build
from tandem.plan.starts import Starts, appended, measures
from tandem.plan.sweep import Sweep
from tandem.plan.weights import MOST_COUNTED, simplest, whole
from tandem.schedule.measures import exact

TOLD = 0.98
"""Of the open area as it was told last: with less than this it is told again."""

AFTERWARDS = 2.0
"""What comes after the search (the last step builds the layout once more, the measures are taken)
lasts about so many times as long as building it did: thousandths of a second, or seconds at
thousands of tasks.
"""
MOST_AFTERWARDS = 0.25
"""Of the time limit it is given no more than this."""

SAMPLING = ("longest-tail", "balanced", "random", "best-of-n", "weighted")
"""Rules that are not tried once more at the beginning: two have been, the others draw many
schedules.
"""


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
    """The front or the one best schedule that the question asks for, proven as far as time allows;
    see `plan.question.Method`. With a limit on `work` everything is done turn by turn in one
    thread, whatever `workers` says.

    Raises:
      InfeasibleError: it is proven that no schedule answers the question.
      NothingFoundError: none was found within the limit.
    """
    meter = None if work is None else Meter(work)
    threads = 1 if meter is not None else workers or os.cpu_count() or 1
    search = _Search(cell, question, time_limit, meter, seed, threads, on_solution)
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
        meter: Meter | None,
        seed: int,
        workers: int,
        on_solution: Callable[[Progress], None] | None,
    ) -> None:
        self.began = monotonic()
        self.until = None if time_limit is None else self.began + time_limit
        self.meter = meter
        self.cell, self.question, self.seed, self.workers, self.on_solution = (
            cell,
            question,
            seed,
            workers,
            on_solution,
        )
        self.asked = question
        self.instance = Instance.of(cell)
        self.layout = Layout.of(self.instance)
        self.limits = Goal(
            1,
            0,
            _limit(question.max_makespan, self.instance.per_second, self.instance.horizon),
            _limit(question.max_stress, self.instance.per_stress, self._most_stress()),
        )
        self.door = Door(cell, self.instance, question)
        self.archive = Archive(cell, self.layout, self.limits)
        self.infeasible = False
        self.optimal: Prover | bool = False
        # of a front all is open until the first schedules and bounds set its frame
        self.open = 1.0 if question.minimize == "front" else None
        if self.until is not None and time_limit is not None:
            # the limit holds for the answer, not for the search alone
            built = monotonic() - self.began
            self.until -= min(AFTERWARDS * built, MOST_AFTERWARDS * time_limit)

    def begin(self, hint: Hint) -> None:
        """The first schedules: the hints, and what the dispatch rules give; what costs more than a
        moment comes after the first.
        """
        if self.layout.impossible():
            return
        # what the user has is first: whatever is found later has to be better
        for hinted in filter(None, map(self.door.hinted, schedules_in(hint))):
            self._offer(self.door.admit(appended(self.layout, hinted.starts)))
            self._offer(hinted)
        random = Random(self.seed)
        # these rules know nothing of listed sets; the attempts below do
        if self.instance.stress_of_set is None:
            self._by_rule("longest-tail", random, None)
            bound, prices = load_prices(self.layout)
            self._note(inf, bound, Prover.SHARED)
            for name in ("balanced", *(name for name in SPECS if name not in SAMPLING)):
                if self.archive.found and self._is_late():
                    return
                self._by_rule(name, random, prices)
            for starts in opened(self.layout, self.question, self.until, self.meter):
                self._offer(self.door.admit(starts))
        few = islice(
            attempts(
                self.layout,
                SPECS["weighted"],
                random,
                self.question,
                lambda: bool(self.archive.found),
            ),
            40,
        )
        # on large cells these attempts take long: they are made only while nothing has been found
        if len(self.instance.tasks) < 100 or not self.archive.found:
            for attempt in few:
                if attempt is not None:
                    self._offer(self.door.admit(attempt.starts()))
                if self._is_late():
                    return

    def _is_late(self) -> bool:
        """The limit is over. A first schedule is looked for all the same."""
        return self.until is not None and monotonic() > self.until

    def _by_rule(self, name: str, random: Random, prices: list[float] | None) -> None:
        if (state := build(self.layout, SPECS[name], random, prices=prices)) is not None:
            self._offer(self.door.admit(state.starts()))

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
            # a schedule that the checker refuses is a bug of ours: it is said, and nothing is
            # called proven
            if self.door.refused:
                raise NothingFoundError(
                    f"no schedule that keeps {_limits(self.question)} was found in {wall:.1f} s:"
                    f" {self.door.apology()}"
                )
            if self.infeasible:
                raise InfeasibleError(
                    f"no schedule keeps {_limits(self.question)}; this is proven."
                )
            if interrupted:
                raise KeyboardInterrupt
            raise NothingFoundError(
                f"no schedule that keeps {_limits(self.question)} was found in {wall:.1f} s;"
                " whether there is one is open."
            )
        # a single answer is complete once it is proven, a front once nothing lies between its
        # points
        results = self._results()
        complete = (
            self.archive.complete
            if self.question.minimize == "front"
            else results[0].status == Status.OPTIMAL
        )
        if self.door.refused:
            complete = False
            warnings.warn(self.door.apology(), RefusedScheduleWarning, stacklevel=3)
        return Front(
            self.cell,
            results,
            complete,
            "exact",
            SOLVER,
            self.seed,
            wall,
            interrupted,
            self.asked,
            out_of_time=self._is_late(),
            **self._open_part(),
        )

    def _open_part(self) -> dict[str, Any]:
        """What a front says of the part of it that is not known."""
        if self.question.minimize != "front" or self.archive.complete or self.door.refused:
            return {}
        corners = tuple(
            (self.instance.seconds(makespan), self.instance.stress(stress))
            for makespan, stress in self.archive.bound_points
        )
        return {"bound_front": corners, "open_area": self.archive.open_area()}

    def _results(self) -> tuple[Result, ...]:
        if self.question.minimize == "front":
            return self.archive.results()
        best = min(self.archive.points, key=self._rank)
        result = self.archive.result(best, proven=self.optimal or None)
        if self.question.minimize == "weighted" and not self.optimal:
            makespan = self.instance.seconds(int(self.archive.least_makespan(inf)))
            stress = self.instance.stress(self.archive.least_stress)
            low = Bound(
                makespan,
                stress,
                (Step(makespan, self.archive.prover_of(inf)),),
                (Step(stress, Prover.LEAST_STRESS),),
            )
            result = Result(self.cell, result.schedule, Status.FEASIBLE, low)
        return (result,)

    def _rank(self, point: tuple[int, int]) -> tuple[int, ...]:
        if self.question.minimize == "weighted":
            return (Goal(*whole(self.question, self.instance)).value(*point), *point)
        return point[::-1] if self.question.minimize == "stress" else point

    def _front(self) -> None:
        """Gap by gap."""
        self.open = self.archive.open_area()
        self._tell()
        Sweep(self.archive, self.door, self._effort(), self._tell_less_open).run()
        self.infeasible = not self.archive.found and not self.archive.gaps

    def _quickest(self, cap: int | None) -> GoalStatus:
        """The least makespan under the cap on stress and, at that makespan, the least stress; facts
        are learned on the way.
        """
        limits = self.limits
        top = inf if cap is None else cap
        factor = self._most_stress() + 1
        if len(self.instance.tasks) <= SMALL and self._can_count(Goal(factor, 1)):
            both = self._race(Goal(factor, 1, limits.max_makespan, cap))
            for bound, by in both.steps:
                self._note(top, bound // factor, by)
            if both.starts is not None and both.proven:
                makespan, stress = self._point(both.starts)
                self._note(stress - 1, makespan + 1, both.by)
            elif both.proven:
                self._note(top, inf, both.by)
            return both
        first = self._race(Goal(1, 0, limits.max_makespan, cap))
        if first.starts is None:
            if first.proven:
                self._note(top, inf, first.by)
            return first
        makespan = self._point(first.starts)[0]
        second = self._race(Goal(0, 1, makespan, cap))
        for bound, by in second.steps:
            self._note(bound - 1, makespan + 1, by)
        return GoalStatus(second.starts, first.bound, first.proven and second.proven)

    def _lexicographic(self) -> None:
        """The least of one objective and, at that value, the least of the other."""
        limits = self.limits
        if self.question.minimize == "makespan":
            best = self._quickest(limits.max_stress)
            self.optimal = best.proven
        else:
            first = self._race(Goal(0, 1, limits.max_makespan, limits.max_stress))
            if first.starts is not None:
                for bound, by in first.steps:
                    self._note(bound - 1, inf, by)
                stress = self._point(first.starts)[1]
                best = self._race(Goal(1, 0, limits.max_makespan, stress))
                self.optimal = first.proven and best.proven
            best = first
        self.infeasible = best.starts is None and best.proven

    def _weighted(self) -> None:
        """The least weighted sum and, of those, the least makespan; where no weights of the same
        order are small enough to be counted, it is looked for along the front.
        """
        time, stress = whole(self.question, self.instance)
        if not time or not stress:
            self.question = Question(
                "makespan" if time else "stress",
                self.question.weights,
                self.question.max_makespan,
                self.question.max_stress,
            )
            return self._lexicographic()
        # of equal sums the quickest is wanted, so a tick more counts, less than any sum does
        finer = self._most_ticks() + 1
        time, stress = time * finer + 1, stress * finer
        if not self._can_count(Goal(time, stress)):
            time, stress = simplest(time, stress, self._most_ticks(), self._most_stress())
        if not self._can_count(Goal(time, stress)):
            self._front()
            self.optimal = self.archive.complete
            return None
        answer = self._race(replace(self.limits, time=time, stress=stress))
        self.optimal = answer.proven and answer.by
        self.infeasible = answer.starts is None and answer.proven
        return None

    def _can_count(self, goal: Goal) -> bool:
        """Whether the values of all schedules that may be met are small enough for the solver, and
        the weights too where there is no stress to weigh.
        """
        most = goal.value(self._most_ticks(), self._most_stress())
        return max(most, goal.time, goal.stress) <= MOST_COUNTED

    def _most_ticks(self) -> int:
        """No schedule that is met ends later: from here on tasks are put as early as they can; what
        is known already may be a late hint.
        """
        return max([self.instance.horizon, *(makespan for makespan, _ in self.archive.points)])

    def _race(self, goal: Goal) -> GoalStatus:
        """Works on one goal, from the best schedule known and the best bound known."""
        top = inf if goal.max_stress is None else goal.max_stress
        floor = self.archive.least_makespan(top)
        if floor == inf or (goal.max_makespan is not None and floor > goal.max_makespan):
            return GoalStatus(None, 0, True, by=self.archive.prover_of(top))
        stress = (
            self.archive.least_stress
            if goal.max_makespan is None
            else self.archive.least_stress_within(goal.max_makespan)
        )
        known = goal.time * int(floor) + goal.stress * max(int(stress), 0)
        best = self.archive.best(goal)
        race = Portfolio(self.door, self.layout, goal, self._effort(), best, known)
        try:
            return race.run()
        finally:
            if goal.stress == 0:
                for bound, by in race.answer.steps:
                    self._note(top, bound, by)

    def _effort(self) -> Effort:
        return Effort(
            self.until,
            self.seed,
            self.workers,
            lambda schedule, bound: self._offer(schedule),
            meter=self.meter,
        )

    def _note(self, stress: float, makespan: float, by: Prover) -> None:
        self.archive.learn(stress, makespan, by)

    def _offer(self, schedule: Admitted | None) -> None:
        if schedule is not None and self.archive.offer(schedule):
            self._tell()

    def _tell_less_open(self) -> None:
        """Tells that less of the front is open, when it is much less."""
        if self.archive.open_area() < TOLD * (self.open or 0.0):
            self._tell()

    def _tell(self) -> None:
        if self.on_solution is None or not self.archive.found:
            return
        if self.archive.frame is not None:
            self.open = self.archive.open_area()
        floor = self.instance.seconds(int(self.archive.least_makespan(inf)))
        self.on_solution(
            Progress(self.archive.results(), floor, monotonic() - self.began, self.open)
        )

    def _point(self, starts: Starts) -> tuple[int, int]:
        return measures(self.instance, starts)

    def _most_stress(self) -> int:
        table = self.instance.stress_of_set
        return (
            sum(max(way.stress for way in ways) for ways in self.instance.ways)
            if table is None
            else max(table.values())
        )


def _limit(limit: float | None, scale: int, most: int) -> int | None:
    """The limit in whole numbers, cut down; None when nothing comes near it, so that no solver has
    to count so far.
    """
    if limit is None:
        return None
    whole_ones = int((exact(limit) * scale).to_integral_value(ROUND_FLOOR))
    return whole_ones if whole_ones < most else None


def _limits(question: Question) -> str:
    return " and ".join([*question.limits, "the cell's own limits"])
