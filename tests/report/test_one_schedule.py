"""A stored plan is one schedule: nine files and an explanation of it tell the same starts, ends and
operators, and carry the same digest. Each file is read as those read it for whom it was written.

The schedule has one task later than need be, which no planner would answer: whatever shows it has
read what was stored.
"""

from __future__ import annotations

import csv
import json
import re
import shutil
from collections.abc import Callable
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import openpyxl
import pytest

import tandem
from tandem.cli.root import run
from tandem.draw.style import looks
from tandem.plan.result import Front, Result, Status
from tandem.report import write
from tandem.report.mspdi import SCALE, SPACE, START
from tandem.report.stored import read_plan
from tandem.schedule.checker import faults
from tandem.schedule.critical import slack
from tandem.schedule.model import Schedule

EXAMPLES = Path(__file__).parents[2] / "examples"
ENDINGS = ("html", "xlsx", "md", "png", "svg", "pdf", "csv", "xml", "json")
LATER = 0.5
"""Seconds by which one task is put off; a decimal, so that commas and points are read too."""
POINT = 1

Rows = dict[str, tuple[float, float, frozenset[str]]]
"""Task -> start and end in seconds, and who does it."""


def put_off(result: Result) -> Result:
    """The same values by a schedule in which one task begins later than it could."""
    free = slack(result.cell, result.schedule)
    for late in result.schedule:
        if free[late.task] < LATER:
            continue
        moved = replace(late, start=late.start + LATER, end=late.end + LATER)
        rows = (moved if a == late else a for a in result.schedule)
        if not faults(result.cell, other := Schedule(tuple(rows))):
            return replace(result, schedule=other, canonical=False)
    raise AssertionError("no task of the schedule can be put off")


@pytest.fixture(scope="module", params=[("thesis", "en"), ("crew", "de")], ids=lambda p: p[0])
def stored(request: Any, tmp_path_factory: Any) -> tuple[Path, Result, str]:
    """A folder with a plan and its nine files, the schedule in it, and the language."""
    name, language = request.param
    folder: Path = tmp_path_factory.mktemp(name)
    shutil.copy(EXAMPLES / f"{name}.yaml", folder / "cell.yaml")
    cell = tandem.load(folder / "cell.yaml")
    front = tandem.plan(cell, method="longest-tail", time_limit=5, workers=1)
    later = put_off(front[POINT - 1])
    results = tuple(later if n == POINT else r for n, r in enumerate(front, 1))
    write(replace(front, results=results, source="cell.yaml"), folder / "plan.json")
    files = [part for ending in ENDINGS for part in ("-o", str(folder / f"shown.{ending}"))]
    plan = str(folder / "plan.json")
    assert run(["report", plan, "--point", str(POINT), "--lang", language, *files]) == 0
    return folder, later, language


def expected(result: Result) -> Rows:
    return {a.task: (a.start, a.end, frozenset(a.operators)) for a in result.schedule}


def number(text: Any) -> float:
    return float(str(text).replace(",", "."))


def row(cell: Any, task: str, who: str, start: Any, end: Any) -> tuple[str, Any]:
    """A row as people read it: a task's name before its label, operators by their labels."""
    names = {look.label: name for name, look in looks(cell).items()}
    return task.partition(":")[0], (
        number(start),
        number(end),
        frozenset(names[label] for label in who.split(" + ")),
    )


def of_json(folder: Path, result: Result) -> Rows:
    return expected(read_plan(folder / "shown.json").front[POINT - 1])


def of_csv(folder: Path, result: Result) -> Rows:
    with (folder / "shown.csv").open(encoding="utf-8-sig", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["shown"] == "yes"]
    assert {row["plan"] for row in rows} == {result.schedule.digest}
    return {
        r["task"]: (
            float(r["start_s"]),
            float(r["end_s"]),
            frozenset(r["operators"].split(" + ")),
        )
        for r in rows
    }


def of_md(folder: Path, result: Result) -> Rows:
    text = (folder / "shown.md").read_text().replace("\\", "")
    section = text.split("\n## ")[2].partition("\n### ")[0]
    assert result.schedule.digest in section
    sheets = text.split("\n### ")[1:]
    assert len(sheets) == len(result.cell.operators)
    assert all(result.schedule.digest in sheet for sheet in sheets)
    lines = [line.strip("| ").split(" | ") for line in section.splitlines() if line[:1] == "|"]
    return dict(row(result.cell, *line[:4]) for line in lines[2:])


def of_xlsx(folder: Path, result: Result) -> Rows:
    book = openpyxl.load_workbook(folder / "shown.xlsx")
    naming = [
        sheet.title
        for sheet in book
        if any(result.schedule.digest in str(c.value) for line in sheet for c in line)
    ]
    plan, *_ = [name for name in naming if name == f"Plan {POINT}"]
    # the front, the plan, its Gantt chart and a sheet for each operator
    assert len(naming) == 3 + len(result.cell.operators)
    lines = [[cell.value for cell in line] for line in book[plan].iter_rows(min_row=4)]
    return dict(row(result.cell, *line[:4]) for line in lines[: len(result.schedule)])


def of_xml(folder: Path, result: Result) -> Rows:
    root = ElementTree.parse(folder / "shown.xml").getroot()
    space = {"p": SPACE}

    def entries(path: str) -> list[dict[str, str]]:
        return [
            {part.tag.partition("}")[2]: part.text or "" for part in entry}
            for entry in root.findall(path, space)
        ]

    assert result.schedule.digest in root.findtext("p:Title", namespaces=space)
    labels = {entry["UID"]: entry["Name"] for entry in entries("p:Resources/p:Resource")}
    who: dict[str, list[str]] = {}
    for entry in entries("p:Assignments/p:Assignment"):
        who.setdefault(entry["TaskUID"], []).append(labels[entry["ResourceUID"]])

    def second(text: str) -> float:
        return (datetime.fromisoformat(text) - START).total_seconds() / SCALE

    return dict(
        row(
            result.cell,
            entry["Name"],
            " + ".join(who[entry["UID"]]),
            second(entry["Start"]),
            second(entry["Finish"]),
        )
        for entry in entries("p:Tasks/p:Task")
    )


