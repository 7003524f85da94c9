"""The revised NIOSH lifting equation: the weight that is recommended for a lift, and what a load is
of it; for one kind of lift, or for several in one job.

    RWL = LC HM VM DM AM FM CM,    LI = L / RWL

Source: Waters TR, Putz-Anderson V, Garg A (1994, revised 2021) Applications manual for the revised
NIOSH lifting equation, DHHS (NIOSH) Publication 94-110, doi:10.26616/NIOSHPUB94110revised092021,
sections 1.3 to 1.5 and 2.4, tables 1 to 7. Public domain.

The manual's metric and US constants are not exact conversions of each other (23 kg and 51 lb, 25 cm
and 10 in): one lift is computed in one system. Its printed examples round each multiplier to two
decimals first; `rwl_as_printed` does so too. The index never falls with load, reach, travel,
asymmetry or frequency. It does with height: the best one is 75 cm. The column of the frequency
table changes at 75 cm as well.

It does not apply to lifting with one hand, over 8 h, seated or kneeling, in restricted space, of
unstable loads, while carrying, pushing or pulling, with a wheelbarrow or shovel, faster than about
76 cm/s, on slippery floors, or outside 19 to 26 degrees C (section 1.2).
"""

from __future__ import annotations

from collections.abc import Sequence
from decimal import ROUND_HALF_UP, Decimal
from typing import Annotated, Any, Literal, NamedTuple, Self

from pydantic import Field, model_validator

from tandem.ergonomics.facts import Facts, Several, fact
from tandem.ergonomics.outcome import Outcome, Published, Reason, Step, banded

METHOD = "niosh"

Unit = Literal["cm", "in"]
Duration = Literal["short", "moderate", "long"]
Coupling = Literal["good", "fair", "poor"]
Minutes = Annotated[float, Field(ge=0, le=1440)]


class System(NamedTuple):
    """The constants of one system of units."""

    lc: float
    h_min: float
    h_max: float
    v_ref: float
    v_slope: float
    v_max: float
    d_coefficient: float
    d_min: float
    d_max: float
    mass: str


SYSTEMS = {
    "cm": System(23, 25, 63, 75, 0.003, 175, 4.5, 25, 175, "kg"),
    "in": System(51, 10, 25, 30, 0.0075, 70, 1.8, 10, 70, "lb"),
}
"""Unit of length -> constants (tables 1 to 4): centimetres and kg, or inches and lb."""

FREQUENCIES = (0.2, 0.5, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15)
# table 5: a column for duration and V below or at least 75 cm (30 in), a value for each frequency
FM = {
    ("short", "low"): (1, .97, .94, .91, .88, .84, .80, .75, .70, .60, .52, .45, .41, .37, 0, 0, 0),
    ("short", "high"):
        (1, .97, .94, .91, .88, .84, .80, .75, .70, .60, .52, .45, .41, .37, .34, .31, .28),
    ("moderate", "low"):
        (.95, .92, .88, .84, .79, .72, .60, .50, .42, .35, .30, .26, 0, 0, 0, 0, 0),
    ("moderate", "high"):
        (.95, .92, .88, .84, .79, .72, .60, .50, .42, .35, .30, .26, .23, .21, 0, 0, 0),
    ("long", "low"): (.85, .81, .75, .65, .55, .45, .35, .27, .22, .18, 0, 0, 0, 0, 0, 0, 0),
    ("long", "high"): (.85, .81, .75, .65, .55, .45, .35, .27, .22, .18, .15, .13, 0, 0, 0, 0, 0),
}  # fmt: skip
CM = {"good": (1.0, 1.0), "fair": (0.95, 1.0), "poor": (0.9, 0.9)}
"""Table 7: below 75 cm (30 in), and at least so high."""
LIMITS = (1.0, 3.0)
"""Lifting indices up to which lifts are a goal of design, and a risk for some."""
MOST_MINUTES = 480


class Lift(Facts):
    """One kind of lift with two hands. Lengths in cm, masses in kg, or in and lb with `unit: in`.

    `H` beyond 63 cm, `V` and `D` beyond 175 cm and `A` beyond 135 degrees are no mistake: the
    equation then recommends no weight at all.
    """

    H: float = fact("horizontal, hands to the middle of the ankles", "cm", 0, 150, cautious=63.0)
    V: float = fact("height of the hands at the origin", "cm", 0, 250, cautious=0.0)
    D: float = fact("vertical travel of the hands", "cm", 0, 250, cautious=175.0)
    A: float = fact("asymmetry, body to load", "deg", 0, 180, cautious=135.0)
    F: float = fact("lifts per minute, mean over 15 min", "1/min", 0, 30, cautious=15.0)
    duration: Duration = fact(
        "short (1 h or less), moderate (2 h or less) or long (8 h or less), by niosh_duration",
        cautious="long",
    )
    coupling: Coupling = fact("grip: good, fair or poor", cautious="poor")


