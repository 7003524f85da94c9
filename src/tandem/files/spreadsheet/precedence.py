"""What comes before what, where it does not stand in one column of the task sheet: several columns,
one without a header, a matrix with a column for each task, or a sheet of its own with pairs or such
a matrix.

A pair or a mark says that two tasks are linked, but not always which comes first. Words say it
("from", "Nachfolger"); where there are none, the order of the task list does, if all links run one
way through it. Else the import asks.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from tandem.cell.names import key
from tandem.files.spreadsheet.findings import Findings, listed
from tandem.files.spreadsheet.grid import Grid, Value, blank, shown
from tandem.files.spreadsheet.header import Column, Table
from tandem.files.spreadsheet.references import References, UnknownTaskError, unquoted
from tandem.files.spreadsheet.said import say
from tandem.files.spreadsheet.values import is_number
from tandem.files.spreadsheet.vocabulary import MEANS, Meaning, meaning

Side = Literal["first", "later", "task", "predecessors", "successors", "kind", "lag"]

SIDES: dict[str, str] = {
    "first": (
        "from|von|i|source|quelle|first|zuerst|erst|vorher|earlier|before|vor|tail|anfang|predecessor|vorgaenger|vorlaeufer|pred|vorg"
    ),
    "later": (
        "to|bis|j|target|ziel|second|then|dann|danach|nachher|later|after|nach|head|successor|nachfolger|succ|nachf"
    ),
    "kind": "type|typ|art|link type|beziehung|anordnungsbeziehung|relation",
    "lag": "lag|zeitabstand|abstand|puffer|offset|delay|wartezeit",
}
"""Headers in a list of pairs, less words such as "task"."""
SIDE_OF: dict[str, Side] = {
    word: side  # type: ignore[misc]
    for side, words in SIDES.items()
    for word in words.split("|")
}

MATRIX: dict[str, str] = {"after": "predecessor mark", "before": "successor mark", "": "link mark"}
"""What the columns of a matrix mean, by what stands above them: nothing says which of the two tasks
comes first in the last.
"""

ABOUT_PRECEDENCE = re.compile(
    r"preced|vorrang|vorgaenger|predecess|successor|nachfolg|abhaengig|dependen|anordnungsbez|reihenfolgebez"
)
"""Names of sheets that hold what comes before what."""

NEUTRAL = re.compile(
    r"(sheet|tabelle|blatt|table)"
    r" ?\d*|links?|kanten|edges|arcs|pairs|paare|graph|relations|beziehungen|netz(plan|werk)?"
    r"|network"
)
"""Names of sheets that say nothing against it."""

MARKS = {"1", "x", "✓", "✔", "●", "•", "*", "true", "wahr", "yes", "ja", "y", "j"}
NO_MARKS = {"", "0", "-", "–", "—", "−", ".", "/", "false", "falsch", "no", "nein", "n"}
END_TO_START = {"", "fs", "ea", "finish to start", "end to start", "ende anfang", "finish start"}
LAST_HEADER_ROW = 20
WAYS_OUT = (
    "Write 'from' and 'to' above two columns of tasks, or give each task its predecessors in a"
    " column 'Predecessors'; if the sheet holds something else, give it another name"
)


@dataclass(frozen=True)
class Link:
    """`first` has ended before `later` starts; `place` is where a sheet says so."""

    first: str
    later: str
    place: str


def is_mark(value: Value) -> bool | None:
    """True for a mark such as 1 or x, False for none, such as 0 or an empty cell; None for anything
    else.
    """
    if isinstance(value, bool):
        return value
    text = shown(value).casefold()
    return True if text in MARKS else False if text in NO_MARKS else None


def is_about_precedence(grid: Grid) -> bool:
    """The sheet is called so, or has the two columns of a list of pairs."""
    return bool(ABOUT_PRECEDENCE.search(key(grid.name))) or any(
        _is_header_of_pairs(grid, row) for row in range(min(3, len(grid.rows)))
    )


# --- columns of the task sheet --------------------------------------------------------------------


def with_precedence(table: Table, findings: Findings) -> Table:
    """The table with a meaning for the columns that belong to its predecessors although their
    headers alone do not say so.
    """
    naming = next(
        (table.having(what)[0] for what in ("number", "task", "label") if table.having(what)), None
    )
    if naming is None:
        return table
    rows = [
        row
        for row in range(table.first_row, len(table.grid.rows))
        if not blank(table.grid.value(row, naming.index))
    ]
    references = _first_look(table, naming, rows)
    return _with_unnamed(
        _with_matrix(table, references, rows, findings), references, rows, findings
    )


def _first_look(table: Table, naming: Column, rows: list[int]) -> References:
    """The names in the sheet, before its rows are told into tasks and others."""
    names = {row: unquoted(shown(table.grid.value(row, naming.index))) for row in rows}
    labels = {
        shown(table.grid.value(row, column.index)): names[row]
        for column in table.having("task", "label")
        for row in rows
    }
    return References(list(dict.fromkeys(names.values())), labels)


def _with_matrix(
    table: Table, references: References, rows: list[int], findings: Findings
) -> Table:
    """Two or more columns that are headed by different tasks and hold nothing but marks are a
    matrix.
    """
    grid = table.grid
    headed: dict[int, str] = {}
    for column in table.columns:
        free = (
            column.meaning is None
            or column.meaning.what in ("after", "before")
            or not column.meaning.sure
        )
        name = (
            references.task(shown(grid.value(table.header_row, column.index)))
            if free and column.header
            else None
        )
        if (
            name is not None
            and name not in headed.values()
            and all(is_mark(grid.value(row, column.index)) is not None for row in rows)
        ):
            headed[column.index] = name
    if len(headed) < 2 or not any(
        is_mark(grid.value(row, index)) for index in headed for row in rows
    ):
        return table
    columns = [
        replace(column, meaning=_of_matrix(table, column)) if column.index in headed else column
        for column in table.columns
    ]
    ends = [column.place.rpartition("!")[2] for column in columns if column.index in headed]
    findings.note(
        "assumed",
        say("matrix", first=ends[0], last=ends[-1]),
        columns[min(headed)].place,
    )
    return replace(table, columns=tuple(columns))


def _of_matrix(table: Table, column: Column) -> Meaning:
    """By the words above the task in the column's header, or above those left of it."""
    said = column.meaning.what if column.meaning else None
    above = table.grid.rows[table.header_row - 1][: column.index + 1] if table.header_row else ()
    words = meaning(next((shown(value) for value in reversed(above) if not blank(value)), ""))
    return Meaning(
        MATRIX.get(said or "-") or MATRIX.get(words.what if words else "-") or MATRIX[""]
    )


