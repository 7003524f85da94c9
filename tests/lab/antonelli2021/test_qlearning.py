"""Tabular Q-learning: it finds what value iteration finds, how fast, how precisely, and where it
has not been it knows nothing.
"""

from __future__ import annotations

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tandem.errors import UsageError
from tandem.files.validate import cell_of
from tandem.lab.antonelli2021 import repair
from tandem.lab.antonelli2021.markov import policy_values, value_iteration
from tandem.lab.antonelli2021.qlearning import (
    Config,
    Episodes,
    greedy,
    play,
    sweep_seeds,
    train_seeds,
)

LID = cell_of({
    "operators": {"robot": {"kind": "robot"}},
    "tasks": {"base": {"time": {"robot": 10}}, "lid": {"time": {"robot": 4}, "after": ["base"]}},
})  # fmt: skip


@pytest.fixture(scope="module")
def lid():
    return repair(LID)


ANYWHERE = Config(
    steps=100_000,
    horizon=20.0,
    epsilon=0.3,
    epsilon_end=0.3,
    limit=10,
    exploring_starts=True,
    stratified=True,
)


@pytest.fixture(scope="module")
def learned(lid):
    """Three seeds along episodes, one time in five a slip."""
    return train_seeds(keys(3), lid.process(0.2), ANYWHERE)


def keys(count, seed=0):
    return jax.random.split(jax.random.key(seed), count)


def error(process, table):
    """The largest difference of a learned value from the exact one."""
    return float(
        np.abs(
            np.where(process.goal, 0.0, np.asarray(table).min(axis=-1))
            - value_iteration(process).values
        ).max()
    )


def test_with_slips_even_draws_bring_it_within_a_thousandth_and_independent_ones_do_not(lid):
    process = lid.process(0.2)
    config = Config(steps=60_000, horizon=5.0, stratified=True)
    with jax.enable_x64(True):
        even = sweep_seeds(keys(2), process, config)
        independent = sweep_seeds(keys(2), process, replace(config, stratified=False))
        assert max(error(process, table) for table in even.table) < 1e-3
        assert 1e-3 < min(error(process, table) for table in independent.table) < 1.0


def test_along_episodes_with_slips_the_values_are_near_and_the_policy_is_the_exact_one(
    lid, learned
):
    process = lid.process(0.2)
    assert max(error(process, table) for table in learned.table) < 0.1
    for table in learned.table:
        assert policy_values(process, np.asarray(greedy(table)))[0] == pytest.approx(
            value_iteration(process).values[0]
        )


def test_the_curve_falls_towards_the_exact_values(lid, learned):
    off = np.abs(np.asarray(learned.curve) - value_iteration(lid.process(0.2)).values).max(axis=2)
    assert np.all(off[:, -1] < off[:, 0] / 5)


def test_a_key_repeats_and_seeds_do_not_depend_on_their_neighbours(lid, learned):
    again = train_seeds(keys(3), lid.process(0.2), ANYWHERE)
    second = train_seeds(keys(3)[jnp.array([1, 1, 0])], lid.process(0.2), ANYWHERE)
    assert np.array_equal(learned.table, again.table)
    assert np.array_equal(second.table, learned.table[jnp.array([1, 1, 0])])
    assert not np.array_equal(learned.table[0], learned.table[1])


def test_illegal_actions_are_never_taken(lid, learned):
    illegal = ~lid.process(0.2).legal
    assert np.all(np.asarray(learned.visits)[:, illegal] == 0)
    assert np.all(np.isinf(np.asarray(learned.table)[:, illegal]))
    assert np.all(np.asarray(learned.visits).sum((1, 2)) == ANYWHERE.steps)


def test_what_never_happens_in_training_is_not_learned_and_exploring_starts_mend_it(lid):
    """Without slips and from the empty table no wrong state is ever seen; the assembly itself (10 +
    4 s) is learned all the same.
    """
    process, wrong = lid.process(0.0), np.flatnonzero(lid.wrong)
    nominal = train_seeds(
        keys(3), process, replace(ANYWHERE, exploring_starts=False, epsilon=0.0, epsilon_end=0.0)
    )
    exploring = train_seeds(keys(3), process, ANYWHERE)
    assert np.asarray(nominal.visits)[:, wrong].sum() == 0
    assert np.asarray(nominal.episode_cost)[:, -1].tolist() == [14, 14, 14]
    assert np.asarray(exploring.visits)[:, wrong].sum(2).min() > 100
    assert min(error(process, table) for table in nominal.table) > 1
    assert max(error(process, table) for table in exploring.table) < 1e-3


def test_a_discount_and_a_bonus_are_those_of_the_formula():
    """One part, no slips: Q(mount) = 10 - 100; taking it off wrongly mounted: 5 + 0.9 (10 -
    100).
    """
    world = repair(
        cell_of(
            {"operators": {"robot": {"kind": "robot"}}, "tasks": {"lid": {"time": {"robot": 10}}}}
        )
    )
    learned = train_seeds(
        keys(1),
        world.process(0.0),
        Config(steps=2000, gamma=0.9, bonus=100.0, exploring_starts=True),
    )
    table = np.asarray(learned.table[0])
    assert table[0, 0] == pytest.approx(-90)
    assert table[world.numbers[(2,)], 1] == pytest.approx(5 - 81)


def test_following_a_policy_costs_its_value_on_average(lid):
    process = lid.process(0.3)
    exact = value_iteration(process)
    number = 4000
    episodes: Episodes = jax.jit(play, static_argnames="limit")(
        jax.random.key(3),
        process,
        jnp.asarray(exact.policy),
        jnp.zeros(number, jnp.int32),
        limit=400,
    )
    cost = np.asarray(episodes.cost)
    assert np.all(episodes.reached)
    assert abs(cost.mean() - exact.values[0]) < 4 * cost.std() / number**0.5
    assert np.asarray(episodes.steps).min() == 2


def test_settings_that_make_no_sense_are_refused_all_at_once():
    with pytest.raises(
        UsageError, match=r"epsilon is 2, outside 0 to 1; gamma is -1.*horizon is -3, below 0"
    ):
        Config(epsilon=2, gamma=-1, horizon=-3)
    with pytest.raises(UsageError, match="steps is 3, less than reports"):
        Config(steps=3)
