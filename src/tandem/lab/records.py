"""Results on disk: the documents that ship with the package, and the records of a reproduction that
was stopped and goes on.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any

from pydantic import ConfigDict, ValidationError

from tandem.errors import CellError, Fault
from tandem.files.atomic import store
from tandem.learn.forms import Form, complaints


class _Head(Form):
    """What every document of a reproduction says of itself."""

    model_config = ConfigDict(frozen=True, strict=True, extra="allow")

    schema_version: int
    command: str
    versions: dict[str, str]


def stored_document(path: str, name: str) -> dict[str, Any]:
    """The document of the long run of a system, which ships with the package, at a path below
    `lab`; the system's name is for the remedy.

    Raises CellError when this copy of the package has none, or a damaged one.
    """
    file = resources.files("tandem.lab") / path
    if not file.is_file():
        raise CellError(
            [
                Fault(
                    f"the stored result is not there; run `tandem reproduce {name}`.", (), str(file)
                )
            ]
        )
    document: dict[str, Any] = _read(
        file, f"Install Tandem anew, or run `tandem reproduce {name}`."
    )
    try:
        _Head.model_validate_json(json.dumps(document))
    except ValidationError as error:
        raise CellError(
            [
                Fault(f"is no result of a reproduction: {fault}", (), str(file))
                for fault in complaints(_Head, error)
            ]
        ) from None
    return document


def kept_record(file: Path, make: Callable[[], Any]) -> Any:
    """What the file holds; made, and written whole or not at all, when there is none yet. Raises
    CellError when it is damaged.
    """
    if not file.exists():
        file.parent.mkdir(parents=True, exist_ok=True)
        store(file, json.dumps(make(), separators=(",", ":")) + "\n")
    return read_record(file)


def read_record(file: Path) -> Any:
    """What a record holds. Raises CellError when it is damaged."""
    return _read(file, "Delete it: the reproduction makes it anew and keeps the others.")


def _read(file: Traversable, remedy: str) -> Any:
    try:
        return json.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise CellError(
            [Fault(f"cannot be read ({error.strerror}). {remedy}", (), str(file))]
        ) from error
    except (ValueError, RecursionError) as error:  # text that is no UTF-8 is a ValueError, too
        raise CellError(
            [
                Fault(
                    f"is no JSON that can be read ({str(error).splitlines()[0]}). {remedy}",
                    (),
                    str(file),
                )
            ]
        ) from error
