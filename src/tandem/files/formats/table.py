"""All formats that a cell can be read from: a name, what it is, how to tell it, how to read it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import PurePath
from typing import Any, Protocol

from tandem.cell.model import Cell
from tandem.errors import CellError, Fault
from tandem.files import json_reader, yaml_reader
from tandem.files.formats import (
    alb,
    alwabp,
    battery,
    case,
    fjs,
    fjs_dag,
    hrcalbp,
    job_shop_lib,
    jsp,
    psplib,
    pyjobshop,
    rcp,
    taillard,
)
from tandem.files.formats.lines import nearly_numbers, rows
from tandem.files.formats.written import Written
from tandem.files.json_writer import to_json
from tandem.files.positions import Path, Place
from tandem.files.yaml_writer import to_yaml


class Readable(Protocol):
    """A file that was read: plain values keyed as in a cell file, where each of them stands, what
    is wrong, and what is left out.
    """

    faults: list[Fault]
    notes: list[Fault]

    def plain(self) -> Any: ...

    def place(self, path: Path) -> Place: ...


@dataclass(frozen=True)
class Format:
    """One format.

    Attributes:
      what: for lists and help texts.
      read: text and the file's name in, the values out; raises CellError with file and line when it
        is not of this form.
      looks_like: whether a text seems to be of this form; asked in the order of the table.
      numbers: whether it is made of numbers alone, so that remarks in an old encoding do no harm.
    """

    what: str
    read: Callable[[str, str], Readable]
    looks_like: Callable[[str], bool]
    numbers: bool = False


FORMATS = {
    "job-shop-lib": Format(
        "job shop of job-shop-lib, JSON", job_shop_lib.read, job_shop_lib.looks_like
    ),
    "case": Format("human-robot case studies and battery cells, JSON", case.read, case.looks_like),
    "json": Format(
        "cell file, JSON", json_reader.read, lambda text: text.lstrip()[:1] in ("{", "[")
    ),
    "alb": Format("assembly line balancing, .alb and .IN2", alb.read, alb.looks_like, numbers=True),
    "hrcalbp": Format(
        "line with human, robot and joint tasks, .csv", hrcalbp.read, hrcalbp.looks_like
    ),
    "alwabp": Format(
        "assembly line worker assignment", alwabp.read, alwabp.looks_like, numbers=True
    ),
    "fjs-dag": Format(
        "flexible job shop with any acyclic precedence",
        fjs_dag.read,
        fjs_dag.looks_like,
        numbers=True,
    ),
    "psplib": Format(
        "project under shared capacities, PSPLIB and MMLIB, .sm and .mm",
        psplib.read,
        psplib.looks_like,
        numbers=True,
    ),
    "rcp": Format(
        "project under shared capacities, Patterson", rcp.read, rcp.looks_like, numbers=True
    ),
    "taillard": Format(
        "classic job shop, Taillard's two tables",
        taillard.read,
        taillard.looks_like,
        numbers=True,
    ),
    "jsp": Format(
        "classic job shop, OR-Library and JSPLIB", jsp.read, jsp.looks_like, numbers=True
    ),
    "fjs": Format("flexible job shop, FJSPLIB", fjs.read, fjs.looks_like, numbers=True),
    "battery": Format(
        "sampled battery cells, told by a name such as H2R1_7.txt",
        battery.read,
        battery.looks_like,
        numbers=True,
    ),
    "yaml": Format("cell file, YAML", yaml_reader.read, lambda text: True),
}
"""Name -> format, in the order in which they are told. A new one is a file and a line here."""


@dataclass(frozen=True)
class Writer:
    """A form that a cell can be written in.

    Attributes:
      what: for lists and help texts.
      write: raises CellError, with every reason, when the form cannot say all that decides which
        schedules there are.
    """

    what: str
    write: Callable[[Cell], Written]


WRITERS = {
    "yaml": Writer("cell file, YAML", lambda cell: Written(to_yaml(cell), ())),
    "json": Writer("cell file, JSON", lambda cell: Written(to_json(cell), ())),
    "fjs": Writer("flexible job shop, FJSPLIB", fjs.write),
    "fjs-dag": Writer("flexible job shop with any acyclic precedence", fjs_dag.write),
    "jsp": Writer("classic job shop, OR-Library and JSPLIB", jsp.write),
    "job-shop-lib": Writer("job shop of job-shop-lib, JSON", job_shop_lib.write),
    "pyjobshop": Writer("problem data of PyJobShop, JSON", pyjobshop.write),
}
"""Name -> form to write. A new one is a function and a line here."""

ENDINGS = {
    ".alb": "alb",
    ".in2": "alb",
    ".fjs": "fjs",
    ".jsp": "jsp",
    ".mm": "psplib",
    ".rcp": "rcp",
    ".sm": "psplib",
}
"""How the names of files end that nobody gives to anything else."""


def detected(text: str, source: str = "text") -> str:
    """The name of the format that a text is of, told by its content; where that leaves it open, by
    the ending of its name.

    Lines of numbers that are nearly of a form are taken for it, so that the message can name the
    line and the word that are wrong. What is like nothing else is taken for YAML.

    Raises:
      CellError: it reads as a classic and as a flexible job shop, and they are not the same.
    """
    ending = ENDINGS.get(PurePath(source).suffix.lower())
    found = next(name for name, format in FORMATS.items() if format.looks_like(text))
    if ending == "rcp":
        return ending
    if found == "fjs" and battery.named_so(source):
        return "battery"
    if found == "jsp" and _reads_as_flexible(text, source):
        if ending not in ("jsp", "fjs"):
            raise CellError([Fault(DOUBTFUL, (), f"{source}:1")])
        return ending
    if found != "yaml":
        return found
    return ending or (_nearest_shape(text) if nearly_numbers(text) else found)


DOUBTFUL = (
    "this is a classic job shop (pairs of machine and time) or a flexible one (for each operation:"
    " how many machines, then machine and time of each): every line can be read both ways. State"
    " which: --format jsp or --format fjs."
)


def _reads_as_flexible(text: str, source: str) -> bool:
    try:
        fjs.read(text, source)
    except CellError:
        return False
    return True


def _nearest_shape(text: str) -> str:
    """Which form lines of numbers are most like, by how many stand in the first lines; YAML when
    they are like none.
    """
    lines = [row.words for row in rows(text)]
    head, below = lines[0], [len(words) for words in lines[1:]]
    if len(head) == 1 and below:
        return "alb" if below[0] == 1 else "alwabp"
    if len(head) == 3 and below and below[0] in (2, 3):
        return "fjs-dag"
    if len(head) == 2 and below and head[1].isdecimal() and set(below) == {2 * int(head[1][:9])}:
        return "jsp"
    return "fjs" if len(head) in (2, 3) and below else "yaml"
