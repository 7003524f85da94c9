"""The report in a real browser: it opens without a network, a click shows a plan, paper shows
everything.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from tests.draw.cells import (
    desk,
    eighteen,
    front_by_rule,
    gearbox_front,
    layered_front,
    thesis,
    thesis_front,
)

from tandem.draw.style import looks
from tandem.plan.methods import plan
from tandem.plan.result import Front
from tandem.report.html import write_html

pytestmark = pytest.mark.browser

FRONTS: dict[str, Callable[[], Front]] = {
    "thesis": thesis_front,
    "gearbox": gearbox_front,
    "desk": lambda: front_by_rule(desk(), [0, 1, 3], proven=False, slack=0.1),
    "120 tasks": layered_front,
}
PAPER = (1032, 710)
"""A4 landscape within its margins, in CSS pixels."""


@pytest.fixture
def opened(browser: Any, tmp_path: Path) -> Iterator[Callable[..., Any]]:
    """Opens the report of a front; at the end nothing may have failed and nothing may have been
    fetched from outside the file.
    """
    requests: list[str] = []
    errors: list[str] = []
    context = browser.new_context(offline=True)

    def load(front: Front, *, width: int = 1400, scripts: bool = True, language: str = "en") -> Any:
        nonlocal context
        if not scripts:
            context = browser.new_context(java_script_enabled=False)
        page = context.new_page()
        page.set_viewport_size({"width": width, "height": 900})
        page.on("request", lambda request: requests.append(request.url))
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.on("console", lambda message: errors.append(message.text))
        page.goto(
            write_html(
                front, tmp_path / "report.html", command="tandem plan cell.yaml", language=language
            ).as_uri()
        )
        return page

    yield load
    context.close()
    assert errors == []
    assert [url for url in requests if not url.startswith(("file://", "data:"))] == []
    assert requests


def visible_plans(page: Any) -> list[str]:
    return [plan.get_attribute("id") for plan in page.locator(".plan").all() if plan.is_visible()]


def test_the_recommended_plan_is_open_at_first_and_a_click_opens_another(
    opened: Callable[..., Any],
) -> None:
    page = opened(thesis_front())
    assert visible_plans(page) == ["plan-2"]
    page.locator("svg a.point .target").nth(2).click()
    page.locator("#plan-3").wait_for(state="visible")
    assert visible_plans(page) == ["plan-3"]
    assert page.locator("svg a.point[aria-current]").get_attribute("data-plan") == "3"
    page.locator("tr[data-plan='1'] td").first.click()
    page.locator("#plan-1").wait_for(state="visible")
    assert visible_plans(page) == ["plan-1"]
    page.go_back()
    page.locator("#plan-3").wait_for(state="visible")
    page.get_by_role("button", name="Show all plans").click()
    assert visible_plans(page) == ["plan-1", "plan-2", "plan-3"]


def test_the_keyboard_reaches_every_point(opened: Callable[..., Any]) -> None:
    page = opened(thesis_front())
    page.locator("svg a.point").first.focus()
    page.keyboard.press("Enter")
    page.locator("#plan-1").wait_for(state="visible")
    assert visible_plans(page) == ["plan-1"]


def test_without_scripts_every_plan_is_shown(opened: Callable[..., Any]) -> None:
    page = opened(thesis_front(), scripts=False)
    assert visible_plans(page) == ["plan-1", "plan-2", "plan-3"]
    assert not page.locator("#all").is_visible()


@pytest.mark.parametrize("width", [1400, 800, 390])
@pytest.mark.parametrize("name", FRONTS)
def test_the_page_is_never_wider_than_the_window(
    opened: Callable[..., Any], name: str, width: int
) -> None:
    page = opened(FRONTS[name](), width=width)
    assert page.evaluate("document.documentElement.scrollWidth") <= width


@pytest.mark.parametrize("name", FRONTS)
def test_text_is_at_least_16_pixels_and_no_label_leaves_its_bar(
    opened: Callable[..., Any], name: str
) -> None:
    page = opened(FRONTS[name]())
    sizes = page.evaluate(
        """[...document.querySelectorAll("p, td, th, li, dd, text, button, a")]
             .filter(e => e.textContent.trim() && e.getClientRects().length)
             .map(e => parseFloat(getComputedStyle(e).fontSize) * (e.ownerSVGElement
               ? Math.hypot(e.getScreenCTM().a, e.getScreenCTM().b) : 1))"""
    )
    assert min(sizes) >= 15.99
    outside = page.evaluate(
        """[...document.querySelectorAll(".gantt g.task")]
             .filter(e => e.getClientRects().length).flatMap(g => {
             const bar = g.querySelector("rect").getBoundingClientRect();
             return [...g.querySelectorAll("text")].filter(t => {
               const box = t.getBoundingClientRect();
               return box.left < bar.left - 1 || box.right > bar.right + 1;
             }).map(t => t.textContent);
           })"""
    )
    assert outside == []


def test_the_page_looks_like_something(opened: Callable[..., Any], tmp_path: Path) -> None:
    """The picture has the operators' colours in it and changes when another plan is chosen."""
    from PIL import Image

    page = opened(thesis_front())
    first = page.screenshot(path=tmp_path / "a.png", full_page=True)
    image = Image.open(tmp_path / "a.png").convert("RGB")
    colours = {
        "#{:02X}{:02X}{:02X}".format(*colour)
        for count, colour in image.getcolors(2**24)
        if count > 1500
    }
    assert {look.tint for look in looks(thesis()).values()} <= colours
    page.locator("svg a.point .target").first.click()
    page.locator("#plan-1").wait_for(state="visible")
    assert page.screenshot(full_page=True) != first


