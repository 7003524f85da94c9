"""Every rule of the CP-SAT model alone: a cell of two tasks that it lets through, and one that it
does not.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from ortools.sat.python import cp_model

from tandem.cell.model import Cell
from tandem.files.validate import cell_of
from tandem.plan import cpsat
from tandem.plan.instance import Instance

ONE = {"anna": {"kind": "human"}}
TWO = {"anna": {"kind": "human"}, "cobot": {"kind": "robot"}}
BOTH = {"anna": 5, "cobot": 5}


def cell(operators=TWO, tasks=None, **more) -> Cell:
    return cell_of({"operators": operators, "tasks": tasks, **more})


def possible(of: Cell, upper: int, *rules: cpsat.Rule, most_stress: int | None = None) -> bool:
    """Whether these rules, and no others, leave a schedule that ends by `upper` ticks, whether ends
    are sums or variables.
    """
    answers = set()
    for own_ends in (False, True):
        plan = cpsat.formulate(Instance.of(of), upper, rules, own_ends=own_ends)
        if most_stress is not None:
            plan.model.add(plan.stress <= most_stress)
        status = cp_model.CpSolver().solve(plan.model)
        answers.add(status in (cp_model.OPTIMAL, cp_model.FEASIBLE))
    assert len(answers) == 1
    return answers.pop()


@pytest.mark.parametrize("own_ends", [False, True])
def test_deadlines_are_kept_in_a_slower_way_too(own_ends):
    """Anna is slow: from 0 s she ends at 9 s, although the deadline less the cobot's time would let
    her start at 4 s.
    """
    late = cell(
        tasks={"a": {"time": {"anna": 9, "cobot": 5}, "deadline": 9}, "b": {"time": {"cobot": 9}}}
    )
    for rule, start, allowed in (
        (cpsat.deadlines_are_kept, 0, True),
        (cpsat.deadlines_are_kept, 1, False),
        (cpsat.predecessors_end_first, 1, True),
    ):
        plan = cpsat.formulate(Instance.of(late), 20, [rule], own_ends=own_ends)
        plan.model.add(plan.chosen[0][0] == 1)
        plan.model.add(plan.start[0] == start)
        assert (cp_model.CpSolver().solve(plan.model) != cp_model.INFEASIBLE) == allowed


def test_predecessors_end_first():
    chain = cell(tasks={"a": {"time": BOTH}, "b": {"time": BOTH, "after": ["a"]}})
    assert possible(chain, 10, cpsat.predecessors_end_first)
    assert not possible(chain, 9, cpsat.predecessors_end_first)


@pytest.mark.parametrize(("who", "ticks"), [(0, 9), (1, 5)])
def test_an_end_is_that_of_the_way_chosen(who, ticks):
    """As a sum and as a variable, which a hint tells, too."""
    unlike = {"time": {"anna": 9, "cobot": 5}}
    for own_ends in (False, True):
        for after in (ticks - 1, ticks):
            instance = Instance.of(cell(tasks={"a": unlike, "b": {**unlike, "after": ["a"]}}))
            plan = cpsat.formulate(instance, 30, own_ends=own_ends)
            plan.hint(((who, 0), (1, ticks)))
            plan.model.add(plan.chosen[0][who] == 1)
            plan.model.add(plan.start[0] == 0)
            plan.model.add(plan.start[1] == after)
            solver = cp_model.CpSolver()
            status = solver.solve(plan.model)
            assert (status != cp_model.INFEASIBLE) == (after == ticks)
            assert status == cp_model.INFEASIBLE or solver.value(plan.end[0]) == ticks
        ends = [isinstance(end, cp_model.IntVar) for end in plan.end]
        assert ends == [own_ends, own_ends]
        hinted = len(plan.model.proto.solution_hint.vars)
        assert hinted == (8 if own_ends else 6)


@pytest.mark.parametrize(
    ("wait", "allowed"),
    [
        ({"at_least": 3}, range(8, 99)),
        ({"at_most": 3}, range(5, 9)),
        ({"between": "start-start", "at_least": 3, "at_most": 4}, range(3, 5)),
        ({"between": "start-start"}, range(99)),
    ],
)
def test_waits_are_kept(wait, allowed):
    tasks = {"a": {"time": BOTH}, "b": {"time": BOTH, "wait": {"after": "a", **wait}}}
    for start in (0, 2, 3, 4, 5, 7, 8, 9):
        rules = [cpsat.waits_are_kept, cpsat.predecessors_end_first]
        plan = cpsat.formulate(Instance.of(cell(tasks=tasks)), 30, rules)
        plan.model.add(plan.start[0] == 0)
        plan.model.add(plan.start[1] == start)
        possible = cp_model.CpSolver().solve(plan.model) != cp_model.INFEASIBLE
        assert possible == (start in allowed), start


def test_an_operator_does_one_thing_at_a_time():
    alone = cell(ONE, {"a": {"time": {"anna": 5}}, "b": {"time": {"anna": 5}}})
    assert possible(alone, 10, cpsat.an_operator_does_one_thing_at_a_time)
    assert not possible(alone, 9, cpsat.an_operator_does_one_thing_at_a_time)
    assert possible(alone, 5)  # without the rule


def test_breaks_keep_an_operator_from_working():
    rest = cell(
        {"anna": {"kind": "human", "breaks": [[5, 8]]}},
        {"a": {"time": {"anna": 5}}, "b": {"time": {"anna": 5}}},
    )
    assert possible(rest, 13, cpsat.an_operator_does_one_thing_at_a_time)
    assert not possible(rest, 12, cpsat.an_operator_does_one_thing_at_a_time)


@pytest.mark.parametrize(("in_hand", "ends"), [(None, 13), ("wrench", 13), ("driver", 16)])
def test_taking_up_another_tool_takes_its_time(in_hand, ends):
    """Wrench, then driver: 5 + 3 + 5; with the driver in hand at the start the wrench has to be
    taken up too, or the driver again.
    """
    anna = {"kind": "human"} | ({"tool": in_hand} if in_hand else {})
    tasks = {
        "a": {"time": {"anna": 5}, "tool": "wrench"},
        "b": {"time": {"anna": 5}, "tool": "driver", "after": ["a"]},
    }
    tools = {"wrench": {"changeover": {"anna": 3}}, "driver": {"changeover": {"anna": 3}}}
    swap = cell({"anna": anna}, tasks, tools=tools)
    rules = (cpsat.predecessors_end_first, cpsat.an_operator_does_one_thing_at_a_time)
    assert possible(swap, ends, *rules)
    assert not possible(swap, ends - 1, *rules)


@pytest.mark.parametrize(
    ("kind", "rule"),
    [
        ("tool", cpsat.a_tool_is_used_as_often_as_it_exists),
        ("zone", cpsat.a_zone_holds_as_many_as_it_has_places),
    ],
)
def test_a_tool_and_a_zone_are_shared(kind, rule):
    tasks = {"a": {"time": BOTH, kind: "it"}, "b": {"time": BOTH, kind: "it"}}
    assert not possible(cell(tasks=tasks), 9, rule)
    assert possible(cell(tasks=tasks), 10, rule)
    assert possible(cell(tasks=tasks, **{f"{kind}s": {"it": {"capacity": 2}}}), 5, rule)


def test_a_joint_task_takes_a_place_for_each_who_takes_part():
    joint = {"together": [{"operators": ["anna", "cobot"], "time": 5}], "zone": "fixture"}
    alone = {"time": {"third": 5}, "zone": "fixture"}
    operators = {**TWO, "third": {"kind": "robot"}}
    rule = cpsat.a_zone_holds_as_many_as_it_has_places
    assert possible(
        cell(operators, {"a": joint, "b": alone}, zones={"fixture": {"capacity": 3}}), 5, rule
    )
    assert not possible(
        cell(operators, {"a": joint, "b": alone}, zones={"fixture": {"capacity": 2}}), 9, rule
    )


def test_kinds_are_kept_apart():
    tasks = {"a": {"time": {"anna": 5}, "zone": "it"}, "b": {"time": {"cobot": 5}, "zone": "it"}}
    apart = {"it": {"capacity": 2, "apart": ["human", "robot"]}}
    assert possible(cell(tasks=tasks, zones=apart), 10, cpsat.kinds_are_kept_apart)
    assert not possible(cell(tasks=tasks, zones=apart), 9, cpsat.kinds_are_kept_apart)
    people = {"anna": {"kind": "human"}, "cobot": {"kind": "human"}}
    assert possible(cell(people, tasks, zones=apart), 5, cpsat.kinds_are_kept_apart)


def test_no_task_is_done_by_kinds_that_are_kept_apart():
    joint = {"operators": ["anna", "cobot"], "time": 5}
    tasks = {"a": {"time": {"anna": 9}, "together": [joint], "zone": "it"}, "b": {"time": BOTH}}
    apart = {"it": {"capacity": 2, "apart": ["human", "robot"]}}
    assert possible(cell(tasks=tasks, zones=apart), 9, cpsat.kinds_are_kept_apart)
    assert not possible(cell(tasks=tasks, zones=apart), 8, cpsat.kinds_are_kept_apart)


def test_a_machine_that_holds_a_part_does_nothing_else():
    """Anna puts it in and takes it out; the press would stamp meanwhile."""
    rules = (cpsat.predecessors_end_first, cpsat.a_machine_that_holds_a_part_does_nothing_else)
    tasks = {
        "in": {"time": {"anna": 5}},
        "out": {"time": {"anna": 5}, "after": ["in"]},
        "stamp": {"time": {"press": 3}},
    }
    holding = {"kind": "machine", "holds": [["in", "out"]]}
    for press, ends in (({"kind": "machine"}, 10), (holding, 13)):
        operators = {"anna": {"kind": "human"}, "press": press}
        assert possible(cell(operators, tasks), ends, *rules)
        assert not possible(cell(operators, tasks), ends - 1, *rules)
    between = {**tasks, "stamp": {"time": {"press": 3}, "after": ["in"]}}
    between["out"] = {"time": {"anna": 5}, "after": ["stamp"]}
    operators = {"anna": {"kind": "human"}, "press": holding}
    assert possible(cell(operators, between), 13, *rules)


def test_a_machine_that_holds_a_part_takes_up_no_other():
    rules = (cpsat.predecessors_end_first, cpsat.a_machine_that_holds_a_part_does_nothing_else)
    tasks = {
        "in 1": {"time": {"anna": 5}}, "out 1": {"time": {"anna": 5}, "after": ["in 1"]},
        "in 2": {"time": {"cobot": 5}}, "out 2": {"time": {"cobot": 5}, "after": ["in 2"]},
    }  # fmt: skip
    press = {"kind": "machine", "holds": [["in 1", "out 1"], ["in 2", "out 2"]]}
    assert possible(cell({**TWO, "press": press}, tasks), 20, *rules)
    assert not possible(cell({**TWO, "press": press}, tasks), 19, *rules)


def test_nobody_takes_more_than_allowed():
    rule = cpsat.nobody_takes_more_than_allowed
    tasks = {"a": {"time": {"anna": 5}, "stress": 2.5}, "b": {"time": {"anna": 5}, "stress": 2}}
    assert possible(cell({"anna": {"kind": "human", "stress_limit": 4.5}}, tasks), 10, rule)
    assert not possible(cell({"anna": {"kind": "human", "stress_limit": 4.4}}, tasks), 10, rule)


def test_some_tasks_have_the_same_operators():
    tasks = {"a": {"time": {"anna": 5}}, "b": {"time": BOTH}, "c": {"time": {"cobot": 5}}}
    rule = cpsat.some_tasks_have_the_same_operators
    assert possible(cell(tasks=tasks, same_operator=[["a", "b"]]), 20, rule)
    with_both = cell(tasks={**tasks, "a": {"time": BOTH}}, same_operator=[["a", "b"], ["b", "c"]])
    plan = cpsat.formulate(Instance.of(with_both), 20, [rule])
    plan.model.add(plan.chosen[0][0] == 1)  # anna does a, so she would have to do c
    assert cp_model.CpSolver().solve(plan.model) == cp_model.INFEASIBLE


def test_stress_is_counted():
    tasks = {"a": {"time": {"anna": 5}, "stress": 3}, "b": {"time": BOTH, "stress": 4}}
    assert possible(cell(tasks=tasks), 10, cpsat.stress_is_counted, most_stress=3)
    assert not possible(cell(tasks=tasks), 10, cpsat.stress_is_counted, most_stress=2)
    table = cell(tasks=tasks, stress_of_set={"a": 9, "a,b": 1})
    assert possible(table, 10, cpsat.stress_is_counted, most_stress=1)
    assert not possible(table, 10, cpsat.stress_is_counted, most_stress=0)


@pytest.mark.parametrize(
    "rule",
    [cpsat.the_work_of_an_operator_fits_before_the_end, cpsat.work_before_and_behind_a_task_fits],
)
def test_implied_rules_say_no_before_the_search_does(rule):
    fan = cell(
        ONE,
        {
            name: {"time": {"anna": 5}, "after": after}
            for name, after in (("a", []), ("b", []), ("c", ["a", "b"]))
        },
    )
    assert not possible(
        fan,
        14 if rule is cpsat.the_work_of_an_operator_fits_before_the_end else 9,
        rule,
        cpsat.predecessors_end_first,
    )
    assert possible(fan, 15, rule, cpsat.predecessors_end_first)


def test_each_rule_of_the_model_is_tested_here():
    text = Path(__file__).read_text(encoding="utf-8")
    assert [rule.__name__ for rule in cpsat.RULES if f"cpsat.{rule.__name__}" not in text] == []
