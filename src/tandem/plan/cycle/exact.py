"""Exact planning of a station that repeats, with CP-SAT: the complete front of cycle time and
stress, or one pattern, with proof.

The front is walked from the quickest cycle on: the least cycle time below a stress, the least
stress of that cycle time, and on below it. Where nothing but the work of each operator can bind,
the least cycle time is the most that one of them has to do, and who does what settles it: the order
is then free, since a task can wait for a cycle more. Behind each point at last the fewest products
in process, and of those the shortest stay, is asked for.
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from time import monotonic
from typing import NamedTuple

from ortools.sat.python import cp_model

from tandem.cell.model import Cell
from tandem.errors import InfeasibleError, NothingFoundError
from tandem.plan import cpsat
from tandem.plan.cpsat import SOLVER
from tandem.plan.cycle.door import Admitted, CycleDoor
from tandem.plan.cycle.effort import Answer, Effort
from tandem.plan.cycle.model import Cycle, allocation, formulate
from tandem.plan.cycle.pattern import Pattern, launched, lifted, makespan, stacked
from tandem.plan.cycle.question import FRONT, CycleQuestion, whole
from tandem.plan.cycle.result import CycleBound, CycleFront, CycleResult
from tandem.plan.door import RefusedScheduleWarning
from tandem.plan.goal import Meter
from tandem.plan.instance import Instance
from tandem.plan.race import MANY_TICKS
from tandem.plan.result import Status

MANY = 24
"""With more tasks, the first pattern of a search may take long."""
FIRST = 0.5
"""CP-SAT's deterministic seconds for a pattern to begin with."""
SETTLING = (0.01, 0.1)
"""CP-SAT's deterministic seconds for the choice among the patterns of a point; more are spent only
when none was found.
"""


@dataclass(frozen=True)
class Point:
    """A pattern of the front, and what is proven of it.

    Attributes:
      least_length: ticks; no pattern of at most this stress has a lesser cycle time.
      least_stress: units; no pattern of at most this cycle time has less.
      least_in_process: no pattern of this cycle time and stress has fewer.
      canonical: chosen by the rule of the last step.
    """

    found: Admitted
    least_length: int
    least_stress: int
    least_in_process: int
    canonical: bool = False

    @property
    def proven(self) -> bool:
        """Nothing beats it in both."""
        return self.found.length == self.least_length and self.found.stress == self.least_stress


def solve(
    cell: Cell,
    question: CycleQuestion = FRONT,
    *,
    time_limit: float | None = None,
    work: float | None = None,
    seed: int = 0,
    workers: int | None = None,
    on_point: Callable[[int], None] | None = None,
) -> CycleFront:
    """The front or the one best pattern that the question asks for, proven as far as time allows.

    Args:
      time_limit: seconds; None until everything is proven.
      work: a limit on work instead, in CP-SAT's deterministic seconds; one thread works then, no
        clock is asked, and the run repeats.
      on_point: called with how many points there are, with each new one; may raise
        KeyboardInterrupt.

    Raises:
      InfeasibleError: it is proven that no pattern answers the question.
      NothingFoundError: none was found within the limit.
    """
    meter = None if work is None else Meter(work)
    threads = 1 if meter is not None else workers or os.cpu_count() or 1
    search = _Search(cell, question, time_limit, Effort(None, seed, threads, meter), on_point)
    interrupted = False
    try:
        search.run()
    except KeyboardInterrupt:
        if not search.points and search.first is None:
            raise
        interrupted = True
    return search.front(interrupted)


class _Starts(NamedTuple):
    """A pattern and its cycle time, ticks, as a model describes them."""

    pattern: Pattern
    length: int


class _Trial(NamedTuple):
    """One cycle time tried: what the solver says, and the pattern if there is one."""

    answer: Answer
    found: _Starts | None


