"""The studio's page in a real Chromium, with the real server behind it: what a planner does there
works, nothing fails in the page, and nothing is asked of another host.
"""

from __future__ import annotations

import gzip
import hashlib
import json
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import tandem
from tests.studio.page import (
    THESIS,
    Studio,
    bars,
    browsing,
    button,
    cell_at,
    enter,
    paste,
    planned,
)

STATIC = Path(__file__).parents[2] / "src/tandem/studio/static"
VENDOR = STATIC / "vendor"


# --- what is shipped ------------------------------------------------------------------------------


def test_what_others_wrote_is_what_they_published() -> None:
    told = json.loads((VENDOR / "vendored.json").read_text())
    for one in told:
        content = (VENDOR / one["file"]).read_bytes()
        assert hashlib.sha256(content).hexdigest() == one["sha256"], one["file"]
        assert one["name"]
        assert re.fullmatch(r"\d+\.\d+\.\d+", one["version"])
        assert re.search("MIT|Apache-2.0", one["licence"])
        for licence in one["licence_files"]:
            assert "opyright" in (VENDOR / licence).read_text()
    listed = {one["file"] for one in told} | {f for one in told for f in one["licence_files"]}
    assert {path.name for path in VENDOR.iterdir()} == listed | {"vendored.json"}


def test_the_page_is_small() -> None:
    sent = [path for path in STATIC.rglob("*") if path.suffix in {".js", ".css", ".html", ".json"}]
    assert len(sent) > 10
    assert sum(len(gzip.compress(path.read_bytes())) for path in sent) < 300_000


def test_both_languages_say_the_same_things() -> None:
    english, german = (
        json.loads((STATIC / f"words_{language}.json").read_text()) for language in ("en", "de")
    )
    assert list(english) == list(german)
    for key, sentence in english.items():
        assert sorted(re.findall(r"{\w+}", sentence)) == sorted(re.findall(r"{\w+}", german[key]))


def test_every_word_of_the_page_is_there() -> None:
    english = json.loads((STATIC / "words_en.json").read_text())
    for path in STATIC.glob("*.js"):
        for key in re.findall(r"\b(?:t|say)\(\"([a-z_.]+)\"", path.read_text()):
            assert key in english, (path.name, key)


# --- in the browser -------------------------------------------------------------------------------


@browsing
def test_the_example_is_planned_and_each_point_is_looked_at(
    studio: Studio, expect: Callable[..., Any]
) -> None:
    page = studio.open()
    assert planned(page, expect) == ["23 s, stress 7", "24 s, stress 3", "34 s, stress 2"]
    for name in ("23 s, stress 7", "24 s, stress 3", "34 s, stress 2"):
        page.get_by_role("option", name=name).click()
        expect(page.get_by_role("heading", name=name)).to_be_visible()
    page.get_by_role("option", name="23 s, stress 7").click()
    expect(button(page, "task 6, human, 18 to 21 s")).to_be_visible()
    assert len(bars(page)) == 7


@browsing
def test_a_wrong_time_is_said_at_its_cell_while_it_is_typed(
    studio: Studio, expect: Callable[..., Any]
) -> None:
    page = studio.open()
    cell = cell_at(page, 2, "human [s]")
    cell.click()
    page.keyboard.type("ten")
    expect(cell).to_have_attribute("aria-invalid", "true")
    expect(cell.locator(".message")).to_contain_text("'ten'")
    page.keyboard.press("Escape")
    expect(cell).not_to_have_attribute("aria-invalid", "true")
    expect(cell).to_have_text("10")
    expect(button(page, "Undo")).to_be_disabled()


@browsing
def test_an_edit_is_undone_redone_planned_and_saved(
    studio: Studio, expect: Callable[..., Any]
) -> None:
    page = studio.open()
    cell = cell_at(page, 2, "human [s]")
    enter(page, 2, "human [s]", "18")
    expect(cell).to_have_text("18")
    button(page, "Undo").click()
    expect(cell).to_have_text("10")
    button(page, "Redo").click()
    expect(cell).to_have_text("18")
    assert planned(page, expect) == ["24 s, stress 3", "34 s, stress 2"]
    page.keyboard.press("Control+s")
    expect(page.get_by_role("status")).to_contain_text("is saved")
    assert "human: 18" in studio.path.read_text()
    assert "Exemplary assembly" in studio.path.read_text()
    expect(button(page, "Save")).to_be_disabled()


