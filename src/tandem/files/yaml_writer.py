"""A cell as YAML, as a person would write it: one line a task."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from decimal import Decimal
from typing import Any

from tandem.cell.model import Cell
from tandem.cell.written import number
from tandem.files.yaml_reader import SPECIAL

WIDTH = 120
"""A task that would be longer takes one line for each of its keys."""
PLAIN = re.compile(r"[^\W_](?:[\w ./()+-]*[\w)])?")
"""Text that needs no quotes: nothing in it has a meaning in YAML."""

UNSEEN = re.compile(r"[\x7f-\xa0\u2028\u2029\ufeff\ufffe\uffff]")

NAMES = (
    *("after", "same_operator", "holds", "operators", "tool", "zone", "place"),
    *("label", "part", "name"),
)
"""Keys whose values are names: these are read as they are written, so digits need no quotes."""


def to_yaml(cell: Cell) -> str:
    """The cell file; reading it gives an equal cell."""
    return "\n".join(_lines(cell.to_dict())) + "\n"


def _lines(data: dict[str, Any]) -> Iterator[str]:
    for key, value in data.items():
        if not isinstance(value, Mapping):
            yield f"{key}: {flow(value, key in NAMES)}"
            continue
        yield f"{key}:" if value else f"{key}: {{}}"
        for name, entry in value.items():
            line = f"  {_name(name)}: {flow(entry)}"
            if len(line) <= WIDTH or not isinstance(entry, Mapping):
                yield line
                continue
            yield f"  {_name(name)}:"
            for inner, item in entry.items():
                yield from _inner(_name(inner), item, inner in NAMES)


def _inner(key: str, item: Any, name: bool) -> Iterator[str]:
    """A key of a task: on one line, or a list of mappings with a line for each where it is long."""
    line = f"    {key}: {flow(item, name)}"
    is_table = isinstance(item, list) and any(isinstance(one, Mapping) for one in item)
    if len(line) <= WIDTH or not is_table:
        yield line
        return
    yield f"    {key}:"
    yield from (f"      - {flow(one, name)}" for one in item)


def flow(value: Any, name: bool = False) -> str:
    """A value on one line, as a cell file has it; `name` for text where names belong."""
    if isinstance(value, Mapping):
        return (
            "{"
            + ", ".join(
                f"{_name(key)}: {flow(item, name or key in NAMES)}" for key, item in value.items()
            )
            + "}"
        )
    if isinstance(value, list):
        return "[" + ", ".join(flow(item, name) for item in value) + "]"
    if isinstance(value, str):
        return _name(value) if name else _text(value)
    return _number(value)


def _number(value: float | int | None) -> str:
    if value is None:
        return "null"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int):
        return str(value)
    text = number(value)
    # doses are smaller than what six decimals say
    return text if float(text) == value else f"{Decimal(repr(value)):f}"


def _name(text: str) -> str:
    """Text where names belong: also digits stand without quotes there."""
    return text if PLAIN.fullmatch(text) and text not in SPECIAL else quoted(text)


def _text(text: str) -> str:
    return _name(text) if text[:1].isalpha() else quoted(text)


def quoted(text: str) -> str:
    """Text in double quotes, for YAML and JSON alike; signs that cannot be seen are written as
    their number.
    """
    return escaped(json.dumps(text, ensure_ascii=False))


def escaped(json_text: str) -> str:
    """JSON or quoted YAML without signs that YAML refuses or takes for the end of a line."""
    return UNSEEN.sub(lambda found: f"\\u{ord(found.group()):04x}", json_text)
