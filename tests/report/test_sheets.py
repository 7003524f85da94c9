"""Workbook, MS Project file, Markdown and instructions: every number is that of the plan, and other
programs can open them.
"""

from __future__ import annotations

import io
import re
import shutil
import subprocess
from datetime import datetime
from pathlib import Path
from xml.etree import ElementTree

import openpyxl
import pytest
from tests.draw.cells import gearbox_front, layered_front, thesis_front

from tandem.cell.model import Cell
from tandem.files.spreadsheet import import_cell
from tandem.plan.methods import plan
from tandem.plan.result import Front
from tandem.report.files import write
from tandem.report.instructions import steps
from tandem.report.language import words
from tandem.report.markdown import markdown
from tandem.report.mspdi import SCALE, SPACE, START, mspdi
from tandem.report.xlsx import MOST_SLOTS, slot_seconds, xlsx

FRONTS = {"thesis": thesis_front, "gearbox": gearbox_front, "layered": layered_front}


@pytest.fixture(params=FRONTS)
def front(request: pytest.FixtureRequest) -> Front:
    return FRONTS[request.param]()


def opened(front: Front) -> openpyxl.Workbook:
    return openpyxl.load_workbook(io.BytesIO(xlsx(front)))


# --- the workbook ---------------------------------------------------------------------------------


def test_the_workbook_gives_the_same_cell_again(front: Front, tmp_path: Path) -> None:
    path = write(front, tmp_path / "plan.xlsx")
    assert import_cell(path)[0] == front.cell


def test_the_german_workbook_gives_the_same_cell_again(front: Front, tmp_path: Path) -> None:
    path = write(front, tmp_path / "plan.xlsx", language="de")
    assert "Vorgänge" in openpyxl.load_workbook(path).sheetnames
    assert import_cell(path)[0] == front.cell


def test_every_sentence_is_there_in_german_with_the_same_places() -> None:
    english, german = words("en").sentences, words("de").sentences
    assert set(german) == set(english)
    for key, sentence in english.items():
        assert set(re.findall(r"{\w+}", german[key])) == set(re.findall(r"{\w+}", sentence)), key


def test_the_front_sheet_has_every_plan(front: Front) -> None:
    sheet = opened(front)["Front"]
    rows = [
        (sheet.cell(row, 2).value, sheet.cell(row, 3).value) for row in range(4, 4 + len(front))
    ]
    assert rows == front.points


def test_the_plan_sheet_has_every_step() -> None:
    front = thesis_front()
    sheet = opened(front)["Plan 1"]
    rows = [[cell.value for cell in row[:5]] for row in sheet.iter_rows(min_row=4, max_row=10)]
    assert [(row[0], row[1], row[2], row[3]) for row in rows] == [
        (a.task, a.operators[0], a.start, a.end) for a in front[0].schedule
    ]
    assert sum(row[4] or 0 for row in rows) == front[0].stress


def test_the_gantt_sheet_paints_each_task_where_it_is() -> None:
    front = thesis_front()
    sheet = opened(front)["Gantt 1"]
    slot = slot_seconds(front[0].makespan)
    names = {sheet.cell(row, 1).value: row for row in range(4, 6)}
    for a in front[0].schedule:
        row, first, last = names[a.operators[0]], round(a.start / slot) + 2, round(a.end / slot) + 1
        assert sheet.cell(row, first).value == a.task
        assert sheet.cell(row, first).fill.fgColor.rgb[-6:] not in ("000000", "FFFFFF")
        area = next(
            area
            for area in sheet.merged_cells.ranges
            if (area.min_row, area.min_col) == (row, first)
        )
        assert area.max_col == last


@pytest.mark.parametrize("total", [0.3, 23, 161, 4254, 90_000])
def test_a_gantt_chart_has_few_enough_columns(total: float) -> None:
    assert total / slot_seconds(total) <= MOST_SLOTS


def test_sheets_of_operators_that_are_called_alike() -> None:
    cell = Cell.model_validate(
        {
            "operators": {
                "a/b": {"kind": "human"},
                "A_b": {"kind": "robot"},
                "Tasks": {"kind": "robot"},
            },
            "tasks": {"=1+1": {"time": {"a/b": 1, "A_b": 2, "Tasks": 3}, "stress": 1}},
        }
    )
    book = opened(plan(cell))
    assert {"a_b", "A_b2", "Tasks2"} <= set(book.sheetnames)
    assert book["Plan 1"]["A4"].data_type == "s"


