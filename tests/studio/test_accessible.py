"""No view of the studio, and no page of a report, has a serious fault by axe-core: light and dark,
in English and in German.
"""

from __future__ import annotations

import hashlib
import json
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tandem.report.html import write_html
from tests.draw.cells import gearbox_front, thesis_front
from tests.studio.running import Running

pytestmark = pytest.mark.browser

AXE = Path(__file__).parent / "axe"
"""axe-core as it was published. It is part of no wheel: only these tests load it."""
THESIS = Path(__file__).parents[2] / "examples/thesis.yaml"
PATIENCE_MS = 60_000
WORDS = {
    language: json.loads(
        (THESIS.parents[1] / f"src/tandem/studio/static/words_{language}.json").read_text()
    )
    for language in ("en", "de")
}
LOOKS = [(language, scheme) for language in WORDS for scheme in ("light", "dark")]


def test_axe_core_is_what_was_published() -> None:
    (told,) = json.loads((AXE / "vendored.json").read_text())
    content = (AXE / told["file"]).read_bytes()
    assert hashlib.sha256(content).hexdigest() == told["sha256"]
    assert f"axe v{told['version']}" in content[:200].decode()
    for licence in told["licence_files"]:
        assert (AXE / licence).stat().st_size > 1000


def serious(page: Any) -> list[str]:
    """What axe-core finds in the page as it stands, one line a place."""
    page.evaluate((AXE / "axe.min.js").read_text())
    found = page.evaluate("() => axe.run(document).then(told => told.violations)")
    return [
        f"{rule['id']} ({rule['impact']}): {place['html'][:160]} | {place['failureSummary'][:300]}"
        for rule in found
        if rule["impact"] in ("serious", "critical")
        for place in rule["nodes"]
    ]


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    folder = tmp_path_factory.mktemp("cells")
    shutil.copy(THESIS, folder / "cell.yaml")
    shutil.copy(THESIS, folder / "another.yaml")
    with Running(folder / "cell.yaml") as running:
        yield running


def load(browser: Any, server: Running, language: str, scheme: str) -> Any:
    """A page in a context of its own, which shows the cell."""
    context = browser.new_context(
        viewport={"width": 1280, "height": 900},
        locale={"en": "en-US", "de": "de-DE"}[language],
        color_scheme=scheme,
    )
    context.set_default_timeout(PATIENCE_MS)
    page = context.new_page()
    page.goto(server.line)
    page.get_by_role("grid").wait_for()
    return page


@pytest.fixture
def opened(browser: Any, server: Running) -> Iterator[Callable[[str, str], Any]]:
    pages = []

    def kept(language: str, scheme: str) -> Any:
        pages.append(load(browser, server, language, scheme))
        return pages[-1]

    yield kept
    for page in pages:
        page.context.close()


def button(page: Any, words: dict[str, str], key: str) -> Any:
    return page.get_by_role("button", name=words[key], exact=True)


@pytest.mark.parametrize(("language", "scheme"), LOOKS)
def test_no_view_of_the_studio_has_a_serious_fault(
    opened: Callable[[str, str], Any], language: str, scheme: str
) -> None:
    """One page through its views, so that each is judged as a planner comes to it."""
    page, words = opened(language, scheme), WORDS[language]
    told: dict[str, list[str]] = {"open": serious(page)}

    cell = page.locator("td[data-row='2'][data-column='2']")
    cell.click()
    page.keyboard.type("ten")
    page.locator("td [class=message], td .message").first.wait_for()
    told["a wrong value"] = serious(page)
    page.keyboard.press("Escape")

    button(page, words, "button.plan").click()
    page.locator("[role=option][aria-selected=true]").wait_for()
    button(page, words, "button.plan").wait_for()
    page.get_by_role("option").first.click()
    bar = page.locator("button.bar[data-task='6']")
    bar.click()
    told["a plan, one bar chosen"] = serious(page)

    page.locator(".explain button").first.click()
    page.locator(".explain table, .explain li").first.wait_for()
    told["why a task is where it is"] = serious(page)

    bar.press("ArrowUp")
    page.locator(".readout", has_text="→").wait_for()
    told["a bar on its way"] = serious(page)
    bar.press("Enter")
    button(page, words, "button.resolve").click()
    button(page, words, "button.keep").wait_for()
    told["a proposal"] = serious(page)
    button(page, words, "button.discard").click()

    page.evaluate("() => document.querySelectorAll('details').forEach(one => one.open = true)")
    page.get_by_label(words["scenarios.name"]).fill("half")
    button(page, words, "scenarios.copy").click()
    page.locator("table.compared").first.wait_for()
    told["panels and a scenario"] = serious(page)

    page.get_by_label(words["options.max_makespan"]).fill("20")
    page.keyboard.press("Tab")
    button(page, words, "button.plan").click()
    page.locator(".side .faults").wait_for()
    told["no plan"] = serious(page)
    assert {view: faults for view, faults in told.items() if faults} == {}


def test_no_view_that_is_seldom_seen_has_a_serious_fault(browser: Any, tmp_path: Path) -> None:
    """An empty folder, a workbook on its way in, a file that somebody else has written meanwhile,
    and what was not saved when the server stopped.
    """
    folder, book = tmp_path / "cells", tmp_path / "line 3.csv"
    folder.mkdir()
    book.write_text("Step;Robot [s];Human [s];EAWS;needs\npress;9;10;10;\nhold;;8;11;press\n")
    cell, told = folder / "cell.yaml", {}
    looks = [("en", "light"), ("de", "dark")]

    def seen(page: Any, language: str, view: str) -> None:
        told[language, view] = serious(page)

    with Running(folder) as running:
        for language, scheme in looks:
            cell.unlink(missing_ok=True)
            page, words = load(browser, running, language, scheme), WORDS[language]
            page.get_by_text(words["table.empty"]).wait_for()
            seen(page, language, "an empty folder")
            page.get_by_label(words["import.button"]).set_input_files(book)
            page.locator(".preview table").wait_for()
            seen(page, language, "a workbook")
            page.locator(".preview button.first").click()
            button(page, words, "button.save").click()
            page.locator("header h1", has_text=words["file.unsaved"]).wait_for(state="detached")
            cell.write_text(cell.read_text() + "# by another hand\n")
            page.locator("td[data-row='0'][data-column='1']").click()
            page.keyboard.type("12")
            page.keyboard.press("Enter")
            button(page, words, "button.save").click()
            page.locator(".newer").wait_for()
            seen(page, language, "a newer file")
            with page.expect_response(lambda answer: answer.url.endswith("/api/draft")):
                button(page, words, "button.add_task").click()
            page.context.close()
        assert running.end()[0] == 0
    with Running(folder) as running:
        for language, scheme in looks:
            page = load(browser, running, language, scheme)
            page.locator(".newer").wait_for()
            seen(page, language, "what was not saved")
            page.context.close()
    assert len(told) == 4 * len(looks)
    assert {view: faults for view, faults in told.items() if faults} == {}


@pytest.mark.parametrize(("language", "scheme"), LOOKS)
def test_no_report_has_a_serious_fault(
    browser: Any, tmp_path: Path, language: str, scheme: str
) -> None:
    told = {}
    context = browser.new_context(color_scheme=scheme, offline=True)
    for name, front in (("thesis", thesis_front()), ("gearbox", gearbox_front())):
        page = context.new_page()
        page.goto(write_html(front, tmp_path / f"{name}.html", language=language).as_uri())
        told[name] = serious(page)
    context.close()
    assert {page: faults for page, faults in told.items() if faults} == {}
