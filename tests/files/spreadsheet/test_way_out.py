"""The way out that a message names fits the column in which the fault is."""

from __future__ import annotations

import datetime
from pathlib import Path

import openpyxl
import pytest
from tests.files.spreadsheet.books import sheet

from tandem.errors import CellError
from tandem.files.spreadsheet import import_cell


@pytest.mark.parametrize("column", ["t human [s]", "Stress", "Release [s]", "Deadline [s]"])
def test_no_column_but_a_time_speaks_of_who_can_do_the_task(column: str, tmp_path: Path) -> None:
    headers = ["Task", "t human [s]", *({column} - {"t human [s]"}), "Predecessors"]
    file = tmp_path / "tasks.csv"
    rows = [["1", *"5" * (len(headers) - 2), ""], ["2", *"5" * (len(headers) - 2), "1"]]
    rows[1][headers.index(column)] = "about ten"
    file.write_text("\n".join(",".join(cells) for cells in (headers, *rows)), encoding="utf-8")
    with pytest.raises(CellError) as refused:
        import_cell(file)
    (fault,) = refused.value.faults
    letter = "ABC"[headers.index(column)]
    assert fault.place.endswith(f"!{letter}3")
    assert (
        fault.message
        == "holds 'about ten' where a number is expected: write one number, or leave the cell empty"
        " if there is none."
    )


ARBEITSPLAN = [
    ["AFO", "Arbeitsgang", "Vorgänger", "tg Werker 1 [min]", "te Roboter [s]"],
    [10, "Gehäuse einlegen", None, 0.2, 9],
    [20, "Dichtung setzen", "10", 0.15, None],
    [30, "Deckel", "10; 20", 0.1, 7],
]


def test_the_german_shop_calls_its_numbers_afo_and_its_times_tg_and_te(tmp_path: Path) -> None:
    cell, _ = import_cell(sheet(tmp_path / "plan.xlsx", ARBEITSPLAN))
    assert list(cell.operators) == ["Werker 1", "Roboter"]
    assert cell.tasks["30"].after == ("10", "20")
    assert cell.tasks["10"].time == {"Werker 1": 12, "Roboter": 9}


def test_predecessors_that_stand_in_an_unread_column_name_it(tmp_path: Path) -> None:
    rows = [["Kennung der Linie", *ARBEITSPLAN[0][1:]], *ARBEITSPLAN[1:]]
    file = sheet(tmp_path / "plan.xlsx", rows)
    with pytest.raises(CellError) as refused:
        import_cell(file)
    remedy = "--map 'Kennung der Linie=number'"
    assert [fault.place for fault in refused.value.faults] == ["Sheet1!C3", "Sheet1!C4"]
    assert refused.value.faults[1].message.count(remedy) == 2
    assert ".;" not in refused.value.faults[1].message
    cell, _ = import_cell(file, columns={"Kennung der Linie": "number"})
    assert cell.tasks["30"].after == ("10", "20")


def test_a_header_of_two_rows_gives_its_group_no_predecessors(tmp_path: Path) -> None:
    """ "Stress" stands over Anna's column; what comes before a task is nobody's stress."""
    rows = [
        [None, None, "Time [s]", None, "Stress", None],
        ["No", "Task", "Human Anna", "Cobot", "Human Anna", "Pred."],
        [1, "a", 10, 8, 3, None],
        [2, "b", 12, None, 4, 1],
        [3, "c", 5, 6, 2, "1-2"],
    ]
    cell, _ = import_cell(sheet(tmp_path / "groups.xlsx", rows, merged=["C1:D1"]))
    assert cell.tasks["3"].after == ("1", "2")
    assert cell.tasks["2"].stress == {"Human Anna": 4}


def test_risk_is_no_operator(tmp_path: Path) -> None:
    rows = [
        ["Step", "Worker [s]", "Cobot [s]", "Ergo risk (1-5)", "Pred"],
        ["pick", 12, 9, 2, None],
        ["screw", 20, None, 3, "pick"],
    ]
    cell, _ = import_cell(sheet(tmp_path / "risk.xlsx", rows))
    assert {name: task.stress for name, task in cell.tasks.items()} == {"pick": 2, "screw": 3}


@pytest.mark.parametrize("name", ["Operator", "Worker", "Mitarbeiter", "Bediener", "Resource"])
@pytest.mark.parametrize("unit", ["", " [s]", " (sec)"])
def test_a_column_of_times_called_operator_is_never_left_out(
    name: str, unit: str, tmp_path: Path
) -> None:
    """Beside "Robot" it holds one operator's times: without it, the plan would be the robot's."""
    rows = [
        ["Step", f"{name}{unit}", f"Robot{unit}", "Pred"],
        ["a", 12, 9, None],
        ["b", 20, 8, "a"],
    ]
    cell, _ = import_cell(sheet(tmp_path / "times.xlsx", rows), humans=[name])
    assert cell.tasks["a"].time == {name: 12, "Robot": 9}
    assert cell.tasks["b"].time == {name: 20, "Robot": 8}


