"""Whole games under a search or under the network alone, many side by side in one compiled loop.

Axes: `L` moves of the longest game, `B` games, `K` moves to choose from.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from tandem.learn.alphazero.config import EpsilonGreedy, Search
from tandem.learn.alphazero.network import Network, Parameters, greedy_action
from tandem.learn.alphazero.search import Found, search
from tandem.learn.env import Game, State

Array = Any
Looking = Any
"""How a move is found: a `Search`, an `EpsilonGreedy`, or what else `SEARCHES` knows; frozen, so
that it can be compiled for.
"""


def epsilon_greedy(
    key: Array,
    network: Network,
    parameters: Parameters,
    games: Game,
    states: State,
    config: EpsilonGreedy,
) -> Found:
    """The network's greedy move, or now and then any legal one; `Found.policy` names the greedy
    one, and nothing is said of what is to come.
    """
    pick_key, astray_key = jax.random.split(key)
    legal = jax.vmap(lambda game, state: game.legal(state))(games, states)
    best = jax.vmap(lambda game, state: greedy_action(network, parameters, game, state))(
        games, states
    )
    drawn = jnp.argmax(jnp.where(legal, jax.random.uniform(pick_key, legal.shape), -1.0), -1)
    astray = jax.random.uniform(astray_key, best.shape) < config.share
    return Found(
        jnp.where(astray, drawn, best).astype(jnp.int32),
        jax.nn.one_hot(best, legal.shape[1]),
        jnp.zeros(best.shape),
    )


SEARCHES: dict[type[Any], Any] = {Search: search, EpsilonGreedy: epsilon_greedy}
"""How a search is told -> the search. One more is an entry by who has it: `SEARCHES[Mine] =
my_search`.
"""


def find(
    key: Array,
    network: Network,
    parameters: Parameters,
    games: Game,
    states: State,
    config: Looking,
) -> Found:
    """What the search that `config` tells of finds in `states` `[B]` of `games` `[B]`."""
    found: Found = SEARCHES[type(config)](key, network, parameters, games, states, config)
    return found


class Experience(NamedTuple):
    """What was seen and found at each decision; leading axes `[L, B]`, once flattened one.

    seen: what the network was shown. legal: `[K]` bool. mover: `[]` int32. least: `[]`, units that
    were certain. policy: `[K]`, after the search. to_come: `[]`, units that were still to come, as
    the game then went. valid: `[]` bool, False after the end.
    """

    seen: Any
    legal: Array
    mover: Array
    least: Array
    policy: Array
    to_come: Array
    valid: Array


class FinishedGames(NamedTuple):
    """cost: `[B]` float32, of each whole game. moves: `[L, B]` int32; -1 after the end. state: the
    last states. over: `[B]` bool.
    """

    cost: Array
    moves: Array
    state: State
    over: Array


def selfplay(
    key: Array,
    network: Network,
    parameters: Parameters,
    games: Game,
    config: Looking,
    trust: float = 1.0,
) -> tuple[Experience, FinishedGames]:
    """One whole game on each of `games` `[B]`, every move by a search.

    Args:
      trust: how much of `to_come` is what really came; the rest is what the search expected.
    """
    states = jax.vmap(lambda game: game.reset())(games)

    def move(states: State, key: Array) -> tuple[State, tuple[Experience, Array, Array]]:
        over = _are_over(games, states)
        found = find(key, network, parameters, games, states, config)
        # kept as the network was shown it: the games themselves are not held in memory
        seen, legal, mover, least = jax.vmap(shown)(games, states)
        after, cost = jax.vmap(lambda game, state, move: game.step(state, move))(
            games, states, found.move
        )
        experience = Experience(seen, legal, mover, least, found.policy, found.to_come, ~over)
        return after, (experience, cost / games.unit, jnp.where(over, 0, found.move + 1))

    states, (experience, cost, moves) = jax.lax.scan(
        _while_on(move, games), states, jax.random.split(key, games.longest)
    )
    to_come = jnp.cumsum(cost[::-1], 0)[::-1]
    experience = experience._replace(to_come=trust * to_come + (1 - trust) * experience.to_come)
    return experience, FinishedGames(
        to_come[0] * games.unit, moves - 1, states, _are_over(games, states)
    )


def play_games(
    key: Array, network: Network, parameters: Parameters, games: Game, config: Looking | None = None
) -> FinishedGames:
    """One whole game on each of `games` `[B]`: by a search, or the move that the network likes best
    where `config` is None.
    """
    states = jax.vmap(lambda game: game.reset())(games)

    def move(states: State, key: Array) -> tuple[State, tuple[Array, Array]]:
        if config is None:
            chosen = jax.vmap(lambda game, state: greedy_action(network, parameters, game, state))(
                games, states
            )
        else:
            chosen = find(key, network, parameters, games, states, config).move
        after, cost = jax.vmap(lambda game, state, move: game.step(state, move))(
            games, states, chosen
        )
        return after, (cost, jnp.where(_are_over(games, states), 0, chosen + 1))

    states, (cost, moves) = jax.lax.scan(
        _while_on(move, games), states, jax.random.split(key, games.longest)
    )
    return FinishedGames(jnp.sum(cost, 0), moves - 1, states, _are_over(games, states))


def _are_over(games: Game, states: State) -> Array:
    return jax.vmap(lambda game, state: game.is_over(state))(games, states)


def _while_on(
    move: Callable[[State, Array], tuple[State, Any]], games: Game
) -> Callable[[State, Array], tuple[State, Any]]:
    """`move`, which is not worked out any more (all its numbers are 0) once all games are over."""

    def one(states: State, key: Array) -> tuple[State, Any]:
        shape = jax.eval_shape(move, states, key)[1]

        def nothing(states: Any, key: Array) -> tuple[Any, Any]:
            return states, jax.tree.map(lambda leaf: jnp.zeros(leaf.shape, leaf.dtype), shape)

        return jax.lax.cond(jnp.all(_are_over(games, states)), nothing, move, states, key)

    return one


def shown(game: Game, state: State) -> tuple[Any, Array, Array, Array]:
    """What an experience says of a state before the search: `seen`, `legal`, `mover`, `least`."""
    return (
        game.observe(state),
        game.legal(state),
        game.to_play(state),
        game.least(state) / game.unit,
    )
