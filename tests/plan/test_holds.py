"""Machines that hold a part from one task to another: nothing else is done there meanwhile."""

from __future__ import annotations

from random import Random
from typing import Any

import pytest
from tests.cell.test_machines import press
from tests.fuzz.judges import drawn
from tests.plan.brute_force import front_in_order, front_of_all
from tests.plan.test_judges import two_parts

from tandem.cell.model import Cell
from tandem.errors import CellError, InfeasibleError, NothingFoundError
from tandem.files.validate import cell_of
from tandem.plan.infeasible import conflict
from tandem.plan.instance import Instance, bits
from tandem.plan.list_scheduling import Layout
from tandem.plan.methods import METHODS, plan
from tandem.plan.question import Question
from tandem.plan.rules import RULES, SPECS, build
from tandem.schedule.checker import faults
from tandem.schedule.critical import critical_path, links
from tandem.schedule.model import Assignment, Schedule
from tandem.world.replay import replay


@pytest.mark.parametrize("method", ["exact", "exhaustive"])
def test_the_second_part_waits_until_the_first_is_out(method: str) -> None:
    front = METHODS[method](two_parts(), Question("makespan"))
    assert front.complete
    # 4 + 10 + 3 twice, and the stamp of 2 s before, between or behind
    assert front.points == [(36.0, 0.0)] == front_in_order(two_parts().to_dict())
    result = front[0]
    assert faults(two_parts(), result.schedule) == []
    assert replay(two_parts(), result.schedule) == 36


@pytest.mark.parametrize("rule", sorted(RULES))
def test_every_rule_takes_a_part_out_before_it_puts_in_the_next(rule: str) -> None:
    front = METHODS[rule](two_parts(), Question("makespan"))
    assert faults(two_parts(), front[0].schedule) == []


def by_hand(**moved: float) -> Schedule:
    """In order: part 1, the stamp, part 2."""
    starts = {"in 1": 0, "run 1": 4, "out 1": 14, "stamp": 17, "in 2": 19, "run 2": 23, "out 2": 33}
    rows = []
    for name, start in (starts | moved).items():
        [mode] = two_parts().modes(name)
        rows.append(Assignment(start, start + mode.time, name, mode.operators))
    return Schedule(tuple(rows))


def test_the_checker_says_what_is_done_meanwhile_and_when_it_could_be() -> None:
    assert faults(two_parts(), by_hand()) == []
    assert faults(two_parts(), by_hand(stamp=14)) == [
        "operator 'press': holds the part of task 'in 1' from 0 s until task 'out 1' has ended at"
        " 17 s, but does task 'stamp' (14 to 16 s) meanwhile; 17 s is the earliest."
    ]
    assert faults(two_parts(), by_hand(**{"in 2": 16}))[1:] == [
        "operator 'press': holds the part of task 'in 2' from 16 s until task 'out 2' has ended at"
        " 36 s, but does task 'stamp' (17 to 19 s) meanwhile; 36 s is the earliest.",
        "operator 'press': holds the part of task 'in 1' from 0 s until task 'out 1' has ended at"
        " 17 s, but takes up another one with task 'in 2' at 16 s; 17 s is the earliest.",
    ]


def test_a_changeover_for_something_else_waits_until_the_part_is_out() -> None:
    data = two_parts().to_dict()
    data["tasks"]["stamp"]["tool"] = "die"
    data["tools"] = {"die": {"changeover": {"press": 3}}}
    data["operators"]["press"]["tool"] = "plate"
    cell = cell_of(data)
    early, late = (
        by_hand(stamp=19, **{"in 2": 21, "run 2": 25, "out 2": 35}),
        by_hand(stamp=20, **{"in 2": 22, "run 2": 26, "out 2": 36}),
    )
    assert faults(cell, late) == []
    assert faults(cell, early) == [
        "operator 'press': holds the part of task 'in 1' from 0 s until task 'out 1' has ended at"
        " 17 s, but gets ready for task 'stamp' from 16 s on meanwhile; 20 s is the earliest."
    ]
    assert plan(cell, minimize="makespan", workers=1)[0].makespan == front_in_order(data)[0][0]


