"""Human-robot cases in JSON: agents, tasks with modes, precedence; the sets hrc_case_studies and
hrc_battery_cells.

A mode with one agent becomes a time, one with several a group. `name` is the label, `product` the
part, `same_agent` the pairs of `same_operator`. A table of the Strain Index becomes
`stress_of_set`, and `strain` beside it, the index of that task alone, an assessment by the method
of 1995. Where there is no table, `strain` or `fatigue` of a task is its stress. Both are rounded to
six decimals. Measured standard deviations to the left and right of the mean become the spread:
their mean as a share of the mean time.
"""

from __future__ import annotations

import re
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from tandem.cell.names import clean
from tandem.errors import CellError, Fault
from tandem.files.formats.lines import Translated
from tandem.files.json_reader import read as read_json
from tandem.files.positions import Document, Path, Place

_Name = Annotated[str, AfterValidator(clean)]


class _Part(BaseModel):
    model_config = ConfigDict(extra="ignore", coerce_numbers_to_str=True)


class _Agent(_Part):
    id: _Name
    type: str


class _Way(_Part):
    agents: list[_Name] = Field(min_length=1)
    time: float
    sd_left: float | None = None
    sd_right: float | None = None

    @property
    def spread(self) -> float | None:
        if self.sd_left is None or self.sd_right is None or self.time <= 0:
            return None
        return round((self.sd_left + self.sd_right) / 2 / self.time, 4)


class _Task(_Part):
    id: _Name
    name: str | None = None
    product: str | None = None
    modes: list[_Way] = Field(min_length=1)
    strain: float | None = None
    fatigue: float | None = None


class _Case(_Part):
    name: str = ""
    agents: list[_Agent] = Field(min_length=1)
    tasks: list[_Task] = Field(min_length=1)
    precedence: list[tuple[_Name, _Name]] = []
    same_agent: list[tuple[_Name, _Name]] = []
    strain_index_of_human_task_set: dict[str, float] | None = None


def looks_like(text: str) -> bool:
    """Whether it is JSON with agents; a cell file has operators."""
    return (
        text.lstrip().startswith("{")
        and re.search(r'"agents"\s*:', text) is not None
        and re.search(r'"operators"\s*:\s*\{', text) is None
    )


def read(text: str, source: str) -> Translated:
    """The case as a cell.

    Raises:
      CellError: the file is not JSON, or not of this form; with every value that is not, at its
        line and column.
    """
    document = read_json(text, source)
    try:
        case = _Case.model_validate(document.plain())
    except ValidationError as error:
        flaws = [(item["loc"], item["msg"]) for item in error.errors(include_url=False)]
        raise CellError(
            [
                Fault(
                    f"{'.'.join(map(str, path)) or 'the case'}: {message}.",
                    path,
                    document.place(path).text,
                )
                for path, message in flaws
            ]
        ) from error
    tasks: dict[str, Any] = {}
    lines: dict[Path, tuple[int, int]] = {}
    faults = list(document.faults)
    has_table = case.strain_index_of_human_task_set is not None
    humans = {agent.id for agent in case.agents if agent.type == "human"}
    for place, task in enumerate(case.tasks):
        where = document.place(("tasks", place))
        if task.id in tasks:
            faults.append(
                Fault(
                    f"task {task.id!r} is stated twice. Rename or remove one of them.",
                    (),
                    where.text,
                )
            )
        tasks[task.id] = _task(task, humans if has_table else None)
        lines["tasks", task.id] = (where.line, where.column)
    for place, (first, then) in enumerate(case.precedence):
        where = document.place(("precedence", place))
        if then not in tasks:
            faults.append(Fault(f"precedence names {then!r}, which is no task.", (), where.text))
            continue
        after = tasks[then]["after"]
        lines["tasks", then, "after", len(after)] = (where.line, where.column)
        after.append(first)
    data: dict[str, Any] = {
        "name": case.name,
        "operators": {agent.id: {"kind": agent.type} for agent in case.agents},
        "tasks": tasks,
        "same_operator": case.same_agent,
    }
    if case.strain_index_of_human_task_set is not None:
        data["stress_of_set"] = _table(case.strain_index_of_human_task_set, list(tasks))
    lines.update(_other_lines(case, document))
    return Translated(source, data, lines, faults)


def _task(task: _Task, assessed: set[str] | None) -> dict[str, Any]:
    """A task; `assessed` are the humans for whom a strain is an index, None where it is stress."""
    alone = {way.agents[0]: way for way in task.modes if len(way.agents) == 1}
    joint = [way for way in task.modes if len(way.agents) > 1]
    entry: dict[str, Any] = {
        "label": task.name,
        "part": task.product,
        "time": {who: way.time for who, way in alone.items()},
        "together": [{"operators": way.agents, "time": way.time} for way in joint],
        "after": [],
    }
    stress = task.strain if task.strain is not None else task.fatigue
    if assessed is None:
        if stress is not None:
            entry["stress"] = round(stress, 6)
    elif task.strain is not None and any(assessed & set(way.agents) for way in task.modes):
        entry["ergonomics"] = [{"method": "strain_index_1995", "score": round(task.strain, 6)}]
    measured = {who: way.spread for who, way in alone.items() if way.spread is not None}
    shared = [way.spread for way in joint if way.spread is not None]
    if measured:
        entry["spread"] = measured
    elif shared:
        entry["spread"] = round(sum(shared) / len(shared), 4)
    return entry


def _table(table: dict[str, float], order: list[str]) -> dict[str, float]:
    """The same sets, spelled in the order of the tasks; a set of unknown tasks stays as it is and
    is refused with the cell.
    """
    place = {name: number for number, name in enumerate(order)}
    return {
        ",".join(sorted(map(clean, key.split(",")), key=lambda name: place.get(name, -1))): round(
            value, 6
        )
        for key, value in table.items()
    }


def _other_lines(case: _Case, document: Document) -> dict[Path, tuple[int, int]]:
    found: dict[Path, Place] = {
        ("stress_of_set",): document.place(("strain_index_of_human_task_set",))
    }
    for place, agent in enumerate(case.agents):
        found["operators", agent.id] = document.place(("agents", place))
    for place in range(len(case.same_agent)):
        found["same_operator", place] = document.place(("same_agent", place))
    return {path: (where.line, where.column) for path, where in found.items()}
