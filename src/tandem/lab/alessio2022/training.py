"""Compiled once and used for every training of the experiment: all seeds side by side, on any world
of two agents, robot and human.

Every function takes `[seeds]` keys and returns leaves with a leading axis of that length. World,
rewards and opponents are data, so that trainings that differ in them alone share what was compiled.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import jax
import jax.numpy as jnp

from tandem.lab.alessio2022 import adversarial
from tandem.lab.alessio2022.adversarial import Against, ByChance, Frozen, OneOf
from tandem.lab.alessio2022.layout import WRONG, Layout
from tandem.lab.alessio2022.learn_env import Pursuer
from tandem.lab.alessio2022.world import REACHED_RIGHT
from tandem.learn.ppo import play, ppo
from tandem.learn.ppo.config import Config

Array = Any
HUMANS = ("random", "random goal", "wrong goal", "adversary")
"""Who a robot of the grid is judged against: `others` in their order, and one that learned to spoil
it.
"""


def keys(seeds: Any, number: int) -> list[Array]:
    """So many keys, each `[seeds]`."""
    split = jax.vmap(partial(jax.random.split, num=number))(
        jnp.stack([jax.random.key(seed) for seed in seeds])
    )
    return [split[:, index] for index in range(number)]


def others(drawn: Layout) -> tuple[Any, ...]:
    """The humans of the grid that learn nothing: `HUMANS` but the last, the adversary."""
    return ByChance(), Pursuer.of(drawn), Pursuer.of(drawn, goals=WRONG)


def only(human: str) -> Array:
    """The shares of `OneOf` that pick this one of `HUMANS`."""
    return jnp.array([float(name == human) for name in HUMANS])


def nobody(keys: Array, world: Any, config: Config) -> Array:
    """An actor a seed that knows nothing, where a network must stand that nobody asks."""
    shapes = jax.eval_shape(
        lambda: ppo.start(jax.random.key(0), Against(world, ByChance()), config).parameters["actor"]
    )
    return jax.tree.map(lambda leaf: jnp.zeros((*keys.shape, *leaf.shape[1:]), leaf.dtype), shapes)


def against(
    keys: Array,
    world: Any,
    others: tuple[Any, ...],
    adversaries: Array,
    human: str,
    config: Config,
    updates: int,
) -> Array:
    """The robot's actor, trained beside one of `HUMANS`; `adversaries` are actors, one a seed, and
    `others` as in `success`.
    """
    return _against(keys, world, others, adversaries, only(human), jnp.int32(0), config, updates)


def best_response(
    keys: Array, world: Any, others: tuple[Any, ...], robots: Array, config: Config, updates: int
) -> Array:
    """The actor of the human that learned to spoil that very robot, per seed, paid minus the
    robot's reward; the robots draw their actions.
    """
    return _against(
        keys,
        adversarial.hostile(world),
        others,
        robots,
        only("adversary"),
        jnp.int32(1),
        config,
        updates,
    )


@partial(jax.jit, static_argnames=("config", "updates"))
def _against(
    keys: Array,
    world: Any,
    others: tuple[Any, ...],
    actors: Array,
    shares: Array,
    seat: Array,
    config: Config,
    updates: int,
) -> Array:
    def one(key: Array, actor: Array) -> Array:
        opponent = OneOf((*others, Frozen(actor, jnp.zeros((), bool), config.activation)), shares)
        return adversarial.against(key, world, opponent, config, updates, seat=seat)[0].parameters[
            "actor"
        ]

    return jax.tree.map(lambda leaf: leaf[:, 0], jax.vmap(one)(keys, actors))


@partial(jax.jit, static_argnames=("config", "updates"))
def together(keys: Array, world: Any, config: Config, updates: int) -> tuple[Array, Array]:
    """The actors of robot and human that learn at the same time."""
    actors = jax.vmap(lambda key: adversarial.together(key, world, config, updates)[0])(
        keys
    ).parameters["actor"]
    return jax.tree.map(lambda leaf: leaf[:, 0], actors), jax.tree.map(
        lambda leaf: leaf[:, 1], actors
    )


@partial(jax.jit, static_argnames=("config", "updates", "rounds"))
def in_turns(
    keys: Array, world: Any, config: Config, updates: int, rounds: int
) -> tuple[Array, Array]:
    """The actors of robot and human that learn in turns."""
    pair = jax.vmap(lambda key: adversarial.alternately(key, world, config, updates, rounds)[0])(
        keys
    )
    robot, human = (
        jax.tree.map(lambda leaf: leaf[:, 0], learner.parameters["actor"]) for learner in pair
    )
    return robot, human


@partial(jax.jit, static_argnames=("config", "limit", "episodes"))
def success(
    keys: Array,
    world: Any,
    robots: Array,
    others: tuple[Any, ...],
    adversaries: Array,
    config: Config,
    limit: int,
    episodes: int,
) -> Array:
    """`[len(HUMANS), seeds]` share of games of the grid in which a right terminal state was
    reached, robot and adversary drawing their actions.

    Args:
      keys: `[len(HUMANS), seeds]`. others: of the grid. adversaries: actors, one a seed.
    """

    def one(key: Array, actor: Array, spoiler: Array, shares: Array) -> Array:
        human = OneOf((*others, Frozen(spoiler, jnp.zeros((), bool), config.activation)), shares)
        parameters = {"actor": jax.tree.map(lambda leaf: leaf[None], actor)}
        played = play.sampled(key, parameters, Against(world, human), config, limit, episodes)
        return jnp.mean(played.state.inner.reached == REACHED_RIGHT)

    seeds = jax.vmap(one, in_axes=(0, 0, 0, None))
    return jax.vmap(seeds, in_axes=(0, None, None, 0))(
        keys, robots, adversaries, jnp.eye(len(HUMANS))
    )
