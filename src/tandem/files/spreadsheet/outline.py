"""Rows of the task sheet that are no work of their own: summaries of the rows below them, and
milestones.

Project tools export both. A summary's time is the time of its parts once more, and what comes after
it comes after each part; a milestone takes no time and passes on what comes before it.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from tandem.cell.names import key
from tandem.files.spreadsheet.findings import Findings, listed
from tandem.files.spreadsheet.grid import Grid, blank, shown
from tandem.files.spreadsheet.header import Column, Table
from tandem.files.spreadsheet.precedence import Link, is_mark
from tandem.files.spreadsheet.said import say

CODE = re.compile(r"[^\W_]+(\.[^\W_]+)*\.?")
"""The number of an outline: 1, 1.2, A.3.1."""
LEADING = re.compile(r"(\d+(?:\.\d+)*)\.?\s")
"""The number of an outline before the words of a name: "1.2 Drive screws"."""
MILESTONE = re.compile(r"\b(milestone|meilenstein)")
MOST_LEVELS = 50
"""Levels of an outline; more are no outline that anybody made."""
MOST_LINKS = 200_000
TOO_MANY = (
    f"makes more than {MOST_LINKS:,} links between the parts of summaries or beside milestones."
    " Link single tasks instead."
)


@dataclass(frozen=True)
class Row:
    """One entry of the task sheet, as far as the outline goes.

    Attributes:
      name: of the task; in quotes in the sheet when `quoted`, which says that it is a task whatever
        its name looks like.
      row: counted from 0.
      times: column -> seconds, of the times that are stated.
      zero: a time of 0 is written, and none other.
    """

    name: str
    row: int
    quoted: bool
    times: Mapping[int, float] = field(default_factory=dict)
    zero: bool = False


@dataclass(frozen=True)
class Outline:
    """What is no work.

    Attributes:
      parts: summary -> the tasks and milestones at the ends of its branches, in the order of the
        sheet.
      points: milestones.
    """

    parts: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    points: frozenset[str] = frozenset()

    def __contains__(self, name: str) -> bool:
        return name in self.parts or name in self.points


def with_outline(table: Table) -> Table:
    """The table with the outline's numbers as the names of tasks where nothing else numbers them,
    or where the lists of tasks use them.
    """
    numbers, codes = table.having("number"), table.having("outline number")
    if not codes or (numbers and not _lists_use(table, codes[0])):
        return table
    columns = (
        (
            replace(column, meaning=replace(column.meaning, what="number"))
            if column is codes[0] and column.meaning
            else (
                replace(column, meaning=None, why=say("why.codes", header=repr(codes[0].header)))
                if column in numbers
                else column
            )
        )
        for column in table.columns
    )
    return replace(table, columns=tuple(columns))


def _lists_use(table: Table, codes: Column) -> bool:
    """A code of several levels stands in a list of tasks."""
    rows = table.grid.rows[table.first_row :]
    known = {shown(row[codes.index]) for row in rows if "." in shown(row[codes.index])}
    lists = " ".join(
        shown(row[column.index]) for row in rows for column in table.having("after", "before")
    )
    return any(piece in known for piece in re.findall(r"[\w.]+", lists))


def outline_codes(table: Table, rows: Sequence[Row]) -> dict[str, str]:
    """Name -> the number that the outline gives it: its own, the one that it begins with, or that
    of a column beside it.
    """
    columns = table.having("outline number")
    if not columns:
        return {
            row.name: found[1] if (found := LEADING.match(row.name)) else row.name for row in rows
        }
    return {
        row.name: code
        for row in rows
        if (code := shown(table.grid.value(row.row, columns[0].index)))
    }


# --- which rows -----------------------------------------------------------------------------------


def branches(table: Table, rows: Sequence[Row]) -> tuple[dict[str, tuple[str, ...]], bool]:
    """Summary -> all rows below it, and whether a column made for that says so (else the names or
    the indents do, which may deceive).
    """
    for levels, certain in ((_stated_levels(table, rows), True), (_indents(table, rows), False)):
        if levels is not None:
            return _by_level(rows, levels), certain
    return _by_code(rows, outline_codes(table, rows)), bool(
        table.having("outline number")
    ) or _is_code_column(table)


def _is_code_column(table: Table) -> bool:
    return any(
        key(column.header)
        in ("wbs", "psp", "psp code", "wbs code", "outline number", "gliederungsnummer")
        for column in table.having("number")
    )


def _stated_levels(table: Table, rows: Sequence[Row]) -> list[int] | None:
    columns = table.having("outline level")
    if not columns:
        return None
    texts = [shown(table.grid.value(row.row, columns[0].index)) for row in rows]
    return (
        [int(text) for text in texts]
        if all(text.isdecimal() and len(text) < 3 for text in texts)
        else None
    )


def _indents(table: Table, rows: Sequence[Row]) -> list[int] | None:
    """Blanks before the names or descriptions, or the indents of their cells, if they differ and
    the first row has the least.
    """
    for column in table.having("task", "label", "number"):
        found = [_indent(table.grid, row.row, column.index) for row in rows]
        if 1 < len(set(found)) <= MOST_LEVELS and found[0] == min(found):
            return found
    return None


def _indent(grid: Grid, row: int, column: int) -> int:
    value = grid.value(row, column)
    return grid.indents.get((row, column), 0) + (
        len(value) - len(value.lstrip()) if isinstance(value, str) else 0
    )


def _by_level(rows: Sequence[Row], levels: Sequence[int]) -> dict[str, tuple[str, ...]]:
    found = {}
    for place, row in enumerate(rows):
        end = next(
            (other for other in range(place + 1, len(rows)) if levels[other] <= levels[place]),
            len(rows),
        )
        if end > place + 1:
            found[row.name] = tuple(below.name for below in rows[place + 1 : end])
    return found


def _by_code(rows: Sequence[Row], codes: Mapping[str, str]) -> dict[str, tuple[str, ...]]:
    shallow = {
        name: code
        for name, code in codes.items()
        if code.count(".") < MOST_LEVELS and CODE.fullmatch(code)
    }
    plain = {row.name: shallow[row.name].rstrip(".") for row in rows if row.name in shallow}
    by_code = {code: name for name, code in plain.items()}
    found: dict[str, list[str]] = {}
    for row in rows:
        pieces = plain.get(row.name, "").split(".")
        for length in range(1, len(pieces)):
            above = by_code.get(".".join(pieces[:length]))
            if above is not None:
                found.setdefault(above, []).append(row.name)
    return {row.name: tuple(found[row.name]) for row in rows if row.name in found}


# --- what they are --------------------------------------------------------------------------------


def read_outline(table: Table, rows: Sequence[Row], findings: Findings) -> Outline:
    """The summaries and milestones among the rows. A row that is above others but takes time of its
    own is a fault.
    """
    below, certain = branches(table, rows)
    by_name = {row.name: row for row in rows}
    below = {name: under for name, under in below.items() if not by_name[name].quoted}
    points = frozenset(
        row.name for row in rows if row.name not in below and _is_milestone(table, row)
    )
    parts: dict[str, tuple[str, ...]] = {}
    for name, under in below.items():
        ends = tuple(part for part in under if part not in below)
        parts[name] = ends
        _note_summary(table, by_name[name], [by_name[end] for end in ends], certain, findings)
    for row in rows:
        if row.name in points:
            said = say("milestone", row=row.row + 1, name=repr(row.name))
            findings.note("row", said, table.grid.place(row.row, 0))
    return Outline(parts, points)


def _is_milestone(table: Table, row: Row) -> bool:
    if row.times:
        return False
    for column in table.having("milestone"):
        if (marked := is_mark(table.grid.value(row.row, column.index))) is not None:
            return marked
    words = " ".join(
        shown(table.grid.value(row.row, column.index))
        for column in table.having("number", "task", "label")
    )
    return row.zero or bool(MILESTONE.search(key(words)))


def _note_summary(
    table: Table, row: Row, ends: Sequence[Row], certain: bool, findings: Findings
) -> None:
    place = table.grid.place(row.row, 0)
    names = listed((end.name for end in ends), 12)
    odd = next(_own_times(row, ends, certain), None)
    if odd is not None:
        index, own, parts = odd
        findings.fault(
            f"task {row.name!r} stands above {names} like their sum, but takes {own:g} s where they"
            f" add up to {parts:g} s. If it is their "
            "summary, clear its time or let it be the sum; if it is work of its own, write its"
            f' name in double quotes: "{row.name}".',
            table.grid.place(row.row, index),
        )
        return
    unread = [
        c.header
        for c in table.having("tool", "zone", "place", "part", "stress")
        if not blank(table.grid.value(row.row, c.index))
    ]
    number = "one" if len(unread) == 1 else "other"
    left_out = say(f"summary.unread.{number}", columns=listed(map(repr, unread)))
    said = say(
        "summary",
        row=row.row + 1,
        name=repr(row.name),
        sums=say("summary.sum" if row.times else "summary.stands"),
        names=names,
        left_out=left_out if unread else "",
    )
    findings.note("row", said, place)
    for column in table.having("release", "deadline", "same operator", "wait"):
        if not blank(table.grid.value(row.row, column.index)):
            at = table.grid.place(row.row, column.index)
            findings.fault(
                f"stands beside {row.name!r}, a summary of {names}. Write it beside those of them"
                " that it holds for.",
                at,
            )


def _own_times(row: Row, ends: Sequence[Row], certain: bool) -> Iterator[tuple[int, float, float]]:
    """Times that are no sum of the parts: column, own time, sum. A tool's own summary may also lie
    between the longest part and the sum.
    """
    for column, own in row.times.items():
        times = [end.times.get(column, 0.0) for end in ends]
        near = 1e-3 * (len(times) + 1)
        is_sum = abs(own - sum(times)) <= near
        if not (is_sum or (certain and max(times) - near <= own <= sum(times) + near)):
            yield column, own, sum(times)


# --- what comes before what -----------------------------------------------------------------------


def between_tasks(links: Iterable[Link], outline: Outline, findings: Findings) -> list[Link]:
    """The links with each summary replaced by its parts, and each milestone by what comes before
    it.
    """
    found: dict[tuple[str, str], Link] = {}
    for link in links:
        firsts, laters = (outline.parts.get(name, (name,)) for name in (link.first, link.later))
        if (link.first in outline.parts or link.later in outline.parts) and set(firsts) & set(
            laters
        ):
            findings.fault(
                f"puts {link.later!r} after {link.first!r}, though one is a part of the other. Name"
                " the parts.",
                link.place,
            )
            continue
        if len(found) + len(firsts) * len(laters) > MOST_LINKS:
            findings.fault(TOO_MANY, link.place)
            return []
        for first in firsts:
            for later in laters:
                found.setdefault((first, later), Link(first, later, link.place))
    return _without_points(list(found.values()), outline.points, findings)


def _without_points(
    links: Sequence[Link], points: Collection[str], findings: Findings
) -> list[Link]:
    """The links that are left when each milestone hands what comes before it to what comes after
    it.
    """
    before: dict[str, dict[str, Link]] = {}
    after: dict[str, dict[str, Link]] = {}
    for link in links:
        before.setdefault(link.later, {})[link.first] = link
        after.setdefault(link.first, {})[link.later] = link
    count = len(links)
    for point in points:
        firsts, laters = before.pop(point, {}), after.pop(point, {})
        if (itself := firsts.pop(point, None)) is not None:
            laters.pop(point, None)
            findings.fault(
                f"puts milestone {point!r} after itself. Take one of the links out.", itself.place
            )
        count += len(firsts) * len(laters)
        if count > MOST_LINKS:
            findings.fault(TOO_MANY, next(iter(laters.values())).place)
            return []
        for first in firsts:
            after[first].pop(point, None)
            for later, link in laters.items():
                before[later].pop(point, None)
                joined = Link(first, later, link.place)
                before[later].setdefault(first, joined)
                after[first].setdefault(later, joined)
        for later in laters:
            before.get(later, {}).pop(point, None)
    return [
        link
        for later in before
        for link in before[later].values()
        if not {link.first, link.later} & set(points)
    ]
