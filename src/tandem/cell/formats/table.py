"""All formats that a cell can be read from: a name, what it is, how to tell it, how to read it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

from tandem.cell import json_text, yaml_text
from tandem.cell.formats import alb, alwabp, case, fjs, fjs_dag
from tandem.cell.marked import Path, Place
from tandem.errors import Fault


class Readable(Protocol):
    """A file that was read: plain values keyed as in a cell file, and where each of them stands."""

    faults: list[Fault]

    def plain(self) -> Any: ...

    def place(self, path: Path) -> Place: ...


@dataclass(frozen=True)
class Format:
    """One format.

    Attributes:
      what: for lists and help texts.
      read: text and the file's name in, the values out; raises CellError with file and line when it is not of this form.
      looks_like: whether a text seems to be of this form; asked in the order of the table.
      numbers: whether it is made of numbers alone, so that remarks in an old encoding do no harm.
    """

    what: str
    read: Callable[[str, str], Readable]
    looks_like: Callable[[str], bool]
    numbers: bool = False


FORMATS = {
    "case": Format("human-robot case studies and battery cells, JSON", case.read, case.looks_like),
    "json": Format("cell file, JSON", json_text.read, lambda text: text.lstrip()[:1] in ("{", "[")),
    "alb": Format("assembly line balancing, .alb and .IN2", alb.read, alb.looks_like, numbers=True),
    "alwabp": Format("assembly line worker assignment", alwabp.read, alwabp.looks_like, numbers=True),
    "fjs-dag": Format("flexible job shop with any acyclic precedence", fjs_dag.read, fjs_dag.looks_like, numbers=True),
    "fjs": Format("flexible job shop, FJSPLIB", fjs.read, fjs.looks_like, numbers=True),
    "yaml": Format("cell file, YAML", yaml_text.read, lambda text: True),
}


def detected(text: str) -> str:
    """The name of the first format that the text looks like; what looks like none is taken for YAML."""
    return next(name for name, format in FORMATS.items() if format.looks_like(text))