def _with_unnamed(
    table: Table, references: References, rows: list[int], findings: Findings
) -> Table:
    """Columns without a header behind a list of tasks belong to it when they hold tasks."""
    columns = list(table.columns)
    end = table.grid.lengths[table.header_row] if table.grid.lengths else len(columns)
    left: Column | None = None
    for place, column in enumerate(columns):
        if column.header or column.meaning or left is None:
            left = (
                column
                if column.meaning and column.meaning.what in ("after", "after rows", "before")
                else None
            )
            continue
        filled = [row for row in rows if not blank(table.grid.value(row, column.index))]
        strange = [
            row
            for row in filled
            if not _names_tasks(references, table.grid.value(row, column.index))
        ]
        if not filled or (place >= end and not _is_torn_list(table.grid, filled, left, column)):
            continue
        if not strange:
            columns[place] = replace(column, meaning=left.meaning)
            said = say("no_header", letter=column.letter, header=repr(left.header))
            findings.note("assumed", said, column.place)
        else:
            left = None
        if 0 < len(strange) * 2 < len(filled):
            value = shown(table.grid.value(strange[0], column.index))
            findings.fault(
                f"holds {value!r}, which is no task, in a column without a header that otherwise"
                " holds tasks. Mend it, or write a header "
                f'above the column (--map "{column.letter}=ignore" leaves it out).',
                table.grid.place(strange[0], column.index),
            )
    return replace(table, columns=tuple(columns))


