"""Opens a workbook in a process of its own, with limits of memory and time.

A workbook is a program for its reader: a few bytes may claim a sheet of a billion rows, and the
libraries that unpack such files allocate, panic or abort on damaged ones. In here that ends a child
process, `worker.py`, and becomes one message. The child gets the file's bytes on its standard input
and answers in lines of JSON, a sheet a line; nothing that either side reads is ever executed.
"""

from __future__ import annotations

import datetime
import json
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from tandem.files.spreadsheet.grid import Book, Grid
from tandem.files.spreadsheet.said import Said

WORKER = Path(__file__).with_name("worker.py")
"""The child, started as a script."""
MOST_MEMORY = 2 * 1024**3
"""Bytes of address space that the child may take; where the system cannot limit it (Windows,
macOS), only time is limited.
"""
MOST_CPU_S = 20
MOST_WALL_S = 90


class RefusedError(Exception):
    """Why the book cannot be opened; the end of a sentence that begins with its name."""


def open_apart(path: Path, content: bytes) -> Book:
    """The book that the content holds; `path` gives it a name.

    Raises:
      RefusedError: it is damaged, or opening it takes more memory or time than a planner's workbook
        does.
    """
    try:
        asked = [sys.executable, "-P", str(WORKER), path.name, str(MOST_MEMORY), str(MOST_CPU_S)]
        child = subprocess.run(asked, input=content, capture_output=True, timeout=MOST_WALL_S)
    except subprocess.TimeoutExpired as error:
        raise RefusedError(f"takes longer than {MOST_WALL_S} s to open. {REMEDY}") from error
    lines = child.stdout.splitlines()
    last = json.loads(lines[-1], object_hook=_marked) if lines and child.returncode == 0 else {}
    if "refused" in last:
        raise RefusedError(last["refused"])
    if "book" not in last:
        limits = f"{MOST_MEMORY // 1024**3} GB of memory or {MOST_CPU_S} s of computing"
        raise RefusedError(f"is damaged, or would take more than {limits} to open. {REMEDY}")
    return _book(path, [json.loads(line, object_hook=_marked) for line in lines[:-1]], last["book"])


REMEDY = (
    "Open it where it was made, copy the sheet with the tasks into a new workbook, and save that."
)


# --- what the child's answers mean: what JSON does not know is a mapping of one key that says what

KINDS: Mapping[str, Callable[[Any], Any]] = {
    "map": lambda pairs: {_frozen(key): _frozen(item) for key, item in pairs},
    "set": frozenset,
    "said": lambda parts: Said(parts[0], _frozen(parts[1])),
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
    grids = [
        Grid(**{key: value if key == "name" else _frozen(value) for key, value in sheet.items()})
        for sheet in sheets
    ]
    return Book(path, tuple(grids), **{key: _frozen(value) for key, value in rest.items()})