@browsing
def test_what_each_human_bears_is_written_as_by_hand(
    studio: Studio, expect: Callable[..., Any]
) -> None:
    page = studio.open()
    enter(page, 4, "Stress", "human: 2.5")
    expect(cell_at(page, 4, "Stress")).to_have_text("human: 2.5")
    button(page, "Save").click()
    expect(page.get_by_role("status")).to_contain_text("is saved")
    assert tandem.load(studio.path).tasks["5"].stress == {"human": 2.5}
    button(page, "Deutsch").click()
    belastung = cell_at(page, 4, "Belastung")
    expect(belastung).to_have_text("human: 2,5")
    enter(page, 4, "Belastung", "human: 1,5")
    expect(belastung).to_have_text("human: 1,5")


@browsing
def test_the_keyboard_moves_and_fills_as_in_a_spreadsheet(
    studio: Studio, expect: Callable[..., Any]
) -> None:
    page = studio.open()
    cell_at(page, 0, "robot [s]").click()
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Tab")
    expect(cell_at(page, 1, "human [s]")).to_be_focused()
    page.keyboard.press("F2")
    page.keyboard.type("0")
    page.keyboard.press("Enter")
    expect(cell_at(page, 1, "human [s]")).to_have_text("80")
    expect(cell_at(page, 2, "human [s]")).to_be_focused()
    page.keyboard.press("ArrowUp")
    page.keyboard.press("Shift+ArrowDown")
    page.keyboard.press("Shift+ArrowDown")
    page.keyboard.press("Control+d")
    assert [cell_at(page, row, "human [s]").inner_text() for row in (1, 2, 3)] == ["80"] * 3
    page.keyboard.press("Control+z")
    assert [cell_at(page, row, "human [s]").inner_text() for row in (1, 2, 3)] == ["80", "10", ""]
    page.keyboard.press("Delete")
    expect(cell_at(page, 2, "human [s]")).to_have_text("")


@browsing
def test_a_block_is_pasted_in_one_step_and_undone_in_one(
    studio: Studio, expect: Callable[..., Any]
) -> None:
    page = studio.open()
    before = page.locator("[role=grid] tbody").inner_text()
    cell_at(page, 5, "robot [s]").click()
    paste(page, "3,5\t4\t1\r\n6\t7\t2\t1; 2\r\n8\t\t\t3\r\n")
    expect(cell_at(page, 5, "robot [s]")).to_have_text("3.5")
    expect(cell_at(page, 6, "After")).to_have_text("1, 2")
    expect(cell_at(page, 7, "robot [s]")).to_have_text("8")
    expect(page.get_by_role("status")).to_contain_text("3 rows, 4 columns")
    button(page, "Undo").click()
    assert page.locator("[role=grid] tbody").inner_text() == before


@browsing
def test_two_tasks_of_one_name_are_refused(studio: Studio, expect: Callable[..., Any]) -> None:
    page = studio.open()
    enter(page, 1, "Task", "1")
    expect(cell_at(page, 1, "Task")).to_have_attribute("aria-invalid", "true")
    expect(page.get_by_text("Two tasks are called 1").first).to_be_attached()
    expect(button(page, "Plan")).to_be_disabled()


@browsing
def test_a_new_name_is_followed_by_those_that_wait_for_the_task(
    studio: Studio, expect: Callable[..., Any]
) -> None:
    page = studio.open()
    enter(page, 3, "Task", "press")
    expect(cell_at(page, 5, "After")).to_have_text("1, 2, press")


@browsing
def test_a_newer_file_is_never_written_over_unasked(
    studio: Studio, expect: Callable[..., Any]
) -> None:
    page = studio.open()
    enter(page, 2, "human [s]", "12")
    theirs = studio.path.read_text().replace("robot: 9", "robot: 19")
    assert theirs != studio.path.read_text()
    studio.path.write_text(theirs)
    button(page, "Save").click()
    expect(page.get_by_role("status")).to_contain_text("has changed on disk")
    assert studio.path.read_text() == theirs
    button(page, "Take the file on disk").click()
    expect(cell_at(page, 0, "robot [s]")).to_have_text("19")
    button(page, "Undo").click()
    expect(cell_at(page, 2, "human [s]")).to_have_text("12")


