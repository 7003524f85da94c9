"""The task sheet: a table in, the `tasks` of a cell document out. One row a task, or one row for
each operator who can do it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from tandem.cell.stated import SIDED
from tandem.files.spreadsheet.findings import AS_FRACTION, AS_SHOWN, Findings, Percent
from tandem.files.spreadsheet.grid import Grid, Value, shown
from tandem.files.spreadsheet.header import LISTS, Column, Table
from tandem.files.spreadsheet.joint import WhoError, people_in, ways
from tandem.files.spreadsheet.merged import say_what_is_merged
from tandem.files.spreadsheet.no_work import ask_what_is_no_work
from tandem.files.spreadsheet.outline import (
    MOST_LINKS,
    Outline,
    Row,
    between_tasks,
    outline_codes,
    read_outline,
)
from tandem.files.spreadsheet.precedence import (
    Link,
    listed_headers,
    matrix_links,
    sentence,
    sheet_links,
)
from tandem.files.spreadsheet.references import References, UnknownTaskError, task_name, unquoted
from tandem.files.spreadsheet.rows import task_rows
from tandem.files.spreadsheet.said import Said, enumerated, say
from tandem.files.spreadsheet.scores import SCORE
from tandem.files.spreadsheet.values import cannot, says_able
from tandem.files.spreadsheet.waits import Written, read_waits, wait_of, without_lags

TEXTS = ("part", "tool", "zone", "place")
STAND_IN = 1.0
"""A time to check a task with when its own is a fault; it never leaves this room."""


@dataclass
class Entry:
    """One task under construction.

    Attributes:
      rows: counted from 0; several where each operator has one.
      quoted: its name stands in double quotes.
      data: its part of the cell document.
      times: column -> seconds, of the times that its rows state; the longest where several do.
    """

    name: str
    rows: list[int]
    quoted: bool = False
    data: dict[str, Any] = field(default_factory=dict)
    times: dict[int, float] = field(default_factory=dict)


@dataclass
class Tasks:
    """What a task table holds, as parts of a cell document.

    Attributes:
      operators: named by the columns or rows, in order of appearance, with the place where each was
        first named.
      linked: something says what comes before what, or fails to.
      people: everybody whom this table or other sheets name.
      paired: the pairs of `same_operator`, to know them again.
    """

    tasks: dict[str, dict[str, Any]] = field(default_factory=dict)
    same_operator: list[list[str]] = field(default_factory=list)
    operators: dict[str, str] = field(default_factory=dict)
    linked: bool = False
    people: list[str] = field(default_factory=list)
    paired: set[tuple[str, str]] = field(default_factory=set)


def read_tasks(
    table: Table, findings: Findings, beside: Sequence[Grid] = (), known: Sequence[str] = ()
) -> Tasks:
    """Every task of the table; what is wrong goes to `findings`.

    Args:
      beside: sheets that may say what comes before what.
      known: operators that other sheets name.
    """
    found = Tasks(people=people_in(table, known))
    name, label = _naming(table)
    rows = task_rows(table, findings)
    if not rows:
        findings.fault("has a header but no task below it.", table.grid.place(table.header_row, 0))
    long_form = bool(table.having("operator")) and not any(
        column.meaning and column.meaning.who for column in table.having("time")
    )
    entries = _entries(table, rows, name, label, long_form, findings)
    outline = _outline(table, entries, long_form, findings)
    work = [entry for entry in entries if entry.name not in outline]
    for entry in work:
        _texts(table, entry, label if label is not name else None, findings)
        (_long_times if long_form else _wide_times)(table, entry, found, findings)
        _measures(table, entry, long_form, found.people, findings)
        _own_tools(table, entry, long_form, found.people, findings)
        found.tasks[entry.name] = entry.data
        findings.places["tasks", entry.name] = table.grid.place(
            entry.rows[0], name.index if name else table.columns[0].index
        )
    _pieces(table, findings)
    _cannot(table, work, findings)
    _percentages(table, work, findings)
    say_what_is_merged(
        table, {row: entry.name for entry in entries for row in entry.rows}, findings
    )
    _lists(table, entries, name is None, outline, found, findings, beside)
    named = [Row(entry.name, entry.rows[0], entry.quoted) for entry in work]
    ask_what_is_no_work(named, found.tasks, findings)
    return found


def _outline(table: Table, entries: list[Entry], long_form: bool, findings: Findings) -> Outline:
    """The entries that are summaries or milestones, told by their place and their times; faults in
    the times are told when they are read.
    """
    aside = Findings(marks=findings.marks)
    zero = set()
    for entry in entries:
        for column in table.having("time"):
            cells = [table.grid.value(row, column.index) for row in entry.rows]
            times = [_time(table, row, column, aside) for row in entry.rows]
            if stated := [time for time in times if time is not None]:
                entry.times[column.index] = max(stated)
            nobody = long_form and not any(
                aside.text(table.grid, row, table.having("operator")[0].index) for row in entry.rows
            )
            if nobody and all(shown(value)[:1] == "0" for value in cells):
                zero.add(entry.name)
    rows = [
        Row(entry.name, entry.rows[0], entry.quoted, entry.times, entry.name in zero)
        for entry in entries
    ]
    return read_outline(table, rows, findings)


def _naming(table: Table) -> tuple[Column | None, Column | None]:
    """The columns of names and of labels. A number names the task; its text is then the label."""
    numbers, words, labels = table.having("number"), table.having("task"), table.having("label")
    if numbers:
        return numbers[0], (words or labels or (None,))[0]
    if words:
        return words[0], (labels or (None,))[0]
    return None, labels[0] if labels else None


def _entries(
    table: Table,
    rows: list[int],
    name: Column | None,
    label: Column | None,
    long_form: bool,
    findings: Findings,
) -> list[Entry]:
    entries: dict[str, Entry] = {}
    last: Entry | None = None
    for row in rows:
        written = findings.text(table.grid, row, name.index) if name else ""
        text = unquoted(written)
        said = findings.text(table.grid, row, label.index) if label else ""
        if (
            long_form
            and last
            and not text
            and (
                name
                or not said
                or said == findings.text(table.grid, last.rows[0], label.index if label else None)
            )
        ):
            last.rows.append(row)
            continue
        if not name:
            text = str(len(entries) + 1) if said else ""
        if not text:
            naming = (name or label or table.columns[0]).index
            place = table.grid.place(row, naming)
            if (row, naming) in table.grid.odd:  # which has been told
                continue
            findings.fault(
                "is empty: the row has values and no task. Give the task a name, or clear the row.",
                place,
            )
            continue
        if text in entries:
            if long_form:
                entries[text].rows.append(row)
                last = entries[text]
                continue
            first, here = (
                table.grid.place(r, name.index if name else 0) for r in (entries[text].rows[0], row)
            )
            findings.fault(
                f"task {text!r} stands here a second time, the first is {first}. Give each task a"
                " name of its own.",
                here,
            )
            continue
        last = entries[text] = Entry(task_name(text), [row], text != written)
    return list(entries.values())


def _texts(table: Table, entry: Entry, label: Column | None, findings: Findings) -> None:
    texts = [column for column in table.having(*TEXTS) if not _is_of_somebody(column)]
    columns = [*texts, *([label] if label else [])]
    for column in columns:
        what = column.meaning.what if column is not label and column.meaning else "label"
        text = next(
            (text for row in entry.rows if (text := findings.text(table.grid, row, column.index))),
            "",
        )
        if text and not (what != "label" and text in NO_TOOL):
            entry.data[what] = text
            findings.places["tasks", entry.name, what] = table.grid.place(
                entry.rows[0], column.index
            )
    for column in table.having("release", "deadline"):
        what = column.meaning.what if column.meaning else ""
        moment = _time(table, entry.rows[0], column, findings, zero=what == "release")
        if moment is not None and not (what == "release" and moment == 0):
            entry.data[what] = moment
            findings.places["tasks", entry.name, what] = table.grid.place(
                entry.rows[0], column.index
            )


def unit_of(table: Table, column: Column) -> str:
    """The unit of a column of times: its own, the sheet's, or seconds."""
    return (column.meaning.unit if column.meaning else None) or table.unit or "s"


