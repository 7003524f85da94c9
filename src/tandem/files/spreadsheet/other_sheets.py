"""The sheets beside the tasks: operators with their kind, limits and breaks; tools; zones; stress
by table; the cell's name.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from tandem.cell.names import key
from tandem.cell.parts import Kind
from tandem.cell.walking import SPEED
from tandem.files.spreadsheet.findings import Findings
from tandem.files.spreadsheet.form import OPERATOR_COLUMNS, OperatorColumn
from tandem.files.spreadsheet.grid import Grid, blank, shown, tidy
from tandem.files.spreadsheet.header import Column, Table, best_table
from tandem.files.spreadsheet.references import References, UnknownTaskError, unquoted
from tandem.files.spreadsheet.said import say
from tandem.files.spreadsheet.values import UnreadableError, number, seconds
from tandem.files.spreadsheet.vocabulary import Meaning, is_machine, kind_of, meaning
from tandem.files.spreadsheet.walking import read_places, read_walks

SHEETS: dict[str, str] = {
    "operators": (
        "operators|operator|bediener|ressourcen|resources|mitarbeiter|personal|werker|team|staff|workers|people"
    ),
    "tools": "tools|tool|werkzeuge|werkzeug",
    "zones": "zones|zone|zonen|bereiche|bereich|areas",
    "places": "places|place|orte|ort|standorte|locations",
    "walking": "walking|walking times|walk|walks|wege|weg|wegezeiten|laufwege",
    "stress of sets": (
        "stress of sets|belastung der mengen|belastung je menge|stress table|belastungstabelle"
    ),
    "ergonomics": "ergonomics|ergonomie|facts|angaben|assessments|bewertungen|beurteilungen",
    "cell": "cell|zelle|station|arbeitsplatz|workstation",
    "help": "help|hilfe|readme|anleitung|lists|listen",
}
"""What a sheet beside the tasks is for -> how it may be called."""

ROLES = {name: role for role, names in SHEETS.items() for name in names.split("|")}


@dataclass
class Beside:
    """What stands beside the tasks, as parts of a cell document.

    Attributes:
      operators: name -> `kind` (when stated), `label`, `breaks`, ...
    """

    operators: dict[str, dict[str, Any]] = field(default_factory=dict)
    tools: dict[str, dict[str, Any]] = field(default_factory=dict)
    zones: dict[str, dict[str, Any]] = field(default_factory=dict)
    places: dict[str, list[float]] = field(default_factory=dict)
    walk: dict[str, dict[str, float]] = field(default_factory=dict)
    sets: dict[str, float] | None = None
    name: str | None = None
    cycles: float | None = None


def role_of(grid: Grid) -> str | None:
    """What the sheet is for, by its name."""
    return ROLES.get(key(grid.name))


def read_beside(grids: dict[str, Grid], findings: Findings) -> Beside:
    """Everything except the stress of sets, which needs the tasks' names first."""
    found = Beside()
    if "operators" in grids:
        _operators(grids["operators"], found, findings)
    for role, names in (("tools", ("tool", "task")), ("zones", ("zone", "task"))):
        if role in grids:
            _things(grids[role], role, names, found, findings)
    if "places" in grids:
        found.places = read_places(grids["places"], findings)
    if "walking" in grids:
        read_walks(grids["walking"], found.walk, findings)
    if "cell" in grids:
        _name(grids["cell"], found)
        _cycles(grids["cell"], found, findings)
    return found


def _reader(*wanted: str) -> Callable[[str, int], Meaning | None]:
    def read(text: str, column: int) -> Meaning | None:
        found = meaning(text) if text else None
        return found if found is not None and found.what in wanted else None

    return read


def _table(grid: Grid, *wanted: str) -> Table | None:
    table = best_table(grid, _reader(*wanted))
    return table


def _column(table: Table, *what: str) -> Column | None:
    return next(iter(table.having(*what)), None)


