"""The parts of PPO, each alone."""

from __future__ import annotations

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.learn.probes import SMALL, ForbiddenFruit, LateReward, OneTask

from tandem.learn.networks import masked_log_softmax, sample
from tandem.learn.ppo import ppo


def slow_advantages(reward, value, following, terminated, truncated, discount, gae):
    """The definition, as sums: A_t = sum over k of (discount gae)^k delta_{t+k}, up to the
    episode's end.
    """
    found = []
    for start in range(len(reward)):
        total, weight = 0.0, 1.0
        for t in range(start, len(reward)):
            total += weight * (
                reward[t] + discount * (0.0 if terminated[t] else following[t]) - value[t]
            )
            if terminated[t] or truncated[t]:
                break
            weight *= discount * gae
        found.append(total)
    return found


@settings(max_examples=40)
@given(data=st.data(), discount=st.sampled_from([1.0, 0.9]), gae=st.sampled_from([0.0, 0.95, 1.0]))
def test_advantages_are_the_sum_of_their_definition(data, discount, gae):
    size = 6
    number = st.lists(st.integers(-20, 20), min_size=size, max_size=size)
    flag = st.lists(st.booleans(), min_size=size, max_size=size)
    reward, value, following = (np.array(data.draw(number), float) for _ in range(3))
    terminated, truncated = (np.array(data.draw(flag)) for _ in range(2))
    found = ppo.advantages(
        *map(jnp.asarray, (reward, value, following, terminated, truncated)),
        discount=discount,
        gae=gae,
    )
    np.testing.assert_allclose(
        found,
        slow_advantages(reward, value, following, terminated, truncated, discount, gae),
        atol=1e-3,
    )


def test_a_time_limit_stops_the_sum_but_not_the_bootstrap():
    one, yes, no = jnp.ones(1), jnp.ones(1, bool), jnp.zeros(1, bool)
    paid = {"discount": 1.0, "gae": 0.95}
    assert ppo.advantages(one, one * 0, one * 7, no, yes, **paid) == 8
    assert ppo.advantages(one, one * 0, one * 7, yes, no, **paid) == 1


