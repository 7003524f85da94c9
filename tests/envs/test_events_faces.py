"""The event world's standard faces: the official suites, random players as clients, seeds, masks,
people and chance.
"""

from __future__ import annotations

import subprocess
import sys
import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from pettingzoo.test import api_test, parallel_api_test, parallel_seed_test
from pettingzoo.utils import parallel_to_aec
from tests.plan.test_judges import two_parts

import tandem.envs
from tandem.cell.model import Cell
from tandem.errors import UsageError
from tandem.files.validate import cell_of
from tandem.schedule.checker import faults
from tandem.world.randomness import Chance

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
WILD = {
    "person": "random:0.3+forgetful:0.2+refusing:0.1+pace:0.8..2",
    "chance": Chance("lognormal", cv=0.2, failure_s=30.0, repair_s=4.0),
}


@pytest.fixture(scope="module")
def crew_of_three() -> Cell:
    """Two robots and a human, a joint way, a tool to change and a zone."""
    return cell_of(
        {
            "operators": {
                "arm": {"kind": "robot"},
                "cart": {"kind": "robot"},
                "anna": {"kind": "human", "tool": "wrench"},
            },
            "tools": {"driver": {"changeover": {"anna": 2.0}}},
            "zones": {"jig": {"capacity": 1}},
            "tasks": {
                "1": {"time": {"arm": 3.0, "anna": 4.0}, "stress": 2.0, "zone": "jig"},
                "2": {
                    "time": {"cart": 5.0},
                    "together": [{"operators": ["arm", "anna"], "time": 3.0, "stress": 1.0}],
                },
                "3": {
                    "time": {"anna": 2.0, "cart": 4.0},
                    "stress": 3.0,
                    "after": ["1"],
                    "tool": "driver",
                },
                "4": {"time": {"arm": 2.0, "cart": 2.0}, "after": ["1", "2"], "zone": "jig"},
            },
        }
    )


@pytest.mark.parametrize("options", [{}, WILD], ids=["nominal", "wild"])
def test_pettingzoos_own_suites_are_green(crew_of_three: Cell, options, capsys):
    def make():
        return tandem.envs.parallel_env("events", crew_of_three, **options)

    with warnings.catch_warnings():
        warnings.filterwarnings("error", message=".*action_mask.*")
        # masks in the observation mean a Dict, which the AEC suite notes
        warnings.filterwarnings("ignore", message="Observation")
        parallel_api_test(make(), num_cycles=100)
        parallel_seed_test(make, num_cycles=20)
        api_test(parallel_to_aec(make()), num_cycles=60)
    assert "Passed" in capsys.readouterr().out


@pytest.mark.parametrize(
    "options", [{}, {"asks": False}, WILD], ids=["nominal", "asks nobody", "wild"]
)
def test_gymnasiums_own_checker_is_green(thesis: Cell, options):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(
            gymnasium.make("tandem/RobotBesideHuman-v0", cell=thesis, **options).unwrapped,
            skip_render_check=True,
        )


@pytest.mark.parametrize("mode", ["ansi", "rgb_array"])
def test_gymnasiums_checker_accepts_both_pictures(pair: Cell, mode):
    check_env(gymnasium.make("tandem/RobotBesideHuman-v0", cell=pair, render_mode=mode).unwrapped)


def played(
    env: gymnasium.Env, seed: int, chooses: int = 0
) -> tuple[list[float], dict, list[np.ndarray]]:
    """An episode under random legal actions: rewards, the last info, observations."""
    rng = np.random.default_rng(chooses)
    observation, info = env.reset(seed=seed)
    rewards, seen, ended, cut = [], [observation["observation"]], False, False
    while not (ended or cut):
        assert env.observation_space.contains(observation)
        np.testing.assert_array_equal(observation["action_mask"], info["action_mask"])
        np.testing.assert_array_equal(observation["action_mask"], env.unwrapped.action_masks())
        observation, reward, ended, cut, info = env.step(
            int(rng.choice(np.flatnonzero(observation["action_mask"])))
        )
        assert not info["illegal"]
        assert set(info) == KEYS | {"turn"}
        rewards.append(reward)
        seen.append(observation["observation"])
    return rewards, info, seen


