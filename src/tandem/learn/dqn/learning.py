"""Deep Q-learning by agents that take turns and share one cost: any game, any number of agents,
many games side by side.

Sources: Mnih et al. (2015), Nature 518, 529-533; van Hasselt et al. (2016) for the double estimate.
As Yu, Huang and Chang (2021), J. Manuf. Syst. 60, 487-499, use it for shared assembly: a DQN for
each agent on one Markov game. Costs are minimised.

`start` and `advance` are pure functions; the same key gives the same networks. Axes: `B` games, `A`
agents, `R` rounds that are remembered, `E` rows that a round writes.
"""

from __future__ import annotations

from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import optax

from tandem.learn.dqn.config import Config
from tandem.learn.dqn.network import ValueNetworks
from tandem.learn.env import Game, State, many

Array = Any


class Turns(NamedTuple):
    """Decisions and where they led; any leading axes.

    state: in which `agent` did `move`. cost: `[]`, units, until `after`: the state in which the
    value goes on (or the game is over). valid: `[]` bool, False for a row that holds nothing.
    """

    state: State
    agent: Array
    move: Array
    cost: Array
    after: State
    valid: Array


class Open(NamedTuple):
    """The last decision of each agent in each game, `[B, A, ...]`, while it is not known where it
    leads. waiting: `[B, A]` bool, there is one.
    """

    state: State
    move: Array
    cost: Array
    waiting: Array


class Learner(NamedTuple):
    """A training under way.

    parameters, target, optimiser: of the networks. memory: `[R, E]`. states: of the games, `[B]`.
    open: see `Open`. paid: `[B]` units since each game began. finished: `[2]`, how many games have
    ended since the last report and what they cost, units. rounds, games, moves, updates: `[]`
    int32, done so far.
    """

    parameters: Any
    target: Any
    optimiser: Any
    memory: Turns
    states: State
    open: Open
    paid: Array
    finished: Array
    key: Array
    rounds: Array
    games: Array
    moves: Array
    updates: Array


class Report(NamedTuple):
    """What an interval tells. cost: `[]`, mean of the games that ended in it, in the game's own
    cost; 0 when none did. loss: `[]`. explore: `[]`, the probability of a random move at its end.
    finite: `[]` bool.
    """

    cost: Array
    loss: Array
    explore: Array
    finite: Array


def networks(game: Game, config: Config) -> ValueNetworks:
    """What is learned."""
    return ValueNetworks(len(game.agents) if config.agents == "each" else 1, config.units)


