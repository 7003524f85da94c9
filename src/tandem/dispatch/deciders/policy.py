"""Who decides live: one protocol, one decision, and what may be set.

A decider looks at a `Situation`, which holds what has been seen and nothing more, and says what
begins now. It keeps no memory that matters and looks at no clock: the same situation and options
give the same decision, in a replay, on another machine, or in a process that has just begun.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol

from tandem.dispatch.lookahead.work import STEPS_PER_MS
from tandem.errors import UsageError
from tandem.plan.result import Result
from tandem.schedule.model import Schedule

if TYPE_CHECKING:
    from tandem.dispatch.situation.model import Situation

LONGEST_BUDGET_MS = 3_600_000
"""Of a decision. Nobody waits longer, and no clock has to count further."""

Start = tuple[str, tuple[str, ...]]
"""A task, and the operators who begin it together."""


@dataclass(frozen=True)
class Basis:
    """The plan that a decider carries out or follows, made before the shift.

    Attributes:
      makespan, stress: what it comes to, s and the cell's measure.
      proven: no plan is better by what was asked of it.
      least_makespan, least_stress: no plan falls below these.
    """

    makespan: float
    stress: float
    proven: bool
    least_makespan: float
    least_stress: float

    @classmethod
    def of(cls, found: Result, *, proven: bool) -> Basis:
        """What the result says of itself."""
        low = found.bound
        return cls(found.makespan, found.stress, proven, low.makespan, low.stress)

    @property
    def doubt(self) -> str:
        """What there is to say where it is not proven; empty where it is."""
        if self.proven:
            return ""
        return (
            f"the plan of {self.makespan:g} s and a stress of {self.stress:g} is the best found in"
            f" the time given, not proven the best: no plan is shorter than {self.least_makespan:g}"
            f" s or has less stress than {self.least_stress:g}."
        )


@dataclass(frozen=True)
class Chosen:
    """A plan that was chosen to be carried out or followed: the very schedule, and what is known of
    it. Stands in a shift's journal.
    """

    schedule: Schedule
    basis: Basis

    def to_dict(self) -> dict[str, Any]:
        """As plain values."""
        return {"assignments": self.schedule.to_list(), "basis": vars(self.basis).copy()}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Chosen:
        """The inverse of `to_dict`."""
        return cls(Schedule.from_list(data["assignments"]), Basis(**data["basis"]))


@dataclass(frozen=True)
class Options:
    """What may be set of a decider; each decider uses what concerns it.

    Attributes:
      budget_ms: the most milliseconds that a decision may take.
      seed: of whatever a decider draws.
      random: how often, as a share, the model of the human picks any legal task (`expected` plans
        for it).
      prior: pace factor -> probability: how slow a human may turn out to be (2 = needs twice the
        stated time), before anything was seen.
      frozen_s: what was announced to a human within so many seconds is not changed any more.
      change_penalty: seconds that a better plan must gain before an announced task is changed, or
        a plan that is followed is left.
      learned: a file or folder with a trained policy, for `learned` and `auto`; None for none.
      plan: the plan that is carried out (`fixed`) or followed while it is good; None for none.
      steps_per_ms: how much work a millisecond buys, in steps as `lookahead.work` counts them.
    """

    budget_ms: float = 50.0
    seed: int = 0
    random: float = 0.0
    prior: Mapping[float, float] = field(
        default_factory=lambda: {0.6: 0.1, 0.8: 0.2, 1.0: 0.3, 1.5: 0.2, 2.0: 0.1, 3.0: 0.1}
    )
    frozen_s: float = 0.0
    change_penalty: float = 0.0
    learned: str | None = None
    plan: Chosen | None = None
    steps_per_ms: float = STEPS_PER_MS

    def __post_init__(self) -> None:
        if not 0 < self.budget_ms <= LONGEST_BUDGET_MS:
            raise UsageError(
                f"budget {self.budget_ms:g} ms: must be more than 0, "
                f"and at most {LONGEST_BUDGET_MS}, an hour."
            )
        if not 0 < self.steps_per_ms < math.inf:
            raise UsageError(f"{self.steps_per_ms:g} steps in a millisecond: must be more than 0.")
        if not 0 <= self.random <= 1:
            raise UsageError(f"random {self.random:g}: a share lies between 0 and 1.")
        if not 0 < sum(self.prior.values()) < math.inf or any(
            not 0 < pace < math.inf or share < 0 for pace, share in self.prior.items()
        ):
            raise UsageError(
                f"prior {prior_words(self.prior)}: needs pace factors above 0, each with a"
                " probability of 0 or more."
            )
        if not (0 <= self.frozen_s < math.inf and 0 <= self.change_penalty < math.inf):
            raise UsageError(
                f"frozen {self.frozen_s:g} s, change penalty {self.change_penalty:g} s: "
                "both must be a number of seconds, 0 or more."
            )

    @property
    def work(self) -> float:
        """Steps that a decision may take; see `lookahead.work`."""
        return self.budget_ms * self.steps_per_ms


def prior_words(prior: Mapping[float, float]) -> str:
    """A prior as it is written on the command line: 0.6:1,1:3."""
    return ",".join(f"{factor:g}:{weight:g}" for factor, weight in prior.items()) or "of nothing"


def plan_of(policy: Policy) -> Chosen | None:
    """The plan that the decider carries out or follows; None for those who have none."""
    chosen = getattr(policy, "chosen", None)
    return chosen if isinstance(chosen, Chosen) else None


def basis_of(policy: Policy) -> Basis | None:
    """What is known of that plan; None where there is none."""
    chosen = plan_of(policy)
    return None if chosen is None else chosen.basis


@dataclass(frozen=True)
class Alternative:
    """A choice that was open, and what the decider reckoned it would come to.

    Attributes:
      starts: what would begin now; empty for waiting.
      expected_cost: of the whole assembly, in the objective's measure; None when it was not
        reckoned.
    """

    starts: tuple[Start, ...]
    expected_cost: float | None


@dataclass(frozen=True)
class Decision:
    """What begins now, and why.

    Attributes:
      starts: tasks that robots begin now, alone or with a human who is asked for it too; empty when
        all of them wait or are busy.
      announced: human -> the task that they are asked to do now or next; who is missing is asked to
        wait.
      alternatives: the choices that were open, best first, the one taken included.
      bound: seconds that the remaining work takes at least from now on, whoever does it (times as
        the decider believes them).
      why: one sentence for the people beside the robot.
      by: name of the decider that answered.
      latency_ms: how long it took; no part of what makes two decisions equal.
      expected_cost: of the choice taken; None when it was not reckoned. With `bound` it gives the
        gap.
      look_again: when (s) the decider wants to be asked again although nothing has happened: a
        human who has not finished by then is slower than it takes for granted. None: at the next
        event only.
      asks: what humans are asked to begin now, with all who are to take part; of `announced` the
        part that is for now.
    """

    starts: tuple[Start, ...]
    announced: Mapping[str, str]
    alternatives: tuple[Alternative, ...]
    bound: float
    why: str
    by: str
    latency_ms: float = field(default=0.0, compare=False)
    expected_cost: float | None = None
    look_again: float | None = None
    asks: tuple[Start, ...] = ()


class Policy(Protocol):
    """A decider. Reads the situation, never changes it, and answers always, even when nothing can
    begin.
    """

    @property
    def name(self) -> str:
        """What tables call it."""
        ...

    def decide(self, situation: Situation) -> Decision:
        """What begins now."""
        ...
