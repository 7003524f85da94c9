"""Numbers that stand for "cannot" in a column of times: 9999 or 1000000, which who fills in tables
for a solver writes so that nobody takes the task.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from tandem.files.spreadsheet.findings import Findings
from tandem.files.spreadsheet.grid import Value, shown
from tandem.files.spreadsheet.header import Column, Table
from tandem.files.spreadsheet.tasks import unit_of
from tandem.files.spreadsheet.values import UnreadableError, number

LOOKS_SO = re.compile(r"9{3,}(\.9+)?|10{4,}")
"""All nines, or a one and at least four zeros."""
SO_MANY_TIMES = 20
"""As long as any other time of the table: no task is likely to be."""


@dataclass(frozen=True)
class Time:
    """What one cell holds: as it stands there, and in seconds."""

    value: Value
    seconds: float
    place: str
    column: Column


def looks_like_a_stand_in(amount: str) -> bool:
    """The digits are such as nobody measures: "999", "9999.99", "100000"."""
    return LOOKS_SO.fullmatch(amount) is not None


def ask_about_stand_ins(table: Table, rows: list[int], findings: Findings) -> None:
    """A fault for each such number that is far above all other times of the table. Behind a number
    its unit says that it is a time.
    """
    times = list(_times(table, rows, findings))
    doubtful = {time for time in times if _may_stand_in(time.value, findings)}
    longest = max((time.seconds for time in times if time not in doubtful), default=0.0)
    for time in times:
        if time in doubtful and 0 < longest * SO_MANY_TIMES <= time.seconds:
            text, unit = shown(time.value), unit_of(table, time.column)
            findings.fault(
                f"holds {text}, and no other time of the table is longer than {longest:g} s: is it"
                " a time, or does it say that the task cannot be done so? Write - or leave the cell"
                f" empty if it cannot; write the unit behind it, '{text} {unit}', if it is a time.",
                time.place,
            )


def _times(table: Table, rows: list[int], findings: Findings) -> Iterator[Time]:
    """Every time that is stated, merged ones once; what cannot be read is told elsewhere."""
    grid, aside = table.grid, Findings(marks=findings.marks)
    for column in table.having("time"):
        told = column.meaning is not None and column.meaning.told and bool(column.meaning.unit)
        for row in dict.fromkeys(grid.origin(row, column.index) for row in rows):
            seconds = aside.time(
                grid, row, column.index, unit_of(table, column), told=told, durations=True
            )
            if seconds is not None:
                place = grid.place(row, column.index)
                yield Time(grid.value(row, column.index), seconds, place, column)


def _may_stand_in(value: Value, findings: Findings) -> bool:
    try:
        found = number(value, findings.marks)
    except UnreadableError:  # a duration such as 0:01:30
        return False
    return not found.unit and looks_like_a_stand_in(f"{found.value.normalize():f}")
