"""Who decides live: one protocol, one decision, and one table of all deciders.

A decider looks at a `Situation`, which holds what has been seen and nothing more, and says what begins now. It keeps no memory that
matters: the same situation gives the same decision (within the same budget), so that a journal can be replayed.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import import_module
from typing import TYPE_CHECKING, Protocol

from tandem.cell.model import Cell
from tandem.cell.names import Known
from tandem.errors import UsageError

if TYPE_CHECKING:
    from tandem.dispatch.situation import Situation

Start = tuple[str, tuple[str, ...]]
"""A task, and the operators who begin it together."""


@dataclass(frozen=True)
class Objective:
    """What a decider makes small: `time * makespan + stress * stress`, within a limit of stress.

    Attributes:
      time, stress: weights, per second and per unit of the cell's stress.
      max_stress: the most stress of all humans together; None for no limit but the cell's own.
    """

    time: float = 1.0
    stress: float = 0.0
    max_stress: float | None = None

    def __post_init__(self) -> None:
        if any(not math.isfinite(weight) or weight < 0 for weight in (self.time, self.stress)) or not self.time + self.stress:
            raise UsageError(f"weights {self.time:g}, {self.stress:g}: both must be 0 or more, and one of them more than 0.")
        if self.max_stress is not None and not (math.isfinite(self.max_stress) and self.max_stress >= 0):
            raise UsageError(f"max_stress {self.max_stress}: must be a number, 0 or more.")

    def cost(self, makespan: float, stress: float) -> float:
        """Seconds and stress as one number."""
        return self.time * makespan + self.stress * stress


SECONDS = Objective()
"""Time alone."""


@dataclass(frozen=True)
class Options:
    """What may be set of a decider; each decider uses what concerns it.

    Attributes:
      budget_ms: the most milliseconds that a decision may take.
      seed: of whatever a decider draws.
      random: how often, as a share, the model of the human picks any legal task (`expected` plans for it).
      prior: pace factor -> probability: how slow a human may turn out to be (2 = needs twice the stated time), before anything was seen.
      frozen_s: what was announced to a human within so many seconds is not changed any more.
      change_penalty: seconds that a better plan must gain before an announced task is changed.
      learned: a file or folder with a trained policy, for `learned` and `auto`; None for none.
    """

    budget_ms: float = 50.0
    seed: int = 0
    random: float = 0.0
    prior: Mapping[float, float] = field(default_factory=lambda: {0.6: 0.1, 0.8: 0.2, 1.0: 0.3, 1.5: 0.2, 2.0: 0.1, 3.0: 0.1})
    frozen_s: float = 0.0
    change_penalty: float = 0.0
    learned: str | None = None

    def __post_init__(self) -> None:
        if not self.budget_ms > 0:
            raise UsageError(f"budget {self.budget_ms:g} ms: must be more than 0.")
        if not 0 <= self.random <= 1:
            raise UsageError(f"random {self.random:g}: a share lies between 0 and 1.")
        if not self.prior or any(not (pace > 0 and share >= 0) for pace, share in self.prior.items()) or not sum(self.prior.values()) > 0:
            raise UsageError(f"prior {dict(self.prior)}: needs pace factors above 0, each with a probability of 0 or more.")
        if self.frozen_s < 0 or self.change_penalty < 0:
            raise UsageError(f"frozen {self.frozen_s:g} s, change penalty {self.change_penalty:g} s: neither can be negative.")


@dataclass(frozen=True)
class Alternative:
    """A choice that was open, and what the decider reckoned it would come to.

    Attributes:
      starts: what would begin now; empty for waiting.
      expected_cost: of the whole assembly, in the objective's measure; None when it was not reckoned.
    """

    starts: tuple[Start, ...]
    expected_cost: float | None


@dataclass(frozen=True)
class Decision:
    """What begins now, and why.

    Attributes:
      starts: tasks that robots begin now, alone or with a human who is asked for it too; empty when all of them wait or are busy.
      announced: human -> the task that they are asked to do now or next; who is missing is asked to wait.
      alternatives: the choices that were open, best first, the one taken included.
      bound: seconds that the remaining work takes at least from now on, whoever does it (times as the decider believes them).
      why: one sentence for the people beside the robot.
      by: name of the decider that answered.
      latency_ms: how long it took; no part of what makes two decisions equal.
      expected_cost: of the choice taken; None when it was not reckoned. With `bound` it gives the gap.
      look_again: when (s) the decider wants to be asked again although nothing has happened: a human who has not finished by then is slower
        than it takes for granted. None: at the next event only.
      asks: what humans are asked to begin now, with all who are to take part; of `announced` the part that is for now.
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
    """A decider. Reads the situation, never changes it, and answers always, even when nothing can begin."""

    @property
    def name(self) -> str:
        """What tables call it."""
        ...

    def decide(self, situation: Situation) -> Decision:
        """What begins now."""
        ...


