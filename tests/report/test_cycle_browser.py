"""The page of a station that repeats in a real browser, on the screen and on paper."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.draw.cycles import FRONTS, bench_front, thesis_cycles

from tandem.plan.cycle.result import CycleFront
from tandem.report.cycle.files import write

pytestmark = pytest.mark.browser

PAPER = (1032, 710)
"""A4 landscape within its margins, in CSS pixels."""


@pytest.fixture
def opened(browser: Any, tmp_path: Path) -> Iterator[Callable[..., Any]]:
    """Opens the page of a front; at the end nothing may have failed and nothing may have been
    fetched from outside the file.
    """
    requests: list[str] = []
    errors: list[str] = []
    context = browser.new_context(offline=True)

    def load(front: CycleFront, *, width: int = 1400, language: str = "en") -> Any:
        page = context.new_page()
        page.set_viewport_size({"width": width, "height": 900})
        page.on("request", lambda request: requests.append(request.url))
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.on("console", lambda message: errors.append(message.text))
        page.goto(write(front, tmp_path / "cycle.html", language=language).as_uri())
        return page

    yield load
    context.close()
    assert errors == []
    assert [url for url in requests if not url.startswith(("file://", "data:"))] == []


def test_the_recommended_point_is_open_and_a_click_opens_another(
    opened: Callable[..., Any],
) -> None:
    page = opened(thesis_cycles())
    seen = [
        point.get_attribute("id") for point in page.locator(".plan").all() if point.is_visible()
    ]
    assert seen == ["plan-3"]
    page.locator("svg a.point .target").first.click()
    page.locator("#plan-1").wait_for(state="visible")
    assert not page.locator("#plan-3").is_visible()


@pytest.mark.parametrize("language", ["en", "de"])
@pytest.mark.parametrize("width", [1400, 800, 390])
@pytest.mark.parametrize("name", FRONTS)
def test_the_page_is_never_wider_than_the_window(
    opened: Callable[..., Any], name: str, width: int, language: str
) -> None:
    page = opened(FRONTS[name](), width=width, language=language)
    assert page.evaluate("document.documentElement.scrollWidth") <= width


@pytest.mark.parametrize("language", ["en", "de"])
@pytest.mark.parametrize("name", FRONTS)
def test_text_is_large_enough_and_no_label_leaves_its_bar_or_block(
    opened: Callable[..., Any], name: str, language: str
) -> None:
    page = opened(FRONTS[name](), language=language)
    sizes = page.evaluate(
        """[...document.querySelectorAll("p, td, th, li, dd, text, button, a")]
             .filter(e => e.textContent.trim() && e.getClientRects().length)
             .map(e => parseFloat(getComputedStyle(e).fontSize) * (e.ownerSVGElement
               ? Math.hypot(e.getScreenCTM().a, e.getScreenCTM().b) : 1))"""
    )
    assert min(sizes) >= 15.99
    outside = page.evaluate(
        """[...document.querySelectorAll("svg g.task")]
             .filter(e => e.getClientRects().length).flatMap(g => {
             const bar = g.querySelector("rect").getBoundingClientRect();
             return [...g.querySelectorAll("text")].filter(t => {
               const box = t.getBoundingClientRect();
               return box.left < bar.left - 1 || box.right > bar.right + 1
                 || box.top < bar.top - 3 || box.bottom > bar.bottom + 3;
             }).map(t => t.textContent);
           })"""
    )
    assert outside == []
    clash = page.evaluate(
        """[...document.querySelectorAll("svg.gantt, svg.yamazumi")]
             .filter(e => e.getClientRects().length).flatMap(svg => {
             const boxes = [...svg.querySelectorAll("text")].map(t =>
               [t.textContent, t.getBoundingClientRect()]);
             return boxes.flatMap(([a, one], i) => boxes.slice(i + 1)
               .filter(([b, other]) =>
                 Math.min(one.right, other.right) - Math.max(one.left, other.left) > 2
                 && Math.min(one.bottom, other.bottom) - Math.max(one.top, other.top) > 4)
               .map(([b]) => [a, b]));
           })"""
    )
    assert clash == []


def test_products_have_shades_and_the_takt_a_line(opened: Callable[..., Any]) -> None:
    page = opened(bench_front())
    fills = page.evaluate(
        """[...new Set([...document.querySelectorAll(".gantt g.task rect:first-of-type")]
             .map(e => e.getAttribute("fill")))]"""
    )
    assert {fill.rpartition("-")[2] for fill in fills} == {"0)", "1)", "2)"}
    defined = page.evaluate("[...document.querySelectorAll('pattern')].map(p => `url(#${p.id})`)")
    assert set(fills) <= set(defined)
    assert page.locator("svg.yamazumi line.takt").count() == 1
    assert page.locator("svg.gantt line.boundary").count() == 2


@pytest.mark.parametrize("language", ["en", "de"])
@pytest.mark.parametrize("name", FRONTS)
def test_on_paper_nothing_is_cut_and_each_human_has_a_sheet(
    opened: Callable[..., Any], tmp_path: Path, name: str, language: str
) -> None:
    if not shutil.which("pdftotext"):
        pytest.skip("no pdftotext: apt-get install poppler-utils")
    front = FRONTS[name]()
    page = opened(front, width=PAPER[0], language=language)
    page.emulate_media(media="print")
    boxes = page.evaluate(
        """[...document.querySelectorAll("svg, table")]
             .filter(e => e.getClientRects().length).map(e => {
             const box = e.getBoundingClientRect();
             return [e.tagName, e.getAttribute("class"), box.left, box.right, box.height];
           })"""
    )
    assert len(boxes) > 5
    assert [box for box in boxes if box[3] > PAPER[0] + 1 or box[2] < -1] == []
    assert [box for box in boxes if box[0] == "svg" and box[4] > PAPER[1]] == []
    page.pdf(path=tmp_path / "cycle.pdf", prefer_css_page_size=True, print_background=True)
    told = subprocess.run(
        ["pdftotext", "-layout", tmp_path / "cycle.pdf", "-"],
        check=True,
        capture_output=True,
        text=True,
    )
    pages = told.stdout.split("\f")[:-1]
    word = {"en": "cycle", "de": "Zyklus"}[language]
    named = f" · {word} {front.knee.periodic.digest}"
    sheets = [text for text in pages if named in " ".join(text.split())]
    assert len(sheets) == len(front.cell.humans)
    assert len(pages) <= 3 + 2 * len(front.cell.humans)
