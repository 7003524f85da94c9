"""A foreign learner beside a person, as a client would use it: the example of sb3-contrib's
MaskablePPO on the event world.
"""

from __future__ import annotations

import runpy
from pathlib import Path

import numpy as np
import pytest

from tandem.files.load import load

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def test_the_example_measures_a_player_of_ones_own():
    """Without sb3: what the example measures is right. Who always takes the first legal way beside
    a compliant human needs 26 s.
    """
    import gymnasium

    import tandem.envs  # noqa: F401 (makes the environment known)

    mean_makespan = runpy.run_path(str(EXAMPLES / "sb3_robot_beside_human.py"))["mean_makespan"]
    env = gymnasium.make("tandem/RobotBesideHuman-v0", cell=load(EXAMPLES / "thesis.yaml"))
    first_task = lambda seen: int(np.flatnonzero(seen["action_mask"])[seen["action_mask"][0]])  # noqa: E731
    assert mean_makespan(env, first_task, 2) == 26.0


@pytest.mark.slow
def test_maskable_ppo_learns_beside_a_random_chooser():
    """Within a second of the exact 24.167 s, well before what random legal actions take."""
    pytest.importorskip("sb3_contrib", reason="pip install 'tandem[sb3]' to run it")
    learn = runpy.run_path(str(EXAMPLES / "sb3_robot_beside_human.py"))["learn"]
    found = learn(
        load(EXAMPLES / "thesis.yaml"), person="random:0.5", steps=25_000, episodes=200, seed=0
    )
    assert found.makespan < 25.2
    assert found.makespan < found.random - 1
