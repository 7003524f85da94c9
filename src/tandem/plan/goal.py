"""What a race is after, what is known of it, and how hard to work."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from time import monotonic

from tandem.plan.door import Admitted
from tandem.plan.provers import Prover, Step
from tandem.plan.starts import Starts


@dataclass(frozen=True)
class Goal:
    """The least `time * makespan + stress * stress` within limits; ticks and units."""

    time: int
    stress: int
    max_makespan: int | None = None
    max_stress: int | None = None

    def value(self, makespan: int, stress: int) -> int:
        """What is minimized."""
        return self.time * makespan + self.stress * stress

    def allows(self, makespan: int, stress: int) -> bool:
        """Whether the limits are kept."""
        return (self.max_makespan is None or makespan <= self.max_makespan) and (
            self.max_stress is None or stress <= self.max_stress
        )


@dataclass(frozen=True)
class GoalStatus:
    """What is known about a goal.

    Attributes:
      starts: the best schedule found, None when none was.
      bound: no schedule within the limits has a lower value; meaningless when the goal is proven
        infeasible.
      proven: the schedule is optimal or, when there is none, no schedule keeps the limits.
      steps: what each prover has added to the bound that was known before, rising.
      by: who proved last.
    """

    starts: Starts | None
    bound: int
    proven: bool
    steps: tuple[Step, ...] = ()
    by: Prover = Prover.CP_SAT


@dataclass
class Meter:
    """A limit on work, in CP-SAT's deterministic seconds, that counts down."""

    left: float

    def spend(self, work: float) -> None:
        """Takes note of work that was done."""
        self.left = max(0.0, self.left - work)


@dataclass
class Effort:
    """How hard to work, and on whose behalf.

    Attributes:
      until: `monotonic()` seconds at which to stop; None for never.
      seed, workers: of the search; one worker repeats exactly.
      offer: called in the calling thread with each schedule let in and the bound, may raise
        KeyboardInterrupt.
      work: CP-SAT's deterministic seconds after which a lone worker gives up; None to go on until
        it is proven.
      from_below: CP-SAT first tries whether the bound can be reached, which proves sooner and finds
        later than its own order of search.
      meter: how much work is left for everything, of one worker; None for no limit.
      refutes: a lone worker may also spend processor time on `refute`, which does not repeat.
    """

    until: float | None
    seed: int
    workers: int
    offer: Callable[[Admitted, int], None] = field(default=lambda schedule, bound: None)
    work: float | None = None
    from_below: bool = False
    meter: Meter | None = None
    refutes: bool = False

    @property
    def is_spent(self) -> bool:
        """Time is up, or the work is done."""
        return self.left() <= 0 or (self.meter is not None and self.meter.left <= 0)

    def left(self) -> float:
        """Seconds left."""
        return 1e9 if self.until is None else self.until - monotonic()
