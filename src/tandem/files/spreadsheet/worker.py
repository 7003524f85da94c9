"""The child process that `confined` starts to open a workbook: bytes on its standard input, a sheet
a line of JSON on its standard output.

It is a script, `worker.py NAME MEMORY SECONDS`, and imports nothing but the reader of workbooks:
see `_bare_packages`.
"""

from __future__ import annotations

import contextlib
import datetime
import json
import sys
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from types import ModuleType
from typing import Any

PACKAGES = ("tandem", "tandem.cell", "tandem.files", "tandem.files.spreadsheet")


def _bare_packages() -> None:
    """Puts packages without content in place of ours, so that importing one file does not import
    what their faces show: it saves 0.3 s a book.
    """
    above_tandem = Path(__file__).resolve().parents[3]
    for name in PACKAGES:
        package = ModuleType(name)
        package.__path__ = [str(above_tandem.joinpath(*name.split(".")))]
        sys.modules[name] = package


def _limit(most_memory: int, most_cpu_s: int) -> None:
    """Bounds what this process may take, bytes and seconds of computing, as far as the system
    can.
    """
    try:
        import resource
    except ImportError:  # Windows has no such limits
        return
    for what, most in (
        (resource.RLIMIT_AS, most_memory),
        (resource.RLIMIT_CPU, most_cpu_s),
        (resource.RLIMIT_CORE, 0),
    ):
        with contextlib.suppress(ValueError, OSError):
            hard = resource.getrlimit(what)[1]
            resource.setrlimit(
                what, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard)
            )


def _answer(name: str, content: bytes) -> None:
    from tandem.errors import CellError
    from tandem.files.spreadsheet.confined import REMEDY
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
        field.name: _plain(getattr(book, field.name))
        for field in fields(book)
        if field.name not in ("path", "grids")
    }
    _say({"book": rest})


def _plain(value: Any) -> Any:
    """A value of a book as JSON can hold it: what JSON does not know is a mapping of one key that
    says what it is (`confined.KINDS`).
    """
    if value is None or isinstance(value, str | int | float):
        return value
    from tandem.files.spreadsheet.said import Said

    if isinstance(value, Mapping):
        return {"map": [[_plain(key), _plain(item)] for key, item in value.items()]}
    if isinstance(value, Said):
        return {"said": [value.key, _plain(value.values)]}
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


def _say(document: dict[str, Any]) -> None:
    sys.stdout.write(json.dumps(document) + "\n")


if __name__ == "__main__":
    _limit(int(sys.argv[2]), int(sys.argv[3]))
    _bare_packages()
    _answer(sys.argv[1], sys.stdin.buffer.read())
