"""Schedules of cells in which operators get ready first: what breaks that, and what it explains."""

from __future__ import annotations

import pytest

from tandem.cell.model import Cell
from tandem.files.validate import cell_of
from tandem.schedule.checker import faults
from tandem.schedule.critical import critical_path, links, slack
from tandem.schedule.measures import changing, idle
from tandem.schedule.model import Assignment, Schedule


def bench() -> Cell:
    """Anna has a break from 3 to 5 s, so her 4 s of setting up end at 9 s; she holds the wrong
    tool.
    """
    return cell_of({
        "operators": {
            "anna": {"kind": "human", "setup": 4, "breaks": [[3, 5]], "tool": "file"},
            "cobot": {"kind": "robot", "setup": 1.5},
            "ben": {"kind": "human", "setup": 50},
        },
        "tools": {"driver": {"changeover": {"anna": 2}}},
        "tasks": {
            "base": {"time": {"cobot": 2}},
            "screw": {"time": {"anna": 3, "ben": 3}, "tool": "driver"},
            "lift": {"together": [{"operators": ["anna", "cobot"], "time": 1}]},
        },
    })  # fmt: skip


def planned(base: float = 1.5, screw: float = 11, lift: float = 14) -> Schedule:
    rows = (
        ("base", base, 2, ("cobot",)),
        ("screw", screw, 3, ("anna",)),
        ("lift", lift, 1, ("anna", "cobot")),
    )
    return Schedule(
        tuple(Assignment(start, start + long, task, who) for task, start, long, who in rows)
    )


def test_work_right_behind_the_setup_and_the_changeover_is_sound() -> None:
    assert faults(bench(), planned()) == []


@pytest.mark.parametrize(
    ("rows", "sentence"),
    [
        (
            {"base": 1},
            "operator 'cobot': does task 'base' (1 to 3 s) before it is set up, which takes 1.5 s "
            "between its breaks; 1.5 s is the earliest.",
        ),
        (
            {"lift": 8},
            "operator 'anna': does task 'lift' (8 to 9 s) before it is set up, which takes 4 s "
            "between its breaks; 9 s is the earliest.",
        ),
        (
            {"screw": 10.5},
            "operator 'anna': needs 2 s to take up tool 'driver' before task 'screw', which starts "
            "only 1.5 s after it is set up; 11 s is the earliest.",
        ),
    ],
)
def test_what_is_too_early_is_said(rows: dict[str, float], sentence: str) -> None:
    assert faults(bench(), planned(**rows)) == [sentence]


def test_the_critical_path_begins_with_the_setup() -> None:
    cell, plan = bench(), planned()
    assert [(link.assignment.task, link.reason, link.by) for link in critical_path(cell, plan)] == [
        ("screw", "setup", "anna"),
        ("lift", "operator", "anna"),
    ]
    assert str(critical_path(cell, plan)[0]) == "screw at 11 s, when anna is set up"
    assert [link.reason for link in links(cell, plan)["base"]] == ["setup"]
    assert slack(cell, plan) == {"base": 10.5, "screw": 0, "lift": 0}


def test_setting_up_is_no_idling_and_who_does_nothing_needs_none() -> None:
    cell, plan = bench(), planned()
    assert changing(cell, plan) == {"anna": 6, "cobot": 1.5, "ben": 0}
    assert idle(cell, plan) == {"anna": 3, "cobot": 10.5, "ben": 15}