def test_a_walk_to_something_else_waits_until_the_part_is_out() -> None:
    """A handling machine stands at the jig while it holds the part, and stamps elsewhere."""
    data = two_parts().to_dict()
    for part in "12":
        data["tasks"][f"run {part}"]["place"] = "jig"
    data["tasks"]["stamp"]["place"] = "anvil"
    data["walk"] = {"press": {"jig-anvil": 2}}
    cell = cell_of(data)
    assert faults(cell, by_hand(stamp=19, **{"in 2": 21, "run 2": 25, "out 2": 35})) == []
    [said] = faults(cell, by_hand(stamp=18, **{"in 2": 21, "run 2": 25, "out 2": 35}))
    assert said.endswith(
        "gets ready for task 'stamp' from 16 s on meanwhile; 19 s is the earliest."
    )
    for method in ("exact", "exhaustive"):
        # walking back to the jig lies within the second hold, or the stamp comes first
        assert METHODS[method](cell, Question("makespan")).points == front_in_order(data)


@pytest.mark.parametrize("method", ["exact", "exhaustive"])
def test_a_hold_reaches_over_waits_and_the_part_cures_in_the_machine(method: str) -> None:
    """No task stands in `after`: what comes between is said by waits alone."""
    data = press(holds=[["load", "unload"]])
    data["tasks"]["run"] |= {"after": [], "wait": {"after": "load", "at_most": 5}}
    data["tasks"]["unload"] |= {"after": [], "wait": {"after": "run", "at_least": 30}}
    data["tasks"]["stamp"] = {"time": {"press": 2}}
    cell = cell_of(data)
    assert Instance.of(cell).within == (bits(range(3)),)
    # 4 + 20, cured for 30 s, 3 to take it out; the press stamps before or behind, not meanwhile
    front = METHODS[method](cell, Question("makespan"))
    assert front.points[0] == (59, 4) == front_in_order(data)[0]
    assert faults(cell, front[0].schedule) == []
    assert replay(cell, front[0].schedule) == 59


def test_what_must_have_begun_before_the_last_task_is_done_before_the_part_goes_in() -> None:
    """A wait from a start: heating need not have ended, but only the press can do it."""
    data = press(holds=[["load", "unload"]])
    data["tasks"]["heat"] = {"time": {"press": 6}}
    data["tasks"]["unload"]["wait"] = {"after": "heat", "between": "start-start", "at_least": 1}
    cell = cell_of(data)
    instance = Instance.of(cell)
    assert instance.ahead_of_hold == (bits({instance.tasks.index("heat")}),)
    assert plan(cell, minimize="makespan", workers=1)[0].makespan == front_in_order(data)[0][0]


def test_the_critical_path_leads_through_the_machine() -> None:
    assert [(link.reason, link.by) for link in critical_path(two_parts(), by_hand())][-4:] == [
        ("hold", "press"),
        ("hold", "press"),
        ("predecessor", "in 2"),
        ("predecessor", "run 2"),
    ]
    [stamp] = links(two_parts(), by_hand())["stamp"]
    assert str(stamp) == "stamp at 17 s, when press is free after out 1"


def nested(**holds: Any) -> Cell:
    """The inner hold is a part of the outer one: the same part, measured on the way."""
    return cell_of({
        "operators": {
            "anna": {"kind": "human"},
            "stand": {"kind": "machine", "holds": [["clamp", "release"], ["plug", "unplug"]]},
        },
        "tasks": {
            "clamp": {"time": {"anna": 2}},
            "plug": {"time": {"anna": 1}, "after": ["clamp"]},
            "test": {"time": {"stand": 5}, "after": ["plug"]},
            "unplug": {"time": {"anna": 1}, "after": ["test"]},
            "mark": {"time": {"stand": 2}, "after": ["clamp"]},
            "release": {"time": {"anna": 1}, "after": ["unplug", "mark"]},
        },
    })  # fmt: skip


