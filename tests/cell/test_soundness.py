"""Each rule alone: a cell that keeps it, and the sentence about one that does not."""

from __future__ import annotations

from typing import Any

import pytest

from tandem.cell.precedence import cycles
from tandem.cell.soundness import RULES
from tandem.errors import CellError, Fault
from tandem.files.validate import cell_of


def gearbox(**changes: Any) -> dict[str, Any]:
    """Anna and a cobot; keys such as `press__after` change one key of one task, others the cell."""
    data: dict[str, Any] = {
        "operators": {"cobot": {"kind": "robot"}, "anna": {"kind": "human"}},
        "tasks": {
            "grease": {"time": {"anna": 3}, "stress": 1},
            "press": {"time": {"cobot": 4, "anna": 5}, "stress": 2, "after": ["grease"]},
            "check": {"time": {"anna": 2}, "after": ["press"]},
        },
    }
    for key, value in changes.items():
        if "__" in key:
            task, field = key.split("__")
            data["tasks"][task][field] = value
        else:
            data[key] = value
    return data


def faults(**changes: Any) -> list[Fault]:
    """What is wrong with the gearbox after the changes."""
    try:
        cell_of(gearbox(**changes))
    except CellError as error:
        return list(error.faults)
    return []


def test_the_gearbox_is_sound():
    assert faults() == []


