"""Columns of who can do what: 1 and 0, TRUE and FALSE, or crosses under the operators' names. They
are no times.
"""

from __future__ import annotations

from tandem.cell.names import key
from tandem.files.spreadsheet.findings import Findings, listed
from tandem.files.spreadsheet.grid import Grid, blank
from tandem.files.spreadsheet.header import Column, Table
from tandem.files.spreadsheet.said import say
from tandem.files.spreadsheet.values import says_able
from tandem.files.spreadsheet.vocabulary import Meaning


def settled_abilities(
    columns: list[Column], table: Table, rows: list[int], findings: Findings
) -> list[Column]:
    """Columns that hold abilities mean "able"; the times then come from the one column that names
    nobody, and are asked for without it.
    """
    able = [column for column in columns if _holds_abilities(column, table, rows)]
    if not able:
        return columns
    times = [
        column
        for column in columns
        if column.meaning and column.meaning.what == "time" and column not in able
    ]
    by_row = [column for column in columns if column.meaning and column.meaning.what == "operator"]
    names = listed(repr(column.header) for column in able)
    one_time = len(times) == 1 and times[0].meaning is not None and not times[0].meaning.who
    if one_time and not by_row:
        findings.note(
            "assumed",
            say("able", columns=names, time=repr(times[0].header)),
            able[0].place,
        )
    else:
        asked = " ".join(f'--map "{column.header}=time {column.header} [s]"' for column in able)
        findings.fault(
            f"{names}: nothing but 1 and 0 (or TRUE and FALSE, x) stands there, so it is who can do"
            " what, not how long it takes. Write the times there, or have them in one column"
            f" beside, such as 'Time [s]'. If the times really are 1: {asked} (=ignore leaves it"
            " out).",
            able[0].place,
        )
    return [
        (
            Column(c.index, c.header, c.place, Meaning("able", c.meaning.who))
            if c in able and c.meaning
            else c
        )
        for c in columns
    ]


def _holds_abilities(column: Column, table: Table, rows: list[int]) -> bool:
    """The header names operators and nothing else, and below it there are only marks."""
    said = [
        ability_at(table.grid, row, column.index)
        for row in rows
        if not blank(table.grid.value(row, column.index))
    ]
    return names_only_operators(column) and any(said) and None not in said


def names_only_operators(column: Column) -> bool:
    """The header of a column that might hold times says neither time nor unit, but who; `--map` has
    not said what it is.
    """
    what = column.meaning
    if what is None or what.what != "time" or not what.who or what.unit or what.told:
        return False
    names = {word for name in what.who for word in key(name).split()}
    return set(key(column.header).split()) == names


def ability_at(grid: Grid, row: int, column: int) -> bool | None:
    """Whether a sheet cell says that somebody can do it; None when it holds no mark. A number with
    words in its format is none.
    """
    return (
        None
        if (grid.origin(row, column), column) in grid.words
        else says_able(grid.value(row, column))
    )
