"""No number of a workbook is silently misread: each is what the planner sees, or is refused at its
cell.
"""

from __future__ import annotations

import datetime
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import openpyxl
import pytest
from tests.files.spreadsheet import books

from tandem.cell.model import Cell
from tandem.errors import CellError
from tandem.files.spreadsheet import import_cell, read_workbook
from tandem.files.spreadsheet.number_format import Dress, dress

HEADER = ["Task", "Time human [s]", "Time robot [s]", "Predecessors", "Stress"]


def text_file(path: Path, *lines: str) -> Path:
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def formatted(
    path: Path,
    rows: Sequence[Sequence[Any]],
    formats: Mapping[str, str],
    merged: Sequence[str] = (),
) -> Path:
    """A workbook whose cells have number formats."""
    book = openpyxl.Workbook()
    target = books.fill(book.active, rows, "Tasks", merged)
    for place, code in formats.items():
        target[place].number_format = code
    book.save(path)
    return path


def times(cell: Cell) -> dict[str, dict[str, float]]:
    return {name: dict(task.time) for name, task in cell.tasks.items()}


def refusal(path: Path, **options: Any) -> str:
    with pytest.raises(CellError) as caught:
        import_cell(path, **options)
    return str(caught.value)


def told(path: Path) -> str:
    return "\n".join(map(str, read_workbook(path).notes))


# --- the decimal mark -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    "lines",
    [
        (
            "Nr;Vorgang;Zeit Mensch [s];Zeit Roboter [s];Vorgänger",
            "1.1;a;12,500;8,250;",
            "1.2;b;10,125;9,000;1.1",
        ),
        (
            "Task,Time human [s],Time robot [s],Predecessors",
            "1,12.500,8.250,",
            "2,10.125,9.000,1",
            '3,11.000,7.500,"1,2"',
        ),
        ("Revision 1.2.3;;", "Task;Time human [s];Time robot [s]", "a;12,500;8,250"),
        ("Stand 01.02.2024;;", "Task;Time human [s];Time robot [s]", "a;12,500;8,250"),
        ("Server 192.168.1.20;;", "Task;Time human [s];Time robot [s]", "a;12,500;8,250"),
        ("Task;Time human [s];Description", "a;12,500;M4 x 1.5", "b;8,250;torque 2.5 Nm"),
        ("Task;Time human [s];Part", "a;12,500;4711.1", "b;8,250;4711.2"),
        ("Task;Time human [s];Time robot [s]", "v1.5;12,500;8,250"),
    ],
)
def test_only_times_and_amounts_are_evidence_of_the_decimal_mark(
    lines: Sequence[str], tmp_path: Path
) -> None:
    message = refusal(text_file(tmp_path / "t.csv", *lines))
    assert "may be 12500 or 12.500" in message
    assert "may be 8250 or 8.250" in message


EVIDENCE = {
    "9,5": 12.5,
    "0,500": 12.5,
    "1.234,5": 12.5,
    "1234,567": 12.5,
    "1,234,567": 12500,
    "1,234.5": 12500,
    "9.5": None,
    "1'234.5": None,
}


@pytest.mark.parametrize(("evidence", "expected"), EVIDENCE.items())
def test_one_number_among_the_times_or_the_stress_is_evidence(
    evidence: str, expected: float | None, tmp_path: Path
) -> None:
    """Of the decimal mark; that the other mark groups thousands needs evidence of its own."""
    among_times = text_file(
        tmp_path / "a.csv", "Task;Time human [s];Stress", "a;12,500;1", f"b;{evidence};2"
    )
    in_stress = text_file(
        tmp_path / "b.csv", "Task;Time human [s];Stress", "a;12,500;1", f"b;3;{evidence}"
    )
    for path in (among_times, in_stress):
        if expected is None:
            assert "!B2: holds '12,500', which may be 12500 or 12.500" in refusal(path)
        else:
            assert times(import_cell(path)[0])["a"] == {"human": expected}


def test_numbers_that_disagree_about_the_decimal_mark_prove_nothing(tmp_path: Path) -> None:
    path = text_file(
        tmp_path / "t.csv", "Task;Time human [s];Stress", "a;12,500;1", "b;9,5;2", "c;8.5;3"
    )
    assert "t!B2: holds '12,500', which may be 12500 or 12.500" in refusal(path)


# --- one number, and nothing glued to it ----------------------------------------------------------

GLUED = [
    "1'30",
    "2'",
    "5 10",
    "01.02.2024",
    "1.5.2",
    "12.30.45",
    "1/2",
    "½",
    "ca. 5",
    "5-7",
    "~8",
    "1:30",
    "1h 20",
    "1 h 20 min",
    "5'10\"",
    '5"',
]
GLUED += [
    "5+3",
    "5 10 s",
    "1200 300",
    "1'2345",
    "12'34",
    "1.20.000",
    "1,2,3",
    "0'200",
    "001.200.000",
    "1 200.300 400",
    "1.200'000",
    "5%",
    "1e3",
    "5-",
]
GLUED += [
    "5\u00ad7",
    "1\n200",
    "1  200",
    "1\t200",
    "12.5.",
    "1..5",
    "5 x",
    "3 Stk",
    "5 m",
    "<5",
    "5?",
    "1，5",
    "5e",
    "--5",
    "1_000",
    "0x10",
    "1 1/2",
]


