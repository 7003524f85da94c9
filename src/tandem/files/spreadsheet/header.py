"""Finds the table in a sheet: which rows are its header, and what each column means.

Planners put titles above, merge "Time [s]" over one column per operator, and write units into a row
of their own. Every row near the top is tried as the header, alone and with the row above it; the
one whose columns say most wins.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

from tandem.cell.names import key
from tandem.files.spreadsheet.grid import Grid, Value, blank, letters, shown, tidy
from tandem.files.spreadsheet.said import Said, say
from tandem.files.spreadsheet.units import unit_said
from tandem.files.spreadsheet.values import cannot, is_number, says_able, unit_named
from tandem.files.spreadsheet.vocabulary import SCALE, Meaning, meaning, split_unit

LAST_HEADER_ROW = 60
WEIGHTS = {
    "number": 2.0,
    "task": 2.0,
    "label": 2.0,
    "after": 2.0,
    "after rows": 2.0,
    "time": 3.0,
    "operator": 1.5,
    "ignore": 0.2,
}
TIMED = ("time", "release", "deadline")
LISTS = ("after", "after rows", "before", "same operator")
"""What a column of lists of tasks can mean."""
NOBODYS = {*LISTS, "number", "task", "label", "part"}
"""What a column means for the task alone, never for one of its operators."""
TASK_WORDS = {
    *WEIGHTS,
    "part",
    "tool",
    "zone",
    "place",
    "release",
    "deadline",
    "same operator",
    "wait",
    "before",
    "stress",
    "difficulty",
    "spread",
}
TASK_WORDS |= {"outline number", "outline level", "milestone", "quantity"}
"""What a column of a task sheet can mean."""


@dataclass(frozen=True)
class Column:
    """One column of the table.

    Attributes:
      index: counted from 0.
      header: what stands above it, units included; empty when nothing does.
      place: of its header, `Sheet1!C3`.
      meaning: None when it is not read.
      why: why it is not read, or what was assumed.
    """

    index: int
    header: str
    place: str
    meaning: Meaning | None
    why: Said | None = None

    @property
    def letter(self) -> str:
        """What the column is called in the sheet: C."""
        return letters(self.index)


@dataclass(frozen=True)
class Table:
    """A header and where the rows below it begin.

    Attributes:
      first_row: of the data, counted from 0.
      header_row: the last row of the header proper.
      title: the first text above the header; "" when there is none.
      unit: the unit of all times, when a line above the header or below the table says so ("all
        times in min").
      unit_line: that line and its place; "" when there is none.
      doubt: why no unit may be assumed where none is stated; "" when there is no reason.
    """

    grid: Grid
    header_row: int
    first_row: int
    columns: tuple[Column, ...]
    title: str = ""
    unit: str | None = None
    unit_line: str = ""
    doubt: str = ""

    def having(self, *what: str) -> tuple[Column, ...]:
        """Columns with one of these meanings."""
        return tuple(
            column
            for column in self.columns
            if column.meaning is not None and column.meaning.what in what
        )

    @property
    def holds_tasks(self) -> bool:
        """There is a name for each task, and a time."""
        return bool(
            self.having("number", "task", "label", "outline number") and self.having("time")
        )


Reader = Callable[[str, int], Meaning | None]
"""Header text and column -> meaning."""


def find_table(
    grid: Grid, known: tuple[str, ...] = (), overrides: Mapping[str, Meaning | None] | None = None
) -> Table | None:
    """The task table of a sheet, or None when no row reads like a header.

    Args:
      known: operators known from elsewhere.
      overrides: header text or column letters -> meaning; None for a column not to be read.
    """
    chosen = overrides or {}
    by_key = {key(header): what for header, what in chosen.items()}

    def read(text: str, column: int) -> Meaning | None:
        place = re.sub(r"\d+", "", grid.place(0, column).rpartition("!")[2])
        bare, unit = split_unit(text)
        if (name := next((name for name in (text, place) if name in chosen), None)) is not None:
            return _in_unit(chosen[name], unit)
        if (
            text
            and (name := next((name for name in (key(text), key(bare)) if name in by_key), None))
            is not None
        ):
            return _in_unit(by_key[name], unit)
        found = meaning(text, known) if text else None
        # "Anzahl" is how many there are of a tool, and how many pieces a task has
        if found is not None and found.what == "capacity":
            return replace(found, what="quantity")
        return found if found is None or found.what in TASK_WORDS else None

    return best_table(grid, read)


def _in_unit(told: Meaning | None, unit: str | None) -> Meaning | None:
    """What `--map` says of a column, in the unit that the sheet states unless it states one
    itself.
    """
    return (
        replace(told, unit=told.unit or unit)
        if told is not None and told.what in (*TIMED, "wait")
        else told
    )


def best_table(grid: Grid, read: Reader) -> Table | None:
    """The header whose columns `read` understands best; None when it understands none of any
    row.
    """
    best: tuple[float, Table] | None = None
    for row in range(min(len(grid.rows), LAST_HEADER_ROW)):
        for above in (0, 1):
            if row - above < 0 or not any(isinstance(value, str) for _, value in grid.filled(row)):
                continue
            if _units_in(grid, row) or (above and _is_a_line(grid, row - 1, row)):
                continue
            table = _table(grid, row, above, read)
            score = _score(grid, table, row)
            if score >= 2 and (best is None or score > best[0] + 1e-9):
                best = score, table
    return None if best is None else _with_context(grid, best[1])


def _is_a_line(grid: Grid, row: int, header_row: int) -> bool:
    """The row is a title or a remark: one text, over the first column of the header below it."""
    texts = [column for column, _ in grid.filled(row)]
    first = next((column for column, _ in grid.filled(header_row)), 0)
    return len(texts) == 1 and grid.spread_of(row, texts[0])[1] <= first


def _table(grid: Grid, row: int, above: int, read: Reader) -> Table:
    headers = [_header(grid, row, above, column, read) for column in range(grid.width)]
    first, doubt = row + 1, ""
    below = _units_in(grid, first) if first < len(grid.rows) else {}
    if below:
        said = {
            column: (split_unit(headers[column])[1], unit_named(text))
            for column, text in below.items()
        }
        contradicted = next((column for column, units in said.items() if _differ(*units)), None)
        if contradicted is not None:
            doubt = (
                f"{headers[contradicted]!r} and {below[contradicted]!r} below it"
                f" ({grid.place(first, contradicted)})"
            )
        headers = [
            _with_unit(text, below.get(column), bool(doubt)) for column, text in enumerate(headers)
        ]
        first += 1
    columns = []
    for column, text in enumerate(headers):
        columns.append(Column(column, text, grid.place(row, column), read(text, column)))
    return Table(grid, row, first, tuple(columns), doubt=doubt)


def _units_in(grid: Grid, row: int) -> dict[int, str]:
    """Column -> unit, for a row that holds units of time, perhaps scales of other things beside
    them, and nothing else.
    """
    texts = {column: shown(value).strip("[]() ") for column, value in grid.filled(row)}
    all_units = all(
        unit_named(text) or SCALE.fullmatch(text.casefold().rstrip(".")) for text in texts.values()
    )
    return texts if all_units and any(map(unit_named, texts.values())) else {}


def _differ(stated: str | None, below: str | None) -> bool:
    return stated is not None and below is not None and stated != below


def _with_unit(header: str, below: str | None, doubt: bool) -> str:
    """The header with the unit of the row below it; without any when the two contradict each other
    somewhere.
    """
    bare, unit = split_unit(header)
    if below is None or (unit and not doubt):
        return header
    return bare if doubt else f"{header} [{unit_named(below) or below}]"


def _header(grid: Grid, row: int, above: int, column: int, read: Reader) -> str:
    texts = [_text_at(grid, row, column)]
    if above:
        upper = _text_at(grid, row - 1, column)
        own = read(texts[0], column) if texts[0] and not upper else None
        # "Predecessors" is nobody's, whatever stands over the columns to its left
        if not upper and texts[0] and (own is None or own.what not in NOBODYS):
            left = column
            # "Time [s]" stands over the first of its columns, merged or not
            while left > 0 and not upper:
                left -= 1
                upper = _text_at(grid, row - 1, left)
        texts.insert(0, upper)
    return tidy(" ".join(dict.fromkeys(text for text in texts if text)))


def _text_at(grid: Grid, row: int, column: int) -> str:
    top, left, _, _ = grid.spread_of(row, column)
    value = grid.rows[top][left]
    return tidy(value) if isinstance(value, str) else shown(value)


def _score(grid: Grid, table: Table, row: int) -> float:
    found: set[tuple[str, object]] = set()
    score = 0.0
    for column in table.columns:
        if column.meaning is None or blank(column.header):
            continue
        what = column.meaning
        if (what.what, (what.who, what.human)) in found:
            score -= 1.0
            continue
        found.add((what.what, (what.who, what.human)))
        score += (
            WEIGHTS.get(what.what, 1.0) - (0.0 if what.sure else 1.0) + (0.25 if what.unit else 0.0)
        )
    naming = next(
        (
            table.having(what)[0].index
            for what in ("number", "task", "label", "outline number")
            if table.having(what)
        ),
        None,
    )
    tasks = (
        {shown(grid.value(below, naming)) for below in range(table.first_row, len(grid.rows))}
        if naming is not None
        else set()
    )
    numbers = [shown(value) for _, value in grid.filled(row) if is_number(value)]
    # a matrix of precedence is headed by the tasks themselves
    return score - sum(1 for text in numbers if text not in tasks)


def _with_context(grid: Grid, table: Table) -> Table:
    first_of_header = table.header_row
    texts = []
    for row in range(first_of_header):
        for _, value in grid.filled(row):
            if isinstance(value, str):
                texts.append(tidy(value))
    header_texts = {column.header for column in table.columns}
    inside = {word for header in header_texts for word in (header,)}
    titles = [
        text
        for text in texts
        if re.search(r"[^\W\d]{2}", text) and not any(text in header for header in inside)
    ]
    unit, line = unit_said(grid, table.header_row, table.first_row, bool(table.having("quantity")))
    columns = tuple(_reconsidered(grid, table, column) for column in table.columns)
    unit, line = (None, table.doubt) if table.doubt else (unit, line)
    return replace(
        table,
        columns=columns,
        title=titles[0][:200] if titles else "",
        unit=unit,
        unit_line=line if unit else "",
        doubt="" if unit else line,
    )


def amounts_of(table: Table) -> Iterator[Value]:
    """What stands in the columns of times and amounts: the cells that show how this sheet writes
    decimals.
    """
    for column in table.having(
        *TIMED,
        "stress",
        "difficulty",
        "spread",
        "stress limit",
        "capacity",
        "quantity",
        "changeover",
        "walking speed",
        "x",
        "y",
    ):
        yield from (
            table.grid.rows[row][column.index]
            for row in range(table.first_row, len(table.grid.rows))
        )


def _reconsidered(grid: Grid, table: Table, column: Column) -> Column:
    """What a column holds says what its header leaves open: one called "Robot" that holds names
    says who does the task, not how long it takes, and one called "Operator" that holds numbers
    beside the times of others is one more operator's time.
    """
    if column.meaning is None or (column.meaning.sure and column.meaning.what != "operator"):
        return column
    values = [grid.rows[row][column.index] for row in range(table.first_row, len(grid.rows))]
    if column.meaning.what == "operator":
        others = any(other.meaning and other.meaning.who for other in table.having("time"))
        held = [value for value in values if not blank(value)]
        if others and held and all(map(_says_how_long_or_whether, held)):
            return replace(column, meaning=Meaning("time", (column.header,), sure=False))
        return column
    if all(says_able(value) is not None for value in values if not blank(value)):
        return column
    words = sum(1 for value in values if not cannot(value) and not is_number(value))
    if words * 2 > sum(1 for value in values if not blank(value)):
        return replace(column, meaning=None, why=say("why.texts"))
    return column


def _says_how_long_or_whether(value: Value) -> bool:
    """A number, with its unit perhaps, or a mark of who can do it; no name."""
    begins = isinstance(value, str) and re.match(r"[\d.,]*\d", tidy(value)) is not None
    return begins or is_number(value) or cannot(value) or says_able(value) is not None