def _is_torn_list(grid: Grid, rows: list[int], left: Column, column: Column) -> bool:
    """What a line of a text file has more than its header is the rest of its list of tasks, not of
    a decimal comma that moved all behind it.

    Numbers do not tell the one from the other.
    """
    values = [grid.rows[row][index] for row in rows for index in (left.index, column.index)]
    return not any(blank(value) or is_number(value) for value in values)


def _names_tasks(references: References, value: Value) -> bool:
    try:
        references.read(value)
    except UnknownTaskError:
        return False
    return True


def matrix_links(
    table: Table, rows: dict[str, int], references: References, findings: Findings
) -> list[Link]:
    """The links in the matrix columns of a task sheet; `rows` holds the row of each task."""
    columns = table.having(*MATRIX.values())
    if not columns:
        return []
    said = {column.meaning.what for column in columns if column.meaning}
    marks = [
        (name, other, table.grid.place(row, column.index))
        for name, row in rows.items()
        for column in columns
        if is_mark(table.grid.value(row, column.index))
        and (other := references.task(shown(table.grid.value(table.header_row, column.index))))
        is not None
    ]
    words = (
        "predecessor mark"
        if said == {MATRIX["after"]}
        else "successor mark"
        if said == {MATRIX["before"]}
        else ""
    )
    rows_first = {"predecessor mark": False, "successor mark": True}.get(words)
    remedy = (
        "Write 'Predecessors' above the columns if their tasks come first, 'Successors' if those of"
        " the rows do."
    )
    return _directed(
        marks,
        rows_first,
        list(references.names),
        "the task of the row",
        "that of the column",
        columns[0].place,
        remedy,
        findings,
    )


# --- sheets of their own --------------------------------------------------------------------------


def sheet_links(grid: Grid, references: References, findings: Findings) -> list[Link] | None:
    """The links in a sheet of pairs or a matrix; None when it is no such sheet and does not claim
    to be one by its name.

    A sheet that is called "precedence" or alike and cannot be read is a fault.
    """
    for reading in (_pairs_below_a_header, _matrix, _bare_pairs):
        links = reading(grid, references, findings)
        if links is not None:
            return links
    if ABOUT_PRECEDENCE.search(key(grid.name)):
        findings.fault(
            "by its name the sheet holds what comes before what, but neither pairs nor a matrix of"
            f" tasks. {WAYS_OUT}.",
            f"{grid.name}!A1",
        )
        return []
    return None


def _sides(grid: Grid, row: int) -> dict[int, Side]:
    """What the columns hold if this row is the header of a list of pairs; empty when it is none."""
    sides = {
        column: side
        for column, value in grid.filled(row)
        if isinstance(value, str) and (side := _side(value))
    }
    ends = {
        column: turned
        for column, side in sides.items()
        if side in ("first", "later") and (turned := _turned(str(grid.value(row, column))))
    }
    tasks = [column for column, side in sides.items() if side == "task"]
    if (
        tasks
        and ends
        and not (len(ends) == 2 and _numbers_the_pairs(grid, row, tasks[0], list(ends)))
    ):
        return {**sides, **ends}
    return (
        {column: side for column, side in sides.items() if side != "task"}
        if {"first", "later"} <= set(sides.values())
        else {}
    )


def _numbers_the_pairs(grid: Grid, header: int, numbers: int, ends: list[int]) -> bool:
    """ "No. | Predecessor | Successor" with no gap: the number counts pairs, as a list of tasks
    begins with one that has no predecessor.
    """
    return MEANS.get(key(str(grid.value(header, numbers)))) == "number" and not any(
        blank(grid.value(row, column))
        for row in range(header + 1, len(grid.rows))
        for column in ends
        if not grid.is_blank(row)
    )


