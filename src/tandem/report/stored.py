"""A plan that was kept: the very front that `tandem plan` wrote, read back with the cell that it
was made for.

Nothing is planned anew. Every schedule is judged by the checker when it is read: against the cell
that the plan holds, and against another one when it is asked to keep that too.
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, NamedTuple, TypeVar

from tandem.cell.model import Cell
from tandem.cell.written import number
from tandem.errors import CellError, Fault, NotReadWarning, UnsoundScheduleError, UsageError
from tandem.files.load import load
from tandem.files.messages import shown
from tandem.plan.choice import point_of
from tandem.plan.cycle.result import CycleFront
from tandem.plan.provers import Prover, Step
from tandem.plan.question import Question
from tandem.plan.result import (
    Beyond,
    Bound,
    Confidence,
    Confirmation,
    Front,
    Outcome,
    Quantiles,
    Result,
    Risk,
    Status,
)
from tandem.report.language import words
from tandem.report.project import stale_at_home
from tandem.report.results import (
    faults_of,
    is_number,
    patterns_of,
    points_of,
    read_result,
    schedules_of,
)
from tandem.schedule.cycle import PeriodicSchedule
from tandem.schedule.measures import makespan, stress
from tandem.schedule.model import Schedule

__all__ = ["StoredPlan", "cell_in", "faults_in", "point_of", "read_plan", "stale_note", "stale_now"]

CLOSE = 1e-6
"""Values of a document that are so close to those of its schedules are the same: seconds, stress.
"""


F = TypeVar("F", Front, CycleFront)


@dataclass(frozen=True)
class Stored(Generic[F]):
    """A front as it was stored, of plans or of cycles.

    Attributes:
      front: its points as they were stored, each accepted by the checker.
      made_for: digest of the cell that it was made for; None when the document does not say.
      is_stale: the cell has changed since: it is another now, or no sound one any more.
      changed: the cell as it is now, where it is another than the one it was made for; else None.
      path: the file.
    """

    front: F
    made_for: str | None
    is_stale: bool
    changed: Cell | None
    path: Path

    @property
    def cell(self) -> Cell:
        """The cell that the plan holds; the one beside it when it holds none."""
        return self.front.cell

    def stale_note(self, language: str = "en") -> str:
        """One sentence for whoever is about to use a plan whose cell has changed; empty when it has
        not.
        """
        return stale_note(self.path, language) if self.is_stale else ""


StoredPlan = Stored[Front]


def stale_note(path: str | Path, language: str = "en") -> str:
    """How everyone says that the plan in this file was made for another state of its cell."""
    return words(language)("stale.note", file=path)


def read_plan(path: str | os.PathLike[str], cell: Cell | None = None) -> StoredPlan:
    """The plan in a result document, the very points that were stored.

    Args:
      cell: what the schedules are to keep besides the cell that the document holds. When absent,
        the file that the document names as its cell's is looked for, beside it and here; whether it
        has changed is said, and nothing is judged by it.

    Raises:
      CellError: the file is no result document, holds no point, or no cell although none was given.
      UnsoundScheduleError: a schedule breaks a cell that it is to keep, or is not worth what the
        document says.
    """
    opened = open_stored(path, cell)
    front = _front(opened.document, opened.cell)
    return StoredPlan(front, opened.made_for, opened.is_stale, opened.changed, opened.path)


class Opened(NamedTuple):
    """A stored document whose schedules have been judged, the cell that it belongs to, and what a
    `Stored` says of it.
    """

    document: dict[str, Any]
    cell: Cell
    made_for: str | None
    is_stale: bool
    changed: Cell | None
    path: Path


def open_stored(
    path: str | os.PathLike[str], cell: Cell | None = None, *, cycles: bool = False
) -> Opened:
    """The document in a file, judged as `read_plan` says; with `cycles` one of a station that
    repeats too. Raises as `read_plan` does.
    """
    path = Path(path)
    document = read_result(path, cycles=cycles)
    held = _held(document, path) if cell is not None else cell_in(document, path)
    made_for = document.get("cell_digest")
    if cell is not None:
        changed = cell if made_for not in (None, cell.digest) else None
        is_stale = changed is not None
    else:
        changed, is_stale = stale_now(document, path)
    own = held or cell
    assert own is not None
    values = points_of(document, str(path)) if held is not None or not is_stale else []
    wrong = faults_in(document, own, values)
    if cell is not None and cell != own:
        wrong += faults_in(document, cell)
    if wrong:
        told = [f"{path}: point {place}: {fault}" for place, fault in wrong]
        raise UnsoundScheduleError([*([stale_note(path)] if is_stale else []), *told])
    return Opened(document, own, made_for, is_stale, changed, path)


def cell_in(document: Mapping[str, Any], path: Path) -> Cell:
    """The cell that a result document holds. Raises CellError when it holds none that is sound."""
    held = _held(document, path)
    if held is None:
        fault = (
            "holds no cell: an earlier version of Tandem wrote it. Name the cell file beside it,"
            " or plan anew."
        )
        raise CellError([Fault(fault, (), str(path))])
    return held


def faults_in(
    document: Mapping[str, Any], cell: Cell, values: Sequence[tuple[float, float]] = ()
) -> list[tuple[int, str]]:
    """What is wrong with the schedules of a result document: the number of the point, counted from
    1, and a sentence. They are to keep the cell, to have the digest that is stated, and to be worth
    these makespans and stresses if any are given.
    """
    wrong = []
    for place, pattern in enumerate(patterns_of(document), 1):
        point = document["front"][place - 1]
        found = faults_of(document, cell, pattern)
        if values and not found:
            found += _worth(cell, pattern, values[place - 1], point)
        stated, kind = point.get("digest"), "plan" if isinstance(pattern, Schedule) else "cycle"
        if stated not in (None, pattern.digest):
            found.append(f"is said to be {kind} {shown(stated)}, but is {kind} {pattern.digest}.")
        wrong += [(place, fault) for fault in found]
    return wrong


def _held(document: Mapping[str, Any], path: Path) -> Cell | None:
    """The cell that a document holds."""
    held = document.get("cell_document")
    if held is None:
        return None
    if not isinstance(held, Mapping):
        fault = f"is {shown(held)}, but must be a cell as a cell file holds it. Plan anew."
        raise CellError([Fault(fault, (), f"{path}, cell_document")])
    try:
        return load(held)
    except CellError as error:
        raise CellError([fault.at(f"{path}, cell_document") for fault in error.faults]) from None
    except RecursionError:
        fault = "is nested too deeply for a cell. Plan anew."
        raise CellError([Fault(fault, (), f"{path}, cell_document")]) from None


def stale_now(document: Mapping[str, Any], path: Path) -> tuple[Cell | None, bool]:
    """The cell of the file that the document names, where it is another now, and whether the plan
    is stale.

    The file is looked for from here, from beside the plan and from the folder above; where one of
    them is what the plan was made for, it is not stale. A plan that names no file, or one that is
    not found, is judged by the project in which it lies, if it lies in one.
    """
    source, made_for = document.get("source"), document.get("cell_digest")
    if isinstance(source, str) and isinstance(made_for, str):
        named = [Path(source), path.parent / source, path.parent.parent / source]
        found = [_loaded(file) for file in dict.fromkeys(named) if file.is_file()]
        if any(now is not None and now.digest == made_for for now in found):
            return None, False
        if found:
            return found[0], True
    return None, stale_at_home(path)


def _loaded(file: Path) -> Cell | None:
    """The cell in a file; None when it is no sound one."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", NotReadWarning)
            return load(file)
    except CellError:
        return None


