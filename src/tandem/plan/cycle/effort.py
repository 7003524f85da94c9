"""How hard a search for a cycle works, and how its solver is stopped."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import dataclass
from math import ceil
from time import monotonic

from ortools.sat.python import cp_model

from tandem.plan.portfolio import Meter


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
    """How hard to work.

    Attributes:
      until: `monotonic()` seconds at which to stop; None for never.
      meter: how much work is left, of one worker; None for no limit.
    """

    until: float | None
    seed: int
    workers: int
    meter: Meter | None = None

    @property
    def is_spent(self) -> bool:
        """Time is up, or the work is done."""
        return self.left() <= 0 or (self.meter is not None and self.meter.left <= 0)

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
        solver = cp_model.CpSolver()
        parameters = solver.parameters
        parameters.random_seed = self.seed if work is None else 0
        parameters.num_workers = self.workers if work is None and self.meter is None else 1
        parameters.catch_sigint_signal = False
        if self.until is not None:
            parameters.max_time_in_seconds = max(0.01, share * self.left())
        limits = [work] if work is not None else []
        if self.meter is not None:
            limits.append(max(1e-4, share * self.meter.left))
        if limits:
            parameters.max_deterministic_time = min(limits)
        status = _status(solver, model)
        if self.meter is not None:
            self.meter.spend(solver.response_proto.deterministic_time)
        if status in ("OPTIMAL", "FEASIBLE"):
            bound = ceil(solver.best_objective_bound - 1e-6)
            late = self.until is not None and self.left() < 0.1 + 0.2 * solver.wall_time
            cut = status == "FEASIBLE" and late
            return Answer(solver, round(solver.objective_value), bound, status == "OPTIMAL", cut)
        assert status != "MODEL_INVALID", model.validate()
        return Answer(None, None, 0, status == "INFEASIBLE")


def _status(solver: cp_model.CpSolver, model: cp_model.CpModel) -> str:
    """Solves in a thread, so that Ctrl-C is heard at once."""
    with ThreadPoolExecutor(1) as pool:
        solving = pool.submit(solver.solve, model)
        try:
            while wait([solving], 0.1).not_done:
                pass
        except KeyboardInterrupt:
            while wait([solving], 0.02).not_done:
                solver.stop_search()
            raise
    return solver.status_name(solving.result())
