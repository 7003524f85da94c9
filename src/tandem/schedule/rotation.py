"""Job rotation: who works in whose place of a cell, period by period, and what that puts on each
person. The exact judge of rotations; it knows no solver.

A role is a human of the cell with all tasks that a plan gives to them. In each period every role is
filled by one person of the crew, who works by the plan, product after product. What a person bears
in a shift is told by the measures of `schedule.exposure` that can be told over several roles:

| name | of one person in a shift |
|---|---|
| `dose:SCALE` | sum over their periods: that of a product times the products of the period |
| `time-above:SCALE:LEVEL` | seconds in tasks at the level and above |
| `time-weighted:SCALE` | sum of value x seconds, over the seconds of all periods |
| `peak:SCALE` | highest value of a task |

The person's own assessment goes before that of the role, where the cell states one for a human of
that name.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from functools import cached_property

from tandem.cell.burdens import named, worth
from tandem.cell.crew import Crew, Person
from tandem.cell.measures import OWN, Measure, cost
from tandem.cell.model import Cell
from tandem.cell.names import Known
from tandem.errors import Fault, UsageError
from tandem.schedule.measures import exact, mode_of
from tandem.schedule.model import Schedule

COUNTED = ("dose", "time-above", "time-weighted", "peak")
"""Measures that are told over several roles."""


@dataclass(frozen=True)
class Period:
    """A stretch of the shift.

    Attributes:
      products: made in it, whole ones.
    """

    minutes: float
    products: int


@dataclass(frozen=True)
class Shift:
    """What is rotated over: the roles of a plan, the periods, the people.

    Attributes:
      roles: humans of the cell who have tasks in the plan, in the cell's order.
      each_s: seconds from one product to the next.
    """

    cell: Cell
    schedule: Schedule
    periods: tuple[Period, ...]
    crew: Crew
    each_s: float

    @cached_property
    def roles(self) -> tuple[str, ...]:
        return tuple(who for who in self.cell.humans if self.schedule.of(who))

    def tasks(self, role: str) -> tuple[str, ...]:
        """What the role does for each product, in order."""
        return tuple(row.task for row in self.schedule.of(role))

    def able(self, person: Person, role: str) -> bool:
        """Whether the person can work in this role."""
        fits = person.roles is None or role in person.roles
        return fits and not set(person.cannot) & set(self.tasks(role))

    def there(self, person: Person, period: int) -> bool:
        """Whether the person is there in a period, counted from 0."""
        return person.periods is None or period + 1 in person.periods

    def each(self, measure: Measure, person: Person, role: str) -> Decimal:
        """What a product adds for the person in this role, in units of `costs`; of `peak` the
        highest value of a task.
        """
        found = []
        for row in self.schedule.of(role):
            mode = mode_of(self.cell, row)
            if mode is None:
                continue
            value = worth(self.cell, measure.scale, row.task, mode).get(role)
            if measure.scale != OWN:
                own = self.cell.exposures.get(measure.scale, {}).get((row.task, person.name))
                value = value if own is None else own
            counted = None if value is None else cost(measure, value, exact(mode.time))
            found += [] if counted is None else [counted]
        return max(found, default=Decimal(0)) if measure.what == "peak" else sum(found, Decimal(0))

    def share(self, measure: Measure, period: int) -> Decimal:
        """What the `each` of a period is multiplied with; 1 for a peak."""
        if measure.what == "peak":
            return Decimal(1)
        products = Decimal(self.periods[period].products)
        if measure.what == "time-weighted":
            return products / sum((exact(one.minutes) * 60 for one in self.periods), Decimal(0))
        return products


@dataclass(frozen=True)
class Rotation:
    """Who works in which role in which period.

    Attributes:
      who: for each period, role -> name of the person.
    """

    shift: Shift
    who: tuple[Mapping[str, str], ...]

    def role_of(self, person: str, period: int) -> str | None:
        """What the person does in a period, counted from 0; None when they are not in this cell."""
        return next((role for role, name in self.who[period].items() if name == person), None)

    def has(self, measure: Measure, person: Person) -> Decimal:
        """What the person bears in the shift, exactly."""
        found = [Decimal(0)]
        for period in range(len(self.who)):
            if (role := self.role_of(person.name, period)) is not None:
                share = self.shift.share(measure, period)
                found.append(share * self.shift.each(measure, person, role))
        return max(found) if measure.what == "peak" else sum(found, Decimal(0))

    def worst(self, measure: Measure) -> Decimal:
        """What the person bears who bears most."""
        return max(self.has(measure, person) for person in self.shift.crew.people)

    def spread(self, measure: Measure) -> Decimal:
        """How much more that is than what the person bears who bears least."""
        found = [self.has(measure, person) for person in self.shift.crew.people]
        return max(found) - min(found)

    @property
    def stays(self) -> int:
        """How often somebody has the same role as in the period before."""
        return sum(
            before.get(role) == name
            for before, now in zip(self.who, self.who[1:], strict=False)
            for role, name in now.items()
        )


def faults(rotation: Rotation) -> list[str]:
    """Everything that is wrong with a rotation, in sentences; it reads nothing but the shift."""
    shift = rotation.shift
    people = {person.name: person for person in shift.crew.people}
    found = [*_of_periods(rotation, people)]
    for person in people.values():
        for name, most in shift.crew.most(person).items():
            has = rotation.has(rotation_measure(name, shift.cell), person)
            if has > most:
                found.append(
                    f"person {person.name!r}: comes to {float(has):.6g} of {name}, the limit is"
                    f" {most:f}."
                )
    return found


def _of_periods(rotation: Rotation, people: Mapping[str, Person]) -> Iterator[str]:
    shift = rotation.shift
    if len(rotation.who) != len(shift.periods):
        yield f"there are {len(rotation.who)} periods, but the shift has {len(shift.periods)}."
        return
    for period, filled in enumerate(rotation.who):
        where = f"period {period + 1}"
        if set(filled) != set(shift.roles):
            yield f"{where}: filled are {sorted(filled)}, the roles are {sorted(shift.roles)}."
        names = list(filled.values())
        for name in dict.fromkeys(names):
            if names.count(name) > 1:
                yield f"{where}: {name!r} has {names.count(name)} roles at once."
        for role, name in filled.items():
            person = people.get(name)
            if person is None:
                yield f"{where}: {name!r} is nobody of the crew."
            elif not shift.there(person, period):
                yield f"{where}: {name!r} is not there."
            elif role in shift.roles and not shift.able(person, role):
                yield f"{where}: {name!r} cannot work as {role!r}."


def rotation_measure(name: str, cell: Cell) -> Measure:
    """The measure of this name, which must be one that is told over several roles. Raises
    UsageError.
    """
    measure = named(name, cell)
    if measure.of_worst:
        raise UsageError(
            f"measure {name!r}: leave out `worst:`. Rotation makes the worst person's value least."
        )
    if measure.what == "sum":
        raise UsageError(
            f"measure {name!r} is that of one product. Take dose:stress: stress times the products"
            " of the shift."
        )
    if measure.what not in COUNTED:
        raise UsageError(
            f"measure {name!r}: what comes of it depends on the order of tasks within a product, so"
            " that it is not told over several roles. There are dose, time-above, time-weighted and"
            " peak."
        )
    return measure


def unfit(shift: Shift) -> list[Fault]:
    """What in a crew does not fit the cell, its plan or the periods; each at its key."""
    found: list[Fault] = [*_limits(shift.cell, shift.crew.limits, ("limits",))]
    roles, tasks = Known(shift.roles), Known(shift.cell.tasks)
    if not shift.roles:
        found.append(Fault("the plan gives no task to a human: there is nothing to rotate.", ()))
    for person in shift.crew.people:
        at = ("people", person.name)
        for place, role in enumerate(person.roles or ()):
            if role not in shift.roles:
                told = roles.hint(role)
                if role in shift.cell.humans:
                    told = f"The plan gives {role!r} no task. {told}"
                message = f"person {person.name!r}: {role!r} is no role of the plan. {told}"
                found.append(Fault(message, (*at, "roles", place)))
        for place, task in enumerate(person.cannot):
            if task not in shift.cell.tasks:
                message = f"person {person.name!r}: there is no task {task!r}. {tasks.hint(task)}"
                found.append(Fault(message, (*at, "cannot", place)))
        for place, period in enumerate(person.periods or ()):
            if period > len(shift.periods):
                message = (
                    f"person {person.name!r}: there is no period {period}, the shift has"
                    f" {len(shift.periods)}."
                )
                found.append(Fault(message, (*at, "periods", place)))
        found += _limits(shift.cell, person.limits, (*at, "limits"))
    return found


def _limits(
    cell: Cell, limits: Mapping[str, Decimal], at: tuple[str | int, ...]
) -> Iterator[Fault]:
    for name in limits:
        try:
            rotation_measure(name, cell)
        except UsageError as error:
            yield Fault(str(error), (*at, name))


def measures_of(cell: Cell) -> list[str]:
    """What rotation makes fair when nothing else is asked for: each dose that the cell's tasks are
    assessed for, without sides where the plain name is there; its own stress when there is none.
    """
    from tandem.cell.exposures import HANDS, kind

    doses = [scale for scale in cell.exposures if kind(scale) == "dose"]
    whole = [scale for scale in doses if not scale.endswith(HANDS)]
    return [f"dose:{scale}" for scale in whole] or [f"dose:{OWN}"]


def periods_of(
    minutes: Sequence[float], each_s: float, products: int | None = None
) -> tuple[Period, ...]:
    """Periods with the whole products that are made in each: as many as fit, or so many of the
    shift in proportion to the minutes (largest remainder; the earlier period first).
    """
    if products is None:
        return tuple(Period(one, int(exact(one) * 60 // exact(each_s))) for one in minutes)
    whole = sum(map(exact, minutes), Decimal(0))
    shares = [exact(one) * products / whole for one in minutes]
    made = [int(share) for share in shares]
    order = sorted(range(len(made)), key=lambda i: (made[i] - shares[i], i))
    for place in order[: products - sum(made)]:
        made[place] += 1
    return tuple(Period(one, count) for one, count in zip(minutes, made, strict=True))
