"""One decider for each cell of a shift whose products differ."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from tandem.dispatch.deciders.policy import Basis, Decision, Policy, basis_of
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
    def basis(self) -> Basis | None:
        """The plan that is carried out for the shift's own cell, if any is."""
        return basis_of(self.policies[None])

    def decide(self, situation: Situation) -> Decision:
        """What that decider says."""
        variant = None if situation.product is None else situation.product.variant
        return self.policies[variant].decide(situation)
