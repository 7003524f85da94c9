"""Walking, and tools by operator, are shown where a reader looks: in charts, sheets, the balance,
the table of tasks and the assumptions; in both languages.
"""

from __future__ import annotations

import io
import re

import openpyxl
import pytest
from rich.console import Console
from tests.report.paper import sheets_of

from tandem.draw.lanes import lanes
from tandem.files.load import load
from tandem.plan.methods import plan
from tandem.plan.result import Front
from tandem.report.html import html
from tandem.report.markdown import markdown
from tandem.report.terminal import GanttText
from tandem.report.xlsx import xlsx

PUMP = load("examples/pump.yaml")


@pytest.fixture(scope="module")
def front() -> Front:
    return plan(PUMP, minimize="makespan", workers=1)


def test_lanes_tell_ways_and_changeovers_apart(front: Front) -> None:
    anna, cobot = lanes(PUMP, front[0].schedule, until=200)
    assert {off.kind for off in anna.shaded} == {"walk"}
    assert [off.what for off in anna.shaded] == ["press", "fixture", "bench", "fixture", "bench"]
    assert [(off.kind, off.what) for off in cobot.shaded] == [("changeover", "spindle")]
    assert {off.end - off.start for off in anna.shaded} == {3, 4, 5}


def test_the_terminal_has_a_sign_for_it(front: Front) -> None:
    console = Console(file=io.StringIO(), width=100)
    console.print(GanttText(PUMP, front[0].schedule))
    said = console.file.getvalue()  # type: ignore[attr-defined]
    assert "› walking" in said
    assert "››" in said


@pytest.mark.parametrize(
    ("language", "words"),
    [
        (
            "en",
            [
                "Walks to press, ", "Grey and lined: walking.", "set-up, walking, changeovers [s]",
                "Anna at 1 m/s", "Cobot on its rail fixture to bench 2 s", "place bench",
                "tool screwdriver for Anna", "tool spindle for Cobot on its rail",
                "tool gripper for Cobot on its rail with Anna",
            ],
        ),
        (
            "de",
            [
                "Geht zu press, ", "Grau und liniert: Weg.", "Rüsten, Wege, Wechsel [s]",
                "Anna mit 1 m/s", "Cobot on its rail fixture bis bench 2 s", "Ort bench",
                "Werkzeug screwdriver für Anna", "Werkzeug gripper für Cobot on its rail mit Anna",
            ],
        ),
    ],
)  # fmt: skip
def test_the_page_says_it(front: Front, language: str, words: list[str]) -> None:
    text = re.sub(r"<[^>]+>", "", html(front, language=language))
    assert [word for word in words if word not in text] == []


@pytest.mark.parametrize("language", ["en", "de"])
def test_the_sheet_says_where_to_go_and_what_to_take(front: Front, language: str) -> None:
    anna = sheets_of(html(front, language=language), language)["Anna"]
    steps = [row.change or row.task for row in anna.rows]
    assert steps == [
        "seal", ("bench -> press", 5), "bearings", ("press -> fixture", 4), "gears", "cover",
        ("fixture -> bench", 3), "fittings", ("bench -> fixture", 3), "connect",
        ("fixture -> bench", 3), "label",
    ]  # fmt: skip
    cover = next(row for row in anna.rows if row.task == "cover")
    said = " ".join(cover.cells["means"])
    assert "mallet" in said
    assert "gripper" not in said
    assert "fixture" in said


def test_markdown_and_workbook_say_it_too(front: Front) -> None:
    assert "go from bench to press: 5 s" in markdown(front)
    book = openpyxl.load_workbook(io.BytesIO(xlsx(front)))
    texts = {str(cell.value) for sheet in book for row in sheet.iter_rows() for cell in row}
    assert "go from bench to press: 5 s" in texts
    assert "set-up, walking, changeovers [s]" in texts
