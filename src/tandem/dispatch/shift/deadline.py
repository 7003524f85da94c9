"""A decision in time: whatever the decider does, an answer comes within the budget.

The decider works in a thread that ends with its answer. When it is not ready in time, fails, or
says something that is not allowed, a rule answers instead, and should that fail, a plain one which
needs nothing but the situation. The decision says so (`Answered.instead`), and a replay asks the
same ones again.

Deciders limit their work, not their time; this is the guard for when a machine is busier, or
slower, than was thought.
"""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from time import perf_counter
from typing import Literal

from tandem.dispatch.deciders.own import fault_of
from tandem.dispatch.deciders.policy import Decision, Policy
from tandem.dispatch.deciders.words import phrase
from tandem.dispatch.situation.legal import legal
from tandem.dispatch.situation.model import Situation
from tandem.dispatch.situation.transitions import beginning

Instead = Literal["", "late", "failed"]

FOR_THE_DECIDER = 0.75
"""Share of the budget after which the rule answers; the rest is for the rule and the journal."""


@dataclass(frozen=True)
class Answered:
    """A decision, and why the rule gave it and not the decider: it was "late", or it "failed"
    (`fault` says how); "" when the decider gave it.
    """

    decision: Decision
    instead: Instead = ""
    fault: str = ""


class InTime:
    """A decider and the rule that stands in for it.

    Attributes:
      policy, rule: both deciders; the rule takes a millisecond or so.
      budget_ms: for each decision, from question to answer.
    """

    def __init__(self, policy: Policy, rule: Policy, budget_ms: float) -> None:
        self.policy, self.rule, self.budget_ms = policy, rule, budget_ms
        self._late: threading.Thread | None = None  # still at an earlier question

    def warm_up(self, situation: Situation) -> None:
        """Asks both once without a budget: what they load or reckon once belongs before the shift.
        What they say counts for nothing.
        """
        self._stand_in(situation)
        self._heard(partial(self.policy.decide, situation))

    def decide(self, situation: Situation) -> Answered:
        """What begins now, within the budget."""
        began = perf_counter()
        said = self._ask(situation, self.budget_ms / 1000 * FOR_THE_DECIDER)
        answered = (
            Answered(self._stand_in(situation), "late")
            if said is None
            else self._judged(situation, said)
        )
        return replace(
            answered,
            decision=replace(answered.decision, latency_ms=(perf_counter() - began) * 1000),
        )

    def settle(self) -> None:
        """Waits for a decider that is still at an earlier question: for where nobody waits, as on a
        floor between two events.
        """
        if self._late is not None:
            self._late.join()

    def again(self, situation: Situation, instead: Instead, fault: str = "") -> Answered:
        """The same once more, without a budget: by the rule where it stood in then, because the
        decider was late or failed (`fault` says how).
        """
        if instead:
            return Answered(self._stand_in(situation), instead, fault)
        return self._judged(situation, self._heard(partial(self.policy.decide, situation)))

    def _judged(self, situation: Situation, said: Decision | Exception) -> Answered:
        fault = (
            fault_of(situation, said)
            if isinstance(said, Decision)
            else f"{type(said).__name__}: {said}"
        )
        if isinstance(said, Decision) and not fault:
            return Answered(said)
        return Answered(self._stand_in(situation), "failed", fault)

    def _stand_in(self, situation: Situation) -> Decision:
        said = self._heard(partial(self.rule.decide, situation))
        return (
            said
            if isinstance(said, Decision) and not fault_of(situation, said)
            else plainly(situation)
        )

    def _heard(self, decide: Callable[[], Decision]) -> Decision | Exception:
        try:
            return decide()
        except Exception as error:  # noqa: BLE001  a decider that fails must not stop the floor
            return error

    def _ask(self, situation: Situation, seconds: float) -> Decision | Exception | None:
        """What the decider says; None when that is not there in time, or when it is still at an
        earlier question.
        """
        if self._late is not None and self._late.is_alive():
            return None
        said: queue.SimpleQueue[Decision | Exception] = queue.SimpleQueue()
        thread = threading.Thread(
            target=lambda: said.put(self._heard(partial(self.policy.decide, situation))),
            name="decider",
            daemon=True,
        )
        thread.start()
        try:
            answer = said.get(timeout=seconds)
        except queue.Empty:
            self._late = thread
            return None
        thread.join()
        return answer


def plainly(situation: Situation) -> Decision:
    """The last resort: whoever is idle begins, or is asked for, the first thing that is allowed, in
    the cell's order; humans first.
    """
    humans = set(situation.cell.humans)
    begins = beginning(
        situation, sorted(legal(situation), key=lambda start: not humans.intersection(start[1]))
    )
    return Decision(
        starts=tuple(start for start in begins if not humans.issuperset(start[1])),
        announced={who: task for task, operators in begins for who in operators if who in humans},
        alternatives=(),
        bound=0.0,
        why=f"{phrase(situation, begins)}: "
        + (
            "the first that is allowed, for neither the decider nor the rule could answer."
            if begins
            else "nothing is allowed."
        ),
        by="plain",
        asks=tuple(start for start in begins if humans.intersection(start[1])),
    )