def _time(
    table: Table, row: int, column: Column, findings: Findings, *, zero: bool = False
) -> float | None:
    """Seconds in a column of times, those of all pieces together; None for "cannot" and for
    faults.
    """
    told = column.meaning is not None and column.meaning.told and column.meaning.unit is not None
    durations = column.meaning is not None and column.meaning.what == "time"
    time = findings.time(
        table.grid,
        row,
        column.index,
        unit_of(table, column),
        zero=zero,
        told=told,
        durations=durations,
    )
    if (
        time is None
        or not column.meaning
        or not column.meaning.per_piece
        or not (quantities := table.having("quantity"))
    ):
        return time
    faults = len(findings.faults)
    pieces = findings.amount(table.grid, row, quantities[0].index, "a number of pieces")
    if len(findings.faults) > faults:
        return None
    if not pieces:
        place = table.grid.place(row, quantities[0].index)
        findings.fault(
            f"does not say how many pieces there are, though {column.header!r} is the time of one."
            " Write a number of 1 or more.",
            place,
        )
        return None
    return round(time * pieces, 3)


def _pieces(table: Table, findings: Findings) -> None:
    """Says what became of times per piece and of numbers of pieces."""
    each = [
        column for column in table.having("time") if column.meaning and column.meaning.per_piece
    ]
    quantities = table.having("quantity")
    if each and quantities:
        findings.note(
            "assumed",
            say("piece.times", columns=listed_headers(each), quantity=repr(quantities[0].header)),
            each[0].place,
        )
    elif each:
        findings.note("assumed", say("piece.one", columns=listed_headers(each)), each[0].place)
    elif quantities:
        findings.note(
            "column",
            say("piece.whole", column=repr(quantities[0].header)),
            quantities[0].place,
        )


