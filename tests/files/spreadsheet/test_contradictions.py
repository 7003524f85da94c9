"""What a sheet says beside the columns that are read, and against them, is asked about and never
planned over: conditions, conditions of who can, deleted rows, struck cells, figures of the shift.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import openpyxl
import pytest
from openpyxl.cell.rich_text import CellRichText, TextBlock
from openpyxl.cell.text import InlineFont
from openpyxl.comments import Comment
from openpyxl.styles import Font
from tests.files.spreadsheet.books import sheet

from tandem.errors import CellError
from tandem.files.spreadsheet import import_cell

TIMES = ["No", "Task", "Human [s]", "Robot [s]", "Pred"]
WORK = [[1, "a", 10, 12, None], [2, "b", 11, 13, 1]]


def refused(path: Path, **options: Any) -> list[tuple[str, str]]:
    with pytest.raises(CellError) as caught:
        import_cell(path, **options)
    return [(fault.place.rpartition("!")[2], fault.message) for fault in caught.value.faults]


def beside(tmp_path: Path, header: str, *values: Any) -> Path:
    """The work with one more column."""
    rows = [[*row, value] for row, value in zip(WORK, values, strict=True)]
    return sheet(tmp_path / "plan.xlsx", [[*TIMES, header], *rows])


# --- below the table ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "below",
    [
        [[], ["Takt time", None, 60], ["Shift length", None, 27000]],
        [[], [None, "Takt [s]", 60], [None, "Demand per shift", 450]],
        [["Total work content", None, 21, 25]],
        [["Sum of times", None, 21, 25], ["Line balance %", None, 85, 90]],
        [["Zykluszeit", None, 21, 25], ["Auslastung", None, 0.5, 0.6]],
        [["Σ", None, 21, 25], ["Verteilzeit 10 %", None, 2, 2.5], ["Vorgabezeit", None, 23, 28]],
        [["Ø", None, 10.5, 12.5], ["Std dev", None, 0.5, 0.5]],
        [["Cycle time target", None, 60]],
        [[None, "Sum station 1", 21, 25]],
        [["Sum", None, 21, 25], ["per shift (450)", None, 9450, 11250]],
    ],
)
def test_figures_below_the_tasks_are_no_tasks(below: Sequence[Any], tmp_path: Path) -> None:
    cell, notes = import_cell(sheet(tmp_path / "plan.xlsx", [TIMES, *WORK, *below]))
    assert list(cell.tasks) == ["1", "2"]
    rows = [4 + place for place, row in enumerate(below) if row]
    assert [
        note.place[-1] for note in notes if note.kind == "row" and "blank" not in str(note)
    ] == [str(row) for row in rows]


def test_sums_of_each_station_are_no_tasks(tmp_path: Path) -> None:
    rows = [
        ["Task", "Human [s]", "Robot [s]"],
        ["a", 10, 12],
        ["b", 11, 13],
        ["Subtotal Station 1", 21, 25],
        ["c", 5, 6],
        ["Subtotal Station 2", 5, 6],
    ]
    cell, _ = import_cell(sheet(tmp_path / "plan.xlsx", rows))
    assert list(cell.tasks) == ["a", "b", "c"]


def test_work_that_is_called_almost_so_stays_work(tmp_path: Path) -> None:
    """No figure of the shift, no sum, in the middle of the list, or in quotes."""
    rows = [
        ["Task", "Human [s]"],
        ["Idle time", 3],
        ["o", 4],
        ["Overall inspection", 4],
        ["Balance", 5],
        ['"Takt time"', 6],
    ]
    cell, _ = import_cell(sheet(tmp_path / "plan.xlsx", rows))
    assert list(cell.tasks) == ["Idle time", "o", "Overall inspection", "Balance", "Takt time"]


def test_work_with_a_number_of_its_own_is_no_figure(tmp_path: Path) -> None:
    rows = [TIMES, *WORK, [3, "Idle time", 5, None, 2]]
    cell, _ = import_cell(sheet(tmp_path / "plan.xlsx", rows))
    assert list(cell.tasks) == ["1", "2", "3"]


# --- one operator under several conditions --------------------------------------------------------


@pytest.mark.parametrize(
    "headers",
    [
        ["Observed time human [s]", "Normal time human [s]"],
        ["Human best [s]", "Human worst [s]"],
        ["Human before [s]", "Human after [s]"],
        ["Human [s]", "σ human [s]"],
        ["tr Werker [min]", "te Werker [min]"],
        ["Model A human [s]", "Model B human [s]"],
        ["Left hand [s]", "Right hand [s]"],
        ["Hand links [s]", "Hand rechts [s]"],
        ["Human P50 [s]", "Human P90 [s]"],
        ["Human 1 pc [s]", "Human 10 pcs [s]"],
        ["Human shift 1 [s]", "Human shift 2 [s]"],
        ["Human min", "Human max"],
    ],
)
def test_conditions_are_no_people(headers: list[str], tmp_path: Path) -> None:
    rows = [["Task", *headers, "Robot [s]"], ["a", 8, 10, 9], ["b", 4, 5, 6]]
    ((place, message),) = refused(sheet(tmp_path / "plan.xlsx", rows))
    assert place in ("B1", "C1")
    assert all(word in message for word in ("=ignore", "--map", repr(headers[0])))


def test_a_group_above_the_operators_may_be_a_condition(tmp_path: Path) -> None:
    rows = [
        [None, "Today", None, "Future", None],
        ["Task", "Human [s]", "Robot [s]", "Human [s]", "Robot [s]"],
        ["a", 8, 10, 9, 7],
    ]
    path = sheet(tmp_path / "plan.xlsx", rows, merged=["B1:C1", "D1:E1"])
    assert [place for place, _ in refused(path)] == ["D2", "E2"]


def test_people_with_a_name_of_their_own_are_not_asked_about(tmp_path: Path) -> None:
    headers = ["Werker 1", "Werker 2", "Left cobot", "Right cobot", "Human Anna"]
    rows = [["Task", *(f"{name} [s]" for name in headers)], ["a", 1, 2, 3, 4, 5]]
    cell, _ = import_cell(sheet(tmp_path / "plan.xlsx", rows))
    assert list(cell.operators) == headers


def test_a_condition_may_be_somebody_all_the_same(tmp_path: Path) -> None:
    rows = [["Task", "Human best [s]", "Human worst [s]"], ["a", 8, 10]]
    cell, _ = import_cell(sheet(tmp_path / "plan.xlsx", rows), humans=["Human worst"])
    assert list(cell.operators) == ["Human best", "Human worst"]


@pytest.mark.parametrize(
    "header",
    ["Time human [s] per 10 pcs", "Time per screw human [s]", "Zeit Mensch je Schraube [s]"],
)
def test_a_time_of_many_or_of_another_thing_is_asked_about(header: str, tmp_path: Path) -> None:
    path = sheet(tmp_path / "plan.xlsx", [["Task", header, "Anzahl"], ["a", 8, 4]])
    ((place, message),) = refused(path)
    assert (place, "is neither a task nor a piece" in message) == ("B1", True)
    cell, _ = import_cell(path, columns={"B": "time human [s]"})
    assert cell.tasks["a"].time == {"human": 8}


@pytest.mark.parametrize(
    "header",
    ["Time human [s] per task", "Zeit pro Vorgang Mensch [s]", "Time human per assembly [s]"],
)
def test_a_time_of_a_task_is_what_it_is(header: str, tmp_path: Path) -> None:
    rows = [["Task", header], ["a", 8]]
    assert len(import_cell(sheet(tmp_path / "plan.xlsx", rows))[0].tasks) == 1


def test_a_total_that_is_the_product_shows_that_the_time_is_that_of_one(tmp_path: Path) -> None:
    rows = [["Task", "Qty", "Human [s]", "Total human [s]"], ["a", 4, 3, 12], ["b", 1, 5, 5]]
    ((place, message),) = refused(sheet(tmp_path / "plan.xlsx", rows))
    assert place == "D1"
    assert "'Human [s]' times 'Qty'" in message
    rows[0][2] = "Human per piece [s]"
    cell, _ = import_cell(sheet(tmp_path / "plan.xlsx", rows))
    assert cell.tasks["a"].time == {"Human": 12}


def test_how_many_people_are_no_seconds(tmp_path: Path) -> None:
    path = beside(tmp_path, "Workers", 2, 1)
    ((place, message),) = refused(path)
    assert (place, "how many people" in message) == ("F1", True)
    assert len(import_cell(path, columns={"Workers": "ignore"})[0].operators) == 2


def test_the_only_times_of_somebody_are_not_left_out_in_a_note(tmp_path: Path) -> None:
    """ "cycle" is no operator's time; without both columns, the robot would do all the work."""
    rows = [["Task", "Human cycle 1 [s]", "Human cycle 2 [s]", "Robot [s]"], ["a", 8, 10, 9]]
    path = sheet(tmp_path / "plan.xlsx", rows)
    ((place, message),) = refused(path)
    assert (place, "no other column holds a time of a human" in message) == ("B1", True)
    cell, _ = import_cell(path, columns={"Human cycle 1 [s]": "time human"})
    assert list(cell.operators) == ["human", "Robot"]


