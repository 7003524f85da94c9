"""Settings of a training: frozen dataclasses that pydantic checks, however they are made, with
every fault told at once.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import fields
from functools import wraps
from typing import Annotated, Any, TypeVar

from pydantic import Field, TypeAdapter, ValidationError
from pydantic.dataclasses import dataclass as validated

from tandem.learn.forms import STRICT, SettingsError, complaints

LARGEST = 2**31 - 1
"""The largest whole number that a compiled training counts to."""

Count = Annotated[int, Field(ge=1, le=LARGEST)]
Share = Annotated[float, Field(ge=0, le=1)]
Positive = Annotated[float, Field(gt=0)]
NotNegative = Annotated[float, Field(ge=0)]
Batch = Annotated[int, Field(ge=1, le=2**16)]
"""So many games, draws or decisions at once."""
Units = Annotated[int, Field(ge=1, le=4096)]
"""Of a layer of a network."""

Settings = TypeVar("Settings")


def checked(form: type[Settings]) -> type[Settings]:
    """Makes a frozen dataclass hold its annotations: where values do not fit, by type or by range,
    SettingsError is raised with all of them, as its `__post_init__` may for what two settings say
    together.
    """
    made: Any = validated(form, config=STRICT, frozen=True)
    plain = made.__init__
    by_place = [field.name for field in fields(made) if not field.kw_only]

    @wraps(plain)
    def init(self: Any, *arguments: Any, **given: Any) -> None:
        named = dict(zip(by_place, arguments, strict=False))  # so that faults say the name
        try:
            plain(self, *arguments[len(named) :], **named, **given)
        except ValidationError as error:
            raise SettingsError(dict.fromkeys(complaints(made, error))) from None

    made.__init__ = init
    found: type[Settings] = made
    return found


def must_hold(faults: Iterable[str]) -> None:
    """Raises SettingsError when there are any."""
    if found := tuple(faults):
        raise SettingsError(found)


def read(form: type[Settings], data: Any) -> Settings:
    """Settings of that form from plain values, as JSON holds them.

    Raises SettingsError with everything that does not fit, each setting named by the way to it:
    `config.stages.0.entropy`.
    """
    try:
        return TypeAdapter(form).validate_json(json.dumps(data), strict=True)
    except ValidationError as error:
        raise SettingsError(dict.fromkeys(complaints(form, error))) from None