@pytest.mark.parametrize("text", GLUED)
def test_what_is_no_one_number_is_refused_at_its_cell(text: str, tmp_path: Path) -> None:
    rows = [HEADER, ["a", text, 20, None, 1], ["b", 5, text, None, 1], ["c", 5, 6, None, text]]
    message = refusal(books.sheet(tmp_path / "t.xlsx", rows))
    for place in ("Sheet1!B2", "Sheet1!C3", "Sheet1!E4"):
        assert f"{place}: holds " in message
    assert message.count("\n") == 2


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("1'200", 1200),
        ("1’200", 1200),
        ("1 200", 1200),
        ("1\u00a0200", 1200),
        ("1\u2009200", 1200),
        ("1\u202f200", 1200),
        ("1.200.000", 1_200_000),
        ("1,200,000", 1_200_000),
        ("1 200 000", 1_200_000),
        ("1'200'000,5", 1_200_000.5),
        ("1.200,5", 1200.5),
        ("1,200.5", 1200.5),
        ("1 200,25 s", 1200.25),
        ("12", 12),
        ("１２", 12),
        ("12,5", 12.5),
        (",5", 0.5),
        ("0,500", 0.5),
        ("5s", 5),
        ("5 Sek.", 5),
        ("2 min", 120),
        ("0,5min", 30),
        ("50 HM", 30),
        ("50 1/100 min", 30),
        ("\u200b7\u00a0", 7),
    ],
)
def test_one_number_is_read_as_it_is_written(text: str, expected: float, tmp_path: Path) -> None:
    for name, rows in (
        ("t.xlsx", [HEADER, ["a", text, 20]]),
        ("u.xlsx", [HEADER, ["a", 20, text]]),
    ):
        cell, _ = import_cell(books.sheet(tmp_path / name, rows))
        assert sorted(times(cell)["a"].values()) == sorted([expected, 20])


@pytest.mark.parametrize(
    "value",
    [
        datetime.datetime(2024, 2, 1),
        datetime.date(2024, 2, 1),
        datetime.time(1, 30),
        datetime.timedelta(minutes=90),
        True,
        float(10**13),
    ],
)
def test_typed_cells_that_are_no_plain_number_are_refused(value: object, tmp_path: Path) -> None:
    message = refusal(
        books.sheet(
            tmp_path / "t.xlsx", [HEADER, ["a", value, 20, None, None], ["b", 1, 20, None, value]]
        )
    )
    assert "Sheet1!B2: holds " in message
    assert "Sheet1!E3: holds " in message


@pytest.mark.parametrize("value", [-3, "-3", "−3", "-3 s"])
def test_negative_times_are_refused(value: object, tmp_path: Path) -> None:
    assert "Sheet1!B2: holds" in refusal(
        books.sheet(tmp_path / "t.xlsx", [HEADER, ["a", value, 20]])
    )


@pytest.mark.parametrize("text", ["0'20", "0:30", "0 x", "00:00", "0 Stk", "0/5"])
def test_only_a_lone_zero_says_cannot(text: str, tmp_path: Path) -> None:
    assert "Sheet1!B2: holds" in refusal(
        books.sheet(tmp_path / "t.xlsx", [HEADER, ["a", text, 20]])
    )


# --- merged cells ---------------------------------------------------------------------------------


def merged_file(tmp_path: Path, kind: str, rows: Sequence[Sequence[Any]], area: str) -> Path:
    """The rows with one merged area, "D3:D4", as xlsx, ods or xls."""
    path = tmp_path / f"m.{kind}"
    if kind == "xlsx":
        return books.sheet(path, rows, merged=[area])
    left, top, right, bottom = openpyxl.utils.range_boundaries(area)
    if kind == "ods":
        return books.ods(path, rows, merged=[(top - 1, left - 1, bottom - 1, right - 1)])
    xlwt = pytest.importorskip("xlwt", reason="pip install xlwt")
    book = xlwt.Workbook()
    target = book.add_sheet("Tabelle1")
    for row, values in enumerate(rows):
        for column, value in enumerate(values):
            if value is not None and not (
                top - 1 <= row <= bottom - 1 and left - 1 <= column <= right - 1
            ):
                target.write(row, column, value)
    target.write_merge(top - 1, bottom - 1, left - 1, right - 1, rows[top - 1][left - 1])
    book.save(str(path))
    return path


MERGED_HEADER = [
    "Task",
    "Time human [s]",
    "Time robot [s]",
    "Predecessors",
    "Stress",
    "Latest end [s]",
    "Earliest start [s]",
    "Tool",
    "Same operator as",
]
MERGED_ROWS: list[list[Any]] = [
    MERGED_HEADER,
    ["a", 10, 20, None, 1, None, None, None, None],
    ["b", 12, 30, "a", 4, 99, 3, "driver", "a"],
    ["c", None, None, None, None, None, None, None, None],
    ["d", 7, 8, None, 2, None, None, None, None],
]


@pytest.mark.parametrize("kind", ["xlsx", "ods", "xls"])
@pytest.mark.parametrize(
    ("column", "what"),
    list(enumerate(["time", "time", "after", "stress", "deadline", "release", "tool", "same"], 1)),
)
def test_a_value_merged_downwards_counts_for_every_row(
    kind: str, column: int, what: str, tmp_path: Path
) -> None:
    rows = [list(row) for row in MERGED_ROWS]
    rows[3][2] = None if column == 2 else 5
    letter = "ABCDEFGHI"[column]
    path = merged_file(tmp_path, kind, rows, f"{letter}3:{letter}4")
    cell, notes = import_cell(path)
    b, c = cell.tasks["b"], cell.tasks["c"]
    expected: dict[str, tuple[object, object]] = {
        "time": (
            c.time.get("human" if column == 1 else "robot"),
            b.time["human" if column == 1 else "robot"],
        ),
        "after": (c.after, ("a",)),
        "stress": (c.stress, 4),
        "deadline": (c.deadline, 99),
        "release": (c.release, 3),
        "tool": (c.tool, "driver"),
        "same": (
            {frozenset(pair) for pair in cell.same_operator},
            {frozenset("ab"), frozenset("ac")},
        ),
    }
    assert expected[what][0] == expected[what][1]
    assert f"{letter}3:{letter}4" in "\n".join(map(str, notes))
    assert (cell.tasks["d"].after, cell.tasks["d"].stress, cell.tasks["d"].deadline) == (
        (),
        2,
        None,
    )


