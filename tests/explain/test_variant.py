"""What-if: values set, operators left out, tasks forced; and clear words when that cannot be."""

from __future__ import annotations

from typing import Any

import pytest

from tandem.cell.model import Cell
from tandem.errors import CellError, UsageError
from tandem.explain.variant import variant
from tandem.files.load import load
from tandem.files.validate import cell_of


def test_nothing_asked_gives_the_same_cell(thesis: Cell) -> None:
    assert variant(thesis) == thesis


@pytest.mark.parametrize(
    ("text", "path", "value"),
    [
        ("tasks.6.time.robot=8", ("tasks", "6", "time", "robot"), 8),
        ("tasks.6.time.robot=+10%", ("tasks", "6", "time", "robot"), 11),
        ("tasks.2.time.robot=-10%", ("tasks", "2", "time", "robot"), 6.3),
        ("tasks.4.time.human=5.5", ("tasks", "4", "time", "human"), 5.5),
        ("tasks.4.after=[1]", ("tasks", "4", "after"), ["1"]),
        ("tasks.3.deadline=30", ("tasks", "3", "deadline"), 30),
        ("operators.human.stress_limit=9", ("operators", "human", "stress_limit"), 9),
        ("name=another", ("name",), "another"),
        ('tasks."7".stress=0.5', ("tasks", "7", "stress"), 0.5),
    ],
)
def test_set(thesis: Cell, text: str, path: tuple[str, ...], value: Any) -> None:
    expected = thesis.to_dict()
    at = expected
    for key in path[:-1]:
        at = at[key]
    at[path[-1]] = value
    assert variant(thesis, [text]).to_dict() == expected


def test_set_none_takes_a_way_out(thesis: Cell) -> None:
    assert dict(variant(thesis, ["tasks.6.time.robot=none"]).tasks["6"].time) == {"human": 3.0}


def test_a_name_with_dots_is_found(thesis: Cell) -> None:
    cell = thesis.replace(tasks={"1.5": {"time": {"robot": 9}}, "1": {"time": {"human": 2}}})
    assert variant(cell, ["tasks.1.5.time.robot=4"]).tasks["1.5"].time["robot"] == 4


def test_without_takes_the_operator_out_of_everything() -> None:
    cell = Cell.model_validate(
        {
            "operators": {
                "anna": {"kind": "human"},
                "ben": {"kind": "human"},
                "ur": {"kind": "robot"},
            },
            "tasks": {
                "1": {
                    "time": {"anna": 3, "ben": 4},
                    "stress": {"anna": 1, "ben": 2},
                    "difficulty": {"ben": 1},
                    "tool": "driver",
                },
                "2": {
                    "time": {"ur": 2},
                    "together": [
                        {"operators": ["ben", "ur"], "time": 1},
                        {"operators": ["anna", "ur"], "time": 1, "stress": {"anna": 1}},
                    ],
                },
            },
            "tools": {"driver": {"changeover": {"ben": 2, "anna": 1}}},
        }
    )
    left = variant(cell, without=["ben"])
    assert "ben" not in str(left.to_dict())
    assert left.to_dict()["tasks"]["2"]["together"] == [
        {"operators": ["anna", "ur"], "time": 1, "stress": {"anna": 1}}
    ]


def test_force_leaves_one_way(thesis: Cell) -> None:
    assert dict(variant(thesis, force=["5=human"]).tasks["5"].time) == {"human": 2.0}


def test_force_a_joint_way() -> None:
    cell = Cell.model_validate(
        {
            "operators": {"anna": {"kind": "human"}, "ur": {"kind": "robot"}},
            "tasks": {
                "1": {"time": {"ur": 2}, "together": [{"operators": ["anna", "ur"], "time": 1}]}
            },
        }
    )
    forced = variant(cell, force=["1=ur+anna"])
    assert [mode.operators for mode in forced.modes("1")] == [("anna", "ur")]


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"sets": ["tasks.66.time.robot=8"]}, "no task '66'. Did you mean '6'"),
        ({"sets": ["tasks.6"]}, "write PATH=VALUE"),
        ({"sets": ["tasks.6.deadline=-10%"]}, "changes a number, but nothing stands there"),
        ({"sets": ["tasks.7.after.9=1"]}, "has 6 entries, counted from 0"),
        ({"sets": ["name.x=1"]}, "and has no 'x'"),
        ({"without": ["robo"]}, "Did you mean 'robot'"),
        ({"force": ["5=bob"]}, "no operator 'bob'"),
        ({"force": ["55=human"]}, "no task '55'. Did you mean '5'"),
        ({"force": ["4=human"]}, "human cannot do task '4'. It can be done by robot"),
        ({"force": ["5"]}, "write TASK=OPERATOR"),
    ],
)
def test_what_cannot_be_asked(thesis: Cell, asked: dict[str, list[str]], message: str) -> None:
    with pytest.raises(UsageError) as caught:
        variant(thesis, **asked)
    assert message in str(caught.value)


def test_everything_that_is_wrong_is_told_at_once(thesis: Cell) -> None:
    with pytest.raises(UsageError) as caught:
        variant(thesis, sets=["nonsense", "tasks.9.stress=1"], without=["nobody"])
    assert str(caught.value).count("\n") == 2


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"without": ["robot"]}, "task '4': nobody can do it"),
        ({"sets": ["tasks.6.time.robot=0"]}, "time of 'robot' is 0"),
        ({"sets": ["tasks.6.tme=3"]}, "Did you mean 'time'"),
        ({"sets": ["tasks.1.after=[7]"]}, "circle|wait for each other"),
    ],
)
def test_a_variant_that_is_no_sound_cell(
    thesis: Cell, asked: dict[str, list[str]], message: str
) -> None:
    with pytest.raises(CellError, match=message):
        variant(thesis, **asked)


def test_an_operator_who_is_left_out_leaves_no_ways_and_tools_behind() -> None:
    pump = load("examples/pump.yaml")
    left = variant(pump, without=["cobot"])
    assert left.walk.keys() == {"anna"}
    assert left.tasks["screws"].tool == {"anna": "screwdriver"}
    assert left.tasks["gears"].tool is None
    assert left.tasks["cover"].together == ()


def test_places_that_only_the_operator_had_are_left_out_with_it() -> None:
    pump = load("examples/pump.yaml")
    data = pump.to_dict()
    data["operators"]["cobot"]["place"] = "dock"
    far = {"dock-bench": 9, "dock-fixture": 9, "press-dock": 9}
    data["walk"] = {"anna": {"bench-fixture": 3, "press-bench": 3, "press-fixture": 3, **far}}
    left = variant(cell_of(data), without=["cobot"])
    assert left.walk["anna"].keys() == {"bench-fixture", "press-bench", "press-fixture"}


def test_ways_and_places_can_be_set() -> None:
    pump = load("examples/pump.yaml")
    assert variant(pump, ["walk.anna.speed=2"]).walking["anna"]["bench", "press"] == 2.5
    assert variant(pump, ["tasks.seal.place=press"]).tasks["seal"].place == "press"
    assert variant(pump, ["tasks.screws.tool.cobot=drill"]).tasks["screws"].tool == {
        "anna": "screwdriver",
        "cobot": "drill",
    }
