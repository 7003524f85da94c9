"""Independent PPO: every agent has an actor and a critic of its own, sees its own observation and
is paid its own reward.

`rollout`, `advantages`, `loss`, `update` are pure functions; `train` composes them. `jit` it whole,
`vmap` it over keys.
Source: Schulman et al. (2017), arXiv:1707.06347; de Witt et al. (2020), arXiv:2011.09533, for the
independent learners.

Axes: `A` agents, `N` environments, `H` steps of a rollout, `B` = H x N, `D` observed numbers, `K`
actions.
"""

from __future__ import annotations

import itertools
from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import optax

from tandem.learn.networks import Perceptron, forward, init, masked_log_softmax, sample
from tandem.learn.ppo.config import Config
from tandem.learn.world import StageValues, State, World

Array = jax.Array
Parameters = dict[str, Perceptron]
"""`actor` and `critic`; every array has a leading axis `A`, unless the network is shared."""


class Environments(NamedTuple):
    """Worlds under way, side by side.

    state: the worlds' states, leading axis `N`.
    age: `[N]` int32, steps since the reset.
    paid: `[N, A]` float32, rewards since the reset.
    broken: `[N, A]` int32, rules broken since the reset.
    """

    state: State
    age: Array
    paid: Array
    broken: Array


class Learner(NamedTuple):
    """A training under way: all that is needed to go on.

    parameters, optimiser: of the agents.
    mean, spread: `[A]`, the unit that the critics work in: value = mean + spread x output.
    environments: the worlds that are being played.
    key: for what is still to be drawn.
    stage: `[]` int32, index of the current stage; `len(config.stages)` when the training is over.
    stage_episodes, stage_steps: `[]` int32, done in this stage.
    episodes, steps, updates: `[]` int32, done in all.
    """

    parameters: Parameters
    optimiser: Any
    mean: Array
    spread: Array
    environments: Environments
    key: Array
    stage: Array
    stage_episodes: Array
    stage_steps: Array
    episodes: Array
    steps: Array
    updates: Array


class Batch(NamedTuple):
    """What a rollout saw; leading axes `[H, N]`, once flattened `[A, B]`.

    `bootstrap` is the critic's value of the state in which an episode was cut off, 0 elsewhere.
    `valid` is False for steps after the rollout's early end.
    """

    observation: Array
    legal: Array
    action: Array
    log_probability: Array
    reward: Array
    terminated: Array
    truncated: Array
    bootstrap: Array
    valid: Array


class Report(NamedTuple):
    """What an update tells. Numbers about episodes are means over those that ended in its rollout,
    0 when none did.

    episodes: `[]`, how many ended. returns: `[A]`. illegal: `[A]`, rules broken in an episode.
    length: `[]`, steps of an episode. first_value: `[A]`, the critic's value of the first state.
    entropy, policy_loss, value_loss, clipped: `[A]`, means over the minibatches. stage, steps:
    `[]`, after the update. finite: `[]` bool, every parameter still is.
    """

    episodes: Array
    returns: Array
    illegal: Array
    length: Array
    first_value: Array
    entropy: Array
    policy_loss: Array
    value_loss: Array
    clipped: Array
    stage: Array
    steps: Array
    finite: Array


def train(key: Array, world: World, config: Config, updates: int) -> tuple[Learner, Report]:
    """So many updates from scratch; the reports have a leading axis of that length. Pure: the same
    key gives the same policy.
    """
    return advance(start(key, world, config), world, config, updates)


def advance(learner: Learner, world: World, config: Config, updates: int) -> tuple[Learner, Report]:
    """So many updates more. One after the last stage's end changes nothing."""

    def one(learner: Learner, _: None) -> tuple[Learner, Report]:
        if config.stop_at_end:
            return jax.lax.cond(
                learner.stage < len(config.stages),
                lambda it: update(it, world, config),
                lambda it: (it, _empty_report(it)),
                learner,
            )
        return update(learner, world, config)

    return jax.lax.scan(one, learner, None, updates)


