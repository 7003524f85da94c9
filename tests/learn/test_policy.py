"""Policies decide in NumPy: the same as in JAX, without it, and quickly."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace

import jax
import numpy as np
import pytest
from tests.learn import tiny

import tandem
from tandem.errors import CellError, UsageError
from tandem.lab.kinat2023.learn_env import StationWorld
from tandem.learn.policy import Policy
from tandem.learn.ppo import ppo
from tandem.learn.ppo.config import Config, Stage
from tandem.learn.settings import read
from tandem.learn.training.agents import PPO


def made(
    shared: bool = False, masked: bool = True
) -> tuple[Policy, ppo.Learner, StationWorld, Config]:
    """An untrained policy of the thesis's cell and the learner it comes from."""
    config = replace(tiny.RECIPE.config, share_actor=shared, masked=masked)
    world = StationWorld.of(tandem.load(tiny.CELL), tiny.RECIPE, stress_factor=1)
    learner = ppo.start(jax.random.key(0), world, config)
    lively = jax.tree.map(lambda leaf: leaf * 20, learner.parameters["actor"])
    actor = jax.tree.map(np.asarray, lively)
    learner = learner._replace(parameters={**learner.parameters, "actor": lively})
    return (
        Policy(
            world.agents,
            actor,
            config.activation,
            masked,
            shared,
            {"pace": "decisions", "sees": "normalised"},
        ),
        learner,
        world,
        config,
    )


@pytest.mark.parametrize("shared", [False, True])
def test_numpy_and_jax_agree(shared):
    policy, learner, world, config = made(shared)
    state = world.reset(jax.random.key(0))
    seen = world.observe(state)
    expected = ppo._forward(learner.parameters, "actor", seen, config)
    np.testing.assert_allclose(policy.logits(np.asarray(seen)), expected, atol=1e-4)
    for row, agent in enumerate(policy.agents):
        np.testing.assert_allclose(
            policy.logits(np.asarray(seen)[row], agent), expected[row], atol=1e-4
        )


def test_the_greedy_action_is_the_best_legal_one_and_draws_are_legal():
    policy, _, world, _ = made()
    seen = np.asarray(world.observe(world.reset(jax.random.key(0))))
    masks = np.zeros((2, 8), np.int8)
    masks[:, [2, 5]] = 1
    actions, state = policy.predict(seen, action_masks=masks)
    assert state is None
    logits = policy.logits(seen)
    assert actions.tolist() == [2 if row[2] > row[5] else 5 for row in logits]
    generator = np.random.default_rng(0)
    drawn = [
        policy.predict(seen, action_masks=masks, deterministic=False, generator=generator)[0]
        for _ in range(50)
    ]
    assert set(np.ravel(drawn)) <= {2, 5}


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({}, "say which are legal"),
        ({"action_masks": np.zeros((2, 8))}, "at least one legal action"),
        ({"action_masks": np.ones(8)}, r"must be \(2, 8\)"),
        (
            {"action_masks": np.ones(8), "agent": "robot"},
            "agent 'robot': this policy knows robot_0, human_0",
        ),
    ],
)
def test_what_does_not_fit_is_refused(options, message):
    policy, _, world, _ = made()
    with pytest.raises(UsageError, match=message):
        policy.predict(np.asarray(world.observe(world.reset(jax.random.key(0)))), **options)


def test_a_saved_policy_comes_back_whole(tmp_path):
    policy, *_ = made()
    back = Policy.load(policy.save(tmp_path / "policy.safetensors"))
    assert back.agents == policy.agents
    assert back.notes == policy.notes
    assert all(
        np.array_equal(a, b)
        for a, b in zip(jax.tree.leaves(back.actor), jax.tree.leaves(policy.actor), strict=True)
    )


def test_a_file_that_is_no_policy_is_refused(tmp_path):
    (tmp_path / "policy.safetensors").write_bytes(b"not one")
    with pytest.raises(CellError, match="no policy that can be read"):
        Policy.load(tmp_path / "policy.safetensors")


def test_deciding_loads_no_jax(tmp_path):
    policy, _, world, _ = made()
    policy.save(tmp_path / "policy.safetensors")
    program = f"""
import json, sys
import numpy as np
sys.modules["jax"] = None                      # importing it would now fail
from tandem.learn import PPO
agents = PPO.load({str(tmp_path / "policy.safetensors")!r})
seen = np.array({np.asarray(world.observe(world.reset(jax.random.key(0)))).tolist()})
actions, _ = agents.predict(seen, action_masks=np.ones((2, 8)))
del sys.modules["jax"]
loaded = [name for name in sys.modules if name.split(".")[0] in ("jax", "optax")]
print(json.dumps([actions.tolist(), loaded]))
"""
    out = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    actions, loaded = json.loads(out.stdout)
    assert loaded == []
    seen = np.asarray(world.observe(world.reset(jax.random.key(0))))
    assert actions == policy.predict(seen, action_masks=np.ones((2, 8)))[0].tolist()


def test_learn_predict_save_load(tmp_path):
    cell = tandem.load(tiny.CELL)
    agents = PPO(cell, stress_factor=5, seed=1)
    agents.recipe = tiny.RECIPE
    with pytest.raises(UsageError, match="learned nothing yet"):
        agents.save(tmp_path / "p.safetensors")
    agents.learn(6 * 128)
    assert agents.result["seeds"][0]["steps"] == 6 * 128
    world = StationWorld.of(cell, tiny.RECIPE)
    state = world.reset(jax.random.key(0))
    seen, masks = np.asarray(world.observe(state)), np.asarray(world.legal(state))
    back = PPO.load(agents.save(tmp_path / "p.safetensors"))
    assert (
        back.predict(seen, action_masks=masks)[0].tolist()
        == agents.predict(seen, action_masks=masks)[0].tolist()
    )
    with pytest.raises(UsageError, match="no cell to learn on"):
        back.learn()


def test_a_recipe_in_episodes_takes_no_number_of_steps():
    with pytest.raises(UsageError, match="counts episodes"):
        PPO(tandem.load(tiny.CELL), recipe_name="thesis").learn(1000)


def test_what_a_configuration_must_be_is_said_all_at_once():
    with pytest.raises(UsageError, match="episodes and steps: says neither"):
        Stage()
    with pytest.raises(UsageError, match=r"(?s)stages.*horizon 0.*clip 2.*activation 'swish'"):
        Config(stages=(), horizon=0, clip=2, activation="swish")
    assert read(Config, json.loads(json.dumps(tiny.RECIPE.config.to_dict()))) == tiny.RECIPE.config
