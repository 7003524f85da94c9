"""Who may stand at the station: one person in words, or a population file, which keeps apart who
learners train with and who they are judged with.

    format: 1
    name: Day shift
    train:
      - {person: "pace:0.8..1.5", share: 2}
      - {person: "random:0..0.5+forgetful:0.05"}
    held_out:
      - {person: "prefers:3,1"}

YAML, read as strictly as a cell: unknown keys are refused with the nearest known one, and every
fault is told at its place.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tandem.cell.names import Known
from tandem.errors import CellError, Fault, UsageError
from tandem.files import yaml_reader
from tandem.files.positions import Document
from tandem.world.arrays import Arrays, Names
from tandem.world.behaviour import Group, person, traits
from tandem.world.people import Person, stacked

PARTS = ("train", "held_out")
"""The two parts of a population; nobody may be in both."""

LARGEST = 1_000_000
"""Characters that a population file may have."""


def load(path: str, names: Names) -> dict[str, tuple[Group, ...]]:
    """The groups of both parts for a cell.

    Raises:
      CellError: the file cannot be read or is not of its form, or what it says does not fit the
        cell; with every fault at its place.
    """
    try:
        with open(path, encoding="utf-8") as file:
            text = file.read(LARGEST + 1)
    except OSError as error:
        near = (
            Known(sorted(entry.name for entry in Path(path).parent.glob("*"))).nearest(
                Path(path).name
            )
            if Path(path).parent.is_dir()
            else None
        )
        meant = f" Did you mean {str(Path(path).parent / near)!r}?" if near else ""
        raise CellError(
            [Fault(f"this population file cannot be read: {error.strerror}.{meant}", (), path)]
        ) from error
    except UnicodeDecodeError as error:
        raise CellError(
            [
                Fault(
                    f"the byte 0x{error.object[error.start]:02x} is not UTF-8. Save the file as"
                    " UTF-8.",
                    (),
                    path,
                )
            ]
        ) from error
    if len(text) > LARGEST:
        raise CellError([Fault("a population file has at most a million characters.", (), path)])
    if not text.strip():
        raise CellError(
            [Fault("the file is empty. A population file has `train` and `held_out`.", (), path)]
        )
    return read(yaml_reader.read(text, path), names)


def read(document: Document, names: Names) -> dict[str, tuple[Group, ...]]:
    """The groups that a document describes; raises as `load` does."""
    data, reader = document.plain(), _Reader(document, names)
    if not isinstance(data, dict):
        raise CellError(
            [reader.fault((), "a population file is a mapping with `train` and `held_out`.")]
        )
    reader.known_keys((), data, ("format", "name", *PARTS))
    if data.get("format", 1) != 1:
        reader.note(("format",), f"format is {data['format']!r}; this version reads format 1.")
    groups = {part: reader.part(part, data.get(part)) for part in PARTS}
    for group in groups["held_out"]:
        if group.traits in [other.traits for other in groups["train"]]:
            reader.note(
                ("held_out",),
                f"{group.spec!r} stands in `train`, too. Whoever is held out must not be trained"
                " with.",
            )
    if faults := [*document.faults, *reader.faults]:
        raise CellError(faults)
    return groups


class _Reader:
    """Collects groups and faults."""

    def __init__(self, document: Document, names: Names):
        self.document, self.names = document, names
        self.faults: list[Fault] = []

    def fault(self, path: tuple[str | int, ...], message: str) -> Fault:
        return Fault(message, path, self.document.place(path).text)

    def note(self, path: tuple[str | int, ...], message: str) -> None:
        self.faults.append(self.fault(path, message))

    def known_keys(
        self, path: tuple[str | int, ...], data: dict[str, Any], keys: tuple[str, ...]
    ) -> None:
        for key in data:
            if key not in keys:
                self.note(
                    (*path, key),
                    f"{key!r} is no key of a population file here. {Known(keys).hint(key)}",
                )

    def part(self, part: str, rows: Any) -> tuple[Group, ...]:
        if not isinstance(rows, list) or not rows:
            self.note(
                (part,), f"{part} must be a list of people, with at least one `- {{person: ...}}`."
            )
            return ()
        return tuple(
            group
            for index, row in enumerate(rows)
            if (group := self.group((part, index), row)) is not None
        )

    def group(self, path: tuple[str | int, ...], row: Any) -> Group | None:
        if not isinstance(row, dict) or not isinstance(row.get("person"), str):
            self.note(path, 'each line says who it is in words: {person: "random:0.5", share: 1}.')
            return None
        self.known_keys(path, row, ("person", "share"))
        share = row.get("share", 1)
        if isinstance(share, bool) or not isinstance(share, int | float) or not 0 < share < 1e6:
            self.note((*path, "share"), f"share is {share!r}: give a number above 0.")
            share = 1
        try:
            found = traits(row["person"], self.names, dotted=False)
            return Group(row["person"], found, float(share))
        except UsageError as error:
            for sentence in str(error).splitlines():
                self.note((*path, "person"), sentence)
            return None


@dataclass(frozen=True)
class Crowd:
    """Who may stand at the station.

    Attributes:
      spec: how it was asked for.
      names, arrays: of the cell.
      groups: who is in it.
    """

    spec: str
    names: Names
    arrays: Arrays
    groups: tuple[Group, ...]

    @property
    def is_one(self) -> bool:
        """All of them are alike."""
        return len(self.groups) == 1 and not self.groups[0].varies

    @property
    def makes_mistakes(self) -> bool:
        """Somebody may."""
        return any(trait.kind == "forgetful" for group in self.groups for trait in group.traits)

    def draw(self, rng: np.random.Generator, count: int) -> Person:
        """So many people with a leading axis, drawn by the groups' shares."""
        if self.is_one:
            one = person(self.groups[0].traits, self.names, self.arrays)
            return Person(*(np.broadcast_to(value, (count, *np.shape(value))) for value in one))
        shares = np.array([group.share for group in self.groups])
        of = rng.choice(len(self.groups), count, p=shares / shares.sum())
        return stacked(
            [person(self.groups[group].traits, self.names, self.arrays, rng.random) for group in of]
        )


def crowd(
    spec: str, names: Names, arrays: Arrays, *, part: str = "held_out", dotted: bool = True
) -> Crowd:
    """The people that a text describes: one person, or `population:FILE`.

    Args:
      part: of a population file, "train" or "held_out"; `population:FILE:train` in the text says
        it, too.
      dotted: a kind may be named by where it stands; see `traits`.

    Raises:
      UsageError: the text is wrong.
      CellError: the population file is.
    """
    kind, _, rest = spec.partition(":")
    if kind.strip() == "population":
        file, _, last = rest.rpartition(":")
        path, part = (file, last) if file and last in PARTS else (rest, part)
        return Crowd(spec, names, arrays, load(path.strip(), names)[part])
    found = traits(spec, names, dotted=dotted)
    return Crowd(spec, names, arrays, (Group(spec, found),))
