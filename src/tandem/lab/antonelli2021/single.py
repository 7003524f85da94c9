"""The product that can be taken apart, as Gymnasium wants it: the robot decides, the human is part
of the world.
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
from tandem.files.load import load
from tandem.lab.antonelli2021.product import UNMOUNT_SHARE
from tandem.lab.antonelli2021.world import RIGHT, WRONG, Slips, operation_words, repair

Observation = dict[str, NDArray[Any]]


class RepairEnv(gymnasium.Env[Any, Any]):
    """Ask for an operation; get minus the seconds that passed.

    Action: `i` mounts part `i`, `T + i` takes it off. Observation: `[2 T]` float32, which parts sit
    rightly, then which sit wrongly; and the mask, 1 = legal. An illegal action changes nothing and
    costs the longest time there is; `strict=True` raises UsageError instead. `terminated` when all
    parts sit rightly, `truncated` after `limit` operations. `info`, besides the mask: `time`
    (seconds so far), `asked`, `deviated` and `illegal` of the last step, `is_success`.

    Args:
      cell: or the path of its file. p: how often the human slips. slips, unmount_share: see
        `repair`.

    Raises:
      CellError: with everything that the system cannot express. UsageError: a number is out of
        range.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": ["ansi"], "render_fps": 4}  # type: ignore[misc]

    def __init__(
        self,
        cell: Cell | str | os.PathLike[str],
        *,
        p: float = 0.1,
        slips: Slips | None = None,
        unmount_share: float = UNMOUNT_SHARE,
        limit: int = 200,
        strict: bool = False,
        render_mode: str | None = None,
    ):
        self.world = repair(
            cell if isinstance(cell, Cell) else load(cell), slips, unmount_share=unmount_share
        )
        self.process = self.world.process(p)
        self.limit, self.strict, self.render_mode = limit, strict, render_mode
        parts = len(self.world.product.names)
        self.longest = max(*self.world.product.mount, *self.world.product.unmount)
        self.action_space = spaces.Discrete(2 * parts)
        self.observation_space = spaces.Dict(
            {
                "observation": spaces.Box(0.0, 1.0, (2 * parts,), np.float32),
                "action_mask": spaces.MultiBinary(2 * parts),
            }
        )
        self.state, self.operations, self.time = 0, 0, 0.0
        self._door = Door({CONTROLLER: 2 * parts}, strict=strict)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """The empty table; `options={"state": n}` begins in another state of `world.nodes`.

        Raises UsageError for a state that there is not.
        """
        super().reset(seed=seed)
        self.state, self.operations, self.time = int((options or {}).get("state", 0)), 0, 0.0
        if not 0 <= self.state < len(self.world.nodes):
            raise UsageError(
                f"state {self.state}: this product has the states 0 to {len(self.world.nodes) - 1}."
            )
        self._door.open()
        return self._observation(), self._info("", False, False)

    def step(self, action: int) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """One operation, or what the human does in its place.

        Raises UsageError for an illegal action when strict, for what is no action, and after the
        end.
        """
        asked, happens, seconds = self._door.number(action, CONTROLLER), 0, float(self.longest)
        words = operation_words(self.world.product, asked) if asked != OUTSIDE else ""
        legal = is_legal(self.action_masks(), asked)
        if legal:
            chance = self.process.chance[self.state, asked]
            happens = int(self.np_random.choice(len(chance), p=chance))
            seconds = float(self.process.cost[self.state, asked, happens])
            self.state = int(self.process.after[self.state, asked, happens])
        elif self.strict:
            possible = ", ".join(map(str, np.flatnonzero(self.action_masks())))
            raise UsageError(f"action {asked}: {words} is not possible now; legal are {possible}.")
        self.operations, self.time = self.operations + 1, self.time + seconds
        done = bool(self.process.goal[self.state])
        cut = not done and self.operations >= self.limit
        self._door.shut_if(done or cut)
        return self._observation(), -seconds, done, cut, self._info(words, happens > 0, not legal)

    def action_masks(self) -> NDArray[np.int8]:
        """`[2 T]` int8, 1 = legal; all 0 when all parts sit rightly."""
        return np.asarray(self.process.legal[self.state], np.int8)

    def render(self) -> Any:
        """How each part sits, in words."""
        words = {RIGHT: "right", WRONG: "wrong"}
        sits = zip(self.world.product.names, self.world.nodes[self.state], strict=True)
        return (
            ", ".join(f"{name} {words.get(how, 'absent')}" for name, how in sits)
            if self.render_mode == "ansi"
            else None
        )

    def _info(self, asked: str, deviated: bool, illegal: bool) -> dict[str, Any]:
        last = {"asked": asked, "deviated": deviated, "illegal": illegal}
        return {
            "action_mask": self.action_masks(),
            "time": self.time,
            **last,
            "is_success": bool(self.process.goal[self.state]),
        }

    def _observation(self) -> Observation:
        node = np.array(self.world.nodes[self.state])
        return {
            "observation": np.concatenate([node == RIGHT, node == WRONG]).astype(np.float32),
            "action_mask": self.action_masks(),
        }