@browsing
def test_an_arrow_is_drawn_and_a_cycle_is_refused_and_named(
    studio: Studio, expect: Callable[..., Any]
) -> None:
    page = studio.open()

    def drag(one: str, other: str) -> None:
        page.locator(f"[data-node='{one}']").hover()
        page.mouse.down()
        page.locator(f"[data-node='{other}']").hover()
        page.mouse.up()

    drag("3", "6")
    expect(cell_at(page, 5, "After")).to_have_text("1, 2, 4, 3")
    drag("6", "1")
    expect(page.get_by_role("status")).to_contain_text("cycle: 1 → 6 → 1")
    expect(cell_at(page, 0, "After")).to_have_text("")
    page.get_by_role("button", name="arrow from task 3 to task 6").focus()
    page.keyboard.press("Delete")
    expect(cell_at(page, 5, "After")).to_have_text("1, 2, 4")


@browsing
def test_a_lost_server_is_said_and_what_was_typed_stays(
    studio: Studio, expect: Callable[..., Any]
) -> None:
    page = studio.open()
    studio.context.set_offline(True)
    enter(page, 2, "human [s]", "12")
    expect(page.get_by_role("status")).to_contain_text("No connection")
    studio.context.set_offline(False)
    expect(page.get_by_role("status")).not_to_contain_text("No connection")
    expect(cell_at(page, 2, "human [s]")).to_have_text("12")
    assert planned(page, expect)


@browsing
def test_the_page_speaks_german(studio: Studio, expect: Callable[..., Any]) -> None:
    page = studio.open()
    planned(page, expect)
    button(page, "Deutsch").click()
    expect(page.get_by_role("option", name="24 s, Belastung 3")).to_be_visible()
    expect(button(page, "Planen")).to_be_visible()
    assert page.locator("html").get_attribute("lang") == "de"


@browsing
@pytest.mark.parametrize("width", [768, 1280, 2560])
def test_nothing_is_wider_than_the_window_and_no_text_is_small(
    studio: Studio, expect: Callable[..., Any], width: int
) -> None:
    page = studio.open()
    page.set_viewport_size({"width": width, "height": 900})
    planned(page, expect)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    small = page.evaluate(
        """() => [...document.querySelectorAll('body *')]
            .filter(e => [...e.childNodes].some(n => n.nodeType === 3 && n.data.trim()))
            .filter(e => parseFloat(getComputedStyle(e).fontSize) < 14)
            .map(e => e.outerHTML.slice(0, 80))"""
    )
    assert small == []