# --- one column for each operator -----------------------------------------------------------------


def _wide_times(table: Table, entry: Entry, found: Tasks, findings: Findings) -> None:
    row = entry.rows[0]
    for column in table.having("time"):
        who = column.meaning.who if column.meaning else ()
        if not who:
            continue
        for name in who:
            found.operators.setdefault(name, column.place)
        time = _time(table, row, column, findings)
        if time is not None:
            _way(entry, who, time, table.grid.place(row, column.index), findings)
    _able_ways(table, entry, found, findings)
    _stand_in(table, entry, found, findings)


def _able_ways(table: Table, entry: Entry, found: Tasks, findings: Findings) -> None:
    """Everybody whom a column of abilities marks takes the one time of the task."""
    able = table.having("able")
    common = [
        column
        for column in table.having("time")
        if able and column.meaning and not column.meaning.who
    ]
    time = _time(table, entry.rows[0], common[0], findings) if common else STAND_IN
    for column in able:
        who = column.meaning.who if column.meaning else ()
        for name in who:
            found.operators.setdefault(name, column.place)
        if time is not None and says_able(
            findings.value(table.grid, entry.rows[0], column.index) or ""
        ):
            _way(entry, who, time, table.grid.place(entry.rows[0], column.index), findings)


def _way(entry: Entry, who: tuple[str, ...], time: float, place: str, findings: Findings) -> None:
    if len(who) == 1:
        if who[0] in entry.data.setdefault("time", {}):
            findings.fault(
                f"gives task {entry.name!r} a second time of {who[0]!r}. Keep one of them.", place
            )
        entry.data["time"][who[0]] = time
        findings.places["tasks", entry.name, "time", who[0]] = place
    else:
        ways = entry.data.setdefault("together", [])
        findings.places["tasks", entry.name, "together", len(ways)] = place
        ways.append({"operators": list(who), "time": time})


def _stand_in(table: Table, entry: Entry, found: Tasks, findings: Findings) -> None:
    """A task whose times are all faulty gets one to be checked with, so that "nobody can do it" is
    not said on top.
    """
    if entry.data.get("time") or entry.data.get("together"):
        return
    faulty = {fault.place for fault in findings.faults}
    if any(
        table.grid.place(row, column.index) in faulty
        for row in entry.rows
        for column in table.having("time", "operator", "quantity")
    ):
        who = next(iter(found.operators), "human")
        found.operators.setdefault(who, "")
        entry.data["time"] = {who: STAND_IN}


def _cannot(table: Table, entries: list[Entry], findings: Findings) -> None:
    """Says for each operator which tasks a 0 or an empty cell has taken away."""
    for column in table.having("time", "able"):
        if not column.meaning or (not column.meaning.who and not table.having("operator", "able")):
            continue
        missing = [
            (entry.name, row)
            for entry in entries
            for row in entry.rows
            if (row, column.index) not in table.grid.odd
            and _says_cannot(table.grid.value(row, column.index), column)
        ]
        if missing:
            who = " + ".join(column.meaning.who) or (
                "nobody" if table.having("able") else "the operator of the row"
            )
            cells = [_as_seen(table, name, row, column) for name, row in missing]
            findings.note("cannot", say("cannot", who=who, tasks=enumerated(cells)), column.place)


