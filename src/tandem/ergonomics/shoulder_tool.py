"""The Shoulder Tool: moments on one shoulder to a daily dose.

Source: Bani Hani D, Huangfu R, Sesek R, Schall MC, Davis GA, Gallagher S (2021) Development and
validation of a cumulative exposure shoulder risk assessment tool based on fatigue failure theory.
Ergonomics 64(1):39-54; equations as in the authors' workbook 1.0.0 (2019), which computes in inches
and pounds; metric facts are converted exactly.

Doses of tasks are added. The dose never falls when load or repetitions rise, nor when the lever
does, but for a downward push or pull lighter than the arm (4.8 lb): there the arm helps.
"""

from __future__ import annotations

from typing import Literal

from tandem.ergonomics.facts import Facts, Several, fact
from tandem.ergonomics.fatigue_failure import cycles_to_failure, outcome
from tandem.ergonomics.lifft import CM_PER_INCH, KG_PER_POUND, NM_PER_FTLB
from tandem.ergonomics.outcome import Outcome, Published, Reason, Step

METHOD = "shoulder_tool"
CHANCE = (0.864, 0.928)
STRONGEST = 681.0
"""Ultimate moment, in-lb."""

Kind = Literal["handling", "horizontal_push_pull", "push_pull_down"]


class ShoulderFacts(Facts):
    """Efforts of one kind, of one arm."""

    lever_cm: float = fact("from the shoulder to the hand", "cm", 0, 120, cautious=70.0)
    load_kg: float = fact("load or force of the hand, as kg", "kg", 0, 100, cautious=5.0)
    reps: float = fact("efforts per work day", "1/day", 0, 200_000, cautious=2000.0)
    type: Kind = fact(
        "handling, horizontal_push_pull or push_pull_down", default="handling", cautious="handling"
    )


class UsTask(Facts):
    """Efforts of one kind, in inches and pounds."""

    lever_in: float = fact("from the shoulder to the hand", "in", 0, 48)
    load_lb: float = fact("load of the hand", "lb", 0, 220)
    reps: float = fact("efforts per work day", "1/day", 0, 200_000)
    type: Kind = "handling"


class UsJob(Facts):
    """The efforts of a day."""

    tasks: Several[UsTask]


def arm_moment_ftlb(lever_in: float) -> float:
    """What the arm itself weighs at that lever, foot-pounds."""
    if lever_in < 1.715:
        return 0.0
    return 121.9 / 12 if lever_in >= 27 else (-8.27 + 4.8223 * lever_in) / 12


def moment_ftlb(lever_in: float, load_lb: float, kind: Kind) -> float:
    """The moment on the shoulder in foot-pounds: the load's, with the arm's when handling, against
    it when pushing or pulling down.
    """
    load, arm = lever_in / 12 * load_lb, arm_moment_ftlb(lever_in)
    if kind == "handling":
        return load + arm
    return load if kind == "horizontal_push_pull" else load - arm


def level(dose: float, risk: float) -> int:
    """Generally safe up to a chance of 25 %, unacceptable from 50 % on."""
    return (risk > 0.25) + (risk >= 0.5)


def dose_us(facts: UsJob) -> Outcome:
    """The dose of a day, and the chance of a disorder of the shoulder."""
    steps, damages = [], []
    for task in facts.tasks:
        moment = moment_ftlb(task.lever_in, task.load_lb, task.type)
        percent = 100 * moment * 12 / STRONGEST
        damages.append(task.reps / cycles_to_failure(percent))
        steps += [
            Step(
                "shoulder_Nm",
                moment * NM_PER_FTLB,
                (Reason(f"shoulder_{task.type}", moment * NM_PER_FTLB),),
                weight=percent / 10,
            ),
            Step("percent_ultimate", percent, (Reason("of_ultimate"),)),
            Step("damage", damages[-1], (Reason("reps", task.reps),), weight=task.reps / 1000),
        ]
    return outcome(METHOD, steps, damages, CHANCE, level)


def assess(facts: ShoulderFacts) -> Outcome:
    """The dose of efforts of one kind."""
    task = UsTask.model_construct(
        lever_in=facts.lever_cm / CM_PER_INCH,
        load_lb=facts.load_kg / KG_PER_POUND,
        reps=facts.reps,
        type=facts.type,
    )
    return dose_us(UsJob.model_construct(tasks=(task,)))


FUNCTIONS: dict[str, Published] = {
    "shoulder": Published(dose_us, UsJob),
    "shoulder_task": Published(assess, ShoulderFacts),
}
"""The published steps that can be asked for alone."""