def _side(header: str) -> Side | None:
    plain, bare = key(header), _without_task(header)
    if not bare:
        return "task" if plain else None
    if what := SIDE_OF.get(plain) or SIDE_OF.get(bare):
        return what
    meant = MEANS.get(plain) or MEANS.get(bare)
    return (
        "first"
        if meant == "after"
        else "later"
        if meant == "before"
        else "task"
        if meant in ("task", "number")
        else None
    )


def _turned(header: str) -> Side | None:
    """Beside a column of tasks "After" lists what each comes after; in "Before | After" it is the
    later of a pair.
    """
    meant = MEANS.get(key(header)) or MEANS.get(_without_task(header))
    return "predecessors" if meant == "after" else "successors" if meant == "before" else None


def _without_task(header: str) -> str:
    small = ("der", "des", "the", "of", "ids")
    return " ".join(
        word
        for word in key(header).split()
        if MEANS.get(word) not in ("number", "task") and word not in small
    )


def _is_header_of_pairs(grid: Grid, row: int) -> bool:
    return bool(_sides(grid, row))


def _pairs_below_a_header(
    grid: Grid, references: References, findings: Findings
) -> list[Link] | None:
    header = next(
        (
            row
            for row in range(min(LAST_HEADER_ROW, len(grid.rows)))
            if _is_header_of_pairs(grid, row)
        ),
        None,
    )
    if header is None:
        return None
    sides = _sides(grid, header)
    by_side = {
        side: [column for column, own in sides.items() if own == side]
        for side in dict.fromkeys(sides.values())
    }
    early = [*by_side.get("first", ()), *by_side.get("predecessors", ())]
    late = [*by_side.get("later", ()), *by_side.get("successors", ())]
    tasks = by_side.get("task", [])[:1]
    numbers = References(references.names, references.labels, references.rows, references.counted)
    rows = [row for row in range(header + 1, len(grid.rows)) if not grid.is_blank(row)]
    numbers.agree_on_numbers(
        [grid.value(row, column) for row in rows for column in (*early, *late, *tasks)]
    )
    if numbers.said:
        findings.note(
            "assumed",
            say("numbers.sheet", sheet=repr(grid.name), reading=numbers.said),
            grid.place(header, 0),
        )
    if not ABOUT_PRECEDENCE.search(key(grid.name)):
        if not rows or not all(
            _names_tasks(numbers, grid.value(row, column))
            for row in rows
            for column in (*early, *late, *tasks)
        ):
            return None
        if not NEUTRAL.fullmatch(key(grid.name)) and not any(
            ABOUT_PRECEDENCE.search(key(shown(grid.value(header, column))))
            for column in (*early, *late)
        ):
            findings.note("sheet", say("sheet.pairs", sheet=repr(grid.name)), grid.place(header, 0))
            return []
    links = []
    for row in rows:
        _only_end_to_start(grid, row, by_side, findings)
        read = {
            column: _tasks_at(grid, row, column, numbers, findings)
            for column in (*early, *late, *tasks)
        }
        for firsts, laters in ((early, tasks), (tasks, late)) if tasks else ((early, late),):
            ends = [(column, other) for column in firsts for other in laters]
            links += [
                Link(first, later, grid.place(row, column))
                for column, other in ends
                for first in read[column]
                for later in read[other]
            ]
    _note_read(grid, links, findings)
    return links


def _only_end_to_start(
    grid: Grid, row: int, by_side: dict[Side, list[int]], findings: Findings
) -> None:
    for column in by_side.get("kind", ()):
        value = shown(grid.value(row, column))
        if key(value) not in END_TO_START:
            findings.fault(
                f"holds {value!r}: a sheet of links knows only links from end to start (FS, EA)."
                " Write it so, or, for one between two starts, 'glue (start) >= 0' into a column"
                " 'Wait after' of the task sheet.",
                grid.place(row, column),
            )
    for column in by_side.get("lag", ()):
        value = shown(grid.value(row, column))
        if value and not re.fullmatch(r"[-–—]|[+-]?0+([.,]0+)?\s*[^\W\d]*\.?", value):
            findings.fault(
                f"holds {value!r}: a sheet of links tells no lag between tasks. Write the wait into"
                " a column 'Wait after' of the task sheet, such as 'glue >= 40'.",
                grid.place(row, column),
            )


