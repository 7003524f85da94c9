"""Whatever is wrong with a cell, the message speaks of cells: no trace of Python or of the library
that found it.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tandem.cell import soundness
from tandem.errors import CellError, Fault
from tandem.files import messages
from tandem.files.load import load
from tandem.files.messages import shown
from tandem.files.validate import cell_of

PYTHON = re.compile(
    r"\{'|\['|\('|<class|<object|\bNone\b|\bTrue\b|\bFalse\b|pydantic|Input should|Keys"
    r" should|\bdict\b|\btuple\b| b'x|Decimal|Error\b"
)
REMEDY = re.compile(
    r"needed|must be|Did you mean|Known:|None are stated|others are known|at most|[Ww]rite |[Tt]ake"
    r" |[Ll]eave |[Cc]orrect |Keep |Give |State |Round |"
    r"Rename|Shorten|"
    r"Set the|Spell |Make them|needs different|needs one at least|belongs in|A name has|can be"
    r" planned|holds pairs|reads format|longer than|"
    r"must last|needs two numbers|A cell file is|as in `|Name "
)

SOUND: dict[str, Any] = {
    "format": 1,
    "name": "n",
    "operators": {
        "r": {"kind": "robot", "label": "R", "breaks": [[1, 2]], "tool": "t", "place": "p"},
        "h": {"kind": "human", "stress_limit": 9},
        "m": {"kind": "machine", "holds": [["a", "b"]]},
    },
    "tasks": {
        "a": {
            "label": "l", "part": "p", "time": {"r": 2, "h": 3}, "stress": 1, "after": [],
            "tool": "t", "zone": "z", "place": "p",
            "difficulty": {"h": 2}, "release": 1, "deadline": 99, "spread": 0.1,
        },
        "b": {"together": [{"operators": ["r", "h"], "time": 4, "stress": {"h": 2},
        "tool": {"h": "t"}}],
        "stress": {"h": 1}, "after": ["a"], "spread": {"h": 0.1}, "tool": {"r": "t"}, "place": "q",
        "wait": [{"after": "a", "between": "start-start", "at_least": 1, "at_most": 50}],
        "ergonomics": [
            {"method": "duet", "omni_res": 4, "reps_per_cycle": {"value": 2, "source": "video"},
            "side": "left", "operators": ["h"]},
            {"method": "eaws", "score": 38},
        ]},
    },
    "tools": {"t": {"capacity": 2, "changeover": {"r": 1}}},
    "zones": {"z": {"capacity": 2, "apart": ["human", "machine"]}},
    "places": {"p": [0, 0], "q": [1, 2.5]},
    "walk": {"r": {"p-q": 2}, "h": {"speed": 1.5}},
    "same_operator": [],
    "stress_of_set": {"": 0, "a": 1, "b": 1, "a,b": 3},
}  # fmt: skip

ODD: tuple[Any, ...] = (
    None, True, False, "x", "1,5", "2", "", -1, 0, 1e9, 10**30, float("nan"), float("-inf"), 1.5,
    -0.1234567891, [], {}, [1], {"a": 1}, "y" * 600,
    [["a"]], [1, 2, 3], {"r": None}, {"h": True}, {"operators": ["r"]}, [{"operators": ["r", "h"]}],
    ["a", "a"], "t\x1b[31m", b"x",
)  # fmt: skip


def paths(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    yield path
    steps = (
        value if isinstance(value, dict) else range(len(value)) if isinstance(value, list) else ()
    )
    for step in steps:
        yield from paths(value[step], (*path, step))


def with_value(path: tuple[Any, ...], value: Any) -> Any:
    """The sound cell with one value replaced or added."""
    if not path:
        return value
    data = copy.deepcopy(SOUND)
    inside: Any = data
    for step in path[:-1]:
        inside = inside[step]
    inside[path[-1]] = value
    return data


def faults_of(data: Any) -> tuple[Fault, ...]:
    try:
        cell_of(data)
    except CellError as error:
        return error.faults
    return ()


def broken() -> Iterator[tuple[Fault, ...]]:
    """Every odd value at every place, and under keys that nobody knows."""
    for path in paths(SOUND):
        for value in ODD:
            yield faults_of(with_value(path, value))
            at = SOUND
            for step in path:
                at = at[step]
            if isinstance(at, dict):
                for key in ("zzz", "duration", " ", "k" * 300):
                    yield faults_of(with_value((*path, key), value))


def test_no_message_shows_python_and_each_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    kinds, sentence = set(), messages._other

    def unknown(path: Any, item: Any) -> str:
        kinds.add(item["type"])
        return sentence(path, item)

    monkeypatch.setattr(messages, "_other", unknown)
    found = {fault.message for faults in broken() for fault in faults}
    assert len(found) > 1000
    assert kinds == set(), "a kind of fault without a sentence of its own"
    assert [message for message in found if PYTHON.search(message)] == []
    assert [message for message in found if not REMEDY.search(message)] == []
    assert [message for message in found if len(message) > 800] == []


def test_every_fault_of_a_broken_value_names_the_place_in_the_document() -> None:
    unplaced = [
        fault
        for path in paths(SOUND)
        if path
        for fault in faults_of(with_value(path, object()))
        if not fault.path
    ]
    assert unplaced == []


UNFIT = {
    "assessments_can_be_scored": {
        "tasks": {
            "a": {"time": {"h": 1}, "ergonomics": {"method": "reba", "trunk": 400}},
            "b": {
                "time": {"h": 1},
                "ergonomics": [
                    {"method": "raba"},
                    {"method": "eaws"},
                    {"method": "reba", "score": 16},
                    {"method": "reba", "score": 3, "operators": ["r", "q"]},
                    {"method": "duet", "omni_res": 3, "reps": 100},
                    {"method": "duet", "omni_res": 3, "reps_per_cycle": 1, "score": 2},
                    {"method": "lifft", "lever": {"cm": 3}},
                    {"method": "ocra", "score": 3},
                    {"method": "ocra", "score": 4},
                ],
            },
        }
    },
    "limits_can_be_kept": {
        "operators": {
            "h": {
                "kind": "human",
                "limits": {
                    "peak:raba": 3,
                    "stress": 5,
                    "worst:peak:stress": 3,
                    "time-weighted:stress": 2,
                    "fatigue:stress:1:1": 0.5,
                    "dose:stress": 9,
                    "peak:stress": 3,
                    "peek:stress": 3,
                },
            },
            "r": {"kind": "robot", "limits": {"peak:stress": 3}},
        }
    },
    "invested_money_is_spread_over_hours": {"cost": {"invest": 9000}},
    "operators_are_known": {"tasks": {"a": {"time": {"q": 1}}}},
    "names_can_be_told_apart": {"tasks": {"a": {"time": {"h": 1}}, "\u0430": {"time": {"h": 1}}}},
    "tasks_are_known": {"tasks": {"a": {"time": {"h": 1}, "after": ["q"]}}},
    "tasks_of_held_parts_are_known": {
        "operators": {"m": {"kind": "machine", "holds": [["a", "q"]]}}
    },
    "no_task_comes_after_itself": {"tasks": {"a": {"time": {"h": 1}, "after": ["a"]}}},
    "no_task_waits_for_itself": {
        "tasks": {"a": {"time": {"h": 1}, "after": ["b"]}, "b": {"time": {"h": 1}, "after": ["a"]}}
    },
    "a_wait_leaves_time_to_start": {
        "tasks": {
            "a": {"time": {"h": 1}},
            "b": {"time": {"h": 1}, "wait": {"after": "a", "at_least": 4, "at_most": 3}},
        }
    },
    "a_group_names_each_operator_once": {
        "tasks": {"a": {"together": [{"operators": ["h", "h"], "time": 1}]}}
    },
    "someone_can_do_each_task": {"tasks": {"a": {}}},
    "kinds_are_kept_apart_from_each_other": {"zones": {"z": {"apart": ["human"]}}},
    "stress_is_put_on_humans": {"tasks": {"a": {"time": {"r": 1}, "stress": {"r": 2}}}},
    "machines_hold_from_one_task_to_a_later_one": {
        "operators": {
            "h": {"kind": "human", "holds": [["a", "b"]]},
            "r": {"kind": "machine", "holds": [["a", "b"], ["a", "a"]]},
        }
    },
    "stress_of_a_group_is_put_on_its_members": {
        "operators": {"h": {"kind": "human"}, "k": {"kind": "human"}, "r": {"kind": "robot"}},
        "tasks": {"a": {"together": [{"operators": ["r", "h"], "time": 1, "stress": {"k": 2}}]}},
    },
    "a_tool_of_a_group_is_used_by_its_members": {
        "operators": {"h": {"kind": "human"}, "k": {"kind": "human"}, "r": {"kind": "robot"}},
        "tasks": {"a": {"together": [{"operators": ["r", "h"], "time": 1, "tool": {"k": "t"}}]}},
    },
    "walks_name_pairs_of_places": {"walk": {"h": {"here-there": 3}}},
    "speeds_lead_between_coordinates": {
        "tasks": {"a": {"time": {"h": 1}, "place": "here"}},
        "walk": {"h": {"speed": 1}},
    },
    "no_detour_is_shorter": {
        "places": {"a": [0, 0], "b": [0, 0], "c": [0, 0]},
        "walk": {"h": {"a-b": 9, "b-c": 1, "a-c": 1}},
    },
    "breaks_are_apart": {
        "operators": {"h": {"kind": "human", "breaks": [[1, 3], [2, 4]]}, "r": {"kind": "robot"}}
    },
    "a_deadline_can_be_met": {"tasks": {"a": {"time": {"h": 5}, "deadline": 1}}},
    "pairs_have_a_common_way": {
        "tasks": {"a": {"time": {"h": 1}}, "b": {"time": {"r": 1}}},
        "same_operator": [["a", "b"]],
    },
    "sets_are_spelled_in_order": {"stress_of_set": {"": 0, "b,a": 1}},
    "listed_things_are_not_misspelled": {
        "tasks": {"a": {"time": {"h": 1}, "tool": "driver"}},
        "tools": {"drivr": {}},
    },
    "things_are_spelled_alike": {
        "tasks": {
            "a": {"time": {"h": 1}, "tool": "driver"},
            "b": {"time": {"h": 1}, "tool": "drivr"},
        }
    },
    "numbers_have_few_decimals": {"tasks": {"a": {"time": {"h": 1.12345678}}}},
    "exact_planning_can_count_it": {
        "tasks": {"a": {"time": {"h": 1e7}}, "b": {"time": {"h": 0.000001}}}
    },
}
"""Rule -> what breaks it, in place of the same keys of a plain cell."""


@pytest.mark.parametrize("rule", [rule.__name__ for rule in soundness.RULES])
def test_every_rule_speaks_of_cells_with_place_value_and_way_out(rule: str) -> None:
    plain = {
        "operators": {"h": {"kind": "human"}, "r": {"kind": "robot"}},
        "tasks": {"a": {"time": {"h": 1}}, "b": {"time": {"r": 1}}},
    }
    found = faults_of({**plain, **UNFIT[rule]})
    assert found
    for fault in found:
        assert fault.path
        assert not PYTHON.search(fault.message)
        assert REMEDY.search(fault.message)


@pytest.mark.parametrize(
    ("value", "said"),
    [
        (True, "true"), (None, "empty"), (2.0, "2"), (0.1 + 0.2, "0.3"), (1234567.5, "1234567.5"),
        ({"a": 1}, "a mapping"), ([1], "a list"),
        ("it's", '"it\'s"'), (10**40, "a number of more than 16 digits"), (b"x",
        "neither text nor a number (bytes)"),
    ],
)  # fmt: skip
def test_a_value_is_shown_as_a_file_has_it(value: object, said: str) -> None:
    assert shown(value) == said


def test_the_break_that_is_wrong_is_named(tmp_path: Path) -> None:
    file = tmp_path / "cell.yaml"
    file.write_text(
        "operators:\n  h: {kind: human, breaks: [[1, 2], [5, yes]]}\ntasks:\n  1: {time: {h: 1}}\n",
        encoding="utf-8",
    )
    with pytest.raises(
        CellError,
        match=r"cell\.yaml:2:41: operator 'h': the end of break 2 is 'yes', but a number is needed",
    ):
        load(file)