def test_a_rollout_follows_a_finished_episode_with_the_next():
    learner = ppo.start(jax.random.key(0), LateReward(), SMALL)
    environments, batch, ended = ppo.rollout(jax.random.key(1), learner, LateReward(), SMALL)
    assert ended.episodes == SMALL.environments * SMALL.horizon / 2
    np.testing.assert_array_equal(
        batch.terminated, np.tile([[False], [True]], (SMALL.horizon // 2, SMALL.environments))
    )
    assert not environments.age.any()


def test_a_cut_off_episode_is_truncated_and_keeps_the_value_of_its_last_state():
    config = replace(SMALL, episode_limit=3, environments=1, minibatch=8)
    learner = ppo.start(jax.random.key(0), Endless(), config)
    _, batch, ended = ppo.rollout(jax.random.key(1), learner, Endless(), config)
    np.testing.assert_array_equal(batch.truncated[:, 0], [False, False, True] * 2 + [False] * 2)
    assert not batch.terminated.any()
    # the probe shows nothing from its third state on
    expected = ppo.values(learner, jnp.zeros((2, 2)), config)
    np.testing.assert_allclose(batch.bootstrap[2, 0], expected, rtol=1e-5)
    assert ended.episodes == 2


class Endless(OneTask):
    """No end of its own."""

    def step(self, state, action):
        after, outcome = super().step(state, action)
        return after, outcome._replace(terminated=jnp.zeros((), bool))


def test_a_rollout_that_stops_at_the_end_holds_one_episode():
    config = replace(SMALL, environments=1, stop_at_end=True, minibatch=8)
    learner = ppo.start(jax.random.key(0), LateReward(), config)
    _, batch, ended = ppo.rollout(jax.random.key(1), learner, LateReward(), config)
    np.testing.assert_array_equal(batch.valid[:, 0], [True, True] + [False] * 6)
    assert ended.episodes == 1


def test_rows_behind_an_early_end_change_nothing():
    """The learner that works on a quarter of a minibatch learns what it would learn from the
    whole.
    """
    config = replace(SMALL, environments=1, stop_at_end=True, minibatch=8)
    learner = ppo.start(jax.random.key(0), LateReward(), config)
    _, batch, _ = ppo.rollout(jax.random.key(1), learner, LateReward(), config)
    flat = ppo._flat(batch, 2)
    noise = jax.random.normal(jax.random.key(2), (2, 8))
    stage = ppo.stage_values(config, learner.stage)
    narrow, *_ = ppo._epochs(jax.random.key(3), learner, flat, noise, noise, stage, config, 2)
    wide, *_ = ppo._epochs(jax.random.key(3), learner, flat, noise, noise, stage, config, 8)
    for left, right in zip(jax.tree.leaves(narrow), jax.tree.leaves(wide), strict=True):
        np.testing.assert_allclose(left, right, atol=1e-6)


def first_loss(world, monkeypatch=None):
    """Policy loss parts of the very policy that acted, with advantages that are all 1."""
    learner = ppo.start(jax.random.key(0), world, SMALL)
    _, batch, _ = ppo.rollout(jax.random.key(1), learner, world, SMALL)
    flat = ppo._flat(batch, 2)
    if monkeypatch:
        right = ppo.masked_log_softmax
        monkeypatch.setattr(
            ppo,
            "masked_log_softmax",
            lambda xp, logits, legal: right(xp, logits, jnp.ones_like(legal)),
        )
    ones = jnp.ones((2, SMALL.environments * SMALL.horizon))
    return ppo.loss(learner.parameters, flat, ones, ones, jnp.asarray(0.0), SMALL)[1]


def test_the_loss_sees_the_distribution_that_acted():
    """Before the first gradient step the ratio is 1 everywhere, so the policy's loss is minus the
    mean advantage and nothing is clipped.
    """
    parts = first_loss(ForbiddenFruit())
    np.testing.assert_allclose(parts["policy"], -1, atol=1e-5)
    assert not parts["clipped"].any()


def test_a_loss_that_forgets_the_mask_compares_two_distributions(monkeypatch):
    parts = first_loss(ForbiddenFruit(), monkeypatch)
    assert (np.abs(np.asarray(parts["policy"]) + 1) > 0.2).all()
    assert (parts["clipped"] > 0.9).all()


def test_an_illegal_action_has_no_probability_and_no_gradient():
    legal = jnp.array([True, False, True])
    log = masked_log_softmax(jnp, jnp.array([0.0, 50.0, 0.0]), legal)
    np.testing.assert_allclose(jnp.exp(log), [0.5, 0, 0.5])
    gradient = jax.grad(lambda logits: masked_log_softmax(jnp, logits, legal)[0])(
        jnp.array([0.0, 50.0, 0.0])
    )
    assert gradient[1] == 0
    assert np.isfinite(gradient).all()


@given(
    st.lists(st.booleans(), min_size=5, max_size=5).filter(any),
    st.floats(0, 1, exclude_max=True, width=32),
)
def test_a_draw_is_never_illegal(mask, uniform):
    legal = np.array(mask)
    log = masked_log_softmax(np, np.linspace(-3, 3, 5, dtype=np.float32), legal)
    assert legal[sample(np, log, np.float32(uniform))]


def test_draws_follow_the_probabilities():
    probability = np.array([0.1, 0.0, 0.6, 0.3])
    draws = sample(np, np.log(np.maximum(probability, 1e-30)), (np.arange(10_000) + 0.5) / 10_000)
    np.testing.assert_allclose(np.bincount(draws, minlength=4) / 10_000, probability, atol=1e-3)


def test_a_training_repeats_for_its_key_and_differs_for_another():
    train = jax.jit(lambda key: ppo.train(key, LateReward(), SMALL, 2)[0].parameters)
    first, again, other = (jax.tree.leaves(train(jax.random.key(seed))) for seed in (0, 0, 1))
    assert all(np.array_equal(a, b) for a, b in zip(first, again, strict=True))
    assert not all(np.array_equal(a, b) for a, b in zip(first, other, strict=True))


def test_stages_follow_each_other_and_the_last_ends_the_training():
    learner, report = jax.jit(lambda key: ppo.train(key, LateReward(), SMALL, 24))(
        jax.random.key(0)
    )
    np.testing.assert_array_equal(report.stage, [0] * 12 + [1] * 12)
    assert learner.stage == len(SMALL.stages)
    assert learner.steps == 24 * 512


def test_an_update_after_the_end_of_an_episode_budget_changes_nothing():
    config = replace(
        SMALL,
        environments=1,
        stop_at_end=True,
        minibatch=8,
        stages=(replace(SMALL.stages[0], steps=None, episodes=3),),
    )
    run = jax.jit(
        lambda key, updates: ppo.train(key, LateReward(), config, updates), static_argnums=1
    )
    (done, _), (longer, _) = run(jax.random.key(0), 3), run(jax.random.key(0), 6)
    assert done.episodes == longer.episodes == 3
    assert all(
        np.array_equal(a, b)
        for a, b in zip(
            jax.tree.leaves(done.parameters), jax.tree.leaves(longer.parameters), strict=True
        )
    )


@pytest.mark.parametrize("shared", [False, True])
def test_an_agent_learns_from_its_own_observation_and_reward_only(shared):
    """Independent: the gradient of one agent's loss does not reach the other's networks, unless
    they are shared on request.
    """
    config = replace(SMALL, share_actor=shared, share_critic=shared)
    learner = ppo.start(jax.random.key(0), LateReward(), config)
    _, batch, _ = ppo.rollout(jax.random.key(1), learner, LateReward(), config)
    flat, ones = ppo._flat(batch, 2), jnp.ones((2, 512))

    def only_robot(parameters):
        nothing = jnp.asarray(0.0)
        return ppo.loss(parameters, flat, ones.at[1].set(0), ones, nothing, config)[1]["value"][0]

    gradient = jax.grad(only_robot)(learner.parameters)["critic"]["0"]["weight"]
    if shared:
        assert gradient.any()
    else:
        assert gradient[0].any()
        assert not gradient[1].any()
