"""What files and settings of trainings must look like, held against frozen forms: every fault in
words, at its place in the data.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, TypeVar, get_args, get_type_hints

from pydantic import AfterValidator, BaseModel, ConfigDict, ValidationError

from tandem.cell.names import Known
from tandem.errors import CellError, Fault, UsageError
from tandem.files.messages import shown

STRICT = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False)
"""How documents and settings are read: no unknown keys, no value of another type, no infinity."""

MOST_BYTES = 2**26
"""Of a document that a training writes; one of a thousand tasks has a hundredth of that."""


class Form(BaseModel):
    """A document of a run: frozen, and read strictly."""

    model_config = ConfigDict(**STRICT, frozen=True)


def key_of(table: Iterable[str]) -> AfterValidator:
    """A text that the table has; `Annotated[str, key_of(TABLE)]`. A new line of the table is known
    by itself.
    """

    def check(value: str) -> str:
        if value not in (names := tuple(table)):
            nearest = Known(names).nearest(value)
            meant = f"Did you mean {nearest!r}? " if nearest else ""
            raise ValueError(f"{meant}choose {' or '.join(map(repr, names))}")
        return value

    return AfterValidator(check)


Made = TypeVar("Made", bound=Form)


class SettingsError(UsageError, ValueError):
    """Settings that do not hold. Each of `faults` begins with the setting's name; pydantic collects
    them because they are values, too.
    """

    def __init__(self, faults: Iterable[str]):
        self.faults = tuple(faults)
        super().__init__(
            "The training's settings do not hold:\n"
            + "\n".join(f"- {fault}" for fault in self.faults)
        )


def read_document(path: Path, form: type[Made]) -> Made:
    """The JSON document in the file.

    Raises:
      OSError: it cannot be read.
      CellError: it is no JSON, or not of this form; with everything that is wrong.
    """
    with open(path, "rb") as file:
        data = file.read(MOST_BYTES + 1)
    if len(data) > MOST_BYTES:
        raise unreadable(
            path, [f"has more than {MOST_BYTES:,} bytes, which no file of a training has."]
        )
    return parsed(path, data, form)


def parsed(path: Path, text: str | bytes, form: type[Made], within: str = "") -> Made:
    """The JSON document in the text, which stands in that file, `within` a part of it. Raises
    CellError as `read_document` does.
    """
    try:
        return form.model_validate_json(text)
    except ValidationError as error:
        faults = dict.fromkeys(complaints(form, error))
        raise unreadable(
            path, [f"{within}: {fault}" if within else fault for fault in faults]
        ) from None


def unreadable(path: str | Path, faults: Iterable[str]) -> CellError:
    """What is wrong with a file, as the error to raise."""
    return CellError([Fault(fault, (), str(path)) for fault in faults])


def complaints(form: Any, error: ValidationError) -> Iterator[str]:
    """Everything that pydantic found wrong with data of a form, each value named by the way to it:
    `config.stages.0.entropy`.
    """
    found = error.errors(include_url=False)
    within = {item["loc"][: len(item["loc"]) - 1] for item in found}
    for item in found:
        if item["type"] == "too_short" and item["loc"] in within:
            continue  # it is said already what is wrong with the values that are there
        place = ".".join(map(str, item["loc"]))
        cause = item.get("ctx", {}).get("error")
        if isinstance(cause, SettingsError):
            yield from (f"{place}.{fault}" if place else fault for fault in cause.faults)
        elif item["type"] == "json_invalid":
            yield f"is no JSON that can be read: {item['ctx']['error']}."
        elif item["type"] in ("unexpected_keyword_argument", "extra_forbidden"):
            *parents, key = item["loc"]
            yield f"{place}: there is no such setting. {Known(_keys(form, parents)).hint(str(key))}"
        elif item["type"] == "missing":
            yield f"{place}: is missing."
        else:
            yield f"{place or 'the whole'} {shown(item['input'])}: {_must_be(item)}."


def _must_be(item: Any) -> str:
    """What pydantic wanted of a value, in words."""
    kind = item["type"]
    if kind == "literal_error":
        return f"choose {item['ctx']['expected']}"
    if kind in _LIMITS:
        key, words = _LIMITS[kind]
        return words.format(f"{item['ctx'][key]:,}".removesuffix(".0"))
    for start, words in _WANTED.items():
        if kind.startswith(start):
            return words
    return str(item["msg"]).removeprefix("Value error, ").rstrip(".")


_LIMITS = {
    "greater_than_equal": ("ge", "must be {} or more"),
    "greater_than": ("gt", "must be more than {}"),
    "less_than_equal": ("le", "must be at most {}"),
    "less_than": ("lt", "must be less than {}"),
    "too_short": ("min_length", "needs {} or more values"),
    "too_long": ("max_length", "has room for {} values"),
}
"""Kind of error -> where its limit stands, and what it says."""

_WANTED = {
    "int": "must be a whole number",
    "finite": "must be a finite number",
    "float": "must be a number",
    "bool": "must be true or false",
    "string_type": "must be text",
    "tuple": "must be a list",
    "list": "must be a list",
    "dict": "must be a table",
    "model": "must be a table",
    "dataclass": "must be a table of settings",
}
"""How the name of a kind of error begins -> what the value must be."""


def _keys(form: Any, parents: Iterable[Any]) -> list[str]:
    """The keys that the part of a form knows to which the way leads."""
    for key in parents:
        if is_dataclass(form) or (isinstance(form, type) and issubclass(form, BaseModel)):
            form = get_type_hints(form)[key]
        else:  # a place in a list
            form = get_args(form)[0]
    return [field.name for field in fields(form)] if is_dataclass(form) else list(form.model_fields)
