"""Every world of the registry behaves as the standards say.

The checkers of Gymnasium, PettingZoo and SB3; vector environments; what info holds; actions that
are none; steps before the beginning and after the end. A new world is tried by itself: when a cell
of one robot and one human will not do for it, it names what it is made of in `MADE_OF`.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.error import ResetNeeded
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode
from pettingzoo.test import api_test, parallel_api_test, parallel_seed_test
from pettingzoo.utils import parallel_to_aec

import tandem.envs
from tandem.envs.registry import PARALLEL, SINGLE
from tandem.errors import UsageError
from tandem.files.validate import cell_of
from tandem.lab.yu2020.board import random_board
from tandem.lab.yu2020.chance import Chance as BoardChance
from tandem.world.randomness import Chance

CELL = cell_of(
    {
        "operators": {"human": {"kind": "human"}, "robot": {"kind": "robot"}},
        "tasks": {
            "a": {"time": {"human": 3, "robot": 4}, "stress": 1},
            "b": {"time": {"human": 2, "robot": 2}, "stress": 2},
            "c": {"time": {"robot": 5}, "after": ["a"]},
        },
    }
)
MADE_OF: dict[str, Any] = {"chessboard": random_board(4, 4, 3, 2, 5, 6, seed=3), "grid": "crossing"}
"""What a world is made of when it takes no cell like `CELL`."""

WILD = {
    "person": "random:0.3+forgetful:0.2+refusing:0.1+pace:0.8..2",
    "chance": Chance("lognormal", cv=0.2, failure_s=30.0, repair_s=4.0),
}
MORE: dict[str, list[dict[str, Any]]] = {
    "tandem/Thesis-v0": [{"by": "ticks"}, {"observation": "thesis", "stress_factor": 5.0}],
    "tandem/RobotBesideHuman-v0": [{"asks": False}, WILD],
    "tandem/Repair-v0": [{"p": 0.5}],
    "thesis": [{"by": "decisions"}],
    "events": [WILD],
    "duo": [{"spread": 0.3, "change": 0.5}],
    "chessboard": [{"chance": BoardChance(0.3, 5, 0.3)}],
    "grid": [{"closing": False, "observation": "marked"}],
}
"""Options beside the standard ones under which a world is tried too."""


def worlds(table: dict[str, str]) -> Iterator[Any]:
    for name in table:
        for number, options in enumerate([{}, *MORE.get(name, [])]):
            yield pytest.param(name, options, id=f"{name}-{number}")


singles = pytest.mark.parametrize(("name", "options"), list(worlds(SINGLE)))
parallels = pytest.mark.parametrize(("name", "options"), list(worlds(PARALLEL)))


def single(name: str, **options: Any) -> gymnasium.Env:
    return gymnasium.make(name, cell=MADE_OF.get(name, CELL), **options)


def parallel(name: str, **options: Any) -> Any:
    return tandem.envs.parallel_env(name, MADE_OF.get(name, CELL), **options)


# --- the official checkers ---


@singles
def test_gymnasiums_checker_is_green(name, options):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(single(name, **options).unwrapped, skip_render_check=True)


@parallels
def test_pettingzoos_suites_are_green(name, options, capsys):
    with warnings.catch_warnings():
        warnings.filterwarnings("error", message=".*action_mask.*")
        # masks in the observation mean a Dict, which the AEC suite notes
        warnings.filterwarnings("ignore", message="Observation")
        parallel_api_test(parallel(name, **options), num_cycles=200)
        parallel_seed_test(lambda: parallel(name, **options), num_cycles=60)
        api_test(parallel_to_aec(parallel(name, **options)), num_cycles=60)
    assert "Passed Parallel API test" in capsys.readouterr().out


@singles
def test_sb3s_checker_is_green(name, options):
    checker = pytest.importorskip(
        "stable_baselines3.common.env_checker",
        reason="pip install 'tandem[sb3]' to run SB3's checker",
    )
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        checker.check_env(single(name, **options).unwrapped, warn=True)


# --- many at once ---


def play_on(env: Any, keep_on: Callable[[int, int], bool]) -> int:
    """Legal moves at random in every copy while it is to be kept on, which is asked with the steps
    and the ended episodes so far. Returns how many episodes have ended.
    """
    rng, steps, ended = np.random.default_rng(0), 0, 0
    mode = env.metadata["autoreset_mode"]
    try:
        observation, info = env.reset(seed=0)
        keys = set(info)
        while keep_on(steps, ended):
            legal = [
                np.flatnonzero(mask) if mask.any() else [0] for mask in observation["action_mask"]
            ]
            observation, _, terminated, truncated, info = env.step(
                np.array([rng.choice(each) for each in legal])
            )
            over = terminated | truncated
            assert set(info) >= keys
            assert env.observation_space.contains(observation)
            steps, ended = steps + 1, ended + int(over.sum())
            if mode is AutoresetMode.DISABLED and over.any():
                observation, info = env.reset(options={"reset_mask": over})
    finally:
        env.close()
    return ended


def two_copies(name: str, options: Any, way: str, mode: AutoresetMode) -> Any:
    return gymnasium.make_vec(
        name,
        num_envs=2,
        vectorization_mode=way,
        vector_kwargs={"autoreset_mode": mode},
        cell=MADE_OF.get(name, CELL),
        **options,
    )


@singles
def test_two_copies_side_by_side_play_a_thousand_steps(name, options):
    env = two_copies(name, options, "sync", AutoresetMode.NEXT_STEP)
    assert play_on(env, lambda steps, _: steps < 1000) > 10


@pytest.mark.parametrize("mode", list(AutoresetMode), ids=lambda mode: mode.name.lower())
@pytest.mark.parametrize("way", ["sync", "async"])
@singles
def test_copies_go_on_after_ten_ends_in_every_way_and_mode(name, options, way, mode):
    """Ways and modes differ in what happens where an episode ends."""
    env = two_copies(name, options, way, mode)
    assert play_on(env, lambda steps, ended: ended <= 10 and steps < 1000) > 10


# --- what info holds ---


def kinds(info: Any) -> Any:
    """The same tables with types for values; of arrays the shape and dtype."""
    if isinstance(info, dict):
        return {key: kinds(value) for key, value in info.items()}
    if isinstance(info, tuple):
        return tuple(map(kinds, info))
    return (info.dtype, info.shape) if isinstance(info, np.ndarray) else type(info)


@singles
def test_a_value_of_info_is_there_in_every_step_and_keeps_its_type(name, options):
    env, rng = single(name, **options).unwrapped, np.random.default_rng(0)
    seen = []
    for seed in range(5):
        _, info = env.reset(seed=seed)
        seen.append(kinds(info))
        over = False
        while not over:
            action = (
                rng.choice(np.flatnonzero(info["action_mask"]))
                if rng.random() < 0.8
                else env.action_space.sample()
            )
            _, reward, ended, cut, info = env.step(action)
            over = ended or cut
            assert type(reward) is float
            seen.append(kinds(info))
    assert all(each == seen[0] for each in seen)
    assert {"action_mask", "illegal", "is_success", "time"} <= set(seen[0])


@parallels
def test_a_value_of_every_agents_info_is_there_in_every_step_and_keeps_its_type(name, options):
    env, rng = parallel(name, **options), np.random.default_rng(0)
    seen = []
    for seed in range(3):
        observations, infos = env.reset(seed=seed)
        seen += map(kinds, infos.values())
        while env.agents:
            actions = {
                agent: rng.choice(np.flatnonzero(observations[agent]["action_mask"]))
                for agent in env.agents
            }
            observations, rewards, _, _, infos = env.step(actions)
            assert {type(reward) for reward in rewards.values()} == {float}
            seen += [
                {key: kind for key, kind in kinds(info).items() if key != "episode"}
                for info in infos.values()
            ]
            for agent, mask in env.action_masks().items():
                np.testing.assert_array_equal(infos[agent]["action_mask"], mask)
                np.testing.assert_array_equal(observations[agent]["action_mask"], mask)
    assert all(each == seen[0] for each in seen)
    assert {"action_mask", "illegal", "is_success", "time"} <= set(seen[0])


# --- actions that are none ---

BEYOND = [-1, -2, -3, -4, -5, -6, -7, -1000, 10**6, 2**31, 2**63, 10**30, "the first too many"]
NO_NUMBER = [
    None,
    1.5,
    1.0,
    "a",
    "1",
    float("nan"),
    [0],
    (0,),
    np.array([0]),
    np.array([[0]]),
    np.array(0.0),
    np.float32(1),
    {},
    type,
]


def first_too_many(action: Any, space: Any) -> Any:
    return int(space.n) if action == "the first too many" else action


@pytest.mark.parametrize("action", BEYOND, ids=repr)
@singles
def test_a_number_beyond_the_space_is_illegal_and_raises_when_strict(name, options, action):
    for strict in (False, True):
        env = single(name, **options, strict=strict)
        _, before = env.reset(seed=0)
        action = first_too_many(action, env.action_space)
        if strict:
            with pytest.raises(
                UsageError,
                match=(
                    r"illegal: the controller named .*, and the actions are 0 to \d+\. Take an"
                    r" action from action_masks"
                ),
            ):
                env.step(action)
            # what was refused has changed nothing
            _, _, _, _, info = env.step(int(np.flatnonzero(before["action_mask"])[-1]))
            assert not info["illegal"]
        else:
            observation, reward, _, _, info = env.step(action)
            assert info["illegal"]
            assert reward <= 0
            assert env.observation_space.contains(observation)


@pytest.mark.parametrize("action", BEYOND, ids=repr)
@parallels
def test_a_number_beyond_an_agents_space_is_illegal_and_raises_when_strict(name, options, action):
    for strict in (False, True):
        env = parallel(name, **options, strict=strict)
        for wrong in env.possible_agents:
            env.reset(seed=0)
            lowest = {agent: int(mask.argmax()) for agent, mask in env.action_masks().items()}
            actions = lowest | {wrong: first_too_many(action, env.action_space(wrong))}
            if strict:
                with pytest.raises(
                    UsageError, match=rf"illegal: {wrong} named .*, and the actions are 0 to \d+"
                ):
                    env.step(actions)
                _, _, _, _, infos = env.step(lowest)
                assert not infos[wrong]["illegal"]
            else:
                observations, _, _, _, infos = env.step(actions)
                assert {agent for agent, info in infos.items() if info["illegal"]} == {wrong}
                assert env.observation_space(wrong).contains(observations[wrong])


@pytest.mark.parametrize("action", NO_NUMBER, ids=repr)
@singles
def test_what_is_no_whole_number_is_refused_in_words(name, options, action):
    env = single(name, **options).unwrapped
    env.reset(seed=0)
    with pytest.raises(
        UsageError, match=r"the controller named .*, no whole number: give one of 0 to \d+"
    ):
        env.step(action)


@pytest.mark.parametrize("action", NO_NUMBER, ids=repr)
@parallels
def test_what_is_no_whole_number_is_refused_for_every_agent_at_once(name, options, action):
    env = parallel(name, **options)
    env.reset(seed=0)
    with pytest.raises(UsageError) as caught:
        env.step(dict.fromkeys(env.agents, action))
    for agent in env.agents:
        assert f"{agent} named " in str(caught.value)


@parallels
def test_missing_and_unknown_agents_are_named(name, options):
    env = parallel(name, **options)
    env.reset(seed=0)
    with pytest.raises(
        UsageError, match=r"no action for robot_0.*\n.*'robot_O'.*Did you mean 'robot_0'"
    ):
        env.step({"human_0": 0, "robot_O": 0})
    with pytest.raises(UsageError, match="give a table from agent to action, for "):
        env.step([0, 0])


@pytest.mark.parametrize(
    "kind",
    [int, np.int8, np.int64, np.uint8, np.array],
    ids=["int", "int8", "int64", "uint8", "array()"],
)
@singles
def test_whole_numbers_of_any_kind_are_actions(name, options, kind):
    env = single(name, **options).unwrapped
    _, info = env.reset(seed=0)
    _, _, _, _, info = env.step(kind(int(np.flatnonzero(info["action_mask"])[0])))
    assert not info["illegal"]


# --- before the beginning and after the end ---


def to_the_end(env: Any) -> None:
    _, info = env.reset(seed=0)
    over = False
    while not over:
        _, _, ended, cut, info = env.step(int(np.flatnonzero(info["action_mask"])[-1]))
        over = ended or cut


@singles
@pytest.mark.parametrize("bare", [False, True], ids=["made", "bare"])
def test_a_step_before_the_reset_or_after_the_end_raises_and_a_reset_mends_it(name, options, bare):
    env = single(name, **options)
    env = env.unwrapped if bare else env
    with pytest.raises(ResetNeeded):
        env.step(0)
    to_the_end(env)
    for action in (0, -1, None):
        with pytest.raises(
            ResetNeeded, match=r"this episode has ended: call reset\(\) before step\(\)"
        ):
            env.step(action)
        with pytest.raises(UsageError):
            env.step(action)
    to_the_end(env)


@pytest.mark.parametrize("name", list(SINGLE))
def test_a_step_after_the_limit_raises_too(name):
    env = single(name, limit=1).unwrapped
    to_the_end(env)
    with pytest.raises(ResetNeeded, match="has ended"):
        env.step(0)


def all_to_the_end(env: Any) -> None:
    env.reset(seed=0)
    rng = np.random.default_rng(0)
    while env.agents:
        env.step(
            {agent: rng.choice(np.flatnonzero(mask)) for agent, mask in env.action_masks().items()}
        )


@parallels
def test_agents_before_the_reset_or_after_the_end_are_told_to_reset(name, options):
    env = parallel(name, **options)
    with pytest.raises(ResetNeeded, match="no episode has begun"):
        env.step(dict.fromkeys(env.possible_agents, 0))
    all_to_the_end(env)

    def everyone(action: int) -> dict[str, int]:
        return dict.fromkeys(env.possible_agents, action)

    for actions in ({}, everyone(0), everyone(-1)):
        with pytest.raises(
            ResetNeeded, match=r"this episode has ended: call reset\(\) before step\(\)"
        ):
            env.step(actions)
    all_to_the_end(env)
