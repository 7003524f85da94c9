"""The structure of a workbook is never silently lost: what comes before what, which rows are tasks,
who takes part.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import openpyxl
import pytest
from openpyxl.styles import Alignment
from tests.files.spreadsheet import books

from tandem.errors import CellError
from tandem.files.spreadsheet import import_cell, read_workbook
from tandem.files.spreadsheet.draft import Draft

Rows = Sequence[Sequence[Any]]

EN = ["Task", "Time human [s]", "Time robot [s]"]
DE = ["Nr.", "Zeit Mensch [s]", "Zeit Roboter [s]"]
LETTERS: Rows = [EN, ["a", 10, 20], ["b", 12, 30], ["c", 5, 6]]
NUMBERS: Rows = [DE, [1, 10, 20], [2, 12, 30], [3, 5, 6]]
CHAIN = {"a": (), "b": ("a",), "c": ("b",)}
AT_ONCE = "no column states what comes before what: every task may begin at once"


def xlsx(path: Path, rows: Rows) -> Path:
    return books.sheet(path.with_suffix(".xlsx"), rows)


def ods(path: Path, rows: Rows) -> Path:
    width = max(map(len, rows))
    return books.ods(
        path.with_suffix(".ods"), [[*row, *[None] * (width - len(row))] for row in rows]
    )


def csv(path: Path, rows: Rows) -> Path:
    text = "\n".join(
        ";".join("" if value is None else f'"{value}"' for value in row) for row in rows
    )
    path.with_suffix(".csv").write_text(text, "utf-8")
    return path.with_suffix(".csv")


FORMATS = [xlsx, ods, csv]


def workbook(path: Path, sheets: dict[str, Rows]) -> Path:
    book = openpyxl.Workbook()
    book.remove(book.active)
    for name, rows in sheets.items():
        books.fill(book.create_sheet(), rows, name)
    book.save(path / "book.xlsx")
    return path / "book.xlsx"


def draft(path: Path, rows: Rows, **options: Any) -> Draft:
    return read_workbook(workbook(path, {"Tasks": rows}), **options)


def after(found: Draft) -> dict[str, tuple[str, ...]]:
    return {name: task.after for name, task in found.cell().tasks.items()}


def said(found: Draft) -> str:
    return "\n".join(map(str, found.notes))


def refusal(found: Draft) -> str:
    with pytest.raises(CellError) as caught:
        found.cell()
    return str(caught.value)


# --- what comes before what: columns --------------------------------------------------------------


@pytest.mark.parametrize("write", FORMATS)
@pytest.mark.parametrize(
    ("first", "second"),
    [
        ("Predecessors", ""),
        ("Predecessors", "Predecessors"),
        ("Predecessor 1", "Predecessor 2"),
        ("Vorgänger 1", "Vorgänger 2"),
        ("Pred. 1", "Pred. 2"),
        ("Vorgänger", "abhängig von"),
    ],
)
def test_several_columns_of_predecessors_are_joined(
    write: Callable[[Path, Rows], Path], first: str, second: str, tmp_path: Path
) -> None:
    rows = [
        [*EN, first, second],
        ["a", 10, 20, None, None],
        ["b", 12, 30, None, None],
        ["c", 5, 6, "a", "b"],
    ]
    cell, _ = import_cell(write(tmp_path / "tasks", rows))
    assert {name: task.after for name, task in cell.tasks.items()} == {
        "a": (),
        "b": (),
        "c": ("a", "b"),
    }


def test_several_columns_of_successors_are_joined_with_the_predecessors(tmp_path: Path) -> None:
    rows = [
        [*EN, "Successor 1", "Successor 2", "After"],
        ["a", 10, 20, "b", "c"],
        ["b", 12, 30],
        ["c", 5, 6, None, None, "b"],
    ]
    assert after(draft(tmp_path, rows)) == {"a": (), "b": ("a",), "c": ("a", "b")}


def test_a_list_of_commas_that_csv_tore_apart_is_put_together(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text(
        "task,human [s],predecessors\na,1,\nb,2,a\nc,3,a,b\nd,4,a,b,c\n"
    )
    cell, _ = import_cell(tmp_path / "t.csv")
    assert {name: task.after for name, task in cell.tasks.items()} == {
        "a": (),
        "b": ("a",),
        "c": ("a", "b"),
        "d": ("a", "b", "c"),
    }


@pytest.mark.parametrize("line", ["3,4,5,1", "3,4,,1,2", "3,4.5,1,2"])
def test_numbers_that_csv_tore_apart_may_be_decimals_and_are_asked_about(
    line: str, tmp_path: Path
) -> None:
    (tmp_path / "t.csv").write_text(f"task,human [s],predecessors\n1,1,\n2,2,1\n{line}\n")
    assert "t!D4: row 4: more columns than the header, which has 3" in refusal(
        read_workbook(tmp_path / "t.csv")
    )


def test_a_column_of_remarks_behind_the_predecessors_is_none_of_them(tmp_path: Path) -> None:
    found = draft(
        tmp_path,
        [
            [*EN, "Predecessors", None],
            ["a", 10, 20],
            ["b", 12, 30, "a", "oil first"],
            ["c", 5, 6, "b", "check"],
        ],
    )
    assert after(found) == CHAIN
    assert "column E, which has no header, was not read" in said(found)


def test_a_slip_in_a_column_of_tasks_without_header_is_asked_about(tmp_path: Path) -> None:
    rows = [
        [*EN, "Predecessors", None],
        ["a", 1, 2],
        ["b", 1, 2, "a"],
        ["c", 1, 2, "a", "b"],
        ["d", 1, 2, "a", "b"],
        ["e", 1, 2, "a", "zz"],
    ]
    message = refusal(draft(tmp_path, rows))
    assert "Tasks!E6: holds 'zz', which is no task" in message
    assert '--map "E=ignore"' in message


@pytest.mark.parametrize(
    "header", ["Anzahl Vorgänger", "Number of predecessors", "Predecessor type"]
)
def test_what_only_speaks_of_predecessors_is_no_list_of_them(header: str, tmp_path: Path) -> None:
    found = draft(
        tmp_path,
        [[*DE, "Vorgänger", header], [1, 10, 20, None, 0], [2, 12, 30, 1, 1], [3, 5, 6, 2, 1]],
    )
    assert after(found) == {"1": (), "2": ("1",), "3": ("2",)}
    assert f"{header!r} was not read" in said(found)


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        ("2;4", ("2", "4")),
        ("2-4", ("2", "3", "4")),
        ("2 4", ("2", "4")),
        ("2EA;4FS", ("2", "4")),
        ("2FS+0 d", ("2",)),
        ("2-FS=P0D;4", ("2", "4")),
    ],
)
def test_lists_as_project_tools_write_them(
    value: str, expected: tuple[str, ...], tmp_path: Path
) -> None:
    rows = [[*DE, "Vorgänger"], *[[number, 10, 20] for number in range(1, 5)], [5, 1, 1, value]]
    assert after(draft(tmp_path, rows))["5"] == expected


@pytest.mark.parametrize("value", ["3FS+2d", "3EA+2 Tage", "3SS", "3FF-1", "2;3AA"])
def test_lags_and_other_links_are_refused(value: str, tmp_path: Path) -> None:
    rows = [[*DE, "Vorgänger"], *[[number, 10, 20] for number in range(1, 4)], [4, 1, 1, value]]
    assert "Tasks!D5: holds" in (message := refusal(draft(tmp_path, rows)))
    assert "only end-to-start" in message or "no task" in message


# --- nothing says it ------------------------------------------------------------------------------


@pytest.mark.parametrize("write", FORMATS)
@pytest.mark.parametrize("rows", [LETTERS, NUMBERS], ids=["en", "de"])
def test_where_nothing_says_what_comes_first_the_import_says_so(
    write: Callable[[Path, Rows], Path], rows: Rows, tmp_path: Path
) -> None:
    _, notes = import_cell(write(tmp_path / "tasks", rows))
    assert any(AT_ONCE in note.message and note.kind == "assumed" for note in notes)


def test_an_empty_column_of_predecessors_is_told(tmp_path: Path) -> None:
    found = draft(tmp_path, [[*EN, "Predecessors"], *LETTERS[1:]])
    assert (
        "Tasks!D1: 'Predecessors' holds no task: nothing comes before anything, every task may"
        " begin at once" in said(found)
    )


def test_nothing_is_told_where_something_comes_first(tmp_path: Path) -> None:
    assert "begin at once" not in said(
        draft(tmp_path, [[*EN, "After"], *LETTERS[1:3], ["c", 5, 6, "a"]])
    )


# --- what comes before what: sheets of their own --------------------------------------------------

PAIRS: dict[str, Rows] = {
    "from, to": [["from", "to"], ["a", "b"], ["b", "c"]],
    "to, from": [["to", "from"], ["b", "a"], ["c", "b"]],
    "von, nach": [["von", "nach"], ["a", "b"], ["b", "c"]],
    "titles above": [
        ["Vorranggraph Station 3"],
        [],
        ["Predecessor", "Successor"],
        ["a", "b"],
        ["b", "c"],
    ],
    "each with its predecessors": [["Vorgang", "Vorgänger"], ["b", "a"], ["c", "b"]],
    "each with its successors": [["Task", "Successors"], ["a", "b"], ["b", "c"]],
    "both beside the task": [
        ["Task", "Predecessor", "Successor"],
        ["a", None, "b"],
        ["b", "a", "c"],
        ["c", "b", None],
    ],
    "numbered pairs": [["No.", "Predecessor", "Successor"], [1, "a", "b"], [2, "b", "c"]],
    "before, after": [["before", "after"], ["a", "b"], ["b", "c"]],
    "links of the one kind that is known": [
        ["von", "nach", "Typ", "Abstand"],
        ["a", "b", "EA", 0],
        ["b", "c", "FS", None],
    ],
    "no header": [["a", "b"], ["b", "c"]],
    "no header, turned": [["b", "a"], ["c", "b"]],
    "both in one cell": [["precedence_relations"], ["a;b"], ["b;c"]],
    "arrows": [["a -> b"], ["b → c"]],
    "arrows to the left": [["b <- a"], ["c <- b"]],
    "a matrix": [[None, "a", "b", "c"], ["a", 0, 1, 0], ["b", 0, 0, 1], ["c", 0, 0, 0]],
    "a matrix of crosses, turned": [[None, "a", "b", "c"], ["a"], ["b", "x"], ["c", None, "x"]],
    "a matrix with directions": [
        ["nach \\ von", "a", "b", "c"],
        ["a"],
        ["b", "x"],
        ["c", None, "x"],
    ],
}


@pytest.mark.parametrize("rows", PAIRS.values(), ids=PAIRS)
def test_a_sheet_of_pairs_or_a_matrix_is_read(rows: Rows, tmp_path: Path) -> None:
    found = read_workbook(workbook(tmp_path, {"Tasks": LETTERS, "precedence": rows}))
    assert after(found) == CHAIN
    assert "sheet 'precedence' is read as what comes before what" in said(found)


def test_words_in_the_corner_count_more_than_the_order_of_the_list(tmp_path: Path) -> None:
    turned: Rows = [["von / nach", "a", "b", "c"], ["a"], ["b", "x"], ["c", None, "x"]]
    assert after(read_workbook(workbook(tmp_path, {"Tasks": LETTERS, "Vorrang": turned}))) == {
        "a": ("b",),
        "b": ("c",),
        "c": (),
    }


def test_pairs_and_a_column_are_joined(tmp_path: Path) -> None:
    sheets = {
        "Tasks": [[*EN, "Predecessors"], *LETTERS[1:2], ["b", 12, 30, "a"], ["c", 5, 6]],
        "Nachfolger": [["Vorgang", "Nachfolger"], ["b", "c"]],
    }
    assert after(read_workbook(workbook(tmp_path, sheets))) == CHAIN


def test_pairs_are_known_by_their_header_in_a_sheet_without_a_name(tmp_path: Path) -> None:
    assert (
        after(read_workbook(workbook(tmp_path, {"Tasks": LETTERS, "Sheet2": PAIRS["from, to"]})))
        == CHAIN
    )


def test_from_and_to_of_something_else_are_left_alone(tmp_path: Path) -> None:
    sheets: dict[str, Rows] = {
        "Tasks": NUMBERS,
        "Schichten": [["von", "nach"], [1, 2], [2, 3]],
        "Kosten": [["from", "to"], ["Ulm", "Bonn"]],
    }
    found = read_workbook(workbook(tmp_path, sheets))
    assert after(found) == {"1": (), "2": (), "3": ()}
    assert "sheet 'Schichten' was not read, though its columns could be pairs of tasks" in said(
        found
    )
    assert "sheet 'Kosten' was not read" in said(found)


@pytest.mark.parametrize(
    "name",
    [
        "precedence",
        "precedence_relations",
        "Vorrang",
        "Vorrangbeziehungen",
        "Vorgänger",
        "successors",
        "Nachfolger",
        "Abhängigkeiten",
    ],
)
def test_a_sheet_that_is_called_so_and_cannot_be_read_is_refused_by_name(
    name: str, tmp_path: Path
) -> None:
    message = refusal(
        read_workbook(workbook(tmp_path, {"Tasks": LETTERS, name: [["foo", "bar"], ["x", 3]]}))
    )
    assert f"{name}!A1: by its name the sheet holds what comes before what" in message


@pytest.mark.parametrize(
    ("rows", "place", "words"),
    [
        (
            [["from", "to"], ["a", "b"], ["b", "cc"]],
            "Vorrang!B3",
            "holds 'cc', which is no task. Did you mean 'c'",
        ),
        ([["a", "b"], ["b", "cc"]], "Vorrang!A2", "holds 'b cc', which is no pair of tasks"),
        (
            [["b", "a"], ["b", "c"]],
            "Vorrang!A1",
            "nothing says which of two linked tasks comes first",
        ),
        (
            [[None, "a", "b", "c"], ["a", None, 1], ["b"], ["c", None, 1]],
            "Vorrang!A1",
            "nothing says which of two linked tasks comes first",
        ),
        (
            [[None, "a", "b", "cc"], ["a", None, 1], ["b", None, None, 1], ["c"]],
            "Vorrang!D1",
            "holds 'cc', which is no task",
        ),
        ([["von", "nach", "Typ"], ["a", "b", "AA"]], "Vorrang!C2", "only links from end to start"),
        ([["von", "nach", "Abstand"], ["a", "b", 5]], "Vorrang!C2", "no lag between tasks"),
    ],
)
def test_a_pair_that_is_not_clear_is_refused_with_its_place(
    rows: Rows, place: str, words: str, tmp_path: Path
) -> None:
    message = refusal(read_workbook(workbook(tmp_path, {"Tasks": LETTERS, "Vorrang": rows})))
    assert any(line.startswith(f"- {place}: ") and words in line for line in message.splitlines())


def test_another_list_of_tasks_is_no_precedence(tmp_path: Path) -> None:
    found = read_workbook(
        workbook(
            tmp_path,
            {
                "Vorgänge": NUMBERS,
                "Vorgänge alt": [["foo"], ["x"]],
                "success rate": [["foo"], ["x"]],
            },
        )
    )
    assert after(found) == {"1": (), "2": (), "3": ()}
    assert "sheet 'Vorgänge alt' was not read" in said(found)


def test_a_hidden_sheet_of_precedence_is_not_passed_over(tmp_path: Path) -> None:
    path = workbook(tmp_path, {"Tasks": LETTERS, "Vorrang": PAIRS["von, nach"]})
    book = openpyxl.load_workbook(path)
    book["Vorrang"].sheet_state = "hidden"
    book.save(path)
    assert (
        "sheet 'Vorrang' is hidden and was not read, though by its name it says what comes before"
        " what" in refusal(read_workbook(path))
    )


# --- what comes before what: a matrix among the tasks ---------------------------------------------


@pytest.mark.parametrize("write", FORMATS)
@pytest.mark.parametrize(
    "marks",
    [
        [[0, 1, 0], [0, 0, 1], [0, 0, 0]],
        [[None, "x", None], [None, None, "x"], [None, None, None]],
        [[0, 0, 0], [1, 0, 0], [0, 1, 0]],
    ],
    ids=["down", "crosses", "turned"],
)
def test_a_matrix_beside_the_times_is_read(
    write: Callable[[Path, Rows], Path], marks: Rows, tmp_path: Path
) -> None:
    rows = [
        [*EN, "a", "b", "c"],
        *[[*row, *line] for row, line in zip(LETTERS[1:], marks, strict=True)],
    ]
    cell, notes = import_cell(write(tmp_path / "tasks", rows))
    assert {name: task.after for name, task in cell.tasks.items()} == CHAIN
    assert any("read as a matrix of what comes before what" in note.message for note in notes)


@pytest.mark.parametrize(
    ("word", "expected"),
    [("Vorgänger", ("2",)), ("Nachfolger", ()), ("Predecessors", ("2",)), ("Successors", ())],
)
def test_the_word_above_a_matrix_says_which_comes_first(
    word: str, expected: tuple[str, ...], tmp_path: Path
) -> None:
    rows = [
        [None, None, None, word],
        [*DE, 1, 2, 3],
        [1, 10, 20, 0, 0, 0],
        [2, 12, 30, 1, 0, 0],
        [3, 5, 6, 0, 1, 0],
    ]
    assert after(draft(tmp_path, rows))["3"] == expected


def test_a_matrix_headed_by_many_numbers_is_a_header_all_the_same(tmp_path: Path) -> None:
    count = 12
    rows = [
        [*DE, *range(1, count + 1)],
        *[[i, 3, 4, *[int(j == i + 1) for j in range(1, count + 1)]] for i in range(1, count + 1)],
    ]
    assert after(draft(tmp_path, rows))["12"] == ("11",)


def test_a_matrix_that_runs_both_ways_through_the_list_is_asked_about(tmp_path: Path) -> None:
    rows = [[*EN, "a", "b", "c"], ["a", 10, 20, None, "x"], ["b", 12, 30], ["c", 5, 6, None, "x"]]
    message = refusal(draft(tmp_path, rows))
    assert "Tasks!D1: nothing says which of two linked tasks comes first" in message
    assert "Write 'Predecessors' above the columns" in message


# --- summaries and milestones ---------------------------------------------------------------------

WBS = ["WBS", "Task name", "Time human [s]", "Time robot [s]", "Predecessors"]
HOUSING: Rows = [
    ["1", "Housing", 22, 50, None],
    ["1.1", "Insert bearing", 10, 20, None],
    ["1.2", "Drive screws", 12, 30, "1.1"],
]
HOUSED = {"1.1": (), "1.2": ("1.1",), "2": ("1.1", "1.2")}


@pytest.mark.parametrize("write", FORMATS)
@pytest.mark.parametrize(
    "header",
    [
        WBS,
        ["PSP", "Vorgangsname", "Zeit Mensch [s]", "Zeit Roboter [s]", "Vorgänger"],
        ["Nr.", *WBS[1:]],
    ],
)
def test_a_summary_is_no_task(
    write: Callable[[Path, Rows], Path], header: list[str], tmp_path: Path
) -> None:
    cell, notes = import_cell(
        write(tmp_path / "tasks", [header, *HOUSING, ["2", "Test", 5, None, "1"]])
    )
    assert {name: task.after for name, task in cell.tasks.items()} == HOUSED
    assert any(
        "row 2 ('1') is a summary and no task: its time is the sum of those below it (1.1, 1.2)"
        in note.message
        for note in notes
    )


@pytest.mark.parametrize("times", [(None, None), ("", "-")], ids=["empty", "dashes"])
def test_a_summary_may_have_no_time_at_all(times: tuple[Any, Any], tmp_path: Path) -> None:
    assert (
        after(
            draft(
                tmp_path, [WBS, ["1", "Housing", *times], *HOUSING[1:], ["2", "Test", 5, None, "1"]]
            )
        )
        == HOUSED
    )


@pytest.mark.parametrize("header", ["Outline Level", "Gliederungsebene", "WBS level"])
def test_a_column_of_levels_tells_summaries(header: str, tmp_path: Path) -> None:
    rows = [
        ["ID", header, "Task Name", "Duration", "Predecessors", "Resource Names"],
        [1, 1, "Housing", "22 s"],
    ]
    rows += [
        [2, 2, "a", "10 s", None, "Worker"],
        [3, 2, "b", "12 s", "2", "Robot"],
        [4, 1, "Test", "5 s", "1FS", "Worker"],
    ]
    assert after(draft(tmp_path, rows)) == {"2": (), "3": ("2",), "4": ("2", "3")}


def test_the_span_of_a_project_tool_is_no_sum_and_a_summary_all_the_same(tmp_path: Path) -> None:
    rows = [
        ["ID", "WBS", "Task Name", "Duration", "Predecessors", "Resource Names"],
        [1, "1", "Housing", "12 s"],
    ]
    rows += [
        [2, "1.1", "a", "10 s", None, "Worker"],
        [3, "1.2", "b", "12 s", None, "Robot"],
        [4, "2", "Test", "5 s", "1", "Worker"],
    ]
    assert after(draft(tmp_path, rows)) == {"2": (), "3": (), "4": ("2", "3")}


def test_lists_that_use_the_outline_make_its_numbers_the_names(tmp_path: Path) -> None:
    rows = [
        ["ID", "WBS", "Task Name", "Duration", "WBS Predecessors", "Resource Names"],
        [1, "1", "Housing", "22 s"],
    ]
    rows += [
        [2, "1.1", "a", "10 s", None, "Worker"],
        [3, "1.2", "b", "12 s", "1.1", "Robot"],
        [4, "2", "Test", "5 s", "1", "Worker"],
    ]
    assert after(draft(tmp_path, rows)) == HOUSED


def test_indents_tell_summaries_when_their_times_are_sums(tmp_path: Path) -> None:
    rows = [
        [*EN, "After"],
        ["Housing", 22, 50],
        ["   Bearing", 10, 20],
        ["   Screws", 12, 30, "Bearing"],
        ["Test", 5, None, "Housing"],
    ]
    assert after(draft(tmp_path, rows)) == {
        "Bearing": (),
        "Screws": ("Bearing",),
        "Test": ("Bearing", "Screws"),
    }


def test_cells_that_are_indented_tell_summaries_too(tmp_path: Path) -> None:
    rows = [
        [*EN, "After"],
        ["Housing", 22, 50],
        ["Bearing", 10, 20],
        ["Screws", 12, 30, "Bearing"],
        ["Test", 5, None, "Housing"],
    ]
    path = workbook(tmp_path, {"Tasks": rows})
    book = openpyxl.load_workbook(path)
    for cell in ("A3", "A4"):
        book["Tasks"][cell].alignment = Alignment(indent=1)
    book.save(path)
    assert after(read_workbook(path)) == {
        "Bearing": (),
        "Screws": ("Bearing",),
        "Test": ("Bearing", "Screws"),
    }


def test_numbers_before_the_words_of_a_name_are_an_outline(tmp_path: Path) -> None:
    rows = [
        [*EN, "After"],
        ["1 Housing", 22, 50],
        ["1.1 Bearing", 10, 20],
        ["1.2 Screws", 12, 30, "1.1"],
        ["2 Test", 5, None, "1"],
    ]
    assert after(draft(tmp_path, rows)) == {
        "1.1 Bearing": (),
        "1.2 Screws": ("1.1 Bearing",),
        "2 Test": ("1.1 Bearing", "1.2 Screws"),
    }


def test_nested_summaries_and_one_with_predecessors(tmp_path: Path) -> None:
    rows = [
        WBS,
        *HOUSING,
        ["1.2.1", "first", 5, 10],
        ["1.2.2", "second", 7, 20, "1.2.1"],
        ["2", "Cover", 7, None, "1"],
        ["2.1", "p", 3],
        ["2.2", "q", 4],
    ]
    housing = ("1.1", "1.2.1", "1.2.2")
    assert after(draft(tmp_path, rows)) == {
        "1.1": (),
        "1.2.1": ("1.1",),
        "1.2.2": ("1.1", "1.2.1"),
        "2.1": housing,
        "2.2": housing,
    }


def test_successors_of_a_summary_come_after_each_part(tmp_path: Path) -> None:
    rows = [
        ["WBS", "Task name", "Time human [s]", "Successors"],
        ["1", "H", 22, "2"],
        ["1.1", "a", 10, "1.2"],
        ["1.2", "b", 12],
        ["2", "t", 5],
    ]
    assert after(draft(tmp_path, rows)) == HOUSED


def test_work_of_its_own_above_parts_is_asked_about_and_can_be_said(tmp_path: Path) -> None:
    rows = [
        ["Nr.", "Zeit Mensch [s]", "Vorgänger"],
        ["1", 30],
        ["1.1", 10],
        ["1.2", 12, "1.1"],
        ["2", 5, "1"],
    ]
    message = refusal(draft(tmp_path, rows))
    assert (
        "Tasks!B2: task '1' stands above 1.1, 1.2 like their sum, but takes 30 s where they add up"
        " to 22 s" in message
    )
    assert after(draft(tmp_path, [rows[0], ['"1"', 30], *rows[2:]])) == {
        "1": (),
        "1.1": (),
        "1.2": ("1.1",),
        "2": ("1",),
    }


def test_a_part_after_its_own_summary_is_refused(tmp_path: Path) -> None:
    message = refusal(draft(tmp_path, [WBS, *HOUSING[:2], ["1.2", "Drive", 12, 30, "1"]]))
    assert "Tasks!E4: puts '1.2' after '1', though one is a part of the other" in message


def test_limits_of_a_summary_are_not_lost(tmp_path: Path) -> None:
    rows = [[*WBS, "Deadline [s]", "Tool"], [*HOUSING[0], 60, "press"], *HOUSING[1:]]
    message = refusal(found := draft(tmp_path, rows))
    assert "Tasks!F2: stands beside '1', a summary of 1.1, 1.2" in message
    assert "Its 'Tool' was not read" in said(found)


@pytest.mark.parametrize(
    "rows",
    [
        [
            ["ID", "Task Name", "Duration", "Predecessors", "Resource Names"],
            [1, "a", "9 s", None, "Worker"],
            [2, "x", "0 s", "1"],
            [3, "b", "4 s", 2, "Worker"],
        ],
        [
            ["Nr.", "Zeit Mensch [s]", "Vorgänger", "Meilenstein"],
            [1, 9, None, "Nein"],
            [2, 0, 1, "Ja"],
            [3, 4, 2, "Nein"],
        ],
        [
            ["Nr.", "Vorgang", "Zeit Mensch [s]", "Vorgänger"],
            [1, "a", 9],
            [2, "Meilenstein Montage fertig", 0, 1],
            [3, "b", 4, 2],
        ],
    ],
    ids=["no duration and nobody", "a column", "a word"],
)
def test_a_milestone_passes_on_what_comes_before_it(rows: Rows, tmp_path: Path) -> None:
    found = draft(tmp_path, rows)
    assert after(found) == {"1": (), "3": ("1",)}
    assert "row 3 ('2') is a milestone" in said(found)


def test_milestones_in_a_row_pass_on_together(tmp_path: Path) -> None:
    rows = [
        ["ID", "Duration", "Predecessors", "Resource Names"],
        [1, 9, None, "Worker"],
        [2, 8, None, "Robot"],
        [3, 0, "1;2"],
        [4, 0, "3"],
    ]
    assert after(draft(tmp_path, [*rows, [5, 4, "4", "Worker"], [6, 4, "3;5", "Worker"]])) == {
        "1": (),
        "2": (),
        "5": ("1", "2"),
        "6": ("5", "1", "2"),
    }


@pytest.mark.parametrize("lists", [("4", "3"), (None, "4")], ids=["two", "itself"])
def test_milestones_in_a_circle_are_refused(lists: tuple[str | None, str], tmp_path: Path) -> None:
    rows = [
        ["ID", "Duration", "Predecessors", "Resource Names"],
        [1, 9, None, "Worker"],
        [3, 0, lists[0]],
        [4, 0, lists[1]],
    ]
    assert "after itself" in refusal(draft(tmp_path, rows))


def test_links_between_large_summaries_are_bounded(tmp_path: Path) -> None:
    rows: list[list[Any]] = [
        ["WBS", "Human [s]", "After"],
        ["1", None],
        *[[f"1.{i}", 1] for i in range(600)],
        ["2", None, "1"],
    ]
    message = refusal(draft(tmp_path, [*rows, *[[f"2.{i}", 1] for i in range(600)]]))
    assert "makes more than 200,000 links between the parts of summaries" in message


def test_a_task_called_after_a_total_is_no_total(tmp_path: Path) -> None:
    found = draft(
        tmp_path,
        [
            ["Nr.", "Bezeichnung", "Zeit Mensch [s]"],
            [1, "a", 9],
            [2, "Summe", 4],
            [3, "b", 2],
            [4, "Summe", 15],
        ],
    )
    assert list(found.cell().tasks) == ["1", "2", "3"]
    assert "row 5 was not read: 'Summe' is a total" in said(found)


# --- who takes part -------------------------------------------------------------------------------

LONG = ["Vorgang", "Bediener", "Zeit [s]", "Vorgänger"]


@pytest.mark.parametrize(
    "word",
    [
        *(
            "gemeinsam",
            "zusammen",
            "beide",
            "both",
            "together",
            "Team",
            "im Team",
            "alle",
            "Anna + UR5",
            "Anna & UR5",
            "Anna und UR5",
            "Anna mit UR5",
        ),
        *("Anna und UR5 gemeinsam", "gemeinsam (Anna, UR5)", "both: Anna/UR5"),
    ],
)
def test_a_word_for_both_is_a_joint_way_of_the_two(word: str, tmp_path: Path) -> None:
    rows = [LONG, ["a", "Anna", 10], ["a", "UR5", 9], ["b", word, 4, "a"]]
    cell = draft(tmp_path, rows, humans=["Anna"]).cell()
    assert set(cell.operators) == {"Anna", "UR5"}
    assert [(set(mode.operators), mode.time) for mode in cell.modes("b")] == [
        ({"Anna", "UR5"}, 4.0)
    ]


def test_a_stroke_is_one_or_the_other(tmp_path: Path) -> None:
    cell = draft(tmp_path, [LONG, ["a", "W1/W2", 10]], humans=["W1", "W2"]).cell()
    assert [mode.operators for mode in cell.modes("a")] == [("W1",), ("W2",)]


@pytest.mark.parametrize("word", ["beide", "gemeinsam", "Team"])
def test_of_three_the_two_are_asked_for_and_nobody_new_is_hired(word: str, tmp_path: Path) -> None:
    rows = [LONG, ["a", "Anna", 10], ["a", "UR5", 9], ["a", "Ben", 8], ["b", word, 4, "a"]]
    message = refusal(draft(tmp_path, rows, humans=["Anna", "Ben"]))
    assert (
        f"Tasks!B5: holds {word!r}, which does not say who takes part. The sheets name 'Anna',"
        " 'UR5' and 'Ben'" in message
    )
    assert "is this a human or a robot" not in message


def test_all_of_three_are_all(tmp_path: Path) -> None:
    rows = [LONG, ["a", "Anna", 10], ["a", "UR5", 9], ["a", "Ben", 8], ["b", "alle", 4, "a"]]
    assert draft(tmp_path, rows, humans=["Anna", "Ben"]).cell().modes("b")[0].operators == (
        "Anna",
        "UR5",
        "Ben",
    )


def test_somebody_called_team_is_somebody(tmp_path: Path) -> None:
    cell = draft(
        tmp_path, [LONG, ["a", "Werker", 10], ["b", "Team", 4, "a"]], humans=["Team"]
    ).cell()
    assert cell.modes("b")[0].operators == ("Team",)


@pytest.mark.parametrize(
    "header",
    [
        ["Vorgang", "Zeit Mensch [s]", "Zeit Roboter [s]", "Zeit gemeinsam [s]"],
        ["Task", "Human", "Robot", "Both"],
        ["Task", "t human [s]", "t robot [s]", "time together [s]"],
        ["Vorgang", "Mensch [s]", "Roboter [s]", "Team [s]"],
        ["Vorgang", "Mensch [s]", "Roboter [s]", "Mensch & Roboter [s]"],
    ],
)
def test_a_column_for_both_is_a_joint_way(header: list[str], tmp_path: Path) -> None:
    cell = draft(tmp_path, [header, ["a", 10, 12, 6], ["b", 5, 7, None]]).cell()
    assert len(cell.operators) == 2
    assert [len(mode.operators) for mode in cell.modes("a")] == [1, 1, 2]
    assert [len(mode.operators) for mode in cell.modes("b")] == [1, 1]


def test_a_stroke_in_a_header_is_asked_about(tmp_path: Path) -> None:
    message = refusal(
        draft(tmp_path, [["Task", "Human [s]", "Robot [s]", "Human/Robot [s]"], ["a", 10, 12, 6]])
    )
    assert (
        "Tasks!D1: 'Human/Robot [s]' may be the time of either or of both. Write 'Human + Robot'"
        in message
    )


def test_a_stress_that_belongs_to_another_group_is_refused_and_no_crash(tmp_path: Path) -> None:
    header = [
        "Task",
        "time h1 + r [s]",
        "time h1 + h2 + r [s]",
        "stress h1 + h2 + r",
        "stress h2 with h1 + r",
    ]
    message = refusal(
        draft(tmp_path, [header, ["a", 1.5, 2, 2.25, 6]], humans=["h1", "h2"], robots=["r"])
    )
    assert "Tasks!E2: gives stress a second time" in message


# --- machines, pieces, scores, abilities ----------------------------------------------------------


@pytest.mark.parametrize(
    "header",
    [
        "Maschinenzeit [s]",
        "Machine time [s]",
        "Maschine 2 [s]",
        "Zeit Presse [s]",
        "Ofenzeit [min]",
    ],
)
def test_a_machine_is_no_robot(header: str, tmp_path: Path) -> None:
    rows = [["Vorgang", "Zeit Mensch [s]", header], ["a", 10, 12], ["b", 3, 4]]
    assert "Tasks!C1: operator" in (message := refusal(draft(tmp_path, rows)))
    assert "is a machine by its name" in message
    assert draft(tmp_path, rows, columns={"C": "ignore"}).cell().robots == ()


def test_a_machine_that_does_whole_tasks_can_be_called_one(tmp_path: Path) -> None:
    rows = [["Vorgang", "Zeit Mensch [s]", "Zeit Presse [s]"], ["a", 10, 12]]
    assert "--machine Presse" in refusal(draft(tmp_path, rows))
    assert draft(tmp_path, rows, machines=["Presse"]).cell().machines == ("Presse",)


def book_with_press(tmp_path: Path, holds: str, apart: str) -> Path:
    return workbook(
        tmp_path,
        {
            "Vorgänge": [
                ["Vorgang", "Zeit Anna [s]", "Zeit Presse [s]", "Vorgänger", "Bereich"],
                ["laden", 4, None, None, "Bett"],
                ["pressen", None, 12, "laden", None],
                ["entladen", 3, None, "pressen", "Bett"],
            ],
            "Bediener": [
                ["Bediener", "Art", "hält"],
                ["Anna", "Mensch", None],
                ["Presse", "Maschine", holds],
            ],
            "Bereiche": [["Bereich", "Anzahl", "hält getrennt"], ["Bett", 2, apart]],
        },
    )


def test_what_machines_hold_and_zones_keep_apart_stands_in_sheets_of_their_own(
    tmp_path: Path,
) -> None:
    path = book_with_press(tmp_path, "laden > entladen", "Mensch; Roboter, Maschine")
    cell = read_workbook(path).cell()
    assert cell.operators["Presse"].holds == (("laden", "entladen"),)
    assert cell.zones["Bett"].apart == ("human", "robot", "machine")


def test_pairs_and_kinds_that_cannot_be_read_are_told_with_their_place(tmp_path: Path) -> None:
    message = refusal(read_workbook(book_with_press(tmp_path, "laden - entladen", "Mensch; Hund")))
    assert "Bediener!C3: holds 'laden - entladen': write from and to which task" in message
    assert "Bereiche!C2: holds 'Hund': zone 'Bett' keeps kinds of operators apart" in message
    unknown = refusal(read_workbook(book_with_press(tmp_path, "laden > entlade", "Mensch; Robot")))
    assert "Bediener!C3: operator 'Presse': holds names 'entlade'" in unknown


def test_a_machine_that_is_a_robot_can_be_called_one(tmp_path: Path) -> None:
    rows = [["Task", "Time human [s]", "Machine time [s]"], ["a", 10, 12]]
    assert draft(tmp_path, rows, robots=["machine"]).cell().robots == ("machine",)


@pytest.mark.parametrize(
    ("header", "quantity", "expected"),
    [
        ("Zeit/Stück Mensch [s]", "Anzahl", 40.0),
        ("time per piece human [s]", "Quantity", 40.0),
        ("Mensch [s/Stk.]", "Stück", 40.0),
        ("Zeit je Stück Mensch [min]", "Menge", 2400.0),
    ],
)
def test_a_time_per_piece_is_multiplied_by_the_pieces(
    header: str, quantity: str, expected: float, tmp_path: Path
) -> None:
    found = draft(tmp_path, [["Vorgang", header, quantity], ["screw", 10, 4], ["cover", 3, 1]])
    assert next(iter(found.cell().tasks["screw"].time.values())) == expected
    assert f"are multiplied by {quantity!r}" in said(found)


def test_pieces_are_not_counted_where_times_are_those_of_the_task(tmp_path: Path) -> None:
    found = draft(
        tmp_path, [["Vorgang", "Zeit Mensch [s]", "Anzahl"], ["screw", 10, 4], ["cover", 3, 1]]
    )
    assert found.cell().tasks["screw"].time["Mensch"] == 10
    assert "column 'Anzahl' was not read: the times are those of the whole task" in said(found)


def test_pieces_that_are_not_stated_are_asked_for(tmp_path: Path) -> None:
    message = refusal(
        draft(
            tmp_path,
            [["Vorgang", "Zeit/Stück Mensch [s]", "Anzahl"], ["screw", 10, 4], ["cover", 3, None]],
        )
    )
    assert message.startswith("- Tasks!C3: does not say how many pieces there are")
    assert message.count("\n") == 0


@pytest.mark.parametrize(
    "header",
    ["RULA", "REBA score", "NIOSH index", "OWAS", "KIM", "RULA-Punkte", "Leitmerkmalmethode"],
)
def test_a_score_that_only_ranks_is_no_stress(header: str, tmp_path: Path) -> None:
    rows = [["Task", "Human [s]", header], ["a", 10, 3], ["b", 5, 4]]
    assert f"Tasks!C1: {header!r} is a score that only ranks" in refusal(draft(tmp_path, rows))
    told = draft(tmp_path, rows, columns={header: "stress"})
    assert told.cell().tasks["b"].stress == 4
    assert f"{header!r} is added up as stress because --map or --aggregate says so" in said(told)


def test_a_score_beside_a_stress_is_left_out_and_told(tmp_path: Path) -> None:
    found = draft(
        tmp_path, [["Task", "Human [s]", "RULA", "Stress"], ["a", 10, 3, 1], ["b", 5, 4, 2]]
    )
    assert found.cell().tasks["b"].stress == 2
    assert "'RULA' was not read: it is a score that only ranks" in said(found)


def test_eaws_points_add_up(tmp_path: Path) -> None:
    assert (
        draft(tmp_path, [["Task", "Human [s]", "EAWS-Punkte"], ["a", 10, 3]])
        .cell()
        .tasks["a"]
        .stress
        == 3
    )


def test_tools_that_are_a_slip_apart_are_asked_about_at_their_rows(tmp_path: Path) -> None:
    message = refusal(
        draft(
            tmp_path,
            [
                ["Task", "Human [s]", "Tool"],
                ["a", 10, "Presse"],
                ["b", 5, "presse"],
                ["c", 5, "Press"],
            ],
        )
    )
    assert "Tasks!C3: tool 'presse' is spelled almost like tool 'Presse'" in message
    assert "Tasks!C4: tool 'Press' is spelled almost like tool 'Presse'" in message


ABILITIES: Rows = [["task", "Human", "Robot"], ["a", 1, 1], ["b", 1, 0], ["c", 0, 1]]


@pytest.mark.parametrize(
    ("times", "expected"),
    [
        (
            [["task", "Human", "Robot"], *LETTERS[1:]],
            {"a": {"Human": 10, "Robot": 20}, "b": {"Human": 12}, "c": {"Robot": 6}},
        ),
        (
            [["task", "human [min]", "robot [min]"], *LETTERS[1:]],
            {"a": {"human": 600, "robot": 1200}, "b": {"human": 720}, "c": {"robot": 360}},
        ),
        (
            [["task", "time [s]"], ["a", 10], ["b", 12], ["c", 5]],
            {"a": {"Human": 10, "Robot": 10}, "b": {"Human": 12}, "c": {"Robot": 5}},
        ),
    ],
    ids=["bare", "minutes", "one time"],
)
def test_a_workbook_of_times_abilities_and_pairs_is_read_as_one(
    times: Rows, expected: dict[str, dict[str, float]], tmp_path: Path
) -> None:
    found = read_workbook(
        workbook(
            tmp_path,
            {
                "task_times": times,
                "station_types": ABILITIES,
                "precedence_relations": PAIRS["from, to"],
            },
        )
    )
    assert {name: dict(task.time) for name, task in found.cell().tasks.items()} == expected
    assert after(found) == CHAIN
    assert "sheet 'station_types' is read as who can do what" in said(found)


@pytest.mark.parametrize(
    ("abilities", "words"),
    [
        ([*ABILITIES[:3], ["cc", 0, 1]], "station_types!A4: holds 'cc', which is no task"),
        (ABILITIES[:3], "station_types!A1: does not say who can do task 'c'"),
        (
            [["task", "Human", "Cobot"], *ABILITIES[1:]],
            (
                "station_types!C2: says that 'Cobot' can do task 'a', for which no time of 'Cobot'"
                " is stated"
            ),
        ),
    ],
)
def test_abilities_that_do_not_fit_the_times_are_refused(
    abilities: Rows, words: str, tmp_path: Path
) -> None:
    sheets = {
        "task_times": [["task", "Human [s]", "Robot [s]"], *LETTERS[1:]],
        "station_types": abilities,
    }
    assert words in refusal(read_workbook(workbook(tmp_path, sheets)))


# --- one wrong column is one message --------------------------------------------------------------


@pytest.mark.parametrize(
    ("rows", "start"),
    [
        (
            [[i, "abc", 4, None] for i in range(1, 43)],
            (
                "Tasks!B2: column B 'Zeit Mensch [s]', rows 2 to 43, as here: holds 'abc' where a"
                " number"
            ),
        ),
        (
            [[i, -i, 4, None] for i in range(1, 43)],
            "Tasks!B2: column B 'Zeit Mensch [s]', rows 2 to 43, as here: holds -1: a time cannot",
        ),
        (
            [[i, 3, 4, f"x{i}"] for i in range(1, 43)],
            "Tasks!D2: column D 'Vorgänger', rows 2 to 43, as here: holds 'x1', which is no task",
        ),
        (
            [[i, None if i != 4 else 1, 0, None] for i in range(1, 43)],
            "Tasks!A2: column A 'Vorgang', rows 2 to 4 and 6 to 43, as here: task '1'",
        ),
        (
            [["same", 3, 4, None] for _ in range(1, 43)],
            (
                "Tasks!A3: column A 'Vorgang', rows 3 to 43, as here: task 'same' stands here a"
                " second time"
            ),
        ),
    ],
    ids=["words", "negative", "predecessors", "nobody", "twice"],
)
def test_one_wrong_column_is_one_message(rows: Rows, start: str, tmp_path: Path) -> None:
    message = refusal(
        draft(tmp_path, [["Vorgang", "Zeit Mensch [s]", "Zeit Roboter [s]", "Vorgänger"], *rows])
    )
    assert message.startswith(f"- {start}")
    assert message.count("\n") == 0


def test_two_wrong_cells_and_other_columns_keep_messages_of_their_own(tmp_path: Path) -> None:
    rows = [
        ["Vorgang", "Zeit Mensch [s]", "Zeit Roboter [s]"],
        [1, "abc", "x"],
        [2, "def", "x"],
        [3, 4, "x"],
        [4, -1, 2],
    ]
    lines = refusal(draft(tmp_path, rows)).splitlines()
    assert [line.split(": ")[0] for line in lines] == [
        "- Tasks!B2",
        "- Tasks!C2",
        "- Tasks!B3",
        "- Tasks!B5",
    ]


def test_a_few_unlike_values_are_told_each_at_its_cell(tmp_path: Path) -> None:
    """They are mistakes of their own; many of them say that the column is another one than was
    thought.
    """
    values = ["1'30", "2'", "5 10", "01.02.2024", "1.5.2", "12.30.45"]
    header = ["Vorgang", "Zeit Mensch [s]", "Zeit Roboter [s]"]
    few = refusal(
        draft(
            tmp_path,
            [header, *([name, value, 20] for name, value in zip("abcdef", values, strict=True))],
        )
    )
    assert [line.split(": ")[0] for line in few.splitlines()] == [
        f"- Tasks!B{row}" for row in range(2, 8)
    ]
    assert all(repr(value) in few for value in values)
    many = refusal(
        draft(tmp_path, [header, *([f"t{row}", f"{row}'30", 20] for row in range(1, 9))])
    )
    assert "rows 2 to 9, as here" in many
