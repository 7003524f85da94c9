"""The chessboard as PettingZoo wants it: robot and human, of whom one chooses at a time."""

from __future__ import annotations

import os
from collections.abc import Container
from typing import Any, ClassVar

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray
from pettingzoo import ParallelEnv

from tandem.cell.model import Cell
from tandem.envs.door import OUTSIDE, Door, is_legal
from tandem.errors import UsageError
from tandem.lab.yu2020.board import Board
from tandem.lab.yu2020.chance import Chance, fate
from tandem.lab.yu2020.layout import layout
from tandem.lab.yu2020.world import HUMAN, ROBOT, is_over, legal, observe, reset, step, to_play

AGENTS = {ROBOT: "robot_0", HUMAN: "human_0"}

Observation = dict[str, NDArray[Any]]


class ChessboardParallel(ParallelEnv[str, Observation, int]):  # type: ignore[misc]
    """`robot_0` and `human_0`; action 0 is "not my turn", `c + 1` takes the piece that starts in
    column `c`.

    Observations are `{"observation": [h, w, 3] float32, "action_mask": [w + 1] int8}`: the authors'
    tensor, and 1 = legal. Exactly one agent has columns to choose from. The other's only legal
    action is 0; which action else it names makes no difference. Both are paid minus the seconds
    that pass. An illegal column of the agent whose turn it is does not raise (unless `strict`): the
    leftmost legal one is taken and `info["illegal"]` is True.

    Args:
      board: a board, or a cell or cell file that can be one.
      chance: how likely failures and errors are; none when absent. The seed of `reset` draws them.
      strict: an illegal action raises UsageError.
    """

    metadata: ClassVar[dict[str, Any]] = {
        "name": "chessboard_v0",
        "render_modes": [],
        "is_parallelizable": True,
    }

    def __init__(
        self,
        board: Board | Cell | str | os.PathLike[str],
        *,
        chance: Chance | None = None,
        strict: bool = False,
    ):
        self.board, self.chance, self.render_mode = _as_board(board), chance, None
        self._layout = layout(self.board)
        self._generator = np.random.default_rng()
        self.possible_agents = list(AGENTS.values())
        self.agents: list[str] = []
        rows, columns = self.board.height, self.board.width
        longest = max(piece.time for piece in self.board.pieces)
        highest = np.broadcast_to(
            np.array([max(longest, 10_000 if chance else 0), 4, columns], np.float32),
            (rows, columns, 3),
        )
        lowest = np.broadcast_to(np.array([0, -2, 0], np.float32), (rows, columns, 3))
        seen = spaces.Box(lowest, highest, dtype=np.float32)
        self.observation_spaces = {
            agent: spaces.Dict(
                {"observation": seen, "action_mask": spaces.MultiBinary(columns + 1)}
            )
            for agent in self.possible_agents
        }
        self.action_spaces = {agent: spaces.Discrete(columns + 1) for agent in self.possible_agents}
        self.state_space = seen
        self._door = Door(dict.fromkeys(self.possible_agents, columns + 1), strict=strict)

    def observation_space(self, agent: str) -> gymnasium.Space[Any]:
        """The same object at each call."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> gymnasium.Space[Any]:
        """The same object at each call."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Observation], dict[str, dict[str, Any]]]:
        """The board before the first move; a new draw of what will go wrong."""
        if seed is not None:
            self._generator = np.random.default_rng(seed)
        self._now, self.agents = reset(self._layout), list(self.possible_agents)
        self._door.open()
        numbers = self._generator.random((3, self.board.height, self.board.width))
        self._fate = None if self.chance is None else fate(self._layout, self.chance, numbers)
        return self._observations(), self._infos(())

    def step(
        self, actions: dict[str, int]
    ) -> tuple[
        dict[str, Observation],
        dict[str, float],
        dict[str, bool],
        dict[str, bool],
        dict[str, dict[str, Any]],
    ]:
        """The agent whose turn it is takes a piece.

        Raises UsageError for an illegal action when strict, for what is no action, and after the
        end.
        """
        named = self._door.numbers(actions)
        mover = AGENTS[int(to_play(self._layout, self._now))]
        mask, illegal = (
            self.action_masks()[mover],
            [agent for agent, number in named.items() if number == OUTSIDE],
        )
        if not is_legal(mask, named[mover]):
            illegal.append(mover)
            if self._door.strict:
                legal_now = ", ".join(map(str, np.flatnonzero(mask)))
                raise UsageError(
                    f"illegal at {self._now.clock} s: {mover} named {named[mover]}; legal are"
                    f" {legal_now}. Take an action from action_masks()."
                )
        column = (int(np.argmax(mask)) if mover in illegal else named[mover]) - 1
        before = int(self._now.clock)
        self._now = step(self._layout, self._now, np.int32(column), self._fate)
        paid, over = float(before - int(self._now.clock)), bool(is_over(self._now))
        self._door.shut_if(over)
        if over:
            self.agents = []
        every = self.possible_agents
        return (
            self._observations(),
            dict.fromkeys(every, paid),
            dict.fromkeys(every, over),
            dict.fromkeys(every, False),
            self._infos(illegal),
        )

    def action_masks(self) -> dict[str, NDArray[np.int8]]:
        """Agent -> `[w + 1]` int8, 1 = legal."""
        open_columns, mover = (
            legal(self._layout, self._now),
            AGENTS[int(to_play(self._layout, self._now))],
        )
        masks = {}
        for agent in self.possible_agents:
            mine = open_columns & (agent == mover)
            masks[agent] = np.concatenate([[not mine.any()], mine]).astype(np.int8)
        return masks

    def state(self) -> NDArray[np.float32]:
        """The tensor: both see the whole board."""
        return np.asarray(observe(self._layout, self._now), np.float32)

    def render(self) -> None:
        """Nothing; `tandem.lab.yu2020.board_picture` draws boards."""

    def close(self) -> None:
        """Nothing is held open."""

    def _observations(self) -> dict[str, Observation]:
        masks = self.action_masks()
        return {
            agent: {"observation": self.state(), "action_mask": masks[agent]}
            for agent in self.possible_agents
        }

    def _infos(self, illegal: Container[str]) -> dict[str, dict[str, Any]]:
        masks, over = self.action_masks(), bool(is_over(self._now))
        return {
            agent: {
                "action_mask": masks[agent],
                "time": float(self._now.clock),
                "illegal": agent in illegal,
                "is_success": over,
            }
            for agent in self.possible_agents
        }


def _as_board(board: Board | Cell | str | os.PathLike[str]) -> Board:
    if isinstance(board, Board):
        return board
    if isinstance(board, Cell):
        return Board.of(board)
    from tandem.files.load import load

    return Board.of(load(board))
