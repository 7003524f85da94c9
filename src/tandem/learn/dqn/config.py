"""What deep Q-learning is told: a frozen configuration that checks itself. No JAX is needed to read
it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any, ClassVar, Literal

from pydantic import ConfigDict

from tandem.learn.forms import STRICT
from tandem.learn.settings import counts, must_hold, one_of


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

    decisions: int = 120_000
    games: int = 32
    kept: int = 8192
    minibatch: int = 128
    learn_every: int = 2
    warm_up: int = 50
    learning_rate: float = 1e-3
    discount: float = 1.0
    explore_from: float = 1.0
    explore_to: float = 0.05
    explore_share: float = 0.5
    target_every: int = 100
    double: bool = False
    agents: Literal["each", "one"] = "each"
    horizon: Literal["own", "next"] = "own"
    units: int = 64
    gradient_limit: float = 10.0

    __pydantic_config__: ClassVar[ConfigDict] = STRICT

    def __post_init__(self) -> None:
        must_hold(self.faults())

    def faults(self) -> Iterator[str]:
        """Everything that is wrong with it."""
        yield from counts(self, ("decisions", "learn_every", "target_every"))
        yield from counts(self, ("games", "minibatch"), most=2**16)
        yield from counts(self, ("kept",), most=2**22)
        yield from counts(self, ("units",), most=4096)
        yield from counts(self, ("warm_up",), least=0)
        if self.games > 0 and self.kept % self.games:
            yield f"kept {self.kept}: must be a multiple of games = {self.games}."
        for name in ("learning_rate", "gradient_limit"):
            if not getattr(self, name) > 0:
                yield f"{name} {getattr(self, name)}: must be more than 0."
        for name in ("discount", "explore_from", "explore_to", "explore_share"):
            if not 0 <= getattr(self, name) <= 1:
                yield f"{name} {getattr(self, name)}: must lie between 0 and 1."
        yield from one_of(self, "agents", ("each", "one"))
        yield from one_of(self, "horizon", ("own", "next"))

    def to_dict(self) -> dict[str, Any]:
        """Plain values, as a run keeps them."""
        return asdict(self)
