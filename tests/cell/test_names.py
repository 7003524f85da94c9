"""Names have one spelling, whatever door they come in by; those that look alike are refused, and so
is what a terminal would obey.
"""

from __future__ import annotations

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

import tandem
from tandem.cell.names import clean, clean_title, harm_in, look, twins
from tandem.errors import CellError, UsageError
from tandem.explain.variant import variant
from tandem.files.load import dumps, loads
from tandem.files.validate import cell_of
from tandem.schedule.model import Schedule
from tandem.world.arrays import Names
from tandem.world.behaviour import traits

APART = "Geha\u0308use"  # as macOS writes it
WHOLE = "Gehäuse"
SPELLINGS = [
    APART,
    f" {WHOLE}",
    f"{WHOLE}\u00a0",
    "Ge\u00adhäuse\u200b",
    f"\ufeff{WHOLE}\u2060",
    f"{WHOLE}\ufe0f",
]


def cell_with(*names: str) -> dict[str, Any]:
    return {
        "operators": {"h": {"kind": "human"}},
        "tasks": {name: {"time": {"h": 1}} for name in names},
    }


@pytest.mark.parametrize("spelling", SPELLINGS)
def test_a_name_has_one_spelling(spelling):
    assert clean(spelling) == WHOLE


@given(st.text())
def test_what_is_clean_stays_so(text):
    assert clean(clean(text)) == clean(text)
    assert clean_title(clean_title(text)) == clean_title(text)


def test_a_title_keeps_the_signs_that_shape_its_letters():
    persian = "\u0645\u06cc\u200c\u062e\u0648\u0627\u0647\u062f"
    assert clean_title(f" {persian}\u202e ") == persian
    assert clean(persian) == persian.replace("\u200c", "")


@pytest.mark.parametrize("spelling", SPELLINGS)
@pytest.mark.parametrize("form", ["yaml", "json"])
def test_a_cell_file_may_refer_to_a_task_in_another_spelling(form, spelling):
    if form == "json":
        data = cell_with(spelling, "b")
        data["tasks"]["b"] = {"time": {"h ": 1}, "after": [WHOLE]}
        text = json.dumps({**data, "same_operator": [[WHOLE, "b"]]})
    else:
        text = (
            "operators: {h: {kind: human}}\n"
            "tasks:\n"
            f"  {WHOLE}: {{time: {{h: 1}}}}\n"
            f'  b: {{time: {{h: 1}}, after: ["{spelling}"]}}\n'
        )
    cell = loads(text)
    assert list(cell.tasks) == [WHOLE, "b"]
    assert cell.tasks["b"].after == (WHOLE,)


@pytest.mark.parametrize("spelling", SPELLINGS)
def test_the_same_name_twice_is_refused_with_both_lines(spelling):
    text = (
        "operators: {h: {kind: human}}\n"
        "tasks:\n"
        f"  {WHOLE}: {{time: {{h: 1}}}}\n"
        f'  "{spelling}": {{time: {{h: 2}}}}\n'
    )
    with pytest.raises(CellError) as refused:
        loads(text, source="twins.yaml")
    [fault] = refused.value.faults
    assert fault.place == "twins.yaml:4:3"
    assert "'Gehäuse' is stated twice, first in line 3 and again here in line 4" in fault.message
    assert "look alike" in fault.message


@pytest.mark.parametrize("table", ["tasks", "operators"])
@pytest.mark.parametrize("twin", ["а", "ａ", "a\u200b", "a "])
def test_names_that_look_alike_are_refused_in_python_too(table, twin):
    data = cell_with("a")
    data["operators"] = {"h": {"kind": "human"}, "a": {"kind": "robot"}}
    data[table] = {**data[table], twin: data[table]["a"]}
    with pytest.raises(CellError, match=r"looks like|twice"):
        cell_of(data)


@pytest.mark.parametrize(
    ("key", "twin"),
    [("tool", "drіver"), ("zone", "drіver"), ("tool", "ｄriver"), ("zone", "driver")],
)
def test_tools_and_zones_that_look_alike_are_refused(key, twin):
    data = cell_with("a", "b")
    data["tasks"]["a"][key], data["tasks"]["b"][key] = "driver", twin
    if twin == "driver":
        assert cell_of(data).tasks["b"].model_dump()[key] == "driver"
        return
    with pytest.raises(CellError, match=r"looks like .* 'driver' but is written with other signs"):
        cell_of(data)