CASES: list[tuple[dict[str, Any], tuple[str | int, ...], str]] = [
    (
        {"press__time": {"cobott": 4, "anna": 5}},
        ("tasks", "press", "time", "cobott"),
        "names 'cobott', who is no operator .* mean 'cobot'",
    ),
    (
        {"press__time": {"Cobot ": 4, "anna": 5}},
        ("tasks", "press", "time", "Cobot"),
        "mean 'cobot'",
    ),
    (
        {"press__together": [{"operators": ["anna", "zoe"], "time": 3}]},
        ("tasks", "press", "together", 0, "operators", 1),
        "names 'zoe'.* Known: 'cobot', 'anna'",
    ),
    (
        {"press__stress": {"ana": 3}},
        ("tasks", "press", "stress", "ana"),
        "stress names 'ana'.* mean 'anna'",
    ),
    (
        {"press__difficulty": {"ana": 3}},
        ("tasks", "press", "difficulty", "ana"),
        "difficulty names 'ana'.* mean 'anna'",
    ),
    (
        {"press__spread": {"ana": 0.3}},
        ("tasks", "press", "spread", "ana"),
        "spread names 'ana'.* mean 'anna'",
    ),
    (
        {"press__tool": "driver", "tools": {"driver": {"changeover": {"cobo": 1}}}},
        ("tools", "driver", "changeover", "cobo"),
        "changeover names 'cobo'",
    ),
    (
        {"press__after": ["greas"]},
        ("tasks", "press", "after", 0),
        "comes after 'greas', which is no task. Did you mean 'grease'",
    ),
    (
        {"same_operator": [["grease", "chek"]]},
        ("same_operator", 0, 1),
        "names 'chek', which is no task. Did you mean 'check'",
    ),
    ({"press__after": ["grease", "press"]}, ("tasks", "press", "after", 1), "comes after itself"),
    (
        {"same_operator": [["grease", "grease"]]},
        ("same_operator", 0),
        "pairs task 'grease' with itself",
    ),
    (
        {"grease__after": ["check"]},
        ("tasks", "grease", "after", 0),
        "3 tasks wait .* 'grease' before 'press' before 'check' before 'grease'",
    ),
    (
        {"grease__after": ["press"]},
        ("tasks", "grease", "after", 0),
        "'grease' and 'press' wait for each other",
    ),
    ({"press__time": {}}, ("tasks", "press"), "nobody can do it. .*'cobot' and 'anna'"),
    (
        {"press__together": [{"operators": ["anna", "cobot", "anna"], "time": 3}]},
        ("tasks", "press", "together", 0, "operators"),
        "'anna' stands twice in one group",
    ),
    (
        {
            "press__together": [
                {"operators": ["anna", "cobot"], "time": 3},
                {"operators": ["cobot", "anna"], "time": 2.5},
            ]
        },
        ("tasks", "press", "together", 1),
        "is stated twice, with 3 s and 2.5 s",
    ),
    (
        {
            "press__time": {},
            "press__zone": "jig",
            "press__together": [{"operators": ["anna", "cobot"], "time": 3}],
        },
        ("tasks", "press", "zone"),
        "only do it together, but zone 'jig' holds 1 .* never meet.*capacity: 2",
    ),
    (
        {
            "press__time": {},
            "press__tool": "arbor",
            "press__together": [{"operators": ["anna", "cobot"], "time": 3}],
            "tools": {"arbor": {"capacity": 1}},
        },
        ("tasks", "press", "tool"),
        "there is 1 of tool 'arbor', so they never meet",
    ),
    (
        {"press__stress": {"cobot": 3}},
        ("tasks", "press", "stress", "cobot"),
        "stress is stated for 'cobot', a robot",
    ),
    (
        {"press__together": [{"operators": ["anna", "cobot"], "time": 3, "stress": {"cobot": 1}}]},
        ("tasks", "press", "together", 0, "stress", "cobot"),
        "stress is stated for 'cobot', a robot",
    ),
    (
        {"operators": {"cobot": {"kind": "robot", "stress_limit": 3}, "anna": {"kind": "human"}}},
        ("operators", "cobot", "stress_limit"),
        "robot and has a stress_limit",
    ),
    (
        {"operators": {"cobot": {"kind": "robot", "breaks": [[9, 4]]}, "anna": {"kind": "human"}}},
        ("operators", "cobot", "breaks", 0),
        r"\[9, 4\] ends before .* write \[4, 9\]",
    ),
    (
        {
            "operators": {
                "cobot": {"kind": "robot", "breaks": [[20, 30], [5, 21.5]]},
                "anna": {"kind": "human"},
            }
        },
        ("operators", "cobot", "breaks", 0),
        r"\[5, 21.5\] and \[20, 30\] overlap. Make them one: \[5, 30\]",
    ),
    (
        {"check__deadline": 8.5, "grease__release": 1},
        ("tasks", "check", "deadline"),
        (
            r"deadline of 8.5 s: 'grease' \(3 s, released at 1 s\) then 'press' \(4 s\) then"
            r" 'check' \(2 s\) ends at 10 s .* Set the deadline to 10 or"
        ),
    ),
    (
        {
            "check__deadline": 10,
            "operators": {
                "cobot": {"kind": "robot"},
                "anna": {"kind": "human", "breaks": [[6, 60]]},
            },
        },
        ("tasks", "check", "deadline"),
        "ends at 62 s at the soonest around the breaks",
    ),
    (
        {
            "check__time": {},
            "check__together": [{"operators": ["cobot", "anna"], "time": 5}],
            "check__deadline": 30,
            "operators": {
                "cobot": {"kind": "robot", "breaks": [[11, 20]]},
                "anna": {"kind": "human", "breaks": [[24, 40]]},
            },
        },
        ("tasks", "check", "deadline"),
        # both are free from 7 to 11 and from 20 to 24 only
        "ends at 45 s at the soonest around the breaks",
    ),
    (
        {"same_operator": [["grease", "press"]], "press__time": {"cobot": 4}},
        ("same_operator", 0),
        "nobody can do both: 'grease' by anna and 'press' by cobot",
    ),
    (
        {"stress_of_set": {"": 0, "check,grease": 4}},
        ("stress_of_set", "check,grease"),
        "Write 'grease,check'",
    ),
    (
        {"stress_of_set": {"grease, check": 4}},
        ("stress_of_set", "grease, check"),
        "Write 'grease,check'",
    ),
    (
        {"stress_of_set": {"grease,chck": 4}},
        ("stress_of_set", "grease,chck"),
        "names 'chck', which is no task. Did you mean 'check'",
    ),
    (
        {"stress_of_set": {"grease,check": 4, "check,grease": 5}},
        ("stress_of_set", "check,grease"),
        "states the set 'grease,check' twice",
    ),
    (
        {"press__tool": "screwdriver", "tools": {"scewdriver": {"capacity": 2}}},
        ("tools", "scewdriver"),
        "never used, while 'screwdriver' is used but not listed",
    ),
    (
        {"press__zone": "jig", "zones": {"Jig": {"capacity": 2}}},
        ("zones", "Jig"),
        "never used, while 'jig' is used",
    ),
    (
        {"press__tool": "Presse", "check__tool": "presse"},
        ("tasks", "check", "tool"),
        (
            "tool 'presse' is spelled almost like tool 'Presse', .* Did you mean 'Presse'. If they"
            " are two, list both under `tools`"
        ),
    ),
    (
        {"grease__tool": "Press", "check__tool": "Presse"},
        ("tasks", "check", "tool"),
        "Did you mean 'Press'",
    ),
    (
        {"grease__tool": "drvier", "check__tool": "driver", "tools": {"driver": {}}},
        ("tasks", "grease", "tool"),
        "Did you mean 'driver'",
    ),
    (
        {"grease__zone": "fixture", "check__zone": "Fixtures"},
        ("tasks", "check", "zone"),
        "zone 'Fixtures' is spelled almost like zone 'fixture'",
    ),
    (
        {
            "press__tool": "gripper",
            "operators": {"cobot": {"kind": "robot", "tool": "griper"}, "anna": {"kind": "human"}},
        },
        ("operators", "cobot", "tool"),
        "Did you mean 'gripper'",
    ),
    (
        {
            "operators": {
                "cobot": {"kind": "robot"},
                "anna": {"kind": "human"},
                "ben": {"kind": "human"},
            },
            "press__together": [
                {"operators": ["cobot", "anna"], "time": 3, "stress": {"anna": 1, "ben": 2}}
            ],
        },
        ("tasks", "press", "together", 0, "stress", "ben"),
        (
            "stress is stated for 'ben', who takes no part. Taking part are 'cobot' and 'anna';"
            " take 'ben' out"
        ),
    ),
    (
        {"press__time": {"cobot": 1 / 3}},
        ("tasks", "press", "time", "cobot"),
        "0.3333333333333333 has more than 6 decimals. Round it, to 0.333",
    ),
    (
        {"press__time": {"cobot": 0.000001}, "grease__time": {"anna": 9e6}},
        ("tasks",),
        "times add up to 9e.* Round the times to 1e-05 s",
    ),
    (
        {"press__stress": 0.000001, "grease__stress": 9e6},
        ("tasks",),
        "stresses add up to 1.8e.* too wide a range",
    ),
]


