"""The training of Yu, Huang and Chang (2020), game by game, as their code was read (not copied);
see `config.YuConfig`.

`start` and `advance` are pure functions; the same key gives the same networks. Axes: 2 agents, the
robot first; `K` positions kept, `w` columns.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import optax

from tandem.lab.yu2020.config import YuConfig
from tandem.lab.yu2020.network import YuNetworks
from tandem.lab.yu2020.search import yu_search
from tandem.learn.alphazero.network import Parameters, greedy_action
from tandem.learn.env import Game, State, many

Array = Any


class Positions(NamedTuple):
    """What an agent remembers, a ring: board `[K, h, w, 3]`, legal `[K, w]` bool, policy `[K, w]`,
    to_come `[K]`, seconds.

    written: `[]` int32, how many ever.
    """

    board: Array
    legal: Array
    policy: Array
    to_come: Array
    written: Array


class Learner(NamedTuple):
    """A training under way. Everything but `key` and the counts has a leading axis of agents.
    games, moves: `[]` int32, done so far.
    """

    parameters: Parameters
    optimiser: Any
    positions: Positions
    key: Array
    games: Array
    moves: Array


class Report(NamedTuple):
    """What a game tells. cost: `[]` seconds. policy_loss, value_loss: `[]`, of the fit that
    followed. finite: `[]` bool.
    """

    cost: Array
    policy_loss: Array
    value_loss: Array
    finite: Array


def networks(config: YuConfig) -> YuNetworks:
    """The networks that are trained."""
    return YuNetworks(config.filters, config.dense, config.value_norm)


def start(key: Array, games: Game, config: YuConfig) -> Learner:
    """A learner that knows nothing yet. `games` `[P]`, of boards of one size that show the board
    itself.
    """
    network_key, key = jax.random.split(key)
    game = jax.tree.map(lambda leaf: leaf[0], games)
    parameters = networks(config).start(network_key, game)
    board = jax.eval_shape(lambda: game.observe(game.reset()))
    empty = Positions(
        jnp.zeros((2, config.kept, *board.shape)),
        jnp.zeros((2, config.kept, game.moves), bool),
        jnp.zeros((2, config.kept, game.moves)),
        jnp.zeros((2, config.kept)),
        jnp.zeros(2, jnp.int32),
    )
    zero = jnp.zeros((), jnp.int32)
    return Learner(
        parameters, jax.vmap(optax.scale_by_adam().init)(parameters), empty, key, zero, zero
    )


def learns(games: Array, config: YuConfig) -> Array:
    """`[]` int32, who learns in the game of that number, from 0: the robot first, then the human,
    in turns of `inner x switch` games.
    """
    return (games // (config.inner * config.switch)) % 2


def advance(learner: Learner, games: Game, config: YuConfig) -> tuple[Learner, Report]:
    """One game, and the fit that follows it. One after the last game changes nothing but the
    key.
    """
    draw_key, play_key, fit_key, key = jax.random.split(learner.key, 4)
    game = jax.tree.map(
        lambda leaf: leaf[jax.random.randint(draw_key, (), 0, leaf.shape[0])], games
    )
    me = learns(learner.games, config)
    positions, moves, cost = _played(play_key, learner, game, me, config)
    parameters, moments, losses = _fit(fit_key, learner, positions, me, config)
    finite = jnp.all(
        jnp.asarray([jnp.all(jnp.isfinite(leaf)) for leaf in jax.tree.leaves(parameters)])
    )
    after = Learner(parameters, moments, positions, key, learner.games + 1, learner.moves + moves)
    over = learner.games >= config.games
    kept = jax.tree.map(
        lambda old, new: jnp.where(over, old, new), learner._replace(key=0), after._replace(key=0)
    )
    return kept._replace(key=key), Report(cost, *losses, finite)


def _played(
    key: Array, learner: Learner, game: Game, me: Array, config: YuConfig
) -> tuple[Positions, Array, Array]:
    """One game: `me` searches and remembers, the other one plays what its network likes best. The
    positions, how many moves, and the cost.
    """
    network, alone = networks(config), many(game, 1)

    def goes_on(carry: tuple[Any, ...]) -> Array:
        return ~game.is_over(carry[0])

    def move(carry: tuple[Any, ...]) -> tuple[Any, ...]:
        state, positions, key, moves, cost = carry
        search_key, key = jax.random.split(key)

        def mine(state: State, positions: Positions) -> tuple[Array, Positions]:
            wide = jax.tree.map(lambda leaf: leaf[None], state)
            found = jax.tree.map(
                lambda leaf: leaf[0],
                yu_search(search_key, network, learner.parameters, alone, wide, config.search),
            )
            index = positions.written[me] % config.kept
            new = (game.observe(state), game.legal(state), found.policy, found.to_come)
            kept = jax.tree.map(
                lambda all_, one: all_.at[me, index].set(one), tuple(positions[:4]), new
            )
            return found.move, Positions(
                kept[0], kept[1], kept[2], kept[3], positions.written.at[me].add(1)
            )

        def theirs(state: State, positions: Positions) -> tuple[Array, Positions]:
            return greedy_action(network, learner.parameters, game, state).astype(
                jnp.int32
            ), positions

        chosen, positions = jax.lax.cond(game.to_play(state) == me, mine, theirs, state, positions)
        after, paid = game.step(state, chosen)
        return after, positions, key, moves + 1, cost + paid

    carry = (game.reset(), learner.positions, key, jnp.zeros((), jnp.int32), jnp.zeros(()))
    _, positions, _, moves, cost = jax.lax.while_loop(goes_on, move, carry)
    return positions, moves, cost


def _fit(
    key: Array, learner: Learner, positions: Positions, me: Array, config: YuConfig
) -> tuple[Parameters, Any, tuple[Array, Array]]:
    """Once over what the agent remembers, in shuffled minibatches; the last one may be smaller.
    Only `me`'s network changes.
    """
    own = jax.tree.map(lambda leaf: leaf[me], (learner.parameters, learner.optimiser, positions))
    there = jnp.minimum(own[2].written, config.kept)
    order = jnp.argsort(
        jax.random.uniform(key, (config.kept,)) + 2.0 * (jnp.arange(config.kept) >= there)
    )
    order = jnp.pad(order, (0, -config.kept % config.minibatch))
    rule = optax.scale_by_adam()
    norm = jnp.asarray(config.value_norm)[me]

    def minibatch(index: Array, carry: tuple[Any, ...]) -> tuple[Any, ...]:
        parameters, moments, sums = carry
        rows = jax.lax.dynamic_slice(order, (index * config.minibatch,), (config.minibatch,))
        counts = index * config.minibatch + jnp.arange(config.minibatch) < there
        gradient, losses = jax.grad(loss, has_aux=True)(
            parameters, jax.tree.map(lambda leaf: leaf[rows], own[2][:4]), counts, norm, config
        )
        change, moments = rule.update(gradient, moments)
        parameters = jax.tree.map(
            lambda old, by: old - config.learning_rate * by, parameters, change
        )
        return parameters, moments, jax.tree.map(jnp.add, sums, losses)

    number = (there + config.minibatch - 1) // config.minibatch
    parameters, moments, sums = jax.lax.fori_loop(
        0, number, minibatch, (*own[:2], (jnp.zeros(()), jnp.zeros(())))
    )
    put = lambda all_, one: all_.at[me].set(one)  # noqa: E731
    kept = jax.tree.map(put, (learner.parameters, learner.optimiser), (parameters, moments))
    return *kept, jax.tree.map(lambda total: total / jnp.maximum(number, 1), sums)


def loss(
    parameters: Parameters, batch: tuple[Array, ...], counts: Array, norm: Array, config: YuConfig
) -> tuple[Array, tuple[Array, Array]]:
    """Cross-entropy of the masked policy and squared error of the value in units of `norm` seconds;
    means over the rows that count `[B]`.
    """
    board, legal, policy, to_come = batch
    logits, value = jax.vmap(networks(config).outputs, (None, 0))(parameters, board)
    # as their library clips it before the logarithm
    probability = jnp.maximum(jax.nn.softmax(logits) * legal, 1e-7)
    weight = counts / jnp.maximum(jnp.sum(counts), 1)
    policy_loss = jnp.sum(
        weight
        * -jnp.sum(policy * jnp.log(probability / jnp.sum(probability, -1, keepdims=True)), -1)
    )
    value_loss = jnp.sum(weight * (value - to_come / norm) ** 2)
    return policy_loss + value_loss, (policy_loss, value_loss)
