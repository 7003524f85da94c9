"""Planners' workbooks are imported to the right cell, with everything left out listed, or refused
with the sheet cell to mend.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from tests.files.spreadsheet import books

from tandem.errors import CellError, UsageError
from tandem.files.spreadsheet import import_cell, read_workbook


def notes(found: Any, kind: str) -> str:
    return "\n".join(str(note) for note in found if note.kind == kind)


def refusal(path: Path, **options: Any) -> str:
    with pytest.raises(CellError) as caught:
        import_cell(path, **options)
    return str(caught.value)


def test_german_plan_with_titles_two_header_rows_headings_and_totals(tmp_path: Path) -> None:
    cell, found = import_cell(books.german_plan(tmp_path / "plan.xlsx"))
    assert cell.name == "Montageplan Baugruppe 4711"
    assert dict(cell.tasks["1"].time) == {"Roboter": 9.0, "Mensch": 10.002}
    assert dict(cell.tasks["2"].time) == {"Roboter": 7.002, "Mensch": 8.001}
    assert dict(cell.tasks["3"].time) == {"Mensch": 10.002}
    assert dict(cell.tasks["4"].time) == {"Roboter": 2.004}
    assert [task.label for task in cell.tasks.values()] == [
        "Deckel einlegen",
        "Rad fügen",
        "Kabel stecken",
        "Schraube",
        "Prüfen",
    ]
    assert [task.stress for task in cell.tasks.values()] == [10, 11, 2, 0, 4]
    assert [task.after for task in cell.tasks.values()] == [(), (), (), ("1", "2"), ("3",)]
    assert cell.humans == ("Mensch",)
    assert cell.robots == ("Roboter",)
    rows = notes(found, "row")
    for what in (
        "row 6 was not read: 'Vormontage'",
        "row 10 was not read",
        "row 14 was not read: 'Summe'",
        "row 16 was not read",
        "blank rows were passed over: 9",
    ):
        assert what in rows
    assert "Montage!G5: column G 'Bemerkung' was not read" in notes(found, "column").replace(
        "column 'B", "column G 'B"
    )
    assert "Mensch cannot do: 4 (D12 is k.A.)" in notes(found, "cannot")
    assert "Roboter cannot do: 3 (C11 is -)" in notes(found, "cannot")


def test_the_plain_list_is_the_thesis_cell(tmp_path: Path) -> None:
    cell, found = import_cell(
        books.sheet(tmp_path / "plain.xlsx", [books.PLAIN_HEADER, *books.PLAIN_ROWS])
    )
    assert books.same_work(cell)
    assert "robot cannot do: 3 (B4 is 0)" in notes(found, "cannot")
    assert "human cannot do: 4 (C5 is empty)" in notes(found, "cannot")


@pytest.mark.parametrize("build", [books.windows_csv, books.english_csv, books.unicode_text])
def test_csv_of_every_kind_is_the_thesis_cell(build: Any, tmp_path: Path) -> None:
    cell, found = import_cell(build(tmp_path / "tasks.csv"))
    renamed = {"Roboter": "robot", "Mensch": "human"}
    tasks = {
        name: {**task, "time": {renamed.get(who, who): t for who, t in task["time"].items()}}
        for name, task in cell.to_dict()["tasks"].items()
    }
    assert tasks == books.THESIS.to_dict()["tasks"]
    assert "columns separated by" in notes(found, "assumed")


def test_csv_named_xls_is_read_as_text(tmp_path: Path) -> None:
    assert books.same_work(import_cell(books.unicode_text(tmp_path / "export.xls"))[0])


def test_ods_is_the_thesis_cell(tmp_path: Path) -> None:
    assert books.same_work(
        import_cell(books.ods(tmp_path / "tasks.ods", [books.PLAIN_HEADER, *books.PLAIN_ROWS]))[0]
    )


def test_ods_formula_without_result_and_error_are_refused(tmp_path: Path) -> None:
    message = refusal(
        books.ods(tmp_path / "tasks.ods", [books.PLAIN_HEADER, *books.PLAIN_ROWS], broken=True)
    )
    assert "Tabelle1!B2: holds a formula with no stored result" in message
    assert "Tabelle1!B3: holds the error #REF!" in message


def test_xls_is_the_thesis_cell(tmp_path: Path) -> None:
    xlwt = pytest.importorskip("xlwt", reason="pip install xlwt")
    book = xlwt.Workbook()
    target = book.add_sheet("Alt")
    for row, values in enumerate([["Station 3"], [], books.PLAIN_HEADER, *books.PLAIN_ROWS]):
        for column, value in enumerate(values):
            if value is not None:
                target.write(row, column, value)
    book.save(str(tmp_path / "old.xls"))
    cell, found = import_cell(tmp_path / "old.xls")
    assert books.same_work(cell)
    assert cell.name == "Station 3"
    assert "cannot be told from an empty cell" in notes(found, "assumed")


def test_one_row_for_each_operator(tmp_path: Path) -> None:
    cell, _ = import_cell(books.one_row_an_operator(tmp_path / "long.xlsx"), humans=["Anna"])
    assert cell.to_dict()["tasks"] == {
        "A10": {"label": "cover", "time": {"Anna": 10, "UR5": 9}, "stress": 10},
        "A20": {
            "label": "wheel",
            "time": {"UR5": 7, "Anna": 8},
            "together": [{"operators": ["Anna", "UR5"], "time": 4.5, "stress": 6}],
            "stress": {"Anna": 11},
            "after": ["A10"],
        },
        "A30": {
            "label": "cable",
            "time": {"Anna": 10, "UR5": 10},
            "stress": 2,
            "after": ["A10", "A20"],
        },
    }


def test_ms_project_columns(tmp_path: Path) -> None:
    cell, found = import_cell(books.ms_project(tmp_path / "project.xlsx"))
    assert [dict(task.time) for task in cell.tasks.values()] == [
        {"Robot": 12.0},
        {"Worker": 30.0},
        {"Worker": 90.0},
        {"Robot": 20.0},
    ]
    assert [task.after for task in cell.tasks.values()] == [(), ("1",), ("1", "2"), ("1", "2", "3")]
    assert cell.tasks["3"].label == "Screw"
    assert "'Start' was not read" in notes(found, "column")
    assert "'Finish' was not read" in notes(found, "column")


def test_dirty_numbers_are_read_as_they_look(tmp_path: Path) -> None:
    cell, _ = import_cell(books.dirty_numbers(tmp_path / "web.xlsx"))
    assert {name: dict(task.time) for name, task in cell.tasks.items()} == {
        "a": {"human": 10.5, "robot": 1234.5},
        "b": {"human": 120.0, "robot": 0.3},
        "c": {"robot": 3.0},
        "d": {"human": 1200.5},
        "e": {"human": 2.0},
    }
    assert [task.after for task in cell.tasks.values()] == [
        (),
        ("a",),
        ("a", "b"),
        ("a", "b", "c"),
        (),
    ]


def test_operators_tools_and_zones_in_sheets_of_their_own(tmp_path: Path) -> None:
    cell, found = import_cell(books.operators_beside(tmp_path / "line.xlsx"))
    assert cell.humans == ("Anna", "Ben")
    assert cell.robots == ("Cell 7",)
    assert cell.operators["Anna"].breaks == ((300.0, 360.0), (600.0, 690.0))
    assert cell.operators["Anna"].stress_limit == 20
    assert cell.tools["driver"].capacity == 2
    assert dict(cell.tools["driver"].changeover) == {"Anna": 4.0}
    assert cell.zones["table"].capacity == 2
    assert cell.tasks["p1"].stress == {"Anna": 3.0, "Ben": 4.0}
    assert cell.tasks["p2"].deadline == 90.0
    assert "row 3 is hidden" in notes(found, "assumed")
    assert "hidden columns were read all the same: 'Zone'" in notes(found, "assumed")
    assert "sheet 'Costs' was not read" in notes(found, "sheet")
    assert "sheet 'Steps old' is hidden and was not read" in notes(found, "sheet")


def test_successors_units_row_repeated_header_and_nameless_total(tmp_path: Path) -> None:
    cell, found = import_cell(books.successors(tmp_path / "balancing.xlsx"))
    expected = books.THESIS.to_dict()["tasks"]
    assert {
        name: {**task, "time": {who.lower(): t for who, t in task["time"].items()}}
        for name, task in cell.to_dict()["tasks"].items()
    } == expected
    assert "row 5 was not read: it repeats the header" in notes(found, "row")
    assert "row 11 was not read: it has no name, and its numbers are the sums" in notes(
        found, "row"
    )
    assert "rounded" in notes(found, "assumed")


def test_sheet_formatted_to_the_last_row(tmp_path: Path) -> None:
    assert books.same_work(import_cell(books.formatted_to_the_end(tmp_path / "long.xlsx"))[0])


# --- refused, each with its place -----------------------------------------------------------------


def test_all_broken_cells_at_once_and_nothing_imported(tmp_path: Path) -> None:
    message = refusal(books.broken_cells(tmp_path / "broken.xlsx"))
    for part in (
        (
            "Zeiten!B3: holds a formula with no stored result: open and save it in Excel or"
            " LibreOffice"
        ),
        "Zeiten!B4: holds the clock time 12:30:00",
        "Zeiten!D4: holds 2024-02-01, not tasks",
        "Zeiten!B5: holds -3: a time cannot be negative",
        "Zeiten!C5: holds 'fast' where a number is expected",
        "Zeiten!D5: holds the number 1.2, which is no task (Excel makes a number of '1,2')",
        "Zeiten!B6: holds '1.234', which may be 1234 or 1.234",
        "Zeiten!D6: holds '22', which is no task. Did you mean '2'?",
        "Zeiten!C7: holds the error #REF!",
    ):
        assert part in message
    assert message.count("\n") == 8


def test_circular_predecessors_by_row_number(tmp_path: Path) -> None:
    message = refusal(books.circle_by_rows(tmp_path / "circle.xlsx"))
    assert "Line 3!D" in message
    assert "circle" in message
    draft = read_workbook(tmp_path / "circle.xlsx")
    assert "row numbers of the sheet" in notes(draft.notes, "assumed")
    assert draft.document["tasks"]["4"]["after"] == ["1", "2"]


def test_two_sheets_that_look_like_tasks(tmp_path: Path) -> None:
    path = books.two_variants(tmp_path / "variants.xlsx")
    assert "today!A1 and with robot 2!A1" in refusal(path)
    assert "--sheet 'today'" in refusal(path)
    assert books.same_work(import_cell(path, sheet="today")[0])
    with pytest.raises(UsageError, match=r"no such sheet. Did you mean 'today'"):
        import_cell(path, sheet="Today ")


def test_chart_only(tmp_path: Path) -> None:
    assert "sheet 'Diagramm' was not read: it is no worksheet but a chart" in refusal(
        books.chart_only(tmp_path / "chart.xlsx")
    )


def test_password(tmp_path: Path) -> None:
    message = refusal(books.password_protected(tmp_path / "secret.xlsx"))
    assert message.startswith("- secret.xlsx: is protected by a password.")


def test_truncated_empty_foreign_and_missing_files(tmp_path: Path) -> None:
    whole = books.sheet(
        tmp_path / "whole.xlsx", [books.PLAIN_HEADER, *books.PLAIN_ROWS]
    ).read_bytes()
    (tmp_path / "cut.xlsx").write_bytes(whole[: len(whole) // 2])
    assert "cut.xlsx: is damaged or cut off" in refusal(tmp_path / "cut.xlsx")
    (tmp_path / "nil.xlsx").write_bytes(b"")
    assert "nil.xlsx: is empty" in refusal(tmp_path / "nil.xlsx")
    (tmp_path / "page.xls").write_bytes(b"<html><table><tr><td>Task</td></tr></table></html>")
    assert "page.xls: is no .xls workbook although its name says so" in refusal(
        tmp_path / "page.xls"
    )
    (tmp_path / "photo.csv").write_bytes(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR" + bytes(50))
    assert "photo.csv: is not text" in refusal(tmp_path / "photo.csv")
    assert "gone.xlsx: cannot be read" in refusal(tmp_path / "gone.xlsx")
    (tmp_path / "old.xls").write_bytes(bytes.fromhex("d0cf11e0a1b11ae1") + bytes(600))
    assert "old.xls: cannot be read as a workbook" in refusal(tmp_path / "old.xls")


def test_twelve_thousand_rows(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text(
        "task,robot [s]\n" + "".join(f"{i},1\n" for i in range(12_000))
    )
    assert "log.csv: has more than 10,000 rows" in refusal(tmp_path / "log.csv")
    import openpyxl

    book = openpyxl.Workbook(write_only=True)
    target = book.create_sheet("Log")
    target.append(["task", "robot [s]"])
    for i in range(12_000):
        target.append([i, 1])
    book.save(tmp_path / "log.xlsx")
    assert "sheet 'Log' was not read: it has 12,001 rows" in refusal(tmp_path / "log.xlsx")


def test_doubtful_columns_tasks_and_operators_are_asked_for(tmp_path: Path) -> None:
    rows = [
        ["Task", "Time", "Anna [s]", "Zeit Anna", "Robot [s]"],
        [1, 5, 5, 5, 4],
        [1, 5, 5, 5, 4],
        [None, 5, 5, 5, 4],
        [2, None, None, None, None],
    ]
    message = refusal(books.sheet(tmp_path / "doubt.xlsx", rows))
    assert "Sheet1!B1: 'Time' does not say whose time it is" in message
    assert "Sheet1!D1: 'Zeit Anna' means the same as 'Anna [s]' (C1)" in message
    assert "Sheet1!A3: task '1' stands here a second time, the first is Sheet1!A2" in message
    assert "Sheet1!A4: is empty: the row has values and no task" in message
    assert "Sheet1!C1: operator 'Anna': is this a human or a robot?" in message
    assert "Sheet1!A5: task '2': nobody can do it" in message


def test_columns_can_be_told(tmp_path: Path) -> None:
    rows = [["Was", "Wer weiß", "X", "Y"], ["a", 3, 4, None], ["b", 2, None, "a"]]
    path = books.sheet(tmp_path / "own.xlsx", rows)
    assert "no column holds a time" in refusal(path)
    cell, _ = import_cell(
        path,
        columns={"Wer weiß": "time robot [min]", "C": "time Eva [s]", "Y": "after"},
        humans=["eva"],
    )
    assert {name: dict(task.time) for name, task in cell.tasks.items()} == {
        "1": {"robot": 180.0, "Eva": 4.0},
        "2": {"robot": 120.0},
    }
    assert cell.tasks["2"].after == ("1",)
    with pytest.raises(UsageError, match=r"no such column. Did you mean 'Wer weiß'"):
        import_cell(path, columns={"Wer weiss nicht": "after", "C": "time robot"})
    with pytest.raises(UsageError, match="no column can mean 'colour'"):
        import_cell(path, columns={"X": "colour"})
    with pytest.raises(UsageError, match=r"has no such operator. Did you mean 'Eva'"):
        import_cell(path, columns={"Wer weiß": "time robot", "C": "time Eva"}, humans=["Evi"])
