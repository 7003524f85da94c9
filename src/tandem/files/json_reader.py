"""JSON with places and without duplicate keys. The standard library's reader keeps neither."""

from __future__ import annotations

import json
import re
from bisect import bisect_right
from typing import Any

from tandem.errors import CellError, Fault
from tandem.files.positions import DEPTH, MOST_VALUES, Document, Entry, Node, enter, too_many

BLANK = re.compile(r"[ \t\r\n]*")
NUMBER = re.compile(r"-?(?:0|[1-9][0-9]*)(?:\.[0-9]+)?(?:[eE][-+]?[0-9]+)?")
STRING = re.compile(r'"(?:[^"\\\x00-\x1f]|\\(?:["\\/bfnrt]|u[0-9a-fA-F]{4}))*"')
WORDS = {
    "true": True,
    "false": False,
    "null": None,
    "NaN": float("nan"),
    "Infinity": float("inf"),
    "-Infinity": float("-inf"),
}
WORD = re.compile(r"-?[A-Za-z_][A-Za-z_0-9]*")


def read(text: str, source: str) -> Document:
    """The text as a tree. NaN and Infinity are read, so that whoever needs a number can say where
    one is missing.

    Raises:
      CellError: it is not well-formed JSON, or nests too deep.
    """
    reader = _Reader(text, source)
    place = reader.skip(0)
    if place == len(text):
        raise CellError(
            [Fault("the file is empty. A cell file has `operators` and `tasks`.", (), source)]
        )
    root, place = reader.value(place, 0)
    if (place := reader.skip(place)) != len(text):
        raise reader.malformed(place, "something follows after the end of the document")
    return Document(source, root, reader.faults)


class _Reader:
    """Reads values from a place in the text on; each method returns what it read and where that
    ended.
    """

    def __init__(self, text: str, source: str):
        self.text = text
        self.source = source
        self.starts = [0, *(found.end() for found in re.finditer("\n", text))]
        self.faults: list[Fault] = []
        self.values = 0

    def where(self, place: int) -> tuple[int, int]:
        line = bisect_right(self.starts, place)
        return line, place - self.starts[line - 1] + 1

    def malformed(self, place: int, problem: str) -> CellError:
        line, column = self.where(place)
        return CellError(
            [
                Fault(
                    f"this is not well-formed JSON: {problem}.",
                    (),
                    f"{self.source}:{line}:{column}",
                )
            ]
        )

    def skip(self, place: int) -> int:
        found = BLANK.match(self.text, place)
        return found.end() if found else place

    def value(self, place: int, depth: int) -> tuple[Node, int]:
        line, column = self.where(place)
        self.values += 1
        if self.values > MOST_VALUES:
            raise too_many(self.source, line, column)
        sign = self.text[place : place + 1]
        if sign in ("{", "["):
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
            inside: Any
            inside, end = (
                self.table(place + 1, depth) if sign == "{" else self.items(place + 1, depth)
            )
            return Node(line, column, inside), end
        if sign == '"':
            text, end = self.string(place)
            return Node(line, column, text, text), end
        if found := NUMBER.match(self.text, place):
            text = found.group()
            whole = text.lstrip("-").isdigit() and len(text) < 16
            return Node(line, column, int(text) if whole else float(text), text), found.end()
        if (found := WORD.match(self.text, place)) and found.group() in WORDS:
            return Node(line, column, WORDS[found.group()], None), found.end()
        raise self.malformed(place, "a value is missing" if sign else "the text ends too early")

    def items(self, place: int, depth: int) -> tuple[list[Node], int]:
        items: list[Node] = []
        place = self.skip(place)
        if self.text[place : place + 1] == "]":
            return items, place + 1
        while True:
            node, place = self.value(place, depth + 1)
            items.append(node)
            place = self.skip(place)
            if self.text[place : place + 1] == "]":
                return items, place + 1
            place = self.skip(self.expect(",", place, "a comma or ] is missing"))

    def table(self, place: int, depth: int) -> tuple[dict[str, Entry], int]:
        table: dict[str, Entry] = {}
        place = self.skip(place)
        if self.text[place : place + 1] == "}":
            return table, place + 1
        while True:
            line, column = self.where(place)
            key, place = self.string(place)
            place = self.skip(
                self.expect(":", self.skip(place), "a colon is missing after the key")
            )
            node, place = self.value(place, depth + 1)
            if fault := enter(table, key, Entry(line, column, node, key), self.source):
                self.faults.append(fault)
            place = self.skip(place)
            if self.text[place : place + 1] == "}":
                return table, place + 1
            place = self.skip(self.expect(",", place, "a comma or } is missing"))

    def string(self, place: int) -> tuple[str, int]:
        found = STRING.match(self.text, place)
        if found is None:
            raise self.malformed(
                place,
                'a text in "quotes" is missing or not closed'
                if place < len(self.text)
                else "the text ends too early",
            )
        written = found.group()
        return str(json.loads(written)) if "\\" in written else written[1:-1], found.end()

    def expect(self, sign: str, place: int, problem: str) -> int:
        if self.text[place : place + 1] != sign:
            raise self.malformed(
                place, problem if place < len(self.text) else "the text ends too early"
            )
        return place + 1
