"""Those who raise the bound of a race: CP-SAT on the whole cell, the relaxation that leaves the
order out, and the search over states.
"""

from __future__ import annotations

import threading
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from math import ceil, inf
from time import monotonic, thread_time
from typing import Any

from ortools.sat.python import cp_model

from tandem.plan import cpsat
from tandem.plan.cpsat import Decisions, formulate
from tandem.plan.door import Admitted
from tandem.plan.list_scheduling import by_start
from tandem.plan.lower_bound import Proof, prove_makespan
from tandem.plan.provers import Prover
from tandem.plan.race import Race
from tandem.plan.starts import append, in_time, list_schedule

FIRST_TURN = 0.4
"""Deterministic seconds for a lone prover's first turn at both models; the next has twice that."""
ROWS_WORK = 0.05
"""Deterministic seconds at first for the implied rows beside a plain model: they prove soon, or
late. With 0.25 they took as much of the cores as the plain model until that had its proof.
"""
ROWS_SHARE = 0.25
"""Their share of the time."""
PATIENT_S = 1.0
"""Seconds of its core for which a prover goes on when it has been overtaken; twice that the next
time. Of a core and not of the clock: on a busy machine it would be begun again and again.
"""
PROVED_AT_ONCE = 60
"""Up to so many tasks the proof waits for nobody and is not soon begun again: a plain model proves
many of these cells in two seconds of a core from whatever schedule it has, and what it would prove
alone is not to be lost.
"""
PATIENT_AT_ONCE_S = 10.0
"""The same seconds for these."""
RELAX_WORK = 2.0
"""Deterministic seconds for the question who does what."""
REFUTABLE = 80
"""Up to so many tasks a state-space search is tried beside the others."""
REFUTABLE_OPERATORS = 3
"""And of so many operators: with more there are too many states that none of them beats."""
REFUTE_NEAR = 0.9
"""It begins when the bound has come so near to the incumbent: far from it there is too much to
refute.
"""
REFUTE_S = 8.0
"""Processor seconds for it: it works fast or not at all."""


