"""Columns of who can do what: 1 and 0, TRUE and FALSE, or crosses under the operators' names. They are no times."""

from __future__ import annotations

from collections.abc import Iterable

from tandem.cell.spreadsheet.findings import Findings, listed
from tandem.cell.spreadsheet.grid import Value, blank
from tandem.cell.spreadsheet.header import Column, Table
from tandem.cell.spreadsheet.values import says_able
from tandem.cell.spreadsheet.words import Meaning, key


def settled_abilities(columns: list[Column], table: Table, rows: list[int], findings: Findings) -> list[Column]:
    """Columns that hold abilities mean "able"; the times then come from the one column that names nobody, and are asked for without it."""
    able = [column for column in columns if _holds_abilities(column, table, rows)]
    if not able:
        return columns
    times = [column for column in columns if column.meaning and column.meaning.what == "time" and column not in able]
    by_row = [column for column in columns if column.meaning and column.meaning.what == "operator"]
    names = listed(repr(column.header) for column in able)
    one_time = len(times) == 1 and times[0].meaning is not None and not times[0].meaning.who
    if one_time and not by_row:
        findings.note("assumed", f"{names} say who can do a task; each of them takes the time in {times[0].header!r}.", able[0].place)
    else:
        asked = " ".join(f'--map "{column.header}=time {column.header} [s]"' for column in able)
        findings.fault(
            f"{names}: nothing but 1 and 0 (or TRUE and FALSE, x) stands there, so it is who can do what, not how long it takes. Write the times "
            f"there, or have them in one column beside, such as 'Time [s]'. If the times really are 1: {asked} (=ignore leaves it out).",
            able[0].place,
        )
    return [Column(c.index, c.header, c.place, Meaning("able", c.meaning.who)) if c in able and c.meaning else c for c in columns]


def _holds_abilities(column: Column, table: Table, rows: list[int]) -> bool:
    """The header names operators and says neither time nor unit, and below it there are only marks."""
    what = column.meaning
    if what is None or what.what != "time" or not what.who or what.unit or what.told:
        return False
    names = {word for name in what.who for word in key(name).split()}
    return set(key(column.header).split()) == names and _only_marks(_values(column, table, rows))


def _only_marks(values: Iterable[Value]) -> bool:
    said = [says_able(value) for value in values if not blank(value)]
    return any(said) and None not in said


def _values(column: Column, table: Table, rows: list[int]) -> list[Value]:
    """What stands in the tasks' rows; a number with a unit in its format is no mark."""
    grid = table.grid
    return [grid.value(row, column.index) if (row, column.index) not in grid.words else "number" for row in rows]
