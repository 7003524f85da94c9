"""What each person has used of a limit stands beside the plan, and what nobody knows among the
assumptions; in both languages.
"""

from __future__ import annotations

import io

import openpyxl
import pytest
from tests import limited

from tandem.plan.methods import METHODS
from tandem.plan.question import Question
from tandem.plan.result import Front
from tandem.report.html import html
from tandem.report.limits import used_of_limits
from tandem.report.markdown import markdown
from tandem.report.xlsx import xlsx


@pytest.fixture(scope="module")
def front() -> Front:
    data = limited.data(dose_lifft=0.25, peak_reba=12)
    del data["tasks"]["close"]["ergonomics"][1]
    return METHODS["exhaustive"](limited.cell_of(data), Question("makespan"))


def test_what_is_used_is_what_the_plan_puts_on_the_person(front: Front) -> None:
    peak, dose = sorted(used_of_limits(front.cell, front[0].schedule), key=lambda one: -one.most)
    assert (peak.who, peak.measure, peak.value, peak.most) == ("anna", "peak:reba", 9, 12)
    assert (dose.measure, dose.value, dose.most) == ("dose:lifft", 0.1, 0.25)


@pytest.mark.parametrize(
    ("language", "words"),
    [
        ("en", ["What is used of people's limits", "A dose is that of a shift with 100 products",
                "count nothing there, since nobody has stated one: close."]),
        ("de", ["Wie weit die Grenzen genutzt sind", "einer Schicht mit 100 Stück",
                "weil niemand einen angegeben hat: close."]),
    ],
)  # fmt: skip
def test_pages_and_workbooks_tell_of_them(front: Front, language: str, words: list[str]) -> None:
    for text in (html(front, language=language), markdown(front, language=language)):
        for said in words:
            assert said in text.replace("&#x27;", "'").replace("&#39;", "'"), said
        assert "dose:lifft" in text
    book = openpyxl.load_workbook(io.BytesIO(xlsx(front, language=language)))
    values = [cell.value for sheet in book for row in sheet for cell in row]
    assert words[0] in values
    assert {"dose:lifft", 0.1, 0.25} <= set(values)