def test_two_times_of_one_operator_are_refused_with_both_places():
    with pytest.raises(
        CellError, match="'h' is stated twice, first in line 2 and again here in line 2"
    ):
        loads('operators: {h: {kind: human}}\ntasks: {a: {time: {h: 1, "h\\u00a0": 3}}}')
    with pytest.raises(CellError, match=r"time states 'h' twice, as 'h' and as 'h\\u200b'"):
        cell_of({**cell_with(), "tasks": {"a": {"time": {"h": 1, "h\u200b": 2}}}})


def test_a_number_and_its_digits_are_one_name():
    with pytest.raises(CellError, match="tasks states '1' twice, as 1 and as '1'"):
        cell_of({**cell_with(), "tasks": {1: {"time": {"h": 1}}, "1": {"time": {"h": 2}}}})


@pytest.mark.parametrize(
    "pair",
    [("m²", "m2"), ("①", "1"), ("½", "1/2"), ("a", "b"), ("A", "a"), ("Schraube", "Schraube 2")],
)
def test_names_that_can_be_told_apart_may_stand_side_by_side(pair):
    assert list(twins(pair)) == []
    assert set(cell_of(cell_with(*pair)).tasks) == set(pair)


@pytest.mark.parametrize(
    "pair", [("a", "а"), ("fit", "ﬁt"), ("A1", "Ａ１"), ("a-b", "a‑b"), ("H", "Η")]
)
def test_what_looks_alike_has_one_look(pair):
    assert look(pair[0]) == look(pair[1])
    assert list(twins(pair)) == [pair]


@pytest.mark.parametrize("sign", ["\x1b", "\x00", "\x07", "\x9b", "\x7f", "\ud800", "\uffff"])
@pytest.mark.parametrize(
    "key", ["task", "operator", "label", "part", "tool", "zone", "after", "name"]
)
def test_signs_that_a_terminal_would_obey_and_half_characters_are_refused(sign, key):
    name = f"a{sign}b"
    data: dict[str, Any] = cell_with("a")
    match key:
        case "task":
            data = cell_with(name)
        case "operator":
            data["operators"][name] = {"kind": "human"}
        case "name":
            data["name"] = name
        case "after":
            data["tasks"]["b"] = {"time": {"h": 1}, "after": [name]}
        case _:
            data["tasks"]["a"][key] = name
    for read in (lambda: cell_of(data), lambda: loads(json.dumps(data))):
        with pytest.raises(
            CellError,
            match=(
                f"holds the (control character|half character|sign) U\\+{ord(sign):04X}, which no"
                " name may have"
            ),
        ):
            read()


def test_what_harms_is_named():
    assert harm_in("a\x1b[2J") == "the control character U+001B"
    assert harm_in("a\ud83d") == "the half character U+D83D"
    assert harm_in("Gehäuse 😀") is None


def test_a_pair_of_halves_is_one_character():
    cell = loads(
        '{"operators": {"h": {"kind": "human"}}, "tasks": {"\\ud83d\\ude00": {"time": {"h": 1}}}}'
    )
    assert list(cell.tasks) == ["😀"]
    assert loads(dumps(cell)) == cell


@pytest.mark.parametrize("spelling", SPELLINGS)
def test_options_take_any_spelling(spelling):
    operators = {"jörg": {"kind": "human"}, "cobot": {"kind": "robot"}}
    cell = cell_of(
        {
            "operators": operators,
            "tasks": {WHOLE: {"time": {"jörg": 5, "cobot": 6}}, "b": {"time": {"cobot": 1}}},
        }
    )
    assert dict(variant(cell, force=[f"{spelling}=jo\u0308rg "]).tasks[WHOLE].time) == {"jörg": 5}
    assert (
        variant(cell, sets=[f'tasks."{spelling}".time.jo\u0308rg=9']).tasks[WHOLE].time["jörg"] == 9
    )
    assert list(variant(cell, without=["jo\u0308rg\u200b"]).operators) == ["cobot"]
    [trait] = traits(f"prefers:{spelling}", Names.of(cell))
    assert trait.words == (WHOLE,)
    with pytest.raises(UsageError, match="there is no task 'x'"):
        variant(cell, force=["x=jörg"])


@pytest.mark.parametrize("spelling", SPELLINGS)
def test_a_plan_is_read_back_in_any_spelling(spelling):
    cell = cell_of(cell_with(WHOLE))
    schedule = Schedule.from_list(
        [{"task": spelling, "operators": ["h\u00a0"], "start": 0, "end": 1}]
    )
    assert tandem.faults(cell, schedule) == []
