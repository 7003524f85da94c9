"""A table of facts in a sheet: a row for each task and side, a column for each fact."""

from __future__ import annotations

import datetime
from dataclasses import dataclass
from typing import Any

from tandem.cell.names import key
from tandem.cell.stated import Given, meanings, with_unit
from tandem.errors import Fault
from tandem.files.spreadsheet.grid import Grid, Value, blank
from tandem.files.spreadsheet.values import Marks, UnreadableError, is_number, number
from tandem.files.spreadsheet.vocabulary import PHRASES

HEADER_WITHIN = 30
"""Rows of a sheet in which its header is looked for."""
NAMES = ("task", "number", "label")
"""What a column may be called that names the tasks, the best first."""


@dataclass(frozen=True)
class Column:
    """A column of facts: its heading without the unit, and the unit that the heading says."""

    index: int
    name: str
    unit: str | None


def header_of(grid: Grid) -> int | None:
    """The row with most headings that are understood; at least the tasks and two facts."""
    best, most = None, 2
    for row in range(min(HEADER_WITHIN, len(grid.rows))):
        heads = [str(value) for _, value in grid.filled(row) if isinstance(value, str)]
        known = sum(bool(meanings(with_unit(head)[0])) for head in heads)
        if known > most - 1 and any(_names(head) for head in heads) and known + 1 > most:
            best, most = row, known + 1
    return best


def _names(head: str) -> str | None:
    return next((what for what in NAMES if key(head) in PHRASES[what]), None)


def columns_of(grid: Grid, head: int) -> tuple[int, list[Column], list[str]]:
    """The column of the tasks, those of facts, and a remark on each other one."""
    heads = [(index, str(value)) for index, value in grid.filled(head)]
    naming = {what: index for index, text in reversed(heads) if (what := _names(text))}
    name_column = next(naming[what] for what in NAMES if what in naming)
    columns, remarks = [], []
    for index, text in heads:
        name, unit = with_unit(text)
        if index == name_column:
            continue
        if meanings(name):
            columns.append(Column(index, name, unit))
        elif index not in naming.values():
            remarks.append(f"{grid.place(head, index)}: column {text!r} is no fact, and not read.")
    return name_column, columns, remarks


def row_of(
    grid: Grid, row: int, columns: list[Column], marks: Marks, faults: list[Fault]
) -> dict[str, Given]:
    """What a row states, by the names of its columns; empty cells state nothing."""
    found: dict[str, Given] = {}
    for column in columns:
        place = grid.place(row, column.index)
        if (row, column.index) in grid.odd:
            faults.append(Fault(f"the cell {grid.odd[row, column.index]}.", place=place))
            continue
        value = grid.value(row, column.index)
        if blank(value) or value in ("-", "–"):
            continue
        found[column.name] = Given(_value(value, marks, place, faults), place, column.unit)
    return found


def _value(value: Value, marks: Marks, place: str, faults: list[Fault]) -> Any:
    if isinstance(value, datetime.datetime | datetime.date):
        return value.isoformat()[:10]
    if is_number(value):
        try:
            return float(number(value, marks).value)
        except UnreadableError as error:
            faults.append(Fault(f"the cell {error}.", place=place))
    return value.strip() if isinstance(value, str) else value


def task_named(value: Value) -> str:
    """The task that a cell names, whole numbers as their digits."""
    return (
        str(int(value)) if isinstance(value, float) and value == int(value) else str(value).strip()
    )
