"""The way in: a planner's workbook becomes a cell, or a list of everything that stands in the way,
each with its sheet and cell.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from tandem.cell.model import Cell
from tandem.cell.names import Known, clean, key
from tandem.cell.parts import Kind
from tandem.errors import CellError, Fault, UsageError
from tandem.files.messages import flaws
from tandem.files.spreadsheet.assessments import read_assessments
from tandem.files.spreadsheet.conditions import ask_which_condition
from tandem.files.spreadsheet.contradictions import ask_about_contradictions, ask_how_many_people
from tandem.files.spreadsheet.findings import Findings, Note, listed
from tandem.files.spreadsheet.grid import Book, Grid, shown
from tandem.files.spreadsheet.header import TIMED, Column, Table, amounts_of, find_table
from tandem.files.spreadsheet.joint import with_joint_ways
from tandem.files.spreadsheet.mapping import check_overrides, overrides_from, settled
from tandem.files.spreadsheet.other_sheets import (
    Beside,
    lists_operators,
    operators_named,
    read_beside,
    read_sets,
    role_of,
    tables_beside,
)
from tandem.files.spreadsheet.outline import with_outline
from tandem.files.spreadsheet.precedence import (
    ABOUT_PRECEDENCE,
    is_about_precedence,
    listed_headers,
    with_precedence,
)
from tandem.files.spreadsheet.repeats import once_a_column
from tandem.files.spreadsheet.rows import task_rows
from tandem.files.spreadsheet.said import enumerated, say
from tandem.files.spreadsheet.scores import AGGREGATES, without_scores
from tandem.files.spreadsheet.stand_ins import ask_about_stand_ins
from tandem.files.spreadsheet.tasks import Tasks, read_tasks, unit_of
from tandem.files.spreadsheet.things import settle_things
from tandem.files.spreadsheet.values import marks_of
from tandem.files.spreadsheet.vocabulary import (
    Meaning,
    is_machine,
    is_walking,
    kind_of,
    says_how_alone,
)
from tandem.files.spreadsheet.who_can import is_table_of_abilities, restrict, with_time_of_each
from tandem.files.spreadsheet.workbook import open_book, refused

PREVIEW_ROWS = 5


@dataclass(frozen=True)
class Draft:
    """What a workbook seems to say, before anything is made of it.

    Attributes:
      sheet: the one that holds the tasks.
      header: the place of its header row, `Sheet1!A3`.
      columns: each with its meaning, or None when it is not read.
      rows: the first rows below the header, as a person reads them.
      notes: every column and row that was left out, and everything that was assumed.
      faults: what stands in the way of a cell; `cell()` raises them.
      document: the cell as a cell file would hold it; sound only when there are no faults.
    """

    path: Path
    sheet: str
    header: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[str, ...], ...]
    notes: tuple[Note, ...]
    faults: tuple[Fault, ...]
    document: Mapping[str, Any]

    def cell(self) -> Cell:
        """The cell.

        Raises:
          CellError: with every fault and its place in the workbook.
        """
        if self.faults:
            raise CellError(self.faults)
        return Cell.model_validate(self.document)


def import_cell(
    path: str | Path,
    *,
    sheet: str | None = None,
    columns: Mapping[str, str] | None = None,
    humans: Iterable[str] = (),
    robots: Iterable[str] = (),
    machines: Iterable[str] = (),
) -> tuple[Cell, tuple[Note, ...]]:
    """The cell in a workbook, and everything that was left out or assumed on the way. The arguments
    are those of `read_workbook`.

    Raises:
      CellError: with every fault and its place in the workbook; nothing is imported by halves.
      UsageError: a sheet, column or operator that the workbook does not have.
    """
    draft = read_workbook(
        path, sheet=sheet, columns=columns, humans=humans, robots=robots, machines=machines
    )
    return draft.cell(), draft.notes


def read_workbook(
    path: str | Path,
    *,
    sheet: str | None = None,
    columns: Mapping[str, str] | None = None,
    humans: Iterable[str] = (),
    robots: Iterable[str] = (),
    machines: Iterable[str] = (),
    aggregate: str | None = None,
) -> Draft:
    """Reads xlsx, xlsm, xls, xlsb, ods and csv as planners keep them; faults in the content are in
    the draft, not raised.

    Args:
      sheet: the one with the tasks, when several look like it.
      columns: header or column letters -> what it means, such as `{"Spalte 4": "time robot [s]",
        "F": "ignore"}`.
      humans, robots, machines: operators whose names do not say what they are.
      aggregate: what columns of scores that only rank are for, one of `scores.AGGREGATES`.

    Raises:
      CellError: the file cannot be opened, or no sheet or several look like tasks.
      UsageError: a sheet, column or operator that the workbook does not have.
    """
    return read_book(
        open_book(Path(path)),
        sheet=sheet,
        columns=columns,
        humans=humans,
        robots=robots,
        machines=machines,
        aggregate=aggregate,
    )


def read_book(
    book: Book,
    *,
    sheet: str | None = None,
    columns: Mapping[str, str] | None = None,
    humans: Iterable[str] = (),
    robots: Iterable[str] = (),
    machines: Iterable[str] = (),
    aggregate: str | None = None,
) -> Draft:
    """The same for an open book; see `read_workbook`."""
    kinds: dict[str, Kind] = {
        **dict.fromkeys(map(clean, humans), "human"),
        **dict.fromkeys(map(clean, robots), "robot"),
        **dict.fromkeys(map(clean, machines), "machine"),
    }
    overrides = overrides_from(columns or {})
    findings = Findings()
    for remark in book.remarks:
        findings.note("assumed", remark, book.path.name)
    roles = {role: grid for grid in book.grids if (role := role_of(grid)) and grid.name != sheet}
    sheets_beside = {role: grid for role, grid in roles.items() if _is_beside(grid)}
    known = tuple(dict.fromkeys([*operators_named(sheets_beside), *kinds]))
    raw, abilities = _task_table(book, sheet, known, overrides)
    check_overrides(overrides, raw)
    findings.marks = marks_of(
        value for table in (raw, *tables_beside(sheets_beside)) for value in amounts_of(table)
    )
    beside = read_beside(sheets_beside, findings)
    raw = with_time_of_each(raw, abilities)
    raw = without_scores(raw, overrides, findings, _aggregate(aggregate))
    raw = with_joint_ways(with_precedence(with_outline(raw), findings), known, findings)
    table = settled(raw, tuple(beside.operators), findings)
    ask_which_condition(table, known, findings)
    rows = task_rows(table, Findings())
    ask_about_contradictions(table, rows, findings)
    ask_how_many_people(table, rows, known, findings)
    ask_about_stand_ins(table, rows, findings)
    others = _other_sheets(
        book, [table.grid.name, *(able.grid.name for able in abilities)], table, findings
    )
    tasks = read_tasks(table, findings, others, known)
    things = {"tool": [*beside.tools], "zone": [*beside.zones], "place": [*beside.places]}
    settle_things(tasks.tasks, things, findings)
    for able in abilities:
        restrict(tasks.tasks, able, findings)
    document = _document(book, table, tasks, beside, kinds, roles, findings)
    _stress(table, document, findings)
    _precedence(table, tasks, findings)
    _more_notes(book, table, findings)
    faults = _all_faults(table, document, findings)
    first_rows = table.grid.rows[table.first_row : table.first_row + PREVIEW_ROWS]
    return Draft(
        path=book.path,
        sheet=table.grid.name,
        header=table.grid.place(table.header_row, 0),
        columns=tuple(column for column in table.columns if column.header or column.meaning),
        rows=tuple(tuple(map(shown, row)) for row in first_rows),
        notes=tuple(findings.notes),
        faults=faults,
        document=document,
    )


def _aggregate(stated: str | None) -> str | None:
    if stated is not None and stated not in AGGREGATES:
        raise UsageError(f"aggregate {stated!r}: {Known(AGGREGATES).hint(stated)}")
    return stated


# --- which sheet ----------------------------------------------------------------------------------


def _is_beside(grid: Grid) -> bool:
    """The sheet's name says that it does not hold the tasks. One called "Station" or "Operators"
    may do so all the same.
    """
    role = role_of(grid)
    if role not in ("operators", "cell", "ergonomics"):
        return role is not None
    if role == "operators" and lists_operators(grid):
        return True
    table = find_table(grid)
    return table is None or not table.holds_tasks


def _task_table(
    book: Book, sheet: str | None, known: tuple[str, ...], overrides: Mapping[str, Meaning | None]
) -> tuple[Table, list[Table]]:
    """The table of tasks, and those that say who can do them."""
    candidates = [grid for grid in book.grids if not grid.hidden and not _is_beside(grid)]
    tables = [
        table
        for grid in candidates
        if (table := find_table(grid, known, overrides)) and table.holds_tasks
    ]
    abilities = [table for table in tables if is_table_of_abilities(table)]
    if sheet is not None:
        return _named_sheet(book, sheet, known, overrides), [
            table for table in abilities if table.grid.name != sheet
        ]
    if not tables:
        raise _no_task_sheet(book, known, overrides)
    tables = [table for table in tables if table not in abilities] or tables
    if len(tables) > 1:
        names = [table.grid.name for table in tables]
        places = " and ".join(table.grid.place(table.header_row, 0) for table in tables)
        raise refused(
            book.path,
            f"holds several sheets that look like tasks ({places}). Choose one, such as --sheet"
            f" {names[0]!r}.",
        )
    return tables[0], [table for table in abilities if table is not tables[0]]


def _other_sheets(book: Book, read: Sequence[str], table: Table, findings: Findings) -> list[Grid]:
    """The sheets that may say what comes before what; the rest, apart from those beside the tasks,
    is noted as not read.
    """
    found = []
    for grid in book.grids:
        if grid.name in read or _is_beside(grid) or not grid.rows:
            continue
        if grid.hidden and ABOUT_PRECEDENCE.search(key(grid.name)):
            said = say("sheet.hidden", sheet=repr(grid.name))
            if table.having("after", "after rows", "before"):
                findings.note("sheet", said, f"{grid.name}!A1")
            else:
                findings.fault(str(said), f"{grid.name}!A1")
        elif not grid.hidden and is_about_precedence(grid):
            found.append(grid)
        else:
            findings.note(
                "sheet",
                say(f"sheet.unread{'.hidden' if grid.hidden else ''}", sheet=repr(grid.name)),
                f"{grid.name}!A1",
            )
    for name, why in book.passed_over.items():
        passed = say("sheet.passed", sheet=repr(name), why=why)
        if ABOUT_PRECEDENCE.search(key(name)):
            findings.fault(f"{passed} By its name it says what comes before what.", book.path.name)
        else:
            findings.note("sheet", passed)
    return found


def _named_sheet(
    book: Book, sheet: str, known: tuple[str, ...], overrides: Mapping[str, Meaning | None]
) -> Table:
    grid = next((grid for grid in book.grids if clean(grid.name) == clean(sheet)), None)
    if grid is None and sheet in book.passed_over:
        raise refused(book.path, f"sheet {sheet!r} cannot be read: {book.passed_over[sheet]}.")
    if grid is None:
        raise UsageError(
            f"--sheet {sheet!r}: {book.path.name} has no such sheet."
            f" {Known(grid.name for grid in book.grids).hint(sheet)}"
        )
    table = find_table(grid, known, overrides)
    if table is None or not table.holds_tasks:
        raise CellError([Fault(_what_is_missing(table), place=f"{grid.name}!A1")])
    return table


def _no_task_sheet(
    book: Book, known: tuple[str, ...], overrides: Mapping[str, Meaning | None]
) -> CellError:
    if not book.grids and not book.passed_over:
        return refused(book.path, "holds no sheet.")
    faults = []
    for name, why in book.passed_over.items():
        faults.append(Fault(f"sheet {name!r} was not read: {why}.", place=book.path.name))
    for grid in book.grids:
        if role_of(grid) is None or len(book.grids) == 1:
            hidden = (
                f" The sheet is hidden; --sheet {grid.name!r} reads it all the same."
                if grid.hidden
                else ""
            )
            table = find_table(grid, known, overrides)
            message = (
                "the sheet is empty." if not grid.rows and not grid.odd else _what_is_missing(table)
            )
            if grid.hidden and table is not None and table.holds_tasks:
                message = "holds the only tasks, but"
            faults.append(Fault(message + hidden, place=f"{grid.name}!A1"))
    return CellError(faults or [Fault("no sheet holds tasks.", place=book.path.name)])


def _what_is_missing(table: Table | None) -> str:
    if table is None:
        return (
            "no row reads like the header of a task list. One row must name the columns, such as"
            " 'Task', 'Time human [s]', 'Time robot [s]', 'Predecessors'. `tandem template` writes"
            " an example; --map says what a column means."
        )
    place = table.grid.place(table.header_row, 0).rpartition("!")[2]
    read = listed(
        f"{column.header!r} as {column.meaning}" for column in table.columns if column.meaning
    )
    missing, told = "holds a time, such as 'Time robot [s]'", "header=time robot [s]"
    if not table.having("number", "task", "label"):
        missing, told = "names the tasks", "header=task"
    return (
        f"in the header at {place} no column {missing}. Understood were: {read}. "
        f'Say what a column means with --map "{told}".'
    )


# --- the document ---------------------------------------------------------------------------------


def _document(
    book: Book,
    table: Table,
    tasks: Tasks,
    beside: Beside,
    kinds: dict[str, Kind],
    roles: Mapping[str, Grid],
    findings: Findings,
) -> dict[str, Any]:
    operators: dict[str, dict[str, Any]] = {
        name: dict(data) for name, data in beside.operators.items()
    }
    for name, place in tasks.operators.items():
        operators.setdefault(name, {})
        findings.places.setdefault(("operators", name), place)
    _kinds(operators, kinds, _is_standard_work(table), findings)
    document: dict[str, Any] = {
        "format": 1,
        "name": _name(book, table, beside, findings),
        "operators": operators,
        "tasks": tasks.tasks,
    }
    if beside.tools:
        document["tools"] = beside.tools
    more = {"zones": beside.zones, "places": beside.places, "walk": beside.walk}
    document |= {name: stated for name, stated in more.items() if stated}
    if beside.cycles is not None:
        document["cycles_per_shift"] = beside.cycles
    if tasks.same_operator:
        document["same_operator"] = tasks.same_operator
    if "ergonomics" in roles:
        read_assessments(roles["ergonomics"], tasks.tasks, findings)
    if "stress of sets" in roles:
        sets = read_sets(roles["stress of sets"], list(tasks.tasks), findings)
        if sets is not None:
            document["stress_of_set"] = sets
    return document


def _name(book: Book, table: Table, beside: Beside, findings: Findings) -> str:
    if beside.name is not None:
        return beside.name
    if table.title:
        findings.note(
            "assumed",
            say("title", title=repr(table.title)),
            f"{table.grid.name}!A1",
        )
        return table.title
    return book.path.stem


def _is_standard_work(table: Table) -> bool:
    """Walking stands beside the times, so what is manual and automatic of a task may both happen,
    one beside the other, as in a table of standard work.
    """
    return any(is_walking(column.header) for column in table.columns)


def _kinds(
    operators: dict[str, dict[str, Any]],
    kinds: dict[str, Kind],
    standard_work: bool,
    findings: Findings,
) -> None:
    by_key = {key(name): name for name in operators}
    for name, kind in kinds.items():
        if (own := by_key.get(key(name))) is None:
            raise UsageError(
                f"--{kind} {name!r}: the workbook has no such operator."
                f" {Known(operators).hint(name)}"
            )
        operators[own]["kind"] = kind
    unclear, guessed = [], []
    for name, data in operators.items():
        if "kind" in data:
            continue
        if standard_work and says_how_alone(name):
            data["kind"] = "human"
            unclear.append(name)
        elif guess := kind_of(name):
            data["kind"] = guess
            guessed.append(say(f"kind.{guess}", name=name))
        else:
            data["kind"] = "human"
            unclear.append(name)
    for name in unclear:
        if is_machine(name) or says_how_alone(name):
            why = "is a machine by its name"
            if not is_machine(name):
                why = "stands beside a time for walking, as in a table of standard work"
            findings.fault(
                f"operator {name!r} {why}. Does it do whole tasks by itself, as"
                f" the others could? Then say --machine {_quoted(name)}, or --robot"
                f" {_quoted(name)} if it is a robot. If its time is a part of what a person does,"
                ' leave it out (--map "HEADER=ignore" leaves out a column), or make loading,'
                " running and unloading tasks of their own.",
                findings.places.get(("operators", name), ""),
            )
            continue
        findings.fault(
            f"operator {name!r}: is this a human or a robot? Say it with --human {_quoted(name)} or"
            f" --robot {_quoted(name)} (--machine, if it is one), or in a sheet 'Operators' with"
            " the columns 'operator' and 'kind'.",
            findings.places.get(("operators", name), ""),
        )
    if guessed:
        findings.note("assumed", say("kinds", who=enumerated(guessed)))


def _quoted(name: str) -> str:
    return f'"{name}"' if " " in name else name


# --- notes and faults at the end ------------------------------------------------------------------


def _stress(table: Table, document: Mapping[str, Any], findings: Findings) -> None:
    """Says where stress is taken as 0 because the sheet does not state it."""
    humans = {name for name, data in document["operators"].items() if data["kind"] == "human"}
    columns = table.having("stress")
    by_humans = [name for name, task in document["tasks"].items() if humans & _who_can(task)]
    bare = [
        name
        for name in by_humans
        if not any(
            "stress" in way
            for way in (document["tasks"][name], *document["tasks"][name].get("together", ()))
        )
    ]
    if not columns and by_humans and "stress_of_set" not in document:
        findings.note("assumed", say("stress.none"))
    elif columns and bare:
        findings.note("assumed", say("stress.bare", tasks=enumerated(bare)), columns[0].place)


def _precedence(table: Table, tasks: Tasks, findings: Findings) -> None:
    """Says when every task may begin at once, because nothing in the workbook keeps it waiting."""
    if tasks.linked:
        return
    columns = table.having("after", "after rows", "before")
    if columns:
        number = "one" if len(columns) == 1 else "other"
        said = say(f"order.empty.{number}", columns=listed_headers(columns))
        findings.note("assumed", said, columns[0].place)
    else:
        findings.note("assumed", say("order.none"))


def _who_can(task: Mapping[str, Any]) -> set[str]:
    return {
        *task.get("time", ()),
        *(who for joint in task.get("together", ()) for who in joint["operators"]),
    }


MOST_REMARKS, LONGEST_REMARK = 10, 60
"""Of the comments at cells, so many are told, each so far."""


def _comments(table: Table, findings: Findings) -> None:
    """Says which cells that are read have comments: "in minutes!" is for people to mind."""
    read = {c.index for c in table.columns if c.meaning and c.meaning.what != "ignore"}
    said = [
        say("comment", cell=table.grid.place(row, column).rpartition("!")[2], text=repr(short))
        for (row, column), text in sorted(table.grid.comments.items())
        if row >= table.header_row and column in read and (short := text[:LONGEST_REMARK])
    ]
    if said:
        findings.note(
            "assumed",
            say("comments", cells=enumerated(said, MOST_REMARKS)),
            table.grid.place(table.header_row, 0),
        )


def _more_notes(book: Book, table: Table, findings: Findings) -> None:
    _comments(table, findings)
    if findings.rounded:
        findings.note("assumed", say("rounded", cells=enumerated(findings.rounded, 20)))
    hidden = [
        column.header
        for column in table.columns
        if column.meaning and column.index in table.grid.hidden_columns
    ]
    if hidden:
        findings.note(
            "assumed",
            say("columns.hidden", columns=enumerated(map(repr, hidden))),
            table.grid.place(table.header_row, 0),
        )
    if (
        not book.sees_errors
        and book.path.suffix.lower() in (".xls", ".xlsb")
        and any(note.kind == "cannot" for note in findings.notes)
    ):
        findings.note("assumed", say("errors.unseen", ending=book.path.suffix))
    if not book.sees_errors and (
        silent := [
            c for c in table.having(*TIMED) if c.meaning and not c.meaning.unit and not table.unit
        ]
    ):
        findings.fault(
            f"no unit is stated for {listed(repr(column.header) for column in silent)}, and in"
            f" {book.path.suffix} files the unit that a number format shows cannot be seen. Write"
            " [s], [min] or [1/100 min] into the header, or save as .xlsx.",
            silent[0].place,
        )
    if book.path.suffix.lower() == ".xlsb":
        findings.note("assumed", say("xlsb"))
    units = {unit_of(table, column) for column in table.having("time")}
    if units - {"s"}:
        findings.note("assumed", say("converted", units=enumerated(sorted(units - {"s"}))))


def _all_faults(table: Table, document: Mapping[str, Any], findings: Findings) -> tuple[Fault, ...]:
    """Those of the sheet, and those of the cell that it describes, placed in the sheet; equal ones
    of a column told once.
    """
    faults = list(dict.fromkeys(findings.faults))
    touched = {fault.place for fault in faults}
    try:
        Cell.model_validate(document)
    except CellError as error:
        more = error.faults
    except ValidationError as error:
        more = tuple(flaw.fault for flaw in flaws(error))
    else:
        more = ()
    for fault in more:
        place = findings.place_of(fault.path)
        if not (place and place in touched) and not (not document["tasks"] and faults):
            faults.append(fault.at(place or fault.place))
    return once_a_column(
        faults, {(table.grid.name, column.letter): column.header for column in table.columns}
    )
