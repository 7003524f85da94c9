"""Places, walking and tools by operator in a cell: what is taken, and what is refused in which
words.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tandem.cell.model import Cell
from tandem.cell.walking import pairs_of, seconds_at
from tandem.errors import CellError
from tandem.files.load import loads
from tandem.files.validate import cell_of
from tandem.files.yaml_writer import to_yaml


def cell(**more: Any) -> Cell:
    """Anna and a cobot, a task at each of three places."""
    return cell_of(
        {
            "operators": {"anna": {"kind": "human"}, "cobot": {"kind": "robot"}},
            "tasks": {
                place: {"time": {"anna": 3, "cobot": 4}, "place": place}
                for place in ("bench", "press-1", "shelf")
            },
            **more,
        }
    )


def faults_of(**more: Any) -> str:
    with pytest.raises(CellError) as refused:
        cell(**more)
    return str(refused.value)


def test_a_pair_counts_for_both_directions_unless_both_are_stated() -> None:
    walk = {"bench-press-1": 3, "press-1-shelf": 4, "shelf-press-1": 5, "bench-shelf": 6}
    times = cell(walk={"anna": walk}).walking["anna"]
    assert times["bench", "press-1"] == times["press-1", "bench"] == 3
    assert (times["press-1", "shelf"], times["shelf", "press-1"]) == (4, 5)


def test_coordinates_and_a_speed_say_what_no_pair_says() -> None:
    places = {"bench": [0, 0], "press-1": [3, 4], "shelf": [0, 1]}
    walking = cell(places=places, walk={"anna": {"speed": 1.5, "bench-shelf": 0.5}}).walking
    assert walking["anna"]["bench", "press-1"] == 3.4
    assert walking["anna"]["shelf", "bench"] == 0.5
    assert "cobot" not in walking


@given(
    st.sampled_from((0.1, 0.3, 1.0, 1.2, 2.5, 7.0)),
    *[st.tuples(*[st.integers(-400, 400).map(lambda n: n / 20)] * 2)] * 2,
)
def test_times_by_speed_are_the_least_tenths_that_are_enough(
    speed: float, start: tuple[float, float], end: tuple[float, float]
) -> None:
    tenths = round(10 * seconds_at(speed, start, end))
    far = sum((Fraction(repr(b)) - Fraction(repr(a))) ** 2 for a, b in zip(start, end, strict=True))

    def reaches(count: int) -> bool:
        return (Fraction(count, 10) * Fraction(repr(speed))) ** 2 >= far

    assert reaches(tenths)
    assert tenths == 0 or not reaches(tenths - 1)


def test_a_key_is_matched_against_the_places_that_there_are() -> None:
    places = ("a", "a-b", "b", "b-c")
    assert pairs_of("a-b-c", places) == [("a", "b-c")]
    assert pairs_of("a-b-b", places) == [("a-b", "b")]
    assert pairs_of("a - b", places) == [("a", "b")]
    assert pairs_of("a-b-b-c", (*places, "b-b-c")) == [("a", "b-b-c"), ("a-b", "b-c")]
    assert pairs_of("a", places) == pairs_of("a-x", places) == []


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (
            {"walk": {"anna": {"bench-press-1": 10, "bench-shelf": 3, "shelf-press-1": 4}}},
            "walk.anna.bench-press-1: walk of 'anna': walking from 'bench' to 'press-1' takes 10 s,"
            " but by 'shelf' 7 s. Give the right time of each of the",
        ),
        (
            {"walk": {"anna": {"bench-shelf": 3}}},
            "walking from 'bench' to 'shelf' takes 3 s, but by 'press-1' 0 s. State 'bench-press-1'"
            " and 'press-1-shelf' too: a way that is not stated takes 0 s.",
        ),
        (
            {"walk": {"anna": {"bnch-shelf": 3}}},
            "walk of 'anna': 'bnch-shelf' names 'bnch', which is no place of the cell. Did you mean"
            " 'bench'?",
        ),
        (
            {"walk": {"anna": {"bench": 3}}},
            "'bench' is no pair of places. Write FROM-TO, as in `bench-fixture: 3`, or `speed: 1`.",
        ),
        (
            {"walk": {"anna": {"bench-bench": 3}}},
            "'bench-bench' leads from 'bench' to itself, which takes no time. Leave it out.",
        ),
        (
            {"walk": {"anna": {"bench-shelf": 0, "bench - shelf": 0}}},
            "states the way from 'bench' to 'shelf' twice, as 'bench-shelf' and 'bench - shelf'.",
        ),
        (
            {"walk": {"ann": {"bench-shelf": 0}}},
            "walk.ann: walk names 'ann', who is no operator of the cell. Did you mean 'anna'?",
        ),
        (
            {"walk": {"anna": {"speed": 0}}},
            "speed is 0, but must be more than 0 metres a second. Leave it out if walking takes no",
        ),
        (
            {"walk": {"anna": {"speed": 1}}, "places": {"bench": [0, 0], "shelf": [1, 0]}},
            "walk of 'anna' is a speed, but the cell does not say where 'press-1' is. Give"
            " coordinates in metres: `places: {press-1: [0, 0]}`.",
        ),
        (
            {"walk": {"anna": {"bench-shelf": -1}}},
            "walk of 'anna': bench-shelf is -1, but must be 0 or more.",
        ),
        ({"walk": {"anna": 3}}, "walk of 'anna' is 3, but a mapping is needed, such as"),
        ({"places": {"bench": [0]}}, "place 'bench' needs two numbers, `[x, y]` in metres."),
        ({"places": {"bench": 3}}, "place 'bench' is 3, but two numbers are needed, `[x, y]`"),
        ({"places": {"bench": [0, "1"]}}, "the y of place 'bench' is '1', which is text, but a"),
        (
            {
                "operators": {
                    "anna": {"kind": "human", "place": "Shelf"},
                    "cobot": {"kind": "robot"},
                }
            },
            "place 'Shelf' is spelled almost like place 'shelf', so that they count as two. Did you"
            " mean 'shelf'? If they are two, rename one.",
        ),
    ],
)
def test_what_is_wrong_is_said_with_its_place_and_the_way_out(
    more: dict[str, Any], said: str
) -> None:
    assert said in faults_of(**more)


def test_a_key_that_can_mean_two_pairs_is_refused() -> None:
    tasks = {name: {"time": {"anna": 1}, "place": name} for name in ("a", "a-a")}
    assert (
        "walk of 'anna': 'a-a-a' can mean from 'a' to 'a-a' or from 'a-a' to 'a'. Rename one of the"
        " places."
    ) in faults_of(tasks=tasks, walk={"anna": {"a-a-a": 3}})


def test_tools_are_one_for_all_or_each_his_own() -> None:
    tasks = {
        "screw": {
            "time": {"anna": 3, "cobot": 4},
            "tool": {"anna": "driver", "cobot": "spindle"},
            "together": [{"operators": ["anna", "cobot"], "time": 2}],
        },
        "press": {
            "time": {"anna": 3},
            "tool": "ram",
            "together": [{"operators": ["anna", "cobot"], "time": 2, "tool": {"cobot": "ram"}}],
        },
    }
    made = cell(tasks=tasks)
    assert [dict(mode.tools) for mode in made.modes("screw")] == [
        {"anna": "driver"}, {"cobot": "spindle"}, {"cobot": "spindle", "anna": "driver"},
    ]  # fmt: skip
    assert [dict(mode.tools) for mode in made.modes("press")] == [{"anna": "ram"}, {"cobot": "ram"}]
    assert made.tool_names == ("driver", "spindle", "ram")
    assert loads(to_yaml(made)) == made


@pytest.mark.parametrize(
    ("task", "said"),
    [
        (
            {"tool": {"ann": "driver"}},
            "task 'a': tool names 'ann', who is no operator of the cell.",
        ),
        ({"tool": {"anna": 3}}, None),
        ({"tool": {"anna": None}}, "task 'a': tool of 'anna' is empty, but a name is needed."),
        ({"tool": ["driver"]}, "task 'a': tool is a list, but a name is needed."),
        (
            {"together": [{"operators": ["anna", "cobot"], "time": 1, "tool": {"ben": "driver"}}]},
            "task 'a': together: tool names 'ben', who is no operator of the cell.",
        ),
        (
            {
                "time": {},
                "tool": "driver",
                "together": [{"operators": ["anna", "cobot"], "time": 1}],
            },
            "can only do it together, but there is 1 of tool 'driver', so they never meet.",
        ),
    ],
)
def test_what_is_wrong_with_a_tool_is_said(task: dict[str, Any], said: str | None) -> None:
    tasks = {"a": {"time": {"anna": 1, "cobot": 1}, **task}}
    if said is None:
        assert cell(tasks=tasks).tool_names == ("3",)
    else:
        assert said in faults_of(tasks=tasks)


def test_a_tool_for_somebody_who_takes_no_part_is_refused() -> None:
    operators = {"anna": {"kind": "human"}, "ben": {"kind": "human"}, "cobot": {"kind": "robot"}}
    joint = {"operators": ["anna", "cobot"], "time": 1, "tool": {"ben": "driver"}}
    assert (
        "task 'a': together: a tool is stated for 'ben', who takes no part. Taking part are 'anna'"
        " and 'cobot'; take 'ben' out of the tools, or into the group."
    ) in faults_of(operators=operators, tasks={"a": {"time": {"ben": 1}, "together": [joint]}})


def test_a_cell_without_places_says_nothing_of_them() -> None:
    plain = cell_of({"operators": {"a": {"kind": "human"}}, "tasks": {"1": {"time": {"a": 1}}}})
    assert plain.digest == "356bdf914505b578"
    assert plain.to_dict().keys() == {"format", "operators", "tasks"}


def test_a_cell_with_all_of_it_comes_back_from_its_file() -> None:
    made = cell(
        places={"bench": [0, 0], "press-1": [3, 4], "shelf": [0, 1.5]},
        walk={"anna": {"speed": 1.2}, "cobot": {"bench-shelf": 0}},
        operators={"anna": {"kind": "human", "place": "shelf"}, "cobot": {"kind": "robot"}},
    )
    assert loads(to_yaml(made)) == made
