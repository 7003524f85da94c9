"""The panels of the page: whatever the cell file knows has a field, with what is wrong at it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import yaml

import tandem
from tandem.files.schema import schema as cell_schema
from tests.studio.page import Expect, Studio, browsing, button, cell_at, enter, planned

FULL = {
    "format": 1,
    "operators": {
        "ann": {"kind": "human", "setup": 1, "tool": "driver"},
        "cob": {"kind": "robot", "breaks": [[40, 50]]},
    },
    "tasks": {
        "a": {"time": {"ann": 4, "cob": 6}, "stress": 3, "tool": "driver", "zone": "jig"},
        "b": {"time": {"ann": 5, "cob": 3}, "stress": 2, "tool": "press", "place": "left"},
    },
    "tools": {"driver": {"capacity": 2, "changeover": {"ann": 2}}},
    "zones": {"jig": {"capacity": 2, "apart": ["human", "robot"]}},
    "places": {"left": [0, 0], "right": [2, 1]},
    "walk": {"ann": {"speed": 1}},
    "same_operator": [["a", "b"]],
    "cost": {"operators": {"ann": 40}, "station": 5},
    "variants": {"long": {"share": 2, "tasks": {"b": {"time": {"ann": 9}}}}},
}


def opened(page: Any, panel: str) -> None:
    """The panel, opened by keyboard."""
    summary = page.locator("summary", has_text=panel)
    summary.focus()
    page.keyboard.press("Enter")


def write(page: Any, label: str, text: str) -> Any:
    field = page.get_by_label(label, exact=True)
    field.fill(text)
    field.press("Enter")
    return field


@browsing
def test_every_key_of_the_cell_file_has_a_field(
    browser: Any, tmp_path: Path, expect: Expect
) -> None:
    path = tmp_path / "cell.yaml"
    path.write_text(yaml.safe_dump(FULL, sort_keys=False))
    studio = Studio(browser, path)
    page = studio.open()
    places = {
        tuple(place.split("\x1f"))
        for place in page.locator("[data-at]").evaluate_all("all => all.map(e => e.dataset.at)")
    }
    schema = cell_schema()
    parts = schema["$defs"]
    for key in set(schema["properties"]) - {"format", "operators", "tasks"}:
        assert any(place[0] == key for place in places), key
    for group, name, part in (
        ("operators", "ann", "Operator"),
        ("tools", "driver", "Tool"),
        ("zones", "jig", "Zone"),
        ("variants", "long", "Variant"),
    ):
        for key in parts[part]["properties"]:
            assert (group, name, key) in places, (group, key)
    assert {("cost", key) for key in parts["Cost"]["properties"]} <= places
    assert {("tools", "press", "capacity"), ("walk", "cob"), ("places", "left")} <= places
    page.get_by_text("Add a column").click()
    offered = set(page.locator(".tasks .menu button").all_inner_texts())
    shown = set(page.get_by_role("grid").get_by_role("columnheader").all_inner_texts())
    words = json.loads(
        (Path(tandem.__file__).parent / "studio/static/words_en.json").read_text("utf-8")
    )
    for key in set(parts["Task"]["properties"]) - {"time"}:
        assert words[f"column.{key}"] in offered | shown, key
    # nothing of it is lost when something is edited and saved
    page.keyboard.press("Escape")
    enter(page, 0, "ann [s]", "7")
    page.keyboard.press("Control+s")
    expect(page.get_by_role("status")).to_contain_text("is saved")
    studio.close()
    changed = json.loads(json.dumps(FULL))
    changed["tasks"]["a"]["time"]["ann"] = 7
    assert tandem.load(path) == tandem.Cell.model_validate(changed)


@browsing
def test_a_tool_is_described_where_a_task_names_it(studio: Studio, expect: Expect) -> None:
    page = studio.open()
    page.get_by_text("Add a column").click()
    page.get_by_role("button", name="Tool", exact=True).click()
    enter(page, 0, "Tool", "driver")
    enter(page, 1, "Tool", "press")
    opened(page, "Tools")
    wrong = write(page, "How many of driver", "two")
    expect(wrong).to_have_attribute("aria-invalid", "true")
    expect(page.get_by_role("button", name="tool 'driver': capacity is 'two'")).to_be_visible()
    wrong.focus()
    expect(page.locator(".panel td.wrong .message")).to_contain_text("'two'")
    expect(button(page, "Plan")).to_be_disabled()
    write(page, "How many of driver", "1")
    expect(wrong).not_to_have_attribute("aria-invalid", "true")
    write(page, "Changeover [s] of press", "robot: 3; human: 2,5")
    write(page, "Setup [s] of robot", "4")
    expect(button(page, "Plan")).to_be_enabled()
    page.keyboard.press("Control+s")
    expect(page.get_by_role("status")).to_contain_text("is saved")
    cell = tandem.load(studio.path)
    assert cell.tools["press"].changeover == {"robot": 3, "human": 2.5}
    assert cell.operators["robot"].setup == 4
    button(page, "Undo").click()
    expect(page.get_by_label("Setup [s] of robot", exact=True)).to_have_value("")


@browsing
def test_zones_variants_and_rules_are_edited(shared: Studio, expect: Expect) -> None:
    page = shared.open()
    opened(page, "Zones")
    page.get_by_label("New zone").fill("jig")
    page.keyboard.press("Enter")
    write(page, "Never at once of jig", "human, robots")
    expect(page.get_by_label("Never at once of jig")).to_have_attribute("aria-invalid", "true")
    write(page, "Never at once of jig", "human, robot")
    expect(page.get_by_label("Never at once of jig")).not_to_have_attribute("aria-invalid", "true")
    opened(page, "Product variants")
    page.get_by_label("New variant").fill("short")
    page.keyboard.press("Enter")
    write(page, "Changes to tasks of short", '{"9": null}')
    field = page.get_by_label("Changes to tasks of short")
    expect(field).to_have_attribute("aria-invalid", "true")
    write(page, "Changes to tasks of short", '{"7": {"stress": 1}}')
    expect(field).not_to_have_attribute("aria-invalid", "true")
    opened(page, "Name and rules")
    write(page, "Same operator", "4 + 6")
    assert planned(page, expect)[0] != "23 s, stress 7"
    button(page, "Undo").click()
    expect(page.get_by_label("Same operator")).to_have_value("")
    assert planned(page, expect)[0] == "23 s, stress 7"


@browsing
def test_each_member_of_what_cannot_be_leads_to_where_it_stands(
    shared: Studio, expect: Expect
) -> None:
    page = shared.open()
    write(page, "Stress limit of human", "1")
    expect(button(page, "Plan")).to_be_enabled()
    button(page, "Plan").click()
    why = page.locator(".side .faults")
    expect(why).to_contain_text("cannot be kept together")
    why.get_by_role("button").first.focus()
    page.keyboard.press("Enter")
    expect(page.get_by_label("Stress limit of human", exact=True)).to_be_focused()
    write(page, "Stress limit of human", "")
    page.get_by_label("Stress at most").fill("1")
    page.get_by_label("Stress at most").press("Enter")
    button(page, "Plan").click()
    why.get_by_role("button").first.click()
    expect(page.get_by_label("Stress at most")).to_be_focused()
    page.get_by_label("Stress at most").fill("")
    page.get_by_text("Add a column").click()
    page.get_by_role("button", name="Deadline [s]", exact=True).click()
    enter(page, 6, "Deadline [s]", "22")
    button(page, "Plan").click()
    why.get_by_role("button").first.click()
    expect(cell_at(page, 6, "Deadline [s]")).to_be_focused()


@browsing
def test_a_workbook_that_nothing_is_known_of_is_mapped_by_hand(
    shared: Studio, expect: Expect, tmp_path: Path
) -> None:
    book = tmp_path / "unknown.csv"
    book.write_text("Ding;wer eins;wer zwei\npress;9;10\nhold;8;7\n", "utf-8")
    page = shared.open()
    page.get_by_label("Import workbook").set_input_files(book)
    preview = page.locator(".preview")
    expect(preview).to_contain_text("no row reads like the header of a task list")
    expect(preview.get_by_role("cell", name="press")).to_be_visible()
    for header, meaning in (
        ("Ding", "task"),
        ("wer eins", "time Anna [s]"),
        ("wer zwei", "time cobot [s]"),
    ):
        write(page, f"Meaning of column {header}", meaning)
    expect(preview).to_contain_text("operator 'Anna': is this a human or a robot?")
    expect(page.get_by_role("button", name="Take these tasks")).to_have_count(0)
    page.get_by_label("Kind of Anna").select_option("robot")
    page.get_by_role("button", name="Take these tasks: 2").click()
    expect(cell_at(page, 0, "Anna [s]")).to_have_text("9")
    expect(page.get_by_role("button", name="Anna is a robot; change")).to_be_visible()