def _says_cannot(value: Value, column: Column) -> bool:
    return (
        cannot(value)
        if column.meaning and column.meaning.what == "time"
        else says_able(value) is False
    )


def _as_seen(table: Table, task: str, row: int, column: Column) -> Said:
    """The task, and what stands in its row."""
    cell = table.grid.place(row, column.index).rpartition("!")[2]
    if text := shown(table.grid.value(row, column.index)):
        return say("cannot.cell", task=task, cell=cell, value=text)
    return say("cannot.empty", task=task, cell=cell)


# --- one row for each operator --------------------------------------------------------------------


def _long_times(table: Table, entry: Entry, found: Tasks, findings: Findings) -> None:
    who_column, time_column = table.having("operator")[0], table.having("time")[0]
    for row in entry.rows:
        place = table.grid.place(row, who_column.index)
        text = findings.text(table.grid, row, who_column.index)
        time = _time(table, row, time_column, findings)
        if not text:
            if time is not None:
                findings.fault(
                    f"is empty: nobody is named for the time of task {entry.name!r}.", place
                )
            continue
        for who in _alternatives(text, place, found.people, findings):
            for name in who:
                found.operators.setdefault(name, place)
            if time is not None:
                _way(entry, who, time, table.grid.place(row, time_column.index), findings)
    _stand_in(table, entry, found, findings)


def _alternatives(
    text: str, place: str, people: Sequence[str], findings: Findings
) -> list[tuple[str, ...]]:
    try:
        return ways(text, people)
    except WhoError as error:
        findings.fault(f"holds {text!r}, which {error}.", place)
        return []


# --- stress and the other measures ----------------------------------------------------------------


def _measures(
    table: Table, entry: Entry, long_form: bool, people: Sequence[str], findings: Findings
) -> None:
    for column in table.having("stress", "difficulty", "spread"):
        if column.meaning is None:
            continue
        what, who, human = column.meaning.what, column.meaning.who, column.meaning.human
        if long_form and not who and what == "stress" and len(entry.rows) > 1:
            _stress_by_row(table, entry, column, people, findings)
            continue
        amount = findings.amount(
            table.grid, entry.rows[0], column.index, f"a number for {what}", _percent(column)
        )
        if amount is None:
            continue
        place = table.grid.place(entry.rows[0], column.index)
        if len(who) > 1:
            _joint_stress(entry, who, human, amount, place, findings)
        elif who:
            _per_operator(entry, what, who[0], amount, place, column, findings)
        else:
            if isinstance(entry.data.get(what), dict):
                findings.fault(
                    f"gives {what} of everybody although task {entry.name!r} has one for each. Keep"
                    " one of the two.",
                    place,
                )
                continue
            entry.data[what] = amount
            findings.places["tasks", entry.name, what] = place
    _scores(table, entry, findings)


def _scores(table: Table, entry: Entry, findings: Findings) -> None:
    """Numbers of columns that are kept as scores of a method: a side or a person that the header
    names belongs to them.
    """
    for column in table.columns:
        if column.meaning is None or not column.meaning.what.startswith(SCORE):
            continue
        amount = findings.amount(
            table.grid, entry.rows[0], column.index, "a number for a score", None
        )
        if amount is None:
            continue
        kept = entry.data.setdefault("ergonomics", [])
        place = table.grid.place(entry.rows[0], column.index)
        findings.places["tasks", entry.name, "ergonomics", len(kept)] = place
        one: dict[str, Any] = {"method": column.meaning.what.removeprefix(SCORE), "score": amount}
        if column.meaning.who:
            one["operators"] = list(column.meaning.who)
        sides = [side for side, words in SIDED if re.search(words, column.header, re.IGNORECASE)]
        if len(sides) == 1:
            one["side"] = sides[0]
        kept.append(one)


def _percent(column: Column) -> Percent | None:
    """How numbers under "[%]" count: a spread is a fraction of the time, all else is taken as it is
    shown.
    """
    if column.meaning is None or not column.meaning.percent:
        return None
    return AS_FRACTION if column.meaning.what == "spread" else AS_SHOWN


