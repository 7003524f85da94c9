"""The standard faces: the official suites, random players as clients, masks that tell the truth,
pictures.
"""

from __future__ import annotations

import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.wrappers import RecordEpisodeStatistics
from pettingzoo.test import api_test, parallel_api_test, parallel_seed_test
from pettingzoo.utils import parallel_to_aec
from tests.lab.conftest import random_cell
from tests.lab.kinat2023.test_thesis_quirks import PUBLISHED

import tandem.envs
from tandem.errors import CellError, UsageError
from tandem.files.load import dump
from tandem.lab.kinat2023 import Rewards
from tandem.lab.kinat2023.episode import actions_of
from tandem.schedule.checker import faults

WAYS = [(by, seen) for by in ("ticks", "decisions") for seen in ("thesis", "scaled", "normalised")]
KEYS = {
    "action_mask",
    "time",
    "makespan",
    "stress",
    "stress_rate",
    "task_started",
    "task_finished",
    "idle",
    "illegal",
    "is_success",
}


@pytest.mark.parametrize(("by", "seen"), WAYS)
def test_pettingzoos_own_suites_are_green(thesis, by, seen, capsys):
    def make():
        return tandem.envs.parallel_env("thesis", thesis, by=by, observation=seen)

    with warnings.catch_warnings():
        warnings.filterwarnings("error", message=".*action_mask.*")
        # masks in the observation mean a Dict, which the AEC suite notes
        warnings.filterwarnings("ignore", message="Observation")
        parallel_api_test(make(), num_cycles=500)
        parallel_seed_test(make, num_cycles=100)
        api_test(parallel_to_aec(make()), num_cycles=300)
    assert "Passed" in capsys.readouterr().out


@pytest.mark.parametrize(("by", "seen"), WAYS)
def test_gymnasiums_own_checker_is_green(thesis, by, seen):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(
            gymnasium.make("tandem/Thesis-v0", cell=thesis, by=by, observation=seen).unwrapped,
            skip_render_check=True,
        )


@pytest.mark.parametrize("mode", ["ansi", "rgb_array"])
def test_gymnasiums_checker_accepts_both_pictures(pair, mode):
    check_env(gymnasium.make("tandem/Thesis-v0", cell=pair, render_mode=mode).unwrapped)


@pytest.mark.parametrize("by", ["ticks", "decisions"])
def test_a_random_player_assembles_the_product(thesis, by):
    """The example of the documentation: masks from the observation, spaces sample with them."""
    env = tandem.envs.parallel_env("thesis", thesis, by=by)
    for seed in range(10):
        observations, infos = env.reset(seed=seed)
        for agent in env.agents:
            env.action_space(agent).seed(seed)
        while env.agents:
            actions = {
                agent: env.action_space(agent).sample(observations[agent]["action_mask"])
                for agent in env.agents
            }
            observations, _, terminated, truncated, infos = env.step(actions)
            assert not any(info["illegal"] for info in infos.values())
            for agent, seen in observations.items():
                assert env.observation_space(agent).contains(seen)
                np.testing.assert_array_equal(seen["action_mask"], infos[agent]["action_mask"])
                np.testing.assert_array_equal(seen["action_mask"], env.action_masks()[agent])
                assert set(infos[agent]) - {"episode"} == KEYS
        assert all(terminated.values()) != all(truncated.values())
        if all(terminated.values()):
            assert faults(thesis, env.game.schedule()) == []
            assert infos["robot_0"]["is_success"]
            assert set(infos["robot_0"]["episode"]) == {"r", "l", "t"}


@pytest.mark.parametrize("by", ["ticks", "decisions"])
@pytest.mark.parametrize("seed", range(5))
def test_a_random_controller_of_both_makes_sound_schedules(seed, by):
    cell = random_cell(seed, 6, 5)
    env = gymnasium.make("tandem/Thesis-v0", cell=cell, by=by)
    rng = np.random.default_rng(seed)
    for _ in range(5):
        observation, info = env.reset(seed=seed)
        ended, total = False, 0.0
        while not ended:
            action = int(
                (observation["action_mask"] * rng.random(observation["action_mask"].shape)).argmax()
            )
            observation, reward, ended, cut, info = env.step(action)
            total += reward
            assert not info["illegal"]
            assert not cut
            assert set(info) == KEYS
            assert observation["action_mask"].any() or ended
        schedule = env.unwrapped.game.schedule()
        assert faults(cell, schedule) == []
        assert total == 2 * (-10 * info["makespan"] + 50)


