"""What others add to Tandem's tables, the laboratory first of all: installed packages by entry
points, as Python packages declare them, and anybody by a dotted name, `package.module:attribute`.

A table that others may add to is a group `tandem.NAME` of entry points, each `name =
"module:attribute"`. Nothing is imported until it is asked for.
"""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Callable, Iterator, Mapping
from importlib import import_module
from importlib.metadata import entry_points
from typing import Any, TypeVar

from tandem.errors import TandemError, UsageError

V = TypeVar("V")

DOTTED = re.compile(r"[^\W\d]\w*(\.[^\W\d]\w*)*:[^\W\d]\w*(\.[^\W\d]\w*)*")
"""`package.module:attribute`, each part a Python name."""


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


def is_dotted(name: str) -> bool:
    """Whether the name says where something stands, `package.module:attribute`, instead of being
    one that a table has.
    """
    return DOTTED.fullmatch(name) is not None


def resolved(home: str) -> Any:
    """What `module:attribute` names. Raises ImportError or AttributeError when it is not there."""
    module, _, name = home.partition(":")
    found: Any = import_module(module)
    for part in name.split("."):
        found = getattr(found, part)
    return found


def from_here(home: str) -> Any:
    """What a dotted name leads to; modules are looked for where Python finds them, and at last in
    the folder in which the command runs.

    Raises UsageError when it leads nowhere, whatever goes wrong in that module.
    """
    if (here := os.getcwd()) not in sys.path:
        sys.path.append(here)
    try:
        return resolved(home)
    except Exception as error:
        raise UsageError(
            f"{home}: cannot be loaded ({_told(error)}). Write package.module:attribute, of a"
            " module that Python finds: in this folder, on PYTHONPATH, or installed."
        ) from error


def _told(error: Exception) -> str:
    """An error of somebody's module in one line."""
    text = " ".join(str(error).split())
    kind = type(error).__name__
    return text if isinstance(error, (ImportError, AttributeError)) and text else f"{kind}: {text}"


def as_it_is(home: str, found: Any) -> Any:
    """What stands there, taken for a line of the table."""
    return found


class Table(Mapping[str, V]):
    """Our own entries, those that installed packages add to the table of that name, and whatever a
    dotted name leads to. Theirs are imported when they are first asked for.

    Walking the table, its length and `in` import nothing. A dotted name is `in` every table, and no
    part of its walk. Asking for an entry that cannot be imported, or is no line of this table,
    raises UsageError; `sound` and `told` go on beside it.

    Args:
      name: of the group of entry points, without `tandem.`.
      own: our entries.
      read: makes a line of the table of what stands at a place (`module:attribute`); raises
        UsageError when it is none.
    """

    def __init__(
        self,
        name: str,
        own: Mapping[str, V],
        read: Callable[[str, Any], V] = as_it_is,
    ) -> None:
        self._name, self._read = name, read
        self._found: dict[str, V] = dict(own)
        self._homes = {key: home for key, home in added(name).items() if key not in own}
        self._order = (*own, *self._homes)

    def __getitem__(self, name: str) -> V:
        if name not in self._found:
            if name in self._homes:
                self._found[name] = self._of_a_package(name, self._homes[name])
            elif is_dotted(name):
                self._found[name] = self._read(name, from_here(name))
        return self._found[name]

    def _of_a_package(self, name: str, home: str) -> V:
        try:
            if not is_dotted(home):
                raise UsageError("it is not of the form package.module:attribute")
            return self._read(home, resolved(home))
        except Exception as error:
            said = str(error) if isinstance(error, TandemError) else _told(error)
            raise UsageError(
                f"{name!r} of tandem.{self._name} is added by an installed package, and cannot be"
                f" loaded from {home}: {said.rstrip('.')}. Mend that package, or uninstall it."
            ) from error

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and (name in self._order or is_dotted(name))

    def __iter__(self) -> Iterator[str]:
        return iter(self._order)

    def __len__(self) -> int:
        return len(self._order)

    def sound(self) -> dict[str, V]:
        """The entries that can be loaded, by name."""
        found = {}
        for name in self:
            try:
                found[name] = self[name]
            except UsageError:
                continue
        return found

    def told(self, what: Callable[[V], str]) -> dict[str, str]:
        """Name -> what is said of it in a list; of one that cannot be loaded, why not."""
        found = {}
        for name in self:
            try:
                found[name] = what(self[name])
            except UsageError as error:
                found[name] = f"cannot be used: {error}"
        return found
