"""Results of `tandem plan --json`, read back: what they must look like, every fault at its
place.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from tandem.cell.model import Cell
from tandem.errors import CellError, Fault
from tandem.files.messages import shown
from tandem.plan.cycle.result import OBJECTIVES
from tandem.schedule import checker, cycle_checker
from tandem.schedule.cycle import PeriodicSchedule
from tandem.schedule.model import Schedule

NO_PLAN = (
    "holds the cycles of a station that repeats, and no plan of one product; `tandem report` and"
    " `tandem check` read it. Plan without --cycle for this command."
)
"""What is said of a document of cycles where a plan is wanted."""
LATEST = 1e15
"""No moment of a schedule is later, seconds: beyond it a float no longer holds microseconds."""


def read_result(path: Path, *, cycles: bool = False) -> dict[str, Any]:
    """The result document in a file, whose schedules have the form of schedules.

    Args:
      cycles: the document may hold patterns of a station that repeats, too.

    Raises CellError, with every fault and the file, when it cannot be read, is none, or holds
    cycles where plans are wanted.
    """
    give = "Give what `tandem plan CELL --json` prints."
    try:
        document: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        patterns_of(document)
        if is_cycle(document) and not cycles:
            raise CellError([Fault(NO_PLAN)])
    except OSError as error:
        why = (error.strerror or "unknown").lower()
        raise CellError(
            [Fault(f"cannot be read: {why}. Name another file.", (), str(path))]
        ) from error
    except json.JSONDecodeError as error:
        place = f"{path}:{error.lineno}:{error.colno}"
        fault = f"is no result document: no well-formed JSON here. {give}"
        raise CellError([Fault(fault, (), place)]) from error
    except (UnicodeDecodeError, RecursionError, ValueError) as error:
        fault = f"is no result document: no JSON text. {give}"
        raise CellError([Fault(fault, (), str(path))]) from error
    except CellError as error:
        raise CellError([fault.at(str(path)) for fault in error.faults]) from error
    return document


def is_cycle(document: Any) -> bool:
    """Whether a result holds patterns of a station that repeats, and no plans of one product."""
    return is_result(document) and document.get("objectives") == OBJECTIVES


def is_result(document: Any) -> bool:
    """Whether a document means to be a result: it has a front, which no cell has."""
    return isinstance(document, Mapping) and "front" in document


def points_of(document: Mapping[str, Any], source: str = "") -> list[tuple[float, float]]:
    """Makespan and stress of each point of the front; `source` is what messages call the document.

    Raises CellError with every point that does not tell them, and when there is no point.
    """
    wrong = [
        Fault(f"point {place} of the front: {key} is {_given(point, key)}, but must be a number.")
        for place, point in enumerate(document["front"], 1)
        for key in ("makespan", "stress")
        if not is_number(point.get(key))
    ]
    if not document["front"]:
        wrong.append(Fault("holds no schedule."))
    if wrong:
        raise CellError(fault.at(source) for fault in wrong)
    return [(point["makespan"], point["stress"]) for point in document["front"]]


def _given(point: Mapping[str, Any], key: str) -> str:
    return shown(point[key]) if key in point else "missing"


def is_number(value: Any) -> bool:
    """A number that a moment or a stress can be."""
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < LATEST


def schedules_of(document: Mapping[str, Any]) -> list[Schedule]:
    """The schedules of a result document. Raises CellError with everything that keeps it from being
    one.
    """
    if wrong := list(_misshapen(document)):
        raise CellError(wrong)
    return [Schedule.from_list(point["assignments"]) for point in document["front"]]


def patterns_of(document: Mapping[str, Any]) -> Sequence[Schedule | PeriodicSchedule]:
    """The schedules of a result document; those of a station that repeats with their cycle times.
    Raises CellError with everything that keeps it from being one.
    """
    schedules = schedules_of(document)
    if not is_cycle(document):
        return schedules
    wrong = [
        Fault(
            f"point {place} of the front: cycle_time is {_given(point, 'cycle_time')}, but must be"
            " a number of more than 0 seconds."
        )
        for place, point in enumerate(document["front"], 1)
        if not (is_number(point.get("cycle_time")) and point["cycle_time"] > 0)
    ]
    if wrong:
        raise CellError(wrong)
    return [
        PeriodicSchedule(schedule, float(point["cycle_time"]))
        for schedule, point in zip(schedules, document["front"], strict=True)
    ]


def faults_of(
    document: Mapping[str, Any], cell: Cell, pattern: Schedule | PeriodicSchedule
) -> list[str]:
    """What the checker of its kind finds wrong with one of the `patterns_of` a result document; of
    a station that repeats also what breaks the limits that were asked for.
    """
    if isinstance(pattern, Schedule):
        return checker.faults(cell, pattern)
    asked = document.get("question")
    asked = asked if isinstance(asked, Mapping) else {}
    limits = {
        name: asked[key]
        for name, key in (
            ("max_cycle_time", "takt"),
            ("max_in_process", "max_in_process"),
            ("max_stress", "max_stress"),
        )
        if is_number(asked.get(key))
    }
    return cycle_checker.faults(cell, pattern, **limits)


def _misshapen(document: Any) -> Iterator[Fault]:
    """What keeps a document from being the result of `tandem plan --json`, each with its place in
    it.
    """
    if not isinstance(document, Mapping) or not isinstance(document.get("front"), list):
        yield Fault(
            f"is no result document, but {shown(document)} without a list `front`. Give what"
            " `tandem plan CELL --json` prints."
        )
        return
    for place, point in enumerate(document["front"], 1):
        here = f"point {place} of the front"
        if not isinstance(point, Mapping) or not isinstance(point.get("assignments"), list):
            yield Fault(
                f"{here} is {shown(point)} without a list `assignments`. Plan anew, or take the"
                " point out."
            )
            continue
        for number, row in enumerate(point["assignments"], 1):
            if problem := _misshapen_row(row):
                yield Fault(f"{here}, assignment {number}: {problem}.")


def _misshapen_row(row: Any) -> str:
    """What is wrong with one assignment; empty when nothing is."""
    if not isinstance(row, Mapping):
        return (
            f'is {shown(row)}, but must be like {{"task": "1", "operators": ["robot"], "start": 0,'
            ' "end": 9}'
        )
    if missing := [key for key in ("task", "operators", "start", "end") if key not in row]:
        return (
            f"{' and '.join(f'`{key}`' for key in missing)} {'is' if len(missing) == 1 else 'are'}"
            " missing"
        )
    for key in ("start", "end"):
        if not is_number(row[key]):
            return f"{key} is {shown(row[key])}, but must be a number of seconds"
    if not isinstance(row["operators"], list) or not all(
        isinstance(who, str | int) for who in row["operators"]
    ):
        return f"operators is {shown(row['operators'])}, but must be a list of names"
    return (
        ""
        if isinstance(row["task"], str | int)
        else f"task is {shown(row['task'])}, but must be a name"
    )


def stale(document: Mapping[str, Any], cell: Cell) -> bool | None:
    """The result was made for another state of the cell; None when it does not say."""
    digest = document.get("cell_digest")
    return None if digest is None else digest != cell.digest