class _Search:
    def __init__(
        self,
        cell: Cell,
        question: CycleQuestion,
        time_limit: float | None,
        effort: Effort,
        on_point: Callable[[int], None] | None,
    ) -> None:
        self.began = monotonic()
        self.cell, self.question, self.effort, self.on_point = cell, question, effort, on_point
        effort.until = None if time_limit is None else self.began + time_limit
        self.instance = instance = Instance.of(cell)
        self.door = CycleDoor(cell, instance, question)
        self.takt = whole(question.takt, instance.per_second)
        # no cycle is looked for that is longer
        self.longest = min(instance.horizon, instance.horizon if self.takt is None else self.takt)
        # None while nothing limits the products in process
        self.laps = question.max_in_process
        self.max_stress = whole(question.max_stress, instance.per_stress)
        self.points: list[Point] = []
        # a pattern to begin with, which counts as long as nothing answers the question better
        self.first: Point | None = None
        self.closed = False

    # ------------------------------------------------------------ the search

    def run(self) -> None:
        """Answers the question as far as time allows."""
        if self.instance.tied and not self._one_product_can_be_made():
            self.closed = True
            return
        if len(self.instance.tasks) > MANY and not self.only_load_binds:
            # so that whoever stops the search has something in hand
            first = self._one_after_the_other(self.max_stress, work=FIRST)
            if first is not None:
                self.first = self._point(first, 1, 0)
                self.points.clear()
        if self.question.takt is not None:
            self._within_takt()
        elif self.question.minimize == "stress":
            self._least_stress_first()
        else:
            self._walk()
        self._settle()

    def _one_product_can_be_made(self) -> bool:
        """False when it is proven that not even one product can be made, by operators who have the
        tools at hand: then none can be made again and again.
        """
        answer = self.effort.solve(self._one_product().model, 0, share=0.25)
        return answer.solver is not None or not answer.proven

    def _one_product(self) -> cpsat.Decisions:
        """The model of one product by operators who have no breaks and the tools at hand."""
        nobody = (None,) * len(self.instance.operators)
        none = ((),) * len(self.instance.operators)
        alone = replace(self.instance, breaks=none, in_hand=nobody, stands=nobody)
        return cpsat.formulate(alone, alone.horizon)

    def _one_after_the_other(self, cap: int | None, work: float | None = None) -> _Starts | None:
        """A pattern in which the station is empty between two products, as long as no better one is
        known: after the last task everybody has the time to get ready for the first.
        """
        plan = self._one_product()
        if cap is not None:
            plan.model.add(plan.stress <= cap)
        answer = self.effort.solve(plan.model, plan.makespan, share=0.5, work=work)
        if answer.solver is None:
            return None
        pattern = launched(plan.read(answer.solver.value))
        length = makespan(self.instance, pattern) + max(self.instance.longest_preparation)
        return _Starts(pattern, length) if length <= self.longest else None

    def _walk(self) -> None:
        """From the least cycle time on; only to that where nothing else is asked for."""
        cap, low = self.max_stress, 1
        while not self.effort.is_spent:
            quickest, starts = self._least_length(low, cap)
            if starts is None:
                self.closed = quickest.proven
                return
            calmest, better = self._least_stress(cap, starts.length)
            least_stress = calmest.bound if better is not None else 0
            point = self._point(better or starts, max(quickest.bound, low), least_stress)
            if point is None:
                return
            if self.question.minimize == "cycle_time":
                self.closed = point.proven
                return
            cap, low = point.found.stress - 1, point.least_length + 1
            if cap < 0:
                self.closed = point.proven
                return

    def _least_stress_first(self) -> None:
        """The least stress of any pattern, then the least cycle time that has it."""
        calmest, starts = self._least_stress(self.max_stress)
        if starts is None:
            self.closed = calmest.proven
            return
        quickest, better = self._least_length(1, calmest.value)
        bound = quickest.bound if better is not None else 1
        point = self._point(better or starts, bound, calmest.bound)
        self.closed = point is not None and point.proven

    def _within_takt(self) -> None:
        """The least stress that keeps the takt; then the fewest in process, and the least cycle
        time of those.
        """
        if self.longest < 1:
            self.closed = True  # less than a tick
            return
        calmest, starts = self._least_stress(self.max_stress)
        if starts is None:
            self.closed = calmest.proven
            return
        first = self._point(starts, 1, calmest.bound)
        if first is None:
            return
        self.closed = calmest.proven
        self._fewest_in_process(first)

    def _fewest_in_process(self, first: Point) -> None:
        """Puts one product after the other in the station, until the takt can be kept."""
        known, stress = first.found, first.found.stress
        for laps in range(1, known.in_process + 1):
            if self.effort.is_spent:
                self.closed = False
                return
            self.laps = laps
            if self.is_monotone and (trial := self._refuted_or_found(self.longest, stress)):
                self.closed = self.closed and (trial.answer.proven or trial.found is not None)
                if trial.found is None:
                    continue
            quickest, starts = self._least_length(1, stress)
            if starts is not None:
                self.points.clear()
                point = self._point(starts, quickest.bound, first.least_stress)
                self.closed = self.closed and quickest.proven and point is not None
                return
            self.closed = self.closed and quickest.proven

    # ------------------------------------------------------------ single questions

    @property
    def is_monotone(self) -> bool:
        """What is possible in a cycle is possible in every longer one: the pattern waits a tick
        more at the end of each. Where something must follow in time, that may be too long.
        """
        return not self.instance.has_most_lags

    @property
    def only_load_binds(self) -> bool:
        """The work of each operator alone decides about the cycle time, and any order will do."""
        instance = self.instance
        return (
            self.laps is None
            and not (instance.has_tools or instance.has_preparations)
            and not (instance.has_apart or instance.tied)
            and max(instance.timed_zone, default=-1) < 0
            and all(len(way.operators) == 1 for ways in instance.ways for way in ways)
        )

    def _asked(self, low: int, high: int, cap: int | None) -> Cycle:
        """The model of cycle times from `low` to `high` ticks and at most this stress."""
        if self.only_load_binds:
            cycle = allocation(self.instance, high)
            cycle.model.add(cycle.length >= low)
        else:
            cycle = formulate(self.instance, low, high, self.laps)
        if cap is not None:
            cycle.model.add(cycle.stress <= cap)
        return cycle

    def _least_length(self, low: int, cap: int | None) -> tuple[Answer, _Starts | None]:
        """The least cycle time at or above `low` of patterns with at most this stress."""
        if not self.only_load_binds:
            # what the work of each asks for is a bound, and often enough
            cycle = allocation(self.instance, self.longest)
            if cap is not None:
                cycle.model.add(cycle.stress <= cap)
            load = self.effort.solve(cycle.model, cycle.length, share=0.25)
            if load.solver is None and load.proven:
                return load, None
            low = max(low, load.bound)
            at_once = self._refuted_or_found(low, cap, share=0.25)
            if at_once.found is not None:
                return Answer(at_once.answer.solver, low, low, True), at_once.found
            low += at_once.answer.proven
            if low > self.longest:
                return Answer(None, None, 0, True), None
            if self.longest - low > MANY_TICKS and self.is_monotone:
                return self._halved(low, cap)
        cycle = self._asked(low, self.longest, cap)
        answer = self.effort.solve(cycle.model, cycle.length, share=0.5)
        if answer.solver is not None or answer.proven:
            return answer, None if answer.solver is None else self._read(cycle, answer.solver)
        found = self._one_after_the_other(cap)
        return Answer(None, None if found is None else found.length, low, False), found

    def _halved(self, low: int, cap: int | None) -> tuple[Answer, _Starts | None]:
        """The same where the ticks are fine, and a search that moves its bound tick by tick would
        take too long: spans of cycle times are refuted, at first short ones, then halves.
        """
        best: tuple[Answer, _Starts] | None = None
        step, high = 1, self.longest
        while low <= high:
            # while nothing is known, steps that double; then the middle
            length = min(low + step - 1, high) if best is None else (low + high) // 2
            step *= 2
            answer, found = self._refuted_or_found(length, cap)
            if found is not None:
                best = answer, found
                high = length - 1
            elif answer.proven:
                low = length + 1
            else:
                break
        if best is None:
            return Answer(None, None, 0, low > high), None
        return Answer(best[0].solver, best[1].length, low, low > high), best[1]

    def _refuted_or_found(self, length: int, cap: int | None, share: float = 0.5) -> _Trial:
        """Any pattern of this cycle time and at most this stress."""
        cycle = self._asked(length, length, cap)
        answer = self.effort.solve(cycle.model, 0, share=share)
        found = None if answer.solver is None else self._read(cycle, answer.solver)
        return _Trial(answer, found)

    def _least_stress(
        self, cap: int | None, length: int | None = None
    ) -> tuple[Answer, _Starts | None]:
        """The least stress of patterns of this cycle time; of any, when none is given."""
        if length is None and self.is_monotone:
            length = self.longest
        low, high = (1, self.longest) if length is None else (length, length)
        cycle = self._asked(low, high, cap)
        answer = self.effort.solve(cycle.model, cycle.stress, share=0.5)
        return answer, None if answer.solver is None else self._read(cycle, answer.solver)

    def _read(self, cycle: Cycle, solver: cp_model.CpSolver) -> _Starts:
        """The pattern that was found, from its launch on."""
        length = solver.value(cycle.length)
        if cycle.makespan is not None:
            return _Starts(launched(cycle.read(solver.value)), length)
        if cycle.place:
            return _Starts(lifted(self.instance, cycle.read(solver.value), length), length)
        ways = [next(w for w, x in enumerate(xs) if solver.value(x)) for xs in cycle.chosen]
        return _Starts(lifted(self.instance, stacked(self.instance, ways), length), length)

    def _point(self, starts: _Starts, least_length: int, least_stress: int) -> Point | None:
        found = self.door.vouched(*starts)
        if found is None:
            return None
        fewest = min(-(-self._least_stay() // found.length), found.in_process)
        point = Point(found, least_length, least_stress, fewest)
        self.points.append(point)
        if self.on_point is not None:
            self.on_point(len(self.points))
        return point

    def _least_stay(self) -> int:
        """No product is out sooner than its longest chain of tasks takes, ticks."""
        return max(
            head + tail for head, tail in zip(self.instance.head, self.instance.tail, strict=True)
        )

    def _settle(self) -> None:
        """Behind each point the fewest in process; several points at once."""
        with ThreadPoolExecutor(self.effort.workers) as pool:
            settling = [pool.submit(self._settled, point) for point in self.points]
            try:
                for place, settled in enumerate(settling):
                    self.points[place] = settled.result()
            except KeyboardInterrupt:
                self.effort.stop()
                self.points = [settled.result() for settled in settling]
                raise

    def _settled(self, point: Point) -> Point:
        """The point with the fewest in process behind it and, of such patterns, the one of the
        shortest stay that bounded work of one thread finds: the same in every run.
        """
        found = point.found
        for laps in range(point.least_in_process, found.in_process + 1):
            point = replace(point, least_in_process=laps)
            cycle = self._behind(found, laps)
            assert cycle.makespan is not None
            for work in SETTLING:
                if self.effort.is_spent:
                    return point
                choice = self.effort.solve(cycle.model, cycle.makespan, work=work)
                if choice.solver is not None or choice.proven:
                    break
            if choice.solver is not None:
                chosen = self.door.vouched(*self._read(cycle, choice.solver))
                if chosen is None or chosen.stress > found.stress:
                    return point
                canonical = point.proven and not choice.ended_by_clock
                return replace(point, found=chosen, canonical=canonical)
            if not choice.proven and laps < found.in_process:
                # what bounded work does not settle, all the time that is left may
                anything = self.effort.solve(cycle.model, 0, share=0.5)
                if anything.solver is not None:
                    better = self.door.vouched(*self._read(cycle, anything.solver))
                    return point if better is None else replace(point, found=better)
                if not anything.proven:
                    return point
        return point

    def _behind(self, found: Admitted, laps: int) -> Cycle:
        """The model of all patterns of the same values, a product in so many cycles."""
        cycle = formulate(self.instance, found.length, found.length, laps)
        cycle.model.add(cycle.stress <= found.stress)
        return cycle

    # ------------------------------------------------------------ the answer

    def front(self, interrupted: bool) -> CycleFront:
        """What was found. Raises as `solve` says."""
        wall = monotonic() - self.began
        kept = " and ".join([*self.question.limits, "the cell's own limits"])
        points = self._answers()
        if not points:
            if self.door.refused:
                raise NothingFoundError(self.door.apology())
            if self.closed:
                raise InfeasibleError(f"no pattern keeps {kept}; this is proven.")
            raise NothingFoundError(
                f"no pattern that keeps {kept} was found in {wall:.1f} s; whether there is one is"
                " open."
            )
        if self.door.refused:
            warnings.warn(self.door.apology(), RefusedScheduleWarning, stacklevel=3)
        believed = not self.door.refused
        results = tuple(self._result(point, believed) for point in _undominated(points))
        return CycleFront(
            self.cell,
            results,
            believed and self.closed and all(r.status == Status.OPTIMAL for r in results),
            "exact",
            SOLVER,
            self.effort.seed,
            wall,
            interrupted,
            self.question,
            out_of_time=self.effort.left() <= 0,
        )

    def _answers(self) -> list[Point]:
        """The points that were found; with the first pattern where nothing else was, or where a
        front is not known to its end.
        """
        if self.first is None or (self.points and (self.closed or not self.question.is_front)):
            return self.points
        return [*self.points, self.first]

    def _result(self, point: Point, believed: bool) -> CycleResult:
        found, instance = point.found, self.instance
        proven = believed and (point.proven or (self.takt is not None and self.closed))
        bound = CycleBound(
            instance.seconds(point.least_length if believed else 0),
            instance.stress(point.least_stress if believed else 0),
            point.least_in_process if believed else 1,
        )
        status = Status.OPTIMAL if proven else Status.FEASIBLE
        return CycleResult(self.cell, found.periodic, status, bound, point.canonical)


def _undominated(points: list[Point]) -> list[Point]:
    """Those that none beats in both, by cycle time."""
    kept: list[Point] = []
    for point in sorted(points, key=lambda point: (point.found.length, point.found.stress)):
        if not kept or point.found.stress < kept[-1].found.stress:
            kept.append(point)
    return kept