@pytest.mark.parametrize("kind", ["xlsx", "ods", "xls"])
def test_a_value_merged_over_two_operators_is_asked_about(kind: str, tmp_path: Path) -> None:
    rows = [HEADER, ["a", 10, 20], ["b", 12, None, "a"]]
    message = refusal(merged_file(tmp_path, kind, rows, "B3:C3"))
    assert (
        "!B3: is merged over B3:C3, so it is not clear what it says of 'Time human [s]', 'Time"
        " robot [s]'" in message
    )


def test_a_block_merged_both_ways_and_a_remark_over_a_time_are_asked_about(tmp_path: Path) -> None:
    rows = [[*HEADER], ["a", 10, 20], ["b", 12, None], ["c", None, None]]
    assert "is merged over B3:C4" in refusal(
        books.sheet(tmp_path / "block.xlsx", rows, merged=["B3:C4"])
    )
    rows = [["Task", "Remark", "Time human [s]"], ["a", "by hand", 5], ["b", "see drawing", None]]
    assert "Sheet1!B3: is merged over B3:C3" in refusal(
        books.sheet(tmp_path / "remark.xlsx", rows, merged=["B3:C3"])
    )


def test_a_faulty_merged_cell_is_told_once_at_its_first_cell(tmp_path: Path) -> None:
    rows = [HEADER, ["a", 10, 20], ["b", "5 10", 3], ["c", None, 3]]
    message = refusal(books.sheet(tmp_path / "t.xlsx", rows, merged=["B3:B4"]))
    assert message.count("holds '5 10'") == 1
    assert "Sheet1!B3" in message


def test_a_unit_in_the_format_of_a_merged_cell_counts_for_its_rows(tmp_path: Path) -> None:
    rows = [["Task", "Time human", "Time robot [s]"], ["a", 1.5, 20], ["b", None, 30]]
    cell, _ = import_cell(
        formatted(tmp_path / "t.xlsx", rows, {"B2": '0.0 "min"'}, merged=["B2:B3"])
    )
    assert times(cell) == {"a": {"human": 90, "robot": 20}, "b": {"human": 90, "robot": 30}}


# --- text files -----------------------------------------------------------------------------------


@pytest.mark.parametrize("separator", [";", ",", "\t", "|"])
@pytest.mark.parametrize(
    ("second", "third", "fourth", "row"),
    [
        ("2;12;30;1;{q}cover", "3;5;6;2;clip", "4;7;8;3;label", 3),
        ("2;12;30;1;cover", "3;5;6;2;clip", "4;7;8;3;{q}label", 5),
        ("2;12;30;1;{q}cover", "3;5;6;2;clip{q}", "4;7;8;3;label", 3),
        ("2;12;30;1;{q}cover", "3;5;6;2;{q}clip", "4;7;8;3;label", 3),
        ("2;{q}12;30;1;cover", "3;{q}5;6;2;clip", "4;7;8;3;label", 3),
        ("2;12;30;1;cover", "{q}3;5;6;2;clip", "4;7;8;3;label", 4),
    ],
)
def test_a_stray_quotation_mark_swallows_no_rows(
    separator: str, second: str, third: str, fourth: str, row: int, tmp_path: Path
) -> None:
    lines = [
        "Nr;Time human [s];Time robot [s];Predecessors;Description",
        "1;10;20;;ok",
        second,
        third,
        fourth,
    ]
    path = text_file(
        tmp_path / "t.csv", *(line.replace(";", separator).format(q='"') for line in lines)
    )
    message = refusal(path)
    assert f"row {row}: a quotation mark is opened" in message
    assert f"{row}: row {row}" in message


def test_texts_of_several_lines_and_marks_within_a_text_are_kept(tmp_path: Path) -> None:
    path = text_file(
        tmp_path / "t.csv",
        '"Nr";"Zeit',
        'Mensch [s]";"Beschreibung"',
        '1;5;"Deckel',
        'oder; je nachdem, Haube"',
        '2;6;Rohr 5" lang',
        '3;7;"Rohr 6"""',
    )
    cell, _ = import_cell(path)
    assert times(cell) == {"1": {"Mensch": 5}, "2": {"Mensch": 6}, "3": {"Mensch": 7}}
    assert [task.label for task in cell.tasks.values()] == [
        "Deckel oder; je nachdem, Haube",
        'Rohr 5" lang',
        'Rohr 6"',
    ]


@pytest.mark.parametrize("line", ["b,12,5,20,a", "b,12,20,a,1,2", "b,12,20,a,1,x,7"])
def test_a_line_with_more_columns_than_the_header_is_refused(line: str, tmp_path: Path) -> None:
    columns = line.count(",") + 1
    header = ["Task", "Time human [s]", "Time robot [s]", "Predecessors", "Description"][
        : columns - 1
    ]
    message = refusal(text_file(tmp_path / "t.csv", ",".join(header), "a,3,4", line))
    assert f"row 3: more columns than the header, which has {len(header)}" in message


