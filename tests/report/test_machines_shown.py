"""Machines in pictures and on paper: a look of their own, named in both languages, and no sheet."""

from __future__ import annotations

import io

import openpyxl
import pytest
from tests.cell.test_machines import press
from tests.report.paper import sheets_of

from tandem.draw.style import MACHINE_COLOURS, looks
from tandem.files.validate import cell_of
from tandem.plan.methods import plan
from tandem.plan.result import Front
from tandem.report.html import html
from tandem.report.markdown import markdown
from tandem.report.xlsx import xlsx


@pytest.fixture(scope="module")
def front() -> Front:
    return plan(cell_of(press()), workers=1)


def test_a_machine_has_a_grey_and_level_lines(front: Front) -> None:
    look = looks(front.cell)["press"]
    assert (look.colour, look.hatch) == (MACHINE_COLOURS[0], "---")


@pytest.mark.parametrize(
    ("language", "one", "kind"), [("en", "1 machine", "machine"), ("de", "1 Maschine", "Maschine")]
)
def test_the_page_names_it_and_has_no_sheet_for_it(
    front: Front, language: str, one: str, kind: str
) -> None:
    page = html(front, language=language)
    assert one in page
    assert f": {kind}." in page
    assert list(sheets_of(page, language)) == ["anna"]


def test_workbook_and_markdown_have_a_sheet_for_people_only(front: Front) -> None:
    book = openpyxl.load_workbook(io.BytesIO(xlsx(front)))
    assert any("anna" in name for name in book.sheetnames)
    assert not any("press" in name for name in book.sheetnames)
    headings = [line for line in markdown(front).splitlines() if line.startswith("#")]
    assert any("anna" in line for line in headings)
    assert not any("press" in line for line in headings)