def _per_operator(
    entry: Entry, what: str, who: str, amount: float, place: str, column: Column, findings: Findings
) -> None:
    values = entry.data.setdefault(what, {})
    if not isinstance(values, dict):
        findings.fault(
            f"gives {what} of {who!r} although task {entry.name!r} has one number for all. Keep one"
            " of the two.",
            place,
        )
        return
    values[who] = amount
    findings.places["tasks", entry.name, what, who] = place


def _joint_stress(
    entry: Entry, who: tuple[str, ...], human: str, amount: float, place: str, findings: Findings
) -> None:
    for way in entry.data.get("together", ()):
        if set(way["operators"]) == set(who):
            stated = way.get("stress")
            if stated is not None and isinstance(stated, dict) != bool(human):
                both = (
                    f"task {entry.name!r} has one number for all of {' + '.join(who)} and one for"
                    f" {human or next(iter(stated))!r} alone"
                )
                findings.fault(f"gives stress a second time: {both}. Keep one of the two.", place)
            elif human:
                way["stress"] = {**(stated or {}), human: amount}
            else:
                way["stress"] = amount
            return
    findings.fault(
        f"gives stress of {' + '.join(who)}, who have no time for task {entry.name!r} together. Add"
        " the time, or clear the cell.",
        place,
    )


def _is_of_somebody(column: Column) -> bool:
    return column.meaning is not None and bool(column.meaning.who)


def _own_tools(
    table: Table, entry: Entry, long_form: bool, people: Sequence[str], findings: Findings
) -> None:
    """Tools that not all who do the task need: a column of their own, or a row of their own."""
    for column in table.having("tool"):
        if column.meaning is None:
            continue
        if not column.meaning.who:
            if long_form and len(entry.rows) > 1:
                _tools_by_row(table, entry, column, people, findings)
            continue
        text = findings.text(table.grid, entry.rows[0], column.index)
        if text:
            place = table.grid.place(entry.rows[0], column.index)
            _own_tool(entry, column.meaning.who, column.meaning.human, text, place, findings)


def _tools_by_row(
    table: Table, entry: Entry, column: Column, people: Sequence[str], findings: Findings
) -> None:
    """One tool for all rows, or each its own."""
    who_column = table.having("operator")[0]
    by_row = {row: findings.text(table.grid, row, column.index) for row in entry.rows}
    if len(set(by_row.values())) == 1:
        return
    entry.data.pop("tool", None)
    for row, text in by_row.items():
        said, here = findings.text(table.grid, row, who_column.index), Findings()
        place = table.grid.place(row, column.index)
        for who in _alternatives(said, place, people, here):
            _own_tool(entry, who, "", text or "-", place, findings)


def _own_tool(
    entry: Entry, who: tuple[str, ...], one: str, tool: str, place: str, findings: Findings
) -> None:
    """The tool of one operator, of a group, or of `one` within the group; "-" says none."""
    if len(who) == 1:
        stated = entry.data.setdefault("tool", {})
        if not isinstance(stated, dict):
            findings.fault(
                f"gives a tool of {who[0]!r} although task {entry.name!r} has one for all. Keep one"
                " of the two.",
                place,
            )
        elif tool not in NO_TOOL:
            stated[who[0]] = tool
            findings.places["tasks", entry.name, "tool", who[0]] = place
        return
    for number, way in enumerate(entry.data.get("together", ())):
        if set(way["operators"]) == set(who):
            stated = way.get("tool")
            if stated is not None and isinstance(stated, dict) != (bool(one) or tool in NO_TOOL):
                findings.fault(
                    f"gives a tool a second time: {' + '.join(who)} have one for all of them in"
                    f" task {entry.name!r}. Keep one of the two.",
                    place,
                )
            elif tool in NO_TOOL:
                way.setdefault("tool", {})
            else:
                way["tool"] = {**(stated or {}), one: tool} if one else tool
            findings.places["tasks", entry.name, "together", number, "tool"] = place
            return
    findings.fault(
        f"gives a tool of {' + '.join(who)}, who have no time for task {entry.name!r} together. Add"
        " the time, or clear the cell.",
        place,
    )


NO_TOOL = ("-", "–", "—", "/")
"""What says that no tool is needed."""