# --- abilities are no times -----------------------------------------------------------------------

YES_NO = [
    (1, 0),
    (True, False),
    ("x", None),
    ("ja", "nein"),
    ("TRUE", "FALSE"),
    ("1", "0"),
    ("yes", "no"),
    ("X", "-"),
    ("✓", ""),
]


@pytest.mark.parametrize(("yes", "no"), YES_NO)
@pytest.mark.parametrize(
    "names", [("Human", "Robot"), ("Mensch", "Roboter"), ("Manual", "Cobot"), ("Werker 1", "UR5e")]
)
def test_a_table_of_abilities_is_no_table_of_times(
    yes: Any, no: Any, names: tuple[str, str], tmp_path: Path
) -> None:
    rows = [
        ["Task", *names, "Predecessors"],
        ["a", yes, yes, None],
        ["b", yes, no, "a"],
        ["c", no, yes, "b"],
    ]
    message = refusal(books.sheet(tmp_path / "t.xlsx", rows))
    assert f"Sheet1!B1: '{names[0]}', '{names[1]}': nothing but 1 and 0" in message
    assert f'--map "{names[0]}=time {names[0]} [s]"' in message
    assert message.count("\n") == 0


@pytest.mark.parametrize(("yes", "no"), YES_NO)
def test_abilities_beside_one_column_of_times_are_read_together(
    yes: Any, no: Any, tmp_path: Path
) -> None:
    rows = [
        ["Task", "Time [min]", "Human", "Robot", "Predecessors"],
        ["a", 1.5, yes, yes, None],
        ["b", 2, yes, no, "a"],
        ["c", 0.5, no, yes, "b"],
    ]
    cell, notes = import_cell(books.sheet(tmp_path / "t.xlsx", rows))
    assert times(cell) == {"a": {"Human": 90, "Robot": 90}, "b": {"Human": 120}, "c": {"Robot": 30}}
    said = "\n".join(map(str, notes))
    assert (
        "'Human', 'Robot' say who can do a task; each of them takes the time in 'Time [min]'"
        in said
    )
    if no is not None:
        assert "Human cannot do: c" in said


def test_one_column_of_marks_among_times_is_asked_about(tmp_path: Path) -> None:
    rows = [["Task", "Time human [s]", "Robot"], ["a", 12, 1], ["b", 9, 0], ["c", 7, 1]]
    assert "Sheet1!C1: 'Robot': nothing but 1 and 0" in refusal(
        books.sheet(tmp_path / "t.xlsx", rows)
    )


def test_times_of_one_second_can_be_told(tmp_path: Path) -> None:
    rows = [["Task", "Human", "Robot"], ["a", 1, 1], ["b", 0, 1]]
    path = books.sheet(tmp_path / "t.xlsx", rows)
    cell, _ = import_cell(path, columns={"Human": "time Human [s]", "Robot": "time Robot [min]"})
    assert times(cell) == {"a": {"Human": 1, "Robot": 60}, "b": {"Robot": 60}}
    assert times(
        import_cell(
            books.sheet(tmp_path / "u.xlsx", [["Task", "Human [s]", "Robot [s]"], *rows[1:]])
        )[0]
    )["a"] == {"Human": 1, "Robot": 1}


def test_abilities_in_one_sheet_and_times_in_another_are_not_read_as_times(tmp_path: Path) -> None:
    book = openpyxl.Workbook()
    books.fill(
        book.active, [["task", "model A", "model B"], [1, 12, 14], [2, 20, 21]], "task_times"
    )
    books.fill(
        book.create_sheet(), [["task", "human", "robot"], [1, 1, 1], [2, 1, 0]], "station_types"
    )
    books.fill(book.create_sheet(), [["predecessor", "successor"], [1, 2]], "precedence_relations")
    book.save(tmp_path / "three.xlsx")
    message = refusal(tmp_path / "three.xlsx")
    assert "station_types!B1: 'human', 'robot': nothing but 1 and 0" in message


# --- units ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("code", "expected"),
    [
        ('0.00 "min"', 90),
        ('0.00" min"', 90),
        ("0.00\\ \\m\\i\\n", 90),
        ('#,##0.0 "Min."', 90),
        ('0.0 "HM"', 0.9),
        ('0.0 "1/100 min"', 0.9),
        ('0.0"s"', 1.5),
        ('0.0 "Sek."', 1.5),
        ('0.0 "h"', 5400),
        ('0 "TMU"', 0.054),
        ('[>=60]0 "s";0.0 "min"', 90),
        ('_-* 0.00 "min"_-;-* 0.00 "min"_-;_-* "-"_-', 90),
        ('[Red]0.0 "(min)"', 90),
    ],
)
@pytest.mark.parametrize("header", ["Time human", "Time human [s]"])
def test_the_unit_in_the_number_format_is_the_one_that_the_planner_sees(
    code: str, expected: float, header: str, tmp_path: Path
) -> None:
    path = formatted(
        tmp_path / "t.xlsx", [["Task", header], ["a", 1.5], ["b", 1.5]], {"B2": code, "B3": code}
    )
    cell, notes = import_cell(path)
    assert times(cell) == {"a": {"human": expected}, "b": {"human": expected}}
    assert "no unit is stated" not in "\n".join(map(str, notes))


