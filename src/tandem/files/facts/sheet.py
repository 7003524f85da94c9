"""Facts in a spreadsheet: a row for each task and side, a column for each fact."""

from __future__ import annotations

import datetime
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tandem.cell.names import clean, key
from tandem.cell.stated import Conditions, Given, entry, meanings, twice, with_unit
from tandem.ergonomics.facts import FactsError
from tandem.ergonomics.tasks import TaskFacts
from tandem.errors import Fault
from tandem.files.spreadsheet.grid import Grid, Value, blank
from tandem.files.spreadsheet.values import Marks, UnreadableError, is_number, marks_of, number
from tandem.files.spreadsheet.vocabulary import PHRASES
from tandem.files.spreadsheet.workbook import open_book

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


def read(path: Path, whole: Conditions) -> tuple[list[TaskFacts], list[str]]:
    """The tasks of a spreadsheet with their facts, and remarks on what was not read.

    Raises:
      FactsError, CellError: it cannot be read, has no such table, or facts are wrong; with every
        fault at its cell.
    """
    book = open_book(path)
    for grid in book.grids:
        if not grid.hidden and (head := _header(grid)) is not None:
            return _table(grid, head, whole)
    raise FactsError(
        [
            Fault(
                "no sheet has a header with the tasks and their facts. Head one column `task` (or"
                " Vorgang), one `method` (or Methode), and others by facts, such as `trunk [°]`;"
                " `tandem score --template facts.xlsx` writes one to fill in.",
                place=path.name,
            )
        ]
    )


def _header(grid: Grid) -> int | None:
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


def _table(grid: Grid, head: int, whole: Conditions) -> tuple[list[TaskFacts], list[str]]:
    name_column, columns, remarks = _columns(grid, head)
    faults: list[Fault] = []
    found: list[TaskFacts] = []
    rows = [row for row in range(head + 1, len(grid.rows)) if not grid.is_blank(row)]
    marks = marks_of(grid.value(row, column.index) for row in rows for column in columns)
    for row in rows:
        task = grid.value(row, name_column)
        name = clean(_named(task))
        given = _row(grid, row, columns, marks, faults)
        if not name:
            if given:
                faults.append(
                    Fault(
                        "the row has facts but no task. Name the task.",
                        place=grid.place(row, name_column),
                    )
                )
            continue
        if not given:
            remarks.append(f"{grid.place(row, name_column)}: {name!r} has no facts.")
            continue
        one, wrong = entry(name, given, grid.place(row, name_column), whole)
        faults += wrong
        found += [one] if one is not None else []
    if not found and not faults:
        faults.append(Fault("no row below the header has facts.", place=grid.place(head, 0)))
    faults += twice(found)
    if faults:
        raise FactsError(faults)
    return found, remarks


def _columns(grid: Grid, head: int) -> tuple[int, list[Column], list[str]]:
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


def _row(
    grid: Grid, row: int, columns: list[Column], marks: Marks, faults: list[Fault]
) -> dict[str, Given]:
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


def _named(value: Value) -> str:
    return (
        str(int(value)) if isinstance(value, float) and value == int(value) else str(value).strip()
    )
