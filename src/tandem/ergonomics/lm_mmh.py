"""The Liberty Mutual equations of manual materials handling: the load or force that a share of men
or women accepts for lifting, lowering, pushing, pulling and carrying.

    MAL50 = RL times a factor for each dimension,   MALp = MAL50 (1 - z_p CV)

Source: Potvin JR, Ciriello VM, Snook SH, Maynard WS, Brogmus GE (2021) The Liberty Mutual manual
materials handling (LM-MMH) equations. Ergonomics 64(8):955-970, doi:10.1080/00140139.2021.1891297;
read in the code of ErgoCalculator, whose printed outputs are the worked examples. The paper's
ranges were not seen: what would give an acceptable load of 0 or less is refused. The ratio of load
to limit rises with load, and with frequency from a few an hour on.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import log
from statistics import NormalDist
from typing import Any, Literal, NamedTuple, Self

from pydantic import model_validator

from tandem.ergonomics.facts import Facts, fact
from tandem.ergonomics.outcome import Outcome, Published, Reason, Step

METHOD = "lm_mmh"
Z75, Z90 = (NormalDist().inv_cdf(share) for share in (0.75, 0.90))


class Equation(NamedTuple):
    """Reference load, coefficient of variation, and a factor for each dimension."""

    reference: float
    variation: float
    factors: Mapping[str, Callable[[float], float]]


EQUATIONS: dict[str, Equation] = {
    "lift_male": Equation(
        82.6,
        0.276,
        {
            "H": lambda H: 1.3532 - H / 0.7079,
            "VRM": lambda VRM: 0.7746 + VRM / 1.912 - VRM**2 / 3.296,
            "DV": lambda DV: 0.8695 - log(DV) / 10.62,
            "F": lambda F: 0.6259 - log(F) / 9.092 - log(F) ** 2 / 125.0,
        },
    ),
    "lift_female": Equation(
        34.9,
        0.26,
        {
            "H": lambda H: 1.2602 - H / 0.7686,
            "VRM": lambda VRM: 0.9877 + VRM / 13.69 - VRM**2 / 9.221,
            "DV": lambda DV: 0.8199 - log(DV) / 7.696,
            "F": lambda F: 0.6767 - log(F) / 12.59 - log(F) ** 2 / 228.2,
        },
    ),
    "lower_male": Equation(
        95.9,
        0.304,
        {
            "H": lambda H: 1.3532 - H / 0.7079,
            "VRM": lambda VRM: 0.7746 + VRM / 1.912 - VRM**2 / 3.296,
            "DV": lambda DV: 0.8695 - log(DV) / 10.62,
            "F": lambda F: 0.5773 - log(F) / 10.80 - log(F) ** 2 / 255.9,
        },
    ),
    "lower_female": Equation(
        37.0,
        0.307,
        {
            "H": lambda H: 1.2602 - H / 0.7686,
            "VRM": lambda VRM: 0.9877 + VRM / 13.69 - VRM**2 / 9.221,
            "DV": lambda DV: 0.8199 - log(DV) / 7.696,
            "F": lambda F: 0.6767 - log(F) / 12.59 - log(F) ** 2 / 228.2,
        },
    ),
    "push_initial_male": Equation(
        70.3,
        0.231,
        {
            "V": lambda V: 1.2737 - V / 1.335 + V**2 / 2.576,
            "DH": lambda DH: 1.0790 - log(DH) / 9.392,
            "F": lambda F: 0.6281 - log(F) / 13.07 - log(F) ** 2 / 379.5,
        },
    ),
    "push_sustained_male": Equation(
        65.3,
        0.267,
        {
            "V": lambda V: 2.2940 - V / 0.3345 + V**2 / 0.6887,
            "DH": lambda DH: 1.1035 - log(DH) / 7.170,
            "F": lambda F: 0.4896 - log(F) / 10.20 - log(F) ** 2 / 403.9,
        },
    ),
    "pull_initial_male": Equation(
        69.8,
        0.238,
        {
            "V": lambda V: 1.7186 - V / 0.6888 + V**2 / 2.025,
            "DH": lambda DH: 1.0790 - log(DH) / 9.392,
            "F": lambda F: 0.6281 - log(F) / 13.07 - log(F) ** 2 / 379.5,
        },
    ),
    "pull_sustained_male": Equation(
        61.0,
        0.257,
        {
            "V": lambda V: 2.1977 - V / 0.3850 + V**2 / 0.9047,
            "DH": lambda DH: 1.1035 - log(DH) / 7.170,
            "F": lambda F: 0.4896 - log(F) / 10.20 - log(F) ** 2 / 403.9,
        },
    ),
    "push_initial_female": Equation(
        36.9,
        0.214,
        {
            "V": lambda V: -0.5304 + V / 0.3361 - V**2 / 0.6915,
            "DH": lambda DH: 1.0286 - DH / 72.22 + DH**2 / 9782,
            "F": lambda F: 0.7251 - log(F) / 13.19 - log(F) ** 2 / 197.3,
        },
    ),
    "pull_initial_female": Equation(
        36.9,
        0.234,
        {
            "V": lambda V: -0.5304 + V / 0.3361 - V**2 / 0.6915,
            "DH": lambda DH: 1.0286 - DH / 72.22 + DH**2 / 9782,
            "F": lambda F: 0.7251 - log(F) / 13.19 - log(F) ** 2 / 197.3,
        },
    ),
    "push_sustained_female": Equation(
        25.5,
        0.286,
        {
            "V": lambda V: -0.6539 + V / 0.2941 - V**2 / 0.5722,
            "DH": lambda DH: 1.0391 - DH / 52.91 + DH**2 / 7975,
            "F": lambda F: 0.6086 - log(F) / 11.95 - log(F) ** 2 / 304.4,
        },
    ),
    "pull_sustained_female": Equation(
        25.5,
        0.298,
        {
            "V": lambda V: -0.6539 + V / 0.2941 - V**2 / 0.5722,
            "DH": lambda DH: 1.0391 - DH / 52.91 + DH**2 / 7975,
            "F": lambda F: 0.6086 - log(F) / 11.95 - log(F) ** 2 / 304.4,
        },
    ),
    "carry_male": Equation(
        74.9,
        0.278,
        {
            "V": lambda V: 1.5505 - V / 1.417,
            "DH": lambda DH: 1.1172 - log(DH) / 6.332,
            "F": lambda F: 0.5149 - log(F) / 7.958 - log(F) ** 2 / 131.1,
        },
    ),
    "carry_female": Equation(
        28.6,
        0.231,
        {
            "V": lambda V: 1.1645 - V / 4.437,
            "DH": lambda DH: 1.0101 - DH / 207.8,
            "F": lambda F: 0.6224 - log(F) / 16.33,
        },
    ),
}
"""Task, phase and sex -> equation; lengths in m, frequencies per minute."""


class LmFacts(Facts):
    """One kind of handling. Lengths in m, loads in kg, forces in kgf."""

    task: Literal["lift", "lower", "push", "pull", "carry"] = fact("what is done")
    sex: Literal["male", "female"] = fact("whose limit", cautious="female")
    phase: Literal["initial", "sustained"] | None = fact(
        "of a push or pull: initial or sustained", default=None
    )
    H: float | None = fact("horizontal reach", "m", above=0, high=1, default=None)
    VRM: float | None = fact("middle height of the range", "m", 0, 2.5, default=None)
    DV: float | None = fact("vertical travel", "m", above=0, high=2.5, default=None)
    V: float | None = fact("height of the hands", "m", 0, 2.5, default=None)
    DH: float | None = fact("horizontal travel", "m", above=0, high=100, default=None)
    F: float = fact("actions per minute", "1/min", above=0, high=30, cautious=6.0)
    load_kg: float | None = fact("load or force", "kg", 0, 300, default=None, asked=True)

    @property
    def name(self) -> str:
        """Of the equation."""
        return "_".join(part for part in (self.task, self.phase, self.sex) if part)

    @model_validator(mode="after")
    def _sound(self) -> Self:
        moves = self.task in ("push", "pull")
        if moves != (self.phase is not None):
            raise ValueError(
                f"phase is {'missing' if moves else 'stated'}: a push or pull needs initial or"
                " sustained, other tasks have none."
            )
        takes = EQUATIONS[self.name].factors
        missing = [key for key in takes if getattr(self, key) is None]
        if missing:
            raise ValueError(
                f"{', '.join(missing)} missing, which {self.name} needs. State all of"
                f" {', '.join(takes)}."
            )
        low = [key for key, factor in takes.items() if factor(getattr(self, key)) <= 0]
        if low:
            shown = ", ".join(f"{key} {getattr(self, key):g}" for key in low)
            raise ValueError(
                f"{shown} is beyond {self.name}: no load would be acceptable. Correct it, or"
                " change the task."
            )
        return self


def limits(facts: LmFacts) -> Outcome:
    """The loads that 50, 75 and 90 % accept, kg or kgf; with a load, its ratio to that of 75 %."""
    equation = EQUATIONS[facts.name]
    half, steps = equation.reference, [Step("RL", equation.reference, (Reason("reference"),))]
    for key, factor in equation.factors.items():
        value = factor(getattr(facts, key))
        half *= value
        why = (Reason(f"lm_{key}", getattr(facts, key)),)
        steps.append(Step(f"lm_{key}", value, why, weight=max(1 - value, 0.0)))
    outputs: dict[str, Any] = {
        "MAL50": half,
        "MAL75": half * (1 - Z75 * equation.variation),
        "MAL90": half * (1 - Z90 * equation.variation),
    }
    steps += [Step(name, value, (Reason("accepted"),)) for name, value in outputs.items()]
    if facts.load_kg is None:
        return Outcome(METHOD, None, 0, outputs, tuple(steps))
    ratio = facts.load_kg / outputs["MAL75"]
    steps.append(Step("lm_ratio", ratio, (Reason("load_of_limit", facts.load_kg),)))
    return Outcome(METHOD, ratio, int(ratio > 1), {**outputs, "ratio": ratio}, tuple(steps))


FUNCTIONS: dict[str, Published] = {"lm_mmh": Published(limits, LmFacts)}
"""The published steps that can be asked for alone."""
