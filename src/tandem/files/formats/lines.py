"""What the formats made of lines of numbers have in common: words with their line, and a cell that
knows where it came from.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import islice
from pathlib import PurePath
from typing import Any, NamedTuple

from tandem.cell.names import harm_in
from tandem.errors import CellError, Fault
from tandem.files.positions import Path, Place

MOST_OPERATORS = 1_000
MOST_WAYS = 2_000_000
NUMBERLIKE = re.compile(
    r"[-+]?(?:[0-9]+(?:[.,][0-9]*)?|[.,][0-9]+)(?:[eE][-+]?[0-9]+)?|[-+]?[0-9]+,[-+][0-9]+|-?[iI]nf(?:inity)?"
)
"""What a number looks like, one with a decimal comma and a pair such as `1,2` among them."""


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
      notes: what stands in the file and has no place in a cell, each with its line.
    """

    source: str
    data: dict[str, Any]
    lines: Mapping[Path, int | tuple[int, int]]
    faults: list[Fault] = field(default_factory=list)
    notes: list[Fault] = field(default_factory=list)

    def plain(self) -> Any:
        """The cell, keyed as in a cell file."""
        return self.data

    def place(self, path: Path) -> Place:
        """The line of the nearest part around the path that has one; the first line for all
        else.
        """
        for length in range(len(path), 0, -1):
            if (where := self.lines.get(path[:length])) is not None:
                line, column = where if isinstance(where, tuple) else (where, 1)
                return Place(
                    line,
                    column,
                    (
                        f"{self.source}:{line}"
                        if isinstance(where, int)
                        else f"{self.source}:{line}:{column}"
                    ),
                )
        return Place(1, 1, f"{self.source}:1")


def rows(text: str) -> list[Row]:
    """The lines that are neither blank nor a remark."""
    lines = ((number, line.split()) for number, line in enumerate(text.splitlines(), 1))
    return [Row(number, words) for number, words in lines if words and not words[0].startswith("#")]


def nearly_numbers(text: str) -> bool:
    """Whether it is lines of numbers, though a word of them may be no number: three of four words
    hold a digit and nothing but what numbers need.
    """
    words = [word for row in islice(rows(text[:100_000]), 500) for word in row.words]
    return len(words) >= 3 and 4 * sum(
        NUMBERLIKE.fullmatch(word) is not None for word in words
    ) >= 3 * len(words)


def shown(word: str) -> str:
    """The word as a message quotes it."""
    return repr(word if len(word) <= 40 else f"{word[:37]}...")


def title(source: str) -> str:
    """The cell's name: the file's, without folder and ending. A file's name may hold bytes that are
    no text; these are shown as "?".
    """
    return "".join("?" if harm_in(sign) else sign for sign in PurePath(source).stem)


def broken(source: str, line: int, message: str) -> CellError:
    """The one fault of a file that is not of its form."""
    return CellError([Fault(message, (), f"{source}:{line}")])


def whole(source: str, line: int, word: str, what: str) -> int:
    """A whole number, 0 or more.

    Raises:
      CellError: it is none, or larger than anything that is counted.
    """
    if not (word.isascii() and word.isdigit()):
        raise broken(source, line, f"{what} is {shown(word)}, but a whole number is needed.")
    if len(word.lstrip("0")) > 9:
        raise broken(source, line, f"{what} is {shown(word)}, which is too large.")
    return int(word)


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
        pointed = word.replace(",", ".", 1)
        remedy = (
            f" Write it with a point: {pointed}."
            if NUMBERLIKE.fullmatch(pointed) and pointed != word
            else ""
        )
        raise broken(source, line, f"{what} is {shown(word)}, but a number is needed.{remedy}")
    return value


def few_enough(
    source: str, line: int, operators: int, tasks: int, most_operators: int = MOST_OPERATORS
) -> None:
    """Refuses a cell of more operators, or of more ways of doing its tasks, than can be held.

    Raises:
      CellError: there are too many; `line` is where their number is stated.
    """
    if operators > most_operators or operators * tasks > MOST_WAYS:
        most = f"{most_operators:,} operators, and {MOST_WAYS:,} pairs of an operator and a task"
        raise broken(
            source,
            line,
            f"{operators:,} operators for {tasks:,} tasks are more than Tandem reads: at most"
            f" {most}.",
        )
