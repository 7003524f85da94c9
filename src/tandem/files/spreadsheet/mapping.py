"""Settles what the columns of a task table mean together, and says which are not read and what was
assumed.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from difflib import get_close_matches

from tandem.cell.names import Known, key
from tandem.errors import UsageError
from tandem.files.spreadsheet.abilities import settled_abilities
from tandem.files.spreadsheet.contradictions import why_unread
from tandem.files.spreadsheet.findings import Findings, listed
from tandem.files.spreadsheet.grid import Grid, blank, shown, tidy
from tandem.files.spreadsheet.header import TASK_WORDS, Column, Table
from tandem.files.spreadsheet.precedence import MATRIX, listed_headers
from tandem.files.spreadsheet.rows import task_rows
from tandem.files.spreadsheet.said import Said, say
from tandem.files.spreadsheet.shape import refuse_values_beyond_the_header
from tandem.files.spreadsheet.stated_units import say_units
from tandem.files.spreadsheet.vocabulary import (
    Meaning,
    bound_of,
    is_kind_word,
    kind_of,
    meaning,
    own_tool,
    split_unit,
    without_scale,
)

ONCE = (
    "part",
    "tool",
    "zone",
    "place",
    "release",
    "deadline",
    "operator",
    "same operator",
    "outline number",
    "outline level",
    "milestone",
    "quantity",
)
JOINED = ("after", "after rows", "before", "wait", *MATRIX.values())
"""Lists of tasks: several columns of one kind add to each other."""


def settled(table: Table, known: tuple[str, ...], findings: Findings) -> Table:
    """The same table with one meaning for each column that is read; the others lose theirs and are
    noted.
    """
    rows = task_rows(table, Findings())
    columns = _with_known_names(table, known, findings)
    columns = _one_name_for_each_task(_numbered(columns, table, rows))
    columns = settled_abilities(columns, table, rows, findings)
    columns = _who_takes_the_time(columns, findings)
    columns = _each_meaning_once(columns, findings)
    read = replace(table, columns=tuple(columns))
    for column in columns:
        if column.meaning is None and not _nothing_in(table.grid, table, column):
            why = column.why or (why_unread(read, column, rows) if column.header else None)
            _note_unread(replace(column, why=why), findings)
        elif column.meaning and column.meaning.what == "ignore":
            findings.note(
                "column",
                say("column.ignored", column=repr(column.header)),
                column.place,
            )
    _ask_which_time_is_meant(columns, findings)
    refuse_values_beyond_the_header(table, columns, rows, findings)
    say_units(table, columns, rows, findings)
    return replace(table, columns=tuple(columns))


def overrides_from(texts: Mapping[str, str], grid: Grid | None = None) -> dict[str, Meaning | None]:
    """`--map` options as meanings: header or column letters -> what it holds, in the words that a
    header may use.

    Raises:
      UsageError: a meaning that no header could have, with the nearest that could.
    """
    found: dict[str, Meaning | None] = {}
    for header, text in texts.items():
        wanted = meaning(text) or own_tool(text, None)
        if wanted is None or wanted.what not in TASK_WORDS:
            canonical = Known(
                [*sorted(TASK_WORDS), "time robot [s]", "time human [s]", "stress human"]
            )
            raise UsageError(
                f"--map {header}={text}: no column can mean {text!r}. {canonical.hint(text)} Write"
                " for example name, label, 'time robot [s]', after, stress, 'stress anna', tool,"
                " operator or ignore."
            )
        found[header] = replace(wanted, sure=True, told=True)
    return found


def check_overrides(overrides: Mapping[str, Meaning | None], table: Table) -> None:
    """Every `--map` names a column that exists.

    Raises:
      UsageError: with the nearest header for one that does not.
    """
    headers = [column.header for column in table.columns if column.header]
    letters = {column.place.rpartition("!")[2].rstrip("0123456789") for column in table.columns}
    known = {key(text) for header in headers for text in (header, split_unit(header)[0])}
    for name in overrides:
        if name not in letters and key(name) not in known:
            raise UsageError(
                f"--map {name!r}: sheet {table.grid.name!r} has no such column."
                f" {Known(headers).hint(name)}"
            )


def _with_known_names(table: Table, known: tuple[str, ...], findings: Findings) -> list[Column]:
    """One spelling for each operator; "stress of the human" where no operator is called so is the
    stress of whoever does it.
    """
    spelled: dict[str, str] = {key(name): name for name in reversed(known)}
    for name in _names_of_operators(table):
        spelled.setdefault(key(name), name)
    settled_columns = []
    for column in table.columns:
        column = _with_scale(column, spelled, findings)
        if column.meaning is None and (tool := own_tool(column.header, tuple(spelled.values()))):
            column = replace(column, meaning=tool)
        if column.meaning and column.meaning.who:
            names = tuple(spelled.get(key(name), name) for name in column.meaning.who)
            human = column.meaning.human and spelled.get(
                key(column.meaning.human), column.meaning.human
            )
            anybody = (
                column.meaning.what != "time"
                and len(names) == 1
                and key(names[0]) not in spelled
                and kind_of(names[0]) == "human"
            )
            column = replace(
                column, meaning=replace(column.meaning, who=() if anybody else names, human=human)
            )
        settled_columns.append(column)
    return settled_columns


def _names_of_operators(table: Table) -> Iterator[str]:
    """Those whose times the headers give, and those whom the rows name."""
    for column in table.having("time"):
        yield from column.meaning.who if column.meaning else ()
    for column in table.having("operator"):
        for row in range(table.first_row, len(table.grid.rows)):
            yield from filter(
                None,
                map(
                    tidy,
                    re.split(
                        r"[/|+&,;]|\bund\b|\band\b|\boder\b|\bor\b",
                        shown(table.grid.rows[row][column.index]),
                    ),
                ),
            )


def _with_scale(column: Column, spelled: Mapping[str, str], findings: Findings) -> Column:
    """What stands in brackets behind a stress, `Stress (0-10)`, is its scale unless it names an
    operator, rightly or nearly so.
    """
    what = column.meaning
    if what is None or what.what not in ("stress", "difficulty", "spread"):
        return column
    header, scale = without_scale(column.header)
    bare = meaning(header)
    strangers = [name for name in what.who if key(name) not in spelled]
    if (
        not scale
        or what.told
        or (what.who and not strangers)
        or bare is None
        or bare.what != what.what
    ):
        return column
    if is_kind_word(scale) or get_close_matches(key(scale), list(spelled), cutoff=0.75):
        return column
    if strangers:
        findings.note(
            "assumed",
            say("scale", scale=repr(scale), column=repr(column.header)),
            column.place,
        )
    percent = bool(re.search(r"%|percent|prozent|pct", scale, re.IGNORECASE))
    return replace(column, meaning=replace(bare, percent=percent, sure=what.sure))


def _numbered(columns: list[Column], table: Table, rows: list[int]) -> list[Column]:
    """Of two columns for the task, "Step" and "Work element", the first is its number where it
    holds nothing but numbers.
    """
    roles = [column.meaning.what if column.meaning else "" for column in columns]
    if "number" in roles or "label" in roles or roles.count("task") < 2:
        return columns
    at = roles.index("task")
    column, what = columns[at], columns[at].meaning
    held = [shown(table.grid.rows[row][column.index]) for row in rows]
    if what is None or what.told or not all(re.fullmatch(r"\d+", text) for text in held):
        return columns
    columns[at] = replace(column, meaning=replace(what, what="number"))
    return columns


def _one_name_for_each_task(columns: list[Column]) -> list[Column]:
    """A number beside a description names the task; of several candidates the first is taken."""
    taken: dict[str, Column] = {}
    found = []
    for column in columns:
        role = column.meaning.what if column.meaning else ""
        if role in ("number", "task", "label"):
            if role in taken:
                column = replace(
                    column,
                    meaning=None,
                    why=say("why.already", header=repr(taken[role].header)),
                )
            else:
                taken[role] = column
        found.append(column)
    if len(taken) == 3:
        spare = taken["label"]
        unread = replace(
            spare,
            meaning=None,
            why=say("why.label", header=repr(taken["task"].header)),
        )
        found = [unread if column is spare else column for column in found]
    return found


def _who_takes_the_time(columns: list[Column], findings: Findings) -> list[Column]:
    times = [column for column in columns if column.meaning and column.meaning.what == "time"]
    wide = [column for column in times if column.meaning and column.meaning.who]
    nobody = [column for column in times if column.meaning and not column.meaning.who]
    operators = [
        column for column in columns if column.meaning and column.meaning.what == "operator"
    ]
    dropped: dict[int, Said] = {}
    if wide:
        for column in operators:
            dropped[column.index] = say("why.plan")
    if (
        nobody
        and (wide or not operators)
        and not any(c.meaning and c.meaning.what == "able" for c in columns)
    ):
        for column in nobody:
            findings.fault(
                f"{column.header!r} does not say whose time it is. Write the operator into the"
                " header, such as 'Time robot [s]', add a column 'Operator', or give --map"
                f' "{column.header}=time robot [s]" (=ignore leaves it out).',
                column.place,
            )
            dropped[column.index] = say("why.whose")
    return [
        (
            replace(column, meaning=None, why=dropped[column.index])
            if column.index in dropped
            else column
        )
        for column in columns
    ]


def _ask_which_time_is_meant(columns: list[Column], findings: Findings) -> None:
    """The least and the most that somebody needs are no time to plan with, and to leave both out
    would leave out who needs it.
    """
    planned = {
        key(name)
        for column in columns
        if column.meaning and column.meaning.what == "time"
        for name in column.meaning.who
    }
    bounds: dict[str, list[Column]] = {}
    for column in columns:
        if column.meaning is None and (name := bound_of(column.header)):
            bounds.setdefault(name, []).append(column)
    for name, several in bounds.items():
        if key(name) not in planned:
            findings.fault(
                f"{listed(repr(column.header) for column in several)}: which time of {name!r} is"
                f' the plan to count on? Say it with --map "{several[0].header}=time {name} [s]"'
                " (=ignore leaves a column out).",
                several[0].place,
            )


def _each_meaning_once(columns: list[Column], findings: Findings) -> list[Column]:
    first: dict[tuple[object, ...], Column] = {}
    found = []
    for column in columns:
        what = column.meaning
        if what is not None and what.what not in ("number", "task", "label", "ignore", *JOINED):
            same = (
                (what.what,)
                if what.what in ONCE and not what.who
                else (what.what, frozenset(what.who), what.human)
            )
            if same in first:
                other = first[same]
                findings.fault(
                    f"{column.header!r} means the same as {other.header!r}"
                    f" ({other.place.rpartition('!')[2]}): {what}. "
                    f'Rename one, or leave it out with --map "{column.header}=ignore".',
                    column.place,
                )
                column = replace(column, meaning=None, why=say("why.same"))
            else:
                first[same] = column
        found.append(column)
    for kind in ("after", "before"):
        several = [
            column
            for column in found
            if column.header and column.meaning and column.meaning.what == kind
        ]
        if len({column.header for column in several}) > 1:
            findings.note(
                "assumed",
                say("columns.together", columns=listed_headers(several)),
                several[0].place,
            )
    return found


def _nothing_in(grid: Grid, table: Table, column: Column) -> bool:
    return not column.header and all(
        blank(grid.rows[row][column.index]) for row in range(table.first_row, len(grid.rows))
    )


def _note_unread(column: Column, findings: Findings) -> None:
    letter = column.place.rpartition("!")[2].rstrip("0123456789")
    said = say(
        f"column.{'unread' if column.header else 'bare'}{'.why' if column.why else ''}",
        letter=letter,
        column=repr(column.header),
        header=column.header,
        why=column.why,
    )
    findings.note("column", said, column.place)
