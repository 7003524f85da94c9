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
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from difflib import get_close_matches
from functools import cached_property

from tandem.cell.exposures import kind
from tandem.cell.model import Cell
from tandem.cell.parts import Mode
from tandem.errors import UsageError
from tandem.schedule.measures import exact, makespan, mode_of, stress
from tandem.schedule.model import Schedule

SHIFT_S = 28_800.0
"""Seconds of a shift when none is stated: eight hours."""

NUMBERS = {
    "sum": 0,
    "dose": 0,
    "peak": 0,
    "time-above": 1,
    "time-weighted": 0,
    "fatigue": 2,
}
"""Measure -> how many numbers stand behind its scale."""

OWN = "stress"
"""The scale that the cell's own numbers are."""


@dataclass(frozen=True)
class Measure:
    """A measure by its name.

    Attributes:
      what: a key of `NUMBERS`. `scale` is what it reads, `numbers` what stands behind the scale.
      of_worst: it is that of the person who has most.
    """

    what: str
    scale: str
    numbers: tuple[Decimal, ...] = ()
    of_worst: bool = False

    @cached_property
    def name(self) -> str:
        """As it is written on the command line and in documents."""
        if self.what == "sum":
            return "worst:stress" if self.of_worst else "stress"
        parts = [self.what, self.scale, *(f"{number:f}" for number in self.numbers)]
        return ":".join(["worst", *parts] if self.of_worst else parts)

    @property
    def per_makespan(self) -> bool:
        """Its value is what the allocation decides, over the makespan."""
        return self.what in ("dose", "time-weighted")

    @property
    def of_highest(self) -> bool:
        """Of several people it is that of the one who has most, and not the sum."""
        return self.of_worst or self.what in ("peak", "fatigue")


def named(name: str, cell: Cell) -> Measure:
    """The measure of this name for the cell. Raises UsageError when there is none, or the cell has
    nothing on its scale.
    """
    parts = name.strip().split(":")
    of_worst = parts[0] == "worst" and len(parts) > 1
    if of_worst:
        parts = parts[1:]
    if cell.stress_of_set is not None and (of_worst or len(parts) > 1) and OWN in parts:
        raise UsageError(
            f"measure {name!r}: the cell states its stress by sets of tasks (stress_of_set), not"
            " task by task. Take the measure stress, or one of another scale."
        )
    if parts in (["stress"], ["sum"]):
        return Measure("sum", OWN, (), of_worst)
    what, scale, rest = parts[0], parts[1] if len(parts) > 1 else "", parts[2:]
    if what not in NUMBERS:
        near = get_close_matches(what, NUMBERS, 1, 0.5)
        told = f"Did you mean {near[0]!r}? " if near else ""
        raise UsageError(
            f"there is no measure {name!r}. {told}There are stress, dose:SCALE, peak:SCALE,"
            " time-weighted:SCALE, time-above:SCALE:LEVEL, fatigue:SCALE:RISE:RECOVERY, and"
            " worst:MEASURE."
        )
    if what == "sum" or not scale or len(rest) != NUMBERS[what]:
        forms = {"time-above": "time-above:SCALE:LEVEL", "fatigue": "fatigue:SCALE:RISE:RECOVERY"}
        form = "stress" if what == "sum" else forms.get(what, f"{what}:SCALE")
        raise UsageError(f"measure {name!r}: write it as {form}.")
    _fits(name, what, scale, cell)
    return Measure(what, scale, tuple(_number(name, text) for text in rest), of_worst)


def _fits(name: str, what: str, scale: str, cell: Cell) -> None:
    known = scales(cell)
    if scale not in known:
        told = ", ".join(known)
        raise UsageError(
            f"measure {name!r}: no task of the cell has a value on the scale {scale!r}. It has"
            f" {told}; state `ergonomics` of its tasks."
        )
    is_dose = scale == OWN or kind(scale) == "dose"
    if what == "dose" and not is_dose:
        raise UsageError(
            f"measure {name!r}: {scale} only ranks, and ranks are not added. Take peak:{scale},"
            f" time-above:{scale}:LEVEL or time-weighted:{scale}."
        )


def _number(name: str, text: str) -> Decimal:
    try:
        number = Decimal(text)
    except InvalidOperation:
        number = Decimal("NaN")
    if not number.is_finite() or number < 0:
        raise UsageError(f"measure {name!r}: {text!r} must be a number, 0 or more.")
    return number


def scales(cell: Cell) -> list[str]:
    """The scales on which some task of the cell has a value; the cell's own stress is the first."""
    return [OWN, *cell.exposures]


def worth(cell: Cell, scale: str, task: str, mode: Mode) -> dict[str, Decimal]:
    """Human -> what one execution of the task in this mode is on the scale; who has no value there
    is left out.
    """
    if scale == OWN:
        return {human: exact(load) for human, load in mode.stress.items()}
    stated = cell.exposures.get(scale, {})
    return {who: stated[task, who] for who in mode.stress if (task, who) in stated}


def costs(cell: Cell, measure: Measure, task: str, mode: Mode) -> dict[str, Decimal]:
    """Human -> what the task in this mode adds to the measure of a cycle, or of `peak` what it is.

    Of `time-weighted` it is value x seconds, of `fatigue` RISE x value x minutes: the exponent of
    its envelope, see `envelope`.
    """
    seconds = exact(mode.time)
    found = worth(cell, measure.scale, task, mode)
    costs_each = {who: cost(measure, value, seconds) for who, value in found.items()}
    return {who: counted for who, counted in costs_each.items() if counted is not None}


def cost(measure: Measure, value: Decimal, seconds: Decimal) -> Decimal | None:
    """What one execution that is worth `value` and lasts so many seconds adds for whoever does it;
    None where it does not count.
    """
    if measure.what == "time-above":
        return seconds if value >= measure.numbers[0] else None
    if measure.what == "time-weighted":
        return value * seconds
    if measure.what == "fatigue":
        return measure.numbers[0] * value * seconds / 60
    return value


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
    """

    measure: Measure
    most: Decimal
    who: str | None = None

    @property
    def words(self) -> str:
        """As it is written on the command line."""
        return f"{self.measure.name}{f'@{self.who}' if self.who else ''}={self.most:f}"

    def per_cycle(self, cycles: float | None) -> Decimal:
        """What the `costs` of a person in one cycle may come to: exactly the limit, and of fatigue
        what keeps its envelope, so that it is kept however little they rest.

        Args:
          cycles: products of a shift; needed for a dose.
        """
        if self.measure.what == "dose":
            return self.most / exact(cycles or 1.0)
        if self.measure.what == "fatigue":
            if self.most >= 1:
                return Decimal("Infinity")
            # a little less than what comes to the limit, since logarithms are rounded
            return Decimal(repr(-math.log1p(-float(self.most)))) * (1 - Decimal("1e-12"))
        return self.most

    def faults(self, cell: Cell, schedule: Schedule, cycles: float | None) -> list[str]:
        """What is wrong with a schedule, by the exact formula; in sentences."""
        people = by_person(cell, schedule, self.measure, cycles=cycles)
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
    return Limit(measure, _number(name, most), who or None)


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
