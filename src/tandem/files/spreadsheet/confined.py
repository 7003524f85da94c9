"""Opens a workbook in a process of its own, with limits of memory and time.

A workbook is a program for its reader: a few bytes may claim a sheet of a billion rows, and the
libraries that unpack such files allocate, panic or abort on damaged ones. In here that ends a child
process and becomes one message. The child gets the file's bytes on its standard input and answers
in lines of JSON, a sheet a line; nothing that either side reads is ever executed.

The child is this file, started as a script. It imports nothing but the reader of workbooks: see
`_bare_packages`.
"""

from __future__ import annotations

import contextlib
import datetime
import json
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import fields
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tandem.files.spreadsheet.grid import Book

MOST_MEMORY = 2 * 1024**3
"""Bytes of address space that the child may take; where the system cannot limit it (Windows,
macOS), only time is limited.
"""
MOST_CPU_S = 20
MOST_WALL_S = 90
PACKAGES = ("tandem", "tandem.cell", "tandem.files", "tandem.files.spreadsheet")


class RefusedError(Exception):
    """Why the book cannot be opened; the end of a sentence that begins with its name."""


def open_apart(path: Path, content: bytes) -> Book:
    """The book that the content holds; `path` gives it a name.

    Raises:
      RefusedError: it is damaged, or opening it takes more memory or time than a planner's workbook
        does.
    """
    try:
        child = subprocess.run(
            [sys.executable, "-P", __file__, path.name],
            input=content,
            capture_output=True,
            timeout=MOST_WALL_S,
        )
    except subprocess.TimeoutExpired as error:
        raise RefusedError(f"takes longer than {MOST_WALL_S} s to open. {REMEDY}") from error
    lines = child.stdout.splitlines()
    last = json.loads(lines[-1]) if lines and child.returncode == 0 else {}
    if "refused" in last:
        raise RefusedError(last["refused"])
    if "book" not in last:
        limits = f"{MOST_MEMORY // 1024**3} GB of memory or {MOST_CPU_S} s of computing"
        raise RefusedError(f"is damaged, or would take more than {limits} to open. {REMEDY}")
    return _book(path, [json.loads(line, object_hook=_marked) for line in lines[:-1]], last["book"])


REMEDY = (
    "Open it where it was made, copy the sheet with the tasks into a new workbook, and save that."
)


# --- on the wire ----------------------------------------------------------------------------------


def _plain(value: Any) -> Any:
    """A value of a grid as JSON can hold it: what JSON does not know is a mapping of one key that
    says what it is.
    """
    if isinstance(value, Mapping):
        return {"map": [[_plain(key), _plain(item)] for key, item in value.items()]}
    if isinstance(value, tuple | list):
        return [_plain(item) for item in value]
    if isinstance(value, frozenset):
        return {"set": sorted(value)}
    if isinstance(value, datetime.timedelta):
        return {"seconds": value.total_seconds()}
    if isinstance(value, datetime.datetime):
        return {"datetime": value.isoformat()}
    if isinstance(value, datetime.date):
        return {"date": value.isoformat()}
    return {"time": value.isoformat()} if isinstance(value, datetime.time) else value


KINDS: Mapping[str, Callable[[Any], Any]] = {
    "map": lambda pairs: {_frozen(key): _frozen(item) for key, item in pairs},
    "set": frozenset,
    "seconds": lambda seconds: datetime.timedelta(seconds=seconds),
    "datetime": datetime.datetime.fromisoformat,
    "date": datetime.date.fromisoformat,
    "time": datetime.time.fromisoformat,
}


def _marked(mapping: dict[str, Any]) -> Any:
    kind = next(iter(mapping), "")
    return KINDS[kind](mapping[kind]) if len(mapping) == 1 and kind in KINDS else mapping


def _frozen(value: Any) -> Any:
    return tuple(map(_frozen, value)) if isinstance(value, list) else value


def _book(path: Path, sheets: list[dict[str, Any]], rest: dict[str, Any]) -> Book:
    from tandem.files.spreadsheet.grid import Book, Grid

    grids = [
        Grid(**{key: value if key == "name" else _frozen(value) for key, value in sheet.items()})
        for sheet in sheets
    ]
    return Book(path, tuple(grids), **{key: _frozen(value) for key, value in rest.items()})


# --- the child ------------------------------------------------------------------------------------


def _bare_packages() -> None:
    """Puts packages without content in place of ours, so that importing one file does not import
    what their faces show: it saves 0.3 s a book.
    """
    above_tandem = Path(__file__).resolve().parents[3]
    for name in PACKAGES:
        package = ModuleType(name)
        package.__path__ = [str(above_tandem.joinpath(*name.split(".")))]
        sys.modules[name] = package


def _limit() -> None:
    """Bounds what this process may take, as far as the system can."""
    try:
        import resource
    except ImportError:  # Windows has no such limits
        return
    for what, most in (
        (resource.RLIMIT_AS, MOST_MEMORY),
        (resource.RLIMIT_CPU, MOST_CPU_S),
        (resource.RLIMIT_CORE, 0),
    ):
        with contextlib.suppress(ValueError, OSError):
            hard = resource.getrlimit(what)[1]
            resource.setrlimit(
                what, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard)
            )


def _answer(name: str, content: bytes) -> None:
    from tandem.errors import CellError
    from tandem.files.spreadsheet.workbook import unpacked

    try:
        book = unpacked(Path(name), content)
    except CellError as error:
        _say({"refused": error.faults[0].message})
        return
    except MemoryError:
        raise
    except BaseException as error:  # noqa: BLE001  a panic of a library is no Exception
        _say({"refused": f"is damaged ({type(error).__name__} while reading it). {REMEDY}"})
        return
    for grid in book.grids:
        _say({field.name: _plain(getattr(grid, field.name)) for field in fields(grid)})
    rest = {
        field.name: getattr(book, field.name)
        for field in fields(book)
        if field.name not in ("path", "grids")
    }
    _say({"book": rest})


def _say(document: dict[str, Any]) -> None:
    sys.stdout.write(json.dumps(document) + "\n")


if __name__ == "__main__":
    _limit()
    _bare_packages()
    _answer(sys.argv[1], sys.stdin.buffer.read())