class CpSat:
    """CP-SAT as a worker of a race."""

    def __init__(self, race: Race) -> None:
        self.race, self.door, self.goal, self.effort = race, race.door, race.goal, race.effort
        self.instance, self.layout = race.instance, race.layout

    def relax(self, seed: int) -> None:
        """Who does what, the order left out: a bound, and work shared out so that a list schedule
        is a good beginning.
        """
        plan = self._model(cpsat.ALLOCATION, self.race.best, True)
        solver = self._solver(1, seed, RELAX_WORK)
        status = self._solve(solver, plan)
        if status == cp_model.INFEASIBLE:
            return self.race.rule_out(Prover.ALLOCATION)
        if status in (cp_model.OPTIMAL, cp_model.FEASIBLE):
            self.race.raise_bound(ceil(solver.best_objective_bound - 1e-6), Prover.ALLOCATION)
            ways = [way for way, _ in plan.read(solver.value)]
            if (starts := list_schedule(self.layout, ways)) is not None:
                self.race.found(starts)
        return None

    def prove(self, workers: int, seed: int, work: float | None = None) -> None:
        """CP-SAT on the whole cell, in two models that prove unlike questions: the implied rows
        below the incumbent, and a plain one that begins with it. Side by side where there are
        `workers`, else in turns. `work` in deterministic seconds.
        """
        if self.effort.from_below or self.race.is_fine:
            return self._prove(not self.race.is_fine, workers, seed, work)
        if workers > 1:
            with ThreadPoolExecutor(1) as pool:
                beside = pool.submit(self._now_and_then, seed)
                self._prove(False, workers - 1, seed, work)
                return beside.result()
        turn = FIRST_TURN if work is None else work
        while self._may_prove:
            self._prove(True, 1, seed, turn * ROWS_SHARE)
            self._prove(False, 1, seed, turn * (1 - ROWS_SHARE))
            if work is not None:
                return None
            turn *= 2
        return None

    def search(self, workers: int, seed: int) -> None:
        """CP-SAT on the whole cell, all `workers` in the plain model, from its own first schedule
        to the end. In a job shop an incumbent as a hint, and to begin again from a better one, held
        its neighbourhoods back.
        """
        plan = self._model(self._plain, None, False)
        solver = self._solver(workers, seed, None)
        watcher = _Watcher(self.race, solver, plan, None, inf)
        self._settle(self._solve(solver, plan, watcher), solver, plan, None, False)

    def _now_and_then(self, seed: int) -> None:
        """The implied rows beside a plain model: each time with twice the work, after a rest."""
        work = ROWS_WORK
        while self._may_prove:
            began = monotonic()
            self._prove(True, 1, seed, work)
            rested = monotonic() + (monotonic() - began) * (1 / ROWS_SHARE - 1)
            while self._may_prove and monotonic() < rested:
                threading.Event().wait(0.02)
            work *= 2

    def _prove(self, below: bool, workers: int, seed: int, work: float | None) -> None:
        """One of the models, begun again whenever the incumbent has moved away from under it."""
        # where ticks are fine one model does it all
        rules = self.race.rules if below or self.race.is_fine else self._plain
        is_at_once = len(self.instance.tasks) <= PROVED_AT_ONCE
        patience = PATIENT_AT_ONCE_S if is_at_once else PATIENT_S
        while not self.race.over:
            with self.race.lock:
                incumbent, cut = self.race.best, self.race.value
            plan = self._model(rules, incumbent, below)
            solver = self._solver(workers, seed, work)
            watcher = _Watcher(self.race, solver, plan, cut, patience)
            solver.best_bound_callback = watcher.on_bound
            status = self._solve(solver, plan, watcher)
            if self._settle(status, solver, plan, cut, below):
                return None
            if not watcher.outdated or work is not None:
                return None
            patience *= 2
        return None

    def _settle(
        self, status: int, solver: cp_model.CpSolver, plan: Decisions, cut: int | None, below: bool
    ) -> bool:
        """What an answer proves, handed on; False where it leaves the question open."""
        if self.door.refused:
            return True
        if status == cp_model.INFEASIBLE:
            if cut is None:
                self.race.rule_out(Prover.CP_SAT)
            else:
                self._nothing_below(cut, below)
            return True
        if status != cp_model.OPTIMAL:
            return False
        value = self.race.proposed(plan.read(solver.value), round(solver.objective_value))
        if value is not None:
            self.race.raise_bound(value, Prover.CP_SAT)
        return True

    @property
    def _may_prove(self) -> bool:
        """What is asked of a model that was wrong counts for nothing."""
        return not self.race.over and not self.door.refused

    @property
    def _plain(self) -> tuple[cpsat.Rule, ...]:
        return tuple(rule for rule in self.race.rules if rule not in cpsat.IMPLIED)

    def _model(
        self, rules: Sequence[cpsat.Rule], incumbent: Admitted | None, below: bool
    ) -> Decisions:
        """The question as a model: anything below the incumbent, or the incumbent to begin with.

        Below, work that no longer fits is refuted at once. But to refute "better by a tick" CP-SAT
        may walk through millions of ticks one by one, on four tasks for minutes; and what a search
        learns from a schedule in its hands is lost. There it is left all of the time: with shorter
        domains it took several times as long to prove the same, or did not. Only where ticks are
        fine do they pay. Ends of their own let it prove in half the time; the implied rows want
        sums.
        """
        goal = self.goal
        value = None if incumbent is None else goal.value(*incumbent.point)
        upper = (
            self.instance.horizon
            if goal.max_makespan is None
            else min(goal.max_makespan, self.instance.horizon)
        )
        is_plain = not (below or self.race.is_fine)
        at_most = None if value is None or is_plain else value - below
        if at_most is not None and goal.time:
            # with the least stress paid, the objective's bound is one on the time
            upper = min(upper, (at_most - goal.stress * self._least_stress) // goal.time)
        plan = formulate(self.instance, upper, rules, own_ends=is_plain)
        objective = goal.time * plan.makespan + goal.stress * plan.stress
        if goal.max_stress is not None:
            plan.model.add(plan.stress <= goal.max_stress)
        if at_most is not None:
            plan.model.add(objective <= at_most)
        if incumbent is not None and not below:
            plan.hint(incumbent.starts)
        plan.model.minimize(objective)
        return plan

    @property
    def _least_stress(self) -> int:
        if self.instance.stress_of_set is not None:
            return 0
        return sum(min(way.stress for way in ways) for ways in self.instance.ways)

    def _solver(self, workers: int, seed: int, work: float | None) -> cp_model.CpSolver:
        solver = cp_model.CpSolver()
        solver.parameters.num_workers = workers
        solver.parameters.random_seed = seed % (1 << 31)
        solver.parameters.catch_sigint_signal = False
        solver.parameters.use_objective_lb_search = self.effort.from_below and not self.race.is_fine
        if self.effort.until is not None:
            solver.parameters.max_time_in_seconds = max(0.01, self.effort.left())
        if work is not None:
            solver.parameters.max_deterministic_time = work
        if self.effort.meter is not None:
            solver.parameters.max_deterministic_time = min(
                solver.parameters.max_deterministic_time, self.effort.meter.left
            )
        solver.parameters.use_strong_propagation_in_disjunctive = self.race.is_fine
        return solver

    def _solve(
        self, solver: cp_model.CpSolver, plan: Decisions, watcher: _Watcher | None = None
    ) -> Any:
        with self.race.lock:
            self.race.running.append(solver)
        try:
            if self.race.stopped:
                return cp_model.UNKNOWN
            status: int = int(solver.solve(plan.model, watcher))  # type: ignore[call-overload]
            if status == cp_model.MODEL_INVALID:
                raise RuntimeError(
                    f"the constraint solver refuses the model: {plan.model.validate()}"
                )
            if status in (cp_model.UNKNOWN, cp_model.FEASIBLE) and watcher is not None:
                watcher.on_bound(solver.best_objective_bound)
            self.race.spend(solver.response_proto.deterministic_time)
            return status
        finally:
            with self.race.lock:
                self.race.running.remove(solver)

    def _nothing_below(self, value: int, below: bool) -> None:
        """The model has no solution although the incumbent's value is given; unless it asked for
        what is `below`, the incumbent itself was in it.
        """
        if not below:
            self.door.refuse(["the model leaves out a schedule that the checker has accepted."])
        else:
            self.race.raise_bound(value, Prover.CP_SAT)


class States:
    """The search over states along the clock as a worker of a race."""

    def __init__(self, race: Race) -> None:
        self.race, self.door, self.goal, self.effort = race, race.door, race.goal, race.effort
        self.instance, self.layout = race.instance, race.layout

    def run(self) -> None:
        """State-space search for anything quicker than the incumbent; where operators have little
        choice it proves in a second what CP-SAT cannot.
        """
        if not self._may_help or not self.race.await_incumbent():
            return
        while not self.race.over and not self._is_near:
            threading.Event().wait(0.05)
        self._run_for(REFUTE_S)

    def run_near(self, work: float) -> None:
        """The same if the bound is near the incumbent, and for no longer than `work` seconds."""
        if self._may_help and self._is_near:
            self._run_for(min(REFUTE_S, work))

    @property
    def _may_help(self) -> bool:
        instance = self.instance
        return (
            not self.goal.stress
            and len(instance.tasks) <= REFUTABLE
            and len(instance.operators) <= REFUTABLE_OPERATORS
        )

    @property
    def _is_near(self) -> bool:
        return self.race.bound >= REFUTE_NEAR * (self.race.value or 0)

    def _run_for(self, seconds: float) -> None:
        """For so many processor seconds."""
        spent = thread_time() + seconds
        while not self.race.over and thread_time() < spent:
            proof = self._refuted(self.race.value or 0, spent)
            self.race.raise_bound(proof.bound * self.goal.time, Prover.STATES)
            if proof.starts is not None and not self._take(proof.starts):
                return

    def _refuted(self, value: int, spent: float) -> Proof:
        """How far the search for anything below this value came before the incumbent changed or its
        time was spent.
        """

        def stop() -> bool:
            return self.race.over or self.race.value != value or thread_time() > spent

        return prove_makespan(
            self.instance,
            value // self.goal.time,
            self.effort.left(),
            most_units=self.goal.max_stress,
            stop=stop,
        )

    def _take(self, starts: Sequence[tuple[int, int]]) -> bool:
        """Takes a schedule that knows precedence and operators only, if it can be made to keep the
        other rules too.
        """
        if self.instance.same_operator or self.instance.has_limits:
            return False
        order = by_start(self.instance, starts)
        sound = append(self.layout, order, [way for way, _ in starts])
        return sound is not None and in_time(self.instance, sound) and self.race.found(sound)


class _Watcher(cp_model.CpSolverSolutionCallback):
    """Hands on what the prover finds, and stops it when an improver has overtaken it for long."""

    def __init__(
        self,
        race: Race,
        solver: cp_model.CpSolver,
        plan: Decisions,
        cut: int | None,
        patience: float,
    ) -> None:
        super().__init__()
        self.race, self.solver, self.plan, self.cut, self.patience = (
            race,
            solver,
            plan,
            cut,
            patience,
        )
        # a lone worker calls from the thread that asked, so that its own time is known
        self.clock = thread_time if solver.parameters.num_workers == 1 else monotonic
        self.began, self.mine, self.outdated = self.clock(), cut, False

    def on_solution_callback(self) -> None:
        starts = self.plan.read(self.value)
        value = self.race.proposed(starts, round(self.objective_value))
        # what it was given counts, too: its own first schedule may be a worse one
        self.mine = min((v for v in (self.mine, value) if v is not None), default=None)
        self._look()

    def on_bound(self, bound: float) -> None:
        known = ceil(bound - 1e-6)
        least = known if self.cut is None else min(known, self.cut)
        self.race.raise_bound(least, Prover.CP_SAT)
        self._look()

    def _look(self) -> None:
        race = self.race
        overtaken = race.value is not None and (self.mine is None or race.value < self.mine)
        if (
            race.over
            or race.door.refused
            or (overtaken and self.clock() - self.began > self.patience)
        ):
            self.outdated = not race.over
            self.solver.stop_search()
