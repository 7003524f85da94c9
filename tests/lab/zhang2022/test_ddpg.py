"""Two actors and a shared critic: the parts by hand, worlds whose answer is known, and the same
choice in NumPy and under JAX.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from tests.learn.probes import LateReward, OneBestAssignment

import tandem
from tandem.errors import UsageError
from tandem.lab.zhang2022 import ddpg
from tandem.lab.zhang2022 import world as rules
from tandem.lab.zhang2022.ddpg import Replay, drawn, legal_pairs, random_pairs, store
from tandem.lab.zhang2022.ddpg_config import Config
from tandem.lab.zhang2022.display import CALM
from tandem.lab.zhang2022.learn_env import DuoWorld
from tandem.lab.zhang2022.pairs import asked_with, candidates, choose, scores, value_of, values_of
from tandem.lab.zhang2022.play import fresh, pairs_of
from tandem.lab.zhang2022.setting import HUMAN, ROBOT, duo, setting

SMALL = Config(
    steps=9600,
    environments=16,
    warm_up=320,
    replay=4800,
    minibatch=64,
    hidden=(16,),
    critic_rate=3e-3,
    actor_rate=3e-3,
    target_rate=0.05,
    discount=1.0,
)
EXPECTED = replace(SMALL, actors_learn="expected", entropy=0.01, ahead=2)
SEEDS = 4


# --- Worlds whose answer is known ---


def returns(world: Any, config: Config) -> list[float]:
    """Sum of both agents' returns of the greedy pair, a seed each."""
    keys = jax.random.split(jax.random.key(0), SEEDS)
    train = jax.jit(jax.vmap(lambda key: ddpg.train(key, world, config)[0].networks)).lower(keys)
    # compiles faster, runs slower
    networks = jax.device_get(
        train.compile(compiler_options={"xla_backend_optimization_level": 0})(keys)
    )
    return [
        _greedy(world, jax.tree.map(lambda leaf, seed=seed: leaf[seed], networks), config)
        for seed in range(SEEDS)
    ]


def _greedy(world: Any, networks: Any, config: Config) -> float:
    state, total = world.reset(jax.random.key(0)), 0.0
    for _ in range(8):
        action = choose(
            np,
            networks,
            np.asarray(world.observe(state)),
            np.asarray(legal_pairs(world, state)),
            config.candidates,
            config.activation,
        )
        state, outcome = world.step(state, jnp.asarray(action))
        total += float(outcome.reward.sum())
        if outcome.terminated:
            return total
    return total


@pytest.mark.parametrize(
    ("world", "config", "best"),
    [(OneBestAssignment, SMALL, 2.0), (LateReward, EXPECTED, 2.0)],
    ids=["best assignment, relaxed", "late reward, expected"],
)
def test_every_seed_solves_the_probe(world: Any, config: Config, best: float) -> None:
    np.testing.assert_allclose(returns(world(), config), best, atol=1e-5)


# --- The choice ---


@pytest.fixture(scope="module")
def networks() -> Any:
    return fresh(duo(tandem.load("examples/alternator.yaml"))[0], np.random.default_rng(3))


def test_candidates_are_the_best_legal_choices_and_answers() -> None:
    score = np.array([[0.1, 0.9, 0.5], [0.2, 0.3, 0.8]])
    pairs = np.array([[True, True, False], [True, False, False], [True, False, False]])
    asked = candidates(np, score, pairs, 2)
    assert asked.first.argmax(1).tolist() == [1, 0], (
        "the first agent's choice 2 leaves no answer: it is not legal"
    )
    assert asked.legal.tolist() == [[True, False], [True, True]]
    assert asked.second[1].argmax(1).tolist() == [1, 2], (
        "its choice 0 leaves all; 1 and 2 score best"
    )
    assert asked.second[0, 0].argmax() == 0


def test_one_candidate_each_leaves_the_decision_to_the_actors(networks: Any) -> None:
    draw = np.random.default_rng(0)
    seen, pairs = draw.random((2, 93), np.float32), np.ones((20, 20), bool)
    score = scores(np, networks["actors"], seen, "relu")
    assert choose(np, networks, seen, pairs, 1, "relu").tolist() == score.argmax(1).tolist()


def test_with_every_choice_a_candidate_the_critic_alone_decides(networks: Any) -> None:
    draw = np.random.default_rng(1)
    seen, pairs = draw.random((2, 93), np.float32), draw.random((20, 20)) < 0.3
    one = np.eye(20, dtype=np.float32)
    values = {
        (i, j): value_of(np, networks["critic"], seen, one[i], one[j], "relu")
        for i in range(20)
        for j in range(20)
        if pairs[i, j]
    }
    assert tuple(choose(np, networks, seen, pairs, 20, "relu").tolist()) == max(
        values, key=values.__getitem__
    )


def test_what_the_pairs_have_in_common_changes_no_value(networks: Any) -> None:
    draw = np.random.default_rng(2)
    seen, pairs = draw.random((2, 93), np.float32), np.ones((20, 20), bool)
    asked = candidates(np, scores(np, networks["actors"], seen, "relu"), pairs, 3)
    table = values_of(np, networks["critic"], seen, asked, "relu")
    for i in range(3):
        for j in range(3):
            assert table[i, j] == pytest.approx(
                value_of(np, networks["critic"], seen, asked.second[i, j], asked.first[i], "relu"),
                rel=1e-4,
                abs=1e-6,
            )


def test_noise_makes_the_human_do_what_its_actor_says_and_the_robot_answer() -> None:
    score = np.array([[0.0, 0.1, 0.2], [0.0, 0.1, 0.2]])
    noise = np.array([0.0, 5.0, 0.0])
    asked = asked_with(np, score, np.ones((3, 3), bool), 3, noise, np.array(True))
    assert asked.first[0].argmax() == 1
    assert asked.legal.tolist() == [[True] * 3, [False] * 3, [False] * 3]
    assert asked_with(np, score, np.ones((3, 3), bool), 3, 0 * noise, np.array(False)).legal.all()


