"""The sheet that says what is known of tasks for ergonomic methods: a row for each task, method and
side.
"""

from __future__ import annotations

from typing import Any

from tandem.cell.names import Known, clean, key
from tandem.cell.stated import Given
from tandem.files.spreadsheet.facts import Column, columns_of, header_of, row_of, task_named
from tandem.files.spreadsheet.findings import Findings
from tandem.files.spreadsheet.grid import Grid
from tandem.files.spreadsheet.said import say
from tandem.files.spreadsheet.values import marks_of
from tandem.files.spreadsheet.vocabulary import PHRASES

OWN = {
    "operators": ("operators", "operator", "for whom", "person", "persons", "people", "bediener",
                  "fuer wen", "personen", "mitarbeiter", "werker"),
    "score": ("score", "wert", "punkte", "punktzahl", "ergebnis"),
    "method": ("method", "methode", "verfahren"),
}  # fmt: skip
"""Columns of an assessment beside its facts, and how they may be called."""


def read_assessments(grid: Grid, tasks: dict[str, dict[str, Any]], findings: Findings) -> None:
    """Puts what the sheet states into the tasks' `ergonomics`; what is wrong goes to `findings`."""
    head = header_of(grid)
    if head is None:  # numbers from outside alone have no facts
        head = next((row for row in range(min(30, len(grid.rows))) if _is_head(grid, row)), None)
    if head is None:
        findings.note("sheet", say("sheet.unread", sheet=repr(grid.name)), f"{grid.name}!A1")
        return
    naming, columns, _ = columns_of(grid, head)
    own = {
        index: what
        for index, text in grid.filled(head)
        for what, spellings in OWN.items()
        if key(str(text)) in spellings
    }
    facts = [column for column in columns if column.index not in own]
    added = [Column(index, what, None) for index, what in own.items()]
    known = {naming, *own, *(column.index for column in columns)}
    for index, text in grid.filled(head):
        if index not in known:
            said = say("column.of_sheet", column=repr(str(text)), sheet=repr(grid.name))
            findings.note("column", said, grid.place(head, index))
    rows = [row for row in range(head + 1, len(grid.rows)) if not grid.is_blank(row)]
    marks = marks_of(grid.value(row, column.index) for row in rows for column in columns)
    names = _names(tasks)
    for row in rows:
        wrong: list[Any] = []
        given = row_of(grid, row, [*added, *facts], marks, wrong)
        for fault in wrong:
            findings.fault(fault.message, fault.place)
        name = clean(task_named(grid.value(row, naming)))
        if not given:
            continue
        task = names.get(key(name)) if name else None
        if task is None:
            hint = Known(tasks).hint(name) if name else "Name the task."
            findings.fault(f"{name!r} is no task. {hint}", grid.place(row, naming))
            continue
        _enter(tasks[task], task, given, grid.place(row, naming), findings)


def _is_head(grid: Grid, row: int) -> bool:
    heads = {key(str(text)) for _, text in grid.filled(row)}
    return bool(heads & {*PHRASES["task"], *PHRASES["number"]}) and bool(heads & {*OWN["method"]})


def _names(tasks: dict[str, dict[str, Any]]) -> dict[str, str]:
    """Names and titles of tasks, folded -> the task."""
    titles = {key(str(data["label"])): name for name, data in tasks.items() if data.get("label")}
    return {**titles, **{key(name): name for name in tasks}}


def _enter(
    data: dict[str, Any], task: str, given: dict[str, Given], place: str, findings: Findings
) -> None:
    kept = data.setdefault("ergonomics", [])
    path: tuple[str | int, ...] = ("tasks", task, "ergonomics", len(kept))
    findings.places[path] = place
    one: dict[str, Any] = {"method": ""}
    for name, value in given.items():
        findings.places[(*path, name)] = value.place
        one[name] = (
            [clean(who) for who in str(value.value).split(",")]
            if name == "operators"
            else str(value.value)
            if name == "method"
            else _written(value)
        )
    if not one["method"]:
        findings.fault("the row names no method. Write one, such as reba.", place)
        return
    kept.append(one)


def _written(given: Given) -> Any:
    """The value with the unit of its heading; degrees need none."""
    if given.unit is None or given.unit == "deg" or not isinstance(given.value, int | float):
        return given.value
    return f"{given.value:.12g} {given.unit}"
