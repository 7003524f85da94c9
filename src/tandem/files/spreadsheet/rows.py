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
from tandem.files.spreadsheet.values import Marks, UnreadableError, cannot, is_number, number
from tandem.files.spreadsheet.vocabulary import FIGURES, FIGURES_OF, TOTALS

ANY_MARK = Marks(".", grouped=True)
"""Good enough to see whether a row sums up those above it."""
AVERAGES = re.compile(
    r"mittelwerte?|durchschnitt|average|mean|min|max|minimum|maximum|taktzeit|cycle time",
    re.IGNORECASE,
)


TOTAL_WORDS = re.compile(
    r"\b(sub ?totals?|grand totals?|totals?|sums?|(zwischen)?summen?|gesamt\w*|insgesamt|overall)\b"
    r"|[Σ∑]",
    re.IGNORECASE,
)
"""Words within a longer name, "Total work content", "Summe Station 1": a total if its numbers are
the sums as well.
"""
PER_TIME = re.compile(r" (target|per (shift|day|hour|week)|(je|pro) (schicht|tag|stunde|woche))$")


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
    figures = _key_figures(table)
    since: list[int] = []
    for row in range(table.first_row, len(grid.rows)):
        if grid.is_blank(row):
            blanks.append(row)
            after_blank = True
            continue
        why = figures.get(row) or _no_task(table, row, rows, row > last and after_blank)
        if why is None and (why := _named_total(table, row, rows, since)):
            since = []
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
        since.append(row)
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


def _named_total(table: Table, row: int, before: list[int], since: list[int]) -> Said | None:
    """A name with a word for a total in it, and numbers that are the sums of all tasks above, or of
    those since the last such row.
    """
    text = _first_text(table, row)
    if not TOTAL_WORDS.search(text) or text[:1] == '"':
        return None
    sums = _are_sums(table, row, before) or (
        len(since) < len(before) and _are_sums(table, row, since, least=1)
    )
    return say("why.total", text=repr(text)) if sums else None


def _first_text(table: Table, row: int) -> str:
    return next((tidy(v) for _, v in table.grid.filled(row) if isinstance(v, str)), "")


def _key_figures(table: Table) -> dict[int, Said]:
    """The rows at the end of the table that are called a takt time, a shift length, a utilisation
    or alike: behind the last one that has another name and a time.
    """
    found: dict[int, Said] = {}
    for row in reversed(range(table.first_row, len(table.grid.rows))):
        text = _first_text(table, row)
        if is_a_figure(text) and not _is_numbered(table, row):
            found[row] = say("why.figure", text=repr(text))
        elif _has_a_time(table, row) and not is_total(text) and not TOTAL_WORDS.search(text):
            break
    return found


def _is_numbered(table: Table, row: int) -> bool:
    return any(is_number(table.grid.value(row, c.index)) for c in table.having("number"))


def is_a_figure(text: str) -> bool:
    """ "Takt time [s]", "Verteilzeit 10 %", "Available time": in plain words, less what stands in
    brackets, and less numbers; a name in double quotes is none.
    """
    plain = re.sub(r"[\[(][^\])]*[\])]|[\d.,%]+", " ", text.replace("Ø", " avg "))
    bare = " ".join(key(plain).split())
    words = PER_TIME.sub("", f" {bare}").split()
    if not words:
        return bool(bare)
    own = [word for place, word in enumerate(words) if place or word not in FIGURES_OF]
    reckoned = " ".join(words) in FIGURES or " ".join(own) in FIGURES
    return text[:1] != '"' and (reckoned or (own != words and own in (["time"], ["zeit"])))


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


def _are_sums(table: Table, row: int, before: list[int], least: int = 2) -> bool:
    """Every number is the sum of its column so far."""
    grid = table.grid
    if len(before) < least:
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