CASES += [
    (
        {"press__wait": {"after": "greas", "at_least": 4}},
        ("tasks", "press", "wait", 0, "after"),
        "task 'press' waits after 'greas', which is no task. Did you mean 'grease'",
    ),
    (
        {"press__wait": [{"after": "press", "at_least": 4}]},
        ("tasks", "press", "wait", 0, "after"),
        "task 'press' waits for itself",
    ),
    (
        {"check__wait": {"after": "grease", "at_least": 40, "at_most": 30}},
        ("tasks", "check", "wait", 0, "at_most"),
        "at least 40 s and at most 30 s, which leaves no moment .*`at_least: 30, at_most: 40`",
    ),
    (
        {"check__wait": [{"after": "grease", "at_least": 4}, {"after": "grease"}]},
        ("tasks", "check", "wait", 1),
        r"the wait after 'grease' \(end-start\) is stated twice",
    ),
    (
        {"grease__wait": {"after": "check"}},
        ("tasks", "grease", "wait", 0, "after"),
        "3 tasks wait for each other in a circle: .* out of the next one's `after` or `wait`",
    ),
    (
        {
            "grease__wait": {"after": "check", "between": "start-start"},
            "press__after": [],
            "check__after": ["grease"],
        },
        ("tasks", "grease", "wait", 0, "after"),
        "'grease' and 'check' wait for each other. .* other's `after` or `wait`",
    ),
    (
        {"check__wait": {"after": "grease", "at_least": 20}, "check__deadline": 24},
        ("tasks", "check", "deadline"),
        r"'grease' \(3 s\) then 'check' 20 s later \(2 s\) ends at 25 s",
    ),
    (
        {"check__wait": {"after": "grease", "at_least": 0.1234567}},
        ("tasks", "check", "wait", 0, "at_least"),
        "0.1234567 has more than 6 decimals",
    ),
]