def start(key: Array, world: World, config: Config) -> Learner:
    """A learner that knows nothing yet."""
    agents = len(world.agents)
    actor_key, critic_key, reset_key, key = jax.random.split(key, 4)
    parameters = {
        "actor": _networks(
            actor_key, world, config, world.actions, config.share_actor, last=config.small_start
        ),
        "critic": _networks(critic_key, world, config, 1, config.share_critic, last=1.0),
    }
    zero = jnp.zeros((), jnp.int32)
    return Learner(
        parameters,
        {
            name: _each(optimiser(config).init, network, shared(config, name))
            for name, network in parameters.items()
        },
        jnp.zeros(agents),
        jnp.ones(agents),
        _reset(reset_key, world, config.environments),
        key,
        *[zero] * 6,
    )


def optimiser(config: Config) -> optax.GradientTransformation:
    """Adam, behind a limit on the gradient's norm when there is one, and behind what keeps the
    weights small. The learning rate is the stage's and applied outside.
    """
    limit = (
        [] if config.gradient_limit is None else [optax.clip_by_global_norm(config.gradient_limit)]
    )
    small = [optax.add_decayed_weights(config.l2, _weights)] if config.l2 else []
    return optax.chain(*small, *limit, optax.scale_by_adam(eps=config.adam_epsilon))


def _weights(network: Perceptron) -> Any:
    """True for a weight, False for a bias."""
    return jax.tree_util.tree_map_with_path(lambda way, _: way[-1].key == "weight", network)


def shared(config: Config, name: str) -> bool:
    """Whether all agents use one `actor` or `critic`."""
    return config.share_actor if name == "actor" else config.share_critic


def update(learner: Learner, world: World, config: Config) -> tuple[Learner, Report]:
    """One rollout, and what the agents learn from it."""
    stage = stage_values(config, learner.stage)
    world = world.in_stage(stage)
    # what is played stems from the policy that learns from it, so it is of no use after this update
    play_key, learn_key, key = jax.random.split(learner.key, 3)
    environments, batch, ended = rollout(play_key, learner, world, config)
    # the critics work in a unit of their own, so that one learning rate suits any cell's rewards
    batch, advantage, target, mean, spread = _compute_advantages(
        learner, environments, batch, stage, world, config
    )
    parameters, moments, losses = _learn(
        learn_key,
        learner,
        batch,
        advantage,
        (target - mean[:, None]) / spread[:, None],
        stage,
        config,
    )
    # the budget counts what really happened: an early end leaves rows that are no steps
    steps = jnp.sum(batch.valid[0]).astype(jnp.int32)
    episodes = ended.episodes.astype(jnp.int32)
    stage_episodes, stage_steps = learner.stage_episodes + episodes, learner.stage_steps + steps
    returns = ended.returns / jnp.maximum(ended.episodes, 1)
    enough = (ended.episodes > 0) & jnp.all(returns >= stage.stop_return)
    over = (stage_episodes >= stage.episodes) | (stage_steps >= stage.steps) | enough
    # whoever has used up a stage's episodes or steps goes on to the next, its counts at 0
    after = learner._replace(
        parameters=parameters,
        optimiser=moments,
        mean=mean,
        spread=spread,
        environments=environments,
        key=key,
        stage=learner.stage + over,
        stage_episodes=jnp.where(over, 0, stage_episodes),
        stage_steps=jnp.where(over, 0, stage_steps),
        episodes=learner.episodes + episodes,
        steps=learner.steps + steps,
        updates=learner.updates + 1,
    )
    return after, _report(after, learner.stage, ended, losses, world, config)


def stage_values(config: Config, stage: Array) -> StageValues:
    """The numbers of the stage at that index; of the last one when the training is over."""
    table = jax.tree.map(
        lambda *values: jnp.asarray(values), *[stage.values() for stage in config.stages]
    )
    return jax.tree.map(lambda values: values[jnp.minimum(stage, len(config.stages) - 1)], table)


