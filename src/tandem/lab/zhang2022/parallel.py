"""Robot and human side by side as PettingZoo wants it: two agents that act at the same time."""

from __future__ import annotations

import os
from typing import Any, ClassVar

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray
from pettingzoo import ParallelEnv

from tandem.cell.model import Cell
from tandem.envs.door import Door, is_legal
from tandem.errors import UsageError
from tandem.lab.kinat2023.game import as_cell
from tandem.lab.zhang2022.display import words
from tandem.lab.zhang2022.setting import AGENTS, HUMAN, ROBOT, duo, setting
from tandem.lab.zhang2022.world import (
    chance,
    choices,
    cost,
    is_done,
    narrow,
    observation_size,
    observe,
    reset,
    step,
)

Observation = dict[str, NDArray[Any]]


class DuoParallel(ParallelEnv[str, Observation, int]):  # type: ignore[misc]
    """`robot_0` and `human_0`; action 0 waits, `i` begins the agent's i-th way of `ways(agent)`,
    alone or jointly.

    Both act at once, but the human's word goes first: an action of the robot that does not fit what
    the human has named becomes the lowest action that does, which is joining where the human asks
    for it. `info["yielded"]` says so. An action that the mask forbids does not raise (unless
    `strict`): the lowest legal one is taken and `info["illegal"]` is True. Each agent is paid minus
    its part of the cost. The other options: those of `tandem.lab.zhang2022.setting`.
    """

    metadata: ClassVar[dict[str, Any]] = {
        "name": "duo_v0",
        "render_modes": [],
        "is_parallelizable": True,
    }

    def __init__(
        self, cell: Cell | str | os.PathLike[str], *, strict: bool = False, **options: float
    ):
        self.cell, self.setting, self.render_mode = as_cell(cell), setting(**options), None
        self.data, self.names = duo(self.cell)
        self.possible_agents = list(AGENTS)
        self.agents: list[str] = []
        size, actions = observation_size(self.data), self.data.pick.shape[1]
        # what is missing can be missing for longer than the longest task takes
        highest = np.full(size, np.inf, np.float32)
        self.observation_spaces = {
            agent: spaces.Dict(
                {
                    "observation": spaces.Box(0 * np.ones(size, np.float32), highest),
                    "action_mask": spaces.MultiBinary(actions),
                }
            )
            for agent in AGENTS
        }
        self.action_spaces = {agent: spaces.Discrete(actions) for agent in AGENTS}
        self._random = np.random.default_rng()
        self._door = Door(dict.fromkeys(AGENTS, actions), strict=strict)

    def observation_space(self, agent: str) -> gymnasium.Space[Any]:
        """The same object at each call."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> gymnasium.Space[Any]:
        """The same object at each call."""
        return self.action_spaces[agent]

    def ways(self, agent: str) -> list[str]:
        """What the agent's actions mean, by number."""
        picks = self.data.pick[AGENTS.index(agent)]
        meant = [self.names.ways[int(np.argmax(pick))] if pick.any() else None for pick in picks]
        return [
            "wait",
            *[f"{way[0]} by {' and '.join(way[1].operators)}" if way else "" for way in meant[1:]],
        ]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Observation], dict[str, dict[str, Any]]]:
        """The first observations; the human's pace and what will happen are drawn with the seed."""
        if seed is not None:
            self._random = np.random.default_rng(seed)
        numbers = {
            "normal": self._random.standard_normal(len(self.cell.tasks)),
            "uniform": self._random.random(4),
        }
        self._state = reset(self.data, *chance(numbers, self.data, self.setting))
        self._difficulty = 0.0
        self.agents = list(AGENTS)
        self._door.open()
        return self._observations(), self._infos([False, False], [False, False])

    def step(
        self, actions: dict[str, int]
    ) -> tuple[
        dict[str, Observation],
        dict[str, float],
        dict[str, bool],
        dict[str, bool],
        dict[str, dict[str, Any]],
    ]:
        """Both act; time runs on until somebody can choose again.

        Raises UsageError for an illegal action when strict, for what is no action, and after the
        end.
        """
        named = list(self._door.numbers(actions).values())
        masks = choices(self.data, self._state)
        illegal = [not is_legal(masks[agent], named[agent]) for agent in (ROBOT, HUMAN)]
        if self._door.strict and any(illegal):
            raise UsageError(self._complaint(named, illegal, masks))
        human = _nearest(named[HUMAN], masks[HUMAN])
        robot = _nearest(named[ROBOT], narrow(self.data, self._state, masks, np.int32(human)))
        self._state, paid = step(
            self.data, self.setting, self._state, np.array([robot, human], np.int32)
        )
        self._difficulty += float(paid.difficulty.sum())
        reward, done = cost(self.setting, paid), bool(is_done(self._state))
        yielded = [not illegal[ROBOT] and robot != named[ROBOT], False]
        self._door.shut_if(done)
        if done:
            self.agents = []
        return (
            self._observations(),
            {agent: -float(reward[i]) for i, agent in enumerate(AGENTS)},
            dict.fromkeys(AGENTS, done),
            dict.fromkeys(AGENTS, False),
            self._infos(illegal, yielded),
        )

    def action_masks(self) -> dict[str, NDArray[np.int8]]:
        """Agent -> `[K]` int8, 1 = legal before the other has named anything."""
        return dict(zip(AGENTS, choices(self.data, self._state).astype(np.int8), strict=True))

    def render(self) -> None:
        """There is no picture of it; `envs.duo.display` says what is shown to the human."""

    def close(self) -> None:
        """Nothing is held open."""

    def _observations(self) -> dict[str, Observation]:
        seen, masks = observe(self.data, self._state), self.action_masks()
        return {
            agent: {"observation": seen.copy(), "action_mask": masks[agent]} for agent in AGENTS
        }

    def _complaint(self, named: list[int], illegal: list[bool], masks: Any) -> str:
        said = [
            f"{agent} named {named[i]} ({self.ways(agent)[named[i]] or 'nothing'}); legal are"
            f" {', '.join(map(str, np.flatnonzero(masks[i])))}"
            for i, agent in enumerate(AGENTS)
            if illegal[i]
        ]
        return f"illegal at {self._now:g} s: {'; '.join(said)}. Take an action from action_masks()."

    @property
    def _now(self) -> float:
        return self.names.seconds(int(self._state.assembly.clock))

    def _infos(self, illegal: list[bool], yielded: list[bool]) -> dict[str, dict[str, Any]]:
        masks, both = self.action_masks(), self._both()
        return {
            agent: {
                "action_mask": masks[agent],
                **both,
                "illegal": illegal[i],
                "yielded": yielded[i],
            }
            for i, agent in enumerate(AGENTS)
        }

    def _both(self) -> dict[str, Any]:
        """What the infos of both agents say."""
        state = self._state
        return {
            "time": self._now,
            "difficulty": self._difficulty,
            "fatigue": float(state.fatigue),
            "happened": words(self.cell, self.names, self.data, state.happened),
            "is_success": bool(is_done(state)),
        }


def _nearest(action: int, legal: NDArray[np.bool_]) -> int:
    """The action, or the lowest legal one."""
    return action if is_legal(legal, action) else int(np.argmax(legal))
