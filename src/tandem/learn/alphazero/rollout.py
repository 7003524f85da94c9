"""What the learners of a cell's game (`cell_games`) have in common: what is paid, and how what was
learned plays the cell.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import jax

from tandem.cell.model import Cell
from tandem.learn.algorithm import Row
from tandem.learn.alphazero.network import Network, predict
from tandem.learn.alphazero.selfplay import FinishedGames, Looking, play_games
from tandem.learn.alphazero.trained import Trained
from tandem.learn.cell_env import CellGame, reached
from tandem.learn.env import Game, many
from tandem.learn.results import SECOND, Reached


def game_of(cell: Cell, stress_factor: float, *, waiting: bool) -> CellGame:
    """The cell's game as it is learned."""
    return CellGame.of(cell, time_weight=SECOND, stress_weight=stress_factor, waiting=waiting)


def play(
    cell: Cell,
    game: CellGame,
    trained: Trained,
    looking: Looking | None = None,
    *,
    games: int = 1,
    seed: int = 0,
) -> list[Reached]:
    """So many games on the cell: by the network alone, or under a search."""
    found = jax.device_get(
        _play(jax.random.key(seed), trained.network, trained.parameters, many(game, games), looking)
    )
    return [
        reached(cell, jax.tree.map(lambda leaf, index=index: leaf[index], found))
        for index in range(games)
    ]


def alone(
    cell: Cell, game: CellGame, network: Network, parameters: Any
) -> list[tuple[Reached, float]]:
    """What the network of each seed (the leading axis of `parameters`) reaches alone, and what it
    expects at the start, in the game's cost.
    """
    found, expected = jax.device_get(_alone(network, parameters, many(game, 1)))
    seeds = range(len(expected))
    return [
        (
            reached(cell, jax.tree.map(lambda leaf, index=index: leaf[index, 0], found)),
            float(expected[index]),
        )
        for index in seeds
    ]


def as_document(result: Reached) -> Row:
    """As the documents and figures of a training have it."""
    return {"makespan": result.makespan, "stress": result.stress, "illegal": result.illegal}


@partial(jax.jit, static_argnames=("network", "looking"))
def _play(
    key: jax.Array, network: Network, parameters: Any, games: Game, looking: Looking | None
) -> FinishedGames:
    found = play_games(key, network, parameters, games, looking)
    return found._replace(moves=found.moves.T)


@partial(jax.jit, static_argnames="network")
def _alone(network: Network, parameters: Any, games: Game) -> tuple[FinishedGames, jax.Array]:
    first = jax.tree.map(lambda leaf: leaf[0], games)

    def one(weights: Any) -> tuple[FinishedGames, jax.Array]:
        found = play_games(jax.random.key(0), network, weights, games)
        return found._replace(moves=found.moves.T), predict(
            network, weights, first, first.reset()
        ).to_come * first.unit

    return jax.lax.map(one, parameters)
