"""One schedule for one question: which of the schedules of a makespan and a stress stands behind a
proven point.

A search proves values; the schedule that it ends with is whichever of equal ones a thread found
first. So the last step of planning asks anew, with nothing in hand but the values, for the first
schedule by this rule:

1. the least spread of stress: the most that one human has, less the least that one has (where there
   are several humans and stress adds up);
2. of those, the least sum of starts;
3. of those, the least start of the cell's first task, then of its second, and so on;
4. of those, the first task done by the operators who stand first in the cell, then the second.

Nothing else goes in: no seed, no hint, no clock, and not how many work at it. Every question is put
to CP-SAT with one worker and bounded deterministic work, so it is answered in the same way each
time. On cells of up to a dozen tasks or so all four are proven, and the schedule is the rule's own.
On larger ones the work may be used up before; then what was found by then is taken, the same in
every run. Either way no task can start earlier while the others stay.

First a start is made: who does what is settled without the order, and ordered by list scheduling.
That alone often has the values asked for; where it has not, CP-SAT is asked for any schedule.
"""

from __future__ import annotations

import threading
import warnings
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from time import monotonic
from typing import Any

from ortools.sat.python import cp_model

from tandem.plan.bounds import reckoned
from tandem.plan.cpsat import ALLOCATION, SOLVER, Decisions, Rule, formulate
from tandem.plan.door import Door, RefusedScheduleWarning
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout
from tandem.plan.result import Front, Result, Status
from tandem.plan.starts import Starts, appended, list_schedule, measures, moved_up
from tandem.schedule.measures import exact

SMALL = 16
"""Up to so many tasks the rule is asked for at once: a start by list scheduling saves nothing."""
ALLOCATION_WORK = 0.02
"""CP-SAT's deterministic seconds for who does what."""
ALLOCATIONS = 4
"""So many are tried before the whole model is asked."""
START_WORK: tuple[tuple[float, dict[str, int]], ...] = (
    (0.006, {"linearization_level": 0}),
    (0.06, {"search_branching": cp_model.PORTFOLIO_WITH_QUICK_RESTART_SEARCH}),
    (2.0, {}),
)
"""The same for any schedule of the values, in one way after the other until there is one."""
SPREAD_WORK = 0.01
"""The same for the least spread of stress."""
SUM_WORK = ((16, 0.008), (24, 0.003))
"""The same for the least sum of starts, up to so many tasks. On larger cells CP-SAT does not come
to search in a time that would be worth it.
"""
ORDER_WORK = 0.003
"""The same for the cell's order."""


def settled(front: Front, *, until: float | None, workers: int) -> Front:
    """The front with the canonical schedule behind each proven point; the schedules of the others
    keep their order, but no task waits for nothing.

    Args:
      until: `monotonic()` seconds at which to stop; points that were not reached by then keep the
        schedule found, and `canonical` False.
      workers: so many points are worked on at once, which changes nothing in what comes out.
    """
    cell, question = front.cell, front.question
    layout = Layout.of(Instance.of(cell))
    last_step = _LastStep(layout, Door(cell, layout.instance, question), until)
    interrupted = front.interrupted
    results = list(front.results)
    with ThreadPoolExecutor(workers) as pool:
        # time may end the step before all have had their turn: the recommended point comes first
        order = sorted(range(len(results)), key=lambda place: place != front.knee_place)
        submitted = {place: pool.submit(last_step.settle, results[place]) for place in order}
        waiting = [submitted[place] for place in range(len(results))]
        try:
            results = [one.result() for one in waiting]
        except BaseException as error:
            for one in waiting:
                one.cancel()
            while wait(waiting, 0.02).not_done:
                last_step.stop()  # again and again: a solver that has not begun does not hear it
            if not isinstance(error, KeyboardInterrupt):
                raise
            interrupted = True
            results = [
                result if one.cancelled() or one.exception() else one.result()
                for one, result in zip(waiting, results, strict=True)
            ]
    if question.minimize == "front":
        results = _undominated(results)
    front = replace(front, results=tuple(results), interrupted=interrupted)
    if last_step.door.refused:
        warnings.warn(last_step.door.apology(), RefusedScheduleWarning, stacklevel=3)
        # what the same model proved is not believed any more
        return unproven(front) if front.solver == SOLVER else front
    return front