def _tasks_at(
    grid: Grid, row: int, column: int, references: References, findings: Findings
) -> list[str]:
    value = findings.value(grid, row, column)
    if value is None:
        return []
    try:
        return references.read(value)
    except UnknownTaskError as error:
        findings.fault(sentence(error), grid.place(row, column))
        return []


def sentence(error: UnknownTaskError) -> str:
    """The error as a sentence of its own."""
    text = str(error)
    return text if text.endswith(("?", ".")) else f"{text}."


def _matrix(grid: Grid, references: References, findings: Findings) -> list[Link] | None:
    """A row of tasks, and below its first column tasks again."""
    for header in range(min(LAST_HEADER_ROW, len(grid.rows))):
        filled = list(grid.filled(header))
        heads = {
            column: name
            for column, value in filled
            if (name := references.task(shown(value))) is not None
        }
        if len(heads) < 2 or len(set(heads.values())) < len(heads) or not min(heads):
            continue
        naming = min(heads) - 1
        if naming in heads:
            continue
        rows = {
            row: name
            for row in range(header + 1, len(grid.rows))
            if (name := references.task(shown(grid.value(row, naming)))) is not None
        }
        if len(rows) < 2 or len(set(rows.values())) < len(rows):
            continue
        return _links_of_matrix(grid, header, naming, heads, rows, references, findings)
    return None


def _links_of_matrix(
    grid: Grid,
    header: int,
    naming: int,
    heads: dict[int, str],
    rows: dict[int, str],
    references: References,
    findings: Findings,
) -> list[Link] | None:
    named = bool(ABOUT_PRECEDENCE.search(key(grid.name)))
    marks = []
    for row, name in rows.items():
        for column, other in heads.items():
            marked = is_mark(grid.value(row, column))
            if marked is None and not named:
                return None
            if marked is None:
                findings.fault(
                    f"holds {shown(grid.value(row, column))!r}: a matrix of what comes before what"
                    " holds 1 or 0.",
                    grid.place(row, column),
                )
            elif marked:
                marks.append((name, other, grid.place(row, column)))
    for row in range(header + 1, len(grid.rows)):
        if row not in rows and named and not grid.is_blank(row):
            findings.fault(
                f"holds {shown(grid.value(row, naming))!r}, which is no task.",
                grid.place(row, naming),
            )
    for column, value in grid.filled(header):
        if named and column > naming and column not in heads:
            findings.fault(f"holds {shown(value)!r}, which is no task.", grid.place(header, column))
    rows_first = _said_in_corner(shown(grid.value(header, naming)))
    place = grid.place(header, naming)
    remedy = (
        "Write 'from / to' into the corner if the tasks of the rows come first, 'to / from' if"
        " those of the columns do."
    )
    links = _directed(
        marks,
        rows_first,
        list(references.names),
        "the task of the row",
        "that of the column",
        place,
        remedy,
        findings,
    )
    _note_read(grid, links, findings)
    return links


def _said_in_corner(text: str) -> bool | None:
    r"""Whether the rows come first: "from \ to" says yes, "nach / von" no."""
    ends = [
        side
        for part in re.split(r"[\\/|→>-]+", text)
        if (side := _side(part)) in ("first", "later")
    ]
    return None if len(ends) != 2 or ends[0] == ends[1] else ends[0] == "first"


