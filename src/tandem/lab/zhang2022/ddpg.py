"""Dual-agent DDPG over discrete choices: two actors, one critic that values pairs, replay, target
networks, noise on the human's actor.

`act`, `store`, `drawn`, `targets`, `critic_loss`, `actor_loss`, `update` are pure functions;
`train` composes them. `jit` it whole, `vmap` it over keys.
Sources: Lillicrap et al. (2016), arXiv:1509.02971, for the algorithm; Zhang et al. (2022), RCIM 73,
102227, as far as it is public, for two actors, a shared critic, a choice by Q-value and noise in
the human's actor. How the pieces meet is in `pairs.py`.

For worlds of two agents in which the agent of row 1 names first (`World.narrow` then says what is
left for row 0), and which end whatever legal actions are taken: there is no limit on an episode's
length here. Both agents are paid for the same end: the critic learns the sum.

Axes: `N` environments, `R` rows of the replay, `B` transitions of a minibatch; `D` and `K` as in
`pairs.py`.
"""

from __future__ import annotations

import itertools
import math
from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import optax

from tandem.lab.zhang2022.ddpg_config import Config
from tandem.lab.zhang2022.pairs import (
    FIRST,
    SECOND,
    Networks,
    asked_with,
    candidates,
    choose,
    scores,
    value_of,
    values_of,
)
from tandem.learn.networks import ILLEGAL, Perceptron, init
from tandem.learn.world import State, World

Array = jax.Array


class Replay(NamedTuple):
    """The newest transitions, a ring; row `i` is one step of all environments and row `i + 1`
    (around the ring) the next.

    seen: `[R, N, 2, D]`. pairs: `[R, N, K, K]` bool. action: `[R, N, 2]` int32. reward: `[R, N]`,
    the sum over both agents. ended: `[R, N]` bool, the episode ended with this step.
    """

    seen: Array
    pairs: Array
    action: Array
    reward: Array
    ended: Array


class Learner(NamedTuple):
    """A training under way: all that is needed to go on.

    networks, targets: actors and critic, and what trails behind them.
    moments: of the optimiser, by network.
    state: the worlds being played, leading axis `N`. paid: `[N]`, their returns so far.
    spread: `[]`, of the noise on the human's scores; 0 for none. noise: `[N, K]`, that noise now.
    key: for what is still to be drawn.
    rounds: `[]` int32, steps of all environments done.
    """

    networks: Networks
    targets: Networks
    moments: dict[str, Any]
    replay: Replay
    state: State
    paid: Array
    spread: Array
    noise: Array
    key: Array
    rounds: Array


class Report(NamedTuple):
    """What a round tells. episodes: how many ended. returns: the sum of their returns. critic,
    actors: losses; 0 before the first update.
    """

    episodes: Array
    returns: Array
    critic: Array
    actors: Array


class Sample(NamedTuple):
    """What the critic learns from: `B` stretches of `ahead` steps; `later_*` is where a stretch
    ends.

    reward: `[B]`, discounted sum of the stretch. weight: `[B]`, discount of what follows it; 0 when
    the episode ended in it.
    """

    seen: Array
    pairs: Array
    action: Array
    reward: Array
    weight: Array
    later_seen: Array
    later_pairs: Array


def train(
    key: Array, world: World, config: Config, noise: Array | float | None = None
) -> tuple[Learner, Report]:
    """A whole training; the reports have a leading axis of `config.rounds`. Pure: the same key
    gives the same networks.

    `noise` `[]` stands for `config.noise` when given: as data, so that trainings with and without
    it run side by side.
    """
    return advance(start(key, world, config, noise), world, config, config.rounds)


def advance(learner: Learner, world: World, config: Config, rounds: int) -> tuple[Learner, Report]:
    """So many rounds more."""
    return jax.lax.scan(lambda learner, _: round_(learner, world, config), learner, None, rounds)


def start(key: Array, world: World, config: Config, noise: Array | float | None = None) -> Learner:
    """A learner that knows nothing yet; `noise` as in `train`."""
    weight_key, reset_key, key = jax.random.split(key, 3)
    seen, choices = world.observation_size, world.actions
    actor, critic = (seen, *config.hidden, choices), (2 * seen + 2 * choices, *config.hidden, 1)
    # one draw: each compiles for a second
    uniform = jax.random.uniform(weight_key, (2 * _weights(actor) + _weights(critic),), minval=-1.0)
    pair = uniform[: 2 * _weights(actor)].reshape(2, -1)
    networks = {
        "actors": jax.vmap(partial(_network, sizes=actor))(pair),
        "critic": _network(uniform[pair.size :], critic),
    }
    rows, n = config.replay // config.environments, config.environments
    replay = Replay(
        jnp.zeros((rows, n, 2, seen)),
        jnp.zeros((rows, n, choices, choices), bool),
        jnp.zeros((rows, n, 2), jnp.int32),
        jnp.zeros((rows, n)),
        jnp.zeros((rows, n), bool),
    )
    return Learner(
        networks,
        networks,
        {name: _optimiser(config).init(network) for name, network in networks.items()},
        replay,
        jax.vmap(world.reset)(jax.random.split(reset_key, n)),
        jnp.zeros(n),
        jnp.asarray(config.noise if noise is None else noise, jnp.float32),
        jnp.zeros((n, choices)),
        key,
        jnp.zeros((), jnp.int32),
    )


