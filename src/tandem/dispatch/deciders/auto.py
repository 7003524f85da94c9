"""`auto`: the best of those who can decide on this cell, and a rule when nobody can. It always
answers. Where few tasks are open it values every choice exactly, else it asks the policy for any
cell.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from time import perf_counter

from tandem.cell.model import Cell
from tandem.dispatch.deciders.any_cell import AnyCell, any_cell
from tandem.dispatch.deciders.by_rule import by_rule
from tandem.dispatch.deciders.policy import Chosen, Decision, Options, Policy, plan_of
from tandem.dispatch.deciders.robust import robust
from tandem.dispatch.deciders.table import POLICIES
from tandem.dispatch.lookahead.objective import Objective
from tandem.dispatch.situation.model import Situation
from tandem.errors import TandemError, UsageError

RULE = "longest-tail"


def auto(cell: Cell, objective: Objective, options: Options) -> Auto:
    """The chain: the learned policy where one is given and fits the cell; every open choice valued
    exactly, and where too much is open for that, the proposals of the policy for any cell (of the
    tuned one where such a one is given), or re-planning where a plan is followed; a rule.

    Raises:
      CellError: not even the rule can hold the cell.
      UsageError: both a plan and a learned policy are given.
    """
    if options.learned is not None and options.plan is not None:
        raise UsageError("auto: a plan and a trained policy are given. Give one, or name a policy.")
    rule = by_rule(RULE, cell, objective, options)
    exact = robust(cell, objective, options)
    if options.plan is not None:
        return Auto((exact,), rule)
    known = POLICIES["learned"](cell, objective, options)
    if isinstance(known, AnyCell):
        return Auto((replace(exact, proposer=known),), rule)
    return Auto((known, replace(exact, proposer=any_cell(cell, objective, options))), rule)


@dataclass(frozen=True)
class Auto:
    """Asks the deciders of the chain in turn, and the rule last."""

    chain: Sequence[Policy]
    rule: Policy
    name: str = "auto"

    @property
    def chosen(self) -> Chosen | None:
        """The plan that is followed; None for none."""
        return next((plan for policy in self.chain if (plan := plan_of(policy))), None)

    def decide(self, situation: Situation) -> Decision:
        """The answer of the first who has one. A decider that fails is passed over; the sentence
        says so.
        """
        began = perf_counter()
        failed: list[str] = []
        for policy in self.chain:
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
