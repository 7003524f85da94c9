"""What the assessments of a cell's tasks say: facts scored by their methods, numbers from outside
as they are. An assessment tells of one execution of its task.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

from tandem.cell.names import Known
from tandem.cell.stated import (
    ROW_KEYS,
    Conditions,
    Given,
    as_given,
    entry,
    meanings,
    method_in,
    row_of,
)
from tandem.cell.written import number
from tandem.ergonomics.methods import LICENSED, METHODS, unknown
from tandem.errors import CellError, Fault

if TYPE_CHECKING:
    from tandem.cell.parts import Assessment, Fields
    from tandem.ergonomics.outcome import Outcome
    from tandem.ergonomics.tasks import Origin, Side, TaskFacts

Path = tuple[str | int, ...]
ONE = Conditions(cycles=1.0, of_one=True)
"""Facts of a cell tell of one execution of a task."""
GRADES = {"rula": 7, "reba": 15}
"""The highest grade of methods whose scores are whole numbers from 1 on."""
TOLERANCE = 0.005
"""How far a score that stands beside its facts may be from what they come to: people round."""


@dataclass(frozen=True)
class Assessed:
    """One assessment of a task, scored.

    Attributes:
      place: among the assessments of its task.
      operators: the humans for whom it holds, in the cell's order.
      own: it names its operators, and so goes before one that holds for everybody.
      value: the score; of a method that gives doses the dose of one execution.
      given, outcome: the facts and what they come to; None of a number from outside.
    """

    task: str
    place: int
    method: str
    side: Side
    operators: tuple[str, ...]
    own: bool
    value: float
    origin: Origin
    minutes: float | None
    given: TaskFacts | None
    outcome: Outcome | None


def assessed(cell: Fields) -> tuple[Assessed, ...]:
    """Every assessment of a sound cell, scored, in the cell's order."""
    found = []
    for task in cell.tasks:
        for place in range(len(cell.tasks[task].ergonomics)):
            one, faults = _read(cell, task, place)
            if one is None:
                raise CellError(faults)
            found.append(one)
    return tuple(found)


def faults(cell: Fields) -> Iterator[Fault]:
    """What keeps the assessments of a cell from being scored, each at the key where it stands."""
    for task in cell.tasks:
        seen: dict[tuple[str, Side, str], int] = {}
        for place in range(len(cell.tasks[task].ergonomics)):
            one, wrong = _read(cell, task, place)
            yield from wrong
            if one is not None:
                yield from _twice(cell, one, seen)


def doers(cell: Fields, task: str) -> tuple[str, ...]:
    """The humans who can do a task, alone or together, in the cell's order."""
    stated = cell.tasks[task]
    able = {*stated.time, *(who for joint in stated.together for who in joint.operators)}
    return tuple(who for who in cell.humans if who in able)


def _read(cell: Fields, task: str, place: int) -> tuple[Assessed | None, list[Fault]]:
    given = cell.tasks[task].ergonomics[place]
    path: Path = ("tasks", task, "ergonomics", place)
    wrong = list(_of_operators(cell, task, given, path))
    method = method_in(given.method)
    if method is None:
        return None, [*wrong, Fault(f"task {task!r}: {unknown(given.method)}", (*path, "method"))]
    row: dict[str, Given] = {}
    for name, value in given.facts.items():
        one = as_given(name, value, name)
        if isinstance(one, str):
            wrong.append(Fault(f"task {task!r}: {one}", (*path, name)))
        else:
            row[name] = one
    is_bare = all(set(meanings(name)) & set(ROW_KEYS) for name in row)
    if is_bare and given.score is not None:
        return _from_outside(cell, given, method, row, path, wrong)
    if method in LICENSED and method not in METHODS:
        return None, [*wrong, Fault(_licensed(task, method), path)]
    row["method"] = Given(method, "method")
    facts, refused = entry(task, row, "", ONE)
    wrong += [_at(fault, path) for fault in refused]
    if facts is None or wrong:
        return None, wrong
    outcome = METHODS[method].run(facts.facts)
    if (fault := _misfit(task, given, method, outcome)) is not None:
        return None, [Fault(fault, (*path, "score") if given.score is not None else path)]
    origin = next(iter(facts.origins.values()))
    return (
        Assessed(
            task, place, method, facts.side, given.operators or doers(cell, task),
            bool(given.operators), float(cast(float, outcome.score)), origin, facts.minutes,
            facts, outcome,
        ),
        [],
    )  # fmt: skip


