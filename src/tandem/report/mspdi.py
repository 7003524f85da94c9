"""A plan as MS Project XML (MSPDI): tasks with their links, operators as resources, who does what.

Elements stand in the order of Microsoft's published schema (mspdi_pj12.xsd, 2007), which MS Project
and its relatives insist on. Project counts no shorter times than a tenth of a minute, so every
second of the plan is a minute here; the file's notes say so.
"""

from __future__ import annotations

from collections.abc import Iterator
from datetime import datetime, timedelta
from xml.etree import ElementTree

from tandem.cell.model import Cell
from tandem.cell.parts import Task
from tandem.draw.imprint import imprint
from tandem.draw.style import looks, task_label
from tandem.plan.result import Result
from tandem.report.language import Words, words
from tandem.schedule.critical import critical_path, slack
from tandem.schedule.measures import exact
from tandem.schedule.model import Assignment

SPACE = "http://schemas.microsoft.com/project"
START = datetime(2000, 1, 3)
"""A Monday; the plan knows no dates."""
SCALE = 60
"""Seconds in the file for one second of the plan."""
CALENDAR = 1
START_TO_START, TENTHS = "3", 10
"""A link between starts; tenths of a minute in the file for one second of the plan."""
FINISH_TO_START, AS_SOON_AS_POSSIBLE, START_NO_EARLIER_THAN, FIXED_DURATION, MINUTES, WORK = (
    "1",
    "0",
    "4",
    "1",
    "3",
    "1",
)


def mspdi(result: Result, *, language: str = "en", stale: bool = False) -> bytes:
    """The plan as the bytes of an XML file. Its title carries the plan's digest, and says whether
    it is `stale`: the cell has changed since.

    Each task keeps its place by "start no earlier than"; links are the cell's precedence; breaks of
    operators are not in it.

    Raises:
      UsageError: reports do not speak the language.
    """
    t, cell = words(language), result.cell
    project = ElementTree.Element("Project", xmlns=SPACE)
    name = cell.name or t("unnamed")
    _add(project, "SaveVersion", "12")
    _add(project, "Name", f"{name}.xml"[:255])
    _add(project, "Title", f"{name} · {imprint(result, t, stale=stale)}"[:512])
    _add(project, "Subject", t("project.scale"))
    _add(project, "ScheduleFromStart", "1")
    _add(project, "StartDate", _date(0))
    _add(project, "FinishDate", _date(result.makespan))
    _add(project, "CurrencyCode", "EUR")
    _add(project, "CalendarUID", str(CALENDAR))
    _add(project, "DefaultStartTime", "00:00:00")
    _add(project, "DefaultFinishTime", "23:59:59")
    _add(project, "MinutesPerDay", "1440")
    _add(project, "MinutesPerWeek", "10080")
    _add(project, "DaysPerMonth", "30")
    _add(project, "DurationFormat", MINUTES)
    _add(project, "NewTasksEstimated", "0")
    _calendar(ElementTree.SubElement(project, "Calendars"))
    _tasks(ElementTree.SubElement(project, "Tasks"), result, t)
    _resources(ElementTree.SubElement(project, "Resources"), cell)
    _assignments(ElementTree.SubElement(project, "Assignments"), result)
    ElementTree.indent(project)
    content: bytes = ElementTree.tostring(project, encoding="UTF-8", xml_declaration=True)
    return content + b"\n"


def _calendar(calendars: ElementTree.Element) -> None:
    """Round the clock, seven days a week."""
    calendar = ElementTree.SubElement(calendars, "Calendar")
    _add(calendar, "UID", str(CALENDAR))
    _add(calendar, "Name", "24 h")
    _add(calendar, "IsBaseCalendar", "1")
    days = ElementTree.SubElement(calendar, "WeekDays")
    for day in range(1, 8):
        week_day = ElementTree.SubElement(days, "WeekDay")
        _add(week_day, "DayType", str(day))
        _add(week_day, "DayWorking", "1")
        time = ElementTree.SubElement(
            ElementTree.SubElement(week_day, "WorkingTimes"), "WorkingTime"
        )
        _add(time, "FromTime", "00:00:00")
        _add(time, "ToTime", "00:00:00")


