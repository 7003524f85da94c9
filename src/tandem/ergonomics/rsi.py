"""The Revised Strain Index: exertions of one hand to an index, for one task, for the subtasks of a
task (COSI) and for the tasks of a day (CUSI).

    RSI = IM EM DM PM HM

Source: Garg A, Moore JS, Kapellusch JM (2017) The Revised Strain Index: an improved upper extremity
exposure assessment model. Ergonomics 60(7):912-922; the composite and the cumulative index:
Ergonomics 60(7):1033-1041. The formulas were read in two independent programs that agree; the limit
of 10 between safe and hazardous was recalled.

The index rises with intensity, efforts, duration and hours, and with the bend of the wrist either
way. Where two branches of a formula meet it steps down by less than 0.05 % (E = 90 a minute, D = 60
s).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Annotated, Self

from pydantic import Field, model_validator

from tandem.ergonomics.facts import Facts, Several, fact
from tandem.ergonomics.outcome import Outcome, Published, Reason, Step

METHOD = "rsi"
LIMIT = 10.0
"""An index above it is hazardous (recalled)."""


def intensity_multiplier(
    *,
    I: Annotated[float, Field(gt=0, le=1)],  # noqa: E741 (the published name)
) -> float:
    """IM of the share of the greatest voluntary force (or Borg CR-10 / 10)."""
    if I <= 0.4:
        return 30 * I**3 - 15.6 * I**2 + 13 * I + 0.4
    return 36 * I**3 - 33.3 * I**2 + 24.77 * I - 1.86


def efforts_multiplier(*, E: Annotated[float, Field(gt=0)]) -> float:
    """EM of efforts per minute."""
    return float(0.1 + 0.25 * E if E <= 90 else 0.00334 * E**1.96)


def duration_multiplier(*, D: Annotated[float, Field(gt=0)]) -> float:
    """DM of seconds per exertion."""
    return 0.45 + 0.31 * D if D <= 60 else 19.17 * math.log(D) - 59.44


def posture_multiplier(*, P: Annotated[float, Field(ge=-90, le=90)]) -> float:
    """PM of the wrist's angle in degrees, extension positive, flexion negative."""
    if P < 0:
        return 1.2 * math.exp(-0.009 * P) - 0.2
    return 1.0 if P <= 30 else 1 + 0.00028 * (P - 30) ** 2


def hours_multiplier(*, H: Annotated[float, Field(gt=0)]) -> float:
    """HM of hours a day."""
    return 0.2 if H <= 0.05 else 0.042 * H + 0.09 * math.log(H) + 0.477


class Exertion(Facts):
    """Exertions of one kind, of one hand."""

    I: float = fact(  # noqa: E741 (the published name)
        "intensity, share of the greatest force (Borg CR-10 / 10)",
        "",
        above=0,
        high=1,
        cautious=1.0,
    )
    E: float = fact("efforts per minute", "1/min", above=0, high=300, cautious=20.0)
    D: float = fact("duration of one exertion", "s", above=0, high=3600, cautious=3.0)
    P: float = fact("wrist, extension positive, flexion negative", "deg", -90, 90, cautious=-60.0)

    @model_validator(mode="after")
    def _within_the_minute(self) -> Self:
        if self.E * self.D > 60.0000001:
            raise ValueError(
                f"E {self.E:g} per minute of D {self.D:g} s each are {self.E * self.D:g} s of"
                " exertion in a minute of 60 s. Correct one of them."
            )
        return self


class RsiFacts(Exertion):
    """Exertions of one kind, and how long a day they go on."""

    H: float = fact("hours a day", "h", above=0, high=24, cautious=8.0)


class CosiFacts(Facts):
    """Exertions of several kinds that take turns in one task, and how long a day that goes on."""

    subtasks: Several[Exertion]
    H: float = fact("hours a day", "h", above=0, high=24, cautious=8.0)


class CusiFacts(Facts):
    """The tasks of a day, one after the other."""

    tasks: Several[CosiFacts]

    @model_validator(mode="after")
    def _within_a_day(self) -> Self:
        if (hours := sum(task.H for task in self.tasks)) > 24:
            raise ValueError(f"the tasks take {hours:g} h together, but a day has 24. Correct H.")
        return self


