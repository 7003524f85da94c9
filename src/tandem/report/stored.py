"""A plan that was kept: the very front that `tandem plan` wrote, read back with the cell that it
was made for.

Nothing is planned anew. Every schedule is judged by the checker when it is read, against the cell
that the plan is asked to keep.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import Any

from tandem.cell.model import Cell
from tandem.cell.written import number
from tandem.errors import CellError, Fault, UnsoundScheduleError, UsageError
from tandem.files.load import load
from tandem.files.messages import shown
from tandem.plan.question import Question
from tandem.plan.result import Bound, Front, Result, Status, knee_index
from tandem.report.results import points_of, read_result, schedules_of
from tandem.schedule.checker import faults
from tandem.schedule.measures import makespan, stress

CLOSE = 1e-6
"""Values of a document that are so close to those of its schedules are the same: seconds, stress.
"""


@dataclass(frozen=True)
class StoredPlan:
    """A front as it was stored.

    Attributes:
      front: its points, each accepted by the checker for `front.cell`.
      made_for: digest of the cell that it was made for; None when the document does not say.
      changed: the cell as it is now, where it is another than the one it was made for; else None.
    """

    front: Front
    made_for: str | None
    changed: Cell | None = None

    @property
    def cell(self) -> Cell:
        """The cell that the schedules were judged by."""
        return self.front.cell

    @property
    def is_stale(self) -> bool:
        """The cell has changed since the plan was made."""
        return self.changed is not None


def read_plan(path: Path, cell: Cell | None = None) -> StoredPlan:
    """The plan in a result document.

    Args:
      cell: what the schedules are to keep; when absent, the cell that the document holds.

    Raises:
      CellError: the file is no result document, holds no point, or no cell although none was given.
      UnsoundScheduleError: a schedule breaks the cell, or is not worth what the document says.
    """
    document = read_result(path)
    held = _held(document, path)
    if cell is None and held is None:
        raise CellError(
            [
                Fault(
                    "holds no cell: an earlier version of Tandem wrote it. Name the cell file"
                    " beside it, or plan anew.",
                    (),
                    str(path),
                )
            ]
        )
    judged = cell or held
    assert judged is not None
    made_for = document.get("cell_digest")
    now = cell or _as_it_is_now(document, path)
    changed = now if now is not None and made_for not in (None, now.digest) else None
    return StoredPlan(_front(document, judged, path), made_for, changed)


def point_of(
    front: Front,
    point: int | None = None,
    makespan: float | None = None,
    stress: float | None = None,
) -> int:
    """Index of the point that is meant: the one of this number, counted from 1; the one of least
    stress within so many seconds; the quickest of at most so much stress; else the knee.

    Raises UsageError when more than one is given, or no point is so.
    """
    if sum(given is not None for given in (point, makespan, stress)) > 1:
        raise UsageError("--point, --makespan and --stress exclude each other: give one of them.")
    if point is not None and not 1 <= point <= len(front):
        raise UsageError(f"--point {point}: {_has(front)}")
    if point is not None:
        return point - 1
    if makespan is None and stress is None:
        return knee_index(front.points)
    latest, hardest = (inf if given is None else given for given in (makespan, stress))
    fit = [
        place
        for place, (time, load) in enumerate(front.points)
        if time <= latest + CLOSE and load <= hardest + CLOSE
    ]
    if not fit:
        given = f"--makespan {number(latest)}" if stress is None else f"--stress {number(hardest)}"
        raise UsageError(f"{given}: no point of the front keeps this; {_has(front)}")
    return fit[-1] if stress is None else fit[0]


def _has(front: Front) -> str:
    points = ", ".join(f"({number(time)} s, {number(load)})" for time, load in front.points)
    return f"the front has {len(front)} point{'s' * (len(front) != 1)}, counted from 1: {points}."


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


def _as_it_is_now(document: Mapping[str, Any], path: Path) -> Cell | None:
    """The cell in the file that the document names, as seen from here or from beside the plan; None
    when there is none, or none that is sound.
    """
    source = document.get("source")
    if not isinstance(source, str):
        return None
    for file in (Path(source), path.parent / source, path.parent.parent / source):
        if file.is_file():
            try:
                return load(file)
            except CellError:
                return None
    return None


def _front(document: Mapping[str, Any], cell: Cell, path: Path) -> Front:
    values = points_of(document)
    results, wrong = [], []
    for place, (schedule, told, row) in enumerate(
        zip(schedules_of(document), values, document["front"], strict=True), 1
    ):
        found = faults(cell, schedule)
        wrong += [f"{path}: point {place}: {fault}" for fault in found]
        if not found and not _is_worth(cell, schedule, told):
            wrong.append(
                f"{path}: point {place}: is said to be worth {number(told[0])} s and a stress of"
                f" {number(told[1])}, but takes {number(makespan(schedule))} s with"
                f" {number(stress(cell, schedule))}."
            )
        results.append(
            Result(cell, schedule, _status(row), _bound(row), row.get("canonical") is True)
        )
    if wrong:
        raise UnsoundScheduleError(wrong)
    return Front(
        cell,
        tuple(results),
        document.get("complete") is True,
        str(document.get("method", "")),
        str(document.get("solver", "")),
        _whole(document.get("seed")),
        float(_number(document.get("wall_s"), 0.0)),
        document.get("interrupted") is True,
        _question(document.get("question")),
        document.get("source"),
    )


def _is_worth(cell: Cell, schedule: Any, told: tuple[float, float]) -> bool:
    found = (makespan(schedule), stress(cell, schedule))
    return all(abs(one - other) <= CLOSE for one, other in zip(found, told, strict=True))


def _status(row: Mapping[str, Any]) -> Status:
    return Status.OPTIMAL if row.get("status") == Status.OPTIMAL else Status.FEASIBLE


def _bound(row: Mapping[str, Any]) -> Bound:
    """What is proven about a point; nothing where the document does not say."""
    told = row.get("bound")
    told = told if isinstance(told, Mapping) else {}
    return Bound(_number(told.get("makespan"), 0.0), _number(told.get("stress"), 0.0))


def _question(told: Any) -> Question:
    """What was asked; the whole front where the document does not say."""
    if not isinstance(told, Mapping):
        return Question()
    try:
        weights = told.get("weights", (1.0, 1.0))
        return Question(
            told.get("minimize", "front"),
            (float(weights[0]), float(weights[1])),
            told.get("max_makespan"),
            told.get("max_stress"),
        )
    except (UsageError, TypeError, ValueError, LookupError):
        return Question()


def _number(value: Any, otherwise: float) -> float:
    is_one = isinstance(value, int | float) and not isinstance(value, bool)
    return value if is_one else otherwise


def _whole(value: Any) -> int:
    return value if isinstance(value, int) else 0
