"""Tasks with their facts, scored: what moves a level, and what the tasks of a shift come to.

Scales are never mixed and ordinal scores never added. Doses of one method and body region are; the
indices of several lifts or exertions are put together as their authors do (CLI, CUSI).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

from tandem.ergonomics import duet, exposure, fatigue_failure, lifft, shoulder_tool
from tandem.ergonomics.facts import Facts, FactsError, about, read
from tandem.ergonomics.methods import METHODS, published
from tandem.ergonomics.outcome import Outcome

Side = Literal["", "left", "right", "both"]
SIDES: tuple[Side, ...] = ("left", "right", "both")
SOURCES = ("measured", "video", "estimated", "default", "stated")
"""Where a fact came from. Whoever names no source has `stated` it; `default` was not stated."""
ANGLE, SHARE = 5.0, 0.10
"""How far a fact is moved to see whether the level stays: degrees of an angle, a share else."""
CHANCES = {
    "lifft": (lifft.CHANCE, lifft.level),
    "duet": (duet.CHANCE, lambda dose, risk: int(dose > duet.CUT)),
    "shoulder_tool": (shoulder_tool.CHANCE, shoulder_tool.level),
}
"""Of the tools of fatigue failure: the logistic function of the dose, and its levels."""


@dataclass(frozen=True, slots=True)
class Origin:
    """Where a fact came from: one of `SOURCES`, who assessed it, and when."""

    source: str = "stated"
    assessor: str = ""
    date: str = ""


@dataclass(frozen=True)
class TaskFacts:
    """What is known of one task and side for one method.

    Attributes:
      facts: as the method takes them.
      origins: of every fact, those that were not stated included.
      minutes: that it lasts a shift, when that is known.
      place: where it stands in a file.
    """

    task: str
    method: str
    side: Side
    facts: Facts
    origins: Mapping[str, Origin]
    minutes: float | None = None
    place: str = ""


def in_a_shift(given: TaskFacts, times: float, minutes: float | None) -> TaskFacts:
    """Facts of one execution as those of a shift in which it is done so many times, for so many
    minutes in all.

    Raises:
      FactsError: so often is out of the method's range.
    """
    facts, stated = given.facts, dict(given.facts)
    if "reps" in stated:
        each = float(stated["reps"])
        facts = read(type(facts), {**stated, "reps": each * times}, given.method)
    return replace(given, facts=facts, minutes=given.minutes if minutes is None else minutes)


@dataclass(frozen=True, slots=True)
class Move:
    """What a small change of one fact does.

    Attributes:
      fact: its name; `value` what it was changed to, `change` by how much, in its unit, or as a
        share when `is_share`.
      score, level: with the changed fact.
    """

    fact: str
    value: float
    change: float
    is_share: bool
    score: float | None
    level: int


@dataclass(frozen=True)
class Scored:
    """A task and side with its outcome.

    Attributes:
      moves: changes within the doubt of a fact that would change the level; none when it is stable.
      unstated: facts that were not stated and the value that was taken instead.
      at_worst: the outcome if all that is unstated were as bad as it may be; None when nothing is.
    """

    given: TaskFacts
    outcome: Outcome
    moves: tuple[Move, ...]
    unstated: Mapping[str, Any] = field(default_factory=dict)
    at_worst: Outcome | None = None

    @property
    def stable(self) -> bool:
        """No small change of a single fact changes the level."""
        return not self.moves


def scored(given: TaskFacts) -> Scored:
    """The outcome of a task and side, what would move its level, and what was not stated."""
    method = METHODS[given.method]
    outcome = method.run(given.facts)
    unstated = {
        name: getattr(given.facts, name)
        for name, origin in given.origins.items()
        if origin.source == "default"
        and about(type(given.facts).model_fields[name])["cautious"] is not None
    }
    return Scored(
        given, outcome, tuple(_moves(given, outcome)), unstated, _at_worst(given, unstated)
    )


def _moves(given: TaskFacts, outcome: Outcome) -> Iterator[Move]:
    for name, info in type(given.facts).model_fields.items():
        value = getattr(given.facts, name)
        if not isinstance(value, int | float) or isinstance(value, bool):
            continue
        if given.origins[name].source == "default" and name not in given.facts.model_fields_set:
            continue
        is_angle, is_whole = about(info)["unit"] == "deg", isinstance(value, int)
        for sign in (-1, 1):
            change = sign * (ANGLE if is_angle else 1 if is_whole else SHARE)
            moved = value + change if is_angle or is_whole else value * (1 + change)
            if moved == value or (found := _with(given, {name: moved})) is None:
                continue
            if found.level != outcome.level:
                share = not (is_angle or is_whole)
                yield Move(name, moved, change, share, found.score, found.level)


def _with(given: TaskFacts, changed: Mapping[str, Any]) -> Outcome | None:
    """The outcome with some facts changed; None when the method does not take them so."""
    method = METHODS[given.method]
    try:
        facts = read(method.model, {**dict(given.facts), **changed}, given.method)
    except FactsError:
        return None
    return method.run(facts)


def _at_worst(given: TaskFacts, unstated: Mapping[str, Any]) -> Outcome | None:
    fields = type(given.facts).model_fields
    worst = {
        name: cautious
        for name, value in unstated.items()
        if (cautious := about(fields[name])["cautious"]) is not None and cautious != value
    }
    return _with(given, worst) if worst else None


# --- the tasks of a shift -------------------------------------------------------------------------


@dataclass(frozen=True)
class Total:
    """What several tasks come to under one method, for one side of the body.

    Attributes:
      kind: "dose" (a sum), "composite" (CLI, CUSI: as their authors define them) or "ordinal" (peak
        and shares of time, never a sum).
      value: the dose, the index or the peak.
      level: of the method's levels; None where the authors give none for it.
      outputs: the further numbers, by name.
      tasks: that are in it.
    """

    method: str
    side: Side
    kind: str
    value: float | None
    level: int | None
    outputs: Mapping[str, Any]
    tasks: tuple[str, ...]


def totals(rows: Sequence[Scored]) -> list[Total]:
    """The totals of each method and side, in the order of the table of methods. What works with
    both hands counts for each.
    """
    found = []
    for method in METHODS:
        of_method = [row for row in rows if row.given.method == method]
        for side in _sides({row.given.side for row in of_method}):
            chosen = [row for row in of_method if row.given.side in (side, "both")]
            if (total := _total(method, side, chosen)) is not None:
                found.append(total)
    return found


def _sides(stated: set[Side]) -> list[Side]:
    """The sides to sum up for: what both hands do counts for each, where one does more."""
    if stated <= {"both"}:
        return list(stated)
    one_sided: tuple[Side, ...] = ("", "left", "right")
    return [side for side in one_sided if side in stated or (side and "both" in stated)]


def _total(method: str, side: Side, rows: Sequence[Scored]) -> Total | None:
    names = tuple(row.given.task for row in rows)
    scale = METHODS[method].scale
    if scale == "dose":
        return _dose(method, side, rows, names)
    if scale == "ordinal":
        return _ordinal(method, side, rows, names)
    if method in ("niosh", "rsi") and len(rows) > 1:
        return _composite(method, side, rows, names)
    return None


def _dose(method: str, side: Side, rows: Sequence[Scored], names: tuple[str, ...]) -> Total:
    dose = math.fsum(float(row.outcome.score or 0) for row in rows)
    if method not in CHANCES:
        return Total(method, side, "dose", dose, None, {"kcal": dose}, names)
    chance, level = CHANCES[method]
    risk = fatigue_failure.probability(dose, *chance)
    outputs = {
        "CD": dose,
        "probability": risk,
        "shares": [float(row.outcome.score or 0) / dose if dose > 0 else 0.0 for row in rows],
    }
    return Total(method, side, "dose", dose, level(dose, risk), outputs, names)


def _ordinal(method: str, side: Side, rows: Sequence[Scored], names: tuple[str, ...]) -> Total:
    peak = max(float(row.outcome.score or 0) for row in rows)
    level = max(row.outcome.level for row in rows)
    outputs: dict[str, Any] = {"peak": peak}
    if all(row.given.minutes is not None for row in rows):
        tasks = [
            {"score": float(row.outcome.score or 0), "minutes": row.given.minutes} for row in rows
        ]
        answer = published(exposure.METHOD, "twa", {"tasks": tasks})
        assert isinstance(answer, dict)
        minutes = math.fsum(float(row.given.minutes or 0) for row in rows)
        above = {
            place: math.fsum(float(r.given.minutes or 0) for r in rows if r.outcome.level >= place)
            for place in range(1, level + 1)
        }
        outputs |= {
            "time_weighted": answer["TWA"],
            "minutes": minutes,
            "minutes_at_level": {str(place): value for place, value in above.items()},
        }
    return Total(method, side, "ordinal", peak, level, outputs, names)


def _composite(
    method: str, side: Side, rows: Sequence[Scored], names: tuple[str, ...]
) -> Total | None:
    """CLI of lifts, CUSI of exertions; None where their authors' condition is not kept."""
    facts = [dict(row.given.facts) for row in rows]
    try:
        if method == "niosh":
            keys = ("H", "V", "D", "A", "F", "duration", "coupling", "L", "V_origin")
            units = {given["unit"] for given in facts}
            if len(units) > 1 or any(given["L"] is None for given in facts):
                return None
            tasks = [{key: given[key] for key in keys} for given in facts]
            answer = published("niosh", "niosh_cli", {"tasks": tasks, "unit": units.pop()})
        else:
            days = [
                {"H": given["H"], "subtasks": [{k: given[k] for k in ("I", "E", "D", "P")}]}
                for given in facts
            ]
            answer = published("rsi", "cusi", {"tasks": days})
    except FactsError:
        return None
    assert isinstance(answer, Outcome)
    name = "CLI" if method == "niosh" else "CUSI"
    return Total(method, side, "composite", answer.score, answer.level, {name: answer.score}, names)
