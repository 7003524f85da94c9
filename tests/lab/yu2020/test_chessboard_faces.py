"""The chessboard's PettingZoo face: turns, masks, illegal columns, troubles."""

from __future__ import annotations

import numpy as np
import pytest

import tandem.envs
from tandem.errors import CellError, UsageError
from tandem.files.load import dump
from tandem.lab.yu2020.board import Board, desk, random_board
from tandem.lab.yu2020.chance import Chance

SMALL = random_board(4, 4, 3, 2, 5, 6, seed=3)


def leftmost(env):
    """Plays the leftmost legal columns; returns the sum of rewards."""
    env.reset(seed=0)
    total = 0.0
    while env.agents:
        masks = env.action_masks()
        assert sum(mask[0] for mask in masks.values()) == 1
        observations, rewards, _, _, infos = env.step(
            {agent: int(mask.argmax()) for agent, mask in masks.items()}
        )
        assert env.observation_space("robot_0").contains(observations["robot_0"])
        total += rewards["human_0"]
    assert infos["robot_0"]["time"] == -total
    return total


def test_leftmost_play_on_the_desk_costs_105_seconds():
    assert leftmost(tandem.envs.parallel_env("chessboard", desk())) == -105


def test_a_cell_and_a_file_will_do_and_what_is_no_board_is_refused(tmp_path):
    dump(SMALL.to_cell(), tmp_path / "board.yaml")
    assert leftmost(tandem.envs.parallel_env("chessboard", tmp_path / "board.yaml")) == leftmost(
        tandem.envs.parallel_env("chessboard", Board.of(SMALL.to_cell()))
    )
    with pytest.raises(CellError, match="takes robot 9 s and human 10 s"):
        tandem.envs.parallel_env("chessboard", "examples/thesis.yaml")


def test_an_illegal_column_becomes_the_leftmost_legal_one_and_is_told():
    env = tandem.envs.parallel_env("chessboard", SMALL)
    env.reset()
    masks = env.action_masks()
    mover = next(agent for agent, mask in masks.items() if not mask[0])
    forbidden = np.flatnonzero(masks[mover] == 0)[-1]
    _, _, _, _, infos = env.step(dict.fromkeys(env.agents, forbidden))
    taken = env.state()
    assert {agent for agent, info in infos.items() if info["illegal"]} == {mover}
    env.reset()
    env.step({agent: int(mask.argmax()) for agent, mask in masks.items()})
    np.testing.assert_array_equal(env.state(), taken)


def test_a_strict_board_refuses_an_illegal_column_and_the_others_word_does_not_count():
    env = tandem.envs.parallel_env("chessboard", SMALL, strict=True)
    env.reset()
    masks = env.action_masks()
    mover = next(agent for agent, mask in masks.items() if not mask[0])
    other = next(agent for agent in masks if agent != mover)
    with pytest.raises(
        UsageError,
        match=rf"illegal at 0 s: {mover} named 0; legal are .* Take an action from action_masks",
    ):
        env.step({mover: 0, other: 0})
    env.step({mover: int(masks[mover].argmax()), other: 3})
    assert (env.state()[..., 1] == (0 if mover == "robot_0" else 1)).sum() == 1


def test_troubles_are_drawn_by_the_seed():
    took = []
    for seed in (0, 0, 1):
        env = tandem.envs.parallel_env("chessboard", SMALL, chance=Chance(0.5, 20, 0.3))
        env.reset(seed=seed)
        while env.agents:
            _, _, _, _, infos = env.step(
                {agent: int(mask.argmax()) for agent, mask in env.action_masks().items()}
            )
        took.append(infos["robot_0"]["time"])
    assert took[0] == took[1] != took[2]