@pytest.mark.parametrize(
    "code",
    [
        "[h]:mm:ss",
        "mm:ss",
        "[mm]:ss",
        "h:mm",
        "dd.mm.yyyy",
        '0.0 "Stk"',
        "0.0%",
        '#,##0.00 "€"',
        "0.0,",
        ";;;",
        '0 "m"',
        '"ca. "0',
    ],
)
def test_number_formats_that_show_no_time_are_refused(code: str, tmp_path: Path) -> None:
    rows = [["Task", "Time human [s]", "Time robot [s]"], ["a", 5, 6], ["b", 1500.5, 6]]
    assert "Tasks!B3: " in refusal(formatted(tmp_path / "t.xlsx", rows, {"B3": code}))


@pytest.mark.parametrize(
    "code",
    [
        "0.00",
        "#,##0.00",
        "0.0E+00",
        "# ?/?",
        "#,##0;[Red]-#,##0",
        "_-* #,##0.00_-;-* #,##0.00_-",
        "0;-0;;@",
        "[Blue]0.0",
    ],
)
def test_number_formats_without_words_change_nothing(code: str, tmp_path: Path) -> None:
    rows = [["Task", "Time human [s]"], ["a", 1500.5], ["b", 0.25]]
    cell, _ = import_cell(formatted(tmp_path / "t.xlsx", rows, {"B2": code, "B3": code}))
    assert times(cell) == {"a": {"human": 1500.5}, "b": {"human": 0.25}}


def test_a_unit_in_some_cells_and_none_in_others_is_asked_about(tmp_path: Path) -> None:
    rows = [["Task", "Time human"], ["a", 1.5], ["b", 2]]
    assert "Tasks!B3: has no unit, B2 has min" in refusal(
        formatted(tmp_path / "t.xlsx", rows, {"B2": '0.0 "min"'})
    )
    assert "Sheet1!B3: has no unit, B2 has min" in refusal(
        books.sheet(tmp_path / "u.xlsx", [["Task", "Time human"], ["a", "1,5 min"], ["b", 2]])
    )
    cell, _ = import_cell(
        formatted(
            tmp_path / "v.xlsx",
            [["Task", "Time human [HM]"], ["a", 1.5], ["b", 20]],
            {"B2": '0.0 "min"'},
        )
    )
    assert times(cell) == {"a": {"human": 90}, "b": {"human": 12}}


def test_an_old_workbook_must_state_its_unit_because_its_formats_cannot_be_seen(
    tmp_path: Path,
) -> None:
    xlwt = pytest.importorskip("xlwt", reason="pip install xlwt")
    for name, header in (("none.xls", "Time human"), ("min.xls", "Time human [min]")):
        book = xlwt.Workbook()
        target = book.add_sheet("Alt")
        for row, values in enumerate([["Task", header], ["a", 1.5]]):
            for column, value in enumerate(values):
                target.write(row, column, value, xlwt.easyxf(num_format_str='0.0 "min"'))
        book.save(str(tmp_path / name))
    assert "Alt!B1: no unit is stated for 'Time human', and in .xls files" in refusal(
        tmp_path / "none.xls"
    )
    assert times(import_cell(tmp_path / "min.xls")[0]) == {"a": {"human": 90}}


def test_units_that_ods_shows_count(tmp_path: Path) -> None:
    path = books.ods(
        tmp_path / "t.ods",
        [
            ["Task", "Time human"],
            ["a", (1.5, "1,50 min")],
            ["b", (2, "2,00 min")],
            ["c", (1200, "1.200,00 min")],
        ],
    )
    assert times(import_cell(path)[0]) == {
        "a": {"human": 90},
        "b": {"human": 120},
        "c": {"human": 72000},
    }
    assert "!B2: is shown with 'Stk'" in refusal(
        books.ods(tmp_path / "u.ods", [["Task", "Time human"], ["a", (1.5, "1,50 Stk")]])
    )


@pytest.mark.parametrize(
    ("rows", "column"),
    [
        ([["Vorgang", "Spalte 4 [HM]"], ["a", 16.5]], "Spalte 4 [HM]"),
        ([["Vorgang", "Spalte 4 [HM]"], ["a", 16.5]], "B"),
        ([["Vorgang", "Spalte 4 (HM)"], ["a", 16.5]], "Spalte 4"),
        ([["Vorgang", "Spalte 4 in HM"], ["a", 16.5]], "B"),
        ([["Vorgang", "Spalte 4"], [None, "HM"], ["a", 16.5]], "Spalte 4"),
        ([["Vorgang", "Spalte 4"], [None, "[HM]"], ["a", 16.5]], "B"),
        ([["alle Zeiten in HM"], ["Vorgang", "Spalte 4"], ["a", 16.5]], "Spalte 4"),
        ([["Einheit:", "HM"], [], ["Vorgang", "Spalte 4"], ["a", 16.5]], "B"),
        ([[None, "Zeit [HM]"], ["Vorgang", "Spalte 4"], ["a", 16.5]], "Zeit [HM] Spalte 4"),
        ([["Linie 3", "Zeit [HM]"], ["Vorgang", "Spalte 4"], ["a", 16.5]], "Spalte 4"),
        ([["Vorgang", "Spalte 4"], ["a", 16.5], [], ["Alle Zeiten in HM"]], "Spalte 4"),
    ],
)
def test_the_unit_of_the_sheet_counts_for_a_mapped_column(
    rows: list[list[Any]], column: str, tmp_path: Path
) -> None:
    path = books.sheet(tmp_path / "t.xlsx", rows)
    assert times(import_cell(path, columns={column: "time robot"})[0]) == {"a": {"robot": 9.9}}
    assert times(import_cell(path, columns={column: "time robot [s]"})[0]) == {"a": {"robot": 16.5}}


