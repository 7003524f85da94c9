"""The event world as Gymnasium wants it: a controller of the robots beside people who are part of
the world.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from tandem.envs.cells import AnyCells, Cells, Room
from tandem.envs.door import CONTROLLER, Door, is_legal
from tandem.envs.game import RENDER_MODES, EventGame, Options
from tandem.envs.observations import MOST
from tandem.envs.rewards import Happening
from tandem.envs.view import View
from tandem.errors import UsageError

Observation = dict[str, NDArray[Any]]


class RobotBesideHuman(gymnasium.Env[Any, Any]):
    """One decision at a time: what a robot begins or, at a person's turn, what it is asked to do.
    Action 0 waits, action i is the cell's i-th way.

    A way is one way of doing one task: `env.unwrapped.game.names.ways[i - 1]` names task and
    operators. Robots do as they are told, people as they like (`person`). At one moment people come
    first. With `asks=False` nobody asks people anything: they are suggested the legal task with the
    longest chain behind it, as an instruction sheet would, and only robots' turns come up.

    `cell` may be several: a folder, a list, or a function that draws one from a NumPy generator;
    each episode is played on one of them, and all have the spaces of the largest (`room`).

    The reward is minus the seconds that passed, less `stress_factor` for each unit of stress, or
    what `reward` says. An illegal action counts as waiting, or as the first legal way when waiting
    is none; `strict=True` raises. The same seed gives the same people and the same chance, whatever
    is decided. The other options: see `Options`. `info["episode"]` is left to the wrappers that
    write it.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": list(RENDER_MODES), "render_fps": 4}  # type: ignore[misc]

    def __init__(
        self,
        cell: AnyCells,
        *,
        asks: bool = True,
        room: Room | Mapping[str, int] | None = None,
        **options: Any,
    ):
        self.cells, self.asks = Cells(cell, room), asks
        self.view = View(EventGame(self.cells.first(), Options(**options)), self.cells.room)
        self.render_mode = self.game.options.render_mode
        actions, size = self.view.actions, self.view.size
        self.action_space = spaces.Discrete(actions)
        self.observation_space = spaces.Dict(
            {
                "observation": spaces.Box(
                    np.zeros(size, np.float32), np.full(size, MOST, np.float32), dtype=np.float32
                ),
                "action_mask": spaces.MultiBinary(actions),
            }
        )
        self._door = Door({CONTROLLER: actions}, strict=self.game.options.strict)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """The first observation; people and chance are drawn anew, from the seed when it is
        given. `options={"cell": ...}` names the cell of this episode.

        Raises UsageError for a cell that does not fit into the spaces.
        """
        super().reset(seed=seed)
        self.view = self.view.on(
            self.cells.asked(options, self.view.own) or self.cells.drawn(self.np_random)
        )
        self.game.reset(self.np_random)
        self._door.open()
        self._to_our_turn()
        return self._observation(), self._info(None, False)

    def step(self, action: int) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """One decision.

        Raises UsageError for an illegal action when strict, for what is no action, and after the
        end.
        """
        action, game, before = self._door.number(action, CONTROLLER), self.game, self.game.shift
        illegal = not is_legal(self.action_masks(), action)
        if illegal and game.options.strict:
            raise UsageError(game.complaint(game.turn, action))
        if game.turn >= 0:
            game.decide(-1 if illegal else action - 1)
            self._to_our_turn()
        happening = game.since(before, illegal)
        self._door.shut_if(game.done or game.truncated)
        return (
            self._observation(),
            game.reward(happening),
            game.done,
            game.truncated,
            self._info(happening, illegal),
        )

    def action_masks(self) -> NDArray[np.int8]:
        """`[W + 1]` int8, 1 = legal; never all 0."""
        return self.view.mask(self.game.turn)

    @property
    def game(self) -> EventGame:
        """The shift under way."""
        return self.view.game

    def render(self) -> Any:
        """The schedule so far, as the render mode says: text, pixels, or None."""
        return self.game.render()

    def _to_our_turn(self) -> None:
        """Time runs on, and people begin what they like, until there is something to decide."""
        game = self.game
        game.to_a_turn()
        while not self.asks and game.turn >= 0 and game.arrays.human[game.turn]:
            mine = np.flatnonzero(game.mask(game.turn)[1:])
            game.decide(
                int(max(mine, key=lambda way: (game.arrays.tail[game.arrays.way_task[way]], -way)))
            )
            game.to_a_turn()

    def _observation(self) -> Observation:
        return {
            "observation": self.view.observe(self.game.turn),
            "action_mask": self.action_masks(),
        }

    def _info(self, happening: Happening | None, illegal: bool) -> dict[str, Any]:
        turn = self.game.turn
        return {
            "action_mask": self.action_masks(),
            "turn": self.game.names.operators[turn] if turn >= 0 else "",
            **self.game.info(happening, None, illegal),
        }
