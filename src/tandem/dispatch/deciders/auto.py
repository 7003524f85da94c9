"""`auto`: whoever is best of those who can answer in time, and a rule when nobody can. It always
answers.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from time import perf_counter

from tandem.cell.model import Cell
from tandem.dispatch.deciders.by_rule import by_rule
from tandem.dispatch.deciders.policy import Decision, Options, Policy
from tandem.dispatch.deciders.replan import robust
from tandem.dispatch.deciders.table import POLICIES
from tandem.dispatch.lookahead.objective import Objective
from tandem.dispatch.situation.model import Situation
from tandem.errors import TandemError

RULE = "longest-tail"


def auto(cell: Cell, objective: Objective, options: Options) -> Auto:
    """The chain: the learned policy where one is given and fits the cell, re-planning, a rule.

    Raises CellError when not even the rule can hold the cell.
    """
    rule = by_rule(RULE, cell, objective, options)
    chain: list[Policy] = []
    if options.learned is not None:
        chain.append(POLICIES["learned"](cell, objective, options))
    chain.append(robust(cell, objective, replace(options, budget_ms=options.budget_ms * SHARE)))
    return Auto(tuple(chain), rule, options.budget_ms)


SHARE = 0.8
"""Of the budget, what the planner gets; the rule answers in the rest."""


@dataclass(frozen=True)
class Auto:
    """Asks the deciders of the chain in turn while there is time for them, and the rule last."""

    chain: Sequence[Policy]
    rule: Policy
    budget_ms: float
    name: str = "auto"

    def decide(self, situation: Situation) -> Decision:
        """The answer of the first who has one. A decider that fails is passed over; the sentence
        says so.
        """
        began = perf_counter()
        failed: list[str] = []
        for policy in self.chain:
            if 1000 * (perf_counter() - began) > self.budget_ms * SHARE:
                break
            try:
                return self._signed(policy.decide(situation), began, failed)
            except (TandemError, ArithmeticError, LookupError, ValueError) as error:
                failed.append(
                    f"{policy.name} could not decide, {type(error).__name__}:"
                    f" {str(error).rstrip('.')}"
                )
        return self._signed(self.rule.decide(situation), began, failed)

    def _signed(self, decision: Decision, began: float, failed: Sequence[str]) -> Decision:
        why = f"{decision.why} ({'; '.join(failed)}.)" if failed else decision.why
        return replace(
            decision, by=f"auto: {decision.by}", why=why, latency_ms=1000 * (perf_counter() - began)
        )