# --- MS Project -----------------------------------------------------------------------------------

ORDER = {
    "Project": (
        "SaveVersion UID Name Title Subject Category Company Manager Author CreationDate Revision"
        " LastSaved ScheduleFromStart StartDate FinishDate FYStartDate CriticalSlackLimit"
        " CurrencyDigits CurrencySymbol CurrencyCode CurrencySymbolPosition CalendarUID"
        " DefaultStartTime DefaultFinishTime MinutesPerDay MinutesPerWeek DaysPerMonth"
        " DefaultTaskType DefaultFixedCostAccrual DefaultStandardRate DefaultOvertimeRate"
        " DurationFormat WorkFormat EditableActualCosts HonorConstraints EarnedValueMethod"
        " InsertedProjectsLikeSummary MultipleCriticalPaths NewTasksEffortDriven NewTasksEstimated"
        " Calendars Tasks Resources Assignments"
    ),
    "Calendar": "UID Name IsBaseCalendar BaseCalendarUID WeekDays Exceptions WorkWeeks",
    "WeekDay": "DayType DayWorking TimePeriod WorkingTimes",
    "WorkingTime": "FromTime ToTime",
    "Task": (
        "UID ID Name Type IsNull CreateDate Contact WBS WBSLevel OutlineNumber OutlineLevel"
        " Priority Start Finish Duration DurationFormat Work Stop Resume ResumeValid EffortDriven"
        " Recurring OverAllocated Estimated Milestone Summary Critical IsSubproject EarlyStart"
        " EarlyFinish LateStart LateFinish FreeSlack TotalSlack FixedCost ConstraintType"
        " CalendarUID ConstraintDate Deadline LevelAssignments Hyperlink IgnoreResourceCalendar"
        " Notes HideBar PredecessorLink"
    ),
    "PredecessorLink": "PredecessorUID Type CrossProject CrossProjectName LinkLag LagFormat",
    "Resource": (
        "UID ID Name Type IsNull Initials Phonetics NTAccount MaterialLabel Code Group WorkGroup"
        " EmailAddress MaxUnits PeakUnits CalendarUID Notes"
    ),
    "Assignment": "UID TaskUID ResourceUID Finish Milestone Notes Start Stop Resume Units Work",
}
"""The sequences of mspdi_pj12.xsd as Microsoft's reference prints them, as far as they are used
here.
"""

REQUIRED = {
    "Project": ("SaveVersion", "CurrencyCode"),
    "Task": ("UID",),
    "Resource": ("UID",),
    "Assignment": ("UID",),
    "Calendar": ("UID",),
}


def project(front: Front) -> ElementTree.Element:
    return ElementTree.fromstring(mspdi(front.knee))


def names(element: ElementTree.Element) -> list[str]:
    return [child.tag.removeprefix(f"{{{SPACE}}}") for child in element]


def text(element: ElementTree.Element, name: str) -> str:
    return element.findtext(f"{{{SPACE}}}{name}") or ""


def test_elements_stand_in_the_order_of_the_schema(front: Front) -> None:
    for element in project(front).iter():
        kind = element.tag.removeprefix(f"{{{SPACE}}}")
        if kind in ORDER:
            order = ORDER[kind].split()
            places = [order.index(name) for name in names(element)]
            assert places == sorted(places), kind
            assert set(REQUIRED.get(kind, ())) <= set(names(element))