# --- a line that says another unit ----------------------------------------------------------------


@pytest.mark.parametrize(
    ("line", "unit"),
    [
        ("all times in min", "min"),
        ("Zeiten in Minuten", "min"),
        ("Unit: min", "min"),
        ("Alle Angaben in HM", "1/100 min"),
        ("* all times in TMU", "TMU"),
    ],
)
@pytest.mark.parametrize("below", [False, True])
def test_a_line_with_another_unit_than_the_headers_is_asked_about(
    line: str, unit: str, below: bool, tmp_path: Path
) -> None:
    rows = [TIMES, *WORK, [], [line]] if below else [[line], [], TIMES, *WORK]
    path = sheet(tmp_path / "plan.xlsx", rows)
    ((place, message),) = refused(path)
    assert place == ("C1" if below else "C3")
    where = "Sheet1!A5" if below else "Sheet1!A1"
    assert message == (
        f"'Human [s]', 'Robot [s]': [s] stands here, and {line!r} ({where}) says {unit}. Mend the"
        ' one that is wrong, or say the unit of the column with --map "C=time Human [s]".'
    )
    told = {"C": "time Human [s]", "D": "time Robot [s]"}
    assert import_cell(path, columns=told)[0].tasks["1"].time == {"Human": 10, "Robot": 12}


