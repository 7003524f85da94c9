"""Columns that look like stress and cannot be added up: scores that only rank. They are added, or
kept as scores of their method, only where somebody says so.
"""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import replace

from tandem.cell.names import key
from tandem.cell.stated import SIDED
from tandem.files.spreadsheet.findings import Findings
from tandem.files.spreadsheet.header import Column, Table
from tandem.files.spreadsheet.said import say
from tandem.files.spreadsheet.vocabulary import Meaning

ORDINAL = re.compile(
    r"\b(rula|reba|owas|niosh|lifting index|hebeindex|cli|strain"
    r" index|ocra|kim|lmm|leitmerkmal\w*|hal|suzanne rodgers|rodgers|risk class|"
    r"risikoklasse|risikobereich|risikostufe|ampel|traffic light|borg|rpe)\b"
)
"""Methods whose numbers are grades, indices or classes of one posture, one lift or one activity."""


METHODS = (
    (r"rula", "rula"), (r"reba", "reba"), (r"niosh|lifting index|hebeindex", "niosh"),
    (r"strain index", "strain_index_1995"), (r"ocra", "ocra"),
    (r"kim|lmm|leitmerkmal\w*", "kim"), (r"hal", "hal_tlv"),
)  # fmt: skip
"""Words of a header, and the method on whose scale its numbers are."""
AGGREGATES = ("sum", "peak", "time-weighted", "time-above", "ignore")
"""What a column of scores may be taken for: added up all the same; kept as scores of its method, of
which a plan minds the highest, the mean weighted by time, or the time above a level; or left out.
"""
SCORE = "score "
"""How the meaning of a column begins that is kept as scores; the method follows."""


def method_of(header: str) -> str | None:
    """The method whose scores a header promises; None when none here has such a scale."""
    return next(
        (name for words, name in METHODS if re.search(rf"\b({words})\b", key(header))), None
    )


def without_scores(
    table: Table, told: Collection[str], findings: Findings, aggregate: str | None = None
) -> Table:
    """The table without the columns of stress that only rank; asked about, unless another column
    states stress, or `--map` or `--aggregate` has told so.

    Args:
      told: headers and column letters that `--map` explains.
      aggregate: one of `AGGREGATES`, for all such columns.
    """
    stress = table.having("stress")
    # in quotes it is somebody's name
    scores = [
        column for column in stress if ORDINAL.search(key(re.sub(r'"[^"]*"', " ", column.header)))
    ]
    others = [column for column in stress if column not in scores]
    columns = list(table.columns)
    for column in scores:
        if _is_told(column, told) or aggregate == "sum":
            findings.note(
                "assumed",
                say("score.told", column=repr(column.header)),
                column.place,
            )
            continue
        place = columns.index(column)
        columns[place] = replace(column, meaning=None, why=say("why.score"))
        if aggregate == "ignore":
            continue
        if aggregate is not None and (method := method_of(column.header)) is not None:
            columns[place] = replace(column, meaning=Meaning(SCORE + method, _people(column)))
            measure = f"{aggregate}:{method}" + ":LEVEL" * (aggregate == "time-above")
            findings.note(
                "assumed",
                say("score.kept", column=repr(column.header), method=method, measure=measure),
                column.place,
            )
            continue
        if aggregate is not None:
            findings.fault(
                f"{column.header!r} is on no scale that is known here, so that --aggregate"
                f" {aggregate} cannot keep it. Leave it out with --map"
                f' "{column.header}=ignore".',
                column.place,
            )
        elif not others:
            findings.fault(
                f"{column.header!r} is a score that only ranks: two tasks of 3 are not one of 6, so"
                " that it cannot be added up as stress. "
                "Say what is meant: --aggregate peak, time-weighted or time-above keeps the scores"
                " for a plan that minds their highest, their mean by time, or the time above a"
                f' level. Leave it out with --map "{column.header}=ignore", or have it added all'
                f' the same with --map "{column.header}=stress".',
                column.place,
            )
    return replace(table, columns=tuple(columns))


def _people(column: Column) -> tuple[str, ...]:
    """Of whom the header speaks; "rechts" is a side and nobody."""
    named = () if column.meaning is None else column.meaning.who
    return tuple(
        who
        for who in named
        if not any(re.fullmatch(words, who, re.IGNORECASE) for _, words in SIDED)
    )


def _is_told(column: Column, told: Collection[str]) -> bool:
    return bool({column.header, column.letter} & set(told)) or key(column.header) in {
        key(name) for name in told
    }
