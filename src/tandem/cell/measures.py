"""Measures of what work does to a person, by name, and which of them a limit may be.

`schedule.exposure` has the table of measures and judges schedules by them; `burdens` says what a
task adds to each. The key `limits` of an operator names some of them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from difflib import get_close_matches
from functools import cached_property
from typing import TYPE_CHECKING

from tandem.cell import assessed
from tandem.cell.exposures import exposures, kind
from tandem.errors import Fault, UsageError

if TYPE_CHECKING:
    from tandem.cell.parts import Fields, Operator


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


def read(name: str, known: Sequence[str], *, is_by_set: bool) -> Measure:
    """The measure of this name, of a cell that has these scales. Raises UsageError when there is
    none.
    """
    parts = name.strip().split(":")
    of_worst = parts[0] == "worst" and len(parts) > 1
    if of_worst:
        parts = parts[1:]
    if is_by_set and (of_worst or len(parts) > 1) and OWN in parts:
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
    _fits(name, what, scale, known)
    return Measure(what, scale, tuple(number_in(name, text) for text in rest), of_worst)


def _fits(name: str, what: str, scale: str, known: Sequence[str]) -> None:
    if scale not in known:
        told = ", ".join(known)
        raise UsageError(
            f"measure {name!r}: no task of the cell has a value on the scale {scale!r}. It has"
            f" {told}. State `ergonomics` of its tasks to have more."
        )
    is_dose = scale == OWN or kind(scale) == "dose"
    if what == "dose" and not is_dose:
        raise UsageError(
            f"measure {name!r}: {scale} only ranks, and ranks are not added. Take peak:{scale},"
            f" time-above:{scale}:LEVEL or time-weighted:{scale}."
        )


def number_in(name: str, text: str) -> Decimal:
    """The number in a part of a measure's name. Raises UsageError when it is none, 0 or more."""
    try:
        number = Decimal(text)
    except InvalidOperation:
        number = Decimal("NaN")
    if not number.is_finite() or number < 0:
        raise UsageError(f"measure {name!r}: {text!r} must be a number, 0 or more.")
    return number


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


def decimal(number: float) -> Decimal:
    """The decimal that the number prints as."""
    return Decimal(repr(float(number)))


KEEPABLE = ("dose", "peak", "time-above")
"""Measures that the key `limits` takes: what each task adds, or is, is known before it begins, so
that every plan and every decision can keep them exactly.
"""


def adds_up(name: str) -> bool:
    """Whether what one task brings of this limit adds to what another brings; of a peak it does
    not.
    """
    return not name.strip().startswith("peak:")


def faults(cell: Fields) -> Iterator[Fault]:
    """What is wrong with the limits of operators, each at its name."""
    if not any(operator.limits for operator in cell.operators.values()):
        return
    if any(assessed.faults(cell)):
        return  # what tasks come to is not known; those faults are told
    known = [OWN, *exposures(cell)]
    for who, operator in cell.operators.items():
        if operator.limits and operator.kind != "human":
            yield Fault(
                f"operator {who!r} is a {operator.kind} and has `limits`. Only humans have a body;"
                " take them out.",
                ("operators", who, "limits"),
            )
        else:
            yield from _of_operator(cell, who, operator, known)


def _of_operator(
    cell: Fields, who: str, operator: Operator, known: Sequence[str]
) -> Iterator[Fault]:
    seen: dict[Measure, str] = {}
    for name in operator.limits:
        path = ("operators", who, "limits", name)
        # first, so that no other spelling of it is asked for on the way
        if (why := _own_key(name)) is not None:
            yield Fault(f"operator {who!r}: limits: {name!r} {why}", path)
            continue
        try:
            measure = read(name, known, is_by_set=cell.stress_of_set is not None)
        except UsageError as error:
            yield Fault(f"operator {who!r}: limits: {error}", path)
            continue
        first = seen.setdefault(measure, name)
        if first != name:
            yield Fault(
                f"operator {who!r}: limits has {first!r} and {name!r}, which are one measure. Keep"
                " one.",
                path,
            )
        elif (why := _unkeepable(measure)) is not None:
            yield Fault(f"operator {who!r}: limits: {name!r} {why}", path)
        elif measure.what == "dose" and cell.cycles_per_shift is None:
            yield Fault(
                f"operator {who!r}: limits has {name!r}, and a dose is that of a shift. State how"
                " many products a shift makes: `cycles_per_shift: 400`, beside `operators`.",
                path,
            )


def _own_key(name: str) -> str | None:
    """What to write instead of a name that means the sum of stress, however it is spelled
    (`stress`, `sum`, `sum:stress`, with `worst:` before it); None when it means something else.
    """
    whose, _, rest = name.strip().partition(":")
    whole = rest if whose == "worst" else name.strip()
    if whole != OWN and whole.partition(":")[0] != "sum":
        return None
    each = "" if whole == name.strip() else " It holds for each person, so leave out `worst:`."
    scale = whole.partition(":")[2]
    other = (
        f" Of {scale} limit peak:{scale} or time-above:{scale}:LEVEL."
        if scale not in ("", OWN)
        else ""
    )
    return f"has a key of its own. Write `stress_limit: MOST` instead.{each}{other}"


def _unkeepable(measure: Measure) -> str | None:
    """Why the measure is no limit of a cell; None when it can be one."""
    if measure.of_worst:
        return "cannot stand here: a limit holds for each person; leave out `worst:`."
    if measure.what == "time-weighted":
        return (
            "cannot be a limit: a mean over time falls by waiting alone. Take"
            f" peak:{measure.scale} or time-above:{measure.scale}:LEVEL."
        )
    if measure.what not in KEEPABLE:
        return (
            "cannot be kept live: it depends on rest that is still to come. Take"
            f" `tandem plan --limit {measure.name}=MOST`, or a limit of peak:{measure.scale}"
            f" or time-above:{measure.scale}:LEVEL here."
        )
    return None