# --- Playing ---


class Ended(NamedTuple):
    """Sums over the episodes that ended in a rollout: how many, returns and rules broken `[A]`,
    steps.
    """

    episodes: Array
    returns: Array
    illegal: Array
    length: Array


def rollout(
    key: Array, learner: Learner, world: World, config: Config
) -> tuple[Environments, Batch, Ended]:
    """`H` steps of `N` environments under the current actors; a finished episode is followed by the
    next one.

    With `stop_at_end` the rollout ends with the episode; the rest of the batch is then not `valid`.
    All random numbers of the rollout are drawn at once: one a decision.
    """
    agents = len(world.agents)
    draw_key, reset_key = jax.random.split(key)
    uniform = jax.random.uniform(draw_key, (config.horizon, config.environments, agents))
    reset_keys = jax.random.split(reset_key, config.horizon)
    none = Ended(jnp.zeros(()), jnp.zeros(agents), jnp.zeros(agents), jnp.zeros(()))

    def one(
        carry: tuple[Environments, Ended], drawn: tuple[Array, Array]
    ) -> tuple[tuple[Environments, Ended], Batch]:
        environments, batch, ended = _step(*drawn, carry[0], learner, world, config)
        return (environments, jax.tree.map(jnp.add, carry[1], ended)), batch

    # of a fixed length: `scan` stacks the rows by itself
    if not config.stop_at_end:
        (environments, ended), batch = jax.lax.scan(
            one, (learner.environments, none), (uniform, reset_keys)
        )
        return environments, batch, ended

    # an end that is not known beforehand needs a `while_loop`, which writes into rows made before
    def keep(
        carry: tuple[Array, tuple[Environments, Ended], Batch],
    ) -> tuple[Array, tuple[Environments, Ended], Batch]:
        index, progress, rows = carry
        progress, seen = one(progress, (uniform[index], reset_keys[index]))
        return (
            index + 1,
            progress,
            jax.tree.map(lambda all_, new: all_.at[index].set(new), rows, seen),
        )

    first = jax.eval_shape(one, (learner.environments, none), (uniform[0], reset_keys[0]))[1]
    empty = jax.tree.map(lambda leaf: jnp.zeros((config.horizon, *leaf.shape), leaf.dtype), first)
    goes_on = lambda carry: (carry[0] < config.horizon) & (carry[1][1].episodes == 0)  # noqa: E731
    _, (environments, ended), batch = jax.lax.while_loop(
        goes_on, keep, (jnp.zeros((), jnp.int32), (learner.environments, none), empty)
    )
    return environments, batch, ended


def act(
    parameters: Parameters,
    observation: Array,
    legal: Array,
    uniform: Array | None,
    state: State,
    world: World,
    config: Config,
) -> tuple[Array, Array, Array]:
    """Actions `[N, A]` drawn from the actors, their log-probabilities, and the masks they were
    drawn under.

    `uniform` `[N, A]` in [0, 1) decides the draw; None takes the most probable action instead.
    """
    logits = jnp.moveaxis(
        _forward(parameters, "actor", jnp.moveaxis(observation, 1, 0), config), 0, 1
    )
    if not config.masked:
        legal = jnp.ones_like(legal)
    choose = (
        (lambda log: jnp.argmax(log, -1))
        if uniform is None
        else (lambda log: sample(jnp, log, uniform))
    )
    log_probability = masked_log_softmax(jnp, logits, legal)
    action = choose(log_probability)
    if config.masked:
        legal = jax.vmap(world.narrow)(state, legal, action)
        log_probability = masked_log_softmax(jnp, logits, legal)
        action = choose(log_probability)
    chosen = jnp.take_along_axis(log_probability, action[..., None], -1)[..., 0]
    return action.astype(jnp.int32), chosen, legal