@pytest.mark.parametrize("name", FRONTS)
def test_on_paper_no_chart_and_no_table_is_cut(opened: Callable[..., Any], name: str) -> None:
    page = opened(FRONTS[name](), width=PAPER[0])
    page.emulate_media(media="print")
    boxes = page.evaluate(
        """[...document.querySelectorAll("svg, table")]
             .filter(e => e.getClientRects().length && !e.closest(".tiled > .chart")).map(e => {
             const box = e.getBoundingClientRect();
             return [e.tagName, e.getAttribute("class"), box.left, box.right, box.height];
           })"""
    )
    assert len(boxes) > 5
    assert [box for box in boxes if box[3] > PAPER[0] + 1 or box[2] < -1] == []
    assert [box for box in boxes if box[0] == "svg" and box[4] > PAPER[1]] == []


def printed(page: Any, file: Path) -> list[str]:
    """The text of each page of paper."""
    if not shutil.which("pdftotext"):
        pytest.skip("no pdftotext: apt-get install poppler-utils")
    page.pdf(path=file, prefer_css_page_size=True, print_background=True)
    told = subprocess.run(
        ["pdftotext", "-layout", file, "-"], check=True, capture_output=True, text=True
    )
    return told.stdout.split("\f")[:-1]


@pytest.mark.parametrize("name", ["thesis", "gearbox", "desk"])
def test_the_printed_pages_are_a4_landscape_and_nothing_leaves_them(
    opened: Callable[..., Any], tmp_path: Path, name: str
) -> None:
    front = FRONTS[name]()
    page = opened(front)
    page.locator("#print-more").check()
    printed(page, tmp_path / "report.pdf")
    subprocess.run(
        ["pdftotext", "-bbox", tmp_path / "report.pdf", tmp_path / "words.html"], check=True
    )
    found = (tmp_path / "words.html").read_text()
    assert {
        (round(float(w)), round(float(h)))
        for w, h in re.findall(r'<page width="([\d.]+)" height="([\d.]+)"', found)
    } == {(842, 595)}
    edges = [
        tuple(map(float, edge))
        for edge in re.findall(
            r'<word xMin="([-\d.]+)" yMin="([-\d.]+)" xMax="([-\d.]+)" yMax="([-\d.]+)"', found
        )
    ]
    assert min(edge[0] for edge in edges) > 25
    assert max(edge[2] for edge in edges) < 842 - 20
    assert max(edge[3] for edge in edges) < 595 - 20
    text = " ".join(re.findall(r">([^<]+)</word>", found))
    for task in front.cell.tasks:
        assert task in text


