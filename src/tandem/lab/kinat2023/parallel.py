"""The thesis's station as PettingZoo wants it: two agents that act at the same time."""

from __future__ import annotations

import os
import time
from typing import Any, ClassVar

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray
from pettingzoo import ParallelEnv

from tandem.cell.model import Cell
from tandem.envs.door import Door, is_legal
from tandem.lab.kinat2023.game import AGENTS, RENDER_MODES, Game, Options, of_reset, thesis_cell

Observation = dict[str, NDArray[Any]]


class ThesisParallel(ParallelEnv[str, Observation, int]):  # type: ignore[misc]
    """`robot_0` and `human_0`; action 0 waits, `i` names the cell's i-th task. The cell is the
    thesis's when none is given.

    Observations are `{"observation": [D] float32, "action_mask": [T + 1] int8}`, 1 = legal; the
    mask is in `info["action_mask"]` and comes from `action_masks()` too. An illegal action does not
    raise (unless `strict`): it costs what the rewards say, does what the thesis says, and sets
    `info["illegal"]`. Options: see `Options`.
    """

    metadata: ClassVar[dict[str, Any]] = {
        "name": "thesis_v0",
        "render_modes": list(RENDER_MODES),
        "is_parallelizable": True,
        "render_fps": 4,
    }

    def __init__(self, cell: Cell | str | os.PathLike[str] | None = None, **options: Any):
        self.game = Game(thesis_cell() if cell is None else cell, Options(**options))
        self.render_mode = self.game.options.render_mode
        self.possible_agents = list(AGENTS)
        self.agents: list[str] = []
        highest, tasks = self.game.highest(), self.game.tasks
        self.observation_spaces = {
            agent: spaces.Dict(
                {
                    "observation": spaces.Box(np.zeros_like(highest), highest, dtype=np.float32),
                    "action_mask": spaces.MultiBinary(tasks + 1),
                }
            )
            for agent in AGENTS
        }
        self.action_spaces = {agent: spaces.Discrete(tasks + 1) for agent in AGENTS}
        self.state_space = spaces.Box(np.zeros_like(highest), highest, dtype=np.float32)
        self._door = Door(dict.fromkeys(AGENTS, tasks + 1), strict=self.game.options.strict)

    def observation_space(self, agent: str) -> gymnasium.Space[Any]:
        """The same object at each call."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> gymnasium.Space[Any]:
        """The same object at each call."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Observation], dict[str, dict[str, Any]]]:
        """The first observations. The station knows no chance: `seed` is taken and changes
        nothing. `options={"cell": ...}` names the cell of this and the next episodes, of as many
        tasks.
        """
        self.game = of_reset(self.game, options)
        self.game.reset()
        self.agents = list(AGENTS)
        self._door.open()
        self._returns, self._steps, self._since = np.zeros(2), 0, time.monotonic()
        return self._observations(), self._infos(
            [self.game.happenings(agent) for agent in range(2)]
        )

    def step(
        self, actions: dict[str, int]
    ) -> tuple[
        dict[str, Observation],
        dict[str, float],
        dict[str, bool],
        dict[str, bool],
        dict[str, dict[str, Any]],
    ]:
        """Both agents act.

        Raises UsageError for an illegal action when strict, for what is no action, and after the
        end.
        """
        robot, human = self._door.numbers(actions).values()
        masks = self.game.masks()
        broken = (not is_legal(masks[0], robot), not is_legal(masks[1], human))
        reward, happenings = self.game.step((robot, human), broken)
        self._returns, self._steps = self._returns + reward, self._steps + 1
        ended, cut = self.game.done, self.game.truncated
        self._door.shut_if(ended or cut)
        if ended or cut:
            self.agents = []
            for agent, happened in enumerate(happenings):
                taken = round(time.monotonic() - self._since, 6)
                happened["episode"] = {
                    "r": float(self._returns[agent]),
                    "l": self._steps,
                    "t": taken,
                }
        return (
            self._observations(),
            {agent: float(reward[i]) for i, agent in enumerate(AGENTS)},
            dict.fromkeys(AGENTS, ended),
            dict.fromkeys(AGENTS, cut),
            self._infos(happenings),
        )

    def action_masks(self) -> dict[str, NDArray[np.int8]]:
        """Agent -> `[T + 1]` int8, 1 = legal."""
        return dict(zip(AGENTS, self.game.masks(), strict=True))

    def state(self) -> NDArray[np.float32]:
        """What the robot observes: both see the whole station."""
        return np.asarray(self.game.observe()[0])

    def render(self) -> str | NDArray[np.uint8] | None:
        """The schedule so far, as the render mode says: text, pixels, or None."""
        return self.game.render()

    def close(self) -> None:
        """Nothing is held open."""

    def _observations(self) -> dict[str, Observation]:
        seen, masks = self.game.observe(), self.game.masks()
        return {
            agent: {"observation": seen[i], "action_mask": masks[i]}
            for i, agent in enumerate(AGENTS)
        }

    def _infos(self, happenings: list[dict[str, Any]]) -> dict[str, dict[str, Any]]:
        masks = self.game.masks()
        return {agent: {"action_mask": masks[i], **happenings[i]} for i, agent in enumerate(AGENTS)}