def of_svg(folder: Path, result: Result) -> Rows:
    """Read off the bars: their outlines carry the task and the operator, and stand to scale."""
    text = (folder / "shown.svg").read_text()
    assert f"{result.schedule.digest};" in re.sub(r"<!--.*?-->", "", text)
    bars: dict[tuple[str, str], tuple[float, float]] = {}
    for who in result.cell.operators:
        for task in result.cell.tasks:
            drawn = re.search(rf'<g id="task {re.escape(task)} {who}">\s*<path d="([^"]*)"', text)
            if drawn:
                across = [float(x) for x in re.findall(r"[ML] (\S+)", drawn[1])]
                bars[task, who] = (min(across), max(across))
    left, right = min(a for a, _ in bars.values()), max(b for _, b in bars.values())
    first = min(a.start for a in result.schedule)
    scale = (result.makespan - first) / (right - left)
    rows: Rows = {}
    for (task, who), ends in bars.items():
        start, end = (round(first + (x - left) * scale, 2) for x in ends)
        rows[task] = (start, end, rows.get(task, (0, 0, frozenset()))[2] | {who})
    return rows


def of_explanation(folder: Path, result: Result, told: str) -> Rows:
    document = json.loads(told)
    assert document["digest"] == result.schedule.digest
    return {r["task"]: (r["start"], r["end"], frozenset(r["operators"])) for r in document["tasks"]}


READERS: dict[str, Callable[[Path, Result], Rows]] = {
    "json": of_json,
    "csv": of_csv,
    "md": of_md,
    "xlsx": of_xlsx,
    "xml": of_xml,
    "svg": of_svg,
}


@pytest.mark.parametrize("ending", READERS)
def test_every_file_tells_the_stored_schedule(
    stored: tuple[Path, Result, str], ending: str
) -> None:
    folder, result, _ = stored
    assert READERS[ending](folder, result) == expected(result)


@pytest.mark.browser
def test_the_page_in_a_browser_opens_with_the_stored_schedule(
    stored: tuple[Path, Result, str], browser: Any
) -> None:
    folder, result, _ = stored
    context = browser.new_context(offline=True)
    page = context.new_page()
    page.goto((folder / "shown.html").as_uri())
    section = page.locator(".plan:visible")
    assert section.get_attribute("id") == f"plan-{POINT}"
    assert result.schedule.digest in section.locator("p.note").first.inner_text()
    lines = section.locator(".steps tbody tr").all()
    found = dict(row(result.cell, *line.locator("th, td").all_inner_texts()[:4]) for line in lines)
    carried = json.loads(page.locator("#result").text_content())
    context.close()
    assert found == expected(result)
    assert carried["front"][POINT - 1]["digest"] == result.schedule.digest


@pytest.mark.parametrize("ending", ["png", "pdf"])
def test_pictures_without_text_say_in_their_file_which_plan_they_show(
    stored: tuple[Path, Result, str], ending: str
) -> None:
    folder, result, _ = stored
    data = (folder / f"shown.{ending}").read_bytes()
    # a PDF holds letters beyond ASCII, and then all of the text, in two bytes each
    assert any(result.schedule.digest.encode(code) in data for code in ("ascii", "utf-16-be"))


def test_an_explanation_speaks_of_the_stored_schedule(
    stored: tuple[Path, Result, str], capfd: pytest.CaptureFixture[str]
) -> None:
    folder, result, language = stored
    explain = ["explain", str(folder / "plan.json"), "--point", str(POINT), "--time-limit", "2"]
    capfd.readouterr()
    assert run([*explain, "--json"]) == 0
    assert of_explanation(folder, result, capfd.readouterr().out) == expected(result)
    late = next(a for a in result.schedule if a.start % 1)
    assert run([*explain, "--task", late.task, "--lang", language]) == 0
    told = capfd.readouterr().out
    assert f"lan {result.schedule.digest}" in told
    assert f"{late.start:g}".replace(".", {"en": ".", "de": ","}[language]) in told


def test_two_stored_plans_are_compared_as_they_are(
    stored: tuple[Path, Result, str], capfd: pytest.CaptureFixture[str]
) -> None:
    folder, result, _ = stored
    plan = str(folder / "plan.json")
    capfd.readouterr()
    assert run(["compare", plan, plan, "--point", str(POINT), "--json"]) == 0
    document = json.loads(capfd.readouterr().out)
    assert document["before"]["digest"] == document["after"]["digest"] == result.schedule.digest
    told = {
        r["task"]: (r["after"]["start"], r["after"]["end"], frozenset(r["after"]["operators"]))
        for r in document["tasks"]
    }
    assert told == expected(result)


def test_a_front_of_one_needs_no_point_to_be_named(tmp_path: Path) -> None:
    cell = tandem.load(EXAMPLES / "thesis.yaml")
    front = tandem.plan(cell, workers=1)
    one: Front = replace(front, results=(put_off(front[0]),))
    write(one, tmp_path / "plan.json")
    assert run(["report", str(tmp_path / "plan.json"), "-o", str(tmp_path / "one.md")]) == 0
    text = (tmp_path / "one.md").read_text()
    assert text.count(one[0].schedule.digest) == 2 + len(cell.operators)
    assert one[0].status is Status.OPTIMAL