# --- Replay and returns ---


def ring(rewards: list[float], ends: list[bool], rows: int) -> Replay:
    """One environment whose row i saw the number i."""
    replay = Replay(
        *[
            np.zeros((rows, 1, *shape), kind)
            for shape, kind in (
                ((2, 1), float),
                ((1, 1), bool),
                ((2,), int),
                ((), float),
                ((), bool),
            )
        ]
    )
    put = jax.jit(store)
    for number, (reward, end) in enumerate(zip(rewards, ends, strict=True)):
        row = Replay(
            np.full((1, 2, 1), number),
            np.ones((1, 1, 1), bool),
            np.zeros((1, 2), int),
            np.array([reward]),
            np.array([end]),
        )
        replay = put(replay, number, row)
    return replay


draw_from = jax.jit(drawn, static_argnames="config")


def test_a_stretch_sums_discounted_rewards_and_stops_at_the_end() -> None:
    config = replace(SMALL, ahead=3, discount=0.5, minibatch=2, environments=1, replay=10)
    replay = ring([1, 2, 4, 8, 16, 32], [False, False, False, False, True, False], 10)
    sample = draw_from(np.array([[0.0, 0.0], [0.999, 0.0]]), replay, 6, config)
    assert sample.seen[:, 0, 0].tolist() == [0, 2]
    assert sample.reward.tolist() == [1 + 2 / 2 + 4 / 4, 4 + 8 / 2 + 16 / 4]
    assert sample.weight.tolist() == [0.125, 0.0]
    assert sample.later_seen[:, 0, 0].tolist() == [3, 5]


def test_the_ring_forgets_the_oldest_and_no_stretch_runs_over_its_seam() -> None:
    config = replace(SMALL, ahead=2, minibatch=64, environments=1, replay=6)
    replay = ring(list(range(15)), [False] * 15, 6)
    sample = draw_from(np.stack([np.linspace(0, 0.9999, 64), np.zeros(64)], 1), replay, 15, config)
    assert sorted(set(sample.seen[:, 0, 0].tolist())) == [9, 10, 11, 12]
    np.testing.assert_array_equal(sample.reward, 2 * sample.seen[:, 0, 0] + 1)
    np.testing.assert_array_equal(sample.later_seen[:, 0, 0], sample.seen[:, 0, 0] + 2)


def test_random_pairs_are_legal_and_all_come_up() -> None:
    pairs = np.zeros((1, 4, 4), bool)
    pairs[0, [0, 2, 3], [1, 2, 0]] = True
    found = jax.jit(random_pairs)(
        np.linspace(0, 0.9999, 30), np.broadcast_to(pairs, (30, 4, 4))
    ).tolist()
    assert [found.count(pair) for pair in ([0, 1], [2, 2], [3, 0])] == [10, 10, 10]


# --- The world of robot and human ---


def test_the_world_moves_under_jax_as_in_numpy_and_the_choice_is_the_same(networks: Any) -> None:
    cell = tandem.load("examples/alternator.yaml")
    data, numbers = duo(cell)[0], setting(spread=0.3, change=1.0, slows=0.5, fatigue=0.1)
    world = DuoWorld.of(cell, numbers)
    state = jax.jit(world.reset)(jax.random.key(5))
    plain = jax.device_get(state)

    @jax.jit
    def forward(state: Any) -> Any:
        pairs = legal_pairs(world, state)
        action = choose(jnp, networks, world.observe(state), pairs, 4, "relu")
        return pairs, action, *world.step(state, action)

    for _ in range(40):
        seen = rules.observe(data, plain)
        pairs, action, state, outcome = forward(state)
        np.testing.assert_array_equal(pairs, pairs_of(data, plain))
        assert (
            action.tolist()
            == choose(
                np, networks, np.stack([seen, seen]), pairs_of(data, plain), 4, "relu"
            ).tolist()
        )
        plain, paid = rules.step(data, numbers, plain, np.asarray(action))
        np.testing.assert_allclose(outcome.reward, -rules.cost(numbers, paid) / 10, rtol=1e-4)
        jax.tree.map(partial(np.testing.assert_allclose, rtol=1e-4), jax.device_get(state), plain)
        if outcome.terminated:
            break
    assert rules.is_done(plain)
    assert plain.happened.kind > 0


def test_the_human_is_the_second_row_and_names_first() -> None:
    data = duo(tandem.load("examples/thesis.yaml"))[0]
    state = rules.reset(data, np.ones(7, np.float32), CALM)
    legal = rules.choices(data, state)
    assert legal[ROBOT].sum() == 3, "tasks 1, 2 or waiting"
    assert legal[HUMAN].sum() == 4, "tasks 1, 2, 3; or leaving the beginning to the robot"
    assert pairs_of(data, state).sum() == 2 + 2 + 3 + 2, (
        "per choice of the human: the tasks that are left, and waiting where something begins"
    )


# --- Words ---


def test_a_configuration_says_everything_that_is_wrong() -> None:
    with pytest.raises(UsageError) as error:
        Config(environments=0, discount=2.0, actors_learn="relax", noise=-1.0, hidden=(), replay=16)
    for words in (
        "environments 0",
        "discount 2",
        "actors_learn 'relax': Did you mean 'relaxed'?",
        "noise -1",
        "hidden a list: needs 1 or more values",
    ):
        assert words in str(error.value)
    with pytest.raises(UsageError, match="replay 32: holds too few steps of 16 environments"):
        Config(replay=32)
    assert Config().to_dict()["actors_learn"] == "relaxed"