@pytest.mark.parametrize("scripts", [True, False])
def test_paper_has_one_plan_and_more_where_a_box_is_ticked(
    opened: Callable[..., Any], tmp_path: Path, scripts: bool
) -> None:
    page = opened(thesis_front(), scripts=scripts)

    def on_paper() -> tuple[list[str], list[str], bool]:
        pages = printed(page, tmp_path / "report.pdf")
        plans = [place for place in "123" if any(f"Plan {place}: " in p[:200] for p in pages)]
        sheets = [
            line for p in pages for line in re.findall(r"Plan (\d): .* · plan [0-9a-f]{12}", p)
        ]
        return plans, sheets, any("What must come before what" in p for p in pages)

    assert on_paper() == (["2"], ["2", "2"], False)
    page.locator("#print-more").check()
    assert on_paper() == (["2"], ["2", "2"], True)
    page.locator("#print-plans").check()
    assert on_paper() == (["1", "2", "3"], ["2", "2"], True)


def test_the_plan_that_is_open_is_the_one_that_is_printed(
    opened: Callable[..., Any], tmp_path: Path
) -> None:
    page = opened(thesis_front())
    page.locator("svg a.point .target").nth(2).click()
    page.locator("#plan-3").wait_for(state="visible")
    text = "".join(printed(page, tmp_path / "report.pdf"))
    assert f"Plan 3: 34 s, stress 2 · plan {thesis_front()[2].schedule.digest}" in text
    assert "Plan 2: " not in text
    page.get_by_role("button", name="Show all plans").click()
    assert page.locator("#print-plans").is_checked()


@cache
def eighteen_planned() -> Front:
    return plan(eighteen(), workers=1, time_limit=120)


@pytest.mark.parametrize("language", ["en", "de"])
def test_a_cell_of_eighteen_tasks_is_printed_on_six_pages(
    opened: Callable[..., Any], tmp_path: Path, language: str
) -> None:
    """A page for the trade-off, one for the plan, one for each of three operators, one for what was
    assumed.
    """
    pages = printed(opened(eighteen_planned(), language=language), tmp_path / "report.pdf")
    heads = {
        "en": ("Plan: ", "Plan 10: ", *["Instructions for "] * 3, "What was assumed"),
        "de": ("Plan: ", "Plan 10: ", *["Anweisung für "] * 3, "Was angenommen wurde"),
    }[language]
    assert [page.lstrip()[: len(head)] for page, head in zip(pages, heads, strict=True)] == list(
        heads
    )


def test_instruction_sheets_are_folded_on_the_screen_and_a_page_each_on_paper(
    opened: Callable[..., Any], tmp_path: Path
) -> None:
    page = opened(thesis_front())
    shown = page.locator(".sheet table")
    assert [table.is_visible() for table in shown.all()] == [False] * 6
    page.get_by_text("Instructions for human").locator("visible=true").click()
    assert [table.is_visible() for table in shown.all()].count(True) == 1
    pages = printed(page, tmp_path / "report.pdf")
    sheets = [sheet for sheet in pages if "Instructions for" in sheet]
    assert [("human" in sheet.splitlines()[0], "Plan 2: 24 s" in sheet,
    "begin when" in sheet) for sheet in sheets] == [
        (False, True, True), (True, True, True),
    ]  # fmt: skip


def test_without_scripts_the_instruction_sheets_stand_open(opened: Callable[..., Any]) -> None:
    page = opened(thesis_front(), scripts=False)
    assert all(table.is_visible() for table in page.locator(".sheet table").all())
