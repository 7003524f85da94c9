"""Their search, batched and compiled, looks at the same columns as often as a straightforward one in plain Python."""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from learn.plain_yu import PlainGame, PlainSearch
from tandem.cell.chessboard import random_board
from tandem.envs import chessboard
from tandem.learn.alphazero.config import YuSearch
from tandem.learn.alphazero.yu_network import YuNetworks
from tandem.learn.alphazero.yu_search import yu_search
from tandem.learn.board_games import BoardGame
from tandem.learn.game import many

pytestmark = pytest.mark.usefixtures("quickly_compiled")

LOOK = YuSearch(simulations=20, depth=3, exploration=30.0)


def test_the_visits_are_those_of_the_plain_search_throughout_a_game():
    board, network = random_board(5, 5, 3, 4, 4, 6, seed=2), YuNetworks(filters=3, dense=8)
    game = BoardGame.of(board, sees="board")
    parameters = jax.tree.map(np.asarray, network.start(jax.random.key(5), game))
    lively = jax.tree.map(lambda leaf: leaf * np.float32(1.5), parameters)
    plain = PlainGame(board)
    theirs = PlainSearch(plain, lively, network.value_norm, LOOK.simulations, LOOK.depth, LOOK.exploration)

    @jax.jit
    def ours(state):
        wide = jax.tree.map(lambda leaf: leaf[None], state)
        found = yu_search(jax.random.key(0), network, lively, many(game, 1), wide, LOOK)
        return found.move[0], found.policy[0], found.to_come[0], game.observe(state)

    state, play, decisions = chessboard.reset(game.layout), plain.start(), 0
    while play.left:
        move, policy, to_come, seen = ours(jax.tree.map(jnp.asarray, state))
        np.testing.assert_allclose(seen, plain.tensor(play), atol=1e-5)
        visits, least = theirs.visits(play)
        expected = np.zeros(board.width)
        expected[list(visits)] = list(visits.values())
        np.testing.assert_allclose(np.asarray(policy) * LOOK.simulations, expected, atol=1e-3)
        assert np.isclose(to_come, min(least[column] for column in visits if visits[column]), rtol=1e-4)
        state, play, decisions = chessboard.step(game.layout, state, np.int32(move)), plain.step(play, int(move)), decisions + 1
        assert state.clock == play.clock
    assert decisions == len(board.pieces)
