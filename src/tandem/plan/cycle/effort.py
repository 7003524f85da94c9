"""How hard a search for a cycle works, and how its solver is stopped."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import dataclass, field
from math import ceil
from time import monotonic

from ortools.sat.python import cp_model

from tandem.plan.goal import Meter


@dataclass(frozen=True)
class Answer:
    """What CP-SAT says of a model.

    Attributes:
      solver: with a solution to read; None when there is none.
      value: of the objective; None without a solution.
      bound: nothing is better than this, in whole numbers; meaningless without a solution.
      proven: the solution is optimal or, when there is none, none exists.
      ended_by_clock: another run may find something else.
    """

    solver: cp_model.CpSolver | None
    value: int | None
    bound: int
    proven: bool
    ended_by_clock: bool = False


@dataclass
class Effort:
    """How hard to work. Questions may be asked from several threads at once.

    Attributes:
      until: `monotonic()` seconds at which to stop; None for never.
      meter: how much work is left, of one worker; None for no limit.
      stopped: somebody interrupted; nothing is begun any more.
    """

    until: float | None
    seed: int
    workers: int
    meter: Meter | None = None
    stopped: bool = False
    running: set[cp_model.CpSolver] = field(default_factory=set)

    @property
    def is_spent(self) -> bool:
        """Time is up, the work is done, or somebody interrupted."""
        used_up = self.meter is not None and self.meter.left <= 0
        return self.stopped or used_up or self.left() <= 0

    def left(self) -> float:
        """Seconds left."""
        return 1e9 if self.until is None else self.until - monotonic()

    def solve(
        self,
        model: cp_model.CpModel,
        objective: cp_model.LinearExprT,
        *,
        share: float = 1.0,
        work: float | None = None,
    ) -> Answer:
        """The least `objective` of the model, as far as the effort goes.

        Args:
          share: of the time or work that is left.
          work: CP-SAT's deterministic seconds of one worker, so that the answer is the same each
            time; the clock still ends it.
        """
        model.minimize(objective)
        solver = self._solver(share, work)
        solving = ThreadPoolExecutor(1)
        self.running.add(solver)
        try:
            # in a thread, so that Ctrl-C is heard at once
            future = solving.submit(solver.solve, model)
            while wait([future], 0.1).not_done:
                if self.stopped:
                    solver.stop_search()
        except KeyboardInterrupt:
            self.stop()
            raise
        finally:
            solving.shutdown()
            self.running.discard(solver)
        if self.meter is not None:
            self.meter.spend(solver.response_proto.deterministic_time)
        return self._answer(solver, model, solver.status_name(future.result()))

    def stop(self) -> None:
        """Ends what is under way."""
        self.stopped = True
        for solver in list(self.running):
            solver.stop_search()

    def _solver(self, share: float, work: float | None) -> cp_model.CpSolver:
        solver = cp_model.CpSolver()
        parameters = solver.parameters
        parameters.random_seed = self.seed if work is None else 0
        parameters.num_workers = self.workers if work is None and self.meter is None else 1
        parameters.catch_sigint_signal = False
        if work is not None:
            # on models of this size they cost more than they save
            parameters.symmetry_level = 0
            parameters.cp_model_probing_level = 0
        if self.until is not None:
            parameters.max_time_in_seconds = max(0.01, share * self.left())
        limits = [work] if work is not None else []
        if self.meter is not None:
            limits.append(max(1e-4, share * self.meter.left))
        if limits:
            parameters.max_deterministic_time = min(limits)
        return solver

    def _answer(self, solver: cp_model.CpSolver, model: cp_model.CpModel, status: str) -> Answer:
        assert status != "MODEL_INVALID", model.validate()
        late = self.until is not None and self.left() < 0.1 + 0.2 * solver.wall_time
        cut = status not in ("OPTIMAL", "INFEASIBLE") and (late or self.stopped)
        if status in ("OPTIMAL", "FEASIBLE"):
            bound = ceil(solver.best_objective_bound - 1e-6)
            return Answer(solver, round(solver.objective_value), bound, status == "OPTIMAL", cut)
        return Answer(None, None, 0, status == "INFEASIBLE", cut)
