"""A game as a face shows it: as it is, or padded to the room that cells of several sizes share."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tandem.cell.model import Cell
from tandem.envs.cells import Room
from tandem.envs.game import EventGame, ways_of


@dataclass(frozen=True)
class View:
    """One shift, and the room for what is seen of it.

    Attributes:
      room: None: everything is as large as the cell.
    """

    game: EventGame
    room: Room | None = None

    def on(self, cell: Cell) -> View:
        """The same on that cell."""
        if cell is self.game.cell or cell.digest == self.game.cell.digest:
            return self
        return View(EventGame(cell, self.game.options, free=self.game.free), self.room)

    @cached_property
    def own(self) -> Room:
        """What the cell takes."""
        return Room.of(self.game.names)

    @cached_property
    def ways(self) -> NDArray[np.float32]:
        """`[3, W]`, see `game.ways_of`."""
        return ways_of(self.game.arrays)

    @property
    def actions(self) -> int:
        """How many there are, waiting included."""
        return (self.own if self.room is None else self.room).ways + 1

    @property
    def size(self) -> int:
        """`D` of an observation."""
        return self.game.observe(0).size if self.room is None else self.room.size

    @property
    def possible_agents(self) -> list[str]:
        """`robot_0`, ..., `machine_0`, ..., `human_0`, ..., of all cells that there is room for."""
        room = self.own if self.room is None else self.room
        kinds = (("robot", room.robots), ("machine", room.machines), ("human", room.humans))
        return [f"{kind}_{index}" for kind, number in kinds for index in range(number)]

    def observe(self, operator: int) -> NDArray[np.float32]:
        """`[D]`, see `observations.observe` and `Room.padded`."""
        seen = self.game.observe(operator)
        return seen if self.room is None else self.room.padded(seen, self.own, self.ways)

    def mask(self, operator: int) -> NDArray[np.int8]:
        """`[W + 1]`, 1 = legal; 0 waits."""
        mask = self.game.mask(operator)
        return mask if self.room is None else self.room.masked(mask)