def _stress_by_row(
    table: Table, entry: Entry, column: Column, people: Sequence[str], findings: Findings
) -> None:
    """One number for all rows, or one for each: those of the joint rows go to the joint ways."""
    who_column = table.having("operator")[0]
    by_row = {
        row: amount
        for row in entry.rows
        if (
            amount := findings.amount(
                table.grid, row, column.index, "a number for stress", _percent(column)
            )
        )
        is not None
    }
    if not by_row:
        return
    findings.places["tasks", entry.name, "stress"] = table.grid.place(
        next(iter(by_row)), column.index
    )
    if len(by_row) == 1 or len(set(by_row.values())) == 1:
        entry.data["stress"] = next(iter(by_row.values()))
        return
    for row, amount in by_row.items():
        for who in _alternatives(
            findings.text(table.grid, row, who_column.index),
            table.grid.place(row, who_column.index),
            people,
            Findings(),
        ):
            if len(who) > 1:
                _joint_stress(entry, who, "", amount, table.grid.place(row, column.index), findings)
            elif amount:
                _per_operator(
                    entry,
                    "stress",
                    who[0],
                    amount,
                    table.grid.place(row, column.index),
                    column,
                    findings,
                )


def _percentages(table: Table, entries: list[Entry], findings: Findings) -> None:
    """Says how percentages were understood, and refuses a column that mixes them with plain
    numbers.
    """
    for column in table.having("stress", "difficulty", "spread"):
        cells = [
            (table.grid.origin(row, column.index), column.index)
            for entry in entries
            for row in entry.rows
        ]
        marked = [cell for cell in cells if table.grid.words.get(cell) == "%"]
        plain = [
            cell
            for cell in cells
            if table.grid.words.get(cell) != "%" and not cannot(table.grid.rows[cell[0]][cell[1]])
        ]
        if not marked:
            continue
        if not _percent(column) and plain:
            here, there = table.grid.place(*plain[0]), table.grid.place(*marked[0])
            findings.fault(
                f"is no percentage, and {there} is one. Write the column {column.header!r} in one"
                " way.",
                here,
            )
        value = table.grid.rows[marked[0][0]][marked[0][1]]
        size = findings.amount(table.grid, *marked[0], "a number", _percent(column))
        if isinstance(value, int | float) and size is not None:
            findings.note(
                "assumed",
                say(
                    "percent",
                    column=repr(column.header),
                    percent=f"{value * 100:.15g}",
                    size=f"{size:.15g}",
                ),
                column.place,
            )


# --- lists of tasks -------------------------------------------------------------------------------


def _lists(
    table: Table,
    entries: list[Entry],
    counted: bool,
    outline: Outline,
    found: Tasks,
    findings: Findings,
    beside: Sequence[Grid],
) -> None:
    """Everything that links tasks: the lists in the columns, a matrix, sheets of pairs, and who
    must be done by the same operator.
    """
    names = [entry.name for entry in entries]
    labels, several = _labels(table, entries)
    rows = {entry.name: entry.rows[0] + 1 for entry in entries}
    codes = outline_codes(
        table, [Row(entry.name, entry.rows[0], entry.quoted) for entry in entries]
    )
    known = {**labels, **{code: name for name, code in codes.items()}}
    unread = {**_unread_numbers(table, entries), **several}
    links: list[Link] = []
    already = len(findings.faults)
    for column in table.having(*LISTS):
        what = column.meaning.what if column.meaning else ""
        references = References(names, known, rows, counted, unread=unread)
        references.agree_on_numbers(
            [table.grid.value(row, column.index) for entry in entries for row in entry.rows],
            what == "after rows",
        )
        if references.said:
            findings.note(
                "assumed",
                say("numbers.column", column=repr(column.header), reading=references.said),
                column.place,
            )
        for entry in entries:
            for row in entry.rows:
                links += _list(table, entry, row, column, what, references, found, findings)
                if len(links) + len(found.same_operator) > MOST_LINKS:
                    findings.fault(
                        f"brings the references to other tasks to more than {MOST_LINKS:,}. "
                        "Name only what comes directly before.",
                        table.grid.place(row, column.index),
                    )
                    return
    references = References(names, known, rows, counted)
    links += matrix_links(
        table, {entry.name: entry.rows[0] for entry in entries}, references, findings
    )
    for grid in beside:
        if (more := sheet_links(grid, references, findings)) is None:
            said = say("sheet.unread", sheet=repr(grid.name))
            findings.note("sheet", said, f"{grid.name}!A1")
        else:
            links += more
    waits = _waits(table, entries, References(names, known, rows, counted), found, findings)
    found.linked = bool(links) or waits or len(findings.faults) > already
    for link in between_tasks(links, outline, findings):
        after = found.tasks[link.later].setdefault("after", [])
        if link.first not in after:
            findings.places["tasks", link.later, "after", len(after)] = link.place
            findings.places.setdefault(("tasks", link.later, "after"), link.place)
            after.append(link.first)