def _rows(table: Table, name: Column, findings: Findings) -> list[int]:
    """Rows with a name; values that stand beside no name are a fault."""
    grid, rows = table.grid, []
    for row in range(table.first_row, len(grid.rows)):
        if not blank(grid.value(row, name.index)):
            rows.append(row)
        elif any(
            not blank(grid.rows[row][column.index]) for column in table.columns if column.meaning
        ):
            findings.fault(
                f"is empty: the row has values and no name below {name.header!r}. Give it one, or"
                " clear the row.",
                grid.place(row, name.index),
            )
    return rows


def tables_beside(grids: Mapping[str, Grid]) -> list[Table]:
    """The sheets beside the tasks that hold numbers, as tables."""
    words = {
        "operators": OPERATOR_WORDS,
        "tools": ("tool", "task", "capacity", "changeover"),
        "zones": ("zone", "task", "capacity", "apart"),
    }
    return [
        table
        for role, wanted in words.items()
        if role in grids and (table := _table(grids[role], *wanted))
    ]


def operators_named(grids: Mapping[str, Grid]) -> list[str]:
    """The operators whom a sheet of their own lists."""
    table = _table(grids["operators"], *OPERATOR_WORDS) if "operators" in grids else None
    name = _column(table, "operator", "task") if table else None
    if table is None or name is None:
        return []
    return [
        shown(value)
        for row in range(table.first_row, len(table.grid.rows))
        if not blank(value := table.grid.value(row, name.index))
    ]


# --- operators ------------------------------------------------------------------------------------


OPERATOR_WORDS = ("operator", "task", *(column.means for column in OPERATOR_COLUMNS))
TELLING = tuple(column.means for column in OPERATOR_COLUMNS if column.holds != "text")
"""Columns that only a sheet of operators has."""


def lists_operators(grid: Grid) -> bool:
    """The sheet has a column of operators and says something about them."""
    table = _table(grid, *OPERATOR_WORDS)
    return (
        table is not None
        and bool(table.having("operator", "task"))
        and bool(table.having(*TELLING))
    )


def _operators(grid: Grid, found: Beside, findings: Findings) -> None:
    table = _table(grid, *OPERATOR_WORDS)
    name = _column(table, "operator", "task") if table else None
    if table is None or name is None:
        findings.note(
            "sheet",
            say("sheet.no_column", sheet=repr(grid.name), column="'operator'"),
            f"{grid.name}!A1",
        )
        return
    _note_columns(table, findings)
    for row in _rows(table, name, findings):
        who = findings.text(grid, row, name.index)
        if not who:
            continue
        if who in found.operators:
            findings.fault(
                f"operator {who!r} stands here a second time. Give each a name of its own.",
                grid.place(row, name.index),
            )
            continue
        found.operators[who] = _operator(table, row, who, findings)
        if (speed := found.operators[who].pop(SPEED, None)) is not None:
            found.walk.setdefault(who, {})[SPEED] = speed
            findings.places["walk", who, SPEED] = findings.places["operators", who, SPEED]
        findings.places["operators", who] = grid.place(row, name.index)


def _operator(table: Table, row: int, who: str, findings: Findings) -> dict[str, Any]:
    data: dict[str, Any] = {}
    for wanted in OPERATOR_COLUMNS:
        column = _column(table, wanted.means)
        if column is None or (column.meaning is not None and column.meaning.who):
            continue
        findings.places["operators", who, wanted.key] = table.grid.place(row, column.index)
        value = _value(table.grid, row, who, wanted, column, findings)
        if value is not None:
            data[wanted.key] = value
    return data


