"""What PPO does on request as the thesis's toolbox has it: channels, small weights, a start at full
size, and an end by the return.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("jax", reason="learning needs the extra tandem[learn]")

import jax
import jax.numpy as jnp

from tandem.errors import UsageError
from tandem.lab.kinat2023.game import thesis_cell
from tandem.lab.kinat2023.learn_env import StationWorld
from tandem.lab.kinat2023.recipe import APPENDIX, STATION, THESIS, TOOLBOX
from tandem.learn.networks import forward, init, joined
from tandem.learn.ppo import ppo


def test_a_first_layer_for_each_channel_is_one_layer_of_blocks():
    draws = np.random.default_rng(0)
    network = init(lambda shape: draws.uniform(-1, 1, shape), (5, 3, 4), channels=(1, 4))
    seen = draws.normal(size=(6, 5))
    whole = joined(network)
    assert np.allclose(
        forward(np, network, seen, "relu"), forward(np, whole, seen, "relu"), atol=1e-12
    )
    assert whole["0"]["weight"].shape == (5, 6)
    assert np.count_nonzero(whole["0"]["weight"]) == 3 * 5
    assert joined(whole) == whole


def test_the_channels_of_the_thesis_are_all_that_it_sees():
    world = StationWorld.of(thesis_cell(), THESIS)
    assert world.channels == (1, 1, 7, 7, 7, 49)
    assert sum(world.channels) == world.observation_size
    assert StationWorld.of(thesis_cell(), STATION).channels == ()


def test_the_toolbox_begins_at_full_size_with_a_layer_a_channel():
    world = StationWorld.of(thesis_cell(), TOOLBOX)
    actors = [
        ppo.start(jax.random.key(0), world, recipe.config).parameters["actor"]
        for recipe in (THESIS, TOOLBOX)
    ]
    assert {name: part["weight"].shape for name, part in actors[1]["0"].items()} == {
        str(index): (2, size, 256) for index, size in enumerate(world.channels)
    }
    assert actors[1]["1"]["weight"].shape == (2, 6 * 256, 256)
    largest = [float(jnp.abs(actor["2"]["weight"]).max()) for actor in actors]
    assert largest[1] > 50 * largest[0]


def test_l2_pulls_weights_and_leaves_biases():
    """Where the loss is flat, Adam's first step is of size 1 towards 0, for weights alone."""
    config = replace(THESIS.config, l2=1e-2)
    network = {"0": {"weight": jnp.array([[2.0, -3.0]]), "bias": jnp.array([1.0, 1.0])}}
    flat = jax.tree.map(jnp.zeros_like, network)
    moves, _ = ppo.optimiser(config).update(flat, ppo.optimiser(config).init(network), network)
    assert np.allclose(moves["0"]["weight"], [[1.0, -1.0]], atol=1e-2)
    assert np.array_equal(moves["0"]["bias"], [0.0, 0.0])


@pytest.mark.parametrize(("stop", "stages"), [(-1e6, 3), (1000.0, 0)])
def test_a_stage_ends_with_an_episode_that_pays_enough(stop, stages):
    """Every episode pays more than minus a million, none pays 1000."""
    short = tuple(replace(stage, stop_return=stop) for stage in THESIS.config.stages)
    config = replace(
        THESIS.config, stages=short, hidden=(8,), episode_limit=20, horizon=32, minibatch=32
    )
    world = StationWorld.of(thesis_cell(), THESIS)
    learner, _ = ppo.train(jax.random.key(0), world, config, 4)
    assert int(learner.episodes) >= 3
    assert int(learner.stage) == stages


def test_the_recipe_as_written_has_none_of_it():
    config = THESIS.config
    assert (config.adam_epsilon, config.l2, config.small_start, config.layer_per_channel) == (
        1e-5,
        0.0,
        0.01,
        False,
    )
    assert {stage.stop_return for stage in config.stages} == {None}
    assert [(stage.episodes, stage.entropy) for stage in APPENDIX.config.stages] == [
        (800, 0.7),
        (1300, 0.01),
    ]


def test_a_shared_network_has_no_channels():
    with pytest.raises(UsageError, match="layer_per_channel"):
        replace(THESIS.config, layer_per_channel=True, share_actor=True)