def _bare_pairs(grid: Grid, references: References, findings: Findings) -> list[Link] | None:
    """Pairs without a header that says which comes first: in two columns, or both in one cell, as
    in "1;2" or "1 -> 2".
    """
    if not ABOUT_PRECEDENCE.search(key(grid.name)):
        return None
    arrows: set[bool] = set()
    pairs: list[tuple[str, str, str]] = []
    for row in range(len(grid.rows)):
        values = [value for _, value in grid.filled(row)]
        columns = [column for column, _ in grid.filled(row)]
        if not values:
            continue
        pair = _pair(values, references)
        if (
            pair is None
            and not pairs
            and not any(
                references.task(piece)
                for value in values
                for piece in re.split(r"[\s;,|/<>→←-]+", shown(value))
            )
        ):
            continue  # titles and a header above the first pair
        if pair is None:
            findings.fault(
                f"holds {' '.join(map(shown, values))!r}, which is no pair of tasks. {WAYS_OUT}.",
                grid.place(row, columns[0]),
            )
            continue
        arrows |= (
            {"<" not in str(values[0]) and "←" not in str(values[0])}
            if re.search(r"[<>→←]", str(values[0]))
            else set()
        )
        pairs.append((*pair, grid.place(row, columns[0])))
    if not pairs:
        return (
            None
            if any(not grid.is_blank(row) for row in range(1, len(grid.rows)))
            else _empty(grid, findings)
        )
    first_leads = arrows.pop() if len(arrows) == 1 else None
    remedy = "Write 'from' and 'to' above two columns of tasks."
    links = _directed(
        pairs,
        first_leads,
        list(references.names),
        "the first",
        "the second",
        pairs[0][2],
        remedy,
        findings,
    )
    _note_read(grid, links, findings)
    return links


def _empty(grid: Grid, findings: Findings) -> list[Link]:
    findings.note("sheet", say("sheet.empty", sheet=repr(grid.name)), f"{grid.name}!A1")
    return []


def _pair(values: Sequence[Value], references: References) -> tuple[str, str] | None:
    texts = [shown(value) for value in values]
    if len(texts) == 1:
        texts = [
            text.strip() for text in re.split(r"\s*(?:->|→|<-|←|>|<|[;,|/]|\s-\s)\s*", texts[0])
        ]
        if len(texts) == 1:
            texts = [text.strip() for text in re.split(r"-|\s+", texts[0])]
    names = [references.task(text) for text in texts]
    if len(names) != 2 or names[0] is None or names[1] is None:
        return None
    return names[0], names[1]


def _note_read(grid: Grid, links: Sequence[Link], findings: Findings) -> None:
    findings.note(
        "assumed",
        say(
            f"sheet.links.{'one' if len(links) == 1 else 'other'}",
            sheet=repr(grid.name),
            n=len(links),
        ),
        f"{grid.name}!A1",
    )


# --- which comes first ----------------------------------------------------------------------------


def _directed(
    pairs: Iterable[tuple[str, str, str]],
    first_leads: bool | None,
    names: list[str],
    one: str,
    other: str,
    place: str,
    remedy: str,
    findings: Findings,
) -> list[Link]:
    """Links out of pairs `(a, b, place)`. Words decide which comes first (`first_leads`), else the
    order of the list, else nobody.
    """
    found = list(pairs)
    if first_leads is None:
        order = {name: at for at, name in enumerate(names)}
        ways = {order[a] < order[b] for a, b, _ in found if a != b}
        if len(ways) > 1:
            message = (
                f"nothing says which of two linked tasks comes first, {one} or {other}, and the"
                " order of the list does not tell."
            )
            findings.fault(f"{message} {remedy}", place)
            return []
        if ways:
            first_leads = ways.pop()
            findings.note(
                "assumed",
                say(f"links.{'before' if first_leads else 'after'}", one=one, other=other),
                place,
            )
    return [Link(a, b, where) if first_leads else Link(b, a, where) for a, b, where in found]


def listed_headers(columns: Iterable[Column]) -> str:
    """The headers of columns in quotes, or their letters."""
    return listed(repr(column.header) if column.header else column.letter for column in columns)
