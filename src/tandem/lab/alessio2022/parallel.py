"""The grid as PettingZoo wants it: both agents name an action, and the one on turn moves."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray
from pettingzoo import ParallelEnv

from tandem.envs.door import Door, is_legal
from tandem.errors import UsageError
from tandem.lab.alessio2022 import world
from tandem.lab.alessio2022.layout import Layout, layout
from tandem.lab.alessio2022.observations import OBSERVATIONS, observe
from tandem.lab.alessio2022.pictures import text
from tandem.lab.alessio2022.world import ROBOT, Rewards

AGENTS = ("robot_0", "human_0")
RENDER_MODES = ("ansi",)
Observation = dict[str, NDArray[Any]]


@dataclass(frozen=True)
class Options:
    """How the grid is played.

    Attributes:
      rewards: what is paid.
      observation: "published" or "marked", see `tandem.lab.alessio2022.observations`.
      first: who moves first, "robot" or "human".
      limit: moves of both together after which an episode is cut off.
      closing: squares that were visited are closed.
      strict: an impossible move raises instead of costing.
      render_mode: None or "ansi", the grid as text.
    """

    rewards: Rewards = field(default_factory=Rewards)
    observation: str = "published"
    first: str = "robot"
    limit: int | None = None
    closing: bool = True
    strict: bool = False
    render_mode: str | None = None

    def __post_init__(self) -> None:
        wrong = [
            f"{name} {getattr(self, name)!r}: choose {' or '.join(map(repr, known))}."
            for name, known in (
                ("observation", (*OBSERVATIONS,)),
                ("first", ("robot", "human")),
                ("render_mode", (None, *RENDER_MODES)),
            )
            if getattr(self, name) not in known
        ]
        if self.limit is not None and self.limit < 1:
            wrong.append(f"limit {self.limit}: must be 1 or more.")
        if wrong:
            raise UsageError("\n".join(wrong))


class GridParallel(ParallelEnv[str, Observation, int]):  # type: ignore[misc]
    """`robot_0` and `human_0`; actions wait, up, down, left, right. Who is not on turn can only
    wait.

    Observations are `{"observation": [4 S] float32, "action_mask": [5] int8}`, 1 = possible; the
    mask is in `info["action_mask"]` and comes from `action_masks()` too. An impossible move does
    not raise (unless strict): it costs `rewards.illegal`, moves nobody and sets `info["illegal"]`.
    Which action the agent that is not on turn names makes no difference, but one it has to be.
    """

    metadata: ClassVar[dict[str, Any]] = {
        "name": "grid_v0",
        "render_modes": list(RENDER_MODES),
        "is_parallelizable": True,
        "render_fps": 4,
    }

    def __init__(self, drawn: str | Layout = "crossing", **options: Any):
        self.layout, self.options = layout(drawn), Options(**options)
        self.grid = world.grid(
            self.layout,
            first=ROBOT if self.options.first == "robot" else 1 - ROBOT,
            limit=self.options.limit,
            closing=self.options.closing,
        )
        self.render_mode = self.options.render_mode
        self.possible_agents = list(AGENTS)
        self.agents: list[str] = []
        size = 4 * len(self.layout.text)
        seen = {
            "observation": spaces.Box(-1.0, 1.0, (size,), np.float32),
            "action_mask": spaces.MultiBinary(len(world.ACTIONS)),
        }
        self.observation_spaces = {agent: spaces.Dict(dict(seen)) for agent in AGENTS}
        self.action_spaces = {agent: spaces.Discrete(len(world.ACTIONS)) for agent in AGENTS}
        self.state_space = spaces.Box(-1.0, 1.0, (size,), np.float32)
        self._state = world.reset(self.grid)
        self._door = Door(dict.fromkeys(AGENTS, len(world.ACTIONS)), strict=self.options.strict)

    def observation_space(self, agent: str) -> gymnasium.Space[Any]:
        """The same object at each call."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> gymnasium.Space[Any]:
        """The same object at each call."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Observation], dict[str, dict[str, Any]]]:
        """The first observations. The grid knows no chance: `seed` is taken and changes nothing."""
        self._state, self.agents = world.reset(self.grid), list(AGENTS)
        self._door.open()
        return self._observations(), self._infos([0, 0])

    def step(
        self, actions: dict[str, int]
    ) -> tuple[
        dict[str, Observation],
        dict[str, float],
        dict[str, bool],
        dict[str, bool],
        dict[str, dict[str, Any]],
    ]:
        """The agent on turn moves.

        Raises UsageError for an impossible move when strict, for what is no action, and after the
        end.
        """
        named, mover = self._door.numbers(actions), AGENTS[int(self._state.turn)]
        if self.options.strict and not is_legal(self.action_masks()[mover], named[mover]):
            square = int(self._state.position[self._state.turn])
            raise UsageError(
                f"{mover} cannot go {world.ACTIONS[named[mover]]} from square {square}."
            )
        chosen = np.array([named[agent] for agent in AGENTS])
        self._state, reward, over, illegal = world.step(
            self.grid, self.options.rewards, self._state, chosen
        )
        ended = bool(over) and not (
            int(self._state.reached) == world.NOWHERE
            and int(self._state.clock) >= int(self.grid.limit)
        )
        self._door.shut_if(bool(over))
        if over:
            self.agents = []
        return (
            self._observations(),
            {agent: float(reward[i]) for i, agent in enumerate(AGENTS)},
            dict.fromkeys(AGENTS, ended),
            dict.fromkeys(AGENTS, bool(over) and not ended),
            self._infos(illegal),
        )

    def action_masks(self) -> dict[str, NDArray[np.int8]]:
        """Agent -> `[5]` int8, 1 = possible."""
        return dict(zip(AGENTS, world.legal(self.grid, self._state).astype(np.int8), strict=True))

    def state(self) -> NDArray[np.float32]:
        """What both observe."""
        return np.asarray(observe(self.grid, self._state, OBSERVATIONS[self.options.observation]))

    def render(self) -> str | None:
        """The grid as text when the render mode is "ansi"."""
        return text(self.layout, self._state) if self.render_mode == "ansi" else None

    def close(self) -> None:
        """Nothing is held open."""

    def _observations(self) -> dict[str, Observation]:
        masks = self.action_masks()
        return {
            agent: {"observation": self.state(), "action_mask": masks[agent]} for agent in AGENTS
        }

    def _infos(self, illegal: Any) -> dict[str, dict[str, Any]]:
        masks, state = self.action_masks(), self._state
        both = {
            "time": int(state.clock),
            "is_success": bool(world.is_success(state)),
            "reached": ("", "right", "wrong")[int(state.reached)],
        }
        return {
            agent: {"action_mask": masks[agent], "illegal": bool(illegal[i]), **both}
            for i, agent in enumerate(AGENTS)
        }