def test_a_hold_may_lie_within_another_one_and_is_then_the_narrower_rule() -> None:
    instance = Instance.of(nested())
    assert instance.rivals == (0, 0)
    best = plan(nested(), minimize="makespan", workers=1)[0]
    # "mark" lies within the outer hold, not within the inner one
    assert [(best.makespan, 0.0)] == front_of_all(nested().to_dict(), 14) == [(12.0, 0.0)]


def crossed() -> Cell:
    """What the last task waits for can only be done by the machine that holds the part."""
    data = press(holds=[["load", "unload"]])
    data["tasks"]["heat"] = {"time": {"press": 6}}
    data["tasks"]["unload"]["after"] = ["run", "heat"]
    data["tasks"]["heat"]["after"] = []
    return cell_of(data)


def test_what_the_last_task_waits_for_is_done_before_the_part_goes_in() -> None:
    """A list of tasks that begins with the first would come to a dead end."""
    cell = crossed()
    instance = Instance.of(cell)
    assert instance.ahead_of_hold == (bits({instance.tasks.index("heat")}),)
    for name in SPECS:
        state = build(Layout.of(instance), SPECS[name], Random(1))
        assert state is not None
        assert faults(cell, instance.schedule(state.starts())) == []
    assert plan(cell, minimize="makespan", workers=1)[0].makespan == 33


def deadlocked() -> Cell:
    """Two parts that wait for each other in one press."""
    data = two_parts().to_dict()
    data["tasks"]["out 1"]["after"] += ["in 2"]
    data["tasks"]["out 2"]["after"] += ["in 1"]
    return cell_of(data)


@pytest.mark.parametrize("method", ["exact", "exhaustive"])
def test_holds_that_cannot_be_are_infeasible_in_words(method: str) -> None:
    with pytest.raises(InfeasibleError):
        METHODS[method](deadlocked(), Question("makespan"))
    assert front_in_order(deadlocked().to_dict()) == []
    found = conflict(deadlocked(), Question())
    assert found is not None
    said = found.sentences()
    assert said[0] == (
        "that press holds a part from task in 1 to task out 1 and that press holds a part from task"
        " in 2 to task out 2 cannot be kept together."
    )
    assert any(line.startswith("Without that press holds a part from task in 1") for line in said)


def test_a_rule_that_comes_to_a_dead_end_says_that_it_found_nothing() -> None:
    with pytest.raises(NothingFoundError):
        METHODS["heft"](deadlocked(), Question("makespan"))


@pytest.mark.parametrize("seed", range(1, 40))
def test_rules_give_sound_schedules_of_random_cells_with_holds(seed: int) -> None:
    _, data = drawn(seed, "holds")
    for task in data["tasks"].values():  # what is late breaks nothing here
        task.pop("deadline", None)
        for wait in task.get("wait", ()):
            wait.pop("at_most", None)
    try:
        cell = cell_of(data)
    except CellError:
        return
    instance = Instance.of(cell)
    layout = Layout.of(instance)
    if layout.impossible() or cell.stress_of_set is not None:
        return
    for name in SPECS:
        state = build(layout, SPECS[name], Random(seed))
        if state is not None:
            said = faults(instance.cell, instance.schedule(state.starts()))
            assert said == [], (name, said)


@pytest.mark.parametrize("key", ["holds", "apart"])
def test_taking_the_rule_out_never_makes_a_plan_longer(key: str) -> None:
    longer, shorter = 0, 0
    for seed in range(1, 101):
        _, data = drawn(seed, key)
        free = {
            **data,
            **{
                table: {
                    name: {k: v for k, v in entry.items() if k != key}
                    for name, entry in data[table].items()
                }
                for table in ("operators", "zones")
            },
        }
        try:
            bound = plan(cell_of(data), minimize="makespan", workers=1)[0].makespan
        except (CellError, InfeasibleError):
            continue
        makespan = plan(cell_of(free), minimize="makespan", workers=1)[0].makespan
        longer, shorter = longer + (makespan > bound), shorter + (makespan < bound)
    assert longer == 0
    assert shorter > 0
