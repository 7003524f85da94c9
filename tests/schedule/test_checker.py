"""The checker finds whatever is wrong with a schedule, and nothing in a sound one."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from decimal import Decimal

import pytest
from tests.effort import calls
from tests.schedule.cells import (
    GEARBOX,
    GEARBOX_PLAN,
    gearbox,
    gearbox_schedule,
    glued,
    glued_schedule,
    schedule,
    thesis,
    thesis_schedule,
)

from tandem.cell.model import Cell
from tandem.schedule.checker import RULES, Judged, faults
from tandem.schedule.model import Assignment, Schedule

COBOT, ANNA, BEN = ("cobot",), ("anna",), ("ben",)


def test_a_sound_schedule_has_no_faults():
    assert faults(thesis(), thesis_schedule()) == []
    assert faults(gearbox(), gearbox_schedule()) == []


DAMAGE = {
    "times that are no numbers": ({"label": (ANNA, math.nan, 7.5)}, r"'label'.*nan.*no time"),
    "an endless task": ({"pack": (COBOT, 15, math.inf)}, r"'pack'.*inf.*no time"),
    "an unknown operator": ({"label": (("anne",), 6.5, 7.5)},
    r"'label'.*no operator 'anne'. Did you mean 'anna'\?"),
    "an operator named twice": ({"label": (("anna", "anna"), 6.5, 7.5)},
    r"'label'.*'anna' is named 2 times"),
    "nobody": ({"label": ((), 6.5, 7.5)}, r"'label': nobody does it; anna or ben can"),
    "an operator who cannot": ({"label": (COBOT, 9, 10)},
    r"'label': cobot cannot do it; anna or ben can"),
    "half a group": ({"gears": (ANNA, 3.5, 6.5)}, r"'gears': anna cannot do it; anna and ben can"),
    "a wrong duration": ({"label": (ANNA, 6.5, 7)},
    r"'label': anna cannot do it in 0.5 s \(6.5 to 7 s\); it takes 1 s, so it would end at 7.5 s"),
    "a negative duration": ({"label": (ANNA, 7.5, 6.5)}, r"'label': anna cannot do it in -1 s"),
    "a start before zero": ({"housing": (COBOT, -1, 3)}, r"'housing': starts at -1 s"),
    "a missed predecessor": ({"cover": (BEN, 6.25, 10.25)},
    r"'cover': starts at 6.25 s, before task 'gears'.*6.5 s is the earliest"),
    "two tasks at once": ({"label": (BEN, 7, 8)},
    r"'ben': does task 'cover' \(6.5 to 10.5 s\) and task 'label' \(7 to 8 s\).*10.5 s is"),
    "a start before the release": ({"shaft": (ANNA, 0.5, 3)},
    r"'shaft': starts at 0.5 s, before its release: 1 s is the earliest"),
    "a missed deadline": ({"screws": (COBOT, 10.5, 12.5)},
    r"'screws': ends at 12.5 s, after its deadline: 12 s"),
    "work in a break": ({"pack": (COBOT, 11, 14)},
    r"'cobot': task 'pack' \(11 to 14 s\) runs into the break from 12 s to 14 s"),
    "a changeover too short": ({"screws": (COBOT, 6.5, 8.5)},
    r"'cobot': needs 3 s.*'driver'.*'screws'.*2.5 s after task 'housing'; 7 s is the earl"),
    "a changeover in a break": ({"pack": (COBOT, 14, 17)},
    r"'cobot': needs 1 s.*'gripper'.*13 s to 14 s.*break from 12 s to 14 s; after it, 15 s"),
    "a pair apart": ({"check": (ANNA, 10.5, 12.5)},
    r"'cover' and 'check': must be done by the same operators, but ben and anna"),
}  # fmt: skip


@pytest.mark.parametrize("what", DAMAGE)
def test_each_damage_is_said(what):
    rows, sentence = DAMAGE[what]
    found = faults(gearbox(), gearbox_schedule(**rows))
    assert any(re.search(sentence, fault) for fault in found), found


@pytest.mark.parametrize(
    ("rows", "sentence"),
    [
        (
            {"glue": (COBOT, 61, 66)},
            r"'press': starts at 100 s, 34 s after task 'glue' has ended, and must wait 40 s at"
            r" least: 106 s is the earliest",
        ),
        (
            {"glue": (COBOT, 0, 5)},
            r"'press': starts at 100 s, 95 s after task 'glue' has ended, and must start within"
            r" 60 s: 65 s is the latest",
        ),
        (
            {"cool": (COBOT, 103, 109)},
            r"'cool': starts at 103 s, 3 s after task 'press' has started, and must wait 4 s",
        ),
        (
            {"cool": (COBOT, 110, 116)},
            r"'cool': starts at 110 s, 10 s after task 'press' has started.* 109 s is the latest",
        ),
        (
            {"cool": (COBOT, 90, 96)},
            r"'cool': starts at 90 s, before task 'press' has started.*104 s is the earliest",
        ),
        (
            {"glue": (COBOT, 98, 103)},
            r"'press': starts at 100 s, before task 'glue' has ended, which it comes after",
        ),
    ],
)
def test_a_wait_that_is_too_short_or_too_long_is_said(rows, sentence):
    assert faults(glued(), glued_schedule()) == []
    found = faults(glued(), glued_schedule(**rows))
    assert len([fault for fault in found if re.search(sentence, fault)]) == 1, found


def test_missing_double_and_unknown_tasks_are_said():
    rows = [a for a in gearbox_schedule() if a.task != "label"]
    found = faults(gearbox(), Schedule((*rows, rows[0], Assignment(7, 8, "lable", ANNA))))
    assert "task 'lable': the cell has no such task. Did you mean 'label'?" in found
    assert "task 'label': is missing; every task must be done once." in found
    assert any("'housing': is done 2 times" in fault for fault in found)


def test_an_empty_schedule_misses_every_task():
    assert len(faults(gearbox(), Schedule(()))) == len(GEARBOX["tasks"])


def test_a_stress_limit_is_judged_by_the_human_s_own_stress():
    tight = {**GEARBOX["operators"], "anna": {"kind": "human", "stress_limit": 4.3}}
    assert faults(gearbox(operators=tight), gearbox_schedule()) == [
        "operator 'anna': collects 4.4 of stress, the limit is 4.3; 0.1 must go (most from 'shaft'"
        " 3, 'gears' 1.1, 'label' 0.3)."
    ]
    assert (
        faults(
            gearbox(operators={**tight, "anna": {"kind": "human", "stress_limit": 4.4}}),
            gearbox_schedule(),
        )
        == []
    )


def test_a_crowded_zone_and_a_tool_in_too_many_hands_are_said():
    narrow = gearbox(
        zones={},
        tasks={
            **GEARBOX["tasks"],
            "gears": {**GEARBOX["tasks"]["gears"], "zone": None},
            "label": {**GEARBOX["tasks"]["label"], "zone": "jig"},
        },
    )
    assert faults(narrow, gearbox_schedule()) == [
        "zone 'jig': there is only 1 place, but 2 operators need it at once from 6.5 s to 7.5 s"
        " (tasks 'label' and 'cover')."
    ]
    tools = {**GEARBOX["tasks"], "label": {**GEARBOX["tasks"]["label"], "tool": "driver"}}
    moved = gearbox_schedule(label=(ANNA, 7, 8))
    assert faults(gearbox(tasks=tools), moved) == [
        "tool 'driver': there is only 1 of it, but 2 operators need it at once from 7 s to 8 s"
        " (tasks 'label' and 'screws')."
    ]
    assert (
        faults(
            gearbox(
                tasks=tools,
                tools={**GEARBOX["tools"], "driver": {**GEARBOX["tools"]["driver"], "capacity": 2}},
            ),
            moved,
        )
        == []
    )


def test_touching_is_not_overlapping():
    cell = Cell.model_validate(
        {
            "operators": {"cobot": {"kind": "robot", "breaks": [[1, 2]]}},
            "tasks": {
                "a": {"time": {"cobot": 1}, "zone": "z", "tool": "t"},
                "b": {"time": {"cobot": 1}, "zone": "z", "tool": "t", "release": 2, "deadline": 3},
            },
        }
    )
    assert faults(cell, schedule({"a": (COBOT, 0, 1), "b": (COBOT, 2, 3)})) == []


def test_tenths_add_up_exactly():
    """0.1 + 0.2 ends at 0.3, though the floats say otherwise."""
    cell = Cell.model_validate(
        {
            "operators": {"cobot": {"kind": "robot"}},
            "tasks": {"a": {"time": {"cobot": 0.1}}, "b": {"time": {"cobot": 0.2}, "after": ["a"]}},
        }
    )
    assert faults(cell, schedule({"a": (COBOT, 0, 0.1), "b": (COBOT, 0.1, 0.3)})) == []
    assert (
        "it takes 0.2 s"
        in faults(cell, schedule({"a": (COBOT, 0, 0.1), "b": (COBOT, 0.1, 0.1 + 0.2)}))[0]
    )


def test_a_first_tool_costs_nothing_unless_another_is_in_hand():
    tasks = {"a": {"time": {"cobot": 2}, "tool": "driver"}}
    tools = {"driver": {"changeover": {"cobot": 3}}}
    start = schedule({"a": (COBOT, 0, 2)})
    assert (
        faults(
            Cell.model_validate(
                {"operators": {"cobot": {"kind": "robot"}}, "tools": tools, "tasks": tasks}
            ),
            start,
        )
        == []
    )
    held = Cell.model_validate(
        {
            "operators": {"cobot": {"kind": "robot", "tool": "gripper"}},
            "tools": tools,
            "tasks": tasks,
        }
    )
    assert faults(held, start) == [
        "operator 'cobot': needs 3 s to take up tool 'driver' before task 'a', which starts only 0"
        " s after the beginning; 3 s is the earliest."
    ]
    assert faults(held, schedule({"a": (COBOT, 3, 5)})) == []


def test_tasks_without_a_tool_leave_the_tool_in_hand():
    tools = {"driver": {"changeover": {"cobot": 3}}}
    tasks = {
        "a": {"time": {"cobot": 1}, "tool": "driver"},
        "b": {"time": {"cobot": 1}},
        "c": {"time": {"cobot": 1}, "tool": "driver"},
    }
    cell = Cell.model_validate(
        {"operators": {"cobot": {"kind": "robot"}}, "tools": tools, "tasks": tasks}
    )
    assert (
        faults(cell, schedule({"a": (COBOT, 0, 1), "b": (COBOT, 1, 2), "c": (COBOT, 2, 3)})) == []
    )


def test_a_set_that_the_table_does_not_list_is_said():
    cell = thesis().replace(stress_of_set={"3,5,6": 7, "3": 1})
    assert faults(cell, thesis_schedule()) == []
    assert faults(cell.replace(stress_of_set={"3": 1}), thesis_schedule()) == [
        "stress_of_set does not list '3,5,6', the tasks that humans do here: this set of tasks is"
        " not allowed."
    ]


def test_limits_are_judged_when_given():
    assert faults(thesis(), thesis_schedule(), max_makespan=23, max_stress=7) == []
    assert faults(thesis(), thesis_schedule(), max_makespan=22.9, max_stress=6.9) == [
        "task '7': ends at 23 s, after the limit on the makespan of 22.9 s.",
        "stress: is 7, over its limit of 6.9.",
    ]
    assert faults(
        thesis().replace(stress_of_set={"3,5,6": 4}), thesis_schedule(), max_stress=3
    ) == ["stress: is 4, over its limit of 3."]


def test_all_faults_are_said_at_once():
    broken = gearbox_schedule(
        housing=(BEN, -1, 3), screws=(("bob",), 3, 9), shaft=(COBOT, 0, 1), check=(ANNA, 2, 12.5)
    )
    named = {rule.__name__ for rule in RULES if list(rule(Judged.of(gearbox(), broken)))}
    assert named >= {
        "operators_are_known", "the_group_can_do_the_task", "durations_are_right",
        "nothing_starts_before_zero", "predecessors_end_first",
        "an_operator_does_one_task_at_a_time", "releases_are_kept", "pairs_have_the_same_operators",
    }  # fmt: skip


def test_garbage_is_judged_and_not_stumbled_over():
    rows = [
        Assignment(start, end, task, who)
        for start in (math.nan, -math.inf, 1e308, 0.0)
        for end in (5e-324, math.inf)
        for task, who in (("label", ANNA), ("", ()))
    ]
    assert len(faults(gearbox(), Schedule(tuple(rows)))) > len(rows)


@pytest.mark.parametrize("heaped", [False, True], ids=["a plan", "a heap"])
def test_twice_the_tasks_take_at_most_three_times_the_looks(heaped: bool):
    effort = []
    for size in (100, 200):
        cell, rows = crowded(size)
        schedule = Schedule(tuple(replace(a, start=0.0, end=1.5) if heaped else a for a in rows))
        assert (faults(cell, schedule) == []) is not heaped
        effort.append(calls(lambda cell=cell, plan=schedule: faults(cell, plan)))
    assert effort[1] < 3 * effort[0]


def crowded(size: int) -> tuple[Cell, list[Assignment]]:
    """So many tasks of four humans, with chains, a zone, tools and breaks; and a sound plan."""
    names = [f"t{index}" for index in range(size)]
    tasks = {
        name: {
            "time": dict.fromkeys("abcd", 1.5),
            "stress": 0.1,
            "after": names[max(0, index - 4) : max(0, index - 3)],
            "zone": "z",
            "tool": "xy"[index % 2],
        }
        for index, name in enumerate(names)
    }
    cell = Cell.model_validate(
        {
            "operators": {name: {"kind": "human", "breaks": [[900, 901]]} for name in "abcd"},
            "tasks": tasks,
            "zones": {"z": {"capacity": 4}},
            "tools": {"x": {"capacity": 4}, "y": {"capacity": 4}},
        }
    )
    rounds = [(index // 4 * 1.5, "abcd"[index % 4]) for index in range(size)]
    return cell, [
        Assignment(start, start + 1.5, name, (who,))
        for (start, who), name in zip(rounds, names, strict=True)
    ]


def test_every_rule_has_been_seen_to_fire():
    """The damages above, together, wake every rule of the checker; a new rule needs its damage."""
    fired = set()
    cells = [(gearbox(), gearbox_schedule(**rows)) for rows, _ in DAMAGE.values()]
    cells += [
        (gearbox(), Schedule((Assignment(0, 1, "nothing", ANNA),))),
        (thesis().replace(stress_of_set={"3": 1}), thesis_schedule()),
    ]
    zones = {
        name: {**task, "zone": "jig", "tool": "driver"} for name, task in GEARBOX["tasks"].items()
    }
    cells.append(
        (
            gearbox(
                tasks=zones,
                zones={"jig": {"capacity": 2, "apart": ["human", "robot"]}},
                tools={"driver": {"capacity": 2}},
            ),
            gearbox_schedule(),
        )
    )
    cells.append(
        (
            gearbox(
                operators={
                    **GEARBOX["operators"],
                    "anna": {"kind": "human", "stress_limit": 0, "limits": {"peak:stress": 0}},
                }
            ),
            gearbox_schedule(),
        )
    )
    cells.append((glued(), glued_schedule(glue=(COBOT, 0, 5))))
    holding = {"kind": "machine", "holds": [["screws", "pack"]], "tool": "gripper"}
    machine = {**GEARBOX["operators"], "cobot": holding}
    cells.append((gearbox(operators=machine), gearbox_schedule(housing=(COBOT, 8, 12))))
    for cell, plan in cells:
        judged = Judged.of(cell, plan, max_makespan=1, max_stress=float(Decimal("0.1")))
        fired |= {rule for rule in RULES if list(rule(judged))}
    assert fired == set(RULES)
    assert set(GEARBOX_PLAN) == set(GEARBOX["tasks"])
