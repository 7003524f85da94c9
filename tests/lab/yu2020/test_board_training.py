"""Networks for chessboards: trained on some boards, played on others, in trouble or not."""

from __future__ import annotations

import jax
import numpy as np
import pytest

from tandem.errors import UsageError
from tandem.lab import yu2020
from tandem.lab.yu2020 import board_training
from tandem.lab.yu2020.board import random_board
from tandem.lab.yu2020.config import YuConfig, YuSearch
from tandem.lab.yu2020.optimal import optimum
from tandem.lab.yu2020.play import play
from tandem.learn.alphazero.config import Config, EpsilonGreedy

SIZE = (4, 5, 3, 3, 3, 6)
TRAINING = [random_board(*SIZE, seed=seed) for seed in range(10, 14)]
TEST = [random_board(*SIZE, seed=seed) for seed in range(3)]
THEIRS = YuConfig(YuSearch(6, 2, temperature=1000.0), outer=1, inner=1, switch=2, kept=20, dense=8)


@pytest.fixture(scope="module")
def theirs():
    return board_training.train(TRAINING, THEIRS, seed=999, held=TEST, every=2)


def test_a_curve_is_read_on_boards_that_are_held_out_and_repeats_for_its_seed(theirs):
    trained, curve = theirs
    assert [point["games"] for point in curve] == [2, 4]
    assert all(
        point["held"] >= np.mean([optimum(board).makespan for board in TEST]) for point in curve
    )
    again, same = board_training.train(TRAINING, THEIRS, seed=999, held=TEST, every=2)
    assert [point["held"] for point in same] == [point["held"] for point in curve]
    assert all(
        np.array_equal(a, b)
        for a, b in zip(
            jax.tree.leaves(again.parameters), jax.tree.leaves(trained.parameters), strict=True
        )
    )


def test_only_the_agent_that_learned_has_changed(theirs):
    """Two games for the robot, then two for the human: both networks have moved from where they
    began; after two games the robot's alone has.
    """
    start = board_training.untrained(THEIRS, TRAINING[0], seed=999).parameters
    end = theirs[0].parameters
    moved = [
        any(
            not np.array_equal(a[agent], b[agent])
            for a, b in zip(*map(jax.tree.leaves, (start, end)), strict=True)
        )
        for agent in (0, 1)
    ]
    assert moved == [True, True]


def test_games_are_legal_and_never_better_than_the_optimum(theirs):
    trained, _ = theirs
    seconds = board_training.play(trained, TEST, looking=YuSearch(6, 2))
    for board, took in zip(TEST, seconds, strict=True):
        assert took[0] >= optimum(board).makespan
        game = play(board, board_training.decider(trained, board, looking=YuSearch(6, 2)))
        assert game.makespan == took[0]


def test_trouble_costs_time():
    untrained = board_training.untrained(Config(units=8), TRAINING[0], seed=0)
    calm = board_training.play(untrained, TEST, samples=4, looking=EpsilonGreedy(0.0))
    assert calm.shape == (3, 4)
    assert (calm == calm[:, :1]).all()
    numbers = np.random.default_rng(0).random((3, 4, 3, 4, 5))
    chance = yu2020.Chance(robot_fails=0.5, repair_s=20, human_errs=0.5)
    fates = [
        [yu2020.fate(yu2020.layout(board), chance, numbers[row, sample]) for sample in range(4)]
        for row, board in enumerate(TEST)
    ]
    stacked = jax.tree.map(
        lambda *leaves: np.stack(leaves).reshape(3, 4, 4, 5),
        *[fate for row in fates for fate in row],
    )
    troubled = board_training.play(
        untrained, TEST, samples=4, looking=EpsilonGreedy(0.0), fates=stacked
    )
    assert troubled.mean() > calm.mean() + 5


def test_boards_of_different_sizes_are_not_trained_on_together():
    with pytest.raises(UsageError, match="all of one height"):
        board_training.train([TEST[0], random_board(3, 4, 2, 3, 2, 5, seed=0)], Config(), seed=0)
