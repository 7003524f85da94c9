"""Facts in YAML or JSON: `tasks`, each with one row of facts, or a list of them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from tandem.cell.names import Known
from tandem.cell.stated import Conditions, Given, as_given, entry, twice
from tandem.ergonomics.facts import FactsError
from tandem.ergonomics.tasks import TaskFacts
from tandem.errors import Fault
from tandem.files import json_reader, yaml_reader
from tandem.files.positions import Document, Path

TOP = ("tasks", "name", "assessor", "date", "cycles_per_shift")


def tree(text: str, source: str) -> Document:
    """The text as a tree: JSON when it begins as JSON does, else YAML. Raises CellError."""
    is_json = re.match(r'\s*({\s*["}]|\[)', text) is not None
    return json_reader.read(text, source) if is_json else yaml_reader.read(text, source)


def read(text: str, source: str, whole: Conditions) -> tuple[list[TaskFacts], str]:
    """The tasks of a text with their facts, and its name, empty when it has none.

    Raises:
      FactsError, CellError: it cannot be read, or facts are wrong; with every fault at its line.
    """
    document = tree(text, source)
    plain = document.plain()
    faults = [*document.faults, *_top(document, plain)]
    usable = isinstance(plain, dict) and isinstance(plain.get("tasks"), dict)
    if not usable or "operators" in plain:
        raise FactsError(faults)
    whole = replace(
        whole,
        assessor=whole.assessor or str(plain.get("assessor") or ""),
        date=whole.date or str(plain.get("date") or ""),
        cycles=whole.cycles if whole.cycles is not None else _cycles(document, plain, faults),
    )
    found: list[TaskFacts] = []
    for task, path, row in _rows(plain["tasks"]):
        place = document.place(path).text
        if not isinstance(row, dict):
            faults.append(
                Fault(
                    f"task {task!r}: a mapping of facts is needed, or a list of them, such as"
                    " `{method: reba, trunk: 45, ...}`.",
                    path,
                    place,
                )
            )
            continue
        one, wrong = entry(task, _given(document, path, row, faults), place, whole)
        faults += wrong
        found += [one] if one is not None else []
    faults += twice(found)
    if faults:
        raise FactsError(faults)
    return found, str(plain.get("name") or "")


def _top(document: Document, plain: Any) -> Iterator[Fault]:
    if not isinstance(plain, dict):
        yield Fault("a file of facts is a mapping with the key `tasks`.", place=document.source)
        return
    if "operators" in plain:
        yield Fault(
            "this is a cell file. Give it by its name, `tandem score CELL`, to score what its tasks"
            " state under `ergonomics`; or write the facts into a file of their own: `tasks: {1:"
            " {method: reba, trunk: 45, ...}}`.",
            ("operators",),
            document.place(("operators",)).text,
        )
        return
    for name in plain:
        if name not in TOP:
            hint = Known(TOP).hint(str(name))
            yield Fault(f"unknown key `{name}`. {hint}", (name,), document.place((name,)).text)
    if not isinstance(plain.get("tasks"), dict) or not plain["tasks"]:
        yield Fault(
            "`tasks` is missing or empty. Write it, as in `tasks: {screw: {method: reba, trunk: 45,"
            " ...}}`.",
            ("tasks",),
            document.place(("tasks",)).text,
        )


def _cycles(document: Document, plain: dict[str, Any], faults: list[Fault]) -> float | None:
    value = plain.get("cycles_per_shift")
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0 < value <= 1e6:
        faults.append(
            Fault(
                f"cycles_per_shift is {value!r}, but must be more than 0, at most 1000000.",
                ("cycles_per_shift",),
                document.place(("cycles_per_shift",)).text,
            )
        )
        return None
    return float(value)


def _rows(tasks: dict[str, Any]) -> Iterator[tuple[str, Path, Any]]:
    for task, rows in tasks.items():
        if isinstance(rows, list) and rows:
            for place, row in enumerate(rows):
                yield task, ("tasks", task, place), row
        else:
            yield task, ("tasks", task), rows


def _given(
    document: Document, path: Path, row: dict[str, Any], faults: list[Fault]
) -> dict[str, Given]:
    found = {}
    for name, value in row.items():
        place = document.place((*path, name)).text
        given = as_given(name, value, place)
        if isinstance(given, str):
            faults.append(Fault(given, (*path, name), place))
        elif value is not None:
            found[name] = given
    return found