def _from_outside(
    cell: Fields,
    given: Assessment,
    method: str,
    row: dict[str, Given],
    path: Path,
    wrong: list[Fault],
) -> tuple[Assessed | None, list[Fault]]:
    task = str(path[1])
    side, origin, minutes, refused = row_of(task, row, method)
    wrong += [_at(fault, path) for fault in refused]
    score = float(cast(float, given.score))
    most = GRADES.get(method)
    if most is not None and not (score.is_integer() and 1 <= score <= most):
        wrong.append(
            Fault(
                f"task {task!r}: score is {number(score)}, but {method} gives whole numbers from 1"
                f" to {most}. Correct it.",
                (*path, "score"),
            )
        )
    if wrong:
        return None, wrong
    return (
        Assessed(
            task, int(path[-1]), method, side, given.operators or doers(cell, task),
            bool(given.operators), score, origin, minutes, None, None,
        ),
        [],
    )  # fmt: skip


def _at(fault: Fault, path: Path) -> Fault:
    """The fault at the key that it names as its place, or at the assessment as a whole."""
    return Fault(fault.message, (*path, fault.place) if fault.place else path)


def _licensed(task: str, method: str) -> str:
    return (
        f"task {task!r}: {LICENSED[method]} is not computed here: its tables are licensed, or not"
        f" verified. State the number that it gave: `{{method: {method}, score: 38}}`."
    )


def _misfit(task: str, given: Assessment, method: str, outcome: Outcome) -> str | None:
    """Why what the facts come to cannot be taken; None when it can."""
    if outcome.score is None or not math.isfinite(outcome.score):
        return (
            f"task {task!r}: {method} gives no number for these facts: what is done is out of its"
            " bounds altogether. Correct the facts, or change the work."
        )
    if given.score is None or math.isclose(
        given.score, outcome.score, rel_tol=TOLERANCE, abs_tol=1e-12
    ):
        return None
    return (
        f"task {task!r}: score is {given.score:g}, but the facts beside it come to"
        f" {outcome.score:.6g} by {method}. Leave the score out, or correct the facts."
    )


def _of_operators(cell: Fields, task: str, given: Assessment, path: Path) -> Iterator[Fault]:
    known, able = Known(cell.operators), doers(cell, task)
    for place, who in enumerate(given.operators):
        here = (*path, "operators", place)
        if who not in known:
            yield Fault(
                f"task {task!r}: ergonomics names {who!r}, who is no operator of the cell."
                f" {known.hint(who)}",
                here,
            )
        elif cell.operators[who].kind != "human":
            yield Fault(
                f"task {task!r}: ergonomics is stated for {who!r}, a {cell.operators[who].kind}."
                f" Only humans have a body; take {who!r} out.",
                here,
            )
        elif who not in able:
            yield Fault(
                f"task {task!r}: ergonomics is stated for {who!r}, who cannot do the task. Give a"
                f" time for {who!r}, or take {who!r} out.",
                here,
            )


def _twice(cell: Fields, one: Assessed, seen: dict[tuple[str, Side, str], int]) -> Iterator[Fault]:
    """A second assessment of one task, method and side for one person. Movements of which a method
    adds the doses up may be several.
    """
    method = METHODS.get(one.method)
    if method is not None and method.scale == "dose" and not method.sided:
        return
    for who in one.operators if one.own else ("",):
        first = seen.setdefault((one.method, one.side, who), one.place)
        if first != one.place:
            side = f", side {one.side}" if one.side else ""
            whose = f" for {who!r}" if who else ""
            yield Fault(
                f"task {one.task!r}: {one.method}{side} is stated twice{whose}. Is one of them the"
                " other side, or another person's (`operators`)? Correct it, or keep one.",
                ("tasks", one.task, "ergonomics", one.place),
            )