def carry(page: Any, name: str, lane: str, seconds: float, *, drop: bool = True) -> None:
    """Drags the bar to another lane, and by so many seconds."""
    bar = button(page, name).bounding_box()
    there = page.locator(f"[data-lane='{lane}']").bounding_box()
    start, end = map(float, re.findall(r"(\S+) to (\S+) s", name)[0])
    scale = bar["width"] / (end - start)
    x, y = bar["x"] + bar["width"] / 2, bar["y"] + bar["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 6, y, steps=2)
    page.mouse.move(x + seconds * scale, there["y"] + there["height"] / 2, steps=4)
    if drop:
        page.mouse.up()


@browsing
def test_a_dragged_bar_says_what_the_checker_says_and_the_rest_is_solved_again(
    studio: Studio, expect: Callable[..., Any]
) -> None:
    page = studio.open()
    planned(page, expect)
    page.get_by_role("option", name="23 s, stress 7").click()
    before = bars(page)
    carry(page, "task 6, human, 18 to 21 s", "robot", 0, drop=False)
    expect(page.locator(".readout")).to_contain_text("task 6, robot, 18 to 28 s")
    page.mouse.up()
    expect(page.get_by_role("status")).to_contain_text("Rules broken")
    expect(button(page, "task 6, robot, 18 to 28 s")).to_be_visible()
    expect(page.locator(".faults li").first).to_be_visible()
    button(page, "Re-solve the rest").click()
    expect(button(page, "Keep")).to_be_visible()
    expect(button(page, "task 6, robot, 18 to 28 s")).to_be_visible()
    button(page, "Discard").click()
    expect(page.locator(".faults li").first).to_be_visible()
    button(page, "Re-solve the rest").click()
    button(page, "Keep").click()
    expect(page.get_by_role("status")).to_contain_text("Kept: 30 s")
    expect(page.locator(".faults")).to_have_count(0)
    button(page, "Undo").click()
    button(page, "Undo").click()
    assert bars(page) == before


@browsing
def test_a_lane_that_cannot_take_a_bar_says_why(studio: Studio, expect: Callable[..., Any]) -> None:
    page = studio.open()
    planned(page, expect)
    before = bars(page)
    carry(page, "task 3, human, 0 to 10 s", "robot", 0, drop=False)
    lane = page.locator("[data-lane='robot']")
    expect(lane).to_have_class(re.compile("barred"))
    expect(lane.locator(".reason")).to_contain_text("robot")
    page.mouse.up()
    expect(page.get_by_role("status")).to_contain_text("Task 3 stays where it was")
    assert bars(page) == before
    carry(page, "task 6, human, 18 to 21 s", "human", 3, drop=False)
    page.keyboard.press("Escape")
    page.mouse.up()
    expect(page.get_by_role("status")).to_contain_text("nothing has moved")
    assert bars(page) == before


@browsing
def test_a_bar_snaps_to_the_ends_of_others_but_not_with_alt(
    studio: Studio, expect: Callable[..., Any]
) -> None:
    page = studio.open()
    planned(page, expect)
    page.get_by_role("option", name="23 s, stress 7").click()
    enter(page, 0, "robot [s]", "9.1")  # times with decimals: the grid is finer than the snapping
    planned(page, expect)
    page.get_by_role("option").first.click()
    name = next(bar for bar in bars(page) if bar.startswith("task 6, human"))
    start = float(re.findall(r"(\S+) to", name)[0])
    carry(page, name, "human", 23.1 - start - 0.15)
    expect(page.get_by_role("button", name=re.compile(r"task 6, human, 23\.1 to"))).to_be_visible()
    button(page, "Undo").click()
    page.keyboard.down("Alt")
    carry(page, name, "human", 23.1 - start - 0.15)
    page.keyboard.up("Alt")
    expect(page.get_by_role("button", name=re.compile(r"task 6, human, 2[23]"))).to_be_visible()
    assert not page.get_by_role("button", name=re.compile(r"task 6, human, 23\.1 to")).count()


@browsing
def test_all_of_it_by_keyboard_alone(studio: Studio, expect: Callable[..., Any]) -> None:
    page = studio.open()
    page.keyboard.press("Control+Enter")
    expect(page.get_by_role("status")).to_contain_text("all proven")
    page.get_by_role("option", selected=True).focus()
    page.keyboard.press("ArrowUp")
    expect(page.get_by_role("option", name="23 s, stress 7")).to_be_focused()
    button(page, "task 6, human, 18 to 21 s").focus()
    page.keyboard.press("ArrowUp")
    expect(page.locator(".readout")).to_contain_text("task 6, robot, 18 to 28 s")
    page.keyboard.press("Escape")
    expect(button(page, "task 6, human, 18 to 21 s")).to_be_focused()
    page.keyboard.press("ArrowUp")
    page.keyboard.press("Enter")
    expect(button(page, "task 6, robot, 18 to 28 s")).to_be_focused()
    page.keyboard.press("l")
    expect(page.get_by_role("button", name="task 6, robot, 18 to 28 s, locked")).to_be_focused()
    button(page, "Re-solve the rest").focus()
    page.keyboard.press("Enter")
    button(page, "Keep").focus()
    page.keyboard.press("Enter")
    expect(page.get_by_role("status")).to_contain_text("Kept: 30 s")
    page.keyboard.press("Control+z")
    expect(page.get_by_role("status")).to_contain_text("One step back")


@browsing
def test_a_task_is_asked_why_it_is_there(studio: Studio, expect: Callable[..., Any]) -> None:
    page = studio.open()
    planned(page, expect)
    page.get_by_role("option", name="23 s, stress 7").click()
    button(page, "task 6, human, 18 to 21 s").click()
    button(page, "Why here, and why not another?").click()
    expect(page.locator(".sentences")).to_contain_text("robot")


@browsing
def test_the_report_is_downloaded_and_opens_with_the_network_off(
    studio: Studio, expect: Callable[..., Any], tmp_path: Path
) -> None:
    page = studio.open()
    planned(page, expect)
    with page.expect_download() as found:
        button(page, "Report").click()
    report = tmp_path / found.value.suggested_filename
    found.value.save_as(report)
    assert report.suffix == ".html"
    studio.context.set_offline(True)
    other = studio.context.new_page()
    other.goto(report.as_uri())
    expect(other.get_by_role("heading", level=1)).to_contain_text("Exemplary assembly")
    studio.context.set_offline(False)


@browsing
def test_a_workbook_is_looked_at_mapped_by_hand_and_taken(
    studio: Studio, expect: Callable[..., Any], tmp_path: Path
) -> None:
    workbook = tmp_path / "line 3.csv"
    workbook.write_text(
        "Step;Robot [s];Human [s];EAWS;needs\npress;9;10;10;\nhold;;8;11;press\n", "utf-8"
    )
    page = studio.open()
    before = page.locator("[role=grid] tbody").inner_text()
    page.get_by_label("Import workbook").set_input_files(workbook)
    expect(page.get_by_text("column E 'needs' was not read").first).to_be_visible()
    page.get_by_label("Meaning of column needs").fill("after")
    page.get_by_label("Meaning of column needs").press("Enter")
    expect(page.get_by_text("column E 'needs' was not read")).to_have_count(0)
    button(page, "Take these tasks: 2").click()
    expect(cell_at(page, 1, "After")).to_have_text("press")
    assert len(planned(page, expect)) >= 1
    button(page, "Undo").click()
    assert page.locator("[role=grid] tbody").inner_text() == before


@browsing
def test_a_limit_that_cannot_be_kept_is_named(studio: Studio, expect: Callable[..., Any]) -> None:
    page = studio.open()
    page.get_by_label("Stress at most").fill("1")
    button(page, "Plan").click()
    expect(page.get_by_text("Without the limit on stress (1) it works")).to_be_visible()
    page.get_by_label("Stress at most").fill("5")
    assert planned(page, expect) == ["24 s, stress 3", "34 s, stress 2"]
    expect(page.get_by_text("Without the limit on stress (1) it works")).to_have_count(0)


@browsing
def test_what_was_not_saved_is_offered_at_the_next_start(
    browser: Any, tmp_path: Path, expect: Callable[..., Any]
) -> None:
    path = tmp_path / "cell.yaml"
    shutil.copy(THESIS, path)
    first = Studio(browser, path)
    page = first.open()
    with page.expect_response(lambda answer: answer.url.endswith("/api/draft")):
        enter(page, 2, "human [s]", "18")
    first.close()
    assert path.read_bytes() == THESIS.read_bytes()
    second = Studio(browser, path)
    page = second.open()
    button(page, "Take it up").click()
    expect(cell_at(page, 2, "human [s]")).to_have_text("18")
    page.keyboard.press("Control+s")
    expect(page.get_by_role("status")).to_contain_text("is saved")
    second.close()
    assert "human: 18" in path.read_text()


@browsing
def test_the_order_of_tasks_and_operators_is_kept(browser: Any, tmp_path: Path) -> None:
    path = tmp_path / "cell.json"
    cell = {
        "format": 1,
        "operators": {"2": {"kind": "human"}, "1": {"kind": "robot"}},
        "tasks": {"10": {"time": {"2": 4}}, "9": {"time": {"1": 3}, "after": ["10"]}},
    }
    path.write_text(json.dumps(cell))
    studio = Studio(browser, path)
    page = studio.open()
    enter(page, 0, "2 [s]", "5")
    with page.expect_response(lambda answer: answer.request.method == "PUT"):
        button(page, "Save").click()
    studio.close()
    saved = json.loads(path.read_text())
    assert list(saved["tasks"]) == ["10", "9"]
    assert list(saved["operators"]) == ["2", "1"]
    assert saved["tasks"]["10"]["time"] == {"2": 5}


@browsing
def test_an_operator_is_added_given_times_and_planned(
    studio: Studio, expect: Callable[..., Any]
) -> None:
    page = studio.open()
    page.get_by_label("New operator").fill("ben")
    button(page, "Add operator").click()
    enter(page, 0, "ben [s]", "3")
    page.get_by_label("Breaks [s] of ben").fill("1 till 2")
    page.get_by_label("Breaks [s] of ben").press("Enter")
    expect(page.get_by_label("Breaks [s] of ben")).to_have_attribute("aria-invalid", "true")
    page.get_by_label("Breaks [s] of ben").fill("40-50")
    page.get_by_label("Breaks [s] of ben").press("Enter")
    expect(button(page, "Plan")).to_be_enabled()
    assert planned(page, expect)[0] != "23 s, stress 7"
    button(page, "Remove ben").click()
    assert planned(page, expect)[0] == "23 s, stress 7"


@browsing
def test_in_an_empty_folder_a_cell_is_begun_and_saved(
    browser: Any, tmp_path: Path, expect: Callable[..., Any]
) -> None:
    studio = Studio(browser, tmp_path)
    page = studio.open()
    button(page, "Add task").click()
    enter(page, 0, "human [s]", "4")
    expect(button(page, "Plan")).to_be_enabled()
    button(page, "Save").click()
    expect(page.get_by_role("status")).to_contain_text("cell.yaml is saved")
    assert planned(page, expect) == ["4 s, stress 0"]
    studio.close()
    assert "human: 4" in (tmp_path / "cell.yaml").read_text()
