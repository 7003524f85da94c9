"""Merged cells among the tasks: downwards their value counts for every row and is noted, across
columns it is refused.
"""

from __future__ import annotations

from collections.abc import Mapping

from tandem.files.spreadsheet.findings import Findings, listed
from tandem.files.spreadsheet.grid import blank, letters
from tandem.files.spreadsheet.header import Column, Table
from tandem.files.spreadsheet.said import enumerated, say

NAMES = ("number", "task", "label")
"""A name may reach over its neighbours; nothing is lost by it."""


def say_what_is_merged(table: Table, tasks: Mapping[int, str], findings: Findings) -> None:
    """Notes and faults about the merged areas of the rows that hold tasks.

    Args:
      tasks: row -> the task that it belongs to.
    """
    read = {
        column.index: column
        for column in table.columns
        if column.meaning and column.meaning.what != "ignore"
    }
    downwards = []
    for top, left, bottom, right in dict.fromkeys(
        table.grid.spread_of(row, column) for row in tasks for column in read
    ):
        if (top, left) == (bottom, right) or blank(table.grid.rows[top][left]):
            continue
        where = f"{letters(left)}{top + 1}:{letters(right)}{bottom + 1}"
        covered = [
            column
            for index, column in read.items()
            if left < index <= right and not _names_tasks(column)
        ]
        if covered:
            said = listed(
                repr(column.header)
                for column in (*([read[left]] if left in read else []), *covered)
            )
            findings.fault(
                f"is merged over {where}, so it is not clear what it says of {said}. Split the"
                " cells and fill in each.",
                table.grid.place(top, left),
            )
        elif (
            left in read
            and not _names_tasks(read[left])
            and len(
                {
                    tasks[row]
                    for row in range(top, min(bottom + 1, len(table.grid.rows)))
                    if row in tasks
                }
            )
            > 1
        ):
            downwards.append(where)
    if downwards:
        findings.note(
            "assumed",
            say("merged", cells=enumerated(downwards)),
            f"{table.grid.name}!{downwards[0]}",
        )


def _names_tasks(column: Column) -> bool:
    return column.meaning is not None and column.meaning.what in NAMES
