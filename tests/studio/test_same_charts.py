"""The page and the one-file report draw the same chart: what stands in a lane, from when to when,
read off the pixels of both in a browser.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.studio.page import Expect, Studio, button, planned

pytestmark = pytest.mark.browser

CELL = {
    "operators": {
        "anna": {"kind": "human", "place": "bench", "breaks": [[6, 8]]},
        "cobot": {"kind": "robot", "setup": 2, "tool": "gripper"},
    },
    "tasks": {
        "lay": {"time": {"anna": 4}, "place": "bench"},
        "screw": {"time": {"cobot": 5}, "tool": {"cobot": "spindle"}, "after": ["lay"]},
        "check": {
            "time": {"anna": 3},
            "place": "fixture",
            "wait": [{"after": "lay", "at_least": 7}],
        },
        "lift": {
            "together": [{"operators": ["anna", "cobot"], "time": 4}],
            "after": ["screw", "check"],
        },
    },
    "tools": {"spindle": {"changeover": {"cobot": 3}}},
    "walk": {"anna": {"bench-fixture": 2}},
}
# lane, what, start and end in seconds, by the lanes' edges and where the plan ends
OF_THE_PAGE = """() => {
    const end = parseFloat(document.querySelector(".axis .makespan").style.left);
    const seconds = one => [parseFloat(one.style.left), parseFloat(one.style.left) +
        parseFloat(one.style.width)].map(x => x / end);
    const found = [];
    document.querySelectorAll(".lane").forEach((lane, row) => {
        const off = one => one.classList[1] === "setup" ? "changeover" : one.classList[1];
        lane.querySelectorAll(".off").forEach(one => found.push([row, off(one), ...seconds(one)]));
        lane.querySelectorAll(".wait").forEach(one => found.push([row, "wait", ...seconds(one)]));
    });
    const tops = [...document.querySelectorAll(".lane")].map(lane => parseFloat(lane.style.top));
    document.querySelectorAll("button.bar").forEach(one => {
        const row = tops.filter(top => top <= parseFloat(one.style.top)).length - 1;
        found.push([row, "bar", ...seconds(one)]);
    });
    document.querySelectorAll(".lanes > .joint").forEach(one => {
        found.push([0, "joint", parseFloat(one.style.left) / end, 0]);
    });
    return found;
}"""
OF_THE_REPORT = """() => {
    const svg = [...document.querySelectorAll(".plan:not([hidden]) svg.gantt")][0];
    const number = (one, name) => parseFloat(one.getAttribute(name));
    const lanes = [...svg.querySelectorAll("rect.lane")];
    const begin = number(lanes[0], "x");
    const end = number(svg.querySelector("line.end"), "x1") - begin;
    const at = x => (x - begin) / end;
    const rowOf = y => lanes.filter(lane => number(lane, "y") <= y + 5).length - 1;
    const found = [];
    svg.querySelectorAll("rect[fill^='url(#fill-']").forEach(one => {
        const kind = one.getAttribute("fill").slice(10, -1);
        const what = /^[0-9]/.test(kind) ? "bar" : kind;
        const x = number(one, "x");
        found.push([rowOf(number(one, "y")), what, at(x), at(x + number(one, "width"))]);
    });
    svg.querySelectorAll("line.wait").forEach(one => {
        const [x, y] = ["x1", "y1"].map(name => number(one, name));
        found.push([rowOf(y), "wait", at(x), at(number(one, "x2"))]);
    });
    svg.querySelectorAll("line.joint").forEach(one => {
        found.push([0, "joint", at(number(one, "x1")), 0]);
    });
    return found;
}"""


@pytest.fixture
def studio(browser: Any, tmp_path: Path) -> Iterator[Studio]:
    (tmp_path / "cell.json").write_text(json.dumps(CELL))
    opened = Studio(browser, tmp_path / "cell.json")
    yield opened
    opened.close()


def drawn(rows: list[list[Any]], makespan: float) -> list[tuple[int, str, float, float]]:
    """What was read, in seconds."""
    return sorted(
        (row, what, round(start * makespan, 1), round(end * makespan, 1))
        for row, what, start, end in rows
    )


def test_the_page_and_the_report_draw_the_same_chart(studio: Studio, expect: Expect) -> None:
    page = studio.open()
    (name,) = planned(page, expect)
    expect(page.locator(".lane .wait")).to_have_count(1)
    makespan = float(name.split()[0])
    on_the_page = drawn(page.evaluate(OF_THE_PAGE), makespan)
    with page.expect_download() as download:
        button(page, "Report").click()
    report = studio.context.new_page()
    report.goto(download.value.path().rename(studio.path.with_name("report.html")).as_uri())
    assert drawn(report.evaluate(OF_THE_REPORT), makespan) == on_the_page
    kinds = [what for _, what, *_ in on_the_page]
    assert {kind: kinds.count(kind) for kind in sorted(set(kinds))} == {
        "bar": 5,
        "break": 1,
        "changeover": 2,
        "joint": 1,
        "wait": 1,
        "walk": 1,
    }


def test_each_chart_is_had_as_a_picture(studio: Studio, expect: Expect) -> None:
    page = studio.open()
    planned(page, expect)
    for chart, file in (
        ("Gantt chart (SVG)", "gantt.svg"),
        ("Compromises (SVG)", "front.svg"),
        ("Precedence graph (SVG)", "graph.svg"),
    ):
        page.get_by_text("Pictures", exact=True).click()
        with page.expect_download() as download:
            button(page, chart).click()
        assert download.value.suggested_filename == file
        picture = download.value.path().read_text()
        assert picture.startswith("<?xml")
        assert ("screw" in picture) == (file != "front.svg")
