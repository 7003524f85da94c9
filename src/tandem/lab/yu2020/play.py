"""Whole games: one in NumPy with its record, or as many as you like side by side in JAX."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tandem.errors import UsageError
from tandem.lab.yu2020.board import HUMAN as HUMAN_NAME
from tandem.lab.yu2020.board import ROBOT as ROBOT_NAME
from tandem.lab.yu2020.board import Board
from tandem.lab.yu2020.layout import by_place, layout
from tandem.lab.yu2020.players import Player
from tandem.lab.yu2020.world import (
    HUMAN,
    ROBOT,
    Array,
    Fate,
    Layout,
    State,
    eligible,
    is_over,
    legal,
    reset,
    step,
    to_play,
)
from tandem.schedule.model import Assignment, Schedule

NAMES = {ROBOT: ROBOT_NAME, HUMAN: HUMAN_NAME}


@dataclass(frozen=True)
class Move:
    """One decision.

    Attributes:
      at: seconds since the start.
      agent: 0 the robot, 1 the human.
      column: from 0.
      piece: its name.
      state: the board before it.
    """

    at: int
    agent: int
    column: int
    piece: str
    state: State


@dataclass(frozen=True)
class Game:
    """A game that was played to its end: the moves, and when the last piece left the board."""

    board: Board
    moves: tuple[Move, ...]
    makespan: int

    @property
    def schedule(self) -> Schedule:
        """Who did which piece from when to when, when nothing went wrong."""
        time = {piece.name: piece.time for piece in self.board.pieces}
        return Schedule(
            tuple(
                Assignment(
                    float(move.at),
                    float(move.at + time[move.piece]),
                    move.piece,
                    (NAMES[move.agent],),
                )
                for move in self.moves
            )
        )


def play(board: Board, choose: Callable[[Layout, State], Any], *, fate: Fate | None = None) -> Game:
    """The game of somebody who chooses a column (from 0) in each state.

    Raises UsageError when the column is not legal.
    """
    laid, names = layout(board), by_place(board)
    state, moves = reset(laid), []
    while not is_over(state):
        agent, column = int(to_play(laid, state)), int(choose(laid, state))
        open_columns = np.flatnonzero(legal(laid, state))
        if column not in open_columns:
            raise UsageError(
                f"column {column} is not legal at {state.clock} s; legal are"
                f" {', '.join(map(str, open_columns))}."
            )
        row = int(np.flatnonzero(eligible(laid, state)[agent, :, column])[0])
        moves.append(Move(int(state.clock), agent, column, names[row, column].name, state))
        state = step(laid, state, np.int32(column), fate)
    return Game(board, tuple(moves), int(state.clock))


def by_rule(player: Player, seed: int = 0) -> Callable[[Layout, State], Any]:
    """A player of `PLAYERS` as `play` wants it."""
    generator = np.random.default_rng(seed)
    return lambda laid, state: player(laid, state, generator.random(laid.time.shape[1]))


def follow(columns: Sequence[int]) -> Callable[[Layout, State], Any]:
    """Somebody who plays these columns one after the other."""
    left = iter(columns)
    return lambda laid, state: next(left)


def makespans(
    layouts: Layout, player: Player, key: Array, *, games: int = 1, fates: Fate | None = None
) -> NDArray[np.int32]:
    """`[B, games]` int32, seconds that the player takes on each of `B` boards, all games side by
    side in one compiled loop.

    Args:
      layouts: of `stacked(boards)`.
      key: a `jax.random.key`; each game draws its own numbers.
      fates: `[B, games, ...]`, what goes wrong in each game; nothing when absent.
    """
    import jax
    import jax.numpy as jnp

    most = int(max(np.sum(layouts.who > 0, axis=(1, 2)))) + (
        0 if fates is None else int(np.asarray(fates.mistakes).sum((-1, -2)).max())
    )
    laid = jax.tree.map(jnp.asarray, layouts)
    keys = jax.random.split(key, (laid.time.shape[0], games))
    one = _one_game(player, most, fates is not None)
    return np.asarray(one(laid, keys, jax.tree.map(jnp.asarray, fates)))


@cache
def _one_game(player: Player, most: int, troubled: bool) -> Any:
    """`[B]` boards, `[B, games]` keys and fates -> `[B, games]` seconds. Compiled once a player and
    shape.
    """
    import jax

    def game(laid: Layout, key: Array, fate: Fate | None) -> Array:
        def move(index: Array, state: State) -> State:
            numbers = jax.random.uniform(jax.random.fold_in(key, index), laid.time.shape[1:])
            return step(laid, state, player(laid, state, numbers), fate)

        return jax.lax.fori_loop(0, most, move, reset(laid)).clock

    over_games = jax.vmap(game, in_axes=(None, 0, 0 if troubled else None))
    return jax.jit(jax.vmap(over_games, in_axes=(0, 0, 0 if troubled else None)))
