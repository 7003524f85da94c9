"""Robot and human side by side for PettingZoo: the official suites, and what happens when the two
do not fit.
"""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from pettingzoo.test import api_test, parallel_api_test, parallel_seed_test
from pettingzoo.utils import parallel_to_aec

import tandem.envs
from tandem.errors import CellError, UsageError
from tandem.files.validate import cell_of

PAIR = cell_of(
    {
        "operators": {"robot": {"kind": "robot"}, "human": {"kind": "human"}},
        "tasks": {
            "a": {"time": {"robot": 3, "human": 4}, "difficulty": {"robot": 1, "human": 2}},
            "b": {
                "time": {"human": 5},
                "together": [{"operators": ["robot", "human"], "time": 2}],
                "difficulty": {"robot": 1, "human": 2},
            },
        },
    }
)


@pytest.mark.parametrize("cell", ["examples/alternator.yaml", "examples/thesis.yaml"])
def test_pettingzoos_own_suites_are_green(cell: str, capsys: pytest.CaptureFixture[str]) -> None:
    def make() -> tandem.lab.zhang2022.parallel.DuoParallel:
        return tandem.envs.parallel_env("duo", cell, spread=0.3, change=0.5)

    with warnings.catch_warnings():
        # masks in the observation mean a Dict, which the AEC suite notes
        warnings.filterwarnings("ignore", message="Observation")
        parallel_api_test(make(), num_cycles=100)
        parallel_seed_test(make, num_cycles=50)
        api_test(parallel_to_aec(make()), num_cycles=60)
    assert "Passed" in capsys.readouterr().out


def test_a_random_player_assembles_the_product_and_hears_of_the_change() -> None:
    env, random, heard = (
        tandem.envs.parallel_env("duo", "examples/alternator.yaml", change=1.0),
        np.random.default_rng(0),
        set(),
    )
    for seed in range(12):
        observations, infos = env.reset(seed=seed)
        while env.agents:
            actions = {
                agent: int(random.choice(np.flatnonzero(seen["action_mask"])))
                for agent, seen in observations.items()
            }
            observations, _, terminated, _, infos = env.step(actions)
            assert not any(info["illegal"] for info in infos.values())
        assert all(terminated.values())
        assert infos["human_0"]["time"] >= 123
        heard.add(infos["human_0"]["happened"].split(" ")[-1])
    assert len(heard) > 1


def test_the_human_goes_first_and_the_robot_joins_or_yields() -> None:
    env = tandem.envs.parallel_env("duo", PAIR)
    env.reset(seed=0)
    assert env.ways("robot_0") == ["wait", "a by robot", "b by robot and human", ""]
    assert env.ways("human_0") == ["wait", "a by human", "b by human", "b by robot and human"]
    _, rewards, _, _, infos = env.step({"robot_0": 1, "human_0": 3})
    assert infos["robot_0"]["yielded"], "the human asked it to join"
    assert (infos["robot_0"]["time"], infos["robot_0"]["difficulty"]) == (2, 3)
    assert rewards == {"robot_0": -(1 + 1), "human_0": -(1 + 2)}
    _, _, terminated, _, infos = env.step({"robot_0": 1, "human_0": 1})
    assert infos["robot_0"]["yielded"]
    assert terminated == {"robot_0": True, "human_0": True}


def test_what_the_mask_forbids_is_said_and_not_done() -> None:
    env = tandem.envs.parallel_env("duo", PAIR)
    env.reset(seed=0)
    env.step({"robot_0": 0, "human_0": 1})
    _, _, _, _, infos = env.step({"robot_0": 0, "human_0": 1})
    assert infos["human_0"]["illegal"], (
        "a is done; b by the human alone was taken, the lowest that is legal"
    )
    assert infos["human_0"]["time"] == 4 + 5
    assert infos["human_0"]["is_success"]


def test_a_strict_face_refuses_what_the_mask_forbids_and_nothing_happens() -> None:
    env = tandem.envs.parallel_env("duo", PAIR, strict=True)
    env.reset(seed=0)
    env.step({"robot_0": 0, "human_0": 1})
    with pytest.raises(
        UsageError,
        match=r"illegal at 4 s: human_0 named 1 \(a by human\); legal are 2, 3\. Take an action",
    ):
        env.step({"robot_0": 0, "human_0": 1})
    assert env.step({"robot_0": 0, "human_0": 2})[4]["human_0"]["time"] == 4 + 5


def test_bad_options_and_cells_are_named() -> None:
    with pytest.raises(UsageError, match="change 3"):
        tandem.envs.parallel_env("duo", PAIR, change=3)
    with pytest.raises(CellError, match="1 robot and 2 humans"):
        tandem.envs.parallel_env("duo", "examples/gearbox.yaml")
