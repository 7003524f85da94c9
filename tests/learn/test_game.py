"""Boards and cells as games of turns: what is legal, whose turn it is, and what a game costs."""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from tests.learn import tiny

import tandem
from tandem.errors import UsageError
from tandem.lab.yu2020.board import random_board
from tandem.lab.yu2020.learn_env import BoardGame
from tandem.learn.cell_env import CellGame, reached
from tandem.learn.env import many, stacked
from tandem.learn.observation import MOVE_FEATURES, WHOLE_FEATURES, ahead

SMALL = {"height": 3, "width": 4, "human": 2, "joint": 3, "robot": 2, "max_time": 5}


@pytest.fixture(scope="module")
def random_play():
    """Many random games at once: game and seed -> costs `[G]`, last states, the states seen `[L,
    G]` and the least that was said to come.
    """

    def play(game, games, seed, prefers_waiting=0.0):
        wide = many(game, games)

        def move(states, key):
            legal = jax.vmap(lambda one, state: one.legal(state))(wide, states)
            numbers = jax.random.uniform(key, legal.shape)
            if prefers_waiting:
                numbers = numbers.at[:, -1].add(prefers_waiting)
            after, cost = jax.vmap(lambda one, state, move: one.step(state, move))(
                wide, states, jnp.argmax(jnp.where(legal, numbers, -1.0), 1)
            )
            least = jax.vmap(lambda one, state: one.least(state))(wide, states)
            turn = jax.vmap(lambda one, state: one.to_play(state))(wide, states)
            return after, (cost, least, legal, turn)

        states = jax.vmap(lambda one: one.reset())(wide)
        return jax.lax.scan(move, states, jax.random.split(jax.random.key(seed), game.longest))

    return jax.jit(play, static_argnames=("games", "prefers_waiting"))


def check_game(game, played):
    """What holds for every game."""
    states, (cost, least, legal, turn) = played
    assert np.asarray(
        jax.vmap(lambda one, state: one.is_over(state))(many(game, cost.shape[1]), states)
    ).all()
    np.testing.assert_array_equal(legal.any(-1), turn >= 0)
    to_come = np.cumsum(np.asarray(cost)[::-1], 0)[::-1]
    assert (np.asarray(least) <= to_come + 1e-3).all(), (
        "what is certain to come never exceeds what comes"
    )
    np.testing.assert_array_equal(np.asarray(cost)[np.asarray(turn) < 0], 0)


def test_a_board_played_by_columns_costs_what_its_cell_takes(random_play):
    board = random_board(**SMALL, seed=3)
    game = jax.tree.map(jnp.asarray, BoardGame.of(board))
    states, told = played = random_play(game, 16, 0)
    check_game(game, played)
    np.testing.assert_array_equal(told[0].sum(0), states.clock)
    best = tandem.plan(board.to_cell(), minimize="makespan").points[0][0]
    assert states.clock.min() >= best


def test_a_cell_without_waiting_is_the_same_game_as_its_board(random_play):
    """Same game in two tellings: every cost that random play meets on the board is met on the cell,
    and the best of many are equal.
    """
    board = random_board(**SMALL, seed=3)
    on_board = random_play(jax.tree.map(jnp.asarray, BoardGame.of(board)), 256, 1)[0].clock
    cell_game = jax.tree.map(jnp.asarray, CellGame.of(board.to_cell(), waiting=False))
    played = random_play(cell_game, 256, 2)
    check_game(cell_game, played)
    assert set(np.asarray(on_board).tolist()) == set(
        np.asarray(played[1][0].sum(0)).astype(int).tolist()
    )


def test_a_cells_game_with_waiting_pays_time_and_stress_and_keeps_to_the_cell(random_play):
    cell = tandem.load(tiny.CELL)
    game = jax.tree.map(jnp.asarray, CellGame.of(cell, time_weight=10, stress_weight=5))
    states, (cost, *_) = played = random_play(game, 16, 0, prefers_waiting=0.5)
    check_game(game, played)
    for index in range(16):
        found = reached(
            cell,
            jax.device_get(
                _Played(
                    cost.sum(0)[index], jax.tree.map(lambda leaf, index=index: leaf[index], states)
                )
            ),
        )
        assert tandem.faults(cell, found.schedule) == []
        assert found.cost == pytest.approx(10 * found.makespan + 5 * found.stress, abs=1e-3)
        assert found.makespan >= 23


class _Played:
    def __init__(self, cost, state):
        self.cost, self.state = cost, state


jax.tree_util.register_pytree_node(
    _Played, lambda it: ((it.cost, it.state), None), lambda _, parts: _Played(*parts)
)


def test_three_operators_and_a_joint_task_take_turns(random_play):
    cell = tandem.Cell.model_validate(
        {
            "operators": {"r": {"kind": "robot"}, "s": {"kind": "robot"}, "h": {"kind": "human"}},
            "tasks": {
                "a": {"time": {"r": 2, "s": 3}},
                "b": {"time": {"h": 4}, "stress": 1},
                "c": {"time": {"s": 1, "h": 2}, "after": ["a"]},
                "d": {"together": [{"operators": ["r", "h"], "time": 2}], "after": ["b"]},
            },
        }
    )
    game = jax.tree.map(jnp.asarray, CellGame.of(cell))
    _, told = played = random_play(game, 64, 0)
    check_game(game, played)
    assert set(np.unique(told[3])) == {-1, 0, 1, 2}
    best = tandem.plan(cell, minimize="makespan").points[0][0]
    assert told[0].sum(0).min() == best == 6


def test_what_a_network_sees_does_not_depend_on_the_order_of_the_tasks():
    cell = tandem.load(tiny.CELL)
    turned = cell.replace(tasks=dict(reversed(cell.tasks.items())))
    looks = []
    for one in (cell, turned):
        game = jax.tree.map(jnp.asarray, CellGame.of(one, time_weight=10, stress_weight=5))
        looks.append(game.observe(game.reset()))
    assert looks[0].moves.shape[1:] == (MOVE_FEATURES,)
    assert looks[0].whole.shape == (WHOLE_FEATURES,)
    np.testing.assert_allclose(looks[0].whole, looks[1].whole, atol=1e-6)
    rows = [np.array(sorted(np.asarray(look.moves).round(5).tolist())) for look in looks]
    np.testing.assert_allclose(rows[0], rows[1], atol=1e-4)


def test_tails_and_what_lies_behind_are_worked_out_by_hand():
    """a (2 s, operator 0) -> b (3 s, either) -> c (4 s, operator 1)."""
    told = ahead(
        task=np.array([0, 1, 1, 2]),
        uses=np.array([[1, 0], [1, 0], [0, 1], [0, 1]], bool),
        time=np.array([2.0, 3.0, 3.0, 4.0]),
        stress=np.zeros(4),
        needs=np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], bool),
        human=np.array([0, 1]),
    )
    assert told.tail.tolist() == [9, 7, 4]
    assert told.only.tolist() == [[2, 0], [0, 0], [0, 4]]
    assert told.behind_only.tolist() == [[0, 4], [0, 4], [0, 0]]
    assert told.behind_open.tolist() == [3, 0, 0]


def test_games_of_different_shapes_are_not_stacked():
    with pytest.raises(ValueError, match="different shapes"):
        stacked([BoardGame.of(random_board(**SMALL, seed=0)), BoardGame.of(random_board(seed=0))])


def test_weights_that_make_no_sense_are_refused():
    with pytest.raises(UsageError, match="time must weigh more than 0"):
        CellGame.of(tandem.load(tiny.CELL), time_weight=0)
