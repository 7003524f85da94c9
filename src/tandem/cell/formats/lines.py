"""What the formats made of lines of numbers have in common: words with their line, and a cell that knows where it came from."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import PurePath
from typing import Any, NamedTuple

from tandem.cell.marked import Path, Place
from tandem.cell.names import harm_in
from tandem.errors import CellError, Fault


class Row(NamedTuple):
    """A line that says something: its number, counted from 1, and its words."""

    line: int
    words: list[str]


@dataclass
class Translated:
    """A cell as plain values, and for each part the line of the file that it was made of.

    Attributes:
      source: what the file is called in messages.
      lines: path in the cell -> line, or line and column, of the file.
    """

    source: str
    data: dict[str, Any]
    lines: Mapping[Path, int | tuple[int, int]]
    faults: list[Fault] = field(default_factory=list)

    def plain(self) -> Any:
        """The cell, keyed as in a cell file."""
        return self.data

    def place(self, path: Path) -> Place:
        """The line of the nearest part around the path that has one; the first line for all else."""
        for length in range(len(path), 0, -1):
            if (where := self.lines.get(path[:length])) is not None:
                line, column = where if isinstance(where, tuple) else (where, 1)
                return Place(line, column, f"{self.source}:{line}" if isinstance(where, int) else f"{self.source}:{line}:{column}")
        return Place(1, 1, f"{self.source}:1")


def rows(text: str) -> list[Row]:
    """The lines that are neither blank nor a remark."""
    lines = ((number, line.split()) for number, line in enumerate(text.splitlines(), 1))
    return [Row(number, words) for number, words in lines if words and not words[0].startswith("#")]


def title(source: str) -> str:
    """The cell's name: the file's, without folder and ending. A file's name may hold bytes that are no text; these are shown as "?"."""
    return "".join("?" if harm_in(sign) else sign for sign in PurePath(source).stem)


def broken(source: str, line: int, message: str) -> CellError:
    """The one fault of a file that is not of its form."""
    return CellError([Fault(message, (), f"{source}:{line}")])


def whole(source: str, line: int, word: str, what: str) -> int:
    """A whole number, 0 or more.

    Raises:
      CellError: it is none.
    """
    if not (word.isascii() and word.isdigit()):
        raise broken(source, line, f"{what} is {word!r}, but a whole number is needed.")
    return int(word[:18])


def seconds(source: str, line: int, word: str, what: str) -> float:
    """A time as written; whether it is more than 0 is judged with the cell.

    Raises:
      CellError: it is no number.
    """
    try:
        value = float(word)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise broken(source, line, f"{what} is {word!r}, but a number is needed.")
    return value