def _labels(table: Table, entries: list[Entry]) -> tuple[dict[str, str], dict[str, str]]:
    """Label -> the one task that is called so; label -> a sentence about the several."""
    called: dict[str, list[str]] = {}
    for entry in entries:
        if text := _label(table, entry):
            called.setdefault(text, []).append(entry.name)
    one = {text: names[0] for text, names in called.items() if len(names) == 1}
    several = {
        text: f"Several tasks are called so, {enumerated(names, 6)}: write the one that is meant."
        for text, names in called.items()
        if len(names) > 1
    }
    return one, several


def _unread_numbers(table: Table, entries: list[Entry]) -> dict[str, str]:
    """Value -> where it stands, for a column that names every task in words of its own and that
    nobody took for their numbers: a list that names no task may well mean those.
    """
    for column in table.columns:
        values = [shown(table.grid.value(entry.rows[0], column.index)) for entry in entries]
        own = len(set(values)) == len(entries) and all(values)
        if own and column.meaning is None and column.header:
            where = f"It stands in column {column.letter}, {column.header!r}, which was not read"
            remedy = f"if that numbers the tasks, say so: --map '{column.header}=number'."
            return dict.fromkeys(values, f"{where}; {remedy}")
    return {}


def _waits(
    table: Table, entries: list[Entry], references: References, found: Tasks, findings: Findings
) -> bool:
    """Reads the waits of all tasks; says whether there are any."""
    cells = [
        (entry, row, column)
        for column in table.having("wait")
        for entry in entries
        for row in entry.rows
        if entry.name in found.tasks
    ]
    for entry, row, column in cells:
        place = table.grid.place(table.grid.origin(row, column.index), column.index)
        for wait in read_waits(table, row, column, unit_of(table, column), references, findings):
            _wait(entry, wait, place, found, findings)
    return any("wait" in data for data in found.tasks.values())


def _wait(entry: Entry, wait: dict[str, Any], place: str, found: Tasks, findings: Findings) -> None:
    """Gives the task one more wait."""
    if wait["after"] not in found.tasks:
        findings.fault(
            f"holds {wait['after']!r}, which is a summary or a milestone and nobody's work."
            " Name the task that is waited for.",
            place,
        )
        return
    waits = entry.data.setdefault("wait", [])
    findings.places["tasks", entry.name, "wait", len(waits)] = place
    waits.append(wait)


def _label(table: Table, entry: Entry) -> str:
    """How a task may be called besides its name; a summary has no place in the cell for it, but
    lists refer to it all the same.
    """
    if "label" in entry.data:
        return str(entry.data["label"])
    columns = table.having("task", "label")
    return shown(table.grid.value(entry.rows[0], columns[0].index)) if columns else ""


def _list(
    table: Table,
    entry: Entry,
    row: int,
    column: Column,
    what: str,
    references: References,
    found: Tasks,
    findings: Findings,
) -> Iterator[Link]:
    value = findings.value(table.grid, row, column.index)
    if value is None:
        return
    place = table.grid.place(table.grid.origin(row, column.index), column.index)
    lags = list[Written]()
    if what == "after" and isinstance(value, str) and entry.name in found.tasks:
        value, lags = without_lags(value)
    try:
        names = references.read(value)
        for lag in lags:
            _wait(entry, wait_of(lag, "s", references, findings), place, found, findings)
    except UnknownTaskError as error:
        findings.fault(sentence(error), place)
        return
    for name in names:
        if what != "same operator":
            yield (
                Link(entry.name, name, place) if what == "before" else Link(name, entry.name, place)
            )
        elif entry.name in found.tasks and name in found.tasks:
            if (entry.name, name) not in found.paired:
                found.paired.add((entry.name, name))
                findings.places["same_operator", len(found.same_operator)] = place
                found.same_operator.append([entry.name, name])
        elif entry.name in found.tasks:
            findings.fault(
                f"holds {name!r}, which is a summary or a milestone and nobody's work. Name the"
                " tasks below it.",
                place,
            )