def test_returns_of_both_faces_agree_on_the_published_schedule(thesis):
    """Joint actions in the single view, two actions in PettingZoo: one world, the same sums."""
    actions = actions_of(thesis, PUBLISHED[5, 24, 3])
    single = gymnasium.make("tandem/Thesis-v0", cell=thesis, by="ticks", stress_factor=5.0)
    double = tandem.envs.parallel_env("thesis", thesis, stress_factor=5.0)
    single.reset(seed=0)
    double.reset(seed=0)
    sums = np.zeros(2)
    for robot, human in actions:
        _, reward, ended, _, info = single.step(robot * 8 + human)
        _, rewards, terminated, _, _ = double.step({"robot_0": robot, "human_0": human})
        sums += (reward, sum(rewards.values()))
    assert ended
    assert all(terminated.values())
    assert (info["time"], info["stress"]) == (24, 3)
    assert sums[0] == sums[1] == -245


def test_one_decision_at_a_time_asks_the_human_first_and_time_stands_still(thesis):
    env = gymnasium.make("tandem/Thesis-v0", cell=thesis).unwrapped
    observation, _ = env.reset()
    assert observation["observation"][:2].tolist() == [0, 1]
    observation, reward, _, _, info = env.step(1)
    assert (reward, info["time"], info["task_started"]) == (0, 0, ("", ""))
    assert observation["observation"][:10].tolist() == [1, 0, 0, 1, 0, 0, 0, 0, 0, 0]
    assert observation["action_mask"].tolist() == [1, 0, 1, 0, 0, 0, 0, 0]
    _, reward, _, _, info = env.step(2)
    # nobody can go on at 7 s
    assert (reward, info["time"], info["task_started"], info["task_finished"]) == (
        -200,
        10,
        ("2", "1"),
        ("2", "1"),
    )


def test_who_has_only_one_choice_is_not_asked():
    """The robot can do nothing but task 1: once the human has it, the robot waits without a
    turn.
    """
    env = gymnasium.make("tandem/Thesis-v0", cell=random_cell(0, 1, 3)).unwrapped
    env.reset()
    steps = 0
    while not env.game.done:
        env.step(int(env.action_masks()[1:].argmax()) + 1)
        steps += 1
    assert steps == 1


def test_an_illegal_action_costs_what_the_rewards_say_and_is_told(pair):
    env = tandem.envs.parallel_env("thesis", pair)
    env.reset()
    _, rewards, _, _, infos = env.step({"robot_0": 3, "human_0": 2})
    assert rewards == {"robot_0": -10 - 20, "human_0": -10}
    assert (infos["robot_0"]["illegal"], infos["human_0"]["illegal"]) == (True, False)


def test_a_task_that_there_is_not_breaks_one_rule_and_two_while_busy(pair):
    env = tandem.envs.parallel_env("thesis", pair)
    env.reset()
    assert env.step({"robot_0": -1, "human_0": 4})[1] == {"robot_0": -10 - 10, "human_0": -10 - 10}
    env.step({"robot_0": 1, "human_0": 0})
    _, rewards, _, _, infos = env.step({"robot_0": 10**12, "human_0": 0})
    assert rewards["robot_0"] == -10 - 20
    assert infos["robot_0"]["illegal"]


@pytest.mark.parametrize("action", [-1, 4, 10**9])
def test_a_human_who_names_no_task_is_not_shown_to_the_robot_as_naming_one(pair, action):
    env = gymnasium.make("tandem/Thesis-v0", cell=pair).unwrapped
    env.reset()
    observation, reward, _, _, info = env.step(action)
    assert (reward, info["illegal"], observation["observation"][:6].tolist()) == (
        0,
        True,
        [1, 0, 0, 0, 0, 0],
    )
    assert env.step(1)[1] == -60 - 10, "three ticks of both, and the rule that the human broke"


