"""The page around a plan: how operators fare, what differs from the plan before, which point is
recommended, scenarios side by side.
"""

from __future__ import annotations

import re
from typing import Any

import tandem
from tests.studio.page import Expect, Studio, browsing, button, cell_at, enter, planned


def looked_at(page: Any, expect: Expect, name: str) -> None:
    page.get_by_role("option", name=name).click()
    expect(page.get_by_role("heading", name=name)).to_be_visible()


def row_of(page: Any, table: str, name: str) -> Any:
    named = page.get_by_role("rowheader", name=name, exact=True)
    return page.get_by_role("table", name=table).get_by_role("row").filter(has=named)


@browsing
def test_the_critical_path_and_the_balance_are_shown(shared: Studio, expect: Expect) -> None:
    page = shared.open()
    planned(page, expect)
    looked_at(page, expect, "24 s, stress 3")
    robot, human = (row_of(page, "Balance of operators", name) for name in ("robot", "human"))
    expect(robot).to_contain_text("100 %")
    expect(human.get_by_role("cell")).to_have_text(["", "13", "11", "54 %", "3"])
    path = page.get_by_role("list", name="Critical path")
    expect(path.get_by_role("button")).to_have_text(["2", "1", "4", "5", "7"])
    expect(page.locator("button.bar.critical")).to_have_count(5)
    bar = button(page, "task 6, human, 18 to 21 s")
    expect(bar).to_have_attribute("aria-description", re.compile("may slip by 1 s"))
    button(page, "to the bar of task 5").focus()
    page.keyboard.press("Enter")
    expect(page.locator("button.bar[data-task='5']")).to_be_focused()
    button(page, "Critical path").focus()
    page.keyboard.press("Enter")
    expect(page.locator("button.bar.critical")).to_have_count(0)


@browsing
def test_the_plan_before_stays_as_ghosts_with_what_changed(shared: Studio, expect: Expect) -> None:
    page = shared.open()
    planned(page, expect)
    expect(page.locator(".ghost")).to_have_count(0)
    looked_at(page, expect, "23 s, stress 7")
    looked_at(page, expect, "24 s, stress 3")
    said = page.get_by_role("note")
    expect(said).to_contain_text("Against 23 s, stress 7:")
    expect(said).to_contain_text("2 tasks moved, 1 changed operator, +1 s, stress -4")
    expect(page.locator(".ghost")).to_have_count(2)
    button(page, "Deutsch").click()
    expect(said).to_contain_text("2 Vorgänge verschoben")
    button(page, "English").click()
    button(page, "Hide ghosts").focus()
    page.keyboard.press("Enter")
    expect(said).to_have_count(0)
    expect(page.locator(".ghost")).to_have_count(0)


@browsing
def test_sliders_move_the_recommended_point(shared: Studio, expect: Expect) -> None:
    page = shared.open()
    planned(page, expect)
    chosen = page.get_by_role("option", selected=True)
    expect(chosen).to_contain_text("24 s, stress 3")
    weight = page.get_by_label("Between time and stress")
    weight.focus()
    page.keyboard.press("End")
    expect(chosen).to_contain_text("34 s, stress 2")
    expect(chosen).to_contain_text("recommended")
    said = page.locator(".sliders .said")
    expect(said).to_contain_text("34 s, stress 2, as with --weights 0,1")
    page.get_by_label("Recommend within").focus()
    page.keyboard.press("Home")
    expect(chosen).to_contain_text("23 s, stress 7")
    expect(page.locator(".point.outside")).to_have_count(2)
    expect(page.get_by_role("option", name="34 s, stress 2")).to_contain_text("outside the limits")
    page.get_by_label("Recommend with stress up to").focus()
    page.keyboard.press("Home")
    expect(said).to_contain_text("No compromise keeps both limits.")
    button(page, "Reset").click()
    expect(page.locator(".point.outside")).to_have_count(0)
    expect(page.get_by_role("option", name="24 s, stress 3")).to_contain_text("recommended")


@browsing
def test_scenarios_are_planned_compared_and_one_is_kept(studio: Studio, expect: Expect) -> None:
    page = studio.open()
    enter(page, 2, "human [s]", "18")
    page.get_by_label("Name of the scenario").fill("slow hands")
    page.keyboard.press("Enter")
    button(page, "Undo").click()
    planned(page, expect)
    slow = row_of(page, "Scenarios", "slow hands")
    expect(slow).to_contain_text("task 3: human takes 18 s instead of 10 s")
    expect(slow).to_contain_text("not planned")
    button(page, "Plan all").focus()
    page.keyboard.press("Enter")
    expect(slow).to_contain_text("2, all proven")
    expect(slow.get_by_role("cell").nth(2)).to_have_text("24 s, stress 3")
    expect(row_of(page, "Scenarios", "As it stands")).to_contain_text("23 s, stress 7")
    point = row_of(page, "Point by point", "23 s, stress 7")
    expect(point).to_contain_text("24 s (+1) at this stress")
    expect(point).to_contain_text("never so quick")
    page.reload()
    expect(slow).to_contain_text("2, all proven")
    button(page, "Keep as the file: slow hands").click()
    expect(page.get_by_role("status")).to_contain_text("is saved")
    expect(cell_at(page, 2, "human [s]")).to_have_text("18")
    assert tandem.load(studio.path).tasks["3"].time == {"human": 18}
    expect(slow).to_contain_text("nothing")
    button(page, "Undo").click()
    expect(cell_at(page, 2, "human [s]")).to_have_text("10")
    button(page, "Remove slow hands").click()
    expect(slow).to_have_count(0)