def test_only_the_columns_that_a_line_contradicts_are_named(tmp_path: Path) -> None:
    header = ["No", "Task", "Human [min]", "Robot [s]", "Pred"]
    ((place, message),) = refused(sheet(tmp_path / "plan.xlsx", [["Times in min"], header, *WORK]))
    assert (place, message.startswith("'Robot [s]': [s] stands here")) == ("D2", True)


@pytest.mark.parametrize(
    "line",
    [
        "all times in seconds",
        "Zeiten in s",
        "Cycle time in min: 2",
        "Taktzeit 2 min",
        "Schicht: 480 min",
    ],
)
def test_a_line_that_agrees_or_speaks_of_something_else_is_no_contradiction(
    line: str, tmp_path: Path
) -> None:
    cell, _ = import_cell(sheet(tmp_path / "plan.xlsx", [[line], TIMES, *WORK]))
    assert cell.tasks["1"].time == {"Human": 10, "Robot": 12}


def test_a_line_about_the_times_of_one_says_nothing_of_those_of_others(tmp_path: Path) -> None:
    header = ["No", "Task", "Human [s]", "Robot [min]", "Pred"]
    rows = [["Roboterzeiten in min (Simulation)"], header, *WORK]
    cell, _ = import_cell(sheet(tmp_path / "plan.xlsx", rows))
    assert cell.tasks["1"].time == {"Human": 10, "Robot": 720}
    rows[0][0] = "Roboterzeiten in s"
    assert [place for place, _ in refused(sheet(tmp_path / "plan.xlsx", rows))] == ["D2"]


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("Zeiten je Los in s", "je Los"),
        ("Zeiten für 10 Stück", "für 10 Stück"),
        ("Times for 5 units [s]", "for 5 units"),
        ("All times per batch", "per batch"),
        ("Zeiten bei 50 % Geschwindigkeit", "50 % Geschwindigkeit"),
        ("times x 1000", "x 1000"),
    ],
)
def test_a_line_that_makes_the_times_those_of_other_work_is_asked_about(
    line: str, words: str, tmp_path: Path
) -> None:
    path = sheet(tmp_path / "plan.xlsx", [[line], TIMES, *WORK])
    ((place, message),) = refused(path)
    assert (place, message.startswith(f"{line!r} (Sheet1!A1) speaks of times {words!r}")) == (
        "C2",
        True,
    )
    told = {"C": "time Human [s]", "D": "time Robot [s]"}
    assert import_cell(path, columns=told)[0].tasks["1"].time == {"Human": 10, "Robot": 12}


