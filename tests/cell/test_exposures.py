"""What one execution puts on a human: facts of a cell, scored scale by scale and never mixed."""

from __future__ import annotations

from decimal import Decimal
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.strategies import cells

import tandem
from tandem.cell.assessed import doers
from tandem.cell.exposures import exposures, kind, scales
from tandem.cell.model import Cell
from tandem.ergonomics.methods import score
from tandem.errors import CellError, UsageError

PEOPLE = {"anna": {"kind": "human"}, "bob": {"kind": "human"}, "cobot": {"kind": "robot"}}
POSTURE = {
    "trunk": 45, "neck": 10, "upper arm": 30, "lower arm": 80, "wrist": 0, "knees": 0,
    "load": "5 kg", "grip": "good",
}  # fmt: skip


def cell(*assessments: dict[str, Any], time: dict[str, float] | None = None) -> Cell:
    """One task, by default for both people and the robot."""
    doers = time or {"anna": 3, "bob": 4, "cobot": 5}
    return Cell.model_validate(
        {"operators": PEOPLE, "tasks": {"a": {"time": doers, "ergonomics": list(assessments)}}}
    )


def test_facts_are_scored_by_their_method_for_every_human_who_can_do_it():
    found = exposures(cell({"method": "REBA", **POSTURE}))
    facts = {
        "trunk_flexion_deg": 45.0, "neck_flexion_deg": 10.0, "upper_arm_flexion_deg": 30.0,
        "lower_arm_flexion_deg": 80.0, "wrist_flexion_deg": 0.0, "knee_flexion_deg": 0.0,
        "load_kg": 5.0, "coupling": "good",
    }  # fmt: skip
    value = Decimal(repr(float(score("reba", facts).score or 0)))
    assert found == {"reba": {("a", "anna"): value, ("a", "bob"): value}}


def test_a_dose_is_that_of_one_execution():
    twice = {"method": "duet", "omni_res": 4, "reps_per_cycle": 2}
    once = {**twice, "reps_per_cycle": 1}
    two, one = exposures(cell(twice))["duet"], exposures(cell(once))["duet"]
    assert float(two["a", "anna"]) == pytest.approx(2 * float(one["a", "anna"]))
    day = score("duet", {"omni_res": 4, "reps": 840.0}).score
    assert float(two["a", "anna"]) * 420 == pytest.approx(day)


def test_sides_are_told_apart_and_the_worse_one_counts():
    found = exposures(
        cell(
            {"method": "duet", "score": 3, "side": "left"},
            {"method": "duet", "score": 5, "side": "right"},
            {"method": "duet", "score": 1, "side": "both"},
            {"method": "rula", "score": 3, "side": "left"},
            {"method": "rula", "score": 6, "side": "right"},
            time={"anna": 3},
        )
    )
    at = ("a", "anna")
    assert (found["duet-left"][at], found["duet-right"][at], found["duet"][at]) == (4, 6, 6)
    assert found["rula"][at] == 6
    assert "rula-left" not in found


def test_an_assessment_of_a_person_goes_before_that_of_everybody():
    found = exposures(
        cell({"method": "eaws", "score": 38}, {"method": "eaws", "score": 20, "operators": ["bob"]})
    )
    assert found == {"eaws": {("a", "anna"): 38, ("a", "bob"): 20}}


def test_movements_of_one_task_add_their_energy():
    lift = {"method": "energy", "score": 1.5}
    assert exposures(cell(lift, lift, time={"anna": 1})) == {"energy": {("a", "anna"): 3}}


def test_every_scale_is_of_a_kind():
    assert {scale for scale in scales() if kind(scale) == "dose"} == {
        "duet", "duet-left", "duet-right", "lifft", "energy",
        "shoulder_tool", "shoulder_tool-left", "shoulder_tool-right",
    }  # fmt: skip
    with pytest.raises(UsageError, match=r"no scale 'reab'.*'reba'"):
        kind("reab")


@pytest.mark.parametrize(
    ("assessment", "said"),
    [
        ({"method": "raba", "trunk": 3}, "no method 'raba'. Did you mean 'reba'"),
        ({"method": "eaws", "trunk": 3}, "EAWS is not computed here"),
        ({"method": "reba", "score": 16}, "whole numbers from 1 to 15"),
        ({"method": "reba", **POSTURE, "trunk": 400}, "is 400 degrees, but reba takes -45 to 150"),
        ({"method": "reba", **POSTURE, "load": -1}, "load_kg is -1"),
        ({"method": "reba", "trunk": 3}, "knee_flexion_deg is missing"),
        ({"method": "reba", **POSTURE, "omni_res": 3}, "Scales are not mixed"),
        ({"method": "reba", **POSTURE, "score": 12}, "the facts beside it come to"),
        ({"method": "duet", "omni_res": 3, "reps": 90}, "State reps_per_cycle instead"),
        ({"method": "duet", "omni_res": 3}, "reps_per_cycle is missing"),
        ({"method": "reba", "score": 3, "operators": ["cobot"]}, "'cobot', a robot"),
        ({"method": "reba", "score": 3, "operators": ["ann"]}, "Did you mean 'anna'"),
        ({"method": "niosh", "score": 1, "side": "left"}, "knows no left side"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_what_cannot_be_scored_is_refused_with_the_way_out(assessment: dict[str, Any], said: str):
    with pytest.raises(CellError) as caught:
        cell(assessment)
    assert any(said in fault.message for fault in caught.value.faults)
    assert all(fault.path[:4] == ("tasks", "a", "ergonomics", 0) for fault in caught.value.faults)


def test_a_method_is_stated_once_for_a_side_and_a_person():
    with pytest.raises(CellError, match="stated twice for 'bob'"):
        cell(
            {"method": "rsi", "score": 3, "operators": ["anna", "bob"]},
            {"method": "rsi", "score": 4, "operators": ["bob"]},
        )


@settings(max_examples=15, deadline=None)
@given(cells(rich=False, max_tasks=4), st.integers(1, 15))
def test_a_cell_is_planned_the_same_with_facts_as_without(plain: Cell, grade: int):
    """The key says what is known; where stress alone counts, it moves no schedule."""
    data = plain.to_dict()
    for name, task in data["tasks"].items():
        if doers(plain, name):
            task["ergonomics"] = [
                {"method": "reba", "score": grade},
                {"method": "duet", "omni_res": 3, "reps_per_cycle": 2},
            ]
    told = Cell.model_validate(data)
    for method in ("exhaustive", "exact"):
        fronts = [tandem.plan(one, method=method, time_limit=20) for one in (plain, told)]
        assert fronts[0].points == fronts[1].points
        assert [one.schedule for one in fronts[0]] == [one.schedule for one in fronts[1]]
        assert [fault for one in fronts[0] for fault in tandem.faults(told, one.schedule)] == []
