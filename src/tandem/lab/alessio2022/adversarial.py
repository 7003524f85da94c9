"""Training against others, on top of PPO (`ppo.py`): against a fixed opponent, against one that
learns too, and the best response to a frozen one.

Nothing here learns by itself. An opponent is put into the world (`Against`), so that what is left
is a world of one agent, which PPO can play; what agents grudge each other is put into the rewards
(`Envious`). An adversary that learns is one whose policy in the world is exchanged between rounds.
Sources: Pinto et al. (2017), "Robust adversarial reinforcement learning", arXiv:1703.02702,
algorithm 1, for learning in alternation; Alessio, Aliev and Antonelli (2022) for the share of the
human's reward that the robot's is reduced by.

Axes as in `ppo.py`; `A` agents of the world itself, of which `Against` leaves one.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, NamedTuple, Protocol, Self

import jax
import jax.numpy as jnp

from tandem.learn.networks import Perceptron, forward, masked_log_softmax, sample
from tandem.learn.ppo import ppo
from tandem.learn.ppo.config import Config
from tandem.learn.ppo.ppo import Learner, Parameters, Report
from tandem.learn.world import StageValues, State, StepResult, World

Array = Any

SHARE = 0.1
"""Of the human's reward that is taken from the robot's; as Alessio et al. (2022) have it."""


class Draws(NamedTuple):
    """The numbers in [0, 1) that decide what opponents do.

    episode: `[A]`, the same through an episode. moment: `[A]`, new at each step.
    """

    episode: Array
    moment: Array


class Opponent(Protocol):
    """Who plays a seat that does not learn. Data (a JAX pytree), so that it can be exchanged
    without compiling again.
    """

    def choose(self, world: World, state: State, seat: int, legal: Array, draws: Draws) -> Array:
        """`[]` int: the action of the agent in `seat`, one of those that `legal` `[K]` allows."""


@partial(jax.tree_util.register_dataclass, data_fields=[], meta_fields=[])
@dataclass(frozen=True)
class ByChance:
    """Takes any legal action, each as likely as the others."""

    def choose(self, world: World, state: State, seat: int, legal: Array, draws: Draws) -> Array:
        reached = jnp.cumsum(legal) / jnp.sum(legal)
        return jnp.sum(reached <= draws.moment[seat]).astype(jnp.int32)


@partial(
    jax.tree_util.register_dataclass, data_fields=["actor", "greedy"], meta_fields=["activation"]
)
@dataclass(frozen=True)
class Frozen:
    """A trained actor that does not learn.

    Attributes:
      actor: one agent's network, without the axis `A`.
      greedy: `[]` bool, takes its most probable action; else draws.
    """

    actor: Perceptron
    greedy: Array
    activation: str = field(default="tanh")

    @classmethod
    def of(
        cls, parameters: Parameters, config: Config, *, seat: int = 0, greedy: bool = False
    ) -> Self:
        """The actor in that seat of trained parameters, which are not shared."""
        return cls(
            jax.tree.map(lambda leaf: leaf[seat], parameters["actor"]),
            jnp.asarray(greedy),
            config.activation,
        )

    def choose(self, world: World, state: State, seat: int, legal: Array, draws: Draws) -> Array:
        log = masked_log_softmax(
            jnp, forward(jnp, self.actor, world.observe(state)[seat], self.activation), legal
        )
        return jnp.where(self.greedy, jnp.argmax(log, -1), sample(jnp, log, draws.moment[seat]))


@partial(jax.tree_util.register_dataclass, data_fields=["opponents", "shares"], meta_fields=[])
@dataclass(frozen=True)
class OneOf:
    """One of several opponents, drawn for each episode.

    Attributes:
      shares: `[len(opponents)]`, how often each; they add up to 1. As data, so that one compiled
        training serves every mixture.
    """

    opponents: tuple[Any, ...]
    shares: Array

    def choose(self, world: World, state: State, seat: int, legal: Array, draws: Draws) -> Array:
        until = jnp.cumsum(self.shares)
        drawn = jnp.minimum(jnp.sum(until <= draws.episode[seat]), len(self.opponents) - 1)
        within = (draws.episode[seat] - until[drawn] + self.shares[drawn]) / jnp.maximum(
            self.shares[drawn], 1e-9
        )
        again = draws._replace(
            episode=draws.episode.at[seat].set(jnp.clip(within, 0.0, 1.0 - 1e-6))
        )
        return jnp.stack(
            [
                one.choose(world, state, seat, legal, again).astype(jnp.int32)
                for one in self.opponents
            ]
        )[drawn]


class Seated(NamedTuple):
    """An episode of `Against`: the world's state, the opponents' numbers of this step, and the key
    that later ones come from.

    The numbers are kept because they are asked for several times in a step, and each place that
    draws compiles for a second.
    """

    inner: State
    draws: Draws
    key: Array


@partial(
    jax.tree_util.register_dataclass, data_fields=["world", "opponent", "seat"], meta_fields=[]
)
@dataclass(frozen=True)
class Against:
    """The world as the agent in `seat` meets it: a world of one agent, in which `opponent` plays
    everyone else.

    The seat is data too: one compiled training serves every seat.
    """

    world: Any
    opponent: Any
    seat: Array = field(default=0)

    @property
    def agents(self) -> tuple[str, ...]:
        return ("learner",)

    @property
    def actions(self) -> int:
        return int(self.world.actions)

    @property
    def observation_size(self) -> int:
        return int(self.world.observation_size)

    def reset(self, key: Array) -> Seated:
        reset_key, draw_key, key = jax.random.split(key, 3)
        episode, moment = jax.random.uniform(draw_key, (2, len(self.world.agents)))
        return Seated(self.world.reset(reset_key), Draws(episode, moment), key)

    def observe(self, state: Seated) -> Array:
        return self.world.observe(state.inner)[self.seat][None]

    def legal(self, state: Seated) -> Array:
        """What is left to the agent, once those that choose before it have chosen."""
        legal = self.world.legal(state.inner)
        own_unknown = jnp.argmax(legal[self.seat])
        return self.world.narrow(state.inner, legal, self._joint(state, legal, own_unknown))[
            self.seat
        ][None]

    def narrow(self, state: Seated, legal: Array, action: Array) -> Array:
        return legal

    def step(self, state: Seated, action: Array) -> tuple[Seated, StepResult]:
        legal = self.world.legal(state.inner)
        narrowed = self.world.narrow(state.inner, legal, self._joint(state, legal, action[0]))
        after, outcome = self.world.step(state.inner, self._joint(state, narrowed, action[0]))
        mine = StepResult(
            outcome.reward[self.seat][None], outcome.terminated, outcome.illegal[self.seat][None]
        )
        draw_key, key = jax.random.split(state.key)
        draws = state.draws._replace(moment=jax.random.uniform(draw_key, state.draws.moment.shape))
        return Seated(after, draws, key), mine

    def in_stage(self, stage: StageValues) -> Self:
        return replace(self, world=self.world.in_stage(stage))

    def _joint(self, state: Seated, legal: Array, own: Array) -> Array:
        """`[A]` int32: the agent's action among those that the opponent chooses under these masks;
        the same draws each time it is asked.
        """
        agents = len(self.world.agents)
        choices = [
            self.opponent.choose(self.world, state.inner, seat, legal[seat], state.draws)
            for seat in range(agents)
        ]
        return jnp.where(jnp.arange(agents) == self.seat, own, jnp.stack(choices)).astype(jnp.int32)


@partial(jax.tree_util.register_dataclass, data_fields=["world", "weights"], meta_fields=[])
@dataclass(frozen=True)
class Envious:
    """The world with each agent's reward a weighted sum of all: `reward' = weights @ reward`,
    `weights` `[A, A]`.
    """

    world: Any
    weights: Array

    @property
    def agents(self) -> tuple[str, ...]:
        return tuple(self.world.agents)

    @property
    def actions(self) -> int:
        return int(self.world.actions)

    @property
    def observation_size(self) -> int:
        return int(self.world.observation_size)

    def reset(self, key: Array) -> State:
        return self.world.reset(key)

    def observe(self, state: State) -> Array:
        return self.world.observe(state)

    def legal(self, state: State) -> Array:
        return self.world.legal(state)

    def narrow(self, state: State, legal: Array, action: Array) -> Array:
        return self.world.narrow(state, legal, action)

    def step(self, state: State, action: Array) -> tuple[State, StepResult]:
        after, outcome = self.world.step(state, action)
        return after, outcome._replace(reward=self.weights @ outcome.reward)

    def in_stage(self, stage: StageValues) -> Self:
        return replace(self, world=self.world.in_stage(stage))


def reduced(world: World, share: float | Array = SHARE) -> Envious:
    """The robot's reward less `share` of the human's; the human's stays its own. Agents are (robot,
    human).
    """
    return Envious(world, jnp.array([[1.0, 0.0], [0.0, 1.0]]).at[0, 1].set(-share))


def hostile(world: World) -> Envious:
    """The human's reward is minus the robot's, and nothing else: the purest adversary
    (zero-sum).
    """
    return Envious(world, jnp.array([[1.0, 0.0], [-1.0, 0.0]]))


# --- Training ---


class Pair(NamedTuple):
    """Two learners of one agent each, robot and human, that have learned from each other."""

    robot: Learner
    human: Learner


def against(
    key: Array, world: World, opponent: Opponent, config: Config, updates: int, *, seat: Array = 0
) -> tuple[Learner, Report]:
    """One agent learns against an opponent that does not. With an adversary's rewards and a
    `Frozen` robot: the learned best response to it.
    """
    return ppo.train(key, Against(world, opponent, seat), config, updates)


def alternately(
    key: Array, world: World, config: Config, updates: int, rounds: int, *, mixed: float = 0.0
) -> tuple[Pair, tuple[Report, Report]]:
    """Robot and human learn in turns, each for `updates / rounds` updates against what the other
    has just become.

    Args:
      updates: of each, in all.
      mixed: share of the robot's episodes that it plays against a human that moves by chance, lest
        it forget those.

    Returns:
      both learners, and their reports `[rounds, updates a round]`.
    """
    robot_key, human_key, key = jax.random.split(key, 3)
    each = max(updates // rounds, 1)
    nobody = Frozen(
        jax.tree.map(
            lambda leaf: leaf[0],
            ppo.start(key, Against(world, ByChance()), config).parameters["actor"],
        ),
        jnp.zeros((), bool),
    )

    def as_robot(human: Any) -> Against:
        return Against(world, OneOf((ByChance(), human), jnp.array([mixed, 1 - mixed])))

    as_human = lambda robot: Against(world, robot, 1)  # noqa: E731
    pair = Pair(
        ppo.start(robot_key, as_robot(nobody), config),
        ppo.start(human_key, as_human(nobody), config),
    )

    def one(pair: Pair, _: None) -> tuple[Pair, tuple[Report, Report]]:
        robot, robots = ppo.advance(
            pair.robot, as_robot(Frozen.of(pair.human.parameters, config)), config, each
        )
        human, humans = ppo.advance(
            pair.human, as_human(Frozen.of(robot.parameters, config)), config, each
        )
        return Pair(robot, human), (robots, humans)

    return jax.lax.scan(one, pair, None, rounds)


def together(key: Array, world: World, config: Config, updates: int) -> tuple[Learner, Report]:
    """Robot and human learn at the same time from the same games: independent PPO on a world whose
    rewards set them against each other.
    """
    return ppo.train(key, world, config, updates)
