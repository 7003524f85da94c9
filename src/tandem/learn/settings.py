"""Settings of a training as plain data and back: frozen dataclasses that check themselves, with every fault told at once.

A class of settings takes no unknown key, no infinity and no value of another type (`STRICT`), and says what is out of range in `faults()`.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from dataclasses import fields, is_dataclass
from typing import Any, TypeVar, get_args, get_type_hints

from pydantic import ConfigDict, TypeAdapter, ValidationError

from tandem.cell.names import Known
from tandem.cell.wording import shown
from tandem.errors import UsageError

STRICT = ConfigDict(extra="forbid", allow_inf_nan=False)
"""How settings are read; a class of them says so with `__pydantic_config__`."""

LARGEST = 2**31 - 1
"""The largest whole number that a compiled training counts to."""

Settings = TypeVar("Settings")


class SettingsError(UsageError, ValueError):
    """Settings that do not hold. Each of `faults` begins with the setting's name; pydantic collects them because they are values, too."""

    def __init__(self, faults: Iterable[str]):
        self.faults = tuple(faults)
        super().__init__("The training's settings do not hold:\n" + "\n".join(f"- {fault}" for fault in self.faults))


def must_hold(faults: Iterable[str]) -> None:
    """Raises SettingsError when there are any."""
    if found := tuple(faults):
        raise SettingsError(found)


def counts(of: Any, names: Iterable[str], *, least: int = 1, most: int = LARGEST) -> Iterator[str]:
    """A fault for each whole number of these names that is out of range; None passes where the class allows it."""
    for name in names:
        value = getattr(of, name)
        if value is not None and not least <= value <= most:
            yield f"{name} {shown(value)}: must be {least} or more{f', at most {most:,}' if value > most else ''}."


def one_of(of: Any, name: str, known: Iterable[str]) -> Iterator[str]:
    """A fault when the named value is none of those."""
    value, known = getattr(of, name), tuple(known)
    if value not in known:
        nearest = Known(known).nearest(value) if isinstance(value, str) else None
        meant = f" Did you mean {nearest!r}?" if nearest else ""
        yield f"{name} {shown(value)}:{meant} choose {' or '.join(known)}."


def read(form: type[Settings], data: Any) -> Settings:
    """Settings of that form from plain values, as JSON holds them.

    Raises SettingsError with everything that does not fit, each setting named by the way to it: `config.stages.0.entropy`.
    """
    try:
        return TypeAdapter(form).validate_json(json.dumps(data), strict=True)
    except ValidationError as error:
        raise SettingsError(dict.fromkeys(_faults(form, error))) from None


def _faults(form: type[Any], error: ValidationError) -> Iterator[str]:
    for item in error.errors(include_url=False):
        place = ".".join(map(str, item["loc"]))
        cause = item.get("ctx", {}).get("error")
        if isinstance(cause, SettingsError):
            yield from (f"{place}.{fault}" if place else fault for fault in cause.faults)
        elif item["type"] == "unexpected_keyword_argument":
            *parents, key = item["loc"]
            yield f"{place}: there is no such setting. {Known(_keys(form, parents)).hint(str(key))}"
        elif item["type"] == "missing":
            yield f"{place}: is missing."
        else:
            yield f"{place or 'settings'} {shown(item['input'])}: {_must_be(item)}."


def _must_be(item: Any) -> str:
    """What pydantic wanted of a value, in words."""
    kind = item["type"]
    if kind == "literal_error":
        return f"choose {item['ctx']['expected']}"
    for start, words in _WANTED.items():
        if kind.startswith(start):
            return words
    return str(item["msg"])


_WANTED = {
    "int": "must be a whole number",
    "finite": "must be a finite number",
    "float": "must be a number",
    "bool": "must be true or false",
    "string": "must be text",
    "tuple": "must be a list",
    "too_": "has another number of values than it must have",
    "dataclass": "must be a table of settings",
    "missing_": "has too few values",
}
"""How the name of a kind of error begins -> what the value must be."""


def _keys(form: Any, parents: Iterable[Any]) -> list[str]:
    """The settings that the part of a form knows to which the keys lead."""
    for key in parents:
        if is_dataclass(form):
            form = get_type_hints(form)[key]
        else:  # a place in a list
            form = get_args(form)[0]
    return [field.name for field in fields(form)] if is_dataclass(form) else []
