"""Metabolic energy of manual work, Garg's equations: postures by the minute, movements each.

Source: Garg A, Chaffin DB, Herrin GD (1978) Prediction of metabolic rates for manual materials
handling jobs. American Industrial Hygiene Association Journal 39(8):661-674; 31 equations, kcal.
All worked examples that we have of it are regression values, none is printed in the paper. Energy
is added; a mean rate is compared with a limit.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Literal, NamedTuple, Self, get_args

from pydantic import Field, model_validator

from tandem.ergonomics.facts import Facts, fact
from tandem.ergonomics.outcome import Outcome, Published, Reason, Step, banded

METHOD = "garg_energy"
RATE, MOVEMENT, TIME = "kcal/min", "kcal per movement", "kcal"
KNEE = 0.81
"""Height in m up to which one bends for a lift, and above which the arms lift."""
LOW, HIGH = "low", "high"
CLASSES = (3.3, 5.8, 8.3)
"""Mean kcal/min up to which work is light, medium and heavy."""

Name = Literal[
    "sit", "stand", "stand_bent", "squat_lift", "stoop_lift", "one_hand_lift", "arm_lift",
    "squat_lower", "stoop_lower", "arm_lower", "walk", "carry_sides", "carry_front",
    "hold_sides_or_thighs", "hold_waist", "hold_one_hand", "push_pull_bench_0p8", "push_pull_1p5",
    "lateral_180_stand_2h", "lateral_180_stand_1h", "lateral_90_stand", "lateral_90_sit_1h",
    "lateral_90_sit_2h", "forward_sit", "forward_stand", "hand_light", "hand_heavy",
    "one_arm_light", "one_arm_heavy", "both_arms_light", "both_arms_heavy",
]  # fmt: skip


class Variables(Facts):
    """What the equations speak of; each takes some."""

    BW: float | None = fact("body weight", "kg", 30, 200, default=None, cautious=90.0)
    L: float | None = fact("load", "kg", 0, 100, default=None)
    F: float | None = fact("mean force of push or pull", "kgf", 0, 100, default=None)
    S: int | None = fact("1 male, 0 female", "", 0, 1, default=None)
    h1: float | None = fact("lower height of the hands", "m", 0, 2.5, default=None)
    h2: float | None = fact("upper height of the hands", "m", 0, 2.5, default=None)
    V: float | None = fact("speed of walking", "m/s", 0, 3, default=None)
    G: float | None = fact("grade", "%", 0, 30, default=None)
    DH: float | None = fact("horizontal travel", "m", 0, 10, default=None)
    t: float | None = fact("time", "min", 0, 1440, default=None)


class Equation(NamedTuple):
    """One equation: the variables that it takes, the unit of its result, and where it holds."""

    takes: str
    unit: str
    energy: Callable[[Any], float]
    heights: str = ""


EQUATIONS: dict[str, Equation] = {
    "sit": Equation("BW", RATE, lambda v: 0.023 * v.BW),
    "stand": Equation("BW", RATE, lambda v: 0.024 * v.BW),
    "stand_bent": Equation("BW", RATE, lambda v: 0.028 * v.BW),
    "squat_lift": Equation(
        "BW L h1 h2 S",
        MOVEMENT,
        lambda v: 0.01 * (0.514 * v.BW * (0.81 - v.h1) + (2.19 + 0.62 * v.S) * v.L * (v.h2 - v.h1)),
        LOW,
    ),
    "stoop_lift": Equation(
        "BW L h1 h2 S",
        MOVEMENT,
        lambda v: 0.01 * (0.325 * v.BW * (0.81 - v.h1) + (1.41 + 0.76 * v.S) * v.L * (v.h2 - v.h1)),
        LOW,
    ),
    "one_hand_lift": Equation(
        "BW L h1 h2",
        MOVEMENT,
        lambda v: 0.01 * (0.352 * v.BW * (0.81 - v.h1) + 3.03 * v.L * (v.h2 - v.h1)),
        LOW,
    ),
    "arm_lift": Equation(
        "BW L h1 h2 S",
        MOVEMENT,
        lambda v: 0.01 * (0.062 * v.BW * (v.h2 - 0.81) + (3.19 - 0.52 * v.S) * v.L * (v.h2 - v.h1)),
        HIGH,
    ),
    "squat_lower": Equation(
        "BW L h1 h2",
        MOVEMENT,
        lambda v: 0.01 * (0.511 * v.BW * (0.81 - v.h1) + 0.701 * v.L * (v.h2 - v.h1)),
        LOW,
    ),
    "stoop_lower": Equation(
        "BW L h1 h2 S",
        MOVEMENT,
        lambda v: (
            0.01
            * (
                0.268 * v.BW * (0.81 - v.h1)
                + 0.675 * v.L * (v.h2 - v.h1)
                + 5.22 * v.S * (0.81 - v.h1)
            )
        ),
        LOW,
    ),
    "arm_lower": Equation(
        "BW L h1 h2 S",
        MOVEMENT,
        lambda v: 0.01 * (0.093 * v.BW * (v.h2 - 0.81) + (1.02 + 0.37 * v.S) * v.L * (v.h2 - v.h1)),
        HIGH,
    ),
    "walk": Equation(
        "BW V G t",
        TIME,
        lambda v: 0.01 * (51 + 2.54 * v.BW * v.V**2 + 0.379 * v.BW * v.G * v.V) * v.t,
    ),
    "carry_sides": Equation(
        "BW L V G t",
        TIME,
        lambda v: (
            0.01
            * (
                80
                + 2.43 * v.BW * v.V**2
                + 4.63 * v.L * v.V**2
                + 4.62 * v.L
                + 0.379 * (v.L + v.BW) * v.G * v.V
            )
            * v.t
        ),
    ),
    "carry_front": Equation(
        "BW L V G t",
        TIME,
        lambda v: (
            0.01
            * (
                68
                + 2.54 * v.BW * v.V**2
                + 4.08 * v.L * v.V**2
                + 11.4 * v.L
                + 0.379 * (v.L + v.BW) * v.G * v.V
            )
            * v.t
        ),
    ),
    "hold_sides_or_thighs": Equation("L t", TIME, lambda v: 0.037 * v.L * v.t),
    "hold_waist": Equation("L t", TIME, lambda v: 0.062 * v.L * v.t),
    "hold_one_hand": Equation("L t", TIME, lambda v: 0.088 * v.L * v.t),
    "push_pull_bench_0p8": Equation(
        "BW F S DH",
        MOVEMENT,
        lambda v: 0.01 * v.DH * (0.112 * v.BW + 1.15 * v.F + 0.505 * v.S * v.F),
    ),
    "push_pull_1p5": Equation("F DH", MOVEMENT, lambda v: v.DH * (0.086 + 0.036 * v.F)),
    "lateral_180_stand_2h": Equation(
        "BW L", MOVEMENT, lambda v: 0.01 * (0.11 * v.BW + 0.726 * v.L)
    ),
    "lateral_180_stand_1h": Equation(
        "BW L", MOVEMENT, lambda v: 0.01 * (0.097 * v.BW + 0.946 * v.L)
    ),
    "lateral_90_stand": Equation(
        "L S", MOVEMENT, lambda v: 0.01 * (3.31 + 0.629 * v.L + 0.143 * v.S * v.L)
    ),
    "lateral_90_sit_1h": Equation(
        "L S", MOVEMENT, lambda v: 0.01 * (3.5 + 0.682 * v.L + 0.321 * v.S * v.L)
    ),
    "lateral_90_sit_2h": Equation(
        "L S", MOVEMENT, lambda v: 0.01 * (2.54 + 1.1 * v.L + 0.248 * v.S * v.L)
    ),
    "forward_sit": Equation("L DH", MOVEMENT, lambda v: 0.01 * v.DH * (6.3 + 2.71 * v.L)),
    "forward_stand": Equation("L DH", MOVEMENT, lambda v: 0.01 * v.DH * (3.57 + 1.23 * v.L)),
    "hand_light": Equation("t", TIME, lambda v: 0.2 * v.t),
    "hand_heavy": Equation("t", TIME, lambda v: 0.6 * v.t),
    "one_arm_light": Equation("t", TIME, lambda v: 0.7 * v.t),
    "one_arm_heavy": Equation("t", TIME, lambda v: 1.5 * v.t),
    "both_arms_light": Equation("t", TIME, lambda v: 1.2 * v.t),
    "both_arms_heavy": Equation("t", TIME, lambda v: 2.2 * v.t),
}
"""Table 1 of the paper, by our names."""


def _faults(name: str, variables: Variables) -> list[str]:
    equation = EQUATIONS[name]
    missing = [key for key in equation.takes.split() if getattr(variables, key) is None]
    if missing:
        return [
            f"{', '.join(missing)} {'is' if len(missing) == 1 else 'are'} missing, which the"
            f" equation {name} needs. State {'it' if len(missing) == 1 else 'them'}."
        ]
    low, high = variables.h1 or 0.0, variables.h2 or 0.0
    if equation.heights and low >= high:
        return [f"h1 is {low:g} m and h2 {high:g} m, but h1 is the lower height. Swap them."]
    if equation.heights == LOW and high > KNEE:
        return [
            f"h2 is {high:g} m, but {name} holds up to {KNEE:g} m. Add an arm lift for the rest."
        ]
    if equation.heights == HIGH and low < KNEE:
        return [
            f"h1 is {low:g} m, but {name} holds from {KNEE:g} m on. Add a lift with the legs or the"
            " back for the rest."
        ]
    return []


def _unused(name: str, variables: Variables) -> list[str]:
    takes = EQUATIONS[name].takes.split()
    return [
        f"{key} is stated, but {name} takes {', '.join(takes)}. Leave it out."
        for key in Variables.model_fields
        if getattr(variables, key) is not None and key not in takes
    ]


class EquationFacts(Variables):
    """One equation and its variables."""

    equation: Name = fact("which of the 31 equations")

    @model_validator(mode="after")
    def _sound(self) -> Self:
        if faults := _faults(self.equation, self) + _unused(self.equation, self):
            raise ValueError(" ".join(faults))
        return self


class GargFacts(EquationFacts):
    """One movement, and how often a shift it is done."""

    reps: float = fact("movements per work day", "1/day", 0, 200_000, cautious=2000.0)


class Movement(Facts):
    """A movement of a job; body weight is that of the job."""

    equation: Name
    reps: float = fact("how often", "", 0, 200_000)
    vars: Variables = Variables()


class JobFacts(Facts):
    """Postures in minutes, movements by their number, over a stretch of work."""

    postures: dict[Literal["sit", "stand", "stand_bent"], float]
    tasks: tuple[Movement, ...] = Field((), strict=False)
    T_min: float = fact("stretch of work", "min", above=0, high=1440)
    BW: float = fact("body weight", "kg", 30, 200)

    @model_validator(mode="after")
    def _sound(self) -> Self:
        stood = sum(self.postures.values())
        faults = [
            f"tasks {number}: {fault}"
            for number, task in enumerate(self.tasks, 1)
            for fault in _faults(task.equation, _with_weight(task, self.BW))
        ]
        if abs(stood - self.T_min) > 1e-6:
            faults.append(
                f"the postures take {stood:g} min together, but T_min is {self.T_min:g}. Make them"
                " equal."
            )
        if any(minutes < 0 for minutes in self.postures.values()):
            faults.append("a posture takes less than 0 min. Correct it.")
        if faults:
            raise ValueError(" ".join(faults))
        return self


def _with_weight(task: Movement, weight: float) -> Variables:
    if "BW" in EQUATIONS[task.equation].takes.split() and task.vars.BW is None:
        return task.vars.model_copy(update={"BW": weight})
    return task.vars


def energy(facts: EquationFacts) -> dict[str, Any]:
    """The result of one equation in its unit: kcal per movement, kcal, or kcal/min."""
    return {"E": EQUATIONS[facts.equation].energy(facts), "unit": EQUATIONS[facts.equation].unit}


def job(facts: JobFacts) -> Outcome:
    """Energy of a stretch of work, kcal, and its mean rate, kcal/min."""
    steps = []
    for posture, minutes in facts.postures.items():
        rate = EQUATIONS[posture].energy(Variables(BW=facts.BW))
        steps.append(
            Step("kcal", rate * minutes, (Reason(f"garg_{posture}", minutes),), weight=0.0)
        )
    for task in facts.tasks:
        each = EQUATIONS[task.equation].energy(_with_weight(task, facts.BW))
        steps.append(
            Step(
                "kcal",
                each * task.reps,
                (Reason("garg_movement", f"{task.reps:g} × {task.equation}"),),
                weight=each * task.reps,
            )
        )
    total = math.fsum(float(step.value or 0) for step in steps)
    rate = total / facts.T_min
    steps.append(Step("kcal_per_min", rate, (Reason("mean_over", facts.T_min),)))
    outputs = {"kcal": total, "kcal_per_min": rate}
    return Outcome(METHOD, rate, banded(rate, CLASSES), outputs, tuple(steps))


def assess(facts: GargFacts) -> Outcome:
    """Energy of one movement so many times a shift, kcal, without that of the posture."""
    each = EQUATIONS[facts.equation].energy(facts)
    total = each * facts.reps
    steps = (
        Step("kcal_each", each, (Reason("garg_equation", facts.equation),), weight=each),
        Step("kcal", total, (Reason("reps", facts.reps),), weight=total),
    )
    return Outcome(METHOD, total, 0, {"kcal_each": each, "kcal": total}, steps)


assert set(EQUATIONS) == set(get_args(Name))

FUNCTIONS: dict[str, Published] = {
    "garg": Published(energy, EquationFacts),
    "garg_job": Published(job, JobFacts),
    "garg_task": Published(assess, GargFacts),
}
"""The published steps that can be asked for alone."""
