"""The page that compares the published systems, as a real browser shows and prints it: no table is
cut at its right edge.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("jax", reason="needs tandem[learn]")

from tandem.lab import comparison
from tandem.lab.probes import PROBES, Entry
from tandem.lab.systems import SYSTEMS

pytestmark = pytest.mark.browser

PAPER = 1032
"""CSS pixels between the margins of A4 across."""

LETTER = 965
"""The same of the shorter Letter paper."""


@pytest.fixture(scope="module")
def page_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The stored tables of all systems, with long words in the tables of features."""
    entry = Entry(
        "yes: as it was found",
        "two tasks cost 46 side by side, 59 one after the other; a joint task is refused (the world"
        " knows no such thing)",
    )
    shown = []
    for name, system in SYSTEMS.items():
        if system.published:
            experiment = system.load()
            document = experiment.stored()
            cells = dict.fromkeys(comparison.cells_to_try(), entry)
            shown.append(
                comparison.Shown(
                    name,
                    system.title,
                    document,
                    "",
                    experiment.table(document),
                    (),
                    dict.fromkeys(PROBES, entry),
                    cells,
                )
            )
    file = tmp_path_factory.mktemp("page") / "comparison.html"
    file.write_text(comparison.html(shown, command="tandem reproduce --all --stored"))
    return file


WIDE = """[...document.querySelectorAll('.wide')].map(part => ({
    label: part.getAttribute('aria-label'),
    hidden: part.scrollWidth - part.clientWidth,
    scrolls: getComputedStyle(part).overflowX === 'auto'}))"""


@pytest.fixture
def shown(browser: Any, page_file: Path) -> Iterator[Any]:
    page = browser.new_page()
    page.goto(page_file.as_uri())
    yield page
    page.close()


@pytest.mark.parametrize("width", [1920, 1440, 1280])
def test_every_table_is_whole_on_a_usual_screen(shown: Any, width: int) -> None:
    shown.set_viewport_size({"width": width, "height": 900})
    assert [part for part in shown.evaluate(WIDE) if part["hidden"] > 0] == []
    assert shown.evaluate("document.documentElement.scrollWidth") <= width


@pytest.mark.parametrize("width", [1024, 600, 360])
def test_what_is_wider_than_the_screen_scrolls_by_itself(shown: Any, width: int) -> None:
    shown.set_viewport_size({"width": width, "height": 900})
    wide = shown.evaluate(WIDE)
    assert any(part["hidden"] > 0 for part in wide)
    assert all(part["scrolls"] for part in wide)
    assert shown.evaluate("document.documentElement.scrollWidth") <= width, (
        "the page itself does not scroll sideways"
    )


@pytest.mark.parametrize("width", [PAPER, LETTER])
def test_every_table_is_whole_on_paper_where_nothing_scrolls(shown: Any, width: int) -> None:
    shown.emulate_media(media="print")
    shown.set_viewport_size({"width": width, "height": 700})
    assert [part for part in shown.evaluate(WIDE) if part["hidden"] > 0] == []
    edges = shown.evaluate(
        "[...document.querySelectorAll('th, td')].map(cell => cell.getBoundingClientRect().right)"
    )
    assert max(edges) <= width
