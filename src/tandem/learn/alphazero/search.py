"""Tree search in the real game, guided by a network: Gumbel MuZero and PUCT, by the library `mctx`.

Sources: Danihelka et al. (2022), "Policy improvement by planning with Gumbel" (`gumbel`); Silver et
al. (2017), arXiv:1712.01815, and Schrittwieser et al. (2020), arXiv:1911.08265, for `puct`. The
state of the game is the tree's embedding, so nothing is modelled: a node holds what would really
be. All agents share one cost; a reward is minus what a step costs and a value is minus what is
still to come, for whoever moves.

Axes: `B` games side by side, `K` moves.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import mctx

from tandem.learn.alphazero.config import Search
from tandem.learn.alphazero.network import IMPOSSIBLE, Network, Parameters, predict
from tandem.learn.env import Game, State

Array = Any


class Found(NamedTuple):
    """What a search says.

    move: `[B]` int32, what to do. policy: `[B, K]`, how good each move looks after the search; sums
    to 1 over legal moves. to_come: `[B]`, the cost that is still to come, in units, as the root
    sees it after the search.
    """

    move: Array
    policy: Array
    to_come: Array


def search(
    key: Array, network: Network, parameters: Parameters, games: Game, states: State, config: Search
) -> Found:
    """Looks ahead from `states` `[B]` of `games` `[B]`. The same key finds the same. In a game that
    is over any move is named, and means nothing.
    """
    legal = jax.vmap(lambda game, state: game.legal(state))(games, states)
    legal = legal | ~jnp.any(legal, 1, keepdims=True)
    seen = jax.vmap(lambda game, state: predict(network, parameters, game, state))(games, states)
    root = mctx.RootFnOutput(prior_logits=seen.logits, value=-seen.to_come, embedding=states)
    known = (parameters, games)
    common: dict[str, Any] = {"invalid_actions": ~legal, "max_depth": config.depth}
    if config.kind == "gumbel":
        run, special = (
            mctx.gumbel_muzero_policy,
            {"max_num_considered_actions": config.considered, "gumbel_scale": config.gumbel_scale},
        )
    else:
        noise = {"dirichlet_fraction": config.noise, "dirichlet_alpha": config.noise_alpha}
        run, special = (
            mctx.muzero_policy,
            {"pb_c_init": config.exploration, "temperature": config.temperature, **noise},
        )
    found = run(known, _light(key), root, _expand(network), config.simulations, **common, **special)
    return Found(found.action, found.action_weights, -found.search_tree.node_values[:, 0])


def _light(key: Array) -> Array:
    """A key of the generator that compiles and runs fastest: a search splits keys at every step of
    every descent, and draws at its root only.
    """
    return jax.random.wrap_key_data(jax.random.bits(key, (4,), jnp.uint32), impl="unsafe_rbg")


def _expand(network: Network) -> Any:
    """What `mctx` calls to make a node: a step of each game, and what the network predicts from
    there.
    """

    def one(
        parameters: Parameters, game: Game, move: Array, state: State
    ) -> tuple[mctx.RecurrentFnOutput, State]:
        over = game.is_over(state)
        after, cost = game.step(state, move)
        seen = predict(network, parameters, game, after)
        logits = jnp.where(game.legal(after), seen.logits, IMPOSSIBLE)
        reward, discount = -cost / game.unit, jnp.where(over, 0.0, 1.0)
        return mctx.RecurrentFnOutput(
            reward=reward, discount=discount, prior_logits=logits, value=-seen.to_come
        ), after

    def expand(
        known: Any, _: Array, moves: Array, states: State
    ) -> tuple[mctx.RecurrentFnOutput, State]:
        parameters, games = known
        return jax.vmap(one, (None, 0, 0, 0))(parameters, games, moves, states)

    return expand