@pytest.mark.parametrize(
    "line",
    [
        "Zeiten je Stück in s",
        "Times per product",
        "Zeiten bei 100 % Geschwindigkeit",
        "Zeiten inkl. 10 % Verteilzeit",
        "Losgröße 10",
        "Zeiten pro Zyklus",
        "Zeitaufnahme 3 x 10 Zyklen",
        "Zeiten: Mittel aus je 10 Messungen",
    ],
)
def test_a_line_that_does_no_such_thing(line: str, tmp_path: Path) -> None:
    cell, _ = import_cell(sheet(tmp_path / "plan.xlsx", [[line], TIMES, *WORK]))
    assert cell.tasks["1"].time == {"Human": 10, "Robot": 12}


# --- columns of several stations ------------------------------------------------------------------


@pytest.mark.parametrize(
    ("headers", "stations"),
    [
        (["Station 1 Human", "Station 2 Human", "Station 1 Robot"], "Station 1, Station 2"),
        (["Mensch Station A", "Roboter Station A", "Mensch Station B"], "Station A, Station B"),
        (["AP10 Werker", "AP20 Werker", "AP20 Cobot"], "AP 10, AP 20"),
        (["Arbeitsplatz 3 Werker", "Cobot", "Arbeitsplatz 4 Werker"], "Arbeitsplatz 3, Arbeitspl"),
        (["ST1 Cobot", "Anna ST1", "Bert ST2"], "ST 1, ST 2"),
    ],
)
def test_times_at_several_stations_are_no_operators_of_one_cell(
    headers: list[str], stations: str, tmp_path: Path
) -> None:
    rows = [["Task", *(f"{name} [s]" for name in headers)], ["a", 8, 9, 7], ["b", None, None, 6]]
    faults = refused(sheet(tmp_path / "plan.xlsx", rows))
    (message,) = [message for _, message in faults if "as one cell" in message]
    assert f"the tasks of {stations}" in message
    assert "=ignore" in message


def test_stations_over_the_operators_are_asked_about_and_can_be_told(tmp_path: Path) -> None:
    rows = [
        [None, "Station 1", None, "Station 2"],
        ["Task", "Human [s]", "Robot [s]", "Human [s]"],
        ["a", 8, 10, None],
        ["b", 7, None, 9],
    ]
    path = sheet(tmp_path / "plan.xlsx", rows, merged=["B1:C1"])
    ((place, message),) = refused(path)
    assert (place, '--human "Station 2 Human"' in message) == ("D2", True)
    assert len(import_cell(path, humans=["Station 2 Human"])[0].operators) == 3
    alone, _ = import_cell(path, columns={"D": "ignore"})
    assert alone.tasks["a"].time == {"Human": 8, "Robot": 10}