@pytest.mark.parametrize("seed", range(3))
def test_a_random_robot_beside_a_compliant_human_makes_sound_schedules(crew_of_three: Cell, seed):
    env = gymnasium.make("tandem/RobotBesideHuman-v0", cell=crew_of_three, stress_factor=0.5)
    rewards, info, _ = played(env, seed, chooses=seed)
    assert info["is_success"]
    assert faults(crew_of_three, env.unwrapped.game.schedule()) == []
    assert sum(rewards) == pytest.approx(-info["makespan"] - 0.5 * info["stress"])


def test_the_same_seed_is_the_same_episode_and_another_is_another(thesis: Cell):
    env = gymnasium.make("tandem/RobotBesideHuman-v0", cell=thesis, **WILD)
    first, again, other = (played(env, seed)[0] for seed in (1, 1, 2))
    assert first == again != other


def test_who_is_not_asked_goes_by_the_instruction_sheet(thesis: Cell):
    """Every turn is the robot's, and the human goes on by itself; a slow one takes the time that it
    takes.
    """
    env = gymnasium.make(
        "tandem/RobotBesideHuman-v0", cell=thesis, asks=False, person="pace:2"
    ).unwrapped
    _, info = env.reset(seed=0)
    turns, ended = set(), False
    while not ended:
        turns.add(info["turn"])
        _, _, ended, _, info = env.step(int(np.flatnonzero(env.action_masks())[-1]))
    assert turns == {"robot"}
    human = env.game.schedule().of("human")
    assert all(a.end - a.start == 2 * thesis.tasks[a.task].time["human"] for a in human)


def test_a_machine_is_an_agent_by_its_kind_and_holds_its_part():
    env = tandem.envs.parallel_env("events", two_parts())
    assert env.possible_agents == ["machine_0", "human_0", "human_1"]
    names = env.unwrapped.game.names
    env.reset(seed=0)
    first = {"human_0": 1 + names.way("in 1", ["anna"]), "human_1": 1 + names.way("in 2", ["ben"])}
    _, _, _, _, infos = env.step({"machine_0": 0, **first})
    # the press takes one part; whoever comes second is not illegal but waits
    schedule = env.unwrapped.game.schedule()
    assert [a.task for a in schedule] == ["in 1"]
    assert not infos["human_1"]["illegal"]


def test_a_random_crew_assembles_the_product(crew_of_three: Cell):
    env = tandem.envs.parallel_env("events", crew_of_three)
    assert env.possible_agents == ["robot_0", "robot_1", "human_0"]
    for seed in range(4):
        observations, infos = env.reset(seed=seed)
        for agent in env.agents:
            env.action_space(agent).seed(seed)
        while env.agents:
            actions = {
                agent: env.action_space(agent).sample(observations[agent]["action_mask"])
                for agent in env.agents
            }
            observations, _, terminated, _, infos = env.step(actions)
            assert not any(info["illegal"] for info in infos.values())
            assert all(set(info) - {"episode"} == KEYS for info in infos.values())
            assert all(
                env.observation_space(agent).contains(seen) for agent, seen in observations.items()
            )
        assert all(terminated.values())
        assert infos["robot_0"]["is_success"]
        assert set(infos["human_0"]["episode"]) == {"r", "l", "t"}
        assert faults(crew_of_three, env.game.schedule()) == []


def test_when_all_wait_for_nothing_a_second_passes(thesis: Cell):
    env = tandem.envs.parallel_env("events", thesis)
    env.reset(seed=0)
    _, rewards, _, _, infos = env.step({"robot_0": 0, "human_0": 0})
    assert (rewards["robot_0"], infos["human_0"]["time"], infos["human_0"]["idle"]) == (
        -1.0,
        1.0,
        1.0,
    )
    assert not infos["robot_0"]["illegal"]