def _worth(
    cell: Cell,
    pattern: Schedule | PeriodicSchedule,
    told: tuple[float, float],
    point: Mapping[str, Any],
) -> list[str]:
    """That a schedule is not worth what is told, if it is not; and that another number of products
    than told is in process.
    """
    schedule = pattern if isinstance(pattern, Schedule) else pattern.schedule
    found, wrong = (makespan(schedule), stress(cell, schedule)), []
    if not all(abs(one - other) <= CLOSE for one, other in zip(found, told, strict=True)):
        wrong.append(
            f"is said to be worth {number(told[0])} s and a stress of {number(told[1])}, but takes"
            f" {number(found[0])} s with {number(found[1])}."
        )
    if isinstance(pattern, PeriodicSchedule) and point.get("in_process") != pattern.in_process:
        wrong.append(
            f"is said to have {shown(point.get('in_process'))} in process, but has"
            f" {pattern.in_process}."
        )
    return wrong


def _front(document: Mapping[str, Any], cell: Cell) -> Front:
    source = document.get("source")
    return Front(
        cell,
        tuple(
            Result(
                cell,
                schedule,
                status_of(row),
                _bound(row),
                row.get("canonical") is True,
                _risk(row.get("risk")),
            )
            for schedule, row in zip(schedules_of(document), document["front"], strict=True)
        ),
        document.get("complete") is True,
        str(document.get("method", "")),
        str(document.get("solver", "")),
        whole_of(document.get("seed")),
        float(number_or(document.get("wall_s"), 0.0)),
        document.get("interrupted") is True,
        _question(document.get("question")),
        source if isinstance(source, str) else None,
        document.get("recommended_by") == "p95",
        out_of_time=document.get("ended_by") == "time",
        bound_front=_bound_front(document.get("bound_front")),
        open_area=document["open_area"] if is_number(document.get("open_area")) else None,
        confirmation=_confirmation(document.get("confirmation")),
        confidence=_confidence(document.get("confidence")),
    )