class NioshFacts(Lift):
    """A lift, its load, and the destination when the load must be placed with care there."""

    L: float | None = fact(
        "load (kg, or lb with unit in)", "kg", above=0, high=500, default=None, asked=True
    )
    unit: Unit = fact("of lengths: cm (with kg) or in (with lb)", default="cm")
    V_origin: float | None = fact(
        "height at the origin, when V is that of the destination", "cm", 0, 250, default=None
    )
    LC: float | None = fact("load constant instead of 23 kg or 51 lb", "kg", above=0, default=None)
    significant_control: bool = fact(
        "the load is placed with care: the destination counts too", default=False, cautious=True
    )
    H_destination: float | None = fact("horizontal at the destination", "cm", 0, 150, default=None)
    V_destination: float | None = fact("height at the destination", "cm", 0, 250, default=None)
    A_destination: float = fact("asymmetry at the destination", "deg", 0, 180, default=0.0)

    @model_validator(mode="after")
    def _destination(self) -> Self:
        if self.significant_control and None in (self.H_destination, self.V_destination):
            raise ValueError(
                "significant_control is true, so the destination counts too: H_destination and"
                " V_destination are missing. State them, or set significant_control to false."
            )
        return self


class Task(Lift):
    """One of several kinds of lift in a job; `L` is its average load, `L_max` its greatest."""

    L: float = fact("average load", "kg", above=0, high=500)
    L_max: float | None = fact("greatest load", "kg", above=0, high=500, default=None)
    V_origin: float | None = fact(
        "height at the origin, when V is that of the destination", "cm", 0, 250, default=None
    )


class JobFacts(Facts):
    """The kinds of lift of one job."""

    tasks: Several[Task]
    unit: Unit = "cm"


class Indices(Facts):
    """Printed indices of one kind of lift."""

    F: float = fact("lifts per minute", "1/min", 0, 30)
    FILI: float = fact("frequency-independent lifting index", above=0)
    STLI: float = fact("single-task lifting index", above=0)


class IndicesFacts(Facts):
    """Printed indices of a job, with the column of table 5 that all share."""

    tasks: Several[Indices]
    duration: Duration
    V: float = fact("height of the hands", "cm", 0, 250)
    unit: Unit = "cm"


class Multipliers(NamedTuple):
    """The six multipliers, each 0 to 1."""

    HM: float
    VM: float
    DM: float
    AM: float
    FM: float
    CM: float


def frequency_multiplier(
    frequency: float, duration: Duration, height: float, unit: Unit = "cm"
) -> float:
    """FM of table 5, between its rows by proportion; 0 above the last row that is not 0."""
    column = FM[duration, "high" if height >= SYSTEMS[unit].v_ref else "low"]
    if frequency <= FREQUENCIES[0]:
        return column[0]
    last = max(row for row, value in enumerate(column) if value > 0)
    if frequency > FREQUENCIES[last]:
        return 0.0
    row = next(row for row, f in enumerate(FREQUENCIES) if f >= frequency)
    low, high = FREQUENCIES[row - 1], FREQUENCIES[row]
    share = (frequency - low) / (high - low)
    return column[row - 1] + share * (column[row] - column[row - 1])


def multipliers(lift: Lift, unit: Unit = "cm", origin: float | None = None) -> Multipliers:
    """The multipliers in full precision (sections 1.3.1 to 1.3.7).

    Args:
      origin: height of the hands at the origin, when `V` of the lift is that of the destination;
        the frequency multiplier always goes by the origin.
    """
    s, (reach, height, travel) = SYSTEMS[unit], (lift.H, lift.V, lift.D)
    return Multipliers(
        HM=s.h_min / max(reach, s.h_min) if reach <= s.h_max else 0.0,
        VM=1 - s.v_slope * abs(height - s.v_ref) if height <= s.v_max else 0.0,
        DM=0.82 + s.d_coefficient / max(travel, s.d_min) if travel <= s.d_max else 0.0,
        AM=1 - 0.0032 * lift.A if lift.A <= 135 else 0.0,
        FM=frequency_multiplier(lift.F, lift.duration, height if origin is None else origin, unit),
        CM=CM[lift.coupling][0 if height < s.v_ref else 1],
    )


