"""Tree search in the real game, guided by a network: Gumbel MuZero and PUCT, by the library `mctx`.

Sources: Danihelka et al. (2022), "Policy improvement by planning with Gumbel" (`gumbel`); Silver et al. (2017), arXiv:1712.01815, and
Schrittwieser et al. (2020), arXiv:1911.08265, for `puct`. The state of the game is the tree's embedding, so nothing is modelled: a node holds
what would really be. All agents share one cost; a reward is minus what a step costs and a value is minus what is still to come, for whoever
moves.

Axes: `B` games side by side, `K` moves.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import jax
import jax.numpy as jnp
import mctx

from tandem.errors import UsageError
from tandem.learn.alphazero.network import Judge, Parameters, opinion
from tandem.learn.game import Game, State

Array = Any


class Found(NamedTuple):
    """What a search says.

    move: `[B]` int32, what to do. policy: `[B, K]`, how good each move looks after the search; sums to 1 over legal moves.
    to_come: `[B]`, the cost that is still to come, in units, as the root sees it after the search.
    """

    move: Array
    policy: Array
    to_come: Array


@dataclass(frozen=True)
class Search:
    """How a search is made.

    Attributes:
      kind: "gumbel" or "puct".
      simulations: for each decision.
      depth: moves that it looks ahead at most; None for no limit.
      considered: of "gumbel": how many moves of the root are looked at.
      gumbel_scale: of "gumbel": 1 draws, 0 is sure.
      exploration: of "puct": the constant c.
      noise, noise_alpha: of "puct": share and concentration of the Dirichlet noise at the root.
      temperature: of "puct": of the draw from the visits; 0 takes the most visited.
    """

    kind: Literal["gumbel", "puct"] = "gumbel"
    simulations: int = 16
    depth: int | None = None
    considered: int = 8
    gumbel_scale: float = 1.0
    exploration: float = 1.25
    noise: float = 0.25
    noise_alpha: float = 0.3
    temperature: float = 1.0

    def __post_init__(self) -> None:
        if faults := list(self.faults()):
            raise UsageError("The search does not hold:\n" + "\n".join(f"- {fault}" for fault in faults))

    def faults(self) -> Iterator[str]:
        """What is wrong with it."""
        if self.kind not in ("gumbel", "puct"):
            yield f"kind {self.kind!r}: choose gumbel or puct."
        for name in ("simulations", "considered"):
            if getattr(self, name) < 1:
                yield f"{name} {getattr(self, name)}: must be 1 or more."
        if self.depth is not None and self.depth < 1:
            yield f"depth {self.depth}: must be 1 or more, or None."
        for name in ("gumbel_scale", "exploration", "temperature"):
            if not getattr(self, name) >= 0:
                yield f"{name} {getattr(self, name)}: must be 0 or more."
        if not 0 <= self.noise <= 1 or not self.noise_alpha > 0:
            yield f"noise {self.noise}, noise_alpha {self.noise_alpha}: a share from 0 to 1, and a number above 0."


def search(key: Array, judge: Judge, parameters: Parameters, games: Game, states: State, config: Search) -> Found:
    """Looks ahead from `states` `[B]` of `games` `[B]`. The same key finds the same. In a game that is over any move is named, and means nothing."""
    legal = jax.vmap(lambda game, state: game.legal(state))(games, states)
    legal = legal | ~jnp.any(legal, 1, keepdims=True)
    seen = jax.vmap(lambda game, state: opinion(judge, parameters, game, state))(games, states)
    root = mctx.RootFnOutput(prior_logits=seen.logits, value=-seen.to_come, embedding=states)
    known = (parameters, games)
    shared = {"invalid_actions": ~legal, "max_depth": config.depth}
    if config.kind == "gumbel":
        found = mctx.gumbel_muzero_policy(
            known, key, root, _expand(judge), config.simulations,
            max_num_considered_actions=config.considered, gumbel_scale=config.gumbel_scale, **shared,
        )  # fmt: skip
    else:
        found = mctx.muzero_policy(
            known, key, root, _expand(judge), config.simulations,
            pb_c_init=config.exploration, dirichlet_fraction=config.noise, dirichlet_alpha=config.noise_alpha, temperature=config.temperature, **shared,
        )  # fmt: skip
    return Found(found.action, found.action_weights, -found.search_tree.node_values[:, 0])


def _expand(judge: Judge) -> Any:
    """What `mctx` calls to make a node: a step of each game, and the judge's opinion of where it leads."""

    def one(parameters: Parameters, game: Game, move: Array, state: State) -> tuple[mctx.RecurrentFnOutput, State]:
        over = game.is_over(state)
        after, cost = game.step(state, move)
        seen = opinion(judge, parameters, game, after)
        logits = jnp.where(game.legal(after), seen.logits, IMPOSSIBLE)
        reward, discount = -cost / game.unit, jnp.where(over, 0.0, 1.0)
        return mctx.RecurrentFnOutput(reward=reward, discount=discount, prior_logits=logits, value=-seen.to_come), after

    def expand(known: Any, _: Array, moves: Array, states: State) -> tuple[mctx.RecurrentFnOutput, State]:
        parameters, games = known
        return jax.vmap(one, (None, 0, 0, 0))(parameters, games, moves, states)

    return expand


IMPOSSIBLE = -1e9
"""The logit of a move that is not legal: its probability is 0 and its gradient finite."""
