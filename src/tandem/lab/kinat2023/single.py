"""The thesis's station as Gymnasium wants it: one controller for both agents, paid the sum of their
rewards.
"""

from __future__ import annotations

import os
from typing import Any, ClassVar

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from tandem.cell.model import Cell
from tandem.envs.door import CONTROLLER, OUTSIDE, Door, is_legal
from tandem.errors import UsageError
from tandem.lab.kinat2023.decisions import after_human
from tandem.lab.kinat2023.game import RENDER_MODES, Game, Options, of_reset, thesis_cell
from tandem.lab.kinat2023.world import HUMAN, ROBOT

Observation = dict[str, NDArray[Any]]


class ThesisEnv(gymnasium.Env[Any, Any]):
    """One controller of robot and human, in one of two ways, on the thesis's cell when none is
    given.

    `by="decisions"` (the default): one decision at a time. The action is 0, wait, or a task's
    number, for the agent whose turn it is; where both decide at once the human comes first and time
    stands still in between (who has only one choice is not asked). The first two numbers of the
    observation say whose turn it is (robot, human), the next T + 1 what the human has just named.

    `by="ticks"`: every second a joint action, `robot * (T + 1) + human`. The mask leaves out what
    would make the robot yield.

    Observation, mask and illegal actions as in the PettingZoo face; `action_masks()` is what
    sb3-contrib asks for. `info["episode"]` is left to `gymnasium.wrappers.RecordEpisodeStatistics`
    and to SB3's `Monitor`, which insist on writing it.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": list(RENDER_MODES), "render_fps": 4}  # type: ignore[misc]

    def __init__(self, cell: Cell | str | os.PathLike[str] | None = None, **options: Any):
        self.game = Game(
            thesis_cell() if cell is None else cell,
            Options(**{"by": "decisions", "observation": "normalised", **options}),
        )
        self.render_mode = self.game.options.render_mode
        self.joint = self.game.options.by == "ticks"
        actions = self.game.tasks + 1
        turn = [] if self.joint else [np.ones(2 + actions, np.float32)]
        highest = np.concatenate([*turn, self.game.highest()])
        self.action_space = spaces.Discrete(actions**2 if self.joint else actions)
        self.observation_space = spaces.Dict(
            {
                "observation": spaces.Box(np.zeros_like(highest), highest, dtype=np.float32),
                "action_mask": spaces.MultiBinary(actions**2 if self.joint else actions),
            }
        )
        self.turn, self.named = HUMAN, 0
        self._door = Door({CONTROLLER: int(self.action_space.n)}, strict=self.game.options.strict)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """The first observation. The station knows no chance: `seed` is taken and changes
        nothing. `options={"cell": ...}` names the cell of this and the next episodes, of as many
        tasks.
        """
        super().reset(seed=seed)
        self.game = of_reset(self.game, options)
        self.game.reset()
        self._door.open()
        self._next_turn()
        return self._observation(), self._info([self.game.happenings(agent) for agent in range(2)])

    def step(self, action: int) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """One decision or one second.

        Raises UsageError for an illegal action when strict, for what is no action, and after the
        end.
        """
        action = self._door.number(action, CONTROLLER)
        illegal = not is_legal(self.action_masks(), action)
        if self.joint:
            robot, human = (
                (OUTSIDE, OUTSIDE) if action == OUTSIDE else divmod(action, self.game.tasks + 1)
            )
            masks = self.game.masks()
            broken = (not is_legal(masks[ROBOT], robot), not is_legal(masks[HUMAN], human))
            reward, happenings = self.game.step((robot, human), broken)
        elif self.turn == HUMAN and self._left_to_the_robot(action).sum() > 1:
            return self._then_the_robot(action, illegal)
        else:
            joint = (
                (action, self.named)
                if self.turn == ROBOT
                else (int(self._left_to_the_robot(action).argmax()), action)
            )
            reward, happenings = self.game.step(
                joint, (illegal and self.turn == ROBOT, illegal and self.turn == HUMAN)
            )
            self._next_turn()
        info = self._info(happenings)
        info["illegal"] = info["illegal"] or (illegal and not self.joint)
        self._door.shut_if(self.game.done or self.game.truncated)
        return self._observation(), float(reward.sum()), self.game.done, self.game.truncated, info

    def action_masks(self) -> NDArray[np.int8]:
        """`[A]` int8, 1 = legal; never all 0."""
        masks = self.game.masks()
        if self.joint:
            both = masks[ROBOT][:, None] * masks[HUMAN]
            np.fill_diagonal(both[1:, 1:], 0)
            flat: NDArray[np.int8] = both.ravel()
            return flat
        if self.turn == HUMAN:
            return np.asarray(masks[HUMAN])
        return self._left_to_the_robot(self.named)

    def render(self) -> Any:
        """The schedule so far, as the render mode says: text, pixels, or None."""
        return self.game.render()

    def _then_the_robot(
        self, action: int, illegal: bool
    ) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """The human has named; no time passes, the robot is asked."""
        if illegal and self.game.options.strict:
            raise UsageError(
                f"the human named {action}; legal are"
                f" {', '.join(map(str, np.flatnonzero(self.action_masks())))}. Take an action from"
                " action_masks()."
            )
        self.turn, self.named = ROBOT, action
        info = self._info(
            [self.game.happenings(ROBOT), self.game.happenings(HUMAN, broken=illegal)]
        )
        return self._observation(), 0.0, False, False, info

    def _left_to_the_robot(self, human: int) -> NDArray[np.int8]:
        return np.asarray(
            after_human(self.game.state, self.game.masks().astype(bool), np.int32(human)), np.int8
        )

    def _next_turn(self) -> None:
        """The human's, when the human decides; else the robot's."""
        self.turn, self.named = (HUMAN if self.game.deciding()[HUMAN] else ROBOT), 0

    def _observation(self) -> Observation:
        seen = self.game.observe()[self.turn if not self.joint else ROBOT]
        if not self.joint:
            turn, named = np.zeros(2, np.float32), np.zeros(self.game.tasks + 1, np.float32)
            turn[self.turn] = 1.0
            if self.named != OUTSIDE:
                named[self.named] = 1.0
            seen = np.concatenate([turn, named, seen])
        return {"observation": seen, "action_mask": self.action_masks()}

    def _info(self, happenings: list[dict[str, Any]]) -> dict[str, Any]:
        """Both agents' happenings in one: what is said per agent becomes a pair (robot, human),
        idle seconds add up.
        """
        robot, human = happenings
        each = {key: (robot[key], human[key]) for key in ("task_started", "task_finished")}
        both = {
            "idle": robot["idle"] + human["idle"],
            "illegal": robot["illegal"] or human["illegal"],
        }
        return {"action_mask": self.action_masks(), **robot, **each, **both}
