"""The best plan that changes as little as it can: an old plan, carried over into a cell that is no
longer quite the one it was made for.

What counts, in this order: tasks that change operator, tasks that change order, tasks whose start
moves by more than a tolerance (`schedule.changes` says when a task does), the makespan, the stress;
within a makespan and a stress that are at most so many percent above the new optimum. One question
after the other is asked of CP-SAT's one model of the cell (`cpsat.formulate`), each with the
answers before it as limits (lexicographic goals; Ehrgott 2005, Multicriteria Optimization, section
5.1). What an answer is worth is measured on its schedule, behind the door.
"""

from __future__ import annotations

import math
import os
import threading
import warnings
from collections.abc import Callable, Iterable, Mapping
from decimal import ROUND_FLOOR
from fractions import Fraction
from queue import Empty, SimpleQueue
from random import Random
from time import monotonic
from typing import Any, NamedTuple

from ortools.sat.python import cp_model

from tandem.cell.model import Cell
from tandem.cell.written import number
from tandem.errors import NothingFoundError, UsageError
from tandem.plan.bounds import closed_forms, least_makespan
from tandem.plan.change_terms import Aim, rules, what_changes
from tandem.plan.cpsat import SOLVER, Decisions, formulate
from tandem.plan.door import Admitted, Door, RefusedScheduleWarning
from tandem.plan.goal import Effort, Goal, GoalStatus, Meter
from tandem.plan.in_the_way import in_the_way
from tandem.plan.list_scheduling import Layout
from tandem.plan.method import Progress
from tandem.plan.portfolio import Portfolio
from tandem.plan.provers import Prover, Step, rising
from tandem.plan.question import Question
from tandem.plan.race import LEAST_SPENT
from tandem.plan.replanned import Optimum, Replan, Replanned
from tandem.plan.result import Bound, Status
from tandem.plan.rules import SPECS, build
from tandem.plan.standing import Standing, stand
from tandem.plan.starts import Starts, append
from tandem.schedule.changes import TOLERANCE_S, Changes, changes
from tandem.schedule.measures import exact
from tandem.schedule.model import Schedule

ALLOW = 2.0
"""Percent above the new optimum, if nothing else is said."""
MOST_TASKS = 400
"""With more tasks in both plans, the model of all pairs takes longer to write down than a user
waits; the best plan that was found on the way is given, and nothing is proven.
"""
SHARE = 0.4
"""Of the time that is left, what one question may take."""
TIDY_WORK = 5.0
"""Deterministic seconds for the last step, which only chooses among equals."""


def replan(
    cell: Cell,
    before: Schedule,
    *,
    stress: float | None = None,
    done: Iterable[str] = (),
    at: float | None = None,
    keep: Iterable[str] = (),
    allow: float = ALLOW,
    tolerance: float = TOLERANCE_S,
    front: bool = False,
    time_limit: float | None = 60.0,
    work: float | None = None,
    seed: int = 0,
    workers: int | None = None,
    on_solution: Callable[[Progress], None] | None = None,
) -> Replanned:
    """The best plan of the cell that changes as little of an old plan as it can.

    The new optimum is the least makespan among plans of at most the old plan's stress, in which
    done, started and kept tasks are where they were. Where that stress can no longer be reached,
    it is the least that can.

    Args:
      cell: as it is now.
      before: the old plan, made for this cell or for another state of it.
      stress: what the old plan was worth; that of its operators in `cell` when absent.
      done: tasks that were done as planned.
      at: seconds; what the old plan has begin before has started, all else begins then or later.
        When absent, the moment at which the last of the done tasks ended; what the old plan has
        begin before may still begin there.
      keep: tasks that keep operators and start.
      allow: percent by which makespan and stress may be above the new optimum.
      tolerance: seconds by which a start may move and still be the same.
      front: for each number of changed tasks the least makespan, within the limit on stress, from
        as few as there can be.
      time_limit, work, seed, workers, on_solution: as in `tandem.plan`.

    Raises:
      UsageError: with everything that is wrong in the call.
      InfeasibleError: no plan leaves what is done, started and kept where it is; says what stands
        in the way.
      NothingFoundError: none was found within the limit.
    """
    _check(allow, tolerance, time_limit, work, workers)
    standing = stand(cell, before, done=done, at=at, keep=keep)
    told = _stress_of(standing) if stress is None else stress
    until = None if work is not None or time_limit is None else monotonic() + time_limit
    meter = None if work is None else Meter(work)
    threads = 1 if meter is not None else workers or os.cpu_count() or 1
    effort = Effort(until, seed, threads, meter=meter)
    search = _Search(standing, told, allow, tolerance, front, effort, on_solution)
    interrupted = False
    try:
        search.begin()
        search.find_optimum()
        if front:
            search.find_front()
        else:
            search.find_least()
    except KeyboardInterrupt:
        interrupted = True
    return search.answer(interrupted)


