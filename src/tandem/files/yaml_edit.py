"""A YAML file changed where its cell has changed, and nowhere else: comments, the order of keys and
how values are written stay as they are in all the rest.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import yaml

from tandem.cell.model import Cell
from tandem.cell.names import clean
from tandem.errors import CellError
from tandem.files.validate import cell_of
from tandem.files.yaml_reader import read
from tandem.files.yaml_writer import NAMES, flow, to_yaml

_Loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
ABSENT = object()
ORDERED = ("operators", "tasks")
"""Where the order of keys means something to whoever reads the cell."""


def changed(text: str, before: Mapping[str, Any], cell: Cell) -> str:
    """The file's text, such that it holds this cell.

    Args:
      text: of a YAML file that can be read.
      before: what stands in it, as a cell is written or, of an unsound one, as it stands there.

    Whatever cannot be changed in place is written anew, the whole file if need be.
    """
    after = cell.to_dict()
    mark = "\ufeff" if text.startswith("\ufeff") else ""
    text = text.removeprefix(mark)
    try:
        root = yaml.compose(text, Loader=_Loader)
        edited = _Edit(text).document(root, before, after)
        document = read(edited, "")
        if _says(cell_of(document.plain(), document.place, document.faults), after):
            return mark + edited
    except (CellError, yaml.YAMLError, _CannotError):
        pass
    return to_yaml(cell)


def _says(cell: Cell, after: Mapping[str, Any]) -> bool:
    """Whether the cell is the one that was wanted, its tasks and operators in that order."""
    found = cell.to_dict()
    ordered = all(list(found[key]) == list(after[key]) for key in ORDERED)
    return ordered and found == dict(after)


class _CannotError(Exception):
    """The text is not laid out as it has to be for this."""


class _Place(NamedTuple):
    """Of a mapping: the key at which it stands, and whether names stand there."""

    key: str
    is_name: bool

    @property
    def is_ordered(self) -> bool:
        return self.key in ORDERED


class _Entry(NamedTuple):
    """A key of a mapping and what stands there, as places in the text."""

    key: int
    key_end: int
    value: int
    end: int
    node: yaml.Node


@dataclass(frozen=True)
class _Edit:
    """What each node's text becomes."""

    text: str

    def document(self, root: yaml.Node | None, before: Any, after: Any) -> str:
        if not isinstance(root, yaml.MappingNode) or not root.value:
            raise _CannotError
        begin, end = root.start_mark.index, self.end(root)
        told = self.node(root, before, after, _Place("", False))
        return self.text[:begin] + told + self.text[end:]

    def end(self, node: yaml.Node) -> int:
        """Where the text of a node ends; of a block with the line on which its last value does."""
        is_block = isinstance(node, yaml.CollectionNode) and not node.flow_style
        if not is_block or not node.value:
            end: int = node.end_mark.index
            if getattr(node, "style", None) in ("|", ">"):
                end = node.start_mark.index + len(
                    self.text[node.start_mark.index : end].rstrip("\r\n ")
                )
            return end
        last = node.value[-1]
        return self._line_end(self.end(last[1] if isinstance(last, tuple) else last))

    def _line_end(self, place: int) -> int:
        end = self.text.find("\n", place)
        return len(self.text) if end < 0 else end

    def node(self, node: yaml.Node, before: Any, after: Any, place: _Place) -> str:
        """The text of a node that said `before` and is to say `after`."""
        if _are_changed_within(node, before, after):
            within = self._in_flow if node.flow_style else self._in_block
            return within(node, before, after, place)
        return flow(after, place.is_name)

    def _entries(self, node: yaml.MappingNode) -> dict[str, _Entry]:
        found = {}
        for key, value in node.value:
            place = value.start_mark.index
            found[clean(key.value)] = _Entry(
                key.start_mark.index, key.end_mark.index, place, self.end(value), value
            )
        return found

    def _kept(
        self, name: str, entry: _Entry, before: Mapping[str, Any], value: Any, place: _Place
    ) -> str:
        """Key and value of an entry that stays."""
        within = _Place(name, place.is_name or name in NAMES)
        was = before.get(name, ABSENT)
        if was == value and not (within.is_ordered and list(was) != list(value)):
            return self.text[entry.key : entry.end]
        told = self.node(entry.node, was, value, within)
        is_block = isinstance(entry.node, yaml.CollectionNode) and not entry.node.flow_style
        if is_block and not _are_changed_within(entry.node, was, value):
            # what stood on lines of its own now follows its key
            return f"{self.text[entry.key : entry.key_end]}: {told}"
        head = self.text[entry.key : entry.value]
        return f"{head}{'' if head[-1:].isspace() else ' '}{told}"

    def _in_block(
        self,
        node: yaml.MappingNode,
        before: Mapping[str, Any],
        after: Mapping[str, Any],
        place: _Place,
    ) -> str:
        """Lines: each entry goes with the comment behind it and the lines of comment before it."""
        entries = self._entries(node)
        indent = " " * node.start_mark.column
        ending = "\r" if "\r\n" in self.text else ""
        lead = self._leads(node, entries, indent)
        told = []
        for key, value in self._wanted(entries, before, after, place):
            if key in entries:
                entry = entries[key]
                behind = self.text[entry.end : self._line_end(entry.end)]
                told.append(lead[key] + self._kept(key, entry, before, value, place) + behind)
            else:
                told.append(f"{indent}{_new(key, value, place.is_name)}{ending}")
        # the first line is indented by what stands before the node
        return "\n".join(told).removeprefix(indent)

    def _leads(
        self, node: yaml.MappingNode, entries: Mapping[str, _Entry], indent: str
    ) -> dict[str, str]:
        """What stands on the lines before each key, its indent included."""
        found, end = {}, -1
        for key, entry in entries.items():
            found[key] = indent if end < 0 else self.text[end + 1 : entry.key]
            if end >= 0 and self.text[end : end + 1] != "\n":
                raise _CannotError
            end = self._line_end(entry.end)
        return found

    def _in_flow(
        self,
        node: yaml.MappingNode,
        before: Mapping[str, Any],
        after: Mapping[str, Any],
        place: _Place,
    ) -> str:
        """`{a: 1, b: 2}`: what stands between two entries stays where both do."""
        entries = self._entries(node)
        names = list(entries)
        begin, end = node.start_mark.index, self.end(node)
        told, last = self.text[begin : entries[names[0]].key], None
        for key, value in self._wanted(entries, before, after, place):
            if last is not None:
                told += self._between(entries, names, last, key)
            entry = entries.get(key)
            told += (
                _new(key, value, place.is_name)
                if entry is None
                else self._kept(key, entry, before, value, place)
            )
            last = key
        return told + self.text[entries[names[-1]].end : end]

    def _between(
        self, entries: Mapping[str, _Entry], names: list[str], first: str, then: str
    ) -> str:
        if first in entries and then in entries and names.index(then) == names.index(first) + 1:
            return self.text[entries[first].end : entries[then].key]
        return ", "

    def _wanted(
        self,
        entries: Mapping[str, _Entry],
        before: Mapping[str, Any],
        after: Mapping[str, Any],
        place: _Place,
    ) -> Iterator[tuple[str, Any]]:
        """Keys and values that the mapping is to have: those that stand there in their own order,
        unless the order itself was changed; a new one after the one that it follows.
        """
        said = [key for key in after if key in entries or before.get(key, ABSENT) != after[key]]
        stay = [key for key in said if key in entries]
        if not place.is_ordered or [key for key in before if key in stay] == stay:
            # what was written in another order than a cell is written in, stays so
            own = iter([key for key in entries if key in stay])
            said = [next(own) if key in entries else key for key in said]
        yield from ((key, after[key]) for key in said)


def _are_changed_within(node: yaml.Node, before: Any, after: Any) -> bool:
    """Whether single entries of the node change, and not the whole."""
    is_mapping = isinstance(before, Mapping) and isinstance(after, Mapping)
    return isinstance(node, yaml.MappingNode) and is_mapping and bool(node.value and after)


def _new(key: str, value: Any, is_name: bool) -> str:
    """An entry that was not there: key, colon, value."""
    return flow({key: value}, is_name)[1:-1]