def unproven(front: Front) -> Front:
    """The front with nothing proven but what needs no search."""
    bound = reckoned(Layout.of(Instance.of(front.cell)))
    results = (replace(result, status=Status.FEASIBLE, bound=bound) for result in front)
    return replace(front, results=tuple(results), complete=False)


def _undominated(results: Sequence[Result]) -> list[Result]:
    """Those that are left when some that are not proven have become quicker, by makespan."""
    kept: list[Result] = []
    for result in sorted(results, key=lambda result: (result.makespan, result.stress)):
        if not kept or result.stress < kept[-1].stress:
            kept.append(result)
    return kept


@dataclass
class _LastStep:
    """The last step of planning for one cell.

    Attributes:
      until: see `settled`.
      running: the solvers at work, to be stopped.
    """

    layout: Layout
    door: Door
    until: float | None
    stopped: bool = False
    running: list[cp_model.CpSolver] = field(default_factory=list)
    lock: threading.Lock = field(default_factory=threading.Lock)

    @property
    def is_over(self) -> bool:
        """Time is up, or somebody interrupted."""
        return self.stopped or (self.until is not None and monotonic() >= self.until)

    def stop(self) -> None:
        """Ends what is under way."""
        self.stopped = True
        with self.lock:
            for solver in self.running:
                solver.stop_search()

    def settle(self, result: Result) -> Result:
        """The result with the schedule that shall stand behind it."""
        if self.is_over:
            return result
        if result.status != Status.OPTIMAL:
            return self._moved_up(result)
        instance = self.layout.instance
        makespan = int(exact(result.makespan) * instance.per_second)
        stress = int(exact(result.stress) * instance.per_stress)
        choice = _Choice(self, makespan, stress)
        starts = choice.starts()
        if starts is None or choice.was_cut or self.is_over:
            return result
        admitted = self.door.vouched(starts)
        if admitted is None:
            return result
        if admitted.point != (makespan, stress):
            self.door.refuse([f"it is worth {admitted.point} instead of {(makespan, stress)}."])
            return result
        return replace(result, schedule=admitted.schedule, canonical=True)

    def _moved_up(self, result: Result) -> Result:
        starts = moved_up(self.layout, self.layout.instance.starts(result.schedule))
        admitted = self.door.admit(starts)
        return result if admitted is None else replace(result, schedule=admitted.schedule)

    @contextmanager
    def at_work(self, solver: cp_model.CpSolver) -> Iterator[None]:
        """The solver can be stopped from outside meanwhile."""
        with self.lock:
            self.running.append(solver)
        try:
            yield
        finally:
            with self.lock:
                self.running.remove(solver)


