"""A sound workbook, damaged in every way that planners damage theirs: the cell is what the sheet
then shows, or it is refused.

Each test says what the sheet shows after its mutation. A mutation that may be refused never changes
a number, and one that leaves the meaning alone changes nothing at all.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import openpyxl
import pytest
from openpyxl.utils import get_column_letter
from tests.files.spreadsheet import books

from tandem.cell.model import Cell
from tandem.errors import CellError
from tandem.files.spreadsheet import import_cell

Work = dict[str, dict[str, Any]]
"""Task -> its times, stress, predecessors and moments."""


@dataclass(frozen=True)
class Sheet:
    """What a planner has on the screen, to be written as a workbook or as text."""

    rows: tuple[tuple[Any, ...], ...]
    formats: dict[tuple[int, int], str] = field(default_factory=dict)
    merged: tuple[str, ...] = ()
    hidden: tuple[int, ...] = ()

    def put(self, row: int, column: int, value: Any) -> Sheet:
        rows = [list(values) for values in self.rows]
        rows[row][column] = value
        return replace(self, rows=tuple(map(tuple, rows)))

    def insert_row(self, at: int, *values: Any) -> Sheet:
        formats = {
            (row + (row >= at), column): code for (row, column), code in self.formats.items()
        }
        return replace(
            self, rows=(*self.rows[:at], tuple(values), *self.rows[at:]), formats=formats
        )

    def insert_column(self, at: int, *values: Any) -> Sheet:
        return replace(
            self,
            rows=tuple(
                (*row[:at], value, *row[at:])
                for row, value in itertools.zip_longest(self.rows, values)
            ),
        )

    def save(self, path: Path) -> Path:
        book = openpyxl.Workbook()
        target = books.fill(book.active, self.rows, "Plan", self.merged)
        for (row, column), code in self.formats.items():
            target.cell(row + 1, column + 1).number_format = code
        for row in self.hidden:
            target.row_dimensions[row + 1].hidden = True
        book.save(path)
        return path

    def save_text(self, path: Path, separator: str, mark: str = ".") -> Path:
        def field_of(value: Any) -> str:
            text = (
                ""
                if value is None
                else str(value).replace(".", mark)
                if isinstance(value, float)
                else str(value)
            )
            return f'"{text}"' if separator in text else text

        path.write_text(
            "".join(separator.join(map(field_of, row)) + "\n" for row in self.rows),
            encoding="utf-8",
        )
        return path


GERMAN = Sheet(
    (
        (
            "Nr.",
            "Bezeichnung",
            "Zeit Mensch [s]",
            "Zeit Roboter [s]",
            "Belastung",
            "Vorgänger",
            "spätestes Ende [s]",
        ),
        ("T1", "Deckel", 12.5, 8.25, 3.5, None, 500.5),
        ("T2", "Rad", 10.125, 9.75, 2.25, "T1", 510.25),
        ("T3", "Kabel", 11.5, 7.375, 1.125, "T1; T2", 520.125),
        ("T4", "Prüfen", 1250.5, 6.5, 4.75, "T3", 5300.5),
    )
)
ENGLISH = replace(
    GERMAN,
    rows=(
        (
            "Task",
            "Description",
            "Time human [s]",
            "Time robot [s]",
            "Stress",
            "Predecessors",
            "Latest end [s]",
        ),
        *GERMAN.rows[1:],
    ),
)
SHEETS = [pytest.param(GERMAN, id="german"), pytest.param(ENGLISH, id="english")]
TIMES, STRESS, AFTER, END = (2, 3), 4, 5, 6
AMOUNTS = (*TIMES, STRESS, END)
ROWS = range(1, 5)
WORDS = {2: "human", 3: "robot", STRESS: "stress", AFTER: "after", END: "deadline"}


def work_of(sheet: Sheet) -> Work:
    """What the rows show, read by this test alone: no headers, no formats, no units."""
    return {
        row[0]: (
            {WORDS[column]: row[column] for column in AMOUNTS}
            | {"after": tuple((row[AFTER] or "").split("; ")) if row[AFTER] else ()}
        )
        for row in sheet.rows[1:]
    }


def work_in(cell: Cell) -> Work:
    kinds = {name: operator.kind for name, operator in cell.operators.items()}
    return {
        name: {
            **{kinds[who]: time for who, time in task.time.items()},
            "stress": task.stress,
            "after": task.after,
            "deadline": task.deadline,
        }
        for name, task in cell.tasks.items()
    }


def outcome(path: Path) -> Work | str:
    """The work of the imported cell, or the refusal, which names a cell of the sheet."""
    try:
        return work_in(import_cell(path)[0])
    except CellError as error:
        return "\n".join(f"{fault.place}: {fault.message}" for fault in error.faults)


def scaled(work: Work, word: str, factor: float, tasks: Iterator[str] | None = None) -> Work:
    chosen = set(tasks) if tasks is not None else set(work)
    return {
        name: (
            {**row, word: pytest.approx(row[word] * factor, abs=0.0006)}
            if name in chosen and row[word] is not None
            else row
        )
        for name, row in work.items()
    }


@pytest.fixture
def tried(tmp_path: Path) -> Callable[[Sheet], Work | str]:
    numbers = itertools.count()
    return lambda sheet: outcome(sheet.save(tmp_path / f"{next(numbers)}.xlsx"))


@pytest.mark.parametrize("sheet", SHEETS)
def test_the_sheet_itself_is_read_as_it_stands(sheet: Sheet, tried: Any, tmp_path: Path) -> None:
    assert tried(sheet) == work_of(sheet)
    for ending, separator, mark in (
        ("csv", ";", ","),
        ("csv", ";", "."),
        ("csv", ",", "."),
        ("tsv", "\t", ","),
    ):
        assert outcome(
            sheet.save_text(tmp_path / f"{ord(separator)}{ord(mark)}.{ending}", separator, mark)
        ) == work_of(sheet)
    assert outcome(books.ods(tmp_path / "t.ods", sheet.rows)) == work_of(sheet)


# --- units ----------------------------------------------------------------------------------------

UNITS = {"s": 1, "Min.": 60, "HM": 0.6, "1/100 min": 0.6, "TMU": 0.036, "h": 3600}


@pytest.mark.parametrize("sheet", SHEETS)
@pytest.mark.parametrize("unit", UNITS)
def test_a_changed_unit_changes_its_column_and_no_other(
    sheet: Sheet, unit: str, tried: Any
) -> None:
    for column in (*TIMES, END):
        header = sheet.rows[0][column]
        expected = scaled(work_of(sheet), WORDS[column], UNITS[unit])
        bare = sheet.put(0, column, header.replace(" [s]", ""))
        for changed in (
            sheet.put(0, column, header.replace("[s]", f"[{unit}]")),
            sheet.put(0, column, header.replace("[s]", f"({unit})")),
            bare.insert_row(
                1, *(unit if c == column else "s" if c in (*TIMES, END) else None for c in range(7))
            ),
            replace(bare, formats={(row, column): f'0.00 "{unit}"' for row in ROWS}),
            replace(sheet, formats={(row, column): f'0.00 "{unit}"' for row in ROWS}),
        ):
            found = tried(changed)
            assert found == expected or (isinstance(found, str) and "Plan!" in found)


@pytest.mark.parametrize("sheet", SHEETS)
@pytest.mark.parametrize("unit", UNITS)
def test_a_unit_in_one_cell_changes_that_cell_alone(sheet: Sheet, unit: str, tried: Any) -> None:
    for row, column in itertools.product(ROWS, (*TIMES, END)):
        value = sheet.rows[row][column]
        expected = scaled(work_of(sheet), WORDS[column], UNITS[unit], iter([sheet.rows[row][0]]))
        for changed in (
            sheet.put(row, column, f"{value:.4f} {unit}"),
            sheet.put(
                row, column, f"{value:.4f}{' ' * unit[0].isdigit()}{unit}".replace(".", ",", 1)
            ),
            replace(sheet, formats={(row, column): f'0.00 "{unit}"'}),
        ):
            found = tried(changed)
            assert found == expected or (isinstance(found, str) and "deadline" in found)
        bare = sheet.put(0, column, sheet.rows[0][column].replace(" [s]", ""))
        assert "has no unit" in tried(replace(bare, formats={(row, column): f'0.00 "{unit}"'}))


@pytest.mark.parametrize("sheet", SHEETS)
def test_a_unit_of_time_behind_a_stress_is_refused(sheet: Sheet, tried: Any) -> None:
    for row in ROWS:
        assert f"Plan!E{row + 1}: holds" in tried(sheet.put(row, STRESS, "3,5 min"))
        assert f"Plan!E{row + 1}: holds" in tried(
            replace(sheet, formats={(row, STRESS): '0.0 "min"'})
        )


# --- decimal marks --------------------------------------------------------------------------------


def spellings(value: float) -> Iterator[str]:
    """The number as Germans, the English and the Swiss type it."""
    for decimals in (3, 4):
        english = f"{value:,.{decimals}f}"
        yield english
        yield english.replace(",", "\0").replace(".", ",").replace("\0", ".")
        yield english.replace(",", "'")
        yield english.replace(",", "\u00a0").replace(".", ",")
        yield f"{value:.{decimals}f}"
        yield f"{value:.{decimals}f}".replace(".", ",")


@pytest.mark.parametrize("sheet", SHEETS)
def test_a_number_typed_as_text_is_the_same_or_refused(sheet: Sheet, tried: Any) -> None:
    for row, column in itertools.product(ROWS, AMOUNTS):
        place = f"Plan!{get_column_letter(column + 1)}{row + 1}: holds"
        for text in dict.fromkeys(spellings(sheet.rows[row][column])):
            found = tried(sheet.put(row, column, text))
            assert found == work_of(sheet) or (isinstance(found, str) and place in found), text


@pytest.mark.parametrize("separator", [";", "\t", "|"])
@pytest.mark.parametrize("marks", [(".", ","), (",", "."), (",", ","), (".", ".")])
def test_text_files_with_one_or_two_decimal_marks(
    separator: str, marks: tuple[str, str], tmp_path: Path
) -> None:
    """Three decimals everywhere, so that every number may be a thousand; the columns may be written
    in different ways.
    """
    rows = [list(row) for row in GERMAN.rows]
    for row, column in itertools.product(ROWS, AMOUNTS):
        rows[row][column] = f"{rows[row][column]:.3f}".replace(".", marks[column % 2])
    found = outcome(Sheet(tuple(map(tuple, rows))).save_text(tmp_path / "t.csv", separator))
    assert found == work_of(GERMAN) or (isinstance(found, str) and "which may be" in found)


@pytest.mark.parametrize("column", [0, 1, 5])
@pytest.mark.parametrize("text", ["1.1", "1,1", "1.2.3", "01.02.2024", "10.0.0.1", "1,234.5"])
def test_texts_of_other_columns_are_no_evidence(column: int, text: str, tmp_path: Path) -> None:
    rows = [list(row) for row in GERMAN.rows]
    for row, amount in itertools.product(ROWS, AMOUNTS):
        rows[row][amount] = f"{rows[row][amount]:.3f}".replace(".", ",")
    rows[4][6] = "5300,500" if column else rows[4][6]
    plain = outcome(Sheet(tuple(map(tuple, rows))).save_text(tmp_path / "plain.csv", ";"))
    rows[4][column] = text
    found = outcome(Sheet(tuple(map(tuple, rows))).save_text(tmp_path / "t.csv", ";"))
    numbers = (
        [{word: row[word] for word in ("human", "robot", "stress")} for row in found.values()]
        if isinstance(found, dict)
        else None
    )
    assert numbers is None or numbers == [
        {word: row[word] for word in ("human", "robot", "stress")}
        for row in work_of(GERMAN).values()
    ]
    assert isinstance(plain, dict) or "which may be" in plain


# --- merged and split cells -----------------------------------------------------------------------


@pytest.mark.parametrize("sheet", SHEETS)
def test_cells_merged_downwards_show_one_value_for_all_their_rows(sheet: Sheet, tried: Any) -> None:
    for column, top, bottom in itertools.product((*AMOUNTS, AFTER), ROWS, ROWS):
        if top >= bottom:
            continue
        letter, expected = get_column_letter(column + 1), sheet
        for row in range(top + 1, bottom + 1):
            expected = expected.put(row, column, sheet.rows[top][column])
        found = tried(replace(sheet, merged=(f"{letter}{top + 1}:{letter}{bottom + 1}",)))
        assert found == work_of(expected) or (isinstance(found, str) and "Plan!" in found)
        if column != AFTER:
            assert found == work_of(expected)


@pytest.mark.parametrize("sheet", SHEETS)
def test_names_merged_downwards_and_cells_merged_across_are_refused(
    sheet: Sheet, tried: Any
) -> None:
    for row in ROWS[:-1]:
        assert "Plan!A" in tried(replace(sheet, merged=(f"A{row + 1}:A{row + 2}",)))
    for row, left, right in itertools.product(ROWS, range(1, 7), range(2, 7)):
        if left < right and sheet.rows[row][left] is not None:
            first, last = get_column_letter(left + 1), get_column_letter(right + 1)
            found = tried(replace(sheet, merged=(f"{first}{row + 1}:{last}{row + 1}",)))
            assert isinstance(found, str)
            assert f"{row + 1}: is merged over" in found


@pytest.mark.parametrize("sheet", SHEETS)
def test_a_column_of_numbers_split_in_two_is_refused(
    sheet: Sheet, tried: Any, tmp_path: Path
) -> None:
    for column in AMOUNTS:
        halves = [str(row[column]).split(".") for row in sheet.rows[1:]]
        split = sheet.insert_column(column + 1, None, *(int(half[1]) for half in halves))
        for row, half in enumerate(halves, 1):
            split = split.put(row, column, int(half[0]))
        letters = get_column_letter(column + 1), get_column_letter(column + 2)
        for changed in (
            split,
            replace(split, merged=(f"{letters[0]}1:{letters[1]}1",)),
            split.put(0, column + 1, sheet.rows[0][column]),
        ):
            found = tried(changed)
            assert isinstance(found, str)
            assert "Plan!" in found
    found = outcome(
        Sheet(
            tuple(
                tuple(str(v).replace(".", ",") if isinstance(v, float) else v for v in row)
                for row in sheet.rows
            )
        ).save_text(tmp_path / "t.csv", "\0")
    )
    assert isinstance(found, str)


def test_decimal_commas_in_a_file_with_commas_are_refused(tmp_path: Path) -> None:
    lines = [
        ",".join(
            "" if v is None else str(v).replace(".", ",") if isinstance(v, float) else str(v)
            for v in row
        )
        for row in ENGLISH.rows
    ]
    (tmp_path / "t.csv").write_text("\n".join(lines))
    assert "more columns than the header" in str(outcome(tmp_path / "t.csv"))


# --- headers, rows and columns --------------------------------------------------------------------


@pytest.mark.parametrize("sheet", SHEETS)
def test_a_shifted_header_is_refused(sheet: Sheet, tried: Any) -> None:
    header, body = sheet.rows[0], sheet.rows[1:]
    assert isinstance(tried(Sheet(((None, *header), *((*row, None) for row in body)))), str)
    assert isinstance(tried(Sheet(((*header[1:], None), *body))), str)
    for column in range(1, 6):
        shifted = Sheet(
            ((*header[:column], None, *header[column:]), *((*row, None) for row in body))
        )
        assert isinstance(tried(shifted), str), column


@pytest.mark.parametrize("sheet", SHEETS)
def test_rows_and_columns_that_say_nothing_change_nothing(sheet: Sheet, tried: Any) -> None:
    work = work_of(sheet)
    for at in range(6):
        assert tried(sheet.insert_row(at)) == work
    for title in ("Station 3", "Stand 01.02.2024", "Version 1.2.3", "Montage 12,5"):
        assert tried(sheet.insert_row(0, title)) == work
        assert tried(sheet.insert_row(0).insert_row(0, title)) == work
        assert tried(replace(sheet.insert_row(0, title, *[None] * 6), merged=("A1:G1",))) == work
    for at in (*ROWS, 5):
        assert tried(sheet.insert_row(at, *sheet.rows[0])) == work
        assert (
            tried(
                replace(
                    sheet.insert_row(at, "Vormontage", *[None] * 6),
                    merged=(f"A{at + 1}:G{at + 1}",),
                )
            )
            == work
        )
    for row in ROWS:
        assert tried(replace(sheet, hidden=(row,))) == work
    for at in range(8):
        assert tried(sheet.insert_column(at)) == work
        assert tried(sheet.insert_column(at, "Bemerkung", "x", 2, "1,5", "3.000")) == work


@pytest.mark.parametrize("sheet", SHEETS)
def test_a_row_of_totals_changes_nothing(sheet: Sheet, tried: Any) -> None:
    sums = [sum(row[column] for row in sheet.rows[1:]) for column in TIMES]
    for name in ("Summe", "Total", "Gesamt", "Σ", "Durchschnitt"):
        assert tried(sheet.insert_row(5, name, None, *sums, None, None, None)) == work_of(sheet)
    assert tried(sheet.insert_row(5, None, None, *sums, None, None, None)) == work_of(sheet)
    assert tried(
        sheet.insert_row(5).insert_row(6, None, "Summe", *sums, None, None, None)
    ) == work_of(sheet)


@pytest.mark.parametrize("sheet", SHEETS)
def test_columns_in_any_order_are_the_same(sheet: Sheet, tried: Any) -> None:
    for order in itertools.islice(itertools.permutations(range(7)), 0, 5040, 210):
        assert tried(
            Sheet(tuple(tuple(row[column] for column in order) for row in sheet.rows))
        ) == work_of(sheet)


# --- number formats -------------------------------------------------------------------------------

HARMLESS = [
    "0",
    "0.00",
    "#,##0.00",
    "0.0E+00",
    "# ?/?",
    "_-* #,##0.00_-;-* #,##0.00_-",
    "[Blue]0.0",
    "@",
    "0.0;[Red]-0.0",
]
REFUSED = ["0.0,", ";;;", "[h]:mm:ss", "mm:ss", "dd.mm.yyyy", "yyyy-mm-dd hh:mm", '0.0 "h":mm']


def cells_refused(message: str) -> set[tuple[str, int]]:
    """Column and row of each cell that the faults name; faults alike of a column are told once,
    with all their rows.
    """
    cells = set()
    for letter, row, rows in re.findall(
        r"^Plan!([A-Z]+)(\d+): (?:column \1 .*?, rows ([^:]*), as here: )?", message, re.MULTILINE
    ):
        for first, last in re.findall(r"(\d+)(?: to (\d+))?", rows or row):
            cells |= {(letter, number) for number in range(int(first), int(last or first) + 1)}
    return cells


@pytest.mark.parametrize("sheet", SHEETS)
def test_a_number_format_changes_no_number_in_silence(sheet: Sheet, tried: Any) -> None:
    for code in HARMLESS:
        assert tried(
            replace(sheet, formats=dict.fromkeys(itertools.product(ROWS, AMOUNTS), code))
        ) == work_of(sheet), code
    for code in (*REFUSED, "0%", '0.0 "Stk"', '#,##0.00 "€"'):
        columns = AMOUNTS if code in REFUSED else (*TIMES, END)
        found = tried(replace(sheet, formats=dict.fromkeys(itertools.product(ROWS, columns), code)))
        assert cells_refused(found) == {
            (get_column_letter(column + 1), row + 1)
            for row, column in itertools.product(ROWS, columns)
        }, code
    assert "is no percentage" in tried(replace(sheet, formats={(2, STRESS): "0%"}))
    assert tried(replace(sheet, formats={(row, STRESS): "0%" for row in ROWS})) == work_of(sheet)


# --- two at once ----------------------------------------------------------------------------------


def test_two_harmless_mutations_at_once_change_nothing(tried: Any) -> None:
    changes: list[Callable[[Sheet], Sheet]] = [
        lambda s: s.insert_row(0, "Stand 01.02.2024"),
        lambda s: s.insert_row(len(s.rows) - 2),
        lambda s: s.insert_row(len(s.rows), "Summe", *[None] * 6),
        lambda s: s.insert_column(7, *[None] * (len(s.rows) - 4), "x"),
        lambda s: replace(s, hidden=(len(s.rows) - 1,)),
        lambda s: replace(
            s,
            rows=tuple(
                tuple(f"\u00a0{v} " if isinstance(v, str) else v for v in row) for row in s.rows
            ),
        ),
        lambda s: replace(
            s,
            rows=tuple(
                tuple(str(v).replace(".", ",") if isinstance(v, float) else v for v in row)
                for row in s.rows
            ),
        ),
    ]
    for one, other in itertools.permutations(changes, 2):
        for sheet in (GERMAN, ENGLISH):
            found = tried(other(one(sheet)))
            assert found == work_of(sheet) or (isinstance(found, str) and "which may be" in found)