def _confidence(told: Any) -> Confidence | None:
    """What a trained policy said of itself; nothing where the document does not hold it."""
    try:
        beyond = tuple(
            Beyond(str(one["what"]), *(float(one[key]) for key in ("value", "least", "most")))
            for one in told["beyond"]
        )
        chance = told["chance"]
        return Confidence(None if chance is None else float(chance), beyond)
    except (TypeError, KeyError, ValueError):
        return None


def _confirmation(told: Any) -> Confirmation | None:
    """What the dynamic program said; nothing where the document does not hold it."""
    try:
        return Confirmation(Outcome(told["outcome"]), whole_of(told["states"]))
    except (TypeError, KeyError, ValueError):
        return None


def _bound_front(told: Any) -> tuple[tuple[float, float], ...]:
    """What is proven of the points that were not found; nothing where the document does not say."""
    try:
        pairs = tuple((corner["makespan"], corner["stress"]) for corner in told)
    except (TypeError, KeyError):
        return ()
    return pairs if all(is_number(value) for pair in pairs for value in pair) else ()


def status_of(row: Mapping[str, Any]) -> Status:
    """How far a point is proven."""
    return Status.OPTIMAL if row.get("status") == Status.OPTIMAL else Status.FEASIBLE


def _bound(row: Mapping[str, Any]) -> Bound:
    """What is proven about a point; nothing where the document does not say."""
    told = row.get("bound")
    told = told if isinstance(told, Mapping) else {}
    makespan, stress = (number_or(told.get(key), 0.0) for key in ("makespan", "stress"))
    by = row.get("proved_by")
    try:
        who = [Prover(by[key]) for key in ("makespan", "stress")] if by is not None else []
    except (TypeError, KeyError, ValueError):
        who = []
    steps = [(Step(value, one),) for value, one in zip((makespan, stress), who, strict=False)]
    return Bound(makespan, stress, *steps)


def _risk(told: Any) -> Risk | None:
    """What was simulated of a point; None where the document does not say all of it."""
    try:
        fixed, replanned = (_quantiles(told[way]) for way in ("fixed", "replanned"))
    except (TypeError, KeyError, ValueError):
        return None
    return None if fixed is None else Risk(fixed, replanned)


def _quantiles(told: Any) -> Quantiles | None:
    if told is None:
        return None
    return Quantiles(float(told["p50"]), float(told["p95"]), int(told["episodes"]))


def _question(told: Any) -> Question:
    """What was asked; the whole front where the document does not say."""
    if not isinstance(told, Mapping):
        return Question()
    limits = [told.get("max_makespan"), told.get("max_stress")]
    weights = told.get("weights", [1.0, 1.0])
    pair: list[Any] = weights if isinstance(weights, list) and len(weights) == 2 else [None]
    if not all(map(is_number, [*pair, *(limit for limit in limits if limit is not None)])):
        return Question()
    try:
        return Question(told.get("minimize", "front"), (pair[0], pair[1]), limits[0], limits[1])
    except (UsageError, TypeError):
        return Question()


def number_or(value: Any, otherwise: float) -> float:
    """The number that a document holds there, if it is one."""
    return value if is_number(value) else otherwise


def whole_of(value: Any) -> int:
    """The whole number that a document holds there; 0 if it is none."""
    return value if is_number(value) and isinstance(value, int) else 0
