"""Training against others, on worlds whose answer a person knows. One compiled training serves
every seat and opponent.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple, Self

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tandem.files.generators import layered
from tandem.lab.alessio2022.adversarial import (
    Against,
    ByChance,
    Draws,
    Envious,
    Frozen,
    OneOf,
    Seated,
    against,
    alternately,
    hostile,
    reduced,
)
from tandem.lab.kinat2023.learn_env import StationWorld
from tandem.lab.kinat2023.recipe import STATION
from tandem.learn.ppo.config import Config, Stage
from tandem.learn.world import StepResult


class Round(NamedTuple):
    """How many rounds were played."""

    number: Any


@partial(jax.tree_util.register_dataclass, data_fields=[], meta_fields=[])
@dataclass(frozen=True)
class Pennies:
    """One round in which both show one of three sides: the robot is paid 1 when they differ, the
    human 1 when they are the same.
    """

    agents = ("robot_0", "human_0")
    actions = 3
    observation_size = 1

    def reset(self, key: Any) -> Round:
        return Round(jnp.zeros((), jnp.int32))

    def observe(self, state: Round) -> Any:
        return jnp.ones((2, 1))

    def legal(self, state: Round) -> Any:
        return jnp.ones((2, 3), bool)

    def narrow(self, state: Round, legal: Any, action: Any) -> Any:
        return legal

    def step(self, state: Round, action: Any) -> tuple[Round, StepResult]:
        same = action[0] == action[1]
        return Round(state.number + 1), StepResult(
            jnp.where(same, jnp.array([0.0, 1.0]), jnp.array([1.0, 0.0])),
            jnp.ones((), bool),
            jnp.zeros(2, jnp.int32),
        )

    def in_stage(self, stage: Any) -> Self:
        return self


SMALL = Config(
    stages=(Stage(steps=20_000, entropy=0.01, learning_rate=0.02),),
    environments=32,
    horizon=8,
    minibatch=256,
    hidden=(8,),
)


def shows(side: int) -> dict[str, Any]:
    """An actor that shows that side, whatever it sees."""
    zero = jnp.zeros((1, 8))
    return {
        "0": {"weight": zero, "bias": jnp.zeros(8)},
        "1": {"weight": jnp.zeros((8, 3)), "bias": 9.0 * jnp.eye(3)[side]},
    }


def frozen(side: int) -> Frozen:
    return Frozen(shows(side), jnp.ones((), bool))


@jax.jit
def respond(key: Any, world: Any, opponent: Any, seat: Any) -> Any:
    """The side that is learned to be shown, and the first weights."""
    learner, _ = against(key, world, opponent, SMALL, 24, seat=seat)
    network = Frozen.of(learner.parameters, SMALL, greedy=True)
    return network.choose(
        world, Round(0), 0, jnp.ones(3, bool), Draws(jnp.zeros(2), jnp.zeros(2))
    ), network.actor["0"]["weight"]


@pytest.mark.parametrize("side", range(3))
def test_the_best_response_to_a_frozen_robot_is_found_and_paid_as_the_hostile_human_is(side):
    """The human is paid for showing what the frozen robot shows: it learns to."""
    assert (
        int(respond(jax.random.key(side), hostile(Pennies()), frozen(side), jnp.int32(1))[0])
        == side
    )


def test_the_robot_learns_to_differ_from_a_human_that_does_not_learn():
    assert int(respond(jax.random.key(7), hostile(Pennies()), frozen(2), jnp.int32(0))[0]) in (0, 1)


@pytest.mark.parametrize(("share", "paid"), [(0.0, 0.0), (0.1, -0.1), (1.0, -1.0)])
def test_the_robot_is_paid_less_by_a_share_of_the_humans_reward(share, paid):
    _, outcome = reduced(Pennies(), share).step(Round(jnp.int32(0)), jnp.array([1, 1]))
    assert outcome.reward.tolist() == pytest.approx([paid, 1.0])


def test_a_hostile_human_is_paid_minus_what_the_robot_is():
    for action, paid in (([0, 1], [1.0, -1.0]), ([2, 2], [0.0, 0.0])):
        assert (
            hostile(Pennies()).step(Round(jnp.int32(0)), jnp.array(action))[1].reward.tolist()
            == paid
        )


def test_what_the_opponent_does_is_decided_by_the_draws_alone():
    mask = jnp.array([True, False, True])
    chosen = [
        int(
            ByChance().choose(
                Pennies(), Round(0), 1, mask, Draws(jnp.zeros(2), jnp.full(2, moment))
            )
        )
        for moment in (0.0, 0.49, 0.51, 0.99)
    ]
    assert chosen == [0, 0, 2, 2]


def test_one_of_several_opponents_plays_through_an_episode_each_in_its_share():
    both = OneOf((frozen(0), frozen(1), frozen(2)), jnp.array([0.25, 0.0, 0.75]))

    def choose(episode):
        draws = Draws(jnp.full(2, episode), jnp.zeros(2))
        return int(both.choose(Pennies(), Round(0), 1, jnp.ones(3, bool), draws))

    assert [choose(episode) for episode in (0.0, 0.24, 0.26, 0.6, 0.999)] == [0, 0, 2, 2, 2]


def test_an_opponent_draws_anew_at_each_step_and_the_same_in_each_question_of_one():
    world = Against(Pennies(), ByChance(), jnp.int32(0))
    states = [world.reset(key) for key in jax.random.split(jax.random.key(0), 4)]
    assert len({float(state.draws.moment[1]) for state in states}) == 4
    after, _ = world.step(states[0], jnp.array([0]))
    assert float(after.draws.moment[1]) != float(states[0].draws.moment[1])
    assert float(after.draws.episode[1]) == float(states[0].draws.episode[1])


@pytest.fixture(scope="module")
def station():
    return StationWorld.of(layered(4, seed=0), STATION)


def play(world, state, seat, generator):
    """An episode of the one-agent world; the tasks that each agent was given are returned with its
    end.
    """
    for _ in range(60):
        mask = np.asarray(world.legal(state)[0])
        assert mask.any()
        state, outcome = world.step(state, jnp.array([generator.choice(np.flatnonzero(mask))]))
        assert int(outcome.illegal[0]) == 0
        if outcome.terminated:
            return state
    raise AssertionError("the episode did not end")


@pytest.mark.parametrize("seat", [0, 1])
def test_where_the_human_chooses_first_both_seats_keep_to_the_rules(station, seat):
    """The robot may be left fewer tasks by the opponent's choice; nobody breaks a rule and all is
    done.
    """
    world = Against(Envious(station, jnp.eye(2)), ByChance(), jnp.int32(seat))
    state: Seated = play(
        world, world.reset(jax.random.key(seat)), seat, np.random.default_rng(seat)
    )
    assert bool(state.inner.ended.all())


def test_pennies_learned_in_turns_end_near_the_value_of_the_game():
    """The robot differs in two of three rounds whatever the human learns; a robot that always shows
    one side would be found out.
    """
    pair, (robots, humans) = jax.jit(
        lambda key: alternately(key, hostile(Pennies()), SMALL, 40, 20)
    )(jax.random.key(0))
    assert robots.episodes.shape == humans.episodes.shape == (20, 2)
    assert int(pair.robot.updates) == int(pair.human.updates) == 40
    assert float(robots.returns[5:].mean()) == pytest.approx(2 / 3, abs=0.2)


def test_the_same_key_gives_the_same_robot_and_another_key_another():
    def train(seed):
        return respond(jax.random.key(seed), hostile(Pennies()), frozen(0), jnp.int32(0))[1]

    first, again, other = (train(seed) for seed in (1, 1, 2))
    assert jnp.array_equal(first, again)
    assert not jnp.array_equal(first, other)
