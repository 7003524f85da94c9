"""A file of people in: `load_crew("people.yaml")`. YAML or JSON.

limits: {dose:duet: 0.03}          # of everybody who states none of their own
periods: [120, 120, 120, 120]      # minutes
people:
  anna: {}
  ben: {roles: [human], cannot: [lift housing], periods: [1, 2], limits: {peak:reba: 7}}
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import Any

from tandem.cell.crew import Crew, Person
from tandem.cell.names import Known, clean
from tandem.errors import CellError, Fault
from tandem.files.facts.document import tree
from tandem.files.load import text_of
from tandem.files.messages import shown
from tandem.files.positions import Document

TOP = ("people", "limits", "periods")
OF_A_PERSON = ("roles", "cannot", "periods", "limits")
MOST_PEOPLE, MOST_PERIODS = 200, 48

At = tuple[str | int, ...]


@dataclass(frozen=True)
class CrewFile:
    """A crew, and where each of its words stands."""

    crew: Crew
    document: Document

    def placed(self, faults: Iterable[Fault]) -> list[Fault]:
        """The faults at their lines, in the order of the file."""
        found = [(self.document.place(fault.path), fault) for fault in faults]
        found.sort(key=lambda one: one[0][:2])
        return [fault.at(place.text) for place, fault in found]


def load_crew(path: str | os.PathLike[str]) -> CrewFile:
    """The people that a file names; `-` reads standard input.

    Raises:
      CellError: it cannot be read, or does not say who is there; with every fault at its line.
    """
    source = "standard input" if os.fspath(path) == "-" else os.fspath(path)
    document = tree(text_of(Path(path), source), source)
    reader = _Reader()
    crew = reader.crew(document.plain())
    file = CrewFile(crew, document)
    if faults := [*document.faults, *file.placed(reader.faults)]:
        raise CellError(faults)
    return file


class _Reader:
    """Plain values in, a crew out; what is wrong is collected."""

    def __init__(self) -> None:
        self.faults: list[Fault] = []

    def refuse(self, message: str, at: At) -> None:
        self.faults.append(Fault(message, at))

    def crew(self, plain: Any) -> Crew:
        if not isinstance(plain, dict):
            self.refuse("a file of people is a mapping: `people: {anna: {}, ben: {}}`.", ())
            return Crew(())
        self.known(plain, TOP, ())
        stated = plain.get("people")
        if isinstance(stated, list) and all(isinstance(name, str | int) for name in stated):
            stated = {str(name): {} for name in stated}
        if not isinstance(stated, dict) or not stated:
            self.refuse("`people` is missing or empty. Name them: `people: {anna: {}}`.", ())
            stated = {}
        if len(stated) > MOST_PEOPLE:
            self.refuse(f"{len(stated)} people are more than {MOST_PEOPLE}.", ("people",))
            stated = {}
        return Crew(
            tuple(self.person(name, value) for name, value in stated.items()),
            self.limits(plain.get("limits"), ("limits",)),
            self.minutes(plain.get("periods")),
        )

    def person(self, name: Any, value: Any) -> Person:
        at, name = ("people", name), clean(str(name))
        if value is None:
            value = {}
        if not isinstance(value, dict):
            self.refuse(
                f"person {name!r}: {shown(value)} is no mapping. Write `{name}: {{}}`, or say what"
                f" they can do: `{name}: {{roles: [...], limits: {{...}}}}`.",
                at,
            )
            return Person(name)
        self.known(value, OF_A_PERSON, at)
        return Person(
            name,
            self.names(value.get("roles"), (*at, "roles")),
            self.names(value.get("cannot"), (*at, "cannot")) or (),
            self.periods(value.get("periods"), (*at, "periods")),
            self.limits(value.get("limits"), (*at, "limits")),
        )

    def known(self, table: dict[Any, Any], names: tuple[str, ...], at: At) -> None:
        for name in table:
            if name not in names:
                self.refuse(f"unknown key `{name}`. {Known(names).hint(str(name))}", (*at, name))

    def names(self, value: Any, at: At) -> tuple[str, ...] | None:
        if value is None:
            return None
        rows = value if isinstance(value, list) else [value]
        if wrong := [one for one in rows if isinstance(one, dict | list | bool) or one is None]:
            self.refuse(f"{at[-1]} is {shown(wrong[0])}, but a list of names is needed.", at)
            return None
        return tuple(clean(str(one)) for one in rows)

    def periods(self, value: Any, at: At) -> tuple[int, ...] | None:
        if value is None:
            return None
        rows = value if isinstance(value, list) else [value]
        if not rows or any(isinstance(n, bool) or not isinstance(n, int) or n < 1 for n in rows):
            self.refuse(
                f"periods is {shown(value)}, but a list of their numbers is needed, counted from 1,"
                " such as [1, 2]. Leave it out for somebody who is there all shift.",
                at,
            )
            return None
        return tuple(rows)

    def minutes(self, value: Any) -> tuple[float, ...] | None:
        if value is None:
            return None
        rows = value if isinstance(value, list) else []
        fit = [n for n in rows if _is_number(n) and 0 < n <= 1440]
        if not rows or len(fit) < len(rows) or len(rows) > MOST_PERIODS:
            self.refuse(
                f"periods is {shown(value)}, but the minutes of each period are needed, such as"
                f" [120, 120]: each more than 0 and at most 1440, at most {MOST_PERIODS} of them.",
                ("periods",),
            )
            return None
        return tuple(map(float, rows))

    def limits(self, value: Any, at: At) -> dict[str, Decimal]:
        if value is None:
            return {}
        if not isinstance(value, dict):
            self.refuse(
                f"limits is {shown(value)}, but a mapping from a measure to the most of it is"
                " needed, such as {dose:duet: 0.03}.",
                at,
            )
            return {}
        return dict(self.limit(value, at))

    def limit(self, table: dict[Any, Any], at: At) -> Iterator[tuple[str, Decimal]]:
        for name, most in table.items():
            if not _is_number(most) or most < 0:
                self.refuse(
                    f"limit {name} is {shown(most)}, but must be a number, 0 or more.", (*at, name)
                )
            else:
                yield str(name).strip(), Decimal(repr(most))


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e15