def test_crosses_below_operator_say_who_can(tmp_path: Path) -> None:
    rows = [
        ["Step", "Time [s]", "Operator", "Robot", "Pred"],
        ["a", 12, "x", "x", None],
        ["b", 20, "x", None, "a"],
    ]
    cell, _ = import_cell(sheet(tmp_path / "crosses.xlsx", rows))
    assert cell.tasks["a"].time == {"Operator": 12, "Robot": 12}
    assert cell.tasks["b"].time == {"Operator": 20}


@pytest.mark.parametrize("header", ["Operator", "Operator(s)"])
def test_names_below_operator_stay_names(header: str, tmp_path: Path) -> None:
    rows = [
        ["Step", header, "Time (s)", "Pred"],
        ["a", "Robot", 12, None],
        ["b", "Worker", 20, "a"],
    ]
    cell, _ = import_cell(sheet(tmp_path / "names.xlsx", rows))
    assert cell.tasks["a"].time == {"Robot": 12}
    assert cell.tasks["b"].time == {"Worker": 20}


HOURS = [
    ["Task", "Human time", "Robot time", "After"],
    ["a", datetime.timedelta(seconds=12), datetime.timedelta(seconds=9), None],
    ["b", datetime.timedelta(minutes=1), None, "a"],
    ["c", datetime.timedelta(seconds=90.5), datetime.timedelta(0), "b"],
]


@pytest.mark.parametrize("form", ["h:mm:ss", "mm:ss", "[h]:mm:ss", "[mm]:ss.0"])
def test_durations_that_are_shown_to_the_second_are_read(form: str, tmp_path: Path) -> None:
    cell, notes = import_cell(_durations(tmp_path, form))
    assert [task.time for task in cell.tasks.values()] == [
        {"Human": 12, "Robot": 9},
        {"Human": 60},
        {"Human": 90.5},
    ]
    assert any("B2 h:mm:ss" in str(note.message) for note in notes)
    assert not any("seconds are assumed" in str(note.message) for note in notes)


@pytest.mark.parametrize("form", ["h:mm", "h:mm:ss AM/PM", "yyyy-mm-dd hh:mm:ss"])
def test_durations_that_are_shown_otherwise_name_the_format(form: str, tmp_path: Path) -> None:
    with pytest.raises(CellError) as refused:
        import_cell(_durations(tmp_path, form))
    assert all("number" in fault.message for fault in refused.value.faults)
    assert {"Sheet1!B2", "Sheet1!B3", "Sheet1!B4"} <= {f.place for f in refused.value.faults}


def _durations(folder: Path, form: str) -> Path:
    file = sheet(folder / "hours.xlsx", HOURS)
    book = openpyxl.load_workbook(file)
    for row in book.active["B2:C4"]:
        for cell in row:
            cell.number_format = form
    book.save(file)
    return file


def test_durations_in_a_text_file_have_three_parts(tmp_path: Path) -> None:
    file = tmp_path / "t.csv"
    file.write_text("Task,Human [min],Robot [min],After\na,00:00:12,9,\nb,0:01:30.5,,a\n")
    cell, _ = import_cell(file)
    assert [task.time for task in cell.tasks.values()] == [
        {"Human": 12, "Robot": 540},
        {"Human": 90.5},
    ]
    file.write_text("Task,Human [s],Robot [s],Deadline [s]\na,0:12,9,\nb,20,8,0:01:30\n")
    with pytest.raises(CellError) as refused:
        import_cell(file)
    assert [fault.place for fault in refused.value.faults] == ["t!B2", "t!D3"]


def test_the_least_and_the_most_are_no_time_to_plan_with(tmp_path: Path) -> None:
    rows = [
        ["No", "Task", "Human min [s]", "Human max [s]", "Robot [s]", "Start max [s]", "Pred"],
        [1, "a", 10, 14, 8, 0, None],
        [2, "b", 12, 15, 9, 20, 1],
    ]
    file = sheet(tmp_path / "bounds.xlsx", rows)
    with pytest.raises(CellError) as refused:
        import_cell(file)
    (fault,) = refused.value.faults
    assert fault.place == "Sheet1!C1"
    assert "'Human min [s]', 'Human max [s]'" in fault.message
    cell, _ = import_cell(file, columns={"Human max [s]": "time Human [s]"})
    assert cell.tasks["1"].time == {"Human": 14, "Robot": 8}


@pytest.mark.parametrize("column", [0, 1])
def test_a_heading_between_numbered_tasks_is_no_task(column: int, tmp_path: Path) -> None:
    heading = [None] * 5
    heading[column] = "Station B"
    rows = [
        ["No", "Task", "Human [s]", "Robot [s]", "Pred"],
        [1, "a", 10, 8, None],
        heading,
        [2, "b", 12, None, 1],
    ]
    cell, notes = import_cell(sheet(tmp_path / "stations.xlsx", rows))
    assert list(cell.tasks) == ["1", "2"]
    assert any("'Station B' is a heading" in str(note.message) for note in notes)
    # where a task has but one name, its time may be forgotten
    with pytest.raises(CellError, match="nobody can do it"):
        import_cell(
            sheet(
                tmp_path / "one.xlsx",
                [[row[1], *row[2:]] for row in rows]
                if column
                else [[row[0], *row[2:]] for row in rows],
            )
        )