@dataclass
class _Choice:
    """The choice among the schedules of one makespan (ticks) and one stress (units).

    Attributes:
      least_spread: units; no schedule of these values has a lesser spread.
      was_cut: a solver was ended by the clock, so that what follows depends on it.
    """

    last_step: _LastStep
    makespan: int
    stress: int
    least_spread: int = 0
    was_cut: bool = False

    @property
    def layout(self) -> Layout:
        """Of the cell."""
        return self.last_step.layout

    @property
    def instance(self) -> Instance:
        """The same."""
        return self.layout.instance

    def starts(self) -> Starts | None:
        """The first by the rule, as far as the work goes; None when no schedule was found at
        all.
        """
        start = None
        if len(self.instance.tasks) > SMALL and (start := self._begin()) is None:
            return None
        work = self._sum_work()
        if start is not None and not work and self._is_spread(start):
            return moved_up(self.layout, start)
        plan = self._model()
        if (spread := self._spread(plan)) is not None:
            start, least = self._least_spread(plan, spread, start)
            if start is None:
                return None
            plan.model.add(spread <= least)
        if work:
            total: cp_model.LinearExprT = sum(plan.start)
            # relaxed, the order of an operator's tasks says much about the sum of their starts
            start, proven = self._least(plan, total, work, start, linearization_level=2)
            if start is not None and proven is not None:
                plan.model.add(total <= proven)
                start = self._first(plan) or start
        return None if start is None else moved_up(self.layout, start)

    def _is_spread(self, start: Starts) -> bool:
        """Whether no schedule of these values has a lesser spread, as far as who does what says."""
        return not self._people() or self._spread_of(start) <= self.least_spread

    def _least_spread(
        self, plan: Decisions, spread: cp_model.IntVar, start: Starts | None
    ) -> tuple[Starts | None, int]:
        """A schedule of the least spread found, and that spread."""
        if start is not None and self._is_spread(start):
            return start, self._spread_of(start)
        start, _ = self._least(plan, spread, SPREAD_WORK, start, linearization_level=0)
        return start, 0 if start is None else self._spread_of(start)

    def _sum_work(self) -> float:
        tasks = len(self.instance.tasks)
        return next((work for most, work in SUM_WORK if tasks <= most), 0.0)

    def _begin(self) -> Starts | None:
        """A schedule of these values to begin with."""
        return self._by_allocation() or self._any()

    def _model(self, rules: Sequence[Rule] | None = None) -> Decisions:
        """Every schedule of these values in the ways that count; the values are the least, so a
        limit on each is enough.
        """
        plan = formulate(self.instance, self.makespan, rules)
        plan.model.add(plan.stress <= self.stress)
        for chosen, steps in zip(plan.chosen, self.layout.steps, strict=True):
            counting = {step.way for step in steps}
            for way, literal in enumerate(chosen):
                if way not in counting:
                    plan.model.add(literal == 0)
        return plan

    def _by_allocation(self) -> Starts | None:
        """Who does what without the order: the least spread, then the least makespan; and what list
        scheduling makes of it, if that has the values. Several are tried.
        """
        plan = self._model(ALLOCATION)
        weight, spread = self.makespan + 1, self._spread(plan)
        plan.model.minimize(plan.makespan + (0 if spread is None else weight * spread))
        for seed in range(ALLOCATIONS):
            solver = self._solve(plan, ALLOCATION_WORK, random_seed=seed)
            if solver is None:
                return None
            self.least_spread = max(
                self.least_spread, int(solver.best_objective_bound + 1e-6) // weight
            )
            starts = list_schedule(self.layout, [way for way, _ in plan.read(solver.value)])
            if starts is not None:
                makespan, stress = measures(self.instance, starts)
                if makespan <= self.makespan and stress <= self.stress:
                    return starts
        return None

    def _any(self) -> Starts | None:
        """Any schedule of these values: without linear relaxation where that is enough, which it is
        at once or never; then in other ways.
        """
        for work, parameters in START_WORK:
            solver = self._solve(plan := self._model(), work, **parameters)
            if solver is not None:
                return appended(self.layout, plan.read(solver.value))
        return None

    def _least(
        self,
        plan: Decisions,
        value: cp_model.LinearExprT,
        work: float,
        start: Starts | None,
        **parameters: int,
    ) -> tuple[Starts | None, int | None]:
        """The schedule of least value found, beginning with `start`; and that value if it is
        proven. Where none is found so, it begins with any.
        """
        if not work:
            return start, None
        if start is not None:
            plan.hint(start)
        plan.model.minimize(value)
        solver = self._solve(plan, work, **parameters)
        if solver is None and start is None and (start := self._begin()) is not None:
            plan.hint(start)
            solver = self._solve(plan, work, **parameters)
        if solver is None:
            return start, None
        found = appended(self.layout, plan.read(solver.value))
        least = round(solver.objective_value)
        return found, least if solver.status_name() == "OPTIMAL" else None

    def _first(self, plan: Decisions) -> Starts | None:
        """Of the schedules of the model the first in the cell's order: the tasks' starts, then
        their operators.

        A search that decides in this order, always for the least, comes to it first; what it skips
        it has refuted.
        """
        plan.model.clear_hints()  # type: ignore[no-untyped-call]
        plan.model.clear_objective()  # type: ignore[no-untyped-call]
        model = plan.model
        first: Any = cp_model.CHOOSE_FIRST
        least: Any = cp_model.SELECT_MIN_VALUE
        most: Any = cp_model.SELECT_MAX_VALUE
        model.add_decision_strategy(plan.start, first, least)
        literals = [
            plan.chosen[task][step.way]
            for task, steps in enumerate(self.layout.steps)
            if len(plan.chosen[task]) > 1
            for step in sorted(steps, key=lambda step: (step.operators, step.ticks))
        ]
        if literals:
            model.add_decision_strategy(literals, first, most)
        solver = self._solve(
            plan,
            ORDER_WORK,
            linearization_level=2,
            search_branching=cp_model.FIXED_SEARCH,
            keep_all_feasible_solutions_in_presolve=True,
            stop_after_first_solution=True,
        )
        return None if solver is None else plan.read(solver.value)

    def _solve(
        self, plan: Decisions, work: float, **parameters: int | bool
    ) -> cp_model.CpSolver | None:
        """The solver when it has a schedule to give; None when it has none, or time is up, so that
        what it has depends on the clock.
        """
        solver = cp_model.CpSolver()
        solver.parameters.num_workers = 1
        solver.parameters.random_seed = 0
        solver.parameters.max_deterministic_time = work
        solver.parameters.catch_sigint_signal = False
        # on models of this size they cost more than they save
        solver.parameters.symmetry_level = 0
        solver.parameters.cp_model_probing_level = 0
        for name, value in parameters.items():
            setattr(solver.parameters, name, value)
        if (until := self.last_step.until) is not None:
            solver.parameters.max_time_in_seconds = max(0.01, until - monotonic())
        with self.last_step.at_work(solver):
            if self.was_cut or self.last_step.is_over:
                return None
            status = solver.status_name(solver.solve(plan.model))
        # CP-SAT ends before its limit when it does not expect to reach another look at the clock
        is_near = until is not None and monotonic() + 0.1 + 0.2 * solver.wall_time > until
        if status in ("FEASIBLE", "UNKNOWN") and (is_near or self.last_step.is_over):
            self.was_cut = True
        return solver if status in ("OPTIMAL", "FEASIBLE") and not self.was_cut else None

    def _people(self) -> list[int]:
        """The humans among whom stress is spread; none where there is nothing to compare."""
        humans = [operator for operator, human in enumerate(self.instance.human) if human]
        return humans if len(humans) > 1 and self.instance.stress_of_set is None else []

    def _spread(self, plan: Decisions) -> cp_model.IntVar | None:
        """The spread as a variable of the model; None where nobody asks for it."""
        people = self._people()
        if not people:
            return None
        model = plan.model
        most, least = (model.new_int_var(0, self.stress, name) for name in ("most", "least"))
        for person in people:
            load: cp_model.LinearExprT = sum(
                way.load[way.operators.index(person)] * literal
                for ways, chosen in zip(self.instance.ways, plan.chosen, strict=True)
                for way, literal in zip(ways, chosen, strict=True)
                if person in way.operators
            )
            model.add(load <= most)
            model.add(load >= least)
        spread = model.new_int_var(0, self.stress, "spread")
        model.add(spread == most - least)
        return spread

    def _spread_of(self, starts: Starts) -> int:
        """The spread of a schedule, units."""
        loads = dict.fromkeys(self._people(), 0)
        for ways, (way, _) in zip(self.instance.ways, starts, strict=True):
            for operator, load in zip(ways[way].operators, ways[way].load, strict=True):
                if operator in loads:
                    loads[operator] += load
        return max(loads.values()) - min(loads.values())