def _product(lc: float, found: Sequence[float]) -> float:
    weight = lc
    for multiplier in found:
        weight *= multiplier
    return weight


def rwl(facts: NioshFacts) -> Outcome:
    """Recommended weight limit and lifting index of one kind of lift, in full precision. With
    significant control at the destination the lower limit of both ends counts (section 1.4).
    """
    return _rwl(facts, multipliers(facts, facts.unit, facts.V_origin))


def rwl_as_printed(facts: NioshFacts) -> Outcome:
    """The same as the manual prints it: each multiplier rounded to two decimals, half up, before
    they are multiplied.
    """
    exact = multipliers(facts, facts.unit, facts.V_origin)
    return _rwl(facts, Multipliers(*(_two_decimals(value) for value in exact)))


def _two_decimals(value: float) -> float:
    # by way of ten digits, so that 0.8250000000000001 and 0.825 round alike
    exact = Decimal(f"{value:.10g}")
    return float(exact.quantize(Decimal("0.01"), rounding=ROUND_HALF_UP))


def _rwl(facts: NioshFacts, origin: Multipliers) -> Outcome:
    system = SYSTEMS[facts.unit]
    lc = system.lc if facts.LC is None else facts.LC
    found, limit, ends = origin, _product(lc, origin), ""
    if facts.significant_control:
        there = multipliers(_at_destination(facts), facts.unit, facts.V)
        if (other := _product(lc, there)) < limit:
            found, limit, ends = there, other, "destination"
        else:
            ends = "origin"
    index = facts.L / limit if facts.L is not None and limit > 0 else None
    steps = [Step("LC", lc, (Reason("load_constant", lc),))]
    steps += _steps(facts if ends != "destination" else _at_destination(facts), found, facts.unit)
    steps.append(Step("RWL", limit, (Reason(f"rwl_{ends or 'one'}", system.mass),)))
    if facts.L is not None:
        steps.append(Step("LI", index, (Reason("load_of_limit", facts.L),)))
    level = _level(index) if facts.L is not None else 2 * (limit <= 0)
    outputs: dict[str, Any] = {"LC": lc, **found._asdict(), "RWL": limit, "LI": index}
    if ends:
        outputs["end"] = ends
    return Outcome(METHOD, index, level, outputs, tuple(steps))


def _at_destination(facts: NioshFacts) -> Lift:
    values = {name: getattr(facts, name) for name in Lift.model_fields}
    return Lift(
        **values | {"H": facts.H_destination, "V": facts.V_destination, "A": facts.A_destination}
    )


def _steps(lift: Lift, found: Multipliers, unit: Unit) -> list[Step]:
    given: dict[str, float | str] = {
        "HM": lift.H, "VM": lift.V, "DM": lift.D, "AM": lift.A, "FM": lift.F, "CM": lift.coupling,
    }  # fmt: skip
    return [
        Step(
            name,
            value,
            (Reason(_in_unit(name, unit), given[name], neutral=value >= 1),),
            weight=1 - value,
        )
        for name, value in found._asdict().items()
    ]


def _in_unit(name: str, unit: Unit) -> str:
    return f"{name}_in" if unit == "in" and name in ("HM", "VM", "DM") else name


def _level(index: float | None) -> int:
    """0 for an index up to 1, 1 up to 3, 2 above and where no weight is recommended."""
    return len(LIMITS) if index is None else banded(index, LIMITS)


def composite(facts: JobFacts) -> Outcome:
    """The composite lifting index of a job of several kinds of lift (section 2.4):

        CLI = STLI_1 + sum over i > 1 of FILI_i (1/FM(F_1+..+F_i) - 1/FM(F_1+..+F_(i-1)))

    in the order of falling STLI, at equal ones the more frequent first. Which height chooses the
    column of table 5 for a sum of frequencies the manual does not say: that of the added lift.
    """
    unit, lc = facts.unit, SYSTEMS[facts.unit].lc
    rows: list[dict[str, Any]] = []
    for number, task in enumerate(facts.tasks, 1):
        found = multipliers(task, unit, task.V_origin)
        free = _product(lc, found._replace(FM=1.0))
        single = free * found.FM
        rows.append(
            {
                "task": number,
                "FIRWL": free,
                "STRWL": single,
                "FILI": _over(task.L_max or task.L, free),
                "STLI": _over(task.L, single),
                "F": task.F,
                "duration": task.duration,
                "V": task.V if task.V_origin is None else task.V_origin,
            }
        )
    index, order = _cli(rows, unit)
    for place, row in enumerate(order, 1):
        row["place"] = place
    steps = [
        Step(
            "STLI",
            row["STLI"],
            (Reason("lift_of_job", float(row["task"])),),
            weight=row["STLI"] if row["STLI"] is not None else 99.0,
        )
        for row in order
    ]
    steps.append(Step("CLI", index, (Reason("composite", float(len(rows))),)))
    outputs = {"CLI": index, "tasks": sorted(rows, key=lambda row: row["task"])}
    return Outcome(METHOD, index, _level(index), outputs, tuple(steps))


