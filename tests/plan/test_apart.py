"""Zones that keep kinds of operators apart: people share them, a person and a robot do not."""

from __future__ import annotations

from typing import Any

import pytest
from tests.plan.brute_force import front_of_all
from tests.plan.test_judges import fixture

from tandem.cell.model import Cell
from tandem.errors import CellError
from tandem.files.validate import cell_of
from tandem.plan.infeasible import infeasible
from tandem.plan.methods import METHODS
from tandem.plan.question import Question
from tandem.schedule.checker import faults
from tandem.schedule.critical import critical_path
from tandem.schedule.model import Assignment, Schedule
from tandem.world.replay import replay


def mixed(start: float) -> Schedule:
    """Anna from 0 to 4 s, Ben beside her, the robot from then on."""
    return Schedule(
        (
            Assignment(0, 4, "left", ("anna",)),
            Assignment(0, 3, "right", ("ben",)),
            Assignment(start, start + 5, "weld", ("cobot",)),
        )
    )


@pytest.mark.parametrize("method", sorted(METHODS))
def test_people_share_the_zone_and_the_robot_waits_until_they_are_out(method: str) -> None:
    front = METHODS[method](fixture(), Question("makespan"))
    assert front.points == [(9.0, 0.0)] == front_of_all(fixture().to_dict())
    result = front[0]
    assert faults(fixture(), result.schedule) == []
    assert replay(fixture(), result.schedule) == 9


def test_the_checker_says_who_is_in_it_at_once() -> None:
    assert faults(fixture(), mixed(4)) == []
    assert faults(fixture(), mixed(3)) == [
        "zone 'fixture': keeps human and robot apart, but 'anna' (task 'left', 0 to 4 s) and"
        " 'cobot' (task 'weld', 3 to 8 s) are in it at once; 4 s is the earliest."
    ]


def test_who_is_not_named_minds_nobody() -> None:
    zones = {"fixture": {"capacity": 3, "apart": ["human", "machine"]}}
    cell = cell_of({**fixture().to_dict(), "zones": zones})
    assert faults(cell, mixed(0)) == []


def test_the_critical_path_says_whom_it_waits_for() -> None:
    assert [str(link) for link in critical_path(fixture(), mixed(4))] == [
        "left at 0 s, from the start",
        "weld at 4 s, when left leaves zone fixture",
    ]


def alone(**zone: Any) -> dict[str, Any]:
    return {
        "operators": {"anna": {"kind": "human"}, "cobot": {"kind": "robot"}},
        "tasks": {
            "lift": {"together": [{"operators": ["anna", "cobot"], "time": 4}], "zone": "bench"}
        },
        "zones": {"bench": {"capacity": 2, **zone}},
    }


@pytest.mark.parametrize(
    ("zone", "says"),
    [
        (
            {"apart": ["human", "robot"]},
            "task 'lift': 'anna' and 'cobot' can only do it together, but zone 'bench' keeps human"
            " and robot apart, so they never meet. Take the task out of the zone, let one operator"
            " do it alone, or take `apart` out.",
        ),
        (
            {"apart": ["human"]},
            "zone 'bench': keeps only 'human' apart, and from nobody. Name two kinds or more, such"
            " as `apart: [human, robot]`, or leave it out.",
        ),
        (
            {"apart": ["human", "machine", "human"]},
            "zone 'bench': `apart` names 'human' twice. Name each once.",
        ),
        ({"apart": "human"}, "apart is the text 'human', but a list is needed"),
        ({"apart": ["human", "robbot"]}, "Did you mean 'robot'?"),
    ],
)
def test_what_is_wrong_with_it_is_said(zone: dict[str, Any], says: str) -> None:
    with pytest.raises(CellError) as caught:
        cell_of(alone(**zone))
    [fault] = caught.value.faults
    assert says in fault.message


def test_a_group_of_both_does_it_where_nobody_is_kept_apart_and_else_one_alone() -> None:
    data = alone(apart=["human", "robot"])
    data["tasks"]["lift"]["time"] = {"anna": 9}
    front = METHODS["exact"](cell_of(data), Question("makespan"))
    assert [row.operators for row in front[0].schedule] == [("anna",)]


def too_tight() -> Cell:
    data = fixture().to_dict()
    for task in data["tasks"].values():
        task["deadline"] = 8
    return cell_of(data)


def test_a_cell_that_has_no_plan_for_it_is_told_so() -> None:
    said = infeasible("", too_tight(), Question()).reasons
    assert "that zone fixture keeps human and robot apart" in said[0]
    assert (
        "Without that zone fixture keeps human and robot apart it works: 7 s with a stress of 0."
        in said
    )