def _check(
    allow: float,
    tolerance: float,
    time_limit: float | None,
    work: float | None,
    workers: int | None,
) -> None:
    wrong = [
        f"{name} {number(value)}: must be a number, 0 or more."
        for name, value in (("allow", allow), ("tolerance", tolerance))
        if not (math.isfinite(value) and value >= 0)
    ]
    if time_limit is not None and not time_limit > 0:
        wrong.append(f"time limit {time_limit}: must be more than 0 seconds.")
    if work is not None and not 0 < work < math.inf:
        wrong.append(f"work {work}: must be a number of more than 0.")
    if workers is not None and workers < 1:
        wrong.append(f"workers {workers}: must be 1 or more.")
    if wrong:
        raise UsageError("\n".join(wrong))


def _stress_of(standing: Standing) -> float | None:
    """The stress of the old plan's operators in the cell as it is; None when they are not there
    for every task, or stress does not add up.
    """
    stated = standing.stated
    if stated.stress_of_set is not None:
        return None
    units = 0
    for task, ways in enumerate(stated.ways):
        team = standing.old[task].team if task in standing.old else None
        loads = [way.stress for way in ways if way.operators == team]
        if not loads:
            return None
        units += min(loads)
    return stated.stress(units)


# --- the search -----------------------------------------------------------------------------------


class Known(NamedTuple):
    """A schedule behind the door, and what it changes."""

    admitted: Admitted
    changes: Changes

    def value(self, aim: Aim) -> int:
        """What it comes to."""
        if aim == "makespan":
            return self.admitted.makespan
        if aim == "stress":
            return self.admitted.stress
        return sum(self.changes.counts) if aim == "changed" else self.changes.count(aim)


class Answered(NamedTuple):
    """What is known of a question: the least value found, None when none was, and its bound."""

    value: int | None
    bound: int

    @property
    def proven(self) -> bool:
        """Nothing is less."""
        return self.value is not None and self.bound >= self.value


NOTHING = 1 << 60
"""The bound of a question whose limits nothing keeps."""
LEAST: tuple[Aim, ...] = ("operator", "order", "start", "makespan", "stress")
"""What is made small, one after the other."""
LEAST_OF_A_POINT: tuple[Aim, ...] = ("operator", "order", "stress")
"""The same, when makespan and number of changed tasks are given."""


