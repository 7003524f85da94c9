"""DUET, the distal upper extremity tool: rated exertions of hand and forearm to a daily dose.

Source: Gallagher S, Schall MC, Sesek RF, Huangfu R (2018) An upper extremity risk assessment tool
based on material fatigue failure theory: the distal upper extremity tool (DUET). Human Factors
60(8):1146-1162, doi:10.1177/0018720818789319, table 1 and equation 6.

Doses of tasks are added. No term for duty cycle, recovery, posture or speed; validated on 441
people of the automotive industry, in one survey. The dose never falls when a rating or repetitions
rise.
"""

from __future__ import annotations

from tandem.ergonomics.facts import Facts, Several, fact
from tandem.ergonomics.fatigue_failure import outcome
from tandem.ergonomics.outcome import Outcome, Published, Reason, Step

METHOD = "duet"
# table 1: of each OMNI-RES rating 0 to 10
DAMAGE_PER_CYCLE = (
    2.6e-07, 4.5e-07, 1.37e-06, 4.13e-06, 1.262e-05, 3.801e-05, 0.00011625, 0.00035014, 0.00105374,
    0.00322581, 0.00970874,
)  # fmt: skip
CHANCE = (0.573, 0.747)
CUT = 0.03
"""The dose above which a job is called one of high risk; its chance is 36.2 %."""


class DuetFacts(Facts):
    """Exertions of one kind, of one hand."""

    omni_res: int = fact(
        "rating of the exertion, OMNI-RES 0 (very easy) to 10 (extremely hard)", "", 0, 10,
        cautious=8,
    )  # fmt: skip
    reps: float = fact("exertions per work day", "1/day", 0, 200_000, cautious=5000.0)


class Job(Facts):
    """The exertions of a day."""

    tasks: Several[DuetFacts]


class Rated(Facts):
    """Exertions of one kind, by their rate."""

    omni_res: int = fact("rating of the exertion, OMNI-RES", "", 0, 10)
    efforts_per_min: float = fact("efforts per minute", "1/min", 0, 300)


class RatedJob(Facts):
    """Exertions that go on for so many hours."""

    hours: float = fact("hours a day", "h", above=0, high=24)
    tasks: Several[Rated]


def dose(facts: Job) -> Outcome:
    """The dose of a day, the share of each task, and the chance of an injury and pain in the last
    year.
    """
    steps, damages = [], []
    for task in facts.tasks:
        each = DAMAGE_PER_CYCLE[task.omni_res]
        damages.append(each * task.reps)
        steps += [
            Step(
                "damage_per_cycle",
                each,
                (Reason("omni_res", float(task.omni_res), neutral=task.omni_res <= 2),),
                weight=max(task.omni_res - 2, 0),
            ),
            Step("damage", damages[-1], (Reason("reps", task.reps),), weight=task.reps / 1000),
        ]
    return outcome(METHOD, steps, damages, CHANCE, lambda dose, risk: int(dose > CUT))


def dose_of_rates(facts: RatedJob) -> Outcome:
    """The same by rates: efforts per minute for so many hours."""
    return dose(
        Job(
            tasks=tuple(
                DuetFacts(omni_res=task.omni_res, reps=task.efforts_per_min * 60 * facts.hours)
                for task in facts.tasks
            )
        )
    )


def assess(facts: DuetFacts) -> Outcome:
    """The dose of exertions of one kind."""
    return dose(Job(tasks=(facts,)))


FUNCTIONS: dict[str, Published] = {
    "duet": Published(dose, Job),
    "duet_job": Published(dose_of_rates, RatedJob),
    "duet_task": Published(assess, DuetFacts),
}
"""The published steps that can be asked for alone."""
