"""What a request asks for, read from JSON: each key known, each value of its kind; every fault at
once.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from tandem.cell.language import LANGUAGES
from tandem.cell.model import Cell
from tandem.cell.names import Known
from tandem.errors import CellError, Fault, UsageError
from tandem.files.messages import shown
from tandem.files.validate import cell_of

Json = dict[str, Any]


@dataclass(frozen=True)
class Kind:
    """What the value of a key may be: in words, as JSON Schema, and as a question."""

    words: str
    schema: Json
    fits: Callable[[Any], bool]


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _is_whole(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _are_names(value: Any) -> bool:
    return isinstance(value, list) and all(isinstance(item, str) for item in value)


def _are_two(value: Any) -> bool:
    return isinstance(value, list) and len(value) == 2 and all(map(_is_number, value))


def _is_preceded(value: Any) -> bool:
    return (
        isinstance(value, list)
        and len(value) == 2
        and isinstance(value[0], str)
        and _are_names(value[1])
    )


def one_of(words: Iterable[str]) -> Kind:
    """One of these words."""
    known = tuple(words)
    return Kind(
        f"one of {', '.join(known)}",
        {"enum": list(known)},
        lambda value: isinstance(value, str) and value in known,
    )


LONGEST_S = 3600
"""No search of the studio goes on for longer."""
NUMBER = Kind("a number", {"type": "number"}, _is_number)
SECONDS = Kind(
    f"more than 0 and at most {LONGEST_S} s",
    {"type": "number", "exclusiveMinimum": 0, "maximum": LONGEST_S},
    lambda value: _is_number(value) and 0 < value <= LONGEST_S,
)
WHOLE = Kind("a whole number", {"type": "integer"}, _is_whole)
TEXT = Kind("a text", {"type": "string"}, lambda value: isinstance(value, str))
TRUTH = Kind("true or false", {"type": "boolean"}, lambda value: isinstance(value, bool))
PAIR = Kind(
    "two numbers, [time, stress]",
    {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2},
    _are_two,
)
POINTS = Kind(
    "a list of [time, stress]",
    {"type": "array", "items": PAIR.schema},
    lambda value: isinstance(value, list) and all(map(_are_two, value)),
)
PRECEDENCE = Kind(
    "a list of [task, [its predecessors]]",
    {
        "type": "array",
        "items": {
            "type": "array",
            "prefixItems": [{"type": "string"}, {"type": "array", "items": {"type": "string"}}],
            "minItems": 2,
            "maxItems": 2,
        },
    },
    lambda value: isinstance(value, list) and all(map(_is_preceded, value)),
)
NAMES = Kind("a list of names", {"type": "array", "items": {"type": "string"}}, _are_names)
TABLE = Kind("an object", {"type": "object"}, lambda value: isinstance(value, Mapping))
ROWS = Kind(
    "a list of assignments",
    {"type": "array", "items": {"type": "object"}},
    lambda value: isinstance(value, list) and all(isinstance(row, Mapping) for row in value),
)
LANGUAGE = one_of(LANGUAGES)

EFFORT: dict[str, Kind] = {"time_limit": SECONDS, "seed": WHOLE, "workers": WHOLE}
"""Keys that any search takes: as the options of the command line."""


def read(
    given: Any, keys: Mapping[str, Kind], *, needed: Iterable[str] = (), where: str = ""
) -> Json:
    """The keys that were given with a value; null counts as not given.

    Args:
      where: stands in front of the names of keys in messages.

    Raises UsageError with every key that is unknown, missing or of another kind.
    """
    if not isinstance(given, Mapping):
        what = where.rstrip(".") or "the request"
        raise UsageError(f"{what} is {shown(given)}, but must be a JSON object.")
    wrong = [
        f"there is no key {where}{key}. {Known(keys).hint(str(key))}"
        for key in given
        if key not in keys
    ]
    found = {key: value for key, value in given.items() if key in keys and value is not None}
    wrong += [
        f"{where}{key} is missing: give {keys[key].words}." for key in needed if key not in found
    ]
    wrong += [
        f"{where}{key} is {shown(value)}, but must be {keys[key].words}."
        for key, value in found.items()
        if not keys[key].fits(value)
    ]
    if wrong:
        raise UsageError("\n".join(wrong))
    return found


def cell_in(document: Any) -> Cell:
    """The cell of a request. Raises CellError with every fault."""
    if not isinstance(document, Mapping):
        raise CellError([Fault(f"the cell is {shown(document)}, but must be a JSON object.")])
    return _cell(json.dumps(document))


@lru_cache(maxsize=8)
def _cell(text: str) -> Cell:
    """While a bar is dragged the same cell is asked about many times a second."""
    return cell_of(json.loads(text))