@dataclass(frozen=True)
class Entry:
    """A line of the table: what the decider does, and where its maker stands (`module:function`, loaded when it is asked for).

    A maker takes a cell, an `Objective` and `Options`, may take seconds, which are spent before the shift begins, and raises CellError for a cell
    that the decider cannot hold. `argument` is handed to it first when it is given: one maker then makes several deciders.
    """

    what: str
    where: str
    argument: str | None = None

    def __call__(self, cell: Cell, objective: Objective, options: Options) -> Policy:
        module, name = self.where.split(":")
        maker = getattr(import_module(module), name)
        policy: Policy = maker(cell, objective, options) if self.argument is None else maker(self.argument, cell, objective, options)
        return policy


def _rule(name: str, what: str) -> Entry:
    return Entry(what, "tandem.dispatch.by_rule:by_rule", name)


POLICIES: dict[str, Entry] = {
    "fixed": Entry("the exact plan for the stated times, its order kept whatever happens", "tandem.dispatch.fixed:fixed"),
    "random": _rule("random", "tasks in random order"),
    "spt": _rule("spt", "shortest task first"),
    "lpt": _rule("lpt", "longest task first"),
    "longest-tail": _rule("longest-tail", "the task with the longest chain behind it first"),
    "earliest-completion": _rule("earliest-completion", "whatever can be finished first"),
    "heft": _rule("heft", "by upward rank over mean times (Topcuoglu et al. 2002)"),
    "least-stress": _rule("least-stress", "the way with the least stress, then the longest tail"),
    "balanced": _rule("balanced", "longest tail, work to whom it suits at the price of each operator's time"),
    "weighted": _rule("weighted", "longest tail, stress weighed against time"),
    "best-of-n": _rule("best-of-n", "the best of randomised schedules of the rule 'balanced', made anew at each event"),
    "replan": Entry("CP-SAT plans the rest anew at each event, with the stated times; the first plan found is taken", "tandem.dispatch.replan:plain"),
    "replan-robust": Entry(
        "as replan, with each person's estimated pace; of good plans the one that is best on average", "tandem.dispatch.replan:robust"
    ),
    "expected": Entry("exact: the least expected cost beside the human as modelled; small cells", "tandem.dispatch.tables:expected"),
    "minimax": Entry("exact: the least cost that no human can spoil; small cells", "tandem.dispatch.tables:minimax"),
    "learned": Entry("a trained best response to many people, a network in NumPy", "tandem.dispatch.learned:learned"),
    "auto": Entry("learned, else planned anew if there is time, else a rule; always answers within the budget", "tandem.dispatch.auto:auto"),
}
"""Name -> decider. A new one is a file and a line here."""


def policy(name: str, cell: Cell, objective: Objective = SECONDS, options: Options | None = None) -> Policy:
    """The decider of this name for the cell.

    Raises:
      UsageError: there is none of this name.
      CellError: it cannot hold this cell.
    """
    known = Known(POLICIES)
    if name not in known:
        raise UsageError(f"there is no policy {name!r}. {known.hint(name)} `tandem policies` lists them.")
    return POLICIES[name](cell, objective, options or Options())
