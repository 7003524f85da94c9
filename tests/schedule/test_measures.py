"""What a schedule is worth, to the last decimal."""

from __future__ import annotations

import pytest
from tests.schedule.cells import gearbox, gearbox_schedule, schedule, thesis, thesis_schedule

from tandem.cell.model import Cell
from tandem.errors import UnsoundScheduleError
from tandem.schedule.measures import (
    Changeover,
    changeovers,
    difficulty,
    idle,
    makespan,
    mode_of,
    peak_stress,
    stress,
    stress_by_human,
    utilisation,
    working,
)
from tandem.schedule.model import Assignment, Schedule


def test_the_thesis_s_second_run_takes_23_s_and_7_of_stress():
    cell, plan = thesis(), thesis_schedule()
    assert (makespan(plan), stress(cell, plan), peak_stress(cell, plan)) == (23, 7, 4)
    assert stress_by_human(cell, plan) == {"human": 7}
    assert working(cell, plan) == {"robot": 20, "human": 15}
    assert idle(cell, plan) == {"robot": 3, "human": 8}
    assert utilisation(cell, plan) == {"robot": 20 / 23, "human": 15 / 23}


def test_joint_tasks_put_stress_on_each_human_and_sums_are_exact():
    cell, plan = gearbox(), gearbox_schedule()
    assert stress_by_human(cell, plan) == {"anna": 4.4, "ben": 4.7}
    assert stress(cell, plan) == 9.1
    assert peak_stress(cell, plan) == 4
    assert difficulty(cell, plan) == 0.1


def test_ten_tenths_are_one():
    cell = Cell.model_validate(
        {
            "operators": {"anna": {"kind": "human"}},
            "tasks": {name: {"time": {"anna": 0.1}, "stress": 0.1} for name in "abcdefghij"},
        }
    )
    plan = schedule(
        {name: (("anna",), place / 10, (place + 1) / 10) for place, name in enumerate("abcdefghij")}
    )
    assert (makespan(plan), stress(cell, plan), working(cell, plan)) == (1.0, 1.0, {"anna": 1.0})


def test_breaks_and_changeovers_are_not_idle_time():
    cell, plan = gearbox(), gearbox_schedule()
    assert changeovers(cell, plan) == (
        Changeover("cobot", "driver", "screws", 4, 7),
        Changeover("cobot", "gripper", "pack", 14, 15),
    )
    assert working(cell, plan) == {"cobot": 9, "anna": 6.5, "ben": 9}
    assert idle(cell, plan) == {"cobot": 18 - 9 - 4 - 2, "anna": 11.5, "ben": 9}


def test_a_table_of_sets_replaces_the_sum():
    cell = thesis().replace(stress_of_set={"3,5,6": 2.5, "3": 1})
    assert stress(cell, thesis_schedule()) == 2.5
    with pytest.raises(UnsoundScheduleError, match=r"'3,5,6'.*not allowed"):
        stress(thesis().replace(stress_of_set={"3": 1}), thesis_schedule())


def test_what_is_no_way_of_doing_a_task_has_no_stress():
    with pytest.raises(UnsoundScheduleError, match="'3': robot from 0 s to 10 s is no way"):
        stress(thesis(), Schedule((Assignment(0, 10, "3", ("robot",)),)))


def test_the_mode_is_found_by_operators_and_exact_duration():
    cell = gearbox()
    assert mode_of(cell, Assignment(0.1, 2.6, "shaft", ("anna",))) == cell.modes("shaft")[0]
    assert mode_of(cell, Assignment(0, 2, "shaft", ("anna",))) is None
    assert mode_of(cell, Assignment(3, 6, "gears", ("ben", "anna"))) == cell.modes("gears")[0]
    assert mode_of(cell, Assignment(0, 2, "gear", ("anna",))) is None


def test_an_empty_schedule_is_worth_nothing():
    empty = Schedule(())
    assert (makespan(empty), stress(thesis(), empty), peak_stress(thesis(), empty)) == (0, 0, 0)
    assert utilisation(thesis(), empty) == {"robot": 0, "human": 0}