def test_the_human_comes_first_when_both_name_one_task(thesis: Cell):
    env = tandem.envs.parallel_env("events", thesis)
    env.reset(seed=0)
    names = env.game.names
    both = {"robot_0": 1 + names.way("1", ["robot"]), "human_0": 1 + names.way("1", ["human"])}
    _, _, _, _, infos = env.step(both)
    assert (
        infos["human_0"]["task_started"],
        infos["robot_0"]["task_started"],
        infos["robot_0"]["illegal"],
    ) == ("1", "", False)


def test_an_illegal_action_waits_and_is_told_or_raises_when_strict(thesis: Cell):
    env = gymnasium.make("tandem/RobotBesideHuman-v0", cell=thesis).unwrapped
    env.reset(seed=0)
    _, reward, _, _, info = env.step(len(env.game.names.ways))
    assert (reward, info["illegal"], info["turn"]) == (0.0, True, "robot")
    strict = gymnasium.make("tandem/RobotBesideHuman-v0", cell=thesis, strict=True).unwrapped
    strict.reset(seed=0)
    with pytest.raises(
        UsageError,
        match=(
            r"illegal at 0 s: 'human' was to do '7' as human; legal are 0 \(wait\), .*Take an"
            r" action from action_masks"
        ),
    ):
        strict.step(len(strict.game.names.ways))


def test_the_limit_cuts_off_and_is_no_end(thesis: Cell):
    env = gymnasium.make("tandem/RobotBesideHuman-v0", cell=thesis, limit=5.0).unwrapped
    env.reset(seed=0)
    cut = False
    while not cut:
        _, _, ended, cut, info = env.step(int(np.flatnonzero(env.action_masks())[-1]))
        assert not ended
    assert info["time"] >= 5.0
    assert not info["is_success"]


def test_the_text_gantt_shows_what_was_done(pair: Cell):
    env = gymnasium.make("tandem/RobotBesideHuman-v0", cell=pair, render_mode="ansi")
    played(env, 0)
    assert env.render().splitlines()[0].strip().startswith("0")
    assert env.render().count("|") == 3


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"person": "randon:0.5"}, "Did you mean 'random'"),
        ({"part": "heldout"}, "part='heldout' is unknown. Did you mean 'held_out'"),
        ({"render_mode": "svg"}, "Choose from None, 'ansi', 'rgb_array'"),
        ({"limit": 0.0}, "seconds above 0"),
    ],
)
def test_options_that_do_not_exist_are_met_with_those_that_do(thesis: Cell, options, message):
    with pytest.raises(UsageError, match=message):
        tandem.envs.parallel_env("events", thesis, **options)


def test_a_slow_human_shows_once_it_has_done_something(thesis: Cell):
    """The pace that has shown is in the observation, and nothing of it before."""
    env = gymnasium.make(
        "tandem/RobotBesideHuman-v0", cell=thesis, asks=False, person="pace:2"
    ).unwrapped
    observation, _ = env.reset(seed=0)
    # per task eight numbers, per operator five before the pace; the human is the second
    place = 8 * 7 + 5 * 2 + 1
    shown, ended = [float(observation["observation"][place])], False
    while not ended:
        observation, _, ended, _, _ = env.step(int(np.flatnonzero(env.action_masks())[-1]))
        shown.append(float(observation["observation"][place]))
    assert (shown[0], shown[-1]) == (1.0, 2.0)


def test_the_robot_beside_a_human_needs_no_jax():
    program = """
import sys, gymnasium, tandem, tandem.envs

cell = tandem.load("examples/thesis.yaml")
env = gymnasium.make("tandem/RobotBesideHuman-v0", cell=cell, person="forgetful:0.2").unwrapped
env.reset(seed=0)
while not env.game.over:
    env.step(int(env.action_masks().nonzero()[0][-1]))
assert env.game.done and "jax" not in sys.modules
"""
    subprocess.run([sys.executable, "-c", program], check=True)
