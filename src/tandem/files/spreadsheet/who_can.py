"""A sheet beside the times that says who can do which task, as 1 and 0: it takes away the times of
those who cannot.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from tandem.cell.names import key
from tandem.files.spreadsheet.abilities import ability_at, names_only_operators
from tandem.files.spreadsheet.findings import Findings, listed
from tandem.files.spreadsheet.grid import shown
from tandem.files.spreadsheet.header import Column, Table
from tandem.files.spreadsheet.references import References, unquoted
from tandem.files.spreadsheet.said import enumerated, say
from tandem.files.spreadsheet.vocabulary import Meaning


def is_table_of_abilities(table: Table) -> bool:
    """Every column of times is named by nothing but an operator and holds nothing but marks, as 1
    and 0.
    """
    columns = table.having("time")
    if not columns or table.unit or not all(map(_is_bare, columns)):
        return False
    said = [
        ability_at(table.grid, row, column.index)
        for column in columns
        for row in range(table.first_row, len(table.grid.rows))
    ]
    return any(said) and None not in said


def _is_bare(column: Column) -> bool:
    return (
        names_only_operators(column) and column.meaning is not None and len(column.meaning.who) == 1
    )


def with_time_of_each(table: Table, abilities: Sequence[Table]) -> Table:
    """The table with its one time for everybody as the time of each operator whom a sheet of
    abilities names.
    """
    columns = table.having("time")
    if (
        not abilities
        or table.having("operator")
        or len(columns) != 1
        or columns[0].meaning is None
        or columns[0].meaning.who
    ):
        return table
    names = list(
        dict.fromkeys(
            name
            for able in abilities
            for column in able.having("time")
            if column.meaning
            for name in column.meaning.who
        )
    )
    spread: list[Column] = []
    for column in table.columns:
        what = column.meaning
        spread += (
            [replace(column, meaning=replace(what, who=(name,))) for name in names]
            if what and column is columns[0]
            else [column]
        )
    return replace(table, columns=tuple(spread))


def restrict(tasks: dict[str, dict[str, Any]], table: Table, findings: Findings) -> None:
    """Takes the times away from those who cannot do a task, and says so; times that are missing,
    and tasks that are not listed, are faults.
    """
    naming = next(
        table.having(what)[0]
        for what in ("number", "task", "label", "outline number")
        if table.having(what)
    )
    references = References(
        list(tasks), {task["label"]: name for name, task in tasks.items() if "label" in task}
    )
    missing = dict.fromkeys(tasks)
    taken: dict[str, list[str]] = {}
    for row in range(table.first_row, len(table.grid.rows)):
        if table.grid.is_blank(row):
            continue
        text = unquoted(shown(table.grid.value(row, naming.index)))
        name = references.task(text)
        if name is None:
            findings.fault(
                f"holds {text!r}, which is no task.", table.grid.place(row, naming.index)
            )
            continue
        missing.pop(name, None)
        for column in table.having("time"):
            _restrict_one(tasks, name, table, row, column, taken, findings)
    for who, cells in taken.items():
        findings.note(
            "cannot",
            say("who.cannot", who=who, sheet=repr(table.grid.name), tasks=enumerated(cells)),
            table.grid.place(table.header_row, 0),
        )
    if missing:
        those = f"{'task' if len(missing) == 1 else 'tasks'} {listed(map(repr, missing))}"
        findings.fault(
            f"does not say who can do {those}. Add a row, or take the sheet away.",
            f"{table.grid.name}!A1",
        )
    if not findings.faults:
        findings.note(
            "assumed",
            say("who.sheet", sheet=repr(table.grid.name)),
            table.grid.place(table.header_row, 0),
        )


def _restrict_one(
    tasks: dict[str, dict[str, Any]],
    name: str,
    table: Table,
    row: int,
    column: Column,
    taken: dict[str, list[str]],
    findings: Findings,
) -> None:
    meaning = column.meaning or Meaning("time")
    times = tasks[name].get("time", {})
    who = next((own for own in times if key(own) == key(meaning.who[0])), None)
    place = table.grid.place(row, column.index)
    able = ability_at(table.grid, row, column.index)
    if able and who is None:
        findings.fault(
            f"says that {meaning.who[0]!r} can do task {name!r}, for which no time of"
            f" {meaning.who[0]!r} is stated.",
            place,
        )
    elif not able and who is not None:
        del times[who]
        findings.places["tasks", name, "time"] = place
        taken.setdefault(who, []).append(f"{name} ({place.rpartition('!')[2]})")