@pytest.mark.parametrize(
    "headers",
    [["Station 1 Human", "Station 1 Robot"], ["Human 1", "Human 2"], ["Stanley 1", "Human 2"]],
)
def test_one_station_and_people_by_number_are_one_cell(headers: list[str], tmp_path: Path) -> None:
    rows = [["Task", *(f"{name} [s]" for name in headers)], ["a", 8, 9]]
    cell, _ = import_cell(
        sheet(tmp_path / "plan.xlsx", rows), humans=["Stanley 1"] * ("Stanley 1" in headers)
    )
    assert list(cell.operators) == headers


# --- rows that are no work ------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("Pause", "a break"),
        ("Break 10 min", "a break"),
        ("Mittagspause", "a break"),
        ("Coffee break", "a break"),
        ("Lunch", "a break"),
        ("Rüstzeit", "getting ready"),
        ("Rüsten", "getting ready"),
        ("Setup (per lot)", "getting ready"),
        ("Changeover", "getting ready"),
        ("Summe", "a total or a figure"),
        ("Verteilzeit 8 %", "a total or a figure"),
        ("Allowance", "a total or a figure"),
        ("Taktzeit", "a total or a figure"),
    ],
)
def test_rows_that_are_numbered_on_and_no_work_are_asked_about(
    name: str, says: str, tmp_path: Path
) -> None:
    rows = [TIMES, *WORK, [3, name, 30, None, None]]
    ((place, message),) = refused(sheet(tmp_path / "plan.xlsx", rows))
    assert place == "A4"
    assert f"{name!r} reads like {says}" in message
    assert message.endswith("""write '3' in double quotes: "3".""")
    rows[-1][0] = '"3"'
    cell, _ = import_cell(sheet(tmp_path / "plan.xlsx", rows))
    assert cell.tasks["3"].label == name


def test_a_name_like_a_total_with_work_below_it_is_work(tmp_path: Path) -> None:
    rows = [TIMES, [1, "Summe", 3, 4, None], [2, "b", 11, 13, None]]
    cell, _ = import_cell(sheet(tmp_path / "plan.xlsx", rows))
    assert cell.tasks["1"].label == "Summe"


@pytest.mark.parametrize("name", ["Aushärten", "Warten / Abkühlen", "Curing (oven)", "Trocknen"])
def test_waiting_that_is_listed_as_work_is_a_note(name: str, tmp_path: Path) -> None:
    rows = [TIMES, *WORK, [3, name, 600, None, 2]]
    _, notes = import_cell(sheet(tmp_path / "plan.xlsx", rows))
    (said,) = [note.said for note in notes if "is busy all the time" in note.message]
    assert said.sentence("de").startswith(f"{name!r} wird als Arbeit geplant")


def test_work_that_is_not_done_each_time_is_a_note(tmp_path: Path) -> None:
    rows = [TIMES, [1, "a (optional)", 3, 4, None], [2, "Prüfen, jedes 10. Teil", 1, 3, 1]]
    rows += [[3, "Warenprobe", 1, 2, None], [4, "Wartung", 1, 2, None]]
    _, notes = import_cell(sheet(tmp_path / "plan.xlsx", rows))
    told = [note.message for note in notes if "in every product" in note.message]
    assert told == [
        "planned in every product, whatever their names say of when they are done:"
        " 'a (optional)', 'Prüfen, jedes 10. Teil'."
    ]
    assert not any("busy all the time" in note.message for note in notes)


def test_a_break_is_asked_about_wherever_it_stands(tmp_path: Path) -> None:
    """As a task, the robot could take it while the human works on."""
    rows = [["Task", "Human [s]", "Robot [s]", "Pred"], ["a", 8, 9, None]]
    rows += [["Pause", 300, 300, "a"], ["b", 8, 9, "Pause"]]
    ((place, message),) = refused(sheet(tmp_path / "plan.xlsx", rows))
    assert (place, "'breaks', such as 300-600" in message) == ("A3", True)
    rows[2][0] = '"Pause"'
    cell, _ = import_cell(sheet(tmp_path / "plan.xlsx", rows))
    assert cell.tasks["b"].after == ("Pause",)


