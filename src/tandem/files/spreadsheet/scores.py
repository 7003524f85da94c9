"""Columns that look like stress and cannot be added up: scores that only rank."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import replace

from tandem.cell.names import key
from tandem.files.spreadsheet.findings import Findings
from tandem.files.spreadsheet.header import Column, Table
from tandem.files.spreadsheet.said import say

ORDINAL = re.compile(
    r"\b(rula|reba|owas|niosh|lifting index|hebeindex|cli|strain"
    r" index|ocra|kim|lmm|leitmerkmal\w*|hal|suzanne rodgers|rodgers|risk class|"
    r"risikoklasse|risikobereich|risikostufe|ampel|traffic light|borg|rpe)\b"
)
"""Methods whose numbers are grades, indices or classes of one posture, one lift or one activity."""


def without_scores(table: Table, told: Collection[str], findings: Findings) -> Table:
    """The table without the columns of stress that only rank; asked about, unless another column
    states stress or `--map` has told so.

    Args:
      told: headers and column letters that `--map` explains.
    """
    stress = table.having("stress")
    # in quotes it is somebody's name
    scores = [
        column for column in stress if ORDINAL.search(key(re.sub(r'"[^"]*"', " ", column.header)))
    ]
    others = [column for column in stress if column not in scores]
    columns = list(table.columns)
    for column in scores:
        if _is_told(column, told):
            findings.note(
                "assumed",
                say("score.told", column=repr(column.header)),
                column.place,
            )
            continue
        columns[columns.index(column)] = replace(
            column,
            meaning=None,
            why=say("why.score"),
        )
        if not others:
            findings.fault(
                f"{column.header!r} is a score that only ranks: two tasks of 3 are not one of 6, so"
                " that it cannot be added up as stress. "
                f'Leave it out with --map "{column.header}=ignore", or have it added all the same'
                f' with --map "{column.header}=stress".',
                column.place,
            )
    return replace(table, columns=tuple(columns))


def _is_told(column: Column, told: Collection[str]) -> bool:
    return bool({column.header, column.letter} & set(told)) or key(column.header) in {
        key(name) for name in told
    }