def test_a_unit_that_is_told_counts_more_than_a_number_format_and_less_than_one_typed(
    tmp_path: Path,
) -> None:
    path = formatted(
        tmp_path / "t.xlsx", [["Task", "Dauer"], ["a", 1.5], ["b", "2 min"]], {"B2": '0.0 "Stk"'}
    )
    assert times(import_cell(path, columns={"Dauer": "time robot [s]"})[0]) == {
        "a": {"robot": 1.5},
        "b": {"robot": 120},
    }


@pytest.mark.parametrize(
    ("line", "unit"),
    [
        (["All times in min"], 60),
        (["Alle Zeiten in Minuten angegeben"], 60),
        (["Zeiten [HM]"], 0.6),
        (["Zeitangaben: min"], 60),
        (["Einheit: HM"], 0.6),
        (["Unit", "min"], 60),
        (["Zeiteinheit", "HM"], 0.6),
        (["Vorgabezeiten in TMU"], 0.036),
        (["All times are given in minutes per piece"], 60),
    ],
)
def test_a_line_above_the_header_states_the_unit(
    line: list[str], unit: float, tmp_path: Path
) -> None:
    rows = [["Line 3"], line, ["Task", "Time human"], ["a", 50]]
    assert times(import_cell(books.sheet(tmp_path / "t.xlsx", rows))[0]) == {
        "a": {"human": pytest.approx(50 * unit)}
    }


def test_lines_that_contradict_each_other_about_the_unit_are_asked_about(tmp_path: Path) -> None:
    rows = [["Zeiten in min"], ["alle Angaben in HM"], ["Task", "Time human"], ["a", 50]]
    assert "Sheet1!B3: no unit is stated for 'Time human', and none can be assumed" in refusal(
        books.sheet(tmp_path / "t.xlsx", rows)
    )
    rows = [["Takt [min]: 2"], ["Task", "Time human"], ["a", 50]]
    assert "none can be assumed beside 'Takt [min]: 2' (Sheet1!A1)" in refusal(
        books.sheet(tmp_path / "u.xlsx", rows)
    )


@pytest.mark.parametrize(
    "unit",
    [
        "0.1 min",
        "1/10 s",
        "10 s",
        "d",
        "m",
        "'",
        "%",
        "s/min",
        "0.1 min/Stück",
        "min x 100",
        "Tage",
        "d pro Teil",
        "s, min",
    ],
)
@pytest.mark.parametrize("header", ["Zeit Mensch [{}]", "Time human ({})", "Dauer [{}] Roboter"])
def test_a_unit_that_is_not_known_is_refused(unit: str, header: str, tmp_path: Path) -> None:
    path = books.sheet(
        tmp_path / "t.xlsx", [["Task", header.format(unit), "Time robot 2 [s]"], ["a", 2, 3]]
    )
    assert "Sheet1!B1: " in refusal(path)


@pytest.mark.parametrize("unit", ["min/Stück", "min pro Teil", "min/Stk.", "min per piece"])
@pytest.mark.parametrize("header", ["Zeit Mensch [{}]", "Time human ({})", "Dauer [{}] Mensch"])
def test_a_known_unit_per_piece_is_that_unit_times_the_pieces(
    unit: str, header: str, tmp_path: Path
) -> None:
    rows = [["Task", header.format(unit), "Anzahl"], ["a", "2,5", 4], ["b", 2, 1]]
    cell, notes = import_cell(books.sheet(tmp_path / "t.xlsx", rows))
    assert [next(iter(own.values())) for own in times(cell).values()] == [600, 120]
    assert any("multiplied by 'Anzahl'" in note.message for note in notes)


@pytest.mark.parametrize(
    "line", ["alle Zeiten in min pro Stück", "Times in min/piece", "Einheit: min je Teil"]
)
def test_a_line_that_speaks_of_times_per_piece_is_asked_about(line: str, tmp_path: Path) -> None:
    rows = [[line], ["Task", "Zeit Mensch", "Anzahl"], ["a", 1.5, 2]]
    assert (
        "Sheet1!B2: no unit is stated for 'Zeit Mensch', and none can be assumed beside"
        in refusal(books.sheet(tmp_path / "t.xlsx", rows))
    )
    rows[1][1] = "Zeit Mensch [min/Stück]"
    assert times(import_cell(books.sheet(tmp_path / "u.xlsx", rows))[0]) == {"a": {"Mensch": 180}}


def test_a_number_of_pieces_that_cannot_be_read_is_one_fault(tmp_path: Path) -> None:
    rows = [["Task", "Zeit/Stück Mensch [s]", "Menge"], ["a", "1,5", "1.000"], ["b", 2, 3]]
    message = refusal(books.sheet(tmp_path / "t.xlsx", rows))
    assert "Sheet1!C2: holds '1.000', which may be 1000 or 1.000" in message
    assert "how many pieces" not in message


def test_a_unit_that_is_not_known_can_be_told(tmp_path: Path) -> None:
    path = books.sheet(tmp_path / "t.xlsx", [["Task", "Zeit Mensch [0,1 min]"], ["a", 2]])
    assert "'0,1 min' is no one unit that Tandem knows" in refusal(path)
    assert times(import_cell(path, columns={"B": "time Mensch [s]"})[0]) == {"a": {"Mensch": 2}}


