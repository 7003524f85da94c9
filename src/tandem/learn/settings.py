"""Settings of a training: frozen dataclasses that check themselves, read from plain data with every
fault told at once.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from typing import Any, TypeVar

from pydantic import TypeAdapter, ValidationError

from tandem.cell.names import Known
from tandem.files.messages import shown
from tandem.learn.forms import SettingsError, complaints

LARGEST = 2**31 - 1
"""The largest whole number that a compiled training counts to."""

Settings = TypeVar("Settings")


def must_hold(faults: Iterable[str]) -> None:
    """Raises SettingsError when there are any."""
    if found := tuple(faults):
        raise SettingsError(found)


def counts(of: Any, names: Iterable[str], *, least: int = 1, most: int = LARGEST) -> Iterator[str]:
    """A fault for each whole number of these names that is out of range; None passes where the
    class allows it.
    """
    for name in names:
        value = getattr(of, name)
        if value is not None and not least <= value <= most:
            yield (
                f"{name} {shown(value)}: must be {least} or"
                f" more{f', at most {most:,}' if value > most else ''}."
            )


def one_of(of: Any, name: str, known: Iterable[str]) -> Iterator[str]:
    """A fault when the named value is none of those."""
    value, known = getattr(of, name), tuple(known)
    if value not in known:
        nearest = Known(known).nearest(value) if isinstance(value, str) else None
        meant = f" Did you mean {nearest!r}?" if nearest else ""
        yield f"{name} {shown(value)}:{meant} choose {' or '.join(known)}."


def read(form: type[Settings], data: Any) -> Settings:
    """Settings of that form from plain values, as JSON holds them.

    Raises SettingsError with everything that does not fit, each setting named by the way to it:
    `config.stages.0.entropy`.
    """
    try:
        return TypeAdapter(form).validate_json(json.dumps(data), strict=True)
    except ValidationError as error:
        raise SettingsError(dict.fromkeys(complaints(form, error))) from None