def test_getting_ready_within_the_sequence_is_a_task_and_a_note(tmp_path: Path) -> None:
    rows = [TIMES, [1, "Rüsten", 10, 12, None], [2, "b", 11, 13, 1]]
    cell, notes = import_cell(sheet(tmp_path / "plan.xlsx", rows))
    assert list(cell.tasks) == ["1", "2"]
    (said,) = [note.said for note in notes if "every product" in note.message]
    assert said.sentence("de").startswith("'Rüsten' wird als Vorgang jedes Stücks geplant")


@pytest.mark.parametrize(
    "name",
    ["Break edges", "Set up housing", "Pausentaste prüfen", "Prepare setup", "Rest", "Change tip"],
)
def test_work_with_such_a_word_in_its_name_is_work(name: str, tmp_path: Path) -> None:
    rows = [TIMES, *WORK, [3, name, 30, None, None]]
    cell, notes = import_cell(sheet(tmp_path / "plan.xlsx", rows))
    assert cell.tasks["3"].label == name
    assert not any("every product" in note.message for note in notes)


# --- columns that contradict ----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("header", "values"),
    [
        ("Robot possible?", ("Y", "N")),
        ("Automatisierbar", ("ja", "nein")),
        ("Suitability", ("both", "human only")),
        ("Eignung", ("beide", "nur Mensch")),
        ("Active", ("Yes", "No")),
        ("Gelöscht", (None, "x")),
        ("Status", ("open", "deleted")),
        ("Bemerkung", ("", "entfällt")),
        ("Relation", ("FS", "SS")),
        ("Lag [s]", (0, 20)),
    ],
)
def test_what_contradicts_the_plan_is_asked_about(
    header: str, values: tuple[Any, Any], tmp_path: Path
) -> None:
    path = beside(tmp_path, header, *values)
    ((place, message),) = refused(path)
    assert place == "F3"
    assert f'--map "{header}=ignore"' in message
    cell, _ = import_cell(path, columns={header: "ignore"})
    assert len(cell.tasks) == 2


@pytest.mark.parametrize(
    ("header", "values", "words"),
    [
        ("Status", ("open", "done"), "column F 'Status' was not read. If it matters"),
        ("Active", ("Yes", "Yes"), "column F 'Active' was not read. If it matters"),
        ("Robot possible?", ("Y", "Y"), "column F 'Robot possible?' was not read. If it matters"),
        ("Station", ("ST1", "ST2"), "the tasks of ST1, ST2 are planned together"),
        ("Every nth cycle", (1, 5), "each task is planned once, in the time that stands there"),
        ("Current operator", ("Human", "Robot"), "who does a task is for the plan to say"),
        ("Relation", ("FS", "FS"), "column F 'Relation' was not read. If it matters"),
    ],
)
def test_what_contradicts_nothing_is_a_note(
    header: str, values: tuple[Any, Any], words: str, tmp_path: Path
) -> None:
    _, notes = import_cell(beside(tmp_path, header, *values))
    assert any(words in note.message for note in notes)


def test_a_share_of_somebody_is_nobody_new(tmp_path: Path) -> None:
    rows = [
        ["ID", "Name", "Duration [min]", "Resource Names"],
        [1, "a", 10, "Human"],
        [2, "b", 5, "Human[50%]"],
    ]
    ((place, message),) = refused(sheet(tmp_path / "plan.xlsx", rows))
    assert (place, "gives a share or a number of somebody" in message) == ("D3", True)


def test_a_name_of_two_tasks_is_no_reference_to_the_last(tmp_path: Path) -> None:
    rows = [["No", "Task", "Human [s]", "Pred"]]
    rows += [[1, "Screw", 3, None], [2, "Screw", 4, 1], [3, "Pack", 5, "Screw"]]
    ((place, message),) = refused(sheet(tmp_path / "plan.xlsx", rows))
    assert (place, "Several tasks are called so, 1, 2" in message) == ("D4", True)