@pytest.mark.parametrize(
    "header", ["Zeit Mensch [s] (min)", "Zeit Mensch [s] [HM]", "Zeit Mensch 0,1 min"]
)
def test_two_units_or_a_part_of_one_in_a_header_are_refused(header: str, tmp_path: Path) -> None:
    assert "is no one unit that Tandem knows" in refusal(
        books.sheet(tmp_path / "t.xlsx", [["Task", header], ["a", 2]])
    )


@pytest.mark.parametrize(
    "header",
    [
        "Time (Anna) [s]",
        "Zeit [s] (UR5)",
        "Zeit (Werker 2) [s]",
        "Time (Robot S) [s]",
        "Zeit Anna S. [s]",
        "Time robot 2 s",
    ],
)
def test_a_name_in_brackets_is_no_unit(header: str, tmp_path: Path) -> None:
    path = books.sheet(tmp_path / "t.xlsx", [["Task", header], ["a", 2]])
    draft = read_workbook(path)
    assert [list(task["time"].values()) for task in draft.document["tasks"].values()] == [[2]]
    assert not any("unit" in fault.message for fault in draft.faults)


@pytest.mark.parametrize("header", ["Einheit", "Unit", "Zeiteinheit", "UoM"])
def test_units_in_a_column_of_their_own_are_not_passed_over(
    header: str | None, tmp_path: Path
) -> None:
    rows = [["Task", "Time human", header], ["a", 2, "min"], ["b", 30, "s"]]
    assert "Sheet1!C2: " in refusal(books.sheet(tmp_path / "t.xlsx", rows))
    rows = [["Task", "Time human [s]", header], ["a", 2, "s"], ["b", 30, "s"]]
    assert times(import_cell(books.sheet(tmp_path / "u.xlsx", rows))[0]) == {
        "a": {"human": 2},
        "b": {"human": 30},
    }


@pytest.mark.parametrize(
    ("below", "expected"), [("s", 50), ("[s]", 50), ("min", None), ("HM", None)]
)
def test_a_row_of_units_that_repeats_the_header_or_contradicts_it(
    below: str, expected: float | None, tmp_path: Path
) -> None:
    path = books.sheet(
        tmp_path / "t.xlsx",
        [["Task", "Time human [s]", "Time robot"], [None, below, "s"], ["a", 50, 6]],
    )
    if expected is None:
        assert (
            f"none can be assumed beside 'Time human [s]' and '{below}' below it (Sheet1!B2)"
            in refusal(path)
        )
    else:
        assert times(import_cell(path)[0]) == {"a": {"human": expected, "robot": 6}}


# --- the scale of stress --------------------------------------------------------------------------

SCALES = [
    "Stress (0-10)",
    "Stress (1–7)",
    "Belastung [Pkt.]",
    "Belastung [Punkte]",
    "Stress [N]",
    "Stress (low/high)",
    "Belastung (niedrig - hoch)",
    "Stress [kg]",
]
SCALES += [
    "Stress 0-10",
    "Belastung in Punkten",
    "Stress (0 = low, 10 = high)",
    "Ergonomic load [1 to 10]",
    "Stress <0..10>",
    "Stress {1-5}",
    "EAWS [Pkt]",
]


@pytest.mark.parametrize("header", SCALES)
def test_what_stands_in_brackets_behind_stress_is_its_scale(header: str, tmp_path: Path) -> None:
    rows = [
        ["Task", "Time human [s]", "Time robot [s]", header],
        ["a", 10, 20, 1],
        ["b", 12, 30, 2],
    ]
    cell, _ = import_cell(books.sheet(tmp_path / "t.xlsx", rows))
    assert {name: task.stress for name, task in cell.tasks.items()} == {"a": 1, "b": 2}


@pytest.mark.parametrize(
    "header",
    [
        "Stress (Anna)",
        "Stress [Anna]",
        "Stress Anna (0-10)",
        "Stress (0-10) Anna",
        "Belastung Anna [Pkt.]",
    ],
)
def test_brackets_that_name_an_operator_still_do(header: str, tmp_path: Path) -> None:
    rows = [["Task", "Anna [s]", "Ben [s]", header], ["a", 10, 20, 1]]
    cell, _ = import_cell(books.sheet(tmp_path / "t.xlsx", rows), humans=["Anna", "Ben"])
    assert cell.tasks["a"].stress == {"Anna": 1}


def test_brackets_that_name_an_operator_of_the_rows_do_so_too(tmp_path: Path) -> None:
    rows = [
        ["Task", "Operator", "Time [s]", "Stress (Anna)"],
        ["a", "Anna", 10, 3],
        [None, "Ben", 12, None],
    ]
    assert import_cell(books.sheet(tmp_path / "t.xlsx", rows), humans=["Anna", "Ben"])[0].tasks[
        "a"
    ].stress == {"Anna": 3}


def test_a_misspelt_operator_in_brackets_is_no_scale(tmp_path: Path) -> None:
    rows = [["Task", "Anna [s]", "Ben [s]", "Stress (Ana)"], ["a", 10, 20, 1]]
    assert "stress names 'Ana'" in refusal(
        books.sheet(tmp_path / "t.xlsx", rows), humans=["Anna", "Ben"]
    )


