"""Signs that the table is not what its header says: a number split over two columns, a line of text
torn apart, a header shifted.
"""

from __future__ import annotations

from collections.abc import Mapping

from tandem.files.spreadsheet.findings import Findings, listed
from tandem.files.spreadsheet.grid import blank, letters
from tandem.files.spreadsheet.header import TIMED, Column, Table
from tandem.files.spreadsheet.values import is_number

AMOUNTS = (*TIMED, "stress", "difficulty", "spread")


def refuse_values_beyond_the_header(
    table: Table, columns: list[Column], rows: list[int], findings: Findings
) -> None:
    """Faults where values stand below no header and look as if they belonged to a neighbour."""
    below = {
        c.index: [row for row in rows if not blank(table.grid.rows[row][c.index])]
        for c in columns
        if not c.header and c.meaning is None
    }
    if longer := _longer_than_the_header(table, below, rows):
        end = table.grid.lengths[table.header_row]
        message = (
            f"row {listed(row + 1 for row in longer)}: more columns than the header, which has"
            f" {end}. Was a decimal comma or a list split? Put the text in quotes, or save the"
            " sheet with semicolons."
        )
        findings.fault(message, table.grid.place(longer[0], end))
        return
    _refuse_split_numbers(table, columns, below, findings)
    _refuse_a_shifted_header(table, columns, below, rows, findings)


def _longer_than_the_header(
    table: Table, below: Mapping[int, list[int]], rows: list[int]
) -> list[int]:
    """Rows of a text file with values behind the last column that the header's line has."""
    lengths, values = table.grid.lengths, table.grid.rows
    if not lengths:
        return []
    end = lengths[table.header_row]
    return [
        row
        for row in rows
        if any(
            column in below and not blank(values[row][column])
            for column in range(end, lengths[row])
        )
    ]


def _refuse_split_numbers(
    table: Table, columns: list[Column], below: Mapping[int, list[int]], findings: Findings
) -> None:
    for index, filled in below.items():
        left = next(
            (
                c
                for c in columns
                if c.index == index - 1 and c.meaning and c.meaning.what in AMOUNTS
            ),
            None,
        )
        numbers = [row for row in filled if is_number(table.grid.rows[row][index])]
        if left is not None and numbers:
            letter = letters(index)
            message = (
                f"column {letter} has no header, and numbers stand in it beside {left.header!r}."
                " Was a column split? Give it a "
                f'header, or leave it out with --map "{letter}=ignore".'
            )
            findings.fault(message, table.grid.place(numbers[0], index))


def _refuse_a_shifted_header(
    table: Table,
    columns: list[Column],
    below: Mapping[int, list[int]],
    rows: list[int],
    findings: Findings,
) -> None:
    """The first column is full and has no header, and the last header has nothing below it."""
    last = max((c for c in columns if c.header), key=lambda c: c.index)
    if (
        rows
        and len(below.get(0, ())) == len(rows)
        and last.meaning
        and all(blank(table.grid.value(row, last.index)) for row in rows)
    ):
        message = (
            f"column A has values and no header, and {last.header!r} a header and no values. Is the"
            ' header shifted? Give column A a header, or leave it out with --map "A=ignore".'
        )
        findings.fault(message, table.grid.place(table.header_row, 0))
