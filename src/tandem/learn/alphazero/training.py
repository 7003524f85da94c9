"""Training by self-play: many whole games under search, then the network learns what the search
found and what came of it; and again.

Source: Silver et al. (2017), arXiv:1712.01815, with the search of Danihelka et al. (2022). `start`
and `advance` are pure functions: the same key gives the same network.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import optax

from tandem.learn.alphazero.config import Config
from tandem.learn.alphazero.network import Network, Parameters, Scorer
from tandem.learn.alphazero.selfplay import Experience, FinishedGames, selfplay, shown
from tandem.learn.env import Game
from tandem.learn.networks import masked_log_softmax

Array = Any


class Learner(NamedTuple):
    """A training under way: all that is needed to go on.

    experience: of the last rounds, `[kept, L x B, ...]`; the newest is at `rounds % kept`.
    best: of the cheapest game so far on each game that is played, `[P, L, ...]`; its policy names
    the moves that were made. best_cost: `[P]`. rounds, games, moves: `[]` int32, done so far.
    """

    parameters: Parameters
    optimiser: Any
    experience: Experience
    best: Experience
    best_cost: Array
    key: Array
    rounds: Array
    games: Array
    moves: Array


class Report(NamedTuple):
    """What a round tells. cost: `[]`, mean of the games, in the game's own cost. policy_loss,
    value_loss, entropy: `[]`. finite: `[]` bool.
    """

    cost: Array
    policy_loss: Array
    value_loss: Array
    entropy: Array
    finite: Array


def network_of(config: Config) -> Scorer:
    """The network that is trained."""
    return Scorer(config.units)


def start(key: Array, games: Game, config: Config) -> Learner:
    """A learner that knows nothing yet. `games` `[P]` is what it will play."""
    network_key, key = jax.random.split(key)
    one = jax.tree.map(lambda leaf: leaf[0], games)
    parameters = network_of(config).start(network_key, one)
    zero, pool = jnp.zeros((), jnp.int32), games.unit.shape[0]
    memory, best = (
        _empty(one, (config.kept, one.longest * config.games)),
        _empty(one, (pool, one.longest)),
    )
    return Learner(
        parameters,
        _optimiser(config).init(parameters),
        memory,
        best,
        jnp.full(pool, jnp.inf, jnp.float32),  # a weak type would be compiled for alone
        key,
        zero,
        zero,
        zero,
    )


def advance(learner: Learner, games: Game, config: Config) -> tuple[Learner, Report]:
    """One round: self-play on games drawn from `games` `[P]`, then learning."""
    draw_key, play_key, learn_key, key = jax.random.split(learner.key, 4)
    pool = games.unit.shape[0]
    chosen = jax.random.choice(draw_key, pool, (config.games,), replace=pool < config.games)
    drawn = jax.tree.map(lambda leaf: leaf[chosen], games)
    fresh, result = selfplay(
        play_key, network_of(config), learner.parameters, drawn, config.search, config.trust
    )
    slot = learner.rounds % config.kept
    experience = jax.tree.map(
        lambda all_, new: all_.at[slot].set(new), learner.experience, _flat(fresh)
    )
    learner = _remembered(learner._replace(experience=experience), fresh, result, chosen)
    parameters, moments, losses = _learn(learn_key, learner, config)
    finite = jnp.all(
        jnp.asarray([jnp.all(jnp.isfinite(leaf)) for leaf in jax.tree.leaves(parameters)])
    )
    after = learner._replace(
        parameters=parameters,
        optimiser=moments,
        key=key,
        rounds=learner.rounds + 1,
        games=learner.games + config.games,
        moves=learner.moves + jnp.sum(fresh.valid, dtype=jnp.int32),
    )
    return after, Report(jnp.mean(result.cost), *losses, finite)


def loss(
    network: Network, parameters: Parameters, batch: Experience, value_weight: float
) -> tuple[Array, tuple[Array, Array, Array]]:
    """Cross-entropy to what the search found, and the squared error of what is still to come; means
    over the valid rows.
    """
    seen = jax.vmap(network.read, (None, 0, 0, 0))(parameters, batch.seen, batch.least, batch.mover)
    log = masked_log_softmax(jnp, seen.logits, batch.legal)
    weight = batch.valid / jnp.maximum(jnp.sum(batch.valid), 1)
    policy = jnp.sum(weight * -jnp.sum(jnp.where(batch.legal, batch.policy * log, 0.0), -1))
    value = jnp.sum(weight * (seen.to_come - batch.to_come) ** 2)
    entropy = jnp.sum(weight * -jnp.sum(jnp.where(batch.legal, jnp.exp(log) * log, 0.0), -1))
    return policy + value_weight * value, (policy, value, entropy)


def _learn(
    key: Array, learner: Learner, config: Config
) -> tuple[Parameters, Any, tuple[Array, Array, Array]]:
    """Minibatches drawn evenly from the decisions that are kept."""
    network, rule = network_of(config), _optimiser(config)
    # the steps grow smaller towards the end, so that the weights settle
    rate = config.learning_rate * (1 - 0.9 * learner.rounds / config.iterations)
    # what was found once by luck stays in every minibatch, however bold the searches are
    imitated = round(config.imitated * config.minibatch)
    sources = [
        (_flat(learner.experience), config.minibatch - imitated),
        (_flat(learner.best), imitated),
    ]

    def minibatch(
        carry: tuple[Parameters, Any], key: Array
    ) -> tuple[tuple[Parameters, Any], tuple[Array, Array, Array]]:
        parameters, moments = carry
        parts = [
            _drawn(key, source, number)
            for key, (source, number) in zip(jax.random.split(key), sources, strict=True)
        ]
        batch = jax.tree.map(lambda *rows: jnp.concatenate(rows), *parts)
        gradient, losses = jax.grad(loss, 1, has_aux=True)(
            network, parameters, batch, config.value_weight
        )
        change, moments = rule.update(gradient, moments)
        return (jax.tree.map(lambda old, by: old - rate * by, parameters, change), moments), losses

    (parameters, moments), losses = jax.lax.scan(
        minibatch,
        (learner.parameters, learner.optimiser),
        jax.random.split(key, config.minibatches),
    )
    return parameters, moments, jax.tree.map(jnp.mean, losses)


def _drawn(key: Array, rows: Experience, number: int) -> Experience:
    """So many of the valid rows, evenly drawn."""
    counted = jnp.cumsum(rows.valid)
    drawn = jnp.searchsorted(counted, jax.random.randint(key, (number,), 1, counted[-1] + 1))
    return jax.tree.map(lambda leaf: leaf[drawn], rows)


def _remembered(
    learner: Learner, fresh: Experience, result: FinishedGames, chosen: Array
) -> Learner:
    """The learner with the cheapest games of the round, played on the games `chosen` `[B]`, where
    they are cheaper than those before.
    """
    cost = jnp.where(
        chosen[None] == jnp.arange(learner.best_cost.shape[0])[:, None], result.cost[None], jnp.inf
    )
    cheapest, cost = jnp.argmin(cost, 1), jnp.min(cost, 1)
    named = fresh._replace(policy=jax.nn.one_hot(result.moves, fresh.policy.shape[-1]))
    better = cost < learner.best_cost

    def newer(old: Array, new: Array) -> Array:
        won = jnp.swapaxes(new[:, cheapest], 0, 1)
        return jnp.where(better.reshape(-1, *[1] * (old.ndim - 1)), won, old)

    return learner._replace(
        best=jax.tree.map(newer, learner.best, named),
        best_cost=jnp.minimum(learner.best_cost, cost),
    )


def _optimiser(config: Config) -> optax.GradientTransformation:
    return optax.chain(optax.clip_by_global_norm(config.gradient_limit), optax.scale_by_adam())


def _flat(experience: Experience) -> Experience:
    return jax.tree.map(
        lambda leaf: leaf.reshape(leaf.shape[0] * leaf.shape[1], *leaf.shape[2:]), experience
    )


def _empty(game: Game, rows: tuple[int, int]) -> Experience:
    """Room for so much experience."""
    seen, legal, mover, least = jax.tree.map(
        lambda leaf: jnp.zeros((*rows, *leaf.shape), leaf.dtype),
        jax.eval_shape(lambda: shown(game, game.reset())),
    )
    return Experience(
        seen,
        legal,
        mover,
        least,
        jnp.zeros((*rows, game.moves)),
        jnp.zeros(rows),
        jnp.zeros(rows, bool),
    )
