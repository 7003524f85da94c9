"""Results on disk: the documents that ship with the package, and the records of a reproduction that
was stopped and goes on.

Both are written by a reproduction and read back by one, never by hand. So each carries a seal, the
SHA-256 of all else in it: what is read is what was found, to the last digit, or it is refused.
Forms would only refuse what is misshapen; a figure that was changed to another one would be shown
as found.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any

from pydantic import ConfigDict, ValidationError

from tandem.errors import CellError, Fault
from tandem.files.atomic import store
from tandem.learn.forms import Form, complaints

SEAL = "sha256"
"""The key of the seal, in documents and in records."""

ANEW = "Delete it: the reproduction makes it anew and keeps the others."


class _Head(Form):
    """What every document of a reproduction says of itself."""

    model_config = ConfigDict(frozen=True, strict=True, extra="allow")

    schema_version: int
    command: str
    versions: dict[str, str]


def write_document(
    file: Path, document: Mapping[str, Any], indent: int | None = None
) -> dict[str, Any]:
    """Writes the result of a reproduction, whole or not at all; returns it with its seal."""
    whole = sealed(document)
    file.parent.mkdir(parents=True, exist_ok=True)
    store(file, _text(whole, indent))
    return whole


def stored_document(path: str, name: str) -> dict[str, Any]:
    """The document of the long run of a system, which ships with the package.

    Args:
      path: below `lab`.
      name: the system's, for the remedy.

    Raises CellError when this copy of the package has none, or one that is damaged or was changed.
    """
    file = resources.files("tandem.lab") / path
    remedy = f"Install Tandem anew, or run `tandem reproduce {name}`."
    if not file.is_file():
        missing = f"the stored result is not there; run `tandem reproduce {name}`."
        raise CellError([Fault(missing, (), str(file))])
    document = _read(file, remedy, "result")
    try:
        _Head.model_validate_json(json.dumps(document))
    except ValidationError as error:
        faults = [f"is no result of a reproduction: {fault}" for fault in complaints(_Head, error)]
        raise CellError([Fault(f"{fault} {remedy}", (), str(file)) for fault in faults]) from None
    return document


def kept_record(file: Path, make: Callable[[], Any], asked: Any = None) -> Any:
    """What the file holds; made, and written whole or not at all, when there is none yet.

    Args:
      asked: what the record answers, where the file's name does not say all of it; a record that
        answers another question is made anew.

    Raises CellError when the record is damaged, or was changed.
    """
    question = json.loads(json.dumps(asked))
    if file.exists() and (record := _record(file))["asked"] == question:
        return record["found"]
    found = make()
    file.parent.mkdir(parents=True, exist_ok=True)
    store(file, _text(sealed({"asked": question, "found": found})))
    return read_record(file)


def read_record(file: Path) -> Any:
    """What a record holds. Raises CellError when it is damaged, or was changed."""
    return _record(file)["found"]


def sealed(document: Mapping[str, Any]) -> dict[str, Any]:
    """The document with a seal at its end; one that it has already is replaced."""
    content = {key: value for key, value in document.items() if key != SEAL}
    return {**content, SEAL: hashlib.sha256(_text(content).encode()).hexdigest()}


def _text(document: Mapping[str, Any], indent: int | None = None) -> str:
    separators = (",", ":") if indent is None else None
    return json.dumps(document, indent=indent, separators=separators) + "\n"


def _record(file: Path) -> dict[str, Any]:
    """What was asked and what was found. Raises CellError when that cannot be relied on."""
    record = _read(file, ANEW, "record")
    if record.keys() != {"asked", "found", SEAL}:
        raise CellError([Fault(f"is no record of a reproduction. {ANEW}", (), str(file))])
    return record


def _read(file: Traversable, remedy: str, what: str) -> dict[str, Any]:
    """The document in the file. Raises CellError when it cannot be read, or its seal does not
    fit.
    """
    try:
        document = json.loads(file.read_text(encoding="utf-8"))
        fault = _broken(document, what)
    except OSError as error:
        fault = f"cannot be read ({error.strerror})."
    except (ValueError, RecursionError) as error:  # text that is no UTF-8 is a ValueError, too
        fault = f"is no JSON that can be read ({str(error).splitlines()[0]})."
    if fault:
        raise CellError([Fault(f"{fault} {remedy}", (), str(file))])
    return dict(document)


def _broken(document: Any, what: str) -> str:
    """Why a document is not what was written; empty when it is."""
    if not isinstance(document, dict):
        return f"is no {what} of a reproduction."
    if SEAL not in document:
        return f"is no {what} of a reproduction: it has no seal (`{SEAL}`)."
    if document[SEAL] != sealed(document)[SEAL]:
        return f"was changed or damaged after it was written: its seal (`{SEAL}`) does not fit."
    return ""