def _over(load: float, limit: float) -> float | None:
    return load / limit if limit > 0 else None


def _cli(rows: Sequence[dict[str, Any]], unit: Unit) -> tuple[float | None, list[dict[str, Any]]]:
    """The index of rows with FILI, STLI, F, duration and V, and the rows in the order in which they
    count; None when one lift, or all of them so often, is beyond what the equation allows.
    """
    order = sorted(rows, key=lambda row: (row["STLI"] is not None, -(row["STLI"] or 0), -row["F"]))
    if any(row["STLI"] is None for row in order):
        return None, order
    index, so_often = order[0]["STLI"], order[0]["F"]
    for row in order[1:]:
        before = frequency_multiplier(so_often, row["duration"], row["V"], unit)
        so_often += row["F"]
        after = frequency_multiplier(so_often, row["duration"], row["V"], unit)
        if after <= 0 or before <= 0:
            return None, order
        index += row["FILI"] * (1 / after - 1 / before)
    return float(index), order


def cli_from_indices(facts: IndicesFacts) -> dict[str, Any]:
    """The composite lifting index of printed FILI, STLI and frequencies (section 2.4.5)."""
    rows = [{**task.model_dump(), "duration": facts.duration, "V": facts.V} for task in facts.tasks]
    return {"CLI": _cli(rows, facts.unit)[0]}


class RateFacts(Facts):
    """Lifting that is not continuous over the 15 minutes of a sample."""

    lift_rate: float = fact("lifts per minute while lifting", "1/min", above=0, high=15)
    work_min: float = fact("minutes of lifting in 15", "min", above=0, high=15)


def special_frequency(facts: RateFacts) -> dict[str, Any]:
    """The frequency of lifting that pauses: rate by minutes over 15 (section 1.3.5.5)."""
    return {"F": facts.lift_rate * facts.work_min / 15}


class SessionsFacts(Facts):
    """Stretches of lifting, each with the recovery behind it, minutes; none when the day ends."""

    sessions: Annotated[
        tuple[Annotated[tuple[Minutes, Minutes | None], Field(strict=False)], ...],
        Field(min_length=1, strict=False),
    ]

    @model_validator(mode="after")
    def _within_a_day(self) -> Self:
        if (longest := _longest(self.sessions)) > MOST_MINUTES:
            raise ValueError(
                f"sessions come to {longest:g} min of lifting without the recovery they need, but"
                f" the equation is for at most {MOST_MINUTES} min (8 h) a day. Shorten them."
            )
        return self


def _longest(sessions: Sequence[tuple[float, float | None]]) -> float:
    longest = going = 0.0
    for work, recovery in sessions:
        going += work
        longest = max(longest, going)
        needed = going if going <= 60 else 0.3 * going if going <= 120 else float("inf")
        if recovery is not None and recovery >= needed:
            going = 0.0
    return longest


def duration_category(facts: SessionsFacts) -> dict[str, Any]:
    """The duration category of a day of lifting, and its longest stretch in minutes (1.3.5.3).

    A short stretch (up to 60 min) needs a recovery as long as itself, a moderate one (up to 120) of
    0.3 of it. Without that, it goes on with the next one, as if there had been no break; so does a
    stretch of more than 2 h, whatever its breaks.
    """
    longest = _longest(facts.sessions)
    kind = "short" if longest <= 60 else "moderate" if longest <= 120 else "long"
    return {"category": kind, "minutes": longest}


FUNCTIONS = {
    "niosh_rwl": Published(rwl, NioshFacts),
    "niosh_rwl_m": Published(rwl_as_printed, NioshFacts),
    "niosh_cli": Published(composite, JobFacts),
    "niosh_cli_from_indices": Published(cli_from_indices, IndicesFacts),
    "niosh_special_frequency": Published(special_frequency, RateFacts),
    "niosh_duration": Published(duration_category, SessionsFacts),
}
"""The published steps that can be asked for alone."""
