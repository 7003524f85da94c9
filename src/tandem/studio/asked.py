"""What a request asks for, read from JSON: each key known, each value of its kind; every fault at
once.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from tandem.cell.model import Cell
from tandem.cell.names import Known
from tandem.errors import CellError, Fault, UsageError
from tandem.files.messages import shown
from tandem.files.validate import cell_of
from tandem.schedule.model import Schedule

Kind = tuple[str, Callable[[Any], bool]]


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _is_whole(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _are_names(value: Any) -> bool:
    return isinstance(value, list) and all(isinstance(item, str) for item in value)


NUMBER: Kind = ("a number", _is_number)
WHOLE: Kind = ("a whole number", _is_whole)
TEXT: Kind = ("a text", lambda value: isinstance(value, str))
TRUTH: Kind = ("true or false", lambda value: isinstance(value, bool))
PAIR: Kind = (
    "two numbers, [time, stress]",
    lambda value: isinstance(value, list) and len(value) == 2 and all(map(_is_number, value)),
)
NAMES: Kind = ("a list of names", _are_names)
TABLE: Kind = ("an object", lambda value: isinstance(value, Mapping))
ROWS: Kind = (
    "a list of assignments",
    lambda value: isinstance(value, list) and all(isinstance(row, Mapping) for row in value),
)

EFFORT: dict[str, Kind] = {
    "time_limit": NUMBER,
    "work": NUMBER,
    "seed": WHOLE,
    "workers": WHOLE,
}
"""Keys that any search takes: as the options of the command line."""
LONGEST_S = 3600.0
"""No search of the studio goes on for longer."""


def read(given: Any, keys: Mapping[str, Kind], *, needed: tuple[str, ...] = ()) -> dict[str, Any]:
    """The keys that were given with a value; null counts as not given.

    Raises UsageError with every key that is unknown, missing or of another kind.
    """
    if not isinstance(given, Mapping):
        raise UsageError(f"the request is {shown(given)}, but must be a JSON object.")
    wrong = [
        f"there is no key {key!r}. {Known(keys).hint(str(key))}" for key in given if key not in keys
    ]
    found = {key: value for key, value in given.items() if key in keys and value is not None}
    wrong += [f"{key} is missing: give {keys[key][0]}." for key in needed if key not in found]
    for key, value in found.items():
        what, fits = keys[key]
        if not fits(value):
            wrong.append(f"{key} is {shown(value)}, but must be {what}.")
    limit = found.get("time_limit")
    if limit is not None and _is_number(limit) and not 0 < limit <= LONGEST_S:
        wrong.append(f"time_limit is {shown(limit)}, but must be more than 0 and at most 3600 s.")
    if wrong:
        raise UsageError("\n".join(wrong))
    return found


def cell_in(document: Any) -> Cell:
    """The cell of a request. Raises CellError with every fault."""
    if not isinstance(document, Mapping):
        raise CellError([Fault(f"the cell is {shown(document)}, but must be a JSON object.")])
    return cell_of(document)


def schedule_in(rows: list[Mapping[str, Any]]) -> Schedule:
    """The schedule of a request's `assignments`. Raises CellError with each row that is none."""
    from tandem.report.results import schedules_of

    return schedules_of({"front": [{"assignments": rows}]})[0]