def test_the_project_says_what_the_plan_says(front: Front) -> None:
    root = project(front)
    rows = {a.task: a for a in front.knee.schedule}
    tasks = dict(zip(front.cell.tasks, root.iter(f"{{{SPACE}}}Task"), strict=True))
    uid = {text(entry, "UID"): name for name, entry in tasks.items()}

    def clock(date: str) -> float:
        return (datetime.fromisoformat(date) - START).total_seconds() / SCALE

    for name, entry in tasks.items():
        assert clock(text(entry, "Start")) == pytest.approx(rows[name].start, abs=0.01)
        assert clock(text(entry, "Finish")) == pytest.approx(rows[name].end, abs=0.01)
        hours, minutes, seconds = map(
            int, re.fullmatch(r"PT(\d+)H(\d+)M(\d+)S", text(entry, "Duration")).groups()
        )  # type: ignore[union-attr]
        assert (hours * 3600 + minutes * 60 + seconds) / SCALE == pytest.approx(
            rows[name].end - rows[name].start, abs=0.01
        )
        links = [
            uid[text(link, "PredecessorUID")] for link in entry.iter(f"{{{SPACE}}}PredecessorLink")
        ]
        assert tuple(links) == front.cell.tasks[name].after
    operators = dict(
        zip(
            [text(entry, "UID") for entry in root.iter(f"{{{SPACE}}}Resource")],
            front.cell.operators,
            strict=True,
        )
    )
    found = {
        (uid[text(entry, "TaskUID")], operators[text(entry, "ResourceUID")])
        for entry in root.iter(f"{{{SPACE}}}Assignment")
    }
    assert found == {(a.task, who) for a in front.knee.schedule for who in a.operators}


# --- Markdown and instructions --------------------------------------------------------------------


def test_markdown_tables_are_whole(front: Front) -> None:
    said = markdown(front)
    widths = {
        len(re.split(r"(?<!\\)\|", line))
        for line in said.splitlines()
        if line.startswith(("| plan ", "| 1 "))
    }
    assert widths
    for block in re.findall(r"(?:^\|.*\n)+", said, re.MULTILINE):
        assert len({len(re.split(r"(?<!\\)\|", line)) for line in block.splitlines()}) == 1
    for makespan, stress in front.points:
        assert re.search(rf"\| {makespan:g} \| {stress:g} \|", said)


def test_names_are_no_markup() -> None:
    cell = Cell.model_validate(
        {
            "name": "<b>*x*|y",
            "operators": {"h": {"kind": "human"}},
            "tasks": {"a|b": {"time": {"h": 1}, "label": "<script>"}},
        }
    )
    said = markdown(plan(cell))
    assert "<b>" not in said
    assert "<script>" not in said
    assert "# Plan: &lt;b>\\*x\\*\\|y" in said


def test_every_operator_is_told_every_task(front: Front) -> None:
    t = words("en")
    for who in front.cell.operators:
        found = steps(front.cell, front.knee.schedule, who, t)
        assert [(step.task, step.start, step.end) for step in found if step.task] == [
            (a.task, a.start, a.end) for a in front.knee.schedule.of(who)
        ]
        assert all(step.begin for step in found)


def test_who_waits_for_whom() -> None:
    front, t = thesis_front(), words("en")
    robot = {step.task: step for step in steps(front.cell, front[0].schedule, "robot", t)}
    human = {step.task: step for step in steps(front.cell, front[0].schedule, "human", t)}
    assert [one.says for one in human["6"].begin] == [
        "previous step done",
        *(f"robot done with {task}" for task in "124"),
    ]
    assert [one.says for one in human["6"].begin if one.last] == ["robot done with 4"]
    assert robot["4"].then == ("own tasks: 7", "human with 6")
    assert [one.says for one in robot["1"].begin] == ["at once"]
    assert robot["1"].then == ("own tasks: 4, 7", "human with 6")
    assert [one.says for one in robot["7"].begin] == [
        "own tasks done: 1, 2, 4",
        *(f"human done with {task}" for task in "356"),
    ]


# --- other programs -------------------------------------------------------------------------------


@pytest.mark.slow
def test_libreoffice_opens_the_workbook(tmp_path: Path) -> None:
    program = shutil.which("soffice") or pytest.skip(
        "no LibreOffice: apt-get install libreoffice-calc"
    )
    write(gearbox_front(), tmp_path / "plan.xlsx")
    profile = f"-env:UserInstallation=file://{tmp_path / 'profile'}"

    def convert(form: str) -> None:
        call = [
            program,
            profile,
            "--headless",
            "--convert-to",
            form,
            "--outdir",
            str(tmp_path),
            str(tmp_path / "plan.xlsx"),
        ]
        subprocess.run(call, check=True, capture_output=True, timeout=120)

    convert("csv")
    assert "makespan" in (tmp_path / "plan.csv").read_text(encoding="utf-8")
    convert("pdf")
    assert (tmp_path / "plan.pdf").read_bytes().startswith(b"%PDF")