@pytest.mark.parametrize(
    ("changes", "path", "sentence"), CASES, ids=[case[2][:40] for case in CASES]
)
def test_one_fault_is_told_with_its_place_and_remedy(changes, path, sentence):
    found = faults(**changes)
    assert [fault.path for fault in found] == [path]
    with pytest.raises(CellError, match=sentence):
        cell_of(gearbox(**changes))


ALLOWED: list[dict[str, Any]] = [
    {"zones": {"spare": {}}, "tools": {"spare": {}}},  # listed, unused and like no other
    # too narrow for the group, not for one alone
    {"press__zone": "jig", "press__together": [{"operators": ["anna", "cobot"], "time": 3}]},
    # touching breaks, in any order
    {
        "operators": {
            "cobot": {"kind": "robot", "breaks": [[5, 9], [1, 5]]},
            "anna": {"kind": "human"},
        }
    },
    {"check__deadline": 9},  # met to the second
    {
        "grease__time": {"anna": 0.1},
        "press__time": {"anna": 0.2},
        "check__time": {"anna": 0.3},
        "check__deadline": 0.6,
    },  # 0.1 + 0.2 + 0.3 is 0.6 here
    {"same_operator": [["grease", "check"], ["grease", "check"]]},
    {"stress_of_set": {"grease,check": 1, "grease,press,check": 5}},
    {"press__stress": {"anna": 0}},
    {"press__after": ["grease", "grease"]},
    {"press__wait": {"after": "grease", "at_least": 4, "at_most": 4}},
    {"press__wait": [{"after": "grease"}, {"after": "grease", "between": "start-start"}]},
    # two on purpose
    {"grease__tool": "Presse", "check__tool": "presse", "tools": {"Presse": {}, "presse": {}}},
    {"grease__zone": "jig 1", "check__zone": "jig 2"},
]


@pytest.mark.parametrize("changes", ALLOWED, ids=str)
def test_what_is_unusual_but_sound_is_allowed(changes):
    assert faults(**changes) == []


def test_every_fault_is_reported_at_once():
    found = faults(
        press__time={"cobott": 4},
        press__after=["greas"],
        press__stress={"cobot": 1},
        check__after=["check"],
        operators={
            "cobot": {"kind": "robot", "stress_limit": 1},
            "anna": {"kind": "human", "breaks": [[2, 1]]},
        },
    )
    assert len(found) == 6


def test_a_deadline_blames_the_task_where_time_runs_out_and_not_those_behind_it():
    assert [fault.path[1] for fault in faults(grease__deadline=2, check__deadline=8)] == ["grease"]


def test_each_cycle_comes_once_and_cutting_each_leaves_none():
    after = {"a": ["b", "e"], "b": ["a", "c"], "c": ["d"], "d": ["b"], "e": []}
    found = list(cycles(after))
    assert found == [["a", "b"], ["b", "d", "c"]]
    for cycle in found:
        after[cycle[0]] = [first for first in after[cycle[0]] if first != cycle[-1]]
    assert list(cycles(after)) == []


def test_a_cycle_reads_in_the_order_of_work():
    """`b` after `a`, `c` after `b`, `a` after `c`."""
    assert list(cycles({"a": ["c"], "b": ["a"], "c": ["b"]})) == [["a", "b", "c"]]


def test_a_chain_of_ten_thousand_tasks_needs_no_recursion():
    count = 10_000
    chain: dict[str, list[str]] = {str(n): [str(n + 1)] for n in range(count)}
    chain[str(count)] = []
    assert list(cycles(chain)) == []
    chain[str(count)] = ["0"]
    assert [len(cycle) for cycle in cycles(chain)] == [count + 1]


def test_every_rule_says_what_it_demands():
    assert all(rule.__doc__ for rule in RULES)