@pytest.mark.parametrize("header", ["is blocked by", "Blocked by"])
def test_what_blocks_a_task_comes_before_it(header: str, tmp_path: Path) -> None:
    rows = [["Key", "Human [s]", header], ["AB-1", 3, None], ["AB-2", 4, "AB-1"]]
    cell, _ = import_cell(sheet(tmp_path / "plan.xlsx", rows))
    assert cell.tasks["AB-2"].after == ("AB-1",)


# --- what is struck out ---------------------------------------------------------------------------


def struck(tmp_path: Path, *cells: str) -> Path:
    book = openpyxl.Workbook()
    for row in (TIMES, *WORK):
        book.active.append(row)
    for cell in cells:
        book.active[cell].font = Font(strike=True)
    book.save(tmp_path / "plan.xlsx")
    return tmp_path / "plan.xlsx"


def test_a_task_that_is_struck_through_is_asked_about(tmp_path: Path) -> None:
    faults = refused(struck(tmp_path, *(f"{column}3" for column in "ABCDE")))
    assert (
        "A3",
        "is struck through, so it may count no more: delete it, or take the line away.",
    ) in (faults)


def test_a_time_that_is_struck_through_is_asked_about(tmp_path: Path) -> None:
    assert [place for place, _ in refused(struck(tmp_path, "D2"))] == ["D2"]


def test_an_empty_cell_may_be_struck_through(tmp_path: Path) -> None:
    assert len(import_cell(struck(tmp_path, "E2"))[0].tasks) == 2


def test_runs_of_a_text_are_not_read_in_one(tmp_path: Path) -> None:
    """Read in one, the first time would be 1012 and the second 101."""
    out, raised = InlineFont(strike=True), InlineFont(vertAlign="superscript")
    book = openpyxl.Workbook()
    for row in (TIMES, *WORK):
        book.active.append(row)
    book.active["C2"] = CellRichText(TextBlock(out, "10"), "12")
    book.active["C3"] = CellRichText("10", TextBlock(raised, "1"))
    book.active["B2"] = CellRichText("m", TextBlock(raised, "2"), " cut")
    book.save(tmp_path / "plan.xlsx")
    assert refused(tmp_path / "plan.xlsx") == [
        ("C2", "holds '1012', of which '10' is struck through: leave only what counts."),
        ("C3", "holds '101', of which '1' is a raised mark: leave only the number."),
    ]


def test_comments_at_the_cells_that_are_read_are_told(tmp_path: Path) -> None:
    book = openpyxl.Workbook()
    for row in ([*TIMES, "Colour"], *WORK):
        book.active.append(row)
    book.active["C3"].comment = Comment("in minutes!", "somebody")
    book.active["F3"].comment = Comment("blue", "somebody")
    book.save(tmp_path / "plan.xlsx")
    _, notes = import_cell(tmp_path / "plan.xlsx")
    told = [note.message for note in notes if "comments" in note.message]
    assert told == ["comments at cells were not read: C3 'in minutes!'."]


# --- text files of other machines -----------------------------------------------------------------


@pytest.mark.parametrize(
    ("code", "said"),
    [("cp1252", "Windows-1252"), ("cp850", "DOS (code page 850)"), ("mac_roman", "Mac Roman")],
)
def test_the_umlauts_tell_the_code_of_a_text_file(code: str, said: str, tmp_path: Path) -> None:
    """Read in another code, "Vorgänger" is no known header, and every task begins at once."""
    text = "Nr;Vorgang;Zeit Mensch [s];Vorgänger\n1;Gehäuse;10,5;\n2;Prüfen;3;1\n"
    (tmp_path / "plan.csv").write_bytes(text.encode(code))
    cell, notes = import_cell(tmp_path / "plan.csv")
    assert cell.tasks["2"].after == ("1",)
    assert cell.tasks["1"].label == "Gehäuse"
    assert any(said in note.message for note in notes)
