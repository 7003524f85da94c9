"""The sheets of places and of walking times: where places are, and how long the way between two of
them takes whom.
"""

from __future__ import annotations

import re
from itertools import combinations
from typing import Any

from tandem.cell.model import Cell
from tandem.cell.names import key
from tandem.cell.walking import SPEED, pairs_of
from tandem.files.spreadsheet.findings import Findings
from tandem.files.spreadsheet.grid import Grid, blank, shown
from tandem.files.spreadsheet.header import Column, best_table
from tandem.files.spreadsheet.said import say
from tandem.files.spreadsheet.values import UnreadableError, number
from tandem.files.spreadsheet.vocabulary import Meaning, meaning

ENDS = {
    "from": frozenset(("from", "von", "start", "place", "ort")),
    "to": frozenset(("to", "nach", "bis", "zu", "ziel", "destination")),
}
AXES = re.compile(r"([xy])( (in )?(m|metres?|meters?|meter))?")


def read_places(grid: Grid, findings: Findings) -> dict[str, list[float]]:
    """`places` from a sheet with the columns "place", "x [m]" and "y [m]"."""
    table = best_table(grid, _place_word)
    columns = {} if table is None else {c.meaning.what: c for c in table.columns if c.meaning}
    if table is None or not {"place", "x", "y"} <= columns.keys():
        return _without_columns(grid, "'place', 'x [m]', 'y [m]'", findings)
    found: dict[str, list[float]] = {}
    for row in range(table.first_row, len(grid.rows)):
        name = findings.text(grid, row, columns["place"].index)
        ends = [_coordinate(grid, row, columns[axis], findings) for axis in ("x", "y")]
        if not name and ends == [None, None]:
            continue
        here = grid.place(row, columns["place"].index)
        if not name or name in found:
            bare = "is empty: the row has coordinates and no name. Give it one, or clear the row."
            twice = f"place {name!r} stands here a second time. Keep one of the rows."
            findings.fault(twice if name else bare, here)
        elif None in ends:
            findings.fault(f"place {name!r} needs two coordinates in metres, x and y.", here)
        else:
            found[name] = [end for end in ends if end is not None]
            findings.places["places", name] = here
    return found


def read_walks(grid: Grid, walk: dict[str, dict[str, float]], findings: Findings) -> None:
    """Puts into `walk` what a sheet says with the columns "from", "to" and a time for each
    operator.
    """
    table = best_table(grid, _walk_word)
    ends = (
        [
            next((c for c in table.columns if c.meaning and c.meaning.what == what), None)
            for what in ENDS
        ]
        if table
        else [None, None]
    )
    if table is None or ends[0] is None or ends[1] is None:
        _without_columns(grid, "'from', 'to'", findings)
        return
    for column in table.columns:
        if column.header and (column.meaning is None or len(column.meaning.who) > 1):
            said = say("column.of_sheet", column=repr(column.header), sheet=repr(grid.name))
            findings.note("column", said, column.place)
    for row in range(table.first_row, len(grid.rows)):
        start, end = (findings.text(grid, row, column.index) for column in ends if column)
        if not start or not end:
            if any(not blank(value) for value in grid.rows[row]):
                findings.fault(
                    "a way leads from a place to a place: name both, or clear the row.",
                    grid.place(row, ends[0].index),
                )
            continue
        for column in table.columns:
            what = column.meaning
            if what is None or len(what.who) != 1:
                continue
            time = findings.time(grid, row, column.index, what.unit or "s", zero=True)
            if time is not None:
                pair, who = f"{start}-{end}", what.who[0]
                if pair in walk.setdefault(who, {}):
                    findings.fault(
                        f"the way from {start!r} to {end!r} stands here a second time. Keep one of"
                        " the rows.",
                        grid.place(row, ends[0].index),
                    )
                walk[who][pair] = time
                findings.places["walk", who, pair] = grid.place(row, column.index)


def rows_of(cell: Cell) -> list[tuple[str, str, dict[str, float]]]:
    """(from, to, operator -> seconds) for each row of such a sheet: both directions in one row
    where that is the same for all.
    """
    stated = {who: _stated(cell, who) for who in cell.walk}
    rows = []
    for one, other in combinations(cell.place_names, 2):
        there, back = (
            {who: times[pair] for who, times in stated.items() if pair in times}
            for pair in ((one, other), (other, one))
        )
        if there:
            rows.append((one, other, there))
        if back != there:
            rows.append((other, one, back))
    return rows


def _stated(cell: Cell, who: str) -> dict[tuple[str, str], float]:
    """The times of pairs that do not follow from the operator's speed, in both directions."""
    known, found = dict.fromkeys(cell.place_names), dict[tuple[str, str], float]()
    for pair, seconds in cell.walk[who].items():
        if pair != SPEED:
            [(one, other)] = pairs_of(pair, known)
            found[one, other] = seconds
            found.setdefault((other, one), seconds)
    return found


def _place_word(text: str, column: int) -> Meaning | None:
    if axis := AXES.fullmatch(key(text)):
        return Meaning(axis[1])
    found = meaning(text) if text else None
    return found if found is not None and found.what in ("place", "task") else None


def _walk_word(text: str, column: int) -> Meaning | None:
    for end, words in ENDS.items():
        if key(text) in words:
            return Meaning(end)
    found = meaning(text) if text else None
    return found if found is not None and found.what == "time" and found.who else None


def _coordinate(grid: Grid, row: int, column: Column, findings: Findings) -> float | None:
    value = grid.value(row, column.index)
    if blank(value):
        return None
    try:
        return float(number(value, findings.marks).value)
    except UnreadableError as error:
        findings.fault(
            f"{error}: {shown(value)} is no number of metres.", grid.place(row, column.index)
        )
        return None


def _without_columns(grid: Grid, columns: str, findings: Findings) -> dict[str, Any]:
    said = say("sheet.no_column", sheet=repr(grid.name), column=columns)
    findings.note("sheet", said, f"{grid.name}!A1")
    return {}