def _tasks(tasks: ElementTree.Element, result: Result, t: Words) -> None:
    cell, schedule = result.cell, result.schedule
    uid = {name: str(place) for place, name in enumerate(cell.tasks, 1)}
    critical, free = (
        {link.assignment.task for link in critical_path(cell, schedule)},
        slack(cell, schedule),
    )
    rows = {a.task: a for a in schedule}
    for name, task in cell.tasks.items():
        a = rows[name]
        label = task_label(cell, name)
        entry = ElementTree.SubElement(tasks, "Task")
        _add(entry, "UID", uid[name])
        _add(entry, "ID", uid[name])
        _add(entry, "Name", (label if label == name else f"{name}: {label}")[:512])
        _add(entry, "Type", FIXED_DURATION)
        _add(entry, "IsNull", "0")
        _add(entry, "OutlineNumber", uid[name])
        _add(entry, "OutlineLevel", "1")
        _add(entry, "Start", _date(a.start))
        _add(entry, "Finish", _date(a.end))
        _add(entry, "Duration", _duration(_span(a)))
        _add(entry, "DurationFormat", MINUTES)
        _add(entry, "Work", _duration(_span(a) * len(a.operators)))
        _add(entry, "EffortDriven", "0")
        _add(entry, "Estimated", "0")
        _add(entry, "Milestone", "0")
        _add(entry, "Summary", "0")
        _add(entry, "Critical", "1" if name in critical else "0")
        _add(entry, "TotalSlack", str(round(free[name] * SCALE / 6)))
        _add(entry, "ConstraintType", START_NO_EARLIER_THAN if a.start else AS_SOON_AS_POSSIBLE)
        _add(entry, "CalendarUID", "-1")
        if a.start:
            _add(entry, "ConstraintDate", _date(a.start))
        if task.deadline is not None:
            _add(entry, "Deadline", _date(task.deadline))
        _add(entry, "Notes", _notes(cell, a, t))
        for first, kind, lag in _links(task):
            link = ElementTree.SubElement(entry, "PredecessorLink")
            _add(link, "PredecessorUID", uid[first])
            _add(link, "Type", kind)
            _add(link, "CrossProject", "0")
            _add(link, "LinkLag", str(round(lag * TENTHS)))
            _add(link, "LagFormat", MINUTES)


def _links(task: Task) -> Iterator[tuple[str, str, float]]:
    """Each task that it comes after, how, and the seconds at least in between; what a wait may last
    at most, MS Project does not know.
    """
    least = {(wait.after, wait.between): wait.at_least for wait in task.wait}
    for first in task.predecessors:
        yield first, FINISH_TO_START, least.get((first, "end-start"), 0.0)
    for (first, between), seconds in least.items():
        if between == "start-start":
            yield first, START_TO_START, seconds


def _notes(cell: Cell, a: Assignment, t: Words) -> str:
    who = " + ".join(looks(cell)[name].label for name in a.operators)
    start, end, span = t.number(a.start), t.number(a.end), t.number(_span(a))
    return (
        f"{t('gantt.bar', task=a.task, who=who, start=start, end=end, span=span)}."
        f" {t('project.scale')}"
    )


def _resources(resources: ElementTree.Element, cell: Cell) -> None:
    for place, look in enumerate(looks(cell).values(), 1):
        entry = ElementTree.SubElement(resources, "Resource")
        _add(entry, "UID", str(place))
        _add(entry, "ID", str(place))
        _add(entry, "Name", look.label)
        _add(entry, "Type", WORK)
        _add(entry, "IsNull", "0")
        _add(entry, "Initials", look.letters)
        _add(entry, "Group", look.kind)
        _add(entry, "MaxUnits", "1")


def _assignments(assignments: ElementTree.Element, result: Result) -> None:
    task_uid = {name: str(place) for place, name in enumerate(result.cell.tasks, 1)}
    operator_uid = {name: str(place) for place, name in enumerate(result.cell.operators, 1)}
    pairs = [(a, who) for a in result.schedule for who in a.operators]
    for place, (a, who) in enumerate(pairs, 1):
        entry = ElementTree.SubElement(assignments, "Assignment")
        _add(entry, "UID", str(place))
        _add(entry, "TaskUID", task_uid[a.task])
        _add(entry, "ResourceUID", operator_uid[who])
        _add(entry, "Finish", _date(a.end))
        _add(entry, "Start", _date(a.start))
        _add(entry, "Units", "1")
        _add(entry, "Work", _duration(_span(a)))


def _span(a: Assignment) -> float:
    return float(exact(a.end) - exact(a.start))


def _date(seconds: float) -> str:
    return (START + timedelta(seconds=round(seconds * SCALE))).isoformat(timespec="seconds")


def _duration(seconds: float) -> str:
    whole = round(seconds * SCALE)
    return f"PT{whole // 3600}H{whole // 60 % 60}M{whole % 60}S"


def _add(parent: ElementTree.Element, name: str, text: str) -> None:
    ElementTree.SubElement(parent, name).text = "".join(
        c for c in text if c >= " " or c in "\t\n\r"
    )
