"""Says in which units the times of a table are: of the header, of a line of the sheet, or of the
cells themselves.
"""

from __future__ import annotations

import re
from contextlib import suppress

from tandem.cell.names import key
from tandem.files.spreadsheet.findings import Findings, listed
from tandem.files.spreadsheet.grid import blank, letters, tidy
from tandem.files.spreadsheet.header import TIMED, Column, Table
from tandem.files.spreadsheet.said import say
from tandem.files.spreadsheet.units import other_work_said, unclear_unit
from tandem.files.spreadsheet.values import (
    UnreadableError,
    cannot,
    duration,
    is_number,
    number,
    unit_named,
    written,
)
from tandem.files.spreadsheet.vocabulary import KINDS, PER_PIECE, QUOTES, kind_of, split_unit

UNIT_COLUMN = re.compile(
    r"|\w*einheit(en)?|(time )?units?( of (time|measure))?|uom|me|dim(ension)?"
)
"""How a column of units is called; it may have no header at all."""


PER_SOMETHING = re.compile(
    r"\b(?:per|je|pro)\b\s*(?:\d+\s*[^\W\d_]{2,}|(?!(?:task|vorgang|arbeitsgang|operation|step|schritt"
    r"|activity|element|person|worker|werker|operator|bediener|mitarbeiter|human|mensch|robot|roboter"
    r"|cobot|product|produkt|assembly|baugruppe|workpiece|werkst(?:ü|ue)ck|station)s?\b)[^\W\d_]{2,})",
    re.IGNORECASE,
)
"""A time of ten, of a screw, of an order: "per 10 pcs", "je Schraube"."""

SHORT = 5
"""Seconds; where all tasks are shorter, their times are rather minutes."""


def say_units(table: Table, columns: list[Column], rows: list[int], findings: Findings) -> None:
    """Where the unit of each column of times comes from, when its header does not say; refused
    where the sheet speaks of several.
    """
    timed = [column for column in columns if column.meaning and column.meaning.what in TIMED]
    for column in timed:
        _refuse_an_unclear_unit(column, findings)
    _refuse_a_line_that_contradicts(table, timed, findings)
    _refuse_a_line_of_other_work(table, timed, findings)
    _refuse_a_column_of_units(table, columns, timed, rows, findings)
    for column in timed:
        _note_units_of_cells(table, column, rows, findings)
    silent = [
        c
        for c in timed
        if c.meaning
        and not c.meaning.unit
        and (_bare_numbers(table, c, rows) or not _units_of_cells(table, c, rows))
    ]
    names = listed(repr(column.header) for column in silent)
    if silent and table.unit:
        findings.note("assumed", say("unit.line", unit=table.unit), silent[0].place)
    elif silent and table.doubt:
        message = (
            f"no unit is stated for {names}, and none can be assumed beside {table.doubt}. Write"
            " the unit into the header."
        )
        findings.fault(message, silent[0].place)
    elif silent:
        longest = _longest(table, silent, rows, findings)
        short = 0 < longest < SHORT
        said = say("unit.short" if short else "unit.none", columns=names, longest=longest)
        findings.note("assumed", said, silent[0].place)


def _longest(table: Table, columns: list[Column], rows: list[int], findings: Findings) -> float:
    """The largest number of the columns; 0 where there is none that can be read."""
    longest = 0.0
    for column in columns:
        for row in _bare_numbers(table, column, rows):
            with suppress(UnreadableError):
                value = number(table.grid.value(row, column.index), findings.marks)
                longest = max(longest, float(value.value))
    return longest


def _refuse_an_unclear_unit(column: Column, findings: Findings) -> None:
    """A header such as "Time human [0.1 min]" states a unit, and none that is known."""
    what = column.meaning
    header = QUOTES.sub(" ", column.header)
    header = PER_PIECE.sub(" ", header) if what is not None and what.per_piece else header
    of_many = PER_SOMETHING.search(header)
    if of_many and what is not None and what.what == "time" and not what.told:
        message = (
            f"{column.header!r}: {tidy(of_many[0])!r} is neither a task nor a piece. Write the time"
            " of the whole task, or 'per piece' beside a column 'Quantity', or say what it is with"
            f' --map "{letters(column.index)}=time human [s]".'
        )
        findings.fault(message, column.place)
        return
    odd = unclear_unit(split_unit(header)[0])
    if odd and what is not None and not (what.told and what.unit):
        message = (
            f"{column.header!r}: {odd!r} is no one unit that Tandem knows. Write [s], [min], [h],"
            " [ms], [1/100 min] or [TMU], or say it "
            f'with --map "{letters(column.index)}=... [s]". A name goes outside the brackets.'
        )
        findings.fault(message, column.place)


