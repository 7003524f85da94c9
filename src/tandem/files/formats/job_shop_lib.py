"""Instances of job-shop-lib as JSON (`JobShopInstance.to_dict`, version 1): a matrix of times and
one of machines, a row a job; machines counted from 0.

Where an operation has several machines, its entry is a list of them; its time is the same on each.
Optional matrices state the earliest start and the latest end of each operation. `due_dates_matrix`
and `metadata` say nothing that decides a schedule.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from tandem.cell.model import Cell
from tandem.errors import CellError, Fault
from tandem.files.formats.fjs import robot, robots
from tandem.files.formats.lines import Translated, broken, few_enough, title
from tandem.files.formats.written import (
    Whole,
    Written,
    all_times,
    alone,
    jobs,
    names_lost,
    not_said,
    refuse,
    whole_numbers,
)
from tandem.files.json_reader import read as read_json
from tandem.files.positions import Document, Path

FORM = "job-shop-lib"
_Machine = Annotated[int, Field(ge=0)]
_OnEach = Annotated[list[_Machine], Field(min_length=1)]


class _Instance(BaseModel):
    model_config = ConfigDict(extra="ignore")

    name: str = ""
    duration_matrix: Annotated[list[list[float]], Field(min_length=1)]
    machines_matrix: list[list[_Machine | _OnEach]]
    release_dates_matrix: list[list[float]] | None = None
    deadlines_matrix: list[list[float | None]] | None = None
    due_dates_matrix: list[list[float | None]] | None = None


def looks_like(text: str) -> bool:
    """Whether it is JSON with a matrix of durations."""
    return text.lstrip().startswith("{") and re.search(r'"duration_matrix"\s*:', text) is not None


def read(text: str, source: str) -> Translated:
    """The instance as a cell: task `2.3` is the third operation of the second job.

    Raises:
      CellError: the file is not JSON, or not of this form; with every value that is not, at its
        line and column.
    """
    document = read_json(text, source)
    try:
        shop = _Instance.model_validate(document.plain())
    except ValidationError as error:
        raise CellError(
            [
                Fault(
                    f"{'.'.join(map(str, item['loc'])) or 'the instance'}: {item['msg']}.",
                    item["loc"],
                    document.place(item["loc"]).text,
                )
                for item in error.errors(include_url=False)
            ]
        ) from error
    if faults := list(_uneven(shop, document)):
        raise CellError(faults)
    tasks: dict[str, Any] = {}
    lines: dict[Path, tuple[int, int]] = {}
    most = 0
    for job, times in enumerate(shop.duration_matrix):
        for step, time in enumerate(times):
            stated = shop.machines_matrix[job][step]
            machines = stated if isinstance(stated, list) else [stated]
            most = max(most, *machines)
            key = f"{job + 1}.{step + 1}"
            where = document.place(("duration_matrix", job, step))
            lines["tasks", key] = (where.line, where.column)
            tasks[key] = {
                "time": {robot(machine): time for machine in machines},
                "part": str(job + 1),
                "after": [f"{job + 1}.{step}"] if step else [],
                **_limits(shop, job, step),
            }
    if not tasks:
        raise broken(source, 1, "no job has an operation.")
    few_enough(source, document.place(("machines_matrix",)).line, most + 1, 1)
    data = {
        "name": shop.name or title(source),
        "operators": robots(0, most + 1),
        "tasks": tasks,
    }
    notes = [
        Fault(
            "due dates are not read: a cell has deadlines, which must be kept.",
            (),
            document.place(("due_dates_matrix",)).text,
        )
    ] * any(date is not None for row in shop.due_dates_matrix or [] for date in row)
    return Translated(source, data, lines, list(document.faults), notes)


def _limits(shop: _Instance, job: int, step: int) -> dict[str, float]:
    found: dict[str, float] = {}
    if shop.release_dates_matrix and (release := shop.release_dates_matrix[job][step]):
        found["release"] = release
    if shop.deadlines_matrix and (deadline := shop.deadlines_matrix[job][step]) is not None:
        found["deadline"] = deadline
    return found


def _uneven(shop: _Instance, document: Document) -> Iterator[Fault]:
    """Every matrix has a row for each job, as long as that of its times."""
    lengths = [len(row) for row in shop.duration_matrix]
    for name in ("machines", "release_dates", "deadlines", "due_dates"):
        matrix = getattr(shop, f"{name}_matrix")
        if matrix and [len(row) for row in matrix] != lengths:
            yield Fault(
                f"{name}_matrix has rows of {[len(row) for row in matrix]} entries, but"
                f" duration_matrix of {lengths}: one for each operation.",
                (),
                document.place((f"{name}_matrix",)).text,
            )


def write(cell: Cell) -> Written:
    """The cell as an instance; names of machines and tasks stand in its metadata.

    Raises:
      CellError: the cell says more than that, its precedence is no rows, or the time of a task
        depends on who does it; with every reason.
    """
    rows, faults = jobs(cell, FORM)
    faults += [
        Fault(
            f"its time depends on who does it, but {FORM} has one time for each task. `fjs` and"
            " `pyjobshop` hold several.",
            ("tasks", name, "time"),
        )
        for name, task in cell.tasks.items()
        if len(set(task.time.values())) > 1
    ]
    refuse(cell, FORM, task=("time", "after", "release", "deadline"), further=faults)
    limits = [task.release for task in cell.tasks.values()]
    limits += [task.deadline for task in cell.tasks.values() if task.deadline is not None]
    unit = whole_numbers([*all_times(cell), *limits])
    data = {
        "name": cell.name,
        "duration_matrix": [[_time(cell, task, unit) for task in job] for job in rows],
        "machines_matrix": _machines(alone(cell, unit), rows),
        "metadata": {"machines": list(cell.operators), "tasks": rows},
        **_matrices(cell, rows, unit),
    }
    notes = (*not_said(cell, unit), *names_lost(cell, 0))
    return Written(json.dumps(data, ensure_ascii=False, indent=1) + "\n", notes)


def _time(cell: Cell, task: str, unit: Whole) -> int:
    return unit(next(iter(cell.tasks[task].time.values())))


def _machines(
    ways: dict[str, list[tuple[int, int]]], rows: list[list[str]]
) -> list[list[int]] | list[list[list[int]]]:
    if all(len(found) == 1 for found in ways.values()):
        return [[ways[task][0][0] for task in job] for job in rows]
    return [[[place for place, _ in ways[task]] for task in job] for job in rows]


def _matrices(cell: Cell, rows: list[list[str]], unit: Whole) -> dict[str, Any]:
    found: dict[str, Any] = {}
    if any(task.release for task in cell.tasks.values()):
        found["release_dates_matrix"] = [
            [unit(cell.tasks[task].release) for task in job] for job in rows
        ]
    if any(task.deadline is not None for task in cell.tasks.values()):
        ends = {
            name: None if task.deadline is None else unit(task.deadline)
            for name, task in cell.tasks.items()
        }
        found["deadlines_matrix"] = [[ends[task] for task in job] for job in rows]
    return found
