"""The assembly chessboards of Yu, Huang and Chang (`tandem.lab.yu2020`) as a game for a search: a
move is a column.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial
from typing import Any, Literal, Self

import jax
import jax.numpy as jnp
import numpy as np

from tandem.lab import yu2020
from tandem.lab.yu2020 import HUMAN, ROBOT, Layout, State
from tandem.lab.yu2020.board import Board, Who
from tandem.lab.yu2020.layout import waits
from tandem.learn.observation import Ahead, AssemblyStatus, ahead, features, time_to_come

Array = Any
Sees = Literal["features", "board"]


@partial(
    jax.tree_util.register_dataclass,
    data_fields=["layout", "ahead", "place", "cell", "way", "unit"],
    meta_fields=["sees"],
)
@dataclass(frozen=True)
class BoardGame:
    """One board. Agent 0 is the robot, agent 1 the human; the human chooses first, and nobody waits
    of his own will. Only time costs.

    Attributes:
      layout: the board as arrays.
      ahead: what our network is told of it beforehand. `T` pieces.
      place: `[T]` int32, where in the flattened board the piece starts. cell: `[h, w]` int32, which
        piece starts here; 0 where none does.
      way: `[T, 2]` int32, the way in `ahead` in which the agent does the piece; the other's where
        it cannot.
      unit: `[]` float32, the mean time of a piece, seconds; one second where the board itself is
        seen, with its raw times.
      sees: what `observe` gives: "features" (an `Observation`), or "board", the tensor `[h, w, 3]`
        that the authors' network is given.
    """

    layout: Layout
    ahead: Ahead
    place: Array
    cell: Array
    way: Array
    unit: Array
    sees: Sees = field(default="features")

    @classmethod
    def of(
        cls,
        board: Board,
        *,
        sees: Sees = "features",
        height: int | None = None,
        width: int | None = None,
    ) -> Self:
        """The board's game, padded with empty rows and columns where `height` and `width` say so.

        Raises UsageError when the board is larger than that.
        """
        laid = yu2020.layout(board, height=height, width=width)
        columns = laid.time.shape[1]
        place = np.array(
            [(piece.row - 1) * columns + piece.first - 1 for piece in board.pieces], np.int32
        )
        cell = np.zeros(laid.time.size, np.int32)
        cell[place] = np.arange(len(place))
        able = np.array(
            [[piece.who != Who.HUMAN, piece.who != Who.ROBOT] for piece in board.pieces]
        )
        needs = np.array([[waits(high, low) for low in board.pieces] for high in board.pieces])
        task, agent = np.nonzero(able)
        way = np.array(
            [
                [_way(task, agent, piece, me) for me in (ROBOT, HUMAN)]
                for piece in range(len(place))
            ],
            np.int32,
        )
        time = np.array([piece.time for piece in board.pieces], np.float64)
        unit = 1.0 if sees == "board" else time.mean()
        told = ahead(
            task,
            agent[:, None] == np.arange(2),
            time[task] / unit,
            np.zeros(len(task)),
            needs,
            np.array([0, 1]),
        )
        return cls(laid, told, place, cell.reshape(laid.time.shape), way, np.float32(unit), sees)

    @property
    def agents(self) -> tuple[str, ...]:
        return ("robot", "human")

    @property
    def moves(self) -> int:
        return int(self.layout.time.shape[-1])

    @property
    def longest(self) -> int:
        return int(self.place.shape[-1])

    def reset(self) -> State:
        return yu2020.reset(self.layout)

    def legal(self, state: State) -> Array:
        return yu2020.legal(self.layout, state)

    def to_play(self, state: State) -> Array:
        return jnp.where(yu2020.is_over(state), -1, yu2020.to_play(self.layout, state))

    def step(self, state: State, move: Array) -> tuple[State, Array]:
        after = yu2020.step(self.layout, state, move)
        return after, (after.clock - state.clock).astype(jnp.float32)

    def is_over(self, state: State) -> Array:
        return yu2020.is_over(state)

    def observe(self, state: State) -> Any:
        if self.sees == "board":
            return yu2020.observe(self.layout, state)
        me = yu2020.to_play(self.layout, state)
        playable = (
            yu2020.bottom(self.layout, state) & (self.layout.who > 0) & ~jnp.any(state.doing, 0)
        )
        piece = jnp.sum(jnp.where(playable, self.cell, 0), 0)
        return features(
            self.ahead,
            self._standing(state),
            me,
            self.way[piece, me],
            jnp.any(playable, 0),
            self.legal(state),
            jnp.zeros(self.moves, bool),
        )

    def least(self, state: State) -> Array:
        return time_to_come(self.ahead, self._standing(state)) * self.unit

    def _standing(self, state: State) -> AssemblyStatus:
        ended = ~state.on.reshape(-1)[self.place]
        doing = state.doing.reshape(2, -1)[:, self.place]
        left = state.left / self.unit
        return AssemblyStatus(
            ended | jnp.any(doing, 0), ended, left @ doing.astype(jnp.float32), left
        )


def _way(task: Array, agent: Array, piece: int, me: int) -> int:
    own = np.flatnonzero(task == piece)
    mine = own[agent[own] == me]
    return int(mine[0] if len(mine) else own[0])