def _refuse_a_line_that_contradicts(table: Table, timed: list[Column], findings: Findings) -> None:
    """ "all times in min" above headers that say [s]: one of the two is forgotten from before."""
    contradicted: dict[str, list[Column]] = {}
    for column in timed:
        what = column.meaning
        stated = what.unit if what and what.what == "time" and not what.told else None
        if stated and table.unit and stated != table.unit and _speaks_of(table.unit_line, column):
            contradicted.setdefault(stated, []).append(column)
    for unit, columns in contradicted.items():
        who = " + ".join(columns[0].meaning.who) if columns[0].meaning else ""
        told = " ".join(filter(None, (f"{columns[0].letter}=time", who)))
        findings.fault(
            f"{listed(repr(column.header) for column in columns)}: [{unit}] stands here, and"
            f" {table.unit_line} says {table.unit}. Mend the one that is wrong, or say the unit of"
            f' the column with --map "{told} [{unit}]".',
            columns[0].place,
        )


def _refuse_a_line_of_other_work(table: Table, timed: list[Column], findings: Findings) -> None:
    """ "Zeiten je Los" above the table: its times are not those of a task."""
    line, words = other_work_said(table.grid, table.header_row, table.first_row)
    columns = [c for c in timed if c.meaning and c.meaning.what == "time" and not c.meaning.told]
    if line and columns:
        first = columns[0]
        who = " + ".join(first.meaning.who) if first.meaning else ""
        told = " ".join(filter(None, (f"{first.letter}=time", who)))
        findings.fault(
            f"{line} speaks of times {words!r}, and a plan needs those of the task as it will be"
            " done. Write these into the columns and take the line out, or say of each column"
            f' that it holds them: --map "{told} [s]".',
            first.place,
        )


def _speaks_of(line: str, column: Column) -> bool:
    """The line is about all times, or about those of the column's operator, for all that is known:
    "Robot times in s" says nothing of the human's.
    """
    words = key(line).split()
    named = {
        kind
        for name, kind in KINDS.items()
        if len(name) > 3 and any(word.startswith(name) for word in words)
    }
    who = column.meaning.who if column.meaning else ()
    return not named or not who or any(kind_of(name) in (None, *named) for name in who)


def _refuse_a_column_of_units(
    table: Table, columns: list[Column], timed: list[Column], rows: list[int], findings: Findings
) -> None:
    """Units that stand row by row in a column of their own, unless they only repeat what the
    headers say.
    """
    for column in columns:
        values = [value for row in rows if not blank(value := table.grid.value(row, column.index))]
        units = {unit_named(value) if isinstance(value, str) else None for value in values}
        if column.meaning is not None or not units or None in units:
            continue
        stated = {(c.meaning.unit if c.meaning else None) or table.unit for c in timed}
        if stated != units and UNIT_COLUMN.fullmatch(key(column.header)):
            message = (
                f"{column.header!r} holds units, and the times are not read by it. Write the unit"
                " into the headers of the times."
            )
            findings.fault(message, table.grid.place(rows[0], column.index))


def _note_units_of_cells(table: Table, column: Column, rows: list[int], findings: Findings) -> None:
    """Units behind numbers, or in their formats, count more than the header; where it states none,
    the bare ones among them have none.
    """
    own = _units_of_cells(table, column, rows)
    unit = (column.meaning.unit if column.meaning else None) or table.unit
    others = {row: name for row, name in own.items() if name != unit}
    bare = _bare_numbers(table, column, rows)
    if own and bare and not unit:
        first = next(iter(own))
        there = f"{letters(column.index)}{first + 1}"
        message = (
            f"has no unit, {there} has {own[first]}, and the header {column.header!r} has none."
            " Write the unit into the header."
        )
        findings.fault(message, table.grid.place(bare[0], column.index))
    elif others:
        cells = listed(f"{letters(column.index)}{row + 1} {name}" for row, name in others.items())
        findings.note(
            "assumed",
            say("unit.cells", column=repr(column.header), cells=cells),
            column.place,
        )


def _units_of_cells(table: Table, column: Column, rows: list[int]) -> dict[int, str]:
    """Row -> the unit of time that its own cell states, be it as text or by its number format."""
    told = column.meaning is not None and column.meaning.told and column.meaning.unit is not None
    found = {}
    for row in rows:
        value = table.grid.value(row, column.index)
        typed = written(value) if isinstance(value, str) else None
        shown_with = (
            ""
            if told
            else table.grid.words.get((table.grid.origin(row, column.index), column.index), "")
        )
        if duration(value):
            found[row] = "h:mm:ss"
        elif unit := (typed.unit if typed else None) or unit_named(shown_with):
            found[row] = unit
    return found


def _bare_numbers(table: Table, column: Column, rows: list[int]) -> list[int]:
    """Rows whose cell is a number, other than 0, without a unit of its own."""
    own = _units_of_cells(table, column, rows)
    values = ((row, table.grid.value(row, column.index)) for row in rows)
    return [
        row for row, value in values if row not in own and is_number(value) and not cannot(value)
    ]
