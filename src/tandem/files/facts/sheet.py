"""Facts in a spreadsheet: a row for each task and side, a column for each fact."""

from __future__ import annotations

from pathlib import Path

from tandem.cell.names import clean
from tandem.cell.stated import Conditions, entry, twice
from tandem.ergonomics.facts import FactsError
from tandem.ergonomics.tasks import TaskFacts
from tandem.errors import Fault
from tandem.files.spreadsheet.facts import columns_of, header_of, row_of, task_named
from tandem.files.spreadsheet.grid import Grid
from tandem.files.spreadsheet.values import marks_of
from tandem.files.spreadsheet.workbook import open_book


def read(path: Path, whole: Conditions) -> tuple[list[TaskFacts], list[str]]:
    """The tasks of a spreadsheet with their facts, and remarks on what was not read.

    Raises:
      FactsError, CellError: it cannot be read, has no such table, or facts are wrong; with every
        fault at its cell.
    """
    book = open_book(path)
    for grid in book.grids:
        if not grid.hidden and (head := header_of(grid)) is not None:
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


def _table(grid: Grid, head: int, whole: Conditions) -> tuple[list[TaskFacts], list[str]]:
    name_column, columns, remarks = columns_of(grid, head)
    faults: list[Fault] = []
    found: list[TaskFacts] = []
    rows = [row for row in range(head + 1, len(grid.rows)) if not grid.is_blank(row)]
    marks = marks_of(grid.value(row, column.index) for row in rows for column in columns)
    for row in rows:
        task = grid.value(row, name_column)
        name = clean(task_named(task))
        given = row_of(grid, row, columns, marks, faults)
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