def legal_pairs(world: World, state: State) -> Array:
    """`[K, K]` bool, `[i, j]`: the agent of row 0 may do i while the agent of row 1, who names
    first, does j.
    """
    legal = world.legal(state)
    numbers = jnp.arange(world.actions, dtype=jnp.int32)
    answers = jax.vmap(
        lambda first: world.narrow(state, legal, jnp.stack([jnp.zeros((), jnp.int32), first]))[
            SECOND
        ]
    )(numbers)
    return answers.T & legal[FIRST][None, :]


# --- Playing ---


def round_(learner: Learner, world: World, config: Config) -> tuple[Learner, Report]:
    """One step of all environments, and the gradient steps that follow it."""
    draw_key, reset_key, key = jax.random.split(learner.key, 3)
    draws = _draws(draw_key, world, config)
    state = learner.state
    seen, pairs = jax.vmap(world.observe)(state), jax.vmap(partial(legal_pairs, world))(state)
    action, noise = act(draws, learner, seen, pairs, config)
    state, outcome = jax.vmap(world.step)(state, action)
    reward = jnp.sum(outcome.reward, -1)
    replay = store(
        learner.replay, learner.rounds, Replay(seen, pairs, action, reward, outcome.terminated)
    )
    ended, paid = outcome.terminated, learner.paid + reward
    again = jax.vmap(world.reset)(jax.random.split(reset_key, config.environments))
    state = jax.tree.map(
        lambda new, old: jnp.where(ended.reshape(-1, *[1] * (old.ndim - 1)), new, old), again, state
    )
    played = learner._replace(
        replay=replay,
        state=state,
        paid=jnp.where(ended, 0.0, paid),
        noise=noise,
        key=key,
        rounds=learner.rounds + 1,
    )
    learned = (played.rounds * config.environments >= config.warm_up) & (
        played.rounds > config.ahead
    )
    played, losses = jax.lax.cond(
        learned, lambda it: learn(draws, it, config), lambda it: (it, jnp.zeros(2)), played
    )
    return played, Report(
        jnp.sum(ended), jnp.sum(jnp.where(ended, paid, 0.0)), losses[0], losses[1]
    )


class Draws(NamedTuple):
    """All that a round leaves to chance, uniform in [0, 1): one draw, because each compiles for a
    second.

    pair: `[N, 2]`, whether a pair is random and which. noise: `[N, K]`, for the human's scores.
    place: `[updates, B, 2]`, row and environment of the transitions that are learned from. later:
    `[updates, B, K]`, for the human's scores in the critic's targets; `K` is 0 when they have no
    noise.
    """

    pair: Array
    noise: Array
    place: Array
    later: Array


def _draws(key: Array, world: World, config: Config) -> Draws:
    n, b, u = config.environments, config.minibatch, config.updates
    in_targets = world.actions * config.noise_in_targets
    shapes = ((n, 2), (n, world.actions), (u, b, 2), (u, b, in_targets))  # of the fields of Draws
    sizes = [math.prod(shape) for shape in shapes]
    parts = jnp.split(
        jax.random.uniform(key, (sum(sizes),)), list(itertools.accumulate(sizes[:-1]))
    )
    return Draws(*[part.reshape(shape) for part, shape in zip(parts, shapes, strict=True)])


def _normal(uniform: Array) -> Array:
    return jax.scipy.special.ndtri(jnp.clip(uniform, 1e-6, 1 - 1e-6))


def act(
    draws: Draws, learner: Learner, seen: Array, pairs: Array, config: Config
) -> tuple[Array, Array]:
    """Pairs `[N, 2]` for `seen` `[N, 2, D]` and `pairs` `[N, K, K]`, some of them at random; and
    the noise `[N, K]` on the human's scores now.
    """
    keep = config.noise_memory
    noise = keep * learner.noise + math.sqrt(1 - keep**2) * learner.spread * _normal(draws.noise)

    def chosen(seen: Array, pairs: Array, noise: Array) -> Array:
        return choose(
            jnp,
            learner.networks,
            seen,
            pairs,
            config.candidates,
            config.activation,
            noise,
            learner.spread > 0,
        )

    action = jax.vmap(chosen)(seen, pairs, noise)
    gone = learner.rounds / (config.rounds * max(config.explore_until, 1e-6))
    share = config.explore_from + (config.explore_to - config.explore_from) * jnp.minimum(gone, 1.0)
    share = jnp.where(learner.rounds * config.environments < config.warm_up, 1.0, share)
    return jnp.where(
        draws.pair[:, :1] < share, random_pairs(draws.pair[:, 1], pairs), action
    ), noise


