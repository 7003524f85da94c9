"""What installed packages add to Tandem's tables, the laboratory first of all: entry points, as
Python packages declare them.

A table that others may add to is a group `tandem.NAME` of entry points, each `name =
"module:attribute"`. Nothing is imported until it is asked for.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib import import_module
from importlib.metadata import entry_points
from typing import Any, TypeVar

from tandem.errors import UsageError

V = TypeVar("V")


def added(table: str) -> dict[str, str]:
    """Name -> `module:attribute` of all that installed packages add to the table, in the order of
    their names.
    """
    found = entry_points(group=f"tandem.{table}")
    return {entry.name: entry.value for entry in sorted(found, key=lambda entry: entry.name)}


def extended(table: str, own: Mapping[str, str]) -> dict[str, str]:
    """Our own lines, `name -> module:attribute`, then those that installed packages add; a name
    that we have stays ours.
    """
    return {**own, **{name: home for name, home in added(table).items() if name not in own}}


def resolved(home: str) -> Any:
    """What `module:attribute` names. Raises ImportError or AttributeError when it is not there."""
    module, name = home.split(":")
    return getattr(import_module(module), name)


class Table(Mapping[str, V]):
    """Our own entries, and those that installed packages add to the table of that name; theirs are
    imported when they are first asked for.

    Asking for one whose package cannot be imported raises UsageError.
    """

    def __init__(self, name: str, own: Mapping[str, V]) -> None:
        self._name = name
        self._found: dict[str, V] = dict(own)
        self._homes = added(name)

    def __getitem__(self, name: str) -> V:
        if name not in self._found:
            self._found[name] = self._loaded(name, self._homes[name])
        return self._found[name]

    def _loaded(self, name: str, home: str) -> V:
        try:
            found: V = resolved(home)
        except (ImportError, AttributeError) as error:
            raise UsageError(
                f"{name!r} of tandem.{self._name} is added by an installed package, and cannot be"
                f" loaded from {home}: {error}. Mend that package, or uninstall it."
            ) from error
        return found

    def __iter__(self) -> Iterator[str]:
        return iter({**self._found, **self._homes})

    def __len__(self) -> int:
        return len({**self._found, **self._homes})
