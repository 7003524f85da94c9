"""One decider for each cell of a shift whose products differ."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from tandem.dispatch.deciders.policy import Chosen, Decision, Policy, Start, plan_of
from tandem.dispatch.situation.model import Situation


@dataclass(frozen=True)
class ByVariant:
    """Asks the decider that was made for the cell of the product under way.

    Attributes:
      policies: variant -> its decider; None stands for the shift's own cell.
    """

    policies: Mapping[str | None, Policy]

    @property
    def name(self) -> str:
        """As of the shift's own cell."""
        return self.policies[None].name

    @property
    def chosen(self) -> Chosen | None:
        """The plan that is carried out or followed for the shift's own cell, if any is."""
        return plan_of(self.policies[None])

    def decide(self, situation: Situation) -> Decision:
        """What that decider says."""
        return self.of(situation).decide(situation)

    def of(self, situation: Situation) -> Policy:
        """The decider for the product under way."""
        return self.policies[None if situation.product is None else situation.product.variant]


def order_of(policy: Policy, situation: Situation) -> Sequence[Start]:
    """The order of the plan that the decider carries out for the product under way; empty for those
    who carry out none.
    """
    one = policy.of(situation) if isinstance(policy, ByVariant) else policy
    order: Sequence[Start] = getattr(one, "order", ())
    return order