def test_strict_raises_with_what_is_legal(pair):
    env = tandem.envs.parallel_env("thesis", pair, strict=True)
    env.reset()
    with pytest.raises(
        UsageError,
        match=(
            r"illegal at 0 s: robot_0 named 3 \(c\); legal are 0, 1, 2\. Take an action from"
            r" action_masks"
        ),
    ):
        env.step({"robot_0": 3, "human_0": 2})
    single = gymnasium.make("tandem/Thesis-v0", cell=pair, strict=True)
    single.reset()
    with pytest.raises(UsageError, match="human named 3; legal are 0, 1, 2"):
        single.step(3)


def test_the_limit_cuts_off_and_is_no_end(thesis):
    env = tandem.envs.parallel_env("thesis", thesis, limit=5)
    env.reset()
    for _ in range(5):
        _, _, terminated, truncated, infos = env.step({"robot_0": 0, "human_0": 0})
    assert not any(terminated.values())
    assert all(truncated.values())
    assert env.agents == []
    assert not infos["human_0"]["is_success"]
    assert infos["human_0"]["idle"] == 1


def test_gymnasiums_statistics_wrapper_works(pair):
    env = RecordEpisodeStatistics(gymnasium.make("tandem/Thesis-v0", cell=pair))
    env.reset()
    info, ended = {}, False
    while not ended:
        _, _, ended, _, info = env.step(int(env.unwrapped.action_masks().argmax()))
    assert info["episode"]["l"] > 0


def test_the_text_gantt_reads_like_the_schedule(thesis):
    env = tandem.envs.parallel_env("thesis", thesis, render_mode="ansi")
    env.reset()
    for robot, human in actions_of(thesis, PUBLISHED[1, 23, 7]):
        env.step({"robot_0": robot, "human_0": human})
    assert env.render() == (
        "      0         10        20\n"
        "robot 1-------|2-----|4|   7|\n"
        "human 3========|5|      6=|\n"
    )  # fmt: skip


def test_the_picture_shows_more_when_more_was_done(thesis):
    env = tandem.envs.parallel_env("thesis", thesis, render_mode="rgb_array")
    env.reset()
    empty = env.render()
    env.step({"robot_0": 1, "human_0": 3})
    # illegal: the task in hand stretches, and that can be drawn too
    env.step({"robot_0": 2, "human_0": 0})
    begun = env.render()
    assert empty.shape == begun.shape
    assert empty.dtype == np.uint8
    assert (empty != begun).any()


def test_without_a_render_mode_nothing_is_drawn(thesis):
    env = tandem.envs.parallel_env("thesis", thesis)
    env.reset()
    assert env.render() is None


def test_rewards_of_ones_own_and_a_cell_from_a_file(pair, tmp_path):
    dump(pair, tmp_path / "pair.yaml")
    mine = Rewards(
        step=0.0, task_done=1.0, illegal=-1.0, idle=-0.5, all_done=0.0, stress_factor=0.0
    )
    env = tandem.envs.parallel_env("thesis", tmp_path / "pair.yaml", rewards=mine)
    env.reset()
    assert env.step({"robot_0": 1, "human_0": 0})[1] == {"robot_0": 0.0, "human_0": -0.5}


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"by": "tick"}, "by='tick' is unknown. Did you mean 'ticks'"),
        ({"observation": "raw"}, "observation='raw' is unknown"),
        ({"render_mode": "human"}, "Choose from None, 'ansi', 'rgb_array'"),
        ({"limit": 0}, "at least one tick"),
        ({"rewards": "table-5-2"}, "Did you mean 'table_5_2'"),
    ],
)
def test_options_that_do_not_exist_are_met_with_those_that_do(thesis, options, message):
    with pytest.raises(UsageError, match=message):
        tandem.envs.parallel_env("thesis", thesis, **options)


def test_an_unknown_environment_is_met_with_the_nearest(thesis):
    with pytest.raises(UsageError, match="Did you mean 'thesis'"):
        tandem.envs.parallel_env("theses", thesis)


def test_a_cell_beyond_the_thesis_is_refused_with_the_reason(thesis):
    two_robots = thesis.replace(operators={"robot": {"kind": "robot"}, "human": {"kind": "robot"}})
    with pytest.raises(CellError, match="2 robots and 0 humans"):
        tandem.envs.parallel_env("thesis", two_robots)
