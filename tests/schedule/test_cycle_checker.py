"""The checker of periodic schedules finds nothing in a sound pattern, and whatever is wrong with
another.
"""

from __future__ import annotations

import math
import re
from dataclasses import replace
from random import Random

import pytest
from tests.fuzz.cycles import drawn, is_run_in
from tests.schedule.cells import thesis

import tandem
from tandem.cell.model import Cell
from tandem.errors import CellError, InfeasibleError, NothingFoundError
from tandem.files.validate import cell_of
from tandem.plan.cycle.methods import plan_cycle
from tandem.schedule import checker
from tandem.schedule.cycle import PeriodicSchedule, copied, start_up
from tandem.schedule.cycle_checker import faults, not_periodic
from tandem.schedule.model import Assignment, Schedule

PRESS = {
    "operators": {"anna": {"kind": "human"}, "cobot": {"kind": "robot"}},
    "tools": {"driver": {"changeover": {"cobot": 2}}, "gripper": {"changeover": {"cobot": 1}}},
    "zones": {"bench": {}},
    "tasks": {
        "place": {"time": {"cobot": 3}, "tool": "gripper", "zone": "bench"},
        "screw": {"time": {"cobot": 4}, "tool": "driver", "after": ["place"]},
        "check": {"time": {"anna": 5}, "after": ["screw"], "zone": "bench", "stress": 1},
    },
}
"""The cobot has 10 s to do in a cycle, changeovers with it."""


def pattern(cycle_time: float, **starts: float) -> PeriodicSchedule:
    """`place` and `screw` by the cobot, `check` by Anna."""
    ticks = {"place": 3, "screw": 4, "check": 5}
    who = {"place": "cobot", "screw": "cobot", "check": "anna"}
    return PeriodicSchedule(
        Schedule(
            tuple(
                Assignment(start, start + ticks[task], task, (who[task],))
                for task, start in starts.items()
            )
        ),
        cycle_time,
    )


@pytest.fixture
def press() -> Cell:
    return cell_of(PRESS)


def test_a_sound_pattern_has_no_faults(press: Cell):
    sound = pattern(10, place=0, screw=5, check=13)
    assert faults(press, sound) == []
    assert (sound.makespan, sound.in_process, sound.position(13), sound.lap(13)) == (18, 2, 3, 1)
    assert not any(checker.faults(copied(press, 5), sound.products(5, start_up(press))))


DAMAGE = {
    "a cycle shorter than the work": (
        pattern(8, place=0, screw=5, check=11),
        r"'cobot'.*'place' \(0 to 3 s of the cycle\).*'screw' \(5 to 1 s of the next\)",
    ),
    "a changeover around the cycle": (
        pattern(9, place=0, screw=5, check=13),
        r"'cobot': needs 1 s to take up tool 'gripper' before task 'place'.*only 0 s after",
    ),
    "a changeover within the cycle": (
        pattern(10, place=0, screw=4, check=13),
        r"'cobot': needs 2 s.*'driver' before task 'screw' \(4 to 8 s of the cycle\).*only 1 s",
    ),
    "a zone that another product fills": (
        pattern(10, place=0, screw=5, check=9),
        r"zone 'bench'.*2 operators need it at once at 0 s of the cycle \(tasks '.*' and '.*'\)",
    ),
    "a missed predecessor": (
        pattern(10, place=0, screw=5, check=3),
        r"'check': starts at 3 s, before task 'screw' has ended",
    ),
    "a task longer than the cycle": (
        pattern(4, place=0, screw=3.5, check=8),
        r"'anna': does task 'check' for 5 s, longer than the cycle of 4 s",
    ),
    "a missing task": (pattern(10, place=0, screw=5), r"'check': is missing"),
    "a cycle time of nothing": (pattern(0, place=0, screw=5, check=13), r"cycle time of 0 s"),
    "a cycle time of no number": (pattern(math.nan, place=0, screw=5, check=13), r"of nan s"),
}


@pytest.mark.parametrize("damage", DAMAGE)
def test_damage_is_found(press: Cell, damage: str):
    broken, said = DAMAGE[damage]
    assert any(re.search(said, fault) for fault in faults(press, broken)), faults(press, broken)


def test_limits_are_kept(press: Cell):
    sound = pattern(10, place=0, screw=5, check=13)
    assert faults(press, sound, max_in_process=2, max_cycle_time=10, max_stress=1) == []
    assert "2 are in process" in faults(press, sound, max_in_process=1)[0]
    assert "over its limit of 9.5 s" in faults(press, sound, max_cycle_time=9.5)[0]
    assert "over its limit of 0.5" in faults(press, sound, max_stress=0.5)[0]


def test_fixed_times_cannot_repeat():
    data = thesis().to_dict()
    data["tasks"]["1"]["release"], data["tasks"]["2"]["deadline"] = 2, 30
    places = [place for place, _ in not_periodic(cell_of(data))]
    assert places == [("tasks", "1", "release"), ("tasks", "2", "deadline")]


def test_a_pattern_is_sound_when_its_products_are_on_one_clock():
    """The checker of schedules is asked for many products: they break their cell just when the
    pattern does. A task is put elsewhere, or the cycle is made shorter or longer.
    """
    random, broken, sound = Random(1), 0, 0
    for seed in range(60):
        _, data = drawn(seed)
        for operator in data["operators"].values():
            operator.pop("stress_limit", None)  # a limit for each product is none for all of them
        data.pop("stress_of_set", None)
        try:
            cell = cell_of(data)
            front = plan_cycle(cell, time_limit=5, workers=1)
        except (CellError, InfeasibleError, NothingFoundError):
            continue
        for result in front:
            for changed in _changed(random, result.periodic):
                count = changed.in_process + 2
                many = changed.products(count, start_up(cell))
                on_one_clock = [
                    fault
                    for fault in checker.faults(copied(cell, count), many)
                    if not is_run_in(fault, changed.in_process)
                ]
                assert bool(faults(cell, changed)) == bool(on_one_clock), (seed, changed)
                broken += bool(on_one_clock)
                sound += not on_one_clock
    assert broken > 160
    assert sound > 80


def _changed(random: Random, periodic: PeriodicSchedule) -> list[PeriodicSchedule]:
    """The pattern with a task elsewhere, and at other cycle times."""
    rows = list(periodic)
    step = min(row.end - row.start for row in rows)
    changed = [
        replace(periodic, cycle_time=round(periodic.cycle_time + change, 6))
        for change in (-step / 2, step, 2 * step)
        if periodic.cycle_time + change > 0
    ]
    for row in random.sample(rows, min(2, len(rows))):
        start = round(max(0.0, row.start + random.choice((-2, -1, -0.5, 0.5, 1, 2)) * step), 6)
        moved = replace(row, start=start, end=round(start + row.end - row.start, 6))
        others = tuple(other for other in rows if other is not row)
        changed.append(replace(periodic, schedule=Schedule((*others, moved))))
    return changed


def test_the_same_pattern_has_the_same_digest():
    cell = tandem.load("examples/thesis.yaml")
    one, two = (plan_cycle(cell, workers=workers) for workers in (1, 2))
    assert [point.periodic.digest for point in one] == [point.periodic.digest for point in two]
    assert len({point.periodic.digest for point in one}) == len(one)
    later = replace(one[0].periodic, cycle_time=one[0].cycle_time + 1)
    assert later.digest != one[0].periodic.digest