@pytest.mark.parametrize(
    ("header", "value", "code", "expected"),
    [
        ("Stress [%]", 30, "General", 30),
        ("Stress [%]", 0.3, "0%", 30),
        ("Stress [%]", 0.3, "0.0 %", 30),
        ("Stress", 0.3, "0%", 0.3),
        ("Stress in Prozent", 30, "0", 30),
    ],
)
def test_percentages_of_stress_are_said_and_count_as_shown(
    header: str, value: float, code: str, expected: float, tmp_path: Path
) -> None:
    rows = [["Task", "Time human [s]", header], ["a", 10, value]]
    cell, notes = import_cell(formatted(tmp_path / "t.xlsx", rows, {"C2": code}))
    assert cell.tasks["a"].stress == expected
    if "%" in code:
        assert f"30 % is {expected:g}" in "\n".join(map(str, notes))


def test_percentages_among_plain_numbers(tmp_path: Path) -> None:
    rows = [["Task", "Time human [s]", "Stress"], ["a", 10, 30], ["b", 10, 0.4]]
    assert "Tasks!C2: is no percentage, and Tasks!C3 is one" in refusal(
        formatted(tmp_path / "t.xlsx", rows, {"C3": "0%"})
    )
    rows[0][2] = "Stress [%]"
    cell, _ = import_cell(formatted(tmp_path / "u.xlsx", rows, {"C3": "0%"}))
    assert [task.stress for task in cell.tasks.values()] == [30, 40]


def test_a_spread_in_per_cent_is_a_fraction_of_the_time(tmp_path: Path) -> None:
    rows = [["Task", "Time human [s]", "Spread [%]"], ["a", 10, 20], ["b", 10, 0.15]]
    cell, _ = import_cell(formatted(tmp_path / "t.xlsx", rows, {"C3": "0%"}))
    assert [task.spread for task in cell.tasks.values()] == [0.2, 0.15]


def test_stress_of_everybody_does_not_overwrite_that_of_one(tmp_path: Path) -> None:
    rows = [["Task", "Anna [s]", "Ben [s]", "Stress Anna", "Stress"], ["a", 10, 20, 1, 7]]
    assert "Sheet1!E2: gives stress of everybody although task 'a' has one for each" in refusal(
        books.sheet(tmp_path / "t.xlsx", rows), humans=["Anna", "Ben"]
    )


# --- task numbers with a decimal comma ------------------------------------------------------------


def after(path: Path) -> dict[str, tuple[str, ...]]:
    return {name: task.after for name, task in import_cell(path)[0].tasks.items()}


@pytest.mark.parametrize(
    ("said", "expected"),
    [
        ("1,3", ("1.3",)),
        ("1,1; 1,2", ("1.1", "1.2")),
        ("1.1, 1.2", ("1.1", "1.2")),
        (1.3, ("1.3",)),
        ("1,1;1.3", ("1.1", "1.3")),
    ],
)
@pytest.mark.parametrize("as_number", [True, False])
def test_a_decimal_comma_in_a_task_number_is_understood(
    said: object, expected: tuple[str, ...], as_number: bool, tmp_path: Path
) -> None:
    names = [1.1, 1.2, 1.3, 1.4] if as_number else ["1.1", "1.2", "1.3", "1.4"]
    rows = [["Nr", "Time human [s]", "Predecessors"], *[[name, 5, None] for name in names]]
    rows[4][2] = said
    assert after(books.sheet(tmp_path / "t.xlsx", rows))["1.4"] == expected


def test_task_numbers_that_may_mean_several_things_are_refused(tmp_path: Path) -> None:
    rows = [
        ["Nr", "Time human [s]", "Predecessors"],
        [1, 5, None],
        [3, 5, None],
        [1.3, 5, None],
        [4, 5, "1,3"],
    ]
    assert "Sheet1!C5: holds '1,3', which may be task 1.3 or tasks 1 and 3" in refusal(
        books.sheet(tmp_path / "t.xlsx", rows)
    )
    rows = [
        ["Nr", "Time human [s]", "Predecessors"],
        ["1.1", 5, None],
        ["1.10", 5, None],
        ["1.2", 5, 1.1],
    ]
    assert "Sheet1!C4: holds the number 1.1, which may be task 1.1 or 1.10" in refusal(
        books.sheet(tmp_path / "u.xlsx", rows)
    )
    rows = [
        ["Nr", "Time human [s]", "Predecessors"],
        ["1.1", 5, None],
        ["1.2", 5, None],
        ["2.1", 5, 2],
    ]
    assert "Sheet1!C4: holds '2', which is no task" in refusal(
        books.sheet(tmp_path / "v.xlsx", rows)
    )
    rows = [
        ["Nr", "Time human [s]", "Predecessors"],
        ["1.1", 5, None],
        ["1.3", 5, None],
        ["1.4", 5, "1,3,1,4"],
    ]
    assert "Sheet1!C4: holds '1'" in refusal(books.sheet(tmp_path / "w.xlsx", rows))


# --- number formats alone -------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("code", "value", "expected"),
    [
        ("General", 1.5, Dress()),
        ('0.0 "min"', 1.5, Dress("min")),
        ('0.0 "min";-0.0 "s"', -1, Dress("s")),
        ('0.0 "min";-0.0 "s";"none"', 0, Dress("none")),
        ("[$€-407] #,##0.00", 1.5, Dress("€")),
        ("0.0,", 1500, Dress(scaled=True)),
        (";;;", 1.5, Dress(hidden=True)),
        (";;;", 0, Dress()),
        ("[h]:mm:ss", 0.5, Dress()),
        ('"a;b" 0', 1, Dress("a;b")),
        ("#,##0_);(#,##0)", -5, Dress()),
    ],
)
def test_what_a_number_format_writes_around_a_number(
    code: str, value: float, expected: Dress
) -> None:
    assert dress(code, value) == expected
