"""Their search, batched and compiled, looks at the same columns as often as a straightforward one
in plain Python.
"""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from tests.lab.yu2020.plain_yu import PlainGame, PlainSearch

from tandem.lab import yu2020
from tandem.lab.yu2020.board import random_board
from tandem.lab.yu2020.config import YuSearch
from tandem.lab.yu2020.learn_env import BoardGame
from tandem.lab.yu2020.network import YuNetworks
from tandem.lab.yu2020.search import yu_search
from tandem.learn.env import many

LOOKS = {
    name: YuSearch(simulations=20, depth=3, exploration=30.0, unvisited=name)
    for name in ("first", "zero")
}


@pytest.mark.parametrize("look", LOOKS.values(), ids=LOOKS)
def test_the_visits_are_those_of_the_plain_search_throughout_a_game(look):
    """All positions of a game are searched side by side: their simulations are of different length,
    and none may disturb another.
    """
    board, network = random_board(5, 5, 3, 4, 4, 6, seed=2), YuNetworks(filters=3, dense=8)
    game = BoardGame.of(board, sees="board")
    parameters = jax.tree.map(np.asarray, network.start(jax.random.key(5), game))
    lively = jax.tree.map(lambda leaf: leaf * np.float32(1.5), parameters)
    plain = PlainGame(board)
    theirs = PlainSearch(plain, lively, network.value_norm, look)
    state, play = yu2020.reset(game.layout), plain.start()
    states, visits, least, tensors = [], [], [], []
    while play.left:
        number, costs = theirs.visits(play)
        states, tensors = [*states, state], [*tensors, plain.tensor(play)]
        visits, least = (
            [*visits, [number.get(column, 0) for column in range(board.width)]],
            [*least, min(costs[at] for at in number if number[at])],
        )
        column = max(sorted(number), key=lambda column: number[column])
        state, play = yu2020.step(game.layout, state, np.int32(column)), plain.step(play, column)
        assert state.clock == play.clock
    assert len(states) == len(board.pieces)
    # with the state in which it is over
    wide = jax.tree.map(lambda *leaves: jnp.asarray(np.stack(leaves)), *states, state)
    games = many(game, len(states) + 1)
    found = jax.jit(lambda: yu_search(jax.random.key(0), network, lively, games, wide, look))()
    seen = jax.jit(jax.vmap(lambda game, state: game.observe(state)))(games, wide)
    np.testing.assert_allclose(seen[:-1], tensors, atol=1e-5)
    np.testing.assert_allclose(found.policy[:-1] * look.simulations, visits, atol=1e-3)
    np.testing.assert_allclose(found.to_come[:-1], least, rtol=1e-4)
    assert not found.policy[-1].any()
    assert (np.asarray(found.move[:-1]) == np.argmax(visits, 1)).all()