def rounds_of(config: Config) -> int:
    """Rounds of a training: every game makes a move in each."""
    return max(1, config.decisions // config.games)


def start(key: Array, game: Game, config: Config) -> Learner:
    """A learner that knows nothing yet."""
    network_key, key = jax.random.split(key)
    parameters = networks(game, config).start(network_key)
    games, agents = config.games, len(game.agents)
    states = jax.vmap(lambda one: one.reset())(many(game, games))
    wide = jax.tree.map(
        lambda leaf: jnp.broadcast_to(leaf[:, None], (games, agents, *leaf.shape[1:])), states
    )
    empty = Open(
        wide,
        jnp.zeros((games, agents), jnp.int32),
        jnp.zeros((games, agents)),
        jnp.zeros((games, agents), bool),
    )
    zero = jnp.zeros((), jnp.int32)
    # its form is known only below
    moments, memory = (
        _optimiser(config).init(parameters),
        Turns(states, zero, zero, zero, states, zero),
    )
    learner = Learner(
        parameters,
        parameters,
        moments,
        memory,
        states,
        empty,
        jnp.zeros(games),
        jnp.zeros(2),
        key,
        zero,
        zero,
        zero,
        zero,
    )
    shape = jax.eval_shape(partial(_moved, game=game, config=config), key, learner)[1]
    memory = jax.tree.map(
        lambda leaf: jnp.zeros((config.kept // games, *leaf.shape), leaf.dtype), shape
    )
    return learner._replace(memory=memory)


def advance(learner: Learner, game: Game, config: Config, rounds: int) -> tuple[Learner, Report]:
    """So many rounds more. Rounds beyond the budget are played like the others: the caller
    counts.
    """

    def one(learner: Learner, _: None) -> tuple[Learner, Array]:
        move_key, learn_key, key = jax.random.split(learner.key, 3)
        moved, rows = _moved(move_key, learner, game, config)
        index = learner.rounds % learner.memory.valid.shape[0]
        memory = jax.tree.map(lambda all_, new: all_.at[index].set(new), learner.memory, rows)
        learner = moved._replace(memory=memory, key=key, rounds=learner.rounds + 1)
        due = (learner.rounds > config.warm_up) & (learner.rounds % config.learn_every == 0)
        return jax.lax.cond(
            due,
            lambda it: _learned(learn_key, it, game, config),
            lambda it: (it, jnp.zeros(())),
            learner,
        )

    learner, losses = jax.lax.scan(one, learner._replace(finished=jnp.zeros(2)), None, rounds)
    finite = jnp.all(
        jnp.asarray([jnp.all(jnp.isfinite(leaf)) for leaf in jax.tree.leaves(learner.parameters)])
    )
    ended, cost = learner.finished
    return learner, Report(
        cost / jnp.maximum(ended, 1) * game.unit,
        jnp.sum(losses) / max(rounds // config.learn_every, 1),
        _explore(learner, config),
        finite,
    )


def values(network: ValueNetworks, parameters: Any, game: Game, state: State) -> Array:
    """`[K]`, what each move costs in the eyes of the agent whose turn it is; infinity for what is
    not legal, 0 once the game is over.
    """
    seen = network.read(
        parameters, game.observe(state), game.least(state) / game.unit, game.to_play(state)
    )
    return jnp.where(game.is_over(state), 0.0, jnp.where(game.legal(state), -seen.logits, jnp.inf))


def loss(
    parameters: Any, target: Any, batch: Turns, counts: Array, game: Game, config: Config
) -> Array:
    """Huber loss of Q(state, move) against cost + discount x the least Q of the target network in
    `after`; mean over the rows that count `[N]`.
    """
    network = networks(game, config)
    now = jax.vmap(partial(values, network, parameters, game))(batch.state)
    then = jax.vmap(partial(values, network, target, game))(batch.after)
    if config.double:
        chosen = jnp.argmin(jax.vmap(partial(values, network, parameters, game))(batch.after), -1)
        best = jnp.take_along_axis(then, chosen[:, None], -1)[:, 0]
    else:
        best = jnp.min(then, -1)
    aim = jax.lax.stop_gradient(batch.cost + config.discount * best)
    predicted = jnp.take_along_axis(now, batch.move[:, None], -1)[:, 0]
    off = jnp.where(counts, predicted - aim, 0.0)
    return jnp.sum(optax.huber_loss(off)) / jnp.maximum(jnp.sum(counts), 1)


def _moved(key: Array, learner: Learner, game: Game, config: Config) -> tuple[Learner, Turns]:
    """A move in every game; finished games begin anew. The rows are what has become known by it."""
    network, states = networks(game, config), learner.states
    explore_key, pick_key = jax.random.split(key)
    me = jax.vmap(game.to_play)(states)
    q_values = jax.vmap(partial(values, network, learner.parameters, game))(states)
    # the values are infinite where a move is not legal, so they tell what may be drawn, too
    drawn = jnp.argmax(
        jnp.where(jnp.isfinite(q_values), jax.random.uniform(pick_key, q_values.shape), -1.0), -1
    )
    astray = jax.random.uniform(explore_key, me.shape) < _explore(learner, config)
    move = jnp.where(astray, drawn, jnp.argmin(q_values, -1)).astype(jnp.int32)
    after, cost = jax.vmap(game.step)(states, move)
    # in units, as the networks know it, so that one learning rate suits any cell
    cost, over = cost / game.unit, jax.vmap(game.is_over)(after)
    rows, opened = _rows(learner.open, states, me, move, cost, after, over, config)
    # games end at different moves, so each is replaced alone and all go on side by side
    fresh = jax.vmap(lambda one: one.reset())(many(game, config.games))
    going = jax.tree.map(
        lambda new, old: jnp.where(over.reshape(-1, *[1] * (old.ndim - 1)), new, old), fresh, after
    )
    paid = learner.paid + cost
    moved = learner._replace(
        states=going,
        open=opened,
        paid=jnp.where(over, 0.0, paid),
        finished=learner.finished + jnp.stack([jnp.sum(over), jnp.sum(jnp.where(over, paid, 0.0))]),
        games=learner.games + jnp.sum(over, dtype=jnp.int32),
        moves=learner.moves + config.games,
    )
    return moved, rows


def _rows(
    opened: Open,
    states: State,
    me: Array,
    move: Array,
    cost: Array,
    after: State,
    over: Array,
    config: Config,
) -> tuple[Turns, Open]:
    """`[E]` rows, and what stays open. With the "next" turn a row is known at once; with the "own"
    one when it comes, or when the game is over.
    """
    if config.horizon == "next":
        return Turns(states, me, move, cost, after, jnp.ones(me.shape, bool)), opened
    # the agent is on turn again: where its last decision led is known only now
    games, agents = opened.waiting.shape
    of_mover = lambda leaf: leaf[jnp.arange(games), me]  # noqa: E731
    back = Turns(
        jax.tree.map(of_mover, opened.state),
        me,
        of_mover(opened.move),
        of_mover(opened.cost),
        states,
        of_mover(opened.waiting),
    )
    # its new decision takes the old one's place; what anybody's move costs is paid by all who wait
    mine = jnp.arange(agents)[None] == me[:, None]

    def put(all_: Array, one: Array) -> Array:
        return jnp.where(mine.reshape(*mine.shape, *[1] * (all_.ndim - 2)), one[:, None], all_)

    opened = Open(
        jax.tree.map(put, opened.state, states),
        put(opened.move, move),
        jnp.where(mine, 0.0, opened.cost) + cost[:, None],
        opened.waiting | mine,
    )
    # at the end of a game nobody gets another turn, so all decisions that are open close here
    wide = lambda leaf: jnp.broadcast_to(leaf[:, None], (games, agents, *leaf.shape[1:]))  # noqa: E731
    agent = jnp.broadcast_to(jnp.arange(agents, dtype=me.dtype)[None], (games, agents))
    ends = Turns(
        opened.state,
        agent,
        opened.move,
        opened.cost,
        jax.tree.map(wide, after),
        opened.waiting & over[:, None],
    )
    flat = jax.tree.map(
        lambda leaf: leaf.reshape(leaf.shape[0] * leaf.shape[1], *leaf.shape[2:]), ends
    )
    rows = jax.tree.map(lambda first, second: jnp.concatenate([first, second]), back, flat)
    return rows, opened._replace(waiting=opened.waiting & ~over[:, None])


def _learned(key: Array, learner: Learner, game: Game, config: Config) -> tuple[Learner, Array]:
    """One step of every network on decisions of its own agent (all decisions, for the one that
    decides for all).
    """
    flat = jax.tree.map(
        lambda leaf: leaf.reshape(leaf.shape[0] * leaf.shape[1], *leaf.shape[2:]), learner.memory
    )
    number = networks(game, config).agents
    rate = config.learning_rate * (1 - 0.9 * jnp.minimum(learner.rounds / rounds_of(config), 1.0))

    # rows of other agents and empty ones are never drawn: the cumulated count has no step there
    def drawn(key: Array, agent: Array) -> tuple[Turns, Array]:
        fits = flat.valid & ((flat.agent == agent) | (number == 1))
        counted = jnp.cumsum(fits)
        rows = jnp.searchsorted(
            counted,
            jax.random.randint(key, (config.minibatch,), 1, jnp.maximum(counted[-1], 1) + 1),
        )
        return jax.tree.map(lambda leaf: leaf[rows], flat), jnp.broadcast_to(
            counted[-1] > 0, rows.shape
        )

    # one gradient for all networks together: each row asks the network of its own agent only
    batches, counts = jax.vmap(drawn)(jax.random.split(key, number), jnp.arange(number))
    together = jax.tree.map(
        lambda leaf: leaf.reshape(leaf.shape[0] * leaf.shape[1], *leaf.shape[2:]), batches
    )
    off, gradient = jax.value_and_grad(loss)(
        learner.parameters, learner.target, together, counts.reshape(-1), game, config
    )
    change, moments = _optimiser(config).update(gradient, learner.optimiser)
    parameters = jax.tree.map(lambda old, by: old - rate * by, learner.parameters, change)
    updates = learner.updates + 1
    # the aim stands still between two copies, or each step would chase its own change
    target = jax.tree.map(
        lambda new, old: jnp.where(updates % config.target_every == 0, new, old),
        parameters,
        learner.target,
    )
    return learner._replace(
        parameters=parameters, target=target, optimiser=moments, updates=updates
    ), off


def _explore(learner: Learner, config: Config) -> Array:
    """The probability of a random move now."""
    share = learner.rounds / max(rounds_of(config) * config.explore_share, 1)
    return config.explore_to + (config.explore_from - config.explore_to) * jnp.maximum(
        1 - share, 0.0
    )


def _optimiser(config: Config) -> optax.GradientTransformation:
    return optax.chain(optax.clip_by_global_norm(config.gradient_limit), optax.scale_by_adam())