class _Search:
    def __init__(
        self,
        standing: Standing,
        stress: float | None,
        allow: float,
        tolerance: float,
        front: bool,
        effort: Effort,
        on_solution: Callable[[Progress], None] | None,
    ) -> None:
        self.began = monotonic()
        self.standing, self.allow, self.tolerance = standing, allow, tolerance
        self.front, self.effort, self.on_solution = front, effort, on_solution
        self.instance = standing.instance
        self.layout = Layout.of(self.instance)
        self.door = Door(standing.cell, self.instance, Question(), standing.promises)
        self.known: dict[Starts, Known] = {}
        self.cap = None if stress is None else _floor(stress, self.instance.per_stress)
        self.reachable: bool | None = None
        self.least = self.floor = 0 if self.layout.impossible() else least_makespan(self.layout)
        self.limits: dict[Aim, int] = {}
        self.at_least: dict[str, int] = {}
        self.infeasible = self.optimum_is_proven = False
        self.points: list[tuple[Starts, bool, bool]] = []
        self.complete = False
        self.rules = rules(standing)
        self.is_too_large = len(standing.old) > MOST_TASKS

    def begin(self) -> None:
        """The first schedules: the old one as it is, the old one with its gaps closed or stretched,
        and what a dispatch rule gives.
        """
        if self.layout.impossible():
            return
        ways, order = self._as_before()
        starts = tuple(
            (way, self.standing.old[task].start if task in self.standing.old else 0)
            for task, way in enumerate(ways)
        )
        self._offer(self.door.admit(starts))
        appended = append(self.layout, order, ways)
        if appended is not None:
            self._offer(self.door.admit(appended))
        if self.instance.stress_of_set is None:
            state = build(self.layout, SPECS["longest-tail"], Random(self.effort.seed))
            if state is not None:
                self._offer(self.door.admit(state.starts()))

    def _as_before(self) -> tuple[list[int], list[int]]:
        """Per task the way of the old operators, else the quickest; and the old order, in which a
        new task comes directly behind what it needs.
        """
        old, instance = self.standing.old, self.instance
        ways = []
        for task, row in enumerate(instance.ways):
            team = old[task].team if task in old else None
            ways.append(
                min(range(len(row)), key=lambda w: (row[w].operators != team, row[w].ticks))
            )
        moment = [0] * len(instance.tasks)
        for task in instance.order:
            firsts = [*instance.before[task], *(lag.before for lag in instance.lags_into[task])]
            needed = max((moment[first] for first in firsts), default=0)
            moment[task] = max(needed, old[task].start if task in old else needed)
        place = {task: index for index, task in enumerate(instance.order)}
        return ways, sorted(range(len(ways)), key=lambda task: (moment[task], place[task]))

    # ------------------------------------------------------------ what is asked

    def find_optimum(self) -> None:
        """The new optimum; the limits follow from it."""
        if self.layout.impossible():
            self.infeasible = True
            return
        proven = True
        quickest = self._race(Goal(1, 0, None, self.cap))
        if quickest.starts is None and quickest.proven and self.cap is not None:
            gentlest = self._race(Goal(0, 1))
            if gentlest.starts is None:
                self.infeasible = gentlest.proven
                return
            self.reachable, proven = False, gentlest.proven
            self.cap = min(known.value("stress") for known in self.known.values())
            quickest = self._race(Goal(1, 0, None, self.cap))
        elif quickest.starts is None:
            self.infeasible = quickest.proven
            return
        else:
            self.reachable = True
        self.optimum_is_proven = proven and quickest.proven
        self.floor = max(self.floor, quickest.bound)

    def _race(self, goal: Goal) -> GoalStatus:
        left, meter = self.effort.left(), self.effort.meter
        share = None if meter is None else Meter(SHARE * meter.left)
        effort = Effort(
            None if self.effort.until is None else monotonic() + max(SHARE * left, min(left, 0.5)),
            self.effort.seed,
            self.effort.workers,
            lambda schedule, bound: self._offer(schedule),
            meter=share,
        )
        fit = [known.admitted for known in self.known.values() if goal.allows(*_point(known))]
        best = min(fit, key=lambda admitted: goal.value(*admitted.point), default=None)
        known = self.floor if goal.time else 0
        race = Portfolio(self.door, self.layout, goal, effort, best, known, rules=self.rules)
        status = race.run()
        if meter is not None and share is not None:
            meter.spend(SHARE * meter.left - share.left)
        if status.starts is not None:
            self._offer(self.door.admit(status.starts))
        return status

    @property
    def allowed(self) -> dict[Aim, int]:
        """So many percent above the new optimum, as far as that is known."""
        found = [known.value("makespan") for known in self.known.values() if self._is_gentle(known)]
        most = 1 + Fraction(exact(self.allow)) / 100
        limits: dict[Aim, int] = {"makespan": math.floor(min(found) * most)} if found else {}
        if self.cap is not None:
            limits["stress"] = math.floor(self.cap * most)
        return limits

    @property
    def _least_makespan(self) -> int:
        """Ticks; no plan within the limit on stress is quicker. What is proven of the optimum holds
        for plans of its own stress.
        """
        return self.floor if self.allowed.get("stress") == self.cap else self.least

    def _is_gentle(self, known: Known) -> bool:
        return self.cap is None or known.value("stress") <= self.cap

    def find_least(self) -> None:
        """One number after the other, each as small as those before it let it be."""
        self.limits = self.allowed
        if not self._fit(self.limits):
            return
        proven = self.optimum_is_proven
        for aim in LEAST:
            answer = self._ask(aim, self.limits, self._least_makespan if aim == "makespan" else 0)
            assert answer.value is not None
            proven = proven and answer.proven
            self.limits[aim] = answer.value
            if aim not in ("makespan", "stress"):
                self.at_least[aim] = answer.bound
        self._settle(self.limits, proven)
        self.complete = proven and not self.door.refused

    def find_front(self) -> None:
        """From the least number of changes on: the least makespan for it, then the least number for
        anything quicker.
        """
        gentle = self.allowed
        gentle.pop("makespan", None)
        limits, proven = dict(gentle), True
        while True:
            fewest = self._ask("changed", limits, 0)
            if fewest.value is None:
                self.complete = proven and fewest.bound == NOTHING and bool(self.points)
                return
            quickest = self._ask(
                "makespan", {**gentle, "changed": fewest.value}, self._least_makespan
            )
            assert quickest.value is not None
            here: dict[Aim, int] = {
                **gentle, "changed": fewest.value, "makespan": quickest.value
            }  # fmt: skip
            is_proven = fewest.proven and quickest.proven
            for aim in LEAST_OF_A_POINT:
                answer = self._ask(aim, here, 0)
                assert answer.value is not None
                is_proven = is_proven and answer.proven
                here[aim] = answer.value
            self._settle(here, is_proven)
            proven = proven and is_proven
            if self.effort.is_spent or self.door.refused or self.is_too_large:
                return
            limits = {**gentle, "makespan": quickest.value - 1}

    # ------------------------------------------------------------ how it is asked

    def _fit(self, limits: Mapping[Aim, int]) -> list[Known]:
        return [
            known
            for known in self.known.values()
            if all(known.value(aim) <= most for aim, most in limits.items())
        ]

    def _best(self, aim: Aim, limits: Mapping[Aim, int]) -> Known | None:
        return min(self._fit(limits), key=lambda known: known.value(aim), default=None)

    def _ask(self, aim: Aim, limits: Mapping[Aim, int], floor: int) -> Answered:
        """The least value of the aim within the limits. A bound above every value means that
        nothing keeps the limits.
        """
        best = self._best(aim, limits)
        value = None if best is None else best.value(aim)
        is_over = self.effort.is_spent or bool(self.door.refused) or self.is_too_large
        if is_over or (value is not None and value <= floor):
            return Answered(value, floor)
        plan, terms = self._model(limits)
        plan.model.minimize(terms[aim])
        if best is not None:
            plan.hint(best.admitted.starts)
        solver = self._solver(self.effort.workers, self.effort.seed)
        status = self._solve(solver, plan)
        if self.effort.meter is not None:
            self.effort.meter.spend(solver.response_proto.deterministic_time + LEAST_SPENT)
        if self.door.refused:
            return Answered(value, floor)
        if status == cp_model.INFEASIBLE:
            if best is not None:
                self.door.refuse(["the model leaves out a schedule that was let in."])
                return Answered(value, floor)
            return Answered(None, NOTHING)
        bound = max(floor, math.ceil(solver.best_objective_bound - 1e-6))
        best = self._best(aim, limits)
        if status == cp_model.OPTIMAL and (best is None or best.value(aim) > bound):
            self.door.refuse([f"what it changes is counted wrongly by the model ({aim})."])
            return Answered(None if best is None else best.value(aim), floor)
        return Answered(None if best is None else best.value(aim), bound)

    def _model(
        self, limits: Mapping[Aim, int]
    ) -> tuple[Decisions, dict[Aim, cp_model.LinearExprT]]:
        """The cell's own model within the limits, and the terms that questions are about."""
        upper = min(limits.get("makespan", self.instance.horizon), self.instance.horizon)
        plan = formulate(self.instance, upper, self.rules)
        ticks = _floor(self.tolerance, self.instance.per_second)
        terms: dict[Aim, Any] = {"makespan": plan.makespan, "stress": plan.stress}
        terms |= what_changes(plan, self.standing, ticks)
        for aim, most in limits.items():
            plan.model.add(terms[aim] <= most)
        return plan, terms

    def _solve(self, solver: cp_model.CpSolver, plan: Decisions) -> int:
        """Solves in a thread, so that Ctrl-C is heard; every schedule is let in, here, as it is
        found.
        """
        found: SimpleQueue[Starts | int | BaseException] = SimpleQueue()
        watcher = _Watcher(plan, found)

        def search() -> None:
            try:
                status = int(solver.solve(plan.model, watcher))  # type: ignore[call-overload]
                if status == cp_model.MODEL_INVALID:
                    raise RuntimeError(f"the solver refuses the model: {plan.model.validate()}")
                found.put(status)
            except BaseException as error:  # noqa: BLE001  it is raised again in the calling thread
                found.put(error)

        thread = threading.Thread(target=search, daemon=True)
        thread.start()
        try:
            while True:
                try:
                    news = found.get(timeout=0.05)
                except Empty:
                    continue
                if isinstance(news, int):
                    return news
                if isinstance(news, BaseException):
                    raise news
                self._offer(self.door.vouched(news))
        finally:
            while thread.is_alive():
                solver.stop_search()
                thread.join(0.02)

    def _settle(self, limits: Mapping[Aim, int], proven: bool) -> None:
        """Among all schedules of these values the one whose starts are nearest to the old ones, in
        sum, and of those the one that begins earliest, the cell's first tasks before others.

        A single worker, bounded work and no schedule to begin with make it the same in every run.
        """
        best = self._best("makespan", limits)
        if best is None:
            return
        starts, canonical, moved = best.admitted.starts, proven, None
        for last in (False, True):
            if self.effort.left() <= 0 or self.door.refused or self.is_too_large:
                canonical = False
                break
            plan, _ = self._model(limits)
            shift = self._shift(plan)
            if moved is not None:
                plan.model.add(shift <= moved)
            count = len(plan.start)
            early = sum((2 * count - task) * start for task, start in enumerate(plan.start))
            plan.model.minimize(early if last else shift)
            solver = self._solver(1, 0, TIDY_WORK)
            status = self._solve(solver, plan)
            canonical = canonical and status == cp_model.OPTIMAL and not self.door.refused
            if status not in (cp_model.OPTIMAL, cp_model.FEASIBLE) or self.door.refused:
                break
            starts, moved = plan.read(solver.value), solver.value(shift)
        self.points.append((starts, proven and not self.door.refused, canonical))

    def _shift(self, plan: Decisions) -> Any:
        """The sum of the ticks by which starts differ from those of the old plan."""
        shifts = []
        for task, old in self.standing.old.items():
            shift = plan.model.new_int_var(0, max(self.instance.horizon, old.start), "")
            plan.model.add(shift >= plan.start[task] - old.start)
            plan.model.add(shift >= old.start - plan.start[task])
            shifts.append(shift)
        return sum(shifts)

    def _solver(self, workers: int, seed: int, work: float | None = None) -> cp_model.CpSolver:
        """For one question; `work` in deterministic seconds, else its share of what is left."""
        solver = cp_model.CpSolver()
        solver.parameters.num_workers = workers
        solver.parameters.random_seed = seed % (1 << 31)
        solver.parameters.catch_sigint_signal = False
        if self.effort.until is not None:
            solver.parameters.max_time_in_seconds = max(0.05, SHARE * self.effort.left())
        if work is None and self.effort.meter is not None:
            work = SHARE * self.effort.meter.left
        if work is not None:
            solver.parameters.max_deterministic_time = work
        return solver

    def _offer(self, admitted: Admitted | None) -> None:
        """Remembers a schedule that was let in."""
        if admitted is None or admitted.starts in self.known:
            return
        known = Known(admitted, changes(self.standing.before, admitted.schedule, self.tolerance))
        self.known[admitted.starts] = known
        if self.on_solution is not None:
            best = self._result(self._provisional(), False, False)
            floor = self.instance.seconds(self._least_makespan)
            self.on_solution(Progress((best,), floor, monotonic() - self.began))

    # ------------------------------------------------------------ what is answered

    def _provisional(self) -> Known:
        """The best so far, within the limits as far as they are known."""
        fit = self._fit({**self.allowed, **self.limits})
        if not fit:
            return min(self.known.values(), key=lambda known: _point(known)[::-1])
        return min(fit, key=lambda known: tuple(known.value(aim) for aim in LEAST))

    def _result(self, known: Known, proven: bool, canonical: bool) -> Replan:
        admitted = known.admitted
        bounds = (self._least_makespan, self._least_stress())
        makespan, stress = admitted.point if proven else bounds
        times = rising([*closed_forms(self.layout), Step(makespan, Prover.CP_SAT)])
        loads = rising(
            [Step(self._least_stress(), Prover.LEAST_STRESS), Step(stress, Prover.CP_SAT)]
        )
        bound = Bound(
            self.instance.seconds(makespan),
            self.instance.stress(stress),
            tuple(Step(self.instance.seconds(int(ticks)), by) for ticks, by in times),
            tuple(Step(self.instance.stress(int(units)), by) for units, by in loads),
        )
        return Replan(
            self.standing.cell,
            admitted.schedule,
            Status.OPTIMAL if proven else Status.FEASIBLE,
            bound,
            canonical,
            changes=known.changes,
        )

    def _least_stress(self) -> int:
        if self.instance.stress_of_set is not None:
            return min(self.instance.stress_of_set.values())
        return sum(min(way.stress for way in ways) for ways in self.instance.ways)

    def answer(self, interrupted: bool) -> Replanned:
        """What was found. Raises as `replan` says."""
        wall = monotonic() - self.began
        if not self.known:
            if self.door.refused:
                raise NothingFoundError(f"no plan was found: {self.door.apology()}")
            if self.infeasible:
                raise in_the_way(self.standing)
            if interrupted:
                raise KeyboardInterrupt
            raise NothingFoundError(
                f"no plan that leaves what is done, started or kept where it is was found in"
                f" {wall:.1f} s; whether there is one is open."
            )
        if self.door.refused:
            self.complete = False
            warnings.warn(self.door.apology(), RefusedScheduleWarning, stacklevel=3)
        if not self.points:
            self.points.append((self._provisional().admitted.starts, False, False))
        results = [self._result(self.known[starts], *rest) for starts, *rest in self.points]
        return Replanned(
            self.standing.cell,
            tuple(sorted(results, key=lambda result: result.makespan)),
            self.complete,
            "least-change",
            SOLVER,
            self.effort.seed,
            wall,
            interrupted,
            self._question(),
            out_of_time=self.effort.left() <= 0,
            before=self.standing.before,
            optimum=self.optimum,
            allow=self.allow,
            tolerance=self.tolerance,
            kept=tuple(
                (self.instance.tasks[task], fixed.why)
                for task, fixed in sorted(self.standing.fixed.items())
            ),
            at_least=self.at_least,
        )

    @property
    def optimum(self) -> Optimum:
        """The new optimum, as far as it is known."""
        found = [known.value("makespan") for known in self.known.values() if self._is_gentle(known)]
        best = min(found or [known.value("makespan") for known in self.known.values()])
        return Optimum(
            self.instance.seconds(best),
            self.instance.seconds(min(self.floor, best)),
            None if self.cap is None else self.instance.stress(self.cap),
            self.reachable,
            self.optimum_is_proven and not self.door.refused,
        )

    def _question(self) -> Question:
        """The limits as a question."""
        makespan, stress = self.allowed.get("makespan"), self.allowed.get("stress")
        is_free = self.front or makespan is None
        return Question(
            "change",
            max_makespan=None if is_free else self.instance.seconds(makespan or 0),
            max_stress=None if stress is None else self.instance.stress(stress),
        )


def _point(known: Known) -> tuple[int, int]:
    return known.admitted.point


def _floor(value: float, scale: int) -> int:
    """The value in whole numbers, cut down."""
    return int((exact(value) * scale).to_integral_value(ROUND_FLOOR))


class _Watcher(cp_model.CpSolverSolutionCallback):
    """Hands on what the solver finds."""

    def __init__(self, plan: Decisions, found: SimpleQueue[Starts | int | BaseException]) -> None:
        super().__init__()
        self.plan, self.found = plan, found

    def on_solution_callback(self) -> None:
        self.found.put(self.plan.read(self.value))