def _value(
    grid: Grid, row: int, who: str, wanted: OperatorColumn, column: Column, findings: Findings
) -> Any:
    """What a cell of the operators' sheet says, in the words of a cell file; None when it says
    nothing.
    """
    place, unit = (
        grid.place(row, column.index),
        (column.meaning.unit if column.meaning else None) or "s",
    )
    match wanted.holds:
        case "amount":
            return findings.amount(grid, row, column.index, f"a {wanted.word}")
        case "time":
            return findings.time(grid, row, column.index, unit, zero=True)
    text = findings.text(grid, row, column.index)
    if not text:
        return None
    match wanted.holds:
        case "breaks":
            return _breaks(text, unit, place, findings) or None
        case "limits":
            return _limits(text, who, place, findings) or None
        case "pairs":
            return _pairs(text, place, findings) or None
        case "kind":
            kind = _kind(text)
            if kind is None:
                findings.fault(
                    f"holds {text!r}: the kind of {who!r} is 'human', 'robot' or 'machine'.", place
                )
            return kind or "human"
    return text


def _kind(text: str) -> Kind | None:
    return "machine" if is_machine(text) else kind_of(text)


def _kinds(text: str, zone: str, place: str, findings: Findings) -> list[Kind]:
    """ "human; robot" as kinds of operators."""
    kinds: list[Kind] = []
    for part in filter(None, map(str.strip, re.split("[;,+]", text))):
        if (kind := _kind(part)) is None:
            findings.fault(
                f"holds {part!r}: zone {zone!r} keeps kinds of operators apart, each 'human',"
                " 'robot' or 'machine', several with semicolons.",
                place,
            )
        else:
            kinds.append(kind)
    return kinds


PAIR = re.compile(r'\s*("[^"]+"|[^;>"]+?)\s*>\s*("[^"]+"|[^;>"]+?)\s*')


def _pairs(text: str, place: str, findings: Findings) -> list[list[str]]:
    """ "load > unload; a > b" as pairs of names."""
    pairs = []
    for part in filter(None, map(str.strip, re.split(r';(?=(?:[^"]*"[^"]*")*[^"]*$)', text))):
        if (found := PAIR.fullmatch(part)) is None:
            findings.fault(
                f"holds {part!r}: write from and to which task the machine holds a part, several"
                " pairs with semicolons, such as 'load > unload'.",
                place,
            )
        else:
            pairs.append([unquoted(name) for name in found.groups()])
    return pairs


def _limits(text: str, who: str, place: str, findings: Findings) -> dict[str, float]:
    """ "peak:reba = 7; dose:lifft = 0.02" as measures and the most of each."""
    found: dict[str, float] = {}
    for part in filter(None, map(str.strip, text.split(";"))):
        name, _, most = (piece.strip() for piece in part.rpartition("="))
        try:
            if not name or name in found:
                raise UnreadableError(f"holds {part!r}")
            found[name] = float(number(most, findings.marks).value)
        except UnreadableError:
            findings.fault(
                f"holds {part!r}: write limits as measure = most, each measure once, several with"
                " semicolons, such as 'peak:reba = 7; time-above:reba:8 = 20'.",
                place,
            )
        findings.places["operators", who, "limits", name] = place
    return found


def _breaks(text: str, unit: str, place: str, findings: Findings) -> list[list[float]]:
    """ "300-600; 900-1000" as pairs of seconds."""
    pairs = []
    for part in filter(None, map(str.strip, text.split(";"))):
        ends = re.split(r"\s*(?:-|–|\bto\b|\bbis\b)\s*", part)
        try:
            if len(ends) != 2:
                raise UnreadableError(f"holds {part!r}")
            pairs.append([float(seconds(number(end, findings.marks), unit)[0]) for end in ends])
        except UnreadableError:
            findings.fault(
                f"holds {part!r}: write breaks as from-to since the start, several with semicolons,"
                " such as '300-600; 900-1000'.",
                place,
            )
    return pairs


# --- tools, zones, sets, name ---------------------------------------------------------------------


