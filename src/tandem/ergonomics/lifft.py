"""LiFFT, the lifting fatigue failure tool: load moments on the low back to a daily dose.

Source: Gallagher S, Sesek RF, Schall MC, Huangfu R (2017) Development and validation of an
easy-to-use risk assessment tool for cumulative low back loading. Applied Ergonomics 63:142-150,
doi:10.1016/j.apergo.2017.04.016; equations as in the authors' workbook LiFFT 1.4.0 (2018).

    damage = 10^(-5.81636221052493 + 0.0222878437409416 M) reps,  M = lever [in] / 12 load [lb]

Doses of tasks are added. No term for asymmetry, grip or recovery; beyond a moment of about 100 Nm
the authors ask for caution. The dose never falls when lever, load or repetitions rise.
"""

from __future__ import annotations

from tandem.ergonomics.facts import Facts, Several, fact
from tandem.ergonomics.fatigue_failure import outcome
from tandem.ergonomics.outcome import Outcome, Published, Reason, Step

METHOD = "lifft"
CHANCE = (1.7229, 1.0239)
CM_PER_INCH, KG_PER_POUND = 2.54, 0.45359237
NM_PER_FTLB = 1.3558179483314004
CAUTION_NM = 100.0


class LifftFacts(Facts):
    """Lifts of one kind."""

    lever_cm: float = fact(
        "greatest horizontal distance of the load from L5/S1", "cm", 0, 150, cautious=80.0
    )
    load_kg: float = fact("load", "kg", 0, 200, cautious=25.0)
    reps: float = fact("lifts per work day", "1/day", 0, 100_000, cautious=1000.0)


class UsTask(Facts):
    """Lifts of one kind, in inches and pounds."""

    lever_in: float = fact("greatest horizontal distance from L5/S1", "in", 0, 60)
    load_lb: float = fact("load", "lb", 0, 450)
    reps: float = fact("lifts per work day", "1/day", 0, 100_000)


class MetricJob(Facts):
    """The lifts of a day."""

    tasks: Several[LifftFacts]


class UsJob(Facts):
    """The lifts of a day, in inches and pounds."""

    tasks: Several[UsTask]


def moment_ftlb(lever_in: float, load_lb: float) -> float:
    """The load moment in foot-pounds."""
    return lever_in / 12 * load_lb


def damage(moment: float, reps: float) -> float:
    """The damage of so many lifts of a moment in foot-pounds."""
    return float(10 ** (-5.81636221052493 + 0.0222878437409416 * moment) * reps)


def level(dose: float, risk: float) -> int:
    """Low below a chance of 25 %, moderate up to 50 %, high above."""
    return (risk >= 0.25) + (risk > 0.5)


def dose_us(facts: UsJob) -> Outcome:
    """The dose of a day, and the chance that the job is one of high risk (12 injuries and more in
    200,000 hours).
    """
    steps: list[Step] = []
    damages = []
    for task in facts.tasks:
        moment = moment_ftlb(task.lever_in, task.load_lb)
        newton_metres = moment * NM_PER_FTLB
        damages.append(damage(moment, task.reps))
        over = newton_metres > CAUTION_NM
        why = (Reason("moment_caution" if over else "moment", newton_metres),)
        steps.append(Step("moment_Nm", newton_metres, why, weight=newton_metres))
        steps.append(
            Step("damage", damages[-1], (Reason("reps", task.reps),), weight=task.reps / 50)
        )
    return outcome(METHOD, steps, damages, CHANCE, level)


def dose(facts: MetricJob) -> Outcome:
    """The same of centimetres and kilograms, converted exactly."""
    tasks = tuple(
        UsTask.model_construct(
            lever_in=task.lever_cm / CM_PER_INCH,
            load_lb=task.load_kg / KG_PER_POUND,
            reps=task.reps,
        )
        for task in facts.tasks
    )
    return dose_us(UsJob.model_construct(tasks=tasks))


def assess(facts: LifftFacts) -> Outcome:
    """The dose of lifts of one kind."""
    return dose(MetricJob(tasks=(facts,)))


FUNCTIONS: dict[str, Published] = {
    "lifft": Published(dose_us, UsJob),
    "lifft_si": Published(dose, MetricJob),
    "lifft_task": Published(assess, LifftFacts),
}
"""The published steps that can be asked for alone."""
