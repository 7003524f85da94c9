"""YAML as people write it by hand, read strictly.

Scalars follow YAML 1.2: only `true` and `false` are truth values, `010` is ten, `1:30` and `1_000`
are text. Keys are text, in the one spelling of names. Tags, anchors and aliases are refused: they
can run code or grow without end, and a cell needs none.
"""

from __future__ import annotations

import re
from typing import Any

import yaml

from tandem.errors import CellError, Fault
from tandem.files.positions import DEPTH, MOST_VALUES, Document, Entry, Node, enter, too_many

INTEGER = re.compile(r"[-+]?[0-9]+")
FLOAT = re.compile(r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?")
SPECIAL = {
    "": None,
    "~": None,
    "null": None,
    "Null": None,
    "NULL": None,
    "true": True,
    "false": False,
}
INFINITE = re.compile(r"[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)")
MOST = 20
"""Refused signs told of at once."""

# libyaml is ten times faster; PyYAML can be built without it
_Parser = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def read(text: str, source: str) -> Document:
    """The text as a tree.

    Raises:
      CellError: it is not well-formed YAML, holds several documents, nests too deep, or uses tags,
        anchors or aliases.
    """
    try:
        reader = _Reader(text, source)
        document = reader.document()
    except yaml.MarkedYAMLError as error:
        raise CellError([_malformed(error, text, source)]) from error
    except yaml.YAMLError as error:
        raise CellError([Fault(f"this is not well-formed YAML: {error}.", (), source)]) from error
    if reader.refused:
        raise CellError(reader.refused)
    return document


class _Reader:
    """Turns the parser's events into nodes."""

    def __init__(self, text: str, source: str):
        self.source = source
        self.parser = _Parser(text)
        self.refused: list[Fault] = []
        self.faults: list[Fault] = []
        self.values = 0

    def document(self) -> Document:
        self.parser.get_event()  # the stream begins
        if isinstance(event := self.parser.get_event(), yaml.StreamEndEvent):
            raise CellError(
                [
                    Fault(
                        "the file is empty. A cell file has `operators` and `tasks`.",
                        (),
                        self.source,
                    )
                ]
            )
        root = self.node(self.parser.get_event(), 0)
        self.parser.get_event()  # the document ends
        if not isinstance(event := self.parser.get_event(), yaml.StreamEndEvent):
            self.refuse(event, "a second document begins here (`---`). Keep one cell in one file.")
        return Document(self.source, root, self.faults)

    def node(self, event: Any, depth: int) -> Node:
        line, column = event.start_mark.line + 1, event.start_mark.column + 1
        self.values += 1
        if self.values > MOST_VALUES:
            raise too_many(self.source, line, column)
        if isinstance(event, yaml.AliasEvent):
            self.refuse(
                event,
                f"*{event.anchor} repeats an anchored value. Cell files know no anchors; write the"
                " value out.",
            )
            return Node(line, column, None)
        if event.anchor is not None:
            self.refuse(
                event,
                f"&{event.anchor} is an anchor. Cell files know no anchors; write the value out"
                " wherever it is needed.",
            )
        if event.tag is not None:
            self.refuse(
                event,
                f"{_tag(event.tag)} is a tag. Cell files know no tags, because they can run code;"
                " take it out.",
            )
        if isinstance(event, yaml.ScalarEvent):
            return Node(
                line,
                column,
                event.value if event.style else scalar(event.value),
                event.value if event.value or event.style else None,
            )
        if depth == DEPTH:
            raise CellError(
                [
                    Fault(
                        f"the file nests deeper than {DEPTH} levels. A cell needs six.",
                        (),
                        f"{self.source}:{line}:{column}",
                    )
                ]
            )
        if isinstance(event, yaml.SequenceStartEvent):
            items = []
            while not isinstance(event := self.parser.get_event(), yaml.SequenceEndEvent):
                items.append(self.node(event, depth + 1))
            return Node(line, column, items)
        return Node(line, column, self.mapping(depth))

    def mapping(self, depth: int) -> dict[str, Entry]:
        table: dict[str, Entry] = {}
        while not isinstance(event := self.parser.get_event(), yaml.MappingEndEvent):
            key = self.node(event, depth + 1)
            value = self.node(self.parser.get_event(), depth + 1)
            if isinstance(key.value, list | dict) or isinstance(event, yaml.AliasEvent):
                if not isinstance(event, yaml.AliasEvent):
                    self.refuse(event, "a key must be a plain name, not a list or a mapping.")
                continue
            name = key.text or ""
            if fault := enter(table, name, Entry(key.line, key.column, value, name), self.source):
                self.faults.append(fault)
        return table

    def refuse(self, event: Any, message: str) -> None:
        self.refused.append(
            Fault(
                message,
                (),
                f"{self.source}:{event.start_mark.line + 1}:{event.start_mark.column + 1}",
            )
        )
        if len(self.refused) >= MOST:
            raise CellError(self.refused)


def scalar(text: str) -> Any:
    """What a plain scalar means in YAML 1.2: a number, a truth value, nothing, or text."""
    if text in SPECIAL:
        return SPECIAL[text]
    if INTEGER.fullmatch(text):
        return int(text) if len(text) < 16 else float(text)
    if FLOAT.fullmatch(text):
        return float(text)
    return float(text.replace(".", "")) if INFINITE.fullmatch(text) else text


def _tag(tag: str) -> str:
    return tag.replace("tag:yaml.org,2002:", "!!")


def _malformed(error: yaml.MarkedYAMLError, text: str, source: str) -> Fault:
    mark = error.problem_mark or error.context_mark
    if mark is None:
        return Fault(f"this is not well-formed YAML: {error.problem}.", (), source)
    place = f"{source}:{mark.line + 1}:{mark.column + 1}"
    lines = text.splitlines()
    rest = lines[mark.line][: mark.column + 1] if mark.line < len(lines) else ""
    if "\t" in rest:
        return Fault("a tab stands here. YAML indents with blanks; replace the tab.", (), place)
    began = (
        f" ({error.context}, which began in line {error.context_mark.line + 1})"
        if error.context and error.context_mark
        else ""
    )
    return Fault(f"this is not well-formed YAML: {error.problem}{began}.", (), place)
