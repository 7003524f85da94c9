"""What a schedule does to each person, by named measures: the exact judge of plans and limits.

A measure reads values of one execution of a task: those of an ergonomic scale (`cell.exposures`),
or the cell's own `stress`, the scale `stress`. Scores that only rank are never added: of them there
are the peak, the time at a level and above, and a mean over time; doses are added.

| name | of one person | of all |
|---|---|---|
| `sum` | stress over the tasks | sum; the cell's own measure |
| `dose:SCALE` | damage of a shift: that of a cycle times the cycles in the shift | sum |
| `peak:SCALE` | highest value of a task | highest |
| `time-above:SCALE:LEVEL` | seconds of a cycle in tasks at the level and above | sum |
| `time-weighted:SCALE` | sum of value x seconds, over the makespan | mean |
| `fatigue:SCALE:RISE:RECOVERY` | highest fatigue, 0 to 1, of one cycle begun rested | highest |
| `worst:MEASURE` | | the person who has most of that measure |

Fatigue: while a person works on a task of value v, `F' = RISE v (1 - F)`, else `F' = -RECOVERY F`,
both rates per minute (Jaber, Givi and Neumann 2013, Applied Mathematical Modelling 37:7287-7299;
the rise in proportion to the value is ours). The rates have no universal values: state your own.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal

from tandem.cell.burdens import costs, named
from tandem.cell.measures import OWN, Measure, number_in
from tandem.cell.model import Cell
from tandem.cell.parts import Mode
from tandem.errors import UsageError
from tandem.schedule.measures import exact, makespan, mode_of, stress
from tandem.schedule.model import Schedule

SHIFT_S = 28_800.0
"""Seconds of a shift when none is stated: eight hours."""


def by_person(
    cell: Cell,
    schedule: Schedule,
    measure: Measure,
    *,
    cycles: float | None = None,
    shift_s: float = SHIFT_S,
) -> dict[str, Decimal]:
    """Human -> their value of the measure, exact; of fatigue the nearest float.

    Args:
      cycles: products of a shift, which a dose counts; as many as fit, `shift_s` over the makespan,
        when None.
      shift_s: seconds of a shift.
    """
    if measure.what == "fatigue":
        return {who: _fatigue(cell, schedule, measure, who) for who in cell.humans}
    sums = dict.fromkeys(cell.humans, Decimal(0))
    for row in schedule:
        mode = mode_of(cell, row)
        for who, cost in ({} if mode is None else costs(cell, measure, row.task, mode)).items():
            sums[who] = max(sums[who], cost) if measure.what == "peak" else sums[who] + cost
    lasts = exact(makespan(schedule))
    if measure.what == "dose" and cycles is not None:
        return {who: value * exact(cycles) for who, value in sums.items()}
    if measure.per_makespan and lasts:
        factor = exact(shift_s) if measure.what == "dose" else Decimal(1)
        return {who: value * factor / lasts for who, value in sums.items()}
    return sums


def value(
    cell: Cell,
    schedule: Schedule,
    measure: Measure,
    *,
    cycles: float | None = None,
    shift_s: float = SHIFT_S,
) -> float:
    """The measure of the whole schedule, as the table above says; arguments as `by_person`."""
    if measure.what == "sum" and not measure.of_worst:
        return stress(cell, schedule)
    people = by_person(cell, schedule, measure, cycles=cycles, shift_s=shift_s)
    return float(together(measure, people))


def together(measure: Measure, people: Mapping[str, Decimal]) -> Decimal:
    """The measure of all, of those of each person."""
    if measure.of_highest:
        return max(people.values(), default=Decimal(0))
    total = sum(people.values(), Decimal(0))
    return total / max(1, len(people)) if measure.what == "time-weighted" else total


@dataclass(frozen=True)
class Limit:
    """The most of a measure that one person, or each person, may have.

    Attributes:
      who: a human; everybody when None.
      cycles: products of a shift, which a dose counts; needed where it is one.
    """

    measure: Measure
    most: Decimal
    who: str | None = None
    cycles: float | None = None

    @property
    def words(self) -> str:
        """As it is written on the command line."""
        return f"{self.measure.name}{f'@{self.who}' if self.who else ''}={self.most:f}"

    @property
    def per_cycle(self) -> Decimal:
        """What the `costs` of a person in one cycle may come to: exactly the limit, and of fatigue
        what keeps its envelope, so that it is kept however little they rest.
        """
        if self.measure.what == "dose":
            return self.most / exact(self.cycles or 1.0)
        if self.measure.what == "fatigue":
            if self.most >= 1:
                return Decimal("Infinity")
            # a little less than what comes to the limit, since logarithms are rounded
            return Decimal(repr(-math.log1p(-float(self.most)))) * (1 - Decimal("1e-12"))
        return self.most

    def due(self, cell: Cell, task: str, mode: Mode) -> dict[str, Decimal]:
        """Human -> what the task in this mode takes of their `room`, of those whom it holds for."""
        found = costs(cell, self.measure, task, mode)
        if self.measure.what == "peak":
            found = {who: Decimal(value > self.most) for who, value in found.items()}
        if self.measure.what == "dose":
            found = {who: value * exact(self.cycles or 1.0) for who, value in found.items()}
        return {who: value for who, value in found.items() if self.who in (None, who)}

    @property
    def room(self) -> Decimal:
        """What the `due` of all that a person does may come to. Of a peak it is 0, and a task above
        the limit takes 1: so every limit of `KEEPABLE` is kept by one running sum.
        """
        return Decimal(0) if self.measure.what == "peak" else self.most

    def faults(self, cell: Cell, schedule: Schedule) -> list[str]:
        """What is wrong with a schedule, by the exact formula; in sentences."""
        people = by_person(cell, schedule, self.measure, cycles=self.cycles)
        return [
            f"operator {who!r}: comes to {has:.6g} of {self.measure.name}, the limit is"
            f" {self.most:f}."
            for who, has in people.items()
            if self.who in (None, who) and has > self.most
        ]


def limit_of(text: str, cell: Cell, cycles: float | None) -> Limit:
    """The limit that is written `MEASURE=MOST` or `MEASURE@PERSON=MOST`. Raises UsageError for what
    is none, and for measures that cannot be one.
    """
    left, sign, most = text.rpartition("=")
    name, _, who = left.partition("@")
    if not sign or not name:
        raise UsageError(f"limit {text!r}: write it as MEASURE=MOST, such as peak:reba=7.")
    measure = named(name, cell)
    if who and who not in cell.humans:
        raise UsageError(
            f"limit {text!r}: {who!r} is no human of the cell. It has {', '.join(cell.humans)}."
        )
    if measure.of_worst:
        raise UsageError(f"limit {text!r}: a limit holds for each person; leave out `worst:`.")
    if measure.what == "time-weighted":
        raise UsageError(
            f"limit {text!r}: a mean over time falls by waiting alone, so it cannot be a limit."
            f" Limit peak:{measure.scale} or time-above:{measure.scale}:LEVEL."
        )
    if measure.what == "dose" and cycles is None:
        raise UsageError(
            f"limit {text!r}: say how many products a shift makes, --cycles-per-shift N: a dose is"
            " that of a shift."
        )
    return Limit(measure, number_in(name, most), who or None, cycles)


def all_limits(cell: Cell) -> Iterator[tuple[str, Limit]]:
    """What each person of the cell may have at most, with its name among their `limits`; of a
    `stress_limit`, which comes first, that is `stress`.
    """
    for who, operator in cell.operators.items():
        if operator.stress_limit is not None:
            yield OWN, Limit(Measure("sum", OWN), exact(operator.stress_limit), who)
        for name, most in operator.limits.items():
            yield name, Limit(named(name, cell), exact(most), who, cell.cycles_per_shift)


def envelope(cost: Decimal) -> float:
    """What the fatigue of a person is at most, whenever they rest: `1 - exp(-cost)`, with the
    `costs` of all their tasks. Without any rest it is just that.
    """
    return 1.0 - math.exp(-float(cost))


def _fatigue(cell: Cell, schedule: Schedule, measure: Measure, who: str) -> Decimal:
    recovery, fatigue, highest, clock = float(measure.numbers[1]), 0.0, 0.0, 0.0
    for row in schedule.of(who):
        mode = mode_of(cell, row)
        cost = Decimal(0) if mode is None else costs(cell, measure, row.task, mode).get(who, 0)
        fatigue *= math.exp(-recovery * max(0.0, row.start - clock) / 60)
        # a task without a value is neither work nor rest: what is not known does not refresh
        fatigue = 1.0 - (1.0 - fatigue) * math.exp(-float(cost))
        highest, clock = max(highest, fatigue), row.end
    return Decimal(repr(highest))
