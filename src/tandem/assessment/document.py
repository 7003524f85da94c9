"""The assessment as data, every step in it: what `tandem score --json` prints."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from tandem.assessment import sentences as say
from tandem.assessment.shift import Shift
from tandem.cell.assessed import Assessed
from tandem.cell.language import Words
from tandem.ergonomics.methods import METHODS
from tandem.ergonomics.outcome import Outcome, Step
from tandem.ergonomics.tasks import Scored, Total


def of_step(t: Words, step: Step) -> dict[str, Any]:
    """One line of the calculation as data, with its sentence."""
    return {
        "step": step.part,
        "value": step.value,
        "reasons": [
            {
                "reason": why.key,
                "amount": why.amount,
                "band": None if why.band is None else list(why.band),
                "points": why.points,
                "added": why.added,
            }
            for why in step.reasons
        ],
        "text": say.step(t, step),
    }


def of_outcome(t: Words, outcome: Outcome) -> dict[str, Any]:
    """An outcome: its outputs by their published names, and `steps`."""
    return {
        **outcome.outputs,
        "explanation": say.explanation(t, outcome),
        "steps": [of_step(t, step) for step in outcome.steps],
    }


def _of_task(t: Words, row: Scored) -> dict[str, Any]:
    given, outcome = row.given, row.outcome
    return {
        "task": given.task,
        "side": given.side,
        "method": given.method,
        "score": outcome.score,
        "level": outcome.level,
        "action": say.level(t, given.method, outcome.level),
        "explanation": say.explanation(t, outcome),
        "minutes": given.minutes,
        "facts": {
            name: {
                "value": getattr(given.facts, name),
                "unit": say.unit_of(row, name),
                "source": origin.source,
                "assessor": origin.assessor,
                "date": origin.date,
            }
            for name, origin in given.origins.items()
            if getattr(given.facts, name) is not None
        },
        "stable": row.stable,
        "moves": [
            {
                "fact": move.fact,
                "value": move.value,
                "change": move.change,
                "relative": move.is_share,
                "score": move.score,
                "level": move.level,
            }
            for move in row.moves
        ],
        "stability": say.stability(t, row),
        "unstated": dict(row.unstated),
        "at_worst": None
        if row.at_worst is None
        else {"score": row.at_worst.score, "level": row.at_worst.level},
        "outputs": dict(outcome.outputs),
        "steps": [of_step(t, step) for step in outcome.steps],
    }


def _of_total(t: Words, one: Total) -> dict[str, Any]:
    return {
        "method": one.method,
        "side": one.side,
        "kind": one.kind,
        "region": METHODS[one.method].region,
        "value": one.value,
        "level": one.level,
        "outputs": dict(one.outputs),
        "tasks": list(one.tasks),
        "text": say.total(t, one),
    }


def of_outside(one: Assessed) -> dict[str, Any]:
    """A number that was stated and not computed."""
    return {
        "task": one.task,
        "operators": list(one.operators),
        "side": one.side,
        "method": one.method,
        "score": one.value,
        "source": one.origin.source,
        "assessor": one.origin.assessor,
        "date": one.origin.date,
    }


def of_shift(t: Words, shift: Shift) -> dict[str, Any]:
    """What a plan puts on each person."""
    return {
        "cycles": shift.cycles,
        "hours": shift.hours,
        "seconds_each": shift.each_s,
        "people": [
            {
                "person": one.who,
                "tasks": list(one.tasks),
                "unassessed": list(one.unassessed),
                "minutes": one.minutes,
                "totals": [_of_total(t, total) for total in one.totals],
                "peaks": [
                    {"method": peak.method, "peak": peak.value, "task": peak.task}
                    for peak in one.peaks
                ],
            }
            for one in shift.people
        ],
    }


def document(
    t: Words, name: str, rows: Sequence[Scored], totals: Iterable[Total], made: Mapping[str, str]
) -> dict[str, Any]:
    """The whole assessment as one document."""
    return {
        "schema_version": 1,
        "name": name,
        **made,
        "tasks": [_of_task(t, row) for row in rows],
        "totals": [_of_total(t, one) for one in totals],
        "advice": t("advice"),
    }
