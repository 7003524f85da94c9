"""The rows below a header: which are tasks, and which are totals, headings, remarks and blanks that
are left out and listed.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from tandem.cell.names import key
from tandem.files.spreadsheet.findings import Findings
from tandem.files.spreadsheet.grid import Grid, blank, shown, tidy
from tandem.files.spreadsheet.header import Table
from tandem.files.spreadsheet.said import Said, enumerated, say
from tandem.files.spreadsheet.values import Marks, UnreadableError, cannot, number
from tandem.files.spreadsheet.vocabulary import TOTALS

ANY_MARK = Marks(".", grouped=True)
"""Good enough to see whether a row sums up those above it."""
AVERAGES = re.compile(
    r"mittelwerte?|durchschnitt|average|mean|min|max|minimum|maximum|taktzeit|cycle time",
    re.IGNORECASE,
)


def task_rows(table: Table, findings: Findings) -> list[int]:
    """Row numbers, from 0, of the rows that hold a task or a further way of doing it; the others
    are noted.
    """
    grid = table.grid
    rows: list[int] = []
    blanks: list[int] = []
    last = max(
        (row for row in range(table.first_row, len(grid.rows)) if _has_a_time(table, row)),
        default=-1,
    )
    after_blank = False
    for row in range(table.first_row, len(grid.rows)):
        if grid.is_blank(row):
            blanks.append(row)
            after_blank = True
            continue
        why = _no_task(table, row, rows, row > last and after_blank)
        if why:
            findings.note(
                "row",
                say("row.unread", row=row + 1, why=why),
                grid.place(row, next((c for c, _ in grid.filled(row)), 0)),
            )
            continue
        if row in grid.hidden_rows:
            findings.note(
                "assumed",
                say("row.hidden", row=row + 1),
                grid.place(row, 0),
            )
        rows.append(row)
    if inner := [row + 1 for row in blanks if rows and row < rows[-1]]:
        findings.note("row", say("row.blank", rows=enumerated(inner)), grid.place(inner[0] - 1, 0))
    return rows


def _no_task(table: Table, row: int, before: list[int], below_all: bool) -> Said | None:
    """Why the row is no task, or None."""
    grid = table.grid
    filled = list(grid.filled(row))
    texts = [tidy(value) for _, value in filled if isinstance(value, str)]
    if _is_called_a_total(table, row, before):
        return say("why.total", text=repr(texts[0]))
    if _repeats_header(table, row):
        return say("why.repeats")
    if _sums_up(table, row, before):
        return say("why.sums")
    if len(filled) != 1 or not texts or any(r == row for r, _ in grid.odd):
        return None
    _, left, _, right = grid.spread_of(row, filled[0][0])
    if right > left:
        return say("why.heading", text=repr(texts[0]))
    if _is_named_by_halves(table, filled[0][0]):
        return say("why.section", text=repr(texts[0]))
    if below_all:
        return say("why.alone", text=repr(texts[0]))
    return None


def _is_named_by_halves(table: Table, column: int) -> bool:
    """The column is one of a number and a name that every task with a time has both of: a text that
    stands there alone heads the tasks below it.
    """
    grid = table.grid
    naming = [c.index for c in (*table.having("number"), *table.having("task", "label")[:1])]
    timed = [row for row in range(table.first_row, len(grid.rows)) if _has_a_time(table, row)]
    return (
        len(naming) == 2
        and column in naming
        and len(timed) > 1
        and not any(blank(grid.value(row, index)) for row in timed for index in naming)
    )


def _is_called_a_total(table: Table, row: int, before: list[int]) -> bool:
    """The first word of the row says so; behind a name of its own, as in "14 | Summe", only if its
    numbers are the sums as well.
    """
    grid = table.grid
    filled = list(grid.filled(row))
    first, value = next(
        ((column, value) for column, value in filled if isinstance(value, str)), (-1, "")
    )
    if not is_total(str(value)):
        return False
    words = {column.index for column in table.having("number", "task", "label")}
    return first == filled[0][0] or (
        first in words
        and bool(TOTALS.fullmatch(_bare(str(value))))
        and _are_sums(table, row, before)
    )


def is_total(text: str) -> bool:
    """A word that stands before a total or an average instead of a task's name."""
    return bool(TOTALS.fullmatch(_bare(text)) or AVERAGES.fullmatch(_bare(text)))


def _bare(text: str) -> str:
    return tidy(text).rstrip(":. ")


def _has_a_time(table: Table, row: int) -> bool:
    return any(
        (row, c.index) in table.grid.odd or not cannot(table.grid.value(row, c.index))
        for c in table.having("time")
    )


def _repeats_header(table: Table, row: int) -> bool:
    filled = dict(table.grid.filled(row))
    own = [column.index for column in table.columns if column.index in filled]
    header = table.grid.rows[table.header_row]
    words = ((key(shown(filled[index])), index) for index in own)
    return len(own) >= 2 and all(
        word and word == key(shown(header[index])) for word, index in words
    )


def _sums_up(table: Table, row: int, before: list[int]) -> bool:
    """No name, no label, and every number is the sum of its column so far."""
    grid = table.grid
    names = table.having("number", "task", "label", "operator")
    return all(blank(grid.value(row, column.index)) for column in names) and _are_sums(
        table, row, before
    )


def _are_sums(table: Table, row: int, before: list[int]) -> bool:
    """Every number is the sum of its column so far."""
    grid = table.grid
    if len(before) < 2:
        return False
    sums = [
        (column, _number(grid, row, column.index))
        for column in table.having("time", "stress")
        if not blank(grid.rows[row][column.index])
    ]
    totals = [sum(_number(grid, r, column.index) or 0.0 for r in before) for column, _ in sums]
    pairs = [(value, total) for (_, value), total in zip(sums, totals, strict=True)]
    return bool(pairs) and all(
        value is not None and abs(value - total) < 1e-6 * max(1.0, total) for value, total in pairs
    )


def _number(grid: Grid, row: int, column: int) -> float | None:
    try:
        return float(number(grid.rows[row][column], ANY_MARK).value)
    except UnreadableError:
        return None


def values_below(table: Table, index: int) -> Iterator[object]:
    """Everything in a column below the header."""
    return (table.grid.rows[row][index] for row in range(table.first_row, len(table.grid.rows)))