def _step(
    uniform: Array,
    reset_key: Array,
    environments: Environments,
    learner: Learner,
    world: World,
    config: Config,
) -> tuple[Environments, Batch, Ended]:
    state = environments.state
    observation = jax.vmap(world.observe)(state)
    action, log_probability, legal = act(
        learner.parameters, observation, jax.vmap(world.legal)(state), uniform, state, world, config
    )
    state, outcome = jax.vmap(world.step)(state, action)
    # counted per episode, because reports are about episodes and not about steps
    age, paid, broken = (
        environments.age + 1,
        environments.paid + outcome.reward,
        environments.broken + outcome.illegal,
    )
    limit = (
        age >= config.episode_limit if config.episode_limit else jnp.zeros_like(outcome.terminated)
    )
    # an end that the world has itself goes before the limit's: nothing would come after it
    truncated = limit & ~outcome.terminated
    over = truncated | outcome.terminated
    # an episode that was only cut off would have gone on, so its last state's value stands for the
    # rest; the critics are asked only when there is one
    bootstrap = jnp.zeros_like(outcome.reward)
    if config.episode_limit:
        last = jax.lax.cond(
            jnp.any(truncated),
            lambda: values(learner, jax.vmap(world.observe)(state), config),
            lambda: bootstrap,
        )
        bootstrap = jnp.where(truncated[:, None], last, 0.0)
    batch = Batch(
        observation,
        legal,
        action,
        log_probability,
        outcome.reward,
        outcome.terminated,
        truncated,
        bootstrap,
        jnp.ones_like(truncated),
    )
    # sums, not means: how many episodes end differs from step to step
    ended = Ended(
        jnp.sum(over).astype(jnp.float32),
        jnp.sum(jnp.where(over[:, None], paid, 0), 0),
        jnp.sum(jnp.where(over[:, None], broken, 0), 0).astype(jnp.float32),
        jnp.sum(jnp.where(over, age, 0)).astype(jnp.float32),
    )
    # under `vmap` all are reset, and only those that are over take it
    again = _reset(reset_key, world, config.environments)
    following = jax.tree.map(
        lambda new, old: jnp.where(over.reshape(-1, *[1] * (old.ndim - 1)), new, old),
        again,
        Environments(state, age, paid, broken),
    )
    return following, batch, ended


def _reset(key: Array, world: World, number: int) -> Environments:
    agents = len(world.agents)
    state = jax.vmap(world.reset)(jax.random.split(key, number))
    return Environments(
        state,
        jnp.zeros(number, jnp.int32),
        jnp.zeros((number, agents), jnp.float32),
        jnp.zeros((number, agents), jnp.int32),
    )


def values(learner: Learner, observation: Array, config: Config) -> Array:
    """`[..., A]` the critics' values of `observation` `[..., A, D]`, in units of reward."""
    output = _forward(learner.parameters, "critic", jnp.moveaxis(observation, -2, 0), config)[
        ..., 0
    ]
    each = (-1, *[1] * (output.ndim - 1))
    return jnp.moveaxis(output * learner.spread.reshape(each) + learner.mean.reshape(each), 0, -1)


# --- Learning ---


def advantages(
    reward: Array,
    value: Array,
    next_value: Array,
    terminated: Array,
    truncated: Array,
    *,
    discount: float,
    gae: float,
) -> Array:
    """Generalised advantage estimates along rollouts of `H` steps that may span episodes.

        delta_t = reward_t + discount (1 - terminated_t) next_value_t - value_t
        A_t     = delta_t + discount gae (1 - ended_t) A_{t+1},     ended = terminated or truncated

    Source: Schulman et al. (2016), section 3, arXiv:1506.02438; the ends are ours.

    Args:
      reward, value, next_value: `[H, ...]`; `next_value` is the critic's value after the step and
        before any reset.
      terminated, truncated: `[H, ...]` bool. A limit on the length stops the sum but not the
        bootstrap.

    Returns:
      `[H, ...]`, in units of reward.
    """
    delta = reward + discount * jnp.where(terminated, 0.0, next_value) - value
    goes_on = discount * gae * ~(terminated | truncated)

    def back(after: Array, here: tuple[Array, Array]) -> tuple[Array, Array]:
        now = here[0] + here[1] * after
        return now, now

    return jax.lax.scan(back, jnp.zeros_like(delta[0]), (delta, goes_on), reverse=True)[1]


