"""A set-up is shown where a reader looks: in charts, sheets, the balance and the assumptions; in
both languages.
"""

from __future__ import annotations

import io

import openpyxl
import pytest
from tests.report.paper import sheets_of

from tandem.cell.model import Cell
from tandem.draw.lanes import lanes
from tandem.files.validate import cell_of
from tandem.plan.methods import plan
from tandem.plan.result import Front
from tandem.report.html import html
from tandem.report.xlsx import xlsx


def bench() -> Cell:
    """Anna gets ready from 5 to 9 s, behind her break; Ben would too, and has nothing to do."""
    return cell_of({
        "operators": {
            "anna": {"kind": "human", "setup": 4, "breaks": [[3, 5]]},
            "ben": {"kind": "human", "setup": 50},
        },
        "tasks": {"base": {"time": {"anna": 3, "ben": 3}}, "cover": {"time": {"anna": 2},
        "after": ["base"]}},
    })  # fmt: skip


@pytest.fixture(scope="module")
def front() -> Front:
    return plan(bench(), workers=1)


def test_the_lane_of_who_works_shows_it_and_that_of_who_does_nothing_does_not(front: Front) -> None:
    anna, ben = lanes(bench(), front[0].schedule, until=20)
    assert [(off.kind, off.start, off.end) for off in anna.shaded] == [
        ("break", 3, 5),
        ("setup", 5, 9),
    ]
    assert ben.shaded == ()


@pytest.mark.parametrize(
    ("language", "words"),
    [
        (
            "en",
            ["Sets up, 5 to 9 s", "Grey and dotted at the start: set-up.", "anna 4 s, ben 50 s"],
        ),
        (
            "de",
            ["Rüstet, 5 bis 9 s", "Grau und gepunktet am Anfang: Rüsten.", "anna 4 s, ben 50 s"],
        ),
    ],
)
def test_the_page_says_it_in_chart_legend_and_assumptions(
    front: Front, language: str, words: list[str]
) -> None:
    page = html(front, language=language)
    assert [word for word in words if word not in page] == []


@pytest.mark.parametrize("language", ["en", "de"])
def test_the_instruction_sheet_begins_with_it(front: Front, language: str) -> None:
    first, second, third = sheets_of(html(front, language=language), language)["anna"].rows
    assert first.change == ("", 4)
    assert [first.cells[key] for key in ("start", "end")] == [["5"], ["9"]]
    assert first.told("break") == {("3", "5")}
    assert [second.task, third.task] == ["base", "cover"]
    assert second.bold[0][0] == "previous"


def test_the_balance_counts_it_beside_changeovers(front: Front) -> None:
    sheet = openpyxl.load_workbook(io.BytesIO(xlsx(front)))["Plan 1"]
    rows = [[cell.value for cell in row] for row in sheet.iter_rows()]
    (head,) = [row for row in rows if "busy [s]" in row]
    column = head.index("set-up, changeovers [s]")
    assert {row[0]: row[column] for row in rows[rows.index(head) + 1 :]} == {"anna": 4, "ben": 0}
