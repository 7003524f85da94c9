"""What deep Q-learning is told: a frozen configuration that checks itself. No JAX is needed to read
it.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Annotated, Any, Literal

from pydantic import Field

from tandem.learn.settings import LARGEST, Batch, Count, Positive, Share, Units, checked, must_hold


@checked
@dataclass(frozen=True)
class Config:
    """Deep Q-learning (Mnih et al. 2015) by several agents that take turns.

    ASSUMPTION throughout for Yu, Huang and Chang (2021): their hyper-parameters are not public;
    these are common ones.

    Attributes:
      decisions: budget, summed over the games and agents.
      games: played side by side.
      kept: decisions that are remembered, in each agent's memory.
      minibatch, learn_every: how much is learned from, after how many rounds of moves.
      warm_up: rounds of moves before the first learning.
      learning_rate: of Adam; it falls to a tenth of that along a straight line.
      discount: gamma, for each own turn.
      explore_from, explore_to, explore_share: a random move has the first probability at the start
        and falls to the second within that share of the budget.
      target_every: the target network becomes the learned one after so many learnings.
      double: the next move is chosen by the learned network and valued by the target network (van
        Hasselt et al. 2016).
      agents: "each" has a network and a memory of its own; "one" network decides for all
        (single-agent DQN).
      horizon: what a decision's value is continued from: the agent's "own" next turn, or the "next"
        turn, whoever's it is.
      units: of the networks' layers.
      gradient_limit: largest norm of the gradient.
    """

    decisions: Count = 120_000
    games: Batch = 32
    kept: Annotated[int, Field(ge=1, le=2**22)] = 8192
    minibatch: Batch = 128
    learn_every: Count = 2
    warm_up: Annotated[int, Field(ge=0, le=LARGEST)] = 50
    learning_rate: Positive = 1e-3
    discount: Share = 1.0
    explore_from: Share = 1.0
    explore_to: Share = 0.05
    explore_share: Share = 0.5
    target_every: Count = 100
    double: bool = False
    agents: Literal["each", "one"] = "each"
    horizon: Literal["own", "next"] = "own"
    units: Units = 64
    gradient_limit: Positive = 10.0

    def __post_init__(self) -> None:
        if self.kept % self.games:
            must_hold([f"kept {self.kept}: must be a multiple of games = {self.games}."])

    def to_dict(self) -> dict[str, Any]:
        """Plain values, as a run keeps them."""
        return asdict(self)
