"""A learner first solves worlds whose answer is known; one with a broken part must not."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from tests.learn.probes import SEEDS, SMALL, SOLVED, ForbiddenFruit, LateReward, OneBestAssignment

from tandem.learn.ppo import play, ppo
from tandem.learn.ppo.config import Config


def trained(world: Any, config: Config = SMALL) -> tuple[np.ndarray, np.ndarray]:
    """Return of the greedy policies `[seed, A]` and rules broken, after a training of 24 updates a
    seed.
    """

    def one(key: jax.Array) -> tuple[jax.Array, jax.Array]:
        learner, _ = ppo.train(key, world, config, 24)
        played = play.greedy(learner.parameters, world, config, 8)
        return played.returns[0], played.illegal[0]

    returns, illegal = jax.jit(jax.vmap(one))(jax.random.split(jax.random.key(0), SEEDS))
    return np.asarray(returns), np.asarray(illegal)


@pytest.mark.parametrize("world", SOLVED, ids=lambda world: world.__name__)
def test_every_seed_solves_the_probe(world: Any) -> None:
    returns, illegal = trained(world())
    np.testing.assert_allclose(returns, SOLVED[world], atol=1e-5)
    assert not illegal.any()


def test_an_advantage_that_looks_one_step_ahead_only_fails_the_late_reward(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(ppo, "advantages", lambda reward, value, *_, **__: reward - value)
    returns, _ = trained(LateReward())
    assert (returns < 0.5).any()


def test_an_advantage_of_the_wrong_sign_fails_every_seed(monkeypatch: pytest.MonkeyPatch) -> None:
    right = ppo.advantages
    monkeypatch.setattr(
        ppo, "advantages", lambda *arguments, **options: -right(*arguments, **options)
    )
    returns, _ = trained(LateReward())
    assert (returns.min(1) < 0.5).all()


def test_a_mask_that_allows_everything_eats_the_forbidden_fruit(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(ForbiddenFruit, "legal", lambda self, state: jnp.ones((2, 3), bool))
    _, illegal = trained(ForbiddenFruit())
    assert illegal.any()


def test_parameter_sharing_tells_the_agents_apart() -> None:
    """Robot and human must act differently although one network decides for both."""
    from dataclasses import replace

    returns, _ = trained(OneBestAssignment(), replace(SMALL, share_actor=True, share_critic=True))
    np.testing.assert_allclose(returns, 1, atol=1e-5)
