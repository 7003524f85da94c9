"""Text that remembers where it stands: what the YAML and the JSON reader hand on."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from tandem.cell.names import clean
from tandem.errors import CellError, Fault

Path = tuple[str | int, ...]

DEPTH = 30
"""Levels that a file may nest; a cell needs six."""
MOST_VALUES = 500_000
"""Keys and values that a file may have; a cell of 10,000 tasks has about a hundred thousand."""


class Place(NamedTuple):
    """Where something stands: line and column to sort by, counted from 1, and what a person
    reads.
    """

    line: int
    column: int
    text: str


@dataclass(slots=True)
class Node:
    """One value of a file.

    Attributes:
      line, column: where it begins, counted from 1.
      value: a scalar, a list of nodes, or a dictionary from key to entry.
      text: a scalar as it was written, without quotes.
    """

    line: int
    column: int
    value: Any
    text: str | None = None


class Entry(NamedTuple):
    """One key of a mapping, with the place of the key, its value, and the key as it was written."""

    line: int
    column: int
    node: Node
    written: str


@dataclass
class Document:
    """A file as a tree of nodes.

    Attributes:
      source: what the file is called in messages.
      faults: what is wrong with the text itself though it could be read, such as a key that is
        stated twice.
      notes: what has no place in a cell though it is no fault; a cell file has none.
    """

    source: str
    root: Node
    faults: list[Fault] = field(default_factory=list)
    notes: list[Fault] = field(default_factory=list)

    def plain(self) -> Any:
        """The values alone. Where a name belongs, a number is taken as it was written: task 1.10 is
        not task 1.1.
        """
        return _plain(self.root, ())

    def place(self, path: Path) -> Place:
        """Where the value at the path stands: a mapping's entry at its key. A path that leads
        nowhere stops at its last known step.
        """
        line, column, node = self.root.line, self.root.column, self.root
        for step in path:
            if isinstance(node.value, dict) and str(step) in node.value:
                line, column, node, _ = node.value[str(step)]
            elif isinstance(node.value, list) and isinstance(step, int) and step < len(node.value):
                node = node.value[step]
                line, column = node.line, node.column
            elif isinstance(node.value, dict) and isinstance(step, int):
                continue  # one that stands there without a list around it
            else:
                break
        return Place(line, column, f"{self.source}:{line}:{column}")


def entries(node: Node) -> Iterator[tuple[str, Node]]:
    """Keys and values of a mapping."""
    return ((key, entry.node) for key, entry in node.value.items())


def too_many(source: str, line: int, column: int) -> CellError:
    """The fault of a file that goes on and on."""
    message = (
        f"more than {MOST_VALUES:,} keys and values have been read up to here, the most that a cell"
        " file may have. Split the cell."
    )
    return CellError([Fault(message, (), f"{source}:{line}:{column}")])


def enter(table: dict[str, Entry], key: str, entry: Entry, source: str) -> Fault | None:
    """Puts the entry under its key in the one spelling of names; the fault of a key that stands in
    the mapping already.
    """
    name = clean(key)
    if (first := table.setdefault(name, entry)) is entry:
        return None
    remedy = (
        "Keep one of them."
        if first.written == key
        else "The two are written differently but look alike. Rename or remove one of them."
    )
    message = (
        f"{name!r} is stated twice, first in line {first.line} and again here in line {entry.line}."
        f" {remedy}"
    )
    return Fault(message, (), f"{source}:{entry.line}:{entry.column}")


def _plain(node: Node, path: Path) -> Any:
    if isinstance(node.value, dict):
        return {key: _plain(entry.node, (*path, key)) for key, entry in node.value.items()}
    if isinstance(node.value, list):
        return [_plain(item, (*path, place)) for place, item in enumerate(node.value)]
    if node.text and not isinstance(node.value, str) and _is_name(path, node.value is None):
        return node.text
    return node.value


def _is_name(path: Path, null: bool) -> bool:
    """Whether a scalar there is a name or a title. A null stays one where a name may be absent."""
    match path:
        case (
            ("tasks", _, "after", _)
            | ("tasks", _, "wait", "after")
            | ("tasks", _, "wait", _, "after")
            | ("tasks", _, "together", _, "operators", _)
            | ("tasks", _, "ergonomics", "operators", _)
            | ("tasks", _, "ergonomics", _, "operators", _)
            | ("operators", _, "holds", _, _)
            | ("same_operator", _, _)
        ):
            return True
        case (
            ("name",)
            | ("operators", _, "label" | "tool" | "place")
            | ("tasks", _, "label" | "part" | "tool" | "zone" | "place")
            | ("tasks", _, "tool", _)
            | ("tasks", _, "together", _, "tool")
            | ("tasks", _, "together", _, "tool", _)
        ):
            return not null
    return False