def loss(
    parameters: Parameters,
    batch: Batch,
    advantage: Array,
    target: Array,
    entropy_weight: Array,
    config: Config,
) -> tuple[Array, dict[str, Array]]:
    """The sum over the agents of clipped policy loss, critic's loss and minus the entropy. `batch`
    is flat: `[A, B, ...]`.

    The masks of the rollout hold here too: without them the ratio would compare two different
    distributions. A decision with one legal action teaches the actor nothing and does not count in
    its means.

    Args:
      advantage: `[A, B]`. target: `[A, B]`, in the critic's unit.
    """
    log = masked_log_softmax(
        jnp, _forward(parameters, "actor", batch.observation, config), batch.legal
    )
    # how much more likely the action is now than when it was taken; clipped, so that nothing is
    # gained by moving further away from the policy that played
    chosen = jnp.take_along_axis(log, batch.action[..., None], -1)[..., 0]
    ratio = jnp.exp(chosen - batch.log_probability)
    clipped = jnp.clip(ratio, 1 - config.clip, 1 + config.clip)
    policy = -jnp.minimum(ratio * advantage, clipped * advantage)
    entropy = -jnp.sum(jnp.where(batch.legal, jnp.exp(log) * log, 0.0), -1)
    value = _forward(parameters, "critic", batch.observation, config)[..., 0]
    choice = has_choice(batch)
    # the critic learns from every valid step, the actor only where there was a choice
    parts = {
        "policy": _mean(policy, choice),
        "value": _mean(0.5 * (value - target) ** 2, batch.valid),
        "entropy": _mean(entropy, choice),
        "clipped": _mean((jnp.abs(ratio - 1) > config.clip).astype(jnp.float32), choice),
    }
    total = jnp.sum(
        parts["policy"] + config.value_weight * parts["value"] - entropy_weight * parts["entropy"]
    )
    return total, parts


def has_choice(batch: Batch) -> Array:
    """`[...]` bool: a valid step in which the agent had more than one legal action."""
    return batch.valid & (jnp.sum(batch.legal, -1) > 1)


def _compute_advantages(
    learner: Learner,
    environments: Environments,
    batch: Batch,
    stage: StageValues,
    world: World,
    config: Config,
) -> tuple[Batch, Array, Array, Array, Array]:
    """The rollout flat, `[A, B]`, with advantages and the critics' targets, and the unit of the
    critics.
    """
    # the value after a step is the next row's; behind the last row stands the state reached
    value = values(learner, batch.observation, config)
    last = values(learner, jax.vmap(world.observe)(environments.state), config)
    following = jnp.concatenate([value[1:], last[None]])
    # the rows after an early end hold nothing, so what follows the last valid one is put there
    if config.stop_at_end:
        length = jnp.sum(batch.valid.astype(jnp.int32), 0)[0]
        following = following.at[length - 1].set(last)
    # after a cut the next row belongs to a new episode, whose value says nothing of this one
    following = jnp.where(batch.truncated[..., None], batch.bootstrap, following)
    terminated, truncated = batch.terminated[..., None], (batch.truncated | ~batch.valid)[..., None]
    advantage = advantages(
        batch.reward,
        value,
        following,
        terminated,
        truncated,
        discount=config.discount,
        gae=config.gae,
    )
    advantage = jnp.where(batch.valid[..., None], advantage, 0.0)
    target = advantage + value
    # from here on each agent learns alone, so its axis comes first
    flat = _flat(batch, len(world.agents))
    advantage, target = _agents_first(advantage), _agents_first(target)
    # set once, from the first rollout: a unit that moved would unlearn what the critics know
    first = (learner.updates == 0) & config.normalise_returns
    mean = jnp.where(first, _mean(target, flat.valid), learner.mean)
    spread = jnp.where(first, jnp.maximum(_spread(target, flat.valid), 1e-3), learner.spread)
    # steps without a choice teach the actor nothing and must not narrow the spread
    choice = has_choice(flat)
    even = (advantage - _mean(advantage, choice)[:, None]) / (
        _spread(advantage, choice)[:, None] + 1e-8
    )
    return flat, jnp.where(stage.normalise_advantages, even, advantage), target, mean, spread


