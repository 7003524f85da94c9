"""Which cell an episode is played on: always the same, one of a folder or a list, or one that a
generator makes; and the room that makes all of them look alike.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tandem.cell.model import Cell
from tandem.errors import UsageError
from tandem.world.arrays import Names

Generator = Callable[[np.random.Generator], Cell]
AnyCells = Cell | str | os.PathLike[str] | Iterable[Cell | str | os.PathLike[str]] | Generator
"""A cell or its file; a folder of them, or a list; or a function that draws one."""

ENDINGS = (".yaml", ".yml", ".json")
"""Of the files that are taken from a folder."""


@dataclass(frozen=True)
class Room:
    """The most that a cell may have: observations, masks and actions are padded to it, so that
    cells of several sizes have the same spaces.

    Attributes:
      tasks, ways: of doing them. `robots`, `humans`, `machines`: who is there.
    """

    tasks: int
    ways: int
    robots: int
    humans: int
    machines: int = 0

    def __post_init__(self) -> None:
        if wrong := [f"{name}={size!r}" for name, size in vars(self).items() if not size >= 0]:
            raise UsageError(f"room: {', '.join(wrong)}: give whole numbers, 0 or more.")

    @classmethod
    def of(cls, names: Names) -> Room:
        """What the cell has."""
        cell = names.cell
        crew = (len(cell.robots), len(cell.humans), len(cell.machines))
        return cls(len(names.tasks), len(names.ways), *crew)

    def with_room_for(self, other: Room) -> Room:
        """As much as both have."""
        return Room(*map(max, vars(self).values(), vars(other).values()))

    def lacks(self, other: Room) -> str:
        """What the other has more of, in words; empty when it fits."""
        return ", ".join(
            f"{getattr(other, part.name)} {part.name} where there is room for"
            f" {getattr(self, part.name)}"
            for part in fields(self)
            if getattr(other, part.name) > getattr(self, part.name)
        )

    @property
    def operators(self) -> int:
        """Of any kind."""
        return self.robots + self.humans + self.machines

    @property
    def size(self) -> int:
        """`D` of a padded observation: `8 T + 6 O + W + 1`, and `3 W` that tell of the ways."""
        return 8 * self.tasks + 6 * self.operators + 4 * self.ways + 1

    def padded(self, observation: NDArray[Any], own: Room, ways: NDArray[Any]) -> NDArray[Any]:
        """`[size]` float32: what `observations.observe` gives for a cell of `own` size, each part
        with zeros behind it, then `ways` (`[3, W]`).
        """
        parts = [*[(own.tasks, self.tasks)] * 8, *[(own.operators, self.operators)] * 6]
        parts += [(own.ways, self.ways), (1, 1), *[(own.ways, self.ways)] * 3]
        whole = np.concatenate([observation, ways.ravel()])
        found, at = [], 0
        for have, room in parts:
            found.append(np.pad(whole[at : at + have], (0, room - have)))
            at += have
        return np.concatenate(found).astype(np.float32)

    def masked(self, mask: NDArray[np.int8]) -> NDArray[np.int8]:
        """`[ways + 1]` int8, the mask with zeros behind it."""
        return np.pad(mask, (0, self.ways + 1 - len(mask)))


class Cells:
    """Where the cells of a face come from.

    Args:
      source: see `AnyCells`.
      room: see `Room`; the largest of a folder or a list when absent, none for a single cell. A
        generator needs one.

    Raises:
      UsageError: a folder without cells, a generator without room, a cell without.
      CellError: a file holds no sound cell.
    """

    def __init__(self, source: Any, room: Room | Mapping[str, int] | None = None) -> None:
        room = Room(**room) if isinstance(room, Mapping) else room
        self.generator: Generator | None = None
        self.known: tuple[Cell, ...] = ()
        if callable(source) and not isinstance(source, type):
            if room is None:
                raise UsageError(
                    "cells of a generator: say how large they may become, room={'tasks': 12,"
                    " 'ways': 24, 'robots': 1, 'humans': 1}."
                )
            self.generator = source
        elif isinstance(source, Cell) or is_one_file(source):
            self.known = (as_cell(source),)
        else:
            self.known = tuple(as_cell(one) for one in listed(source))
            sizes = [Room.of(Names.of(cell)) for cell in self.known]
            largest = sizes[0]
            for size in sizes[1:]:
                largest = largest.with_room_for(size)
            room = room or largest
        self.room = room
        for cell in self.known:
            self.fits(cell)

    def fits(self, cell: Cell) -> Cell:
        """The cell. Raises UsageError when it has no room."""
        own = Room.of(Names.of(cell))
        if self.room is not None and (lacks := self.room.lacks(own)):
            raise UsageError(
                f"cell {cell.name!r}: has {lacks}. Make the environment with more room."
            )
        return cell

    def first(self) -> Cell:
        """One to begin with; the same at each call."""
        return self.known[0] if self.known else self.drawn(np.random.default_rng(0))

    def drawn(self, rng: np.random.Generator) -> Cell:
        """The one of the next episode; nothing is drawn where there is one only."""
        if self.generator is not None:
            made = self.generator(rng)
            if not isinstance(made, Cell):
                raise UsageError(f"the generator made {made!r}, and no tandem.Cell.")
            return self.fits(made)
        return self.known[int(rng.integers(len(self.known))) if len(self.known) > 1 else 0]

    def asked(self, options: Mapping[str, Any] | None, same: Room) -> Cell | None:
        """The cell that `reset(options={"cell": ...})` names, if it does.

        Raises UsageError when it does not fit into the spaces: those of `same` size, where there is
        no room to spare.
        """
        if options is None or options.get("cell") is None:
            return None
        cell = self.fits(as_cell(options["cell"]))
        if self.room is None and (own := Room.of(Names.of(cell))) != same:
            raise UsageError(
                f"cell {cell.name!r}: has {_told(own)}, the environment's has {_told(same)}. Make"
                " the environment with room=..., or of several cells, to play cells of several"
                " sizes."
            )
        return cell


def _told(room: Room) -> str:
    return ", ".join(f"{size} {name}" for name, size in vars(room).items())


def is_one_file(source: Any) -> bool:
    """Whether it names a file, not a folder."""
    return isinstance(source, str | os.PathLike) and not Path(source).is_dir()


def listed(source: Any) -> list[Any]:
    """The cells of a folder, by their names, or of a list. Raises UsageError where there are
    none.
    """
    if isinstance(source, str | os.PathLike):
        found: list[Any] = sorted(
            file for file in Path(source).iterdir() if file.suffix.lower() in ENDINGS
        )
        if not found:
            raise UsageError(f"{source}: the folder holds no cell ({', '.join(ENDINGS)}).")
        return found
    found = list(source)
    if not found:
        raise UsageError("no cell is given: name one at least.")
    return found


def as_cell(cell: Cell | str | os.PathLike[str]) -> Cell:
    """The cell itself, or the one in that file. Raises CellError as `tandem.load` does."""
    if isinstance(cell, Cell):
        return cell
    from tandem.files.load import load

    return load(cell)
