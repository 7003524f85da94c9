"""An outcome in words: what it is, why, and every step of it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from tandem.assessment.shift import Person, Shift
from tandem.cell.language import Words, spoken
from tandem.ergonomics.facts import about
from tandem.ergonomics.methods import LICENSED, METHODS
from tandem.ergonomics.outcome import Band, Outcome, Reason, Step
from tandem.ergonomics.tasks import Scored, Total

MOST_PARTS = 4
"""Parts that one sentence names; the steps have all of them."""
ADDED = ("load", "coupling", "activity", "muscle", "force")
"""Parts whose points come on top of a score."""


def words(language: str) -> Words:
    """The sentences of this room and of the methods."""
    return spoken(language, "tandem.ergonomics", __package__ or "tandem.assessment")


def number(t: Words, value: float | str | None) -> str:
    """A number to four digits with the language's decimal mark; a word of a method translated."""
    if value is None:
        return "–"
    if isinstance(value, bool):
        return t("yes") if value else t("no")
    if isinstance(value, str):
        return t.sentences.get(f"word.{value}", value)
    if value != 0 and abs(value) < 1e-3:
        return f"{value:.3g}".replace(".", t("decimal"))
    return t.number(float(f"{value:.4g}")) if abs(value) < 1e4 else t.number(round(value))


def band(t: Words, stretch: Band) -> str:
    """A stretch of a scale: 20 to 60, over 60, under 60."""
    low, high = (None if end is None else number(t, end) for end in stretch)
    if low is None:
        return t("band.under", high=high)
    return t("band.over", low=low) if high is None else t("band.between", low=low, high=high)


def reason(t: Words, why: Reason) -> str:
    """A reason alone: flexed 45 degrees."""
    return t(f"reason.{why.key}", amount=number(t, why.amount))


def reasoned(t: Words, why: Reason) -> str:
    """A reason with its stretch and points: flexed 45 degrees (20 to 60: 3)."""
    points = "" if why.points is None else number(t, why.points)
    if why.added and why.points is not None:
        points = t.signed(why.points)
    details = [band(t, why.band)] if why.band else []
    inside = ": ".join([*details, *([points] if points else [])])
    return reason(t, why) + (f" ({inside})" if inside else "")


def step(t: Words, one: Step) -> str:
    """A line of the calculation: trunk 4: flexed 45 degrees (20 to 60: 3), twisted (+1)."""
    return f"{t(f'part.{one.part}')} {number(t, one.value)}: " + ", ".join(
        reasoned(t, why) for why in one.reasons
    )


def level(t: Words, method: str, place: int) -> str:
    """What a level of a method means."""
    return t(f"level.{method}.{place}")


def score(t: Words, method: str, value: float | None) -> str:
    """A score with its unit, where it has one."""
    return t("no_score") if value is None else number(t, value) + t(f"unit.score.{method}")


def explanation(t: Words, outcome: Outcome) -> str:
    """One sentence: the score, what made it so, and what it means."""
    told = sorted((s for s in outcome.steps if s.weight > 0), key=lambda s: -s.weight)
    parts = [_part(t, one) for one in told[:MOST_PARTS]]
    shown = score(t, outcome.method, outcome.score)
    if "probability" in outcome.outputs:
        shown = t("with_chance", score=shown, risk=t.share(outcome.outputs["probability"]))
    values = {
        "method": t(f"method.{outcome.method}"),
        "score": shown,
        "level": level(t, outcome.method, outcome.level),
    }
    if not parts:
        return t("explained.bare", **values)
    return t("explained", parts="; ".join(parts), **values)


def _part(t: Words, one: Step) -> str:
    reasons = [reason(t, why) for why in one.reasons if not why.neutral] or [
        reason(t, why) for why in one.reasons
    ]
    value = number(t, one.value)
    shown = f"+{value}" if one.part in ADDED else value
    return t("part.because", part=t(f"part.{one.part}"), value=shown, reasons=_listed(t, reasons))


def _listed(t: Words, items: list[str]) -> str:
    if len(items) == 1:
        return items[0]
    return t("and", first=", ".join(items[:-1]), last=items[-1])


def fact(t: Words, method: str, name: str) -> str:
    """What a fact of a method is called."""
    common = t.sentences.get(f"fact.{name}", name)
    return t.sentences.get(f"fact.{method}.{name}", common)


def unit_of(row: Scored, name: str) -> str:
    """The unit of a fact, as people write it."""
    unit = str(about(type(row.given.facts).model_fields[name])["unit"])
    if getattr(row.given.facts, "unit", "cm") == "in":
        unit = {"cm": "in", "kg": "lb"}.get(unit, unit)
    return {"deg": "°", "1/day": "", "1/min": "/min", "1/s": "/s"}.get(unit, unit)


