"""Episodes under trained actors: greedy, sampled, and the best of several."""

from __future__ import annotations

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from tandem.learn.ppo.config import Config
from tandem.learn.ppo.ppo import Parameters, act
from tandem.learn.world import World

Array = Any


class Rollout(NamedTuple):
    """`E` episodes.

    state: the worlds' last states, leading axis `E`.
    actions: `[limit, E, A]` int32; 0 after an episode's end.
    length: `[E]` int32, steps. returns: `[E, A]` float32. illegal: `[E, A]` int32, rules broken.
    done: `[E]` bool, came to its end.
    """

    state: Any
    actions: Array
    length: Array
    returns: Array
    illegal: Array
    done: Array


def greedy(parameters: Parameters, world: World, config: Config, limit: int) -> Rollout:
    """One episode (`E` = 1) in which every agent takes its most probable action; ends after `limit`
    steps at the latest.
    """
    return _play(parameters, world, config, limit, jax.random.key(0), None, 1)


def sampled(
    key: Array, parameters: Parameters, world: World, config: Config, limit: int, episodes: int
) -> Rollout:
    """So many episodes with actions drawn from the actors."""
    reset_key, draw_key = jax.random.split(key)
    return _play(
        parameters,
        world,
        config,
        limit,
        reset_key,
        jax.random.uniform(draw_key, (limit, episodes, len(world.agents))),
        episodes,
    )


def _play(
    parameters: Parameters,
    world: World,
    config: Config,
    limit: int,
    reset_key: Array,
    uniform: Array | None,
    episodes: int,
) -> Rollout:
    agents = len(world.agents)
    state = jax.vmap(world.reset)(jax.random.split(reset_key, episodes))
    empty = Rollout(
        state,
        jnp.zeros((limit, episodes, agents), jnp.int32),
        jnp.zeros(episodes, jnp.int32),
        jnp.zeros((episodes, agents), jnp.float32),
        jnp.zeros((episodes, agents), jnp.int32),
        jnp.zeros(episodes, bool),
    )

    def one(carry: tuple[Array, Rollout]) -> tuple[Array, Rollout]:
        index, so_far = carry
        state, on = so_far.state, ~so_far.done
        observation, legal = jax.vmap(world.observe)(state), jax.vmap(world.legal)(state)
        action, _, _ = act(
            parameters,
            observation,
            legal,
            None if uniform is None else uniform[index],
            state,
            world,
            config,
        )
        # episodes end at different steps, but all are stepped: what is over stays as it was
        after, outcome = jax.vmap(world.step)(state, action)
        following = jax.tree.map(
            lambda new, old: jnp.where(on.reshape(-1, *[1] * (old.ndim - 1)), new, old),
            after,
            state,
        )
        return index + 1, Rollout(
            following,
            so_far.actions.at[index].set(jnp.where(on[:, None], action, 0)),
            so_far.length + on,
            so_far.returns + jnp.where(on[:, None], outcome.reward, 0),
            so_far.illegal + jnp.where(on[:, None], outcome.illegal, 0),
            so_far.done | outcome.terminated,
        )

    goes_on = lambda carry: (carry[0] < limit) & ~jnp.all(carry[1].done)  # noqa: E731
    return jax.lax.while_loop(goes_on, one, (jnp.zeros((), jnp.int32), empty))[1]