STANDARD_WORK = [
    ["Step", "Work element", "Manual [s]", "Automatic [s]", "Walk [s]", "Predecessor"],
    [1, "Pick housing", 5, None, 2, None],
    [2, "Press bearing", 3, 22, 2, 1],
]


def test_what_is_automatic_in_standard_work_is_asked_about(tmp_path: Path) -> None:
    file = sheet(tmp_path / "standard.xlsx", STANDARD_WORK)
    with pytest.raises(CellError) as refused:
        import_cell(file)
    (fault,) = refused.value.faults
    assert fault.place == "Sheet1!D1"
    assert "table of standard work" in fault.message
    cell, _ = import_cell(file, robots=["Automatic"])
    assert cell.tasks["2"].time == {"Manual": 3, "Automatic": 22}
    alone, _ = import_cell(file, columns={"Automatic [s]": "ignore"})
    assert alone.tasks["2"].time == {"Manual": 3}
    # without walking they are two ways of doing a task
    rows = [[*row[:4], row[5]] for row in STANDARD_WORK]
    cell, _ = import_cell(sheet(tmp_path / "ways.xlsx", rows))
    assert cell.operators["Automatic"].kind == "robot"


def test_numbered_steps_are_named_by_the_column_beside(tmp_path: Path) -> None:
    cell, _ = import_cell(
        sheet(tmp_path / "steps.xlsx", STANDARD_WORK), columns={"Automatic [s]": "ignore"}
    )
    assert {name: task.label for name, task in cell.tasks.items()} == {
        "1": "Pick housing",
        "2": "Press bearing",
    }


PROJECT = [
    ["Task name", "Duration [s]", "Resource names", "Predecessors"],
    ["Pick", 12, "Worker A", None],
    ["Place", 15, "Cobot", "1"],
]


@pytest.mark.parametrize(
    ("link", "wait"),
    [
        ("2FS+50 s", 50),
        ("2EA+1,5 Min.", 90),
        ("1; 2FS+0.5 mins", 30),
        ("1, 2 FS + 7 secs", 7),
        ("2FS", None),
        ("2FS+0 s", None),
    ],
)
def test_a_wait_behind_a_link_of_a_project_tool(
    link: str, wait: float | None, tmp_path: Path
) -> None:
    rows = [*PROJECT, ["Fasten", 20, "Worker A", link]]
    cell, _ = import_cell(sheet(tmp_path / "lag.xlsx", rows))
    fasten = cell.tasks["Fasten"]
    assert fasten.after == (("Pick", "Place") if link.startswith("1") else ("Place",))
    assert [(one.after, one.at_least) for one in fasten.wait] == [("Place", wait)] * bool(wait)


@pytest.mark.parametrize("link", ["2FS+5", "2FS+5 days", "2FS-5 s", "2SS+5 s"])
def test_a_link_that_no_cell_has_is_refused(link: str, tmp_path: Path) -> None:
    with pytest.raises(CellError) as refused:
        import_cell(sheet(tmp_path / "lag.xlsx", [*PROJECT, ["Fasten", 20, "Worker A", link]]))
    (fault,) = refused.value.faults
    assert fault.place == "Sheet1!D4"
    assert f"holds {link!r}: a list of predecessors knows only end-to-start" in fault.message


@pytest.mark.parametrize(("time", "said"), [("1,2", "no task takes more than 1.2 s"), ("12", "")])
def test_times_of_a_second_are_rather_minutes(time: str, said: str, tmp_path: Path) -> None:
    file = tmp_path / "times.csv"
    file.write_text(f"Nr;Mensch;Roboter;Vorgänger\n10;0,5;0,4;\n20;{time};;10\n")
    _, notes = import_cell(file)
    (note,) = [str(note.message) for note in notes if "no unit is stated" in str(note.message)]
    assert said in note
    assert bool(said) == ("[min]" in note and "[TMU]" not in note)


@pytest.mark.parametrize("header", ["Task #", "Step #", "Activity ID", "Element No."])
def test_numbers_of_tasks_as_english_sheets_head_them(header: str, tmp_path: Path) -> None:
    rows = [
        [header, "Description", "Human [s]", "Robot [s]", "Predecessors"],
        [10, "Insert", 12, None, None],
        [20, "Screw", None, 15, 10],
    ]
    cell, _ = import_cell(sheet(tmp_path / "numbers.xlsx", rows))
    assert cell.tasks["20"].after == ("10",)
    assert cell.tasks["20"].label == "Screw"