def _learn(
    key: Array,
    learner: Learner,
    batch: Batch,
    advantage: Array,
    target: Array,
    stage: StageValues,
    config: Config,
) -> tuple[Parameters, Any, dict[str, Array]]:
    """`epochs` times over the rollout in minibatches of shuffled steps.

    A rollout that ended early is mostly empty. When its steps fit into a quarter or half of a
    minibatch, only so many rows are worked on; empty rows weigh nothing, so this saves time and
    changes no result.
    """
    size = batch.valid.shape[1]
    full = min(config.minibatch, size)
    if not config.stop_at_end:
        return _epochs(key, learner, batch, advantage, target, stage, config, full)
    rows = sorted({max(full // 4, 1), max(full // 2, 1), full})
    fits = jnp.sum(jnp.sum(batch.valid[0]) > jnp.asarray(rows[:-1]))
    return jax.lax.switch(
        fits,
        [partial(_epochs, config=config, portion=number) for number in rows],
        key,
        learner,
        batch,
        advantage,
        target,
        stage,
    )


def _epochs(
    key: Array,
    learner: Learner,
    batch: Batch,
    advantage: Array,
    target: Array,
    stage: StageValues,
    config: Config,
    portion: int,
) -> tuple[Parameters, Any, dict[str, Array]]:
    size = batch.valid.shape[1]
    portions = (
        (jnp.sum(batch.valid[0]) + portion - 1) // portion
        if config.stop_at_end
        else size // portion
    )
    Carry = tuple[Parameters, Any, dict[str, Array]]

    # the sums are carried along rather than stacked: only their means are reported
    def minibatch(chosen: Array, carry: Carry) -> Carry:
        parameters, moments, sums = carry
        part, some, goal = jax.tree.map(
            lambda leaf: jnp.take(leaf, chosen, 1), (batch, advantage, target)
        )
        gradient, parts = jax.grad(loss, has_aux=True)(
            parameters, part, some, goal, stage.entropy, config
        )
        parameters, moments = _descend(parameters, moments, gradient, stage.learning_rate, config)
        return parameters, moments, jax.tree.map(jnp.add, sums, parts)

    def epoch(carry: Carry, key: Array) -> tuple[Carry, None]:
        # empty rows come last
        order = jnp.argsort(jax.random.uniform(key, (size,)) + ~batch.valid[0])

        def one(index: Array, carry: Any) -> Any:
            return minibatch(jax.lax.dynamic_slice(order, (index * portion,), (portion,)), carry)

        return jax.lax.fori_loop(0, portions, one, carry), None

    none = {
        name: jnp.zeros(batch.valid.shape[0]) for name in ("policy", "value", "entropy", "clipped")
    }
    carry = (learner.parameters, learner.optimiser, none)
    (parameters, moments, sums), _ = jax.lax.scan(
        epoch, carry, jax.random.split(key, config.epochs)
    )
    return parameters, moments, jax.tree.map(lambda total: total / (portions * config.epochs), sums)


def _descend(
    parameters: Parameters, moments: Any, gradient: Parameters, rate: Array, config: Config
) -> tuple[Parameters, Any]:
    after, moments_after = {}, {}
    for name in parameters:
        step = lambda pair: optimiser(config).update(*pair)  # noqa: E731
        change, moments_after[name] = _each(
            step, (gradient[name], moments[name], parameters[name]), shared(config, name)
        )
        after[name] = jax.tree.map(lambda old, by: old - rate * by, parameters[name], change)
    return after, moments_after


# --- Axes ---


def _networks(
    key: Array, world: World, config: Config, outputs: int, is_shared: bool, last: float
) -> Perceptron:
    inputs = world.observation_size + (len(world.agents) if is_shared else 0)
    sizes = (inputs, *config.hidden, outputs)
    # a world that names no channels has one, and that is the usual first layer
    channels = tuple(getattr(world, "channels", ())) if config.layer_per_channel else ()
    weights = sum(a * b for a, b in itertools.pairwise(sizes))
    weights += max(0, len(channels) - 1) * sizes[1] * sizes[2]
    # one draw: each compiles for a second
    uniform = jax.random.uniform(key, (1 if is_shared else len(world.agents), weights), minval=-1.0)

    def one(uniform: Array) -> Perceptron:
        taken = 0

        def draw(shape: tuple[int, ...]) -> Array:
            nonlocal taken
            taken += shape[0] * shape[1]
            return uniform[taken - shape[0] * shape[1] : taken].reshape(shape)

        return init(draw, sizes, last, channels)

    return one(uniform[0]) if is_shared else jax.vmap(one)(uniform)


def _forward(parameters: Parameters, name: str, observation: Array, config: Config) -> Array:
    """`[A, ..., out]` from `observation` `[A, ..., D]`."""
    run = partial(forward, jnp, activation=config.activation)
    if not shared(config, name):
        return jax.vmap(run)(parameters[name], observation)
    agents = observation.shape[0]
    whose = jnp.broadcast_to(
        jnp.eye(agents).reshape(agents, *[1] * (observation.ndim - 2), agents),
        (*observation.shape[:-1], agents),
    )
    return run(parameters[name], jnp.concatenate([observation, whose], -1))


def _each(function: Any, argument: Any, is_shared: bool) -> Any:
    return function(argument) if is_shared else jax.vmap(function)(argument)


def _agents_first(leaf: Array) -> Array:
    """`[A, B, ...]` from `[H, N, A, ...]`."""
    return jnp.moveaxis(leaf.reshape(-1, *leaf.shape[2:]), 1, 0)


def _flat(batch: Batch, agents: int) -> Batch:
    wide = {
        name: jnp.broadcast_to(getattr(batch, name)[..., None], (*batch.valid.shape, agents))
        for name in ("terminated", "truncated", "valid")
    }
    return jax.tree.map(_agents_first, batch._replace(**wide))


def _mean(value: Array, counts: Array) -> Array:
    """`[A]` mean over the steps that count; 0 when none does."""
    return jnp.sum(jnp.where(counts, value, 0.0), 1) / jnp.maximum(jnp.sum(counts, 1), 1)


def _spread(value: Array, counts: Array) -> Array:
    return jnp.sqrt(_mean((value - _mean(value, counts)[:, None]) ** 2, counts))


def _report(
    learner: Learner,
    stage: Array,
    ended: Ended,
    losses: dict[str, Array],
    world: World,
    config: Config,
) -> Report:
    number = jnp.maximum(ended.episodes, 1)
    first = world.observe(world.reset(jax.random.key(0)))
    finite = [jnp.all(jnp.isfinite(leaf)) for leaf in jax.tree.leaves(learner.parameters)]
    return Report(
        ended.episodes,
        ended.returns / number,
        ended.illegal / number,
        ended.length / number,
        values(learner, first, config),
        losses["entropy"],
        losses["policy"],
        losses["value"],
        losses["clipped"],
        stage,
        learner.steps,
        jnp.all(jnp.asarray(finite)),
    )


def _empty_report(learner: Learner) -> Report:
    agents = learner.mean.shape[0]
    none, each = jnp.zeros(()), jnp.zeros(agents)
    return Report(
        none,
        each,
        each,
        none,
        each,
        each,
        each,
        each,
        each,
        learner.stage,
        learner.steps,
        jnp.ones((), bool),
    )