def _things(
    grid: Grid, role: str, names: tuple[str, ...], found: Beside, findings: Findings
) -> None:
    table = _table(grid, *names, "capacity", "changeover" if role == "tools" else "apart")
    name = _column(table, *names) if table else None
    if table is None or name is None:
        findings.note(
            "sheet",
            say("sheet.no_column", sheet=repr(grid.name), column=repr(names[0])),
            f"{grid.name}!A1",
        )
        return
    _note_columns(table, findings)
    things = found.tools if role == "tools" else found.zones
    for row in _rows(table, name, findings):
        thing = findings.text(grid, row, name.index)
        if not thing:
            continue
        if thing in things:
            findings.fault(
                f"{role[:-1]} {thing!r} stands here a second time. Keep one of the rows.",
                grid.place(row, name.index),
            )
            continue
        data = things[thing] = {}
        findings.places[role, thing] = grid.place(row, name.index)
        for column in table.having("capacity"):
            if (places := findings.amount(grid, row, column.index, "a capacity")) is not None:
                findings.places[role, thing, "capacity"] = grid.place(row, column.index)
                data["capacity"] = int(places) if places.is_integer() else places
        for column in table.having("apart"):
            if text := findings.text(grid, row, column.index):
                place = findings.places[role, thing, "apart"] = grid.place(row, column.index)
                data["apart"] = _kinds(text, thing, place, findings)
        for column in table.having("changeover"):
            who = column.meaning.who if column.meaning else ()
            unit = (column.meaning.unit if column.meaning else None) or "s"
            time = findings.time(grid, row, column.index, unit, zero=True)
            if time is not None and len(who) == 1:
                data.setdefault("changeover", {})[who[0]] = time
                findings.places[role, thing, "changeover", who[0]] = grid.place(row, column.index)


def _note_columns(table: Table, findings: Findings) -> None:
    for column in table.columns:
        if column.meaning is None and column.header:
            findings.note(
                "column",
                say("column.of_sheet", column=repr(column.header), sheet=repr(table.grid.name)),
                column.place,
            )


def read_sets(grid: Grid, names: list[str], findings: Findings) -> dict[str, float] | None:
    """`stress_of_set` from a sheet with the columns "tasks" and "stress"."""
    table = _table(grid, "task", "stress")
    tasks, amounts = (_column(table, "task"), _column(table, "stress")) if table else (None, None)
    if table is None or tasks is None or amounts is None:
        findings.note(
            "sheet",
            say("sheet.no_columns", sheet=repr(grid.name)),
            f"{grid.name}!A1",
        )
        return None
    references, sets = References(names), {}
    order = {name: place for place, name in enumerate(names)}
    for row in range(table.first_row, len(grid.rows)):
        amount = findings.amount(grid, row, amounts.index, "a number for stress")
        try:
            members = sorted(references.read(grid.value(row, tasks.index)), key=order.__getitem__)
        except UnknownTaskError as error:
            findings.fault(str(error), grid.place(row, tasks.index))
            continue
        if amount is not None:
            findings.places["stress_of_set", ",".join(members)] = grid.place(row, tasks.index)
            sets[",".join(members)] = amount
    return sets


def _name(grid: Grid, found: Beside) -> None:
    for row in range(len(grid.rows)):
        filled = [tidy(str(value)) for _, value in grid.filled(row)]
        if len(filled) >= 2 and key(filled[0]) in (
            "name",
            "cell",
            "zelle",
            "bezeichnung",
            "station",
        ):
            found.name = filled[1]
            return


CYCLES = ("products per shift", "cycles per shift", "stueck je schicht", "zyklen je schicht")


def _cycles(grid: Grid, found: Beside, findings: Findings) -> None:
    for row in range(len(grid.rows)):
        filled = list(grid.filled(row))
        if len(filled) >= 2 and key(tidy(str(filled[0][1]))) in CYCLES:
            findings.places["cycles_per_shift",] = grid.place(row, filled[1][0])
            found.cycles = findings.amount(grid, row, filled[1][0], "the products per shift")
            return