def _multipliers(exertion: Exertion, hours: float) -> dict[str, float]:
    return {
        "IM": intensity_multiplier(I=exertion.I),
        "EM": efforts_multiplier(E=exertion.E),
        "DM": duration_multiplier(D=exertion.D),
        "PM": posture_multiplier(P=exertion.P),
        "HM": hours_multiplier(H=hours),
    }


def assess(facts: RsiFacts) -> Outcome:
    """The index of one kind of exertion, and its multipliers."""
    found = _multipliers(facts, facts.H)
    index = math.prod(found.values())
    given = {"IM": facts.I, "EM": facts.E, "DM": facts.D, "PM": facts.P, "HM": facts.H}
    steps = [
        Step(
            f"rsi_{name}",
            value,
            (Reason(f"rsi_{_wrist(name, facts.P)}", abs(given[name]), neutral=value <= 1),),
            weight=max(math.log(value), 0.0),
        )
        for name, value in found.items()
    ]
    steps.append(Step("RSI", index, (Reason("product"),)))
    return Outcome(METHOD, index, int(index > LIMIT), {**found, "RSI": index}, tuple(steps))


def _wrist(name: str, angle: float) -> str:
    return "PM_flexed" if name == "PM" and angle < 0 else name


def _stacked(
    indices: Sequence[float], given: Sequence[float], multiplier: Callable[[float], float]
) -> tuple[float, list[int]]:
    """The greatest index, and of each smaller one what its amount adds on top of those before it:

    I_1 + sum over i > 1 of I_i / M(x_i) (M(x_1+..+x_i) - M(x_1+..+x_(i-1)))
    """
    order = sorted(range(len(indices)), key=lambda place: (-indices[place], -given[place]))
    total, amount = indices[order[0]], given[order[0]]
    for place in order[1:]:
        before, amount = amount, amount + given[place]
        share = (multiplier(amount) - multiplier(before)) / multiplier(given[place])
        total += indices[place] * share
    return total, order


def _cosi(facts: CosiFacts) -> tuple[float, list[float], list[int]]:
    indices = [math.prod(_multipliers(task, facts.H).values()) for task in facts.subtasks]
    total, order = _stacked(
        indices, [task.E for task in facts.subtasks], lambda efforts: efforts_multiplier(E=efforts)
    )
    return total, indices, order


def composite(facts: CosiFacts) -> Outcome:
    """COSI: the subtask of the greatest index counts in full, each other one by what its efforts
    add to the efforts multiplier.
    """
    total, indices, order = _cosi(facts)
    steps = [
        Step("RSI", indices[place], (Reason("subtask", float(place + 1)),), weight=indices[place])
        for place in order
    ]
    steps.append(Step("COSI", total, (Reason("composite", float(len(indices))),)))
    return Outcome(METHOD, total, int(total > LIMIT), {"COSI": total, "RSI": indices}, tuple(steps))


def cumulative(facts: CusiFacts) -> Outcome:
    """CUSI: the task of the greatest COSI counts in full, each other one by what its hours add to
    the hours multiplier.
    """
    indices = [_cosi(task)[0] for task in facts.tasks]
    total, order = _stacked(
        indices, [task.H for task in facts.tasks], lambda hours: hours_multiplier(H=hours)
    )
    steps = [
        Step("COSI", indices[place], (Reason("task", float(place + 1)),), weight=indices[place])
        for place in order
    ]
    steps.append(Step("CUSI", total, (Reason("composite", float(len(indices))),)))
    return Outcome(
        METHOD, total, int(total > LIMIT), {"CUSI": total, "COSI": indices}, tuple(steps)
    )


FUNCTIONS: dict[str, Published] = {
    "rsi": Published(assess, RsiFacts),
    "cosi": Published(composite, CosiFacts),
    "cusi": Published(cumulative, CusiFacts),
    "rsi_im": Published(intensity_multiplier),
    "rsi_em": Published(efforts_multiplier),
    "rsi_dm": Published(duration_multiplier),
    "rsi_pm": Published(posture_multiplier),
    "rsi_hm": Published(hours_multiplier),
}
"""The published steps that can be asked for alone."""
