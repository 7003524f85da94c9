"""A new user with a workbook that nobody here has seen: from the first look at the page to a proven
front in at most five clicks.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from openpyxl import Workbook

from tests.studio.running import Running

pytestmark = pytest.mark.browser

PATIENCE_MS = 120_000
COUNTED = """() => { addEventListener("click", event => {
    // a label passes its click on to its field; the person has clicked once
    if (event.isTrusted && event.detail > 0) window.clicks = (window.clicks ?? 0) + 1;
}, true); }"""
STATION = [
    ["Station 12, pump housing"],
    [],
    ["Work step", "What", "Person [s]", "Cobot [s]", "Strain", "Comes after"],
    ["A", "place housing", 12, 15, 2, None],
    ["B", "insert seal", 8, None, 3, "A"],
    ["C", "drive screws", 20, 14, 6, "B"],
    ["D", "mount cover", 9, 11, 2, "A"],
    ["E", "test", 6, 6, 1, "C, D"],
]


def test_an_unknown_workbook_is_a_proven_front_after_five_clicks_at_most(
    browser: Any, tmp_path: Path
) -> None:
    book = Workbook()
    for row in STATION:
        book.active.append(row)
    path = tmp_path / "station 12.xlsx"
    book.save(path)
    (tmp_path / "cells").mkdir()
    context = browser.new_context(viewport={"width": 1280, "height": 900}, locale="en-US")
    context.set_default_timeout(PATIENCE_MS)
    with Running(tmp_path / "cells") as server:
        page = context.new_page()
        page.goto(server.line)
        page.get_by_role("grid").wait_for()
        page.evaluate(COUNTED)
        with page.expect_file_chooser() as chooser:
            page.get_by_text("Import workbook", exact=True).click()
        chooser.value.set_files(path)
        # a heading that Tandem does not know is given its meaning by hand
        meaning = page.get_by_label("Meaning of column Comes after")
        meaning.click()
        page.keyboard.type("after")
        page.keyboard.press("Enter")
        page.get_by_text("'Comes after' was not read").wait_for(state="detached")
        page.get_by_role("button", name="Take these tasks: 5").click()
        page.get_by_role("button", name="Plan", exact=True).click()
        page.get_by_role("status").filter(has_text="proven").wait_for()
        first = page.locator("[role=option] .numbers").first.inner_text()
        clicks = page.evaluate("clicks")
    context.close()
    # the chain A, B, C, E at its quickest: 12 + 8 + 14 + 6 seconds
    assert first.startswith("40 s, stress ")
    assert clicks <= 5