def random_pairs(uniform: Array, pairs: Array) -> Array:
    """`[N, 2]` int32, a legal pair each, all equally likely; `uniform` `[N]` in [0, 1) decides."""
    flat = pairs.reshape(pairs.shape[0], -1)
    reached = jnp.cumsum(flat, -1)
    index = jnp.sum(reached <= (uniform * reached[:, -1])[:, None], -1)
    return jnp.stack([index // pairs.shape[-1], index % pairs.shape[-1]], -1).astype(jnp.int32)


def store(replay: Replay, rounds: Array, row: Replay) -> Replay:
    """The replay with one row more in the place of its oldest."""
    index = rounds % replay.reward.shape[0]
    return jax.tree.map(lambda ring, new: ring.at[index].set(new.astype(ring.dtype)), replay, row)


# --- Learning ---


def learn(draws: Draws, learner: Learner, config: Config) -> tuple[Learner, Array]:
    """The gradient steps of a round; and the last one's losses `[2]`, critic's and actors'."""
    losses = jnp.zeros(2)
    for place in range(config.updates):
        learner, losses = update(draws.place[place], draws.later[place], learner, config)
    return learner, losses


def update(place: Array, later: Array, learner: Learner, config: Config) -> tuple[Learner, Array]:
    """One gradient step of critic and actors, and the targets one step behind them; `place` `[B,
    2]` and `later` `[B, K]` as in `Draws`.
    """
    sample = drawn(place, learner.replay, learner.rounds, config)
    wanted = targets(later, learner, sample, config)
    rate = 1 + (config.last_rate - 1) * jnp.minimum(learner.rounds / config.rounds, 1.0)
    critic_part, critic_change = jax.value_and_grad(critic_loss)(
        learner.networks["critic"], sample, wanted, config
    )
    critic, critic_moments = _descend(
        learner, "critic", critic_change, rate * config.critic_rate, config
    )
    actor_part, actor_change = jax.value_and_grad(actor_loss)(
        learner.networks["actors"], critic, sample, config
    )
    actors, actor_moments = _descend(
        learner, "actors", actor_change, rate * config.actor_rate, config
    )
    networks = {"actors": actors, "critic": critic}
    trailing = jax.tree.map(
        lambda old, new: old + config.target_rate * (new - old), learner.targets, networks
    )
    moments = {"actors": actor_moments, "critic": critic_moments}
    return learner._replace(networks=networks, targets=trailing, moments=moments), jnp.stack(
        [critic_part, actor_part]
    )


def drawn(place: Array, replay: Replay, rounds: Array, config: Config) -> Sample:
    """`B` stretches of `ahead` steps from the replay; `rounds` rows were ever stored, more than
    `ahead`. `place` `[B, 2]` in [0, 1) says which.

    Rewards count up to the episode's end, and what follows an end is not looked at.
    """
    rows, number = replay.reward.shape
    oldest = jnp.maximum(rounds - rows, 0)
    begin = oldest + jnp.floor(place[:, 0] * (rounds - config.ahead - oldest)).astype(jnp.int32)
    which = jnp.floor(place[:, 1] * number).astype(jnp.int32)
    reward, weight = jnp.zeros(config.minibatch), jnp.ones(config.minibatch)
    for step in range(config.ahead):
        row = (begin + step) % rows
        reward = reward + weight * replay.reward[row, which]
        weight = weight * config.discount * ~replay.ended[row, which]
    first, last = begin % rows, (begin + config.ahead) % rows
    return Sample(
        replay.seen[first, which],
        replay.pairs[first, which],
        replay.action[first, which],
        reward,
        weight,
        replay.seen[last, which],
        replay.pairs[last, which],
    )


def targets(later: Array, learner: Learner, sample: Sample, config: Config) -> Array:
    """`[B]`, what the critic should say: the stretch's rewards, and the target critic's value of
    the pair chosen where it ends.

    `later` `[B, K]` in [0, 1): for the noise on the human's choice there, if there is any.
    """
    choosing = learner.networks if config.double else learner.targets
    noise = _normal(later) * learner.spread if config.noise_in_targets else None

    def following(seen: Array, pairs: Array, noise: Array | None) -> Array:
        asked = asked_with(
            jnp,
            scores(jnp, choosing["actors"], seen, config.activation),
            pairs,
            config.candidates,
            noise,
            learner.spread > 0,
        )
        value = values_of(jnp, learner.targets["critic"], seen, asked, config.activation)
        if not config.double:
            return jnp.max(jnp.where(asked.legal, value, ILLEGAL))
        judged = jnp.where(
            asked.legal,
            values_of(jnp, learner.networks["critic"], seen, asked, config.activation),
            ILLEGAL,
        )
        return value.reshape(-1)[jnp.argmax(judged.reshape(-1))]

    # Where an episode ended the pairs of the next one stand here; their weight is 0.
    return sample.reward + sample.weight * jax.vmap(following)(
        sample.later_seen, sample.later_pairs, noise
    )


def critic_loss(critic: Any, sample: Sample, wanted: Array, config: Config) -> Array:
    """Mean squared error of the values of the pairs that were taken against `wanted` `[B]`."""
    taken = jax.nn.one_hot(sample.action, sample.pairs.shape[-1])
    value = jax.vmap(
        lambda seen, pair: value_of(jnp, critic, seen, pair[SECOND], pair[FIRST], config.activation)
    )(sample.seen, taken)
    return jnp.mean((value - wanted) ** 2)


def actor_loss(actors: Any, critic: Any, sample: Sample, config: Config) -> Array:
    """Minus what the critic thinks of the actors' choices in the sampled states; see
    `Config.actors_learn`.
    """
    loss = _relaxed_loss if config.actors_learn == "relaxed" else _expected_loss
    return jnp.mean(
        jax.vmap(lambda seen, pairs: loss(actors, critic, seen, pairs, config))(
            sample.seen, sample.pairs
        )
    )


def _relaxed_loss(actors: Any, critic: Any, seen: Array, pairs: Array, config: Config) -> Array:
    """DDPG's: the critic's value of the two actors' probabilities, as if those were an action."""
    score = scores(jnp, actors, seen, config.activation)
    legal = jnp.stack([jnp.any(pairs, 1), jnp.any(pairs, 0)])
    probability = jax.nn.softmax(jnp.where(legal, score / config.temperature, ILLEGAL))
    return -value_of(jnp, critic, seen, probability[SECOND], probability[FIRST], config.activation)


def _expected_loss(actors: Any, critic: Any, seen: Array, pairs: Array, config: Config) -> Array:
    """Each actor's expected value over its candidates: the human's with the best answer to each,
    the robot's with the human's best choice.
    """
    score = scores(jnp, actors, seen, config.activation)
    asked = candidates(jnp, jax.lax.stop_gradient(score), pairs, config.candidates)
    value = jax.lax.stop_gradient(values_of(jnp, critic, seen, asked, config.activation))
    answer = jnp.max(jnp.where(asked.legal, value, ILLEGAL), 1)
    best = jnp.argmax(answer)
    first = _expected(score[FIRST], asked.first, answer, asked.legal[:, 0], config)
    second = _expected(score[SECOND], asked.second[best], value[best], asked.legal[best], config)
    return -first - second


def _expected(score: Array, choice: Array, value: Array, legal: Array, config: Config) -> Array:
    """Mean of `value` `[C]` under the softmax of the scores of these choices `[C, K]`, and the
    entropy by its weight.
    """
    log = jax.nn.log_softmax(jnp.where(legal, choice @ score / config.temperature, ILLEGAL))
    probability = jnp.where(legal, jnp.exp(log), 0.0)
    return jnp.sum(
        probability * (jnp.where(legal, value, 0.0) - config.entropy * jnp.where(legal, log, 0.0))
    )


def _optimiser(config: Config) -> optax.GradientTransformation:
    limit = (
        [] if config.gradient_limit is None else [optax.clip_by_global_norm(config.gradient_limit)]
    )
    return optax.chain(*limit, optax.scale_by_adam())


def _descend(
    learner: Learner, name: str, change: Any, rate: Array, config: Config
) -> tuple[Any, Any]:
    step, moments = _optimiser(config).update(change, learner.moments[name])
    return jax.tree.map(lambda old, by: old - rate * by, learner.networks[name], step), moments


def _weights(sizes: tuple[int, ...]) -> int:
    return sum(a * b for a, b in itertools.pairwise(sizes))


def _network(uniform: Array, sizes: tuple[int, ...]) -> Perceptron:
    """A network from `_weights(sizes)` numbers in [-1, 1); its last layer begins small, so that
    nothing is preferred.
    """
    taken = 0

    def draw(shape: tuple[int, ...]) -> Array:
        nonlocal taken
        taken += math.prod(shape)
        return uniform[taken - math.prod(shape) : taken].reshape(shape)

    return init(draw, sizes, 0.1)
