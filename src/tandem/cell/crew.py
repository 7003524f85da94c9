"""The people of a shift: what each can do, when they are there, and how much they may bear.

A cell's humans are places at which somebody works; the people of a crew take turns there.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from decimal import Decimal


@dataclass(frozen=True)
class Person:
    """One person.

    Attributes:
      roles: humans of the cell in whose place they can work; in that of everybody when None.
      cannot: tasks that they cannot do, and so no role that has one of them.
      periods: in which they are there, counted from 1; in all when None.
      limits: the most of a measure that they may have in the shift, by its name, such as
        `dose:duet` or `peak:reba`.
    """

    name: str
    roles: tuple[str, ...] | None = None
    cannot: tuple[str, ...] = ()
    periods: tuple[int, ...] | None = None
    limits: Mapping[str, Decimal] = field(default_factory=dict)


@dataclass(frozen=True)
class Crew:
    """Who is there for a shift.

    Attributes:
      limits: of everybody who states none of their own for that measure.
      minutes: of each period; None when the file does not say.
    """

    people: tuple[Person, ...]
    limits: Mapping[str, Decimal] = field(default_factory=dict)
    minutes: tuple[float, ...] | None = None

    def most(self, person: Person) -> dict[str, Decimal]:
        """Measure -> the most that this person may have of it."""
        return {**self.limits, **person.limits}

    def without_limits(self) -> Crew:
        """The same people, who may bear anything."""
        return Crew(tuple(replace(one, limits={}) for one in self.people), {}, self.minutes)

    @property
    def measures(self) -> tuple[str, ...]:
        """Every measure that limits somebody."""
        own = (name for person in self.people for name in person.limits)
        return tuple(dict.fromkeys([*self.limits, *own]))