def stability(t: Words, row: Scored) -> str:
    """Which small change of a fact would change the level, or that none does."""
    if row.stable:
        return t("stable")
    told = []
    for move in row.moves:
        unit = unit_of(row, move.fact)
        space = "" if unit in ("", "°") or unit.startswith("/") else " "
        change = (
            t.signed(round(100 * move.change)) + " %"
            if move.is_share
            else t.signed(move.change) + space + unit
        )
        told.append(
            t(
                "move",
                fact=fact(t, row.given.method, move.fact),
                value=number(t, move.value) + space + unit,
                old=number(t, getattr(row.given.facts, move.fact)) + space + unit,
                change=change,
                level=level(t, row.given.method, move.level),
            )
        )
    return t("unstable", moves="; ".join(told))


def unstated(t: Words, row: Scored) -> str:
    """What was not stated and what was taken, and the score if it were as bad as may be; empty when
    all was stated.
    """
    if not row.unstated:
        return ""
    named = ", ".join(
        f"{fact(t, row.given.method, name)} {number(t, value)}"
        for name, value in row.unstated.items()
    )
    said = t("unstated", facts=named)
    if row.at_worst is None or row.at_worst.level == row.outcome.level:
        return said
    worst = t(
        "at_worst",
        score=score(t, row.given.method, row.at_worst.score),
        level=level(t, row.given.method, row.at_worst.level),
    )
    return f"{said} {worst}"


def total(t: Words, one: Total) -> str:
    """What several tasks come to, in a sentence."""
    method = t(f"method.{one.method}")
    if one.side in ("left", "right"):
        method += t("total.side", side=t(f"side.{one.side}"))
    outputs: Mapping[str, Any] = one.outputs
    meaning = "" if one.level is None else level(t, one.method, one.level)
    if one.kind == "dose" and one.level is None:
        return t("total.energy", method=method, kcal=number(t, one.value))
    if one.kind == "dose":
        return t(
            "total.dose",
            method=method,
            region=t(f"region.{METHODS[one.method].region}"),
            dose=number(t, one.value),
            risk=t.share(outputs["probability"]),
            level=meaning,
        )
    if one.kind == "composite":
        name = "CLI" if one.method == "niosh" else "CUSI"
        return t(
            "total.composite", method=method, name=name, value=number(t, one.value), level=meaning
        )
    if "minutes" not in outputs or not one.level:
        return t("total.ordinal", method=method, peak=number(t, one.value), level=meaning)
    return t(
        "total.ordinal.time",
        method=method,
        peak=number(t, one.value),
        level=meaning,
        minutes=number(t, outputs["minutes_at_level"][str(one.level)]),
        all=number(t, outputs["minutes"]),
        place=one.level + (one.method == "rula"),
        mean=number(t, outputs["time_weighted"]),
    )


def sources(t: Words, rows: Iterable[Scored]) -> list[str]:
    """Who assessed and when, each pair once."""
    pairs = {
        (origin.assessor, origin.date)
        for row in rows
        for origin in row.given.origins.values()
        if origin.assessor or origin.date
    }
    return [", ".join(part for part in pair if part) for pair in sorted(pairs)]


def provenance(t: Words, row: Scored) -> str:
    """Where the facts that were stated came from, by source, assessor and date; empty when nothing
    was stated.
    """
    groups: dict[tuple[str, str], list[str]] = {}
    for name, origin in row.given.origins.items():
        if origin.source != "default" or name in row.given.facts.model_fields_set:
            who = ", ".join(part for part in (origin.assessor, origin.date) if part)
            groups.setdefault((origin.source, who), []).append(fact(t, row.given.method, name))
    if not groups:
        return ""
    told = [
        t("provenance.of", source=t(f"source.{source}"), facts=", ".join(names))
        + (t("provenance.by", who=who) if who else "")
        for (source, who), names in groups.items()
    ]
    return t("provenance", sources="; ".join(told))


def method(t: Words, name: str) -> str:
    """What a method is called; a licensed one by its own name."""
    return t.sentences.get(f"method.{name}", LICENSED.get(name, name))


def shift(t: Words, found: Shift) -> str:
    """How many products the shift has, and what that rests on."""
    values = {"cycles": number(t, found.cycles), "each": number(t, found.each_s)}
    if found.hours is None:
        return t("people.cycles", **values)
    return t("people.hours", hours=number(t, found.hours), **values)


def people(t: Words, found: Shift) -> list[tuple[str, list[str]]]:
    """Each person with sentences: how long at work, by which tasks, and what that comes to."""
    return [(one.who, list(_person(t, one))) for one in found.people]


def _person(t: Words, one: Person) -> Iterator[str]:
    if not one.tasks:
        yield t("people.idle")
        return
    yield t("people.work", minutes=t.number(round(one.minutes, 1)), tasks=", ".join(one.tasks))
    yield from (total(t, row) for row in one.totals)
    for peak in one.peaks:
        value = number(t, peak.value)
        yield t("people.peak", method=method(t, peak.method), peak=value, task=peak.task)
    if one.unassessed:
        yield t("people.unassessed", tasks=", ".join(one.unassessed))
