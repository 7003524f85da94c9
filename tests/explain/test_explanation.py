"""Every stated cost equals that of an independent re-solve, which knows neither the explanation
nor, where it can run, the same solver.
"""

from __future__ import annotations

import copy
from dataclasses import replace

import pytest
from tests.benchmark_data import folder
from tests.schedule.cells import GLUED, glued

from tandem.cell.model import Cell
from tandem.errors import InfeasibleError, UsageError
from tandem.explain.alternatives import Alternative, alternative, sentence
from tandem.explain.bottleneck import Bottleneck, part, sentences
from tandem.explain.explanation import Explanation, TaskAnswer, explain
from tandem.files.load import load
from tandem.plan.methods import METHODS, plan
from tandem.plan.question import Question
from tandem.plan.result import Bound, Front, Result, Status
from tandem.schedule.model import Schedule

CASES = {
    "pearce2015_p3": "exhaustive",
    "pearce2018_p1": "exhaustive",
    "pearce2018_p2": "exhaustive",
}


def points_when(
    cell: Cell, task: str, operators: tuple[str, ...], method: str
) -> list[tuple[float, float]]:
    """The front when the task is done by these operators: the cell's file edited by hand, planned
    by another method.
    """
    data = copy.deepcopy(cell.to_dict())
    bound = {
        task,
        *(other for pair in data.get("same_operator", ()) if task in pair for other in pair),
    }
    for name in bound:
        row = data["tasks"][name]
        row["time"] = {
            who: seconds for who, seconds in row.get("time", {}).items() if (who,) == operators
        }
        row["together"] = [
            way for way in row.get("together", ()) if set(way["operators"]) == set(operators)
        ]
        if not row["time"] and not row["together"]:
            return []
    if "stress_of_set" in data and not set(operators) & set(cell.humans):
        data["stress_of_set"] = {
            key: value
            for key, value in data["stress_of_set"].items()
            if not bound & set(key.split(","))
        }
    try:
        return METHODS[method](Cell.model_validate(data), Question()).points
    except InfeasibleError:
        return []


def check(cell: Cell, found: Explanation, other: Alternative, method: str) -> None:
    makespan, stress = found.result.makespan, found.result.stress
    points = points_when(cell, other.task, other.operators, method)
    fastest = min((point for point in points if point[1] <= stress), default=None)
    gentlest = min(
        ((load, seconds) for seconds, load in points if seconds <= makespan), default=None
    )
    assert (
        None
        if other.at_same_stress is None
        else (other.at_same_stress.makespan, other.at_same_stress.stress)
    ) == fastest
    assert (
        None
        if other.in_same_time is None
        else (other.in_same_time.stress, other.in_same_time.makespan)
    ) == gentlest
    if fastest is None and gentlest is None:
        assert (
            None if other.otherwise is None else (other.otherwise.makespan, other.otherwise.stress)
        ) == (points[0] if points else None)
    for cost in (other.at_same_stress, other.in_same_time, other.otherwise):
        if cost is not None:
            assert cost.proven
            assert cost.seconds == pytest.approx(cost.makespan - makespan)
            assert cost.more_stress == pytest.approx(cost.stress - stress)


@pytest.mark.parametrize("point", [None, 1, 2, 3])
def test_each_cost_on_the_thesis_cell_equals_an_independent_solve(
    thesis: Cell, point: int | None
) -> None:
    found = explain(thesis, point=point)
    assert found.front.points == [(23, 7), (24, 3), (34, 2)]
    alternatives = [other for answer in found.tasks for other in answer.alternatives]
    assert len(alternatives) == 5
    for other in alternatives:
        check(thesis, found, other, "exhaustive")


@pytest.mark.parametrize("name", CASES)
def test_each_cost_on_a_case_study_equals_an_independent_solve(name: str) -> None:
    cell = load(folder("hrc_case_studies") / f"{name}.json")
    found = explain(cell)
    alternatives = [other for answer in found.tasks for other in answer.alternatives]
    assert alternatives
    for other in alternatives:
        check(cell, found, other, CASES[name])


def test_waits_are_true(thesis: Cell) -> None:
    found = explain(thesis, point=1)
    by_task = {answer.assignment.task: answer for answer in found.tasks}
    ends = {task: answer.assignment.end for task, answer in by_task.items()}
    for answer in found.tasks:
        for link in answer.waiting.links:
            if link.waited_for is not None:
                assert ends[link.waited_for] == answer.assignment.start
    assert {task for task, answer in by_task.items() if answer.waiting.critical} == {
        "1",
        "2",
        "4",
        "6",
        "7",
    }
    assert "waits for task 1, its predecessor" in by_task["4"].sentences()[0]


def test_a_wait_is_told_as_the_reason_and_as_part_of_the_floor() -> None:
    tasks = {**GLUED["tasks"], "sort": {"time": {"anna": 30}}}
    found = explain(glued(tasks=tasks), point=1)
    by_task = {answer.assignment.task: answer for answer in found.tasks}
    assert "waits until its time after task glue is over" in by_task["press"].sentences()[0]
    assert "waits until its time after task press is over" in by_task["cool"].sentences()[0]
    assert found.floor.kind == "chain"
    assert found.floor.tasks == ("glue", "press")
    assert found.floor.waits == {"press": 40}
    assert "5 + 40 (wait) + 10 s" in sentences(found.floor)[0]
    assert "5 + 40 (Wartezeit) + 10 s" in sentences(found.floor, "de")[0]


def test_who_is_put_off_for_a_follower_is_told_so() -> None:
    by_task = {answer.assignment.task: answer for answer in explain(glued(), point=1).tasks}
    said = by_task["glue"].sentences()[0]
    assert "starts no sooner so that task press can follow it in time, may slip by 20 s" in said


# --- the floor ------------------------------------------------------------------------------------


def test_the_floor_of_the_thesis_cell_in_its_own_words(thesis: Cell) -> None:
    floor = explain(thesis).floor
    assert floor is not None
    assert (
        sentences(floor)[0]
        == "23 s is the floor: tasks 2, 1 and 4 keep robot busy until 18 s, then 6 keeps human busy"
        " until 21 s, then 7 keeps robot busy until 23 s."
    )
    assert floor.tasks == ("1", "2", "3", "4", "6", "7")
    assert floor.smallest


def test_the_group_is_bounding_and_no_member_can_be_missed(thesis: Cell) -> None:
    """Dynamic programming, without CP-SAT, confirms that the group alone takes as long and that
    each smaller one does not.
    """
    floor = explain(thesis).floor
    assert floor is not None
    quickest = METHODS["exhaustive"]
    assert quickest(part(thesis, floor.tasks), Question("makespan"))[0].makespan == floor.makespan
    for task, seconds in floor.without.items():
        rest = [other for other in floor.tasks if other != task]
        assert (
            quickest(part(thesis, rest), Question("makespan"))[0].makespan
            == seconds
            < floor.makespan
        )
    assert set(floor.without) == set(floor.tasks)


def test_a_chain_is_a_floor() -> None:
    cell = Cell.model_validate(
        {
            "operators": {"human": {"kind": "human"}, "robot": {"kind": "robot"}},
            "tasks": {
                "fetch": {"time": {"robot": 4, "human": 3}},
                "place": {"time": {"robot": 5}, "after": ["fetch"]},
                "check": {"time": {"human": 2}, "after": ["place"]},
                "tidy": {"time": {"human": 1}},
            },
        }
    )
    floor = explain(cell).floor
    assert floor is not None
    assert (floor.kind, floor.tasks, floor.makespan) == ("chain", ("fetch", "place", "check"), 10.0)
    assert sentences(floor) == [
        "10 s is the floor: tasks fetch, place and check must follow one another and take 3 + 5 + 2"
        " s even when each is done in its quickest way."
    ]


def test_a_load_is_a_floor() -> None:
    cell = Cell.model_validate(
        {
            "operators": {"human": {"kind": "human"}, "robot": {"kind": "robot"}},
            "tasks": {
                "a": {"time": {"human": 2}},
                "b": {"time": {"robot": 5}, "after": ["a"]},
                "c": {"time": {"robot": 6}, "after": ["a"]},
                "d": {"time": {"human": 1}, "after": ["b", "c"]},
            },
        }
    )
    floor = explain(cell).floor
    assert floor is not None
    assert (floor.kind, floor.operators, floor.tasks) == ("load", ("robot",), ("b", "c"))
    assert sentences(floor) == [
        "14 s is the floor: only robot can take part in tasks b and c, not before 2 s, at least 11"
        " s of work, and 1 s must follow."
    ]


def test_the_floor_under_a_cap_on_stress(thesis: Cell) -> None:
    floor = explain(thesis, point=3).floor
    assert floor is not None
    assert floor.max_stress == 2
    assert floor.makespan == 34
    assert "with a stress of at most 2" in sentences(floor)[0]


# --- how it is asked ------------------------------------------------------------------------------


def test_one_task(thesis: Cell) -> None:
    found = explain(thesis, task="6")
    assert [answer.assignment.task for answer in found.tasks] == ["6"]
    assert found.floor is None


def test_answers_come_one_by_one(thesis: Cell) -> None:
    came: list[type] = []
    found = explain(thesis, on_answer=lambda answer: came.append(type(answer)))
    assert came == [Front, Bottleneck, *[TaskAnswer] * 7]
    assert [answer.assignment.start for answer in found.tasks] == sorted(
        answer.assignment.start for answer in found.tasks
    )


def test_the_document_has_what_the_sentences_say(thesis: Cell) -> None:
    document = explain(thesis).to_dict()
    assert document["front"] == [[23, 7], [24, 3], [34, 2]]
    assert (document["point"], document["makespan"], document["stress"]) == (2, 24, 3)
    six = next(row for row in document["tasks"] if row["task"] == "6")
    assert six["alternatives"][0]["at_same_stress"] == {
        "makespan": 34,
        "stress": 2,
        "seconds": 10,
        "more_stress": -1,
        "proven": True,
        "bound": 34,
    }
    assert document["floor"]["without"] == {"1": 15, "2": 16, "3": 16, "4": 21, "6": 20, "7": 21}


def test_unknown_task_and_point(thesis: Cell) -> None:
    with pytest.raises(UsageError, match=r"no task '66'. Did you mean '6'"):
        explain(thesis, task="66")
    with pytest.raises(UsageError, match="the front has 3 points"):
        explain(thesis, point=4)


def test_a_forced_choice_that_no_schedule_allows() -> None:
    """The human's limit forbids the second task; the explanation says so instead of a cost."""
    cell = Cell.model_validate(
        {
            "operators": {
                "human": {"kind": "human", "stress_limit": 3},
                "robot": {"kind": "robot"},
            },
            "tasks": {
                "1": {"time": {"human": 5}, "stress": 3},
                "2": {"time": {"human": 1, "robot": 4}, "stress": 1},
            },
        }
    )
    answer = explain(cell, task="2").tasks[0]
    assert not answer.alternatives[0].possible
    assert answer.sentences()[1] == "  instead human (1 s): no schedule allows it."


@pytest.mark.slow
def test_fifty_tasks_are_explained_each() -> None:
    from tandem.files.generators import layered

    cell = layered(tasks=50, humans=2, robots=1, seed=7)
    found = explain(cell)
    assert len(found.tasks) == 50


def test_a_point_that_is_not_the_best_is_told_so(thesis: Cell) -> None:
    """An unproven point may be beaten by the answer to "what if": that is said, not hidden behind
    "costs nothing".
    """
    slow = Schedule(
        tuple(
            replace(a, start=a.start + 100, end=a.end + 100) if a.task == "7" else a
            for a in plan(thesis)[1].schedule
        )
    )
    point = Result(thesis, slow, Status.FEASIBLE, Bound(23, 2))
    human = next(mode for mode in thesis.modes("6") if mode.operators == ("human",))
    found = alternative(thesis, point, "6", human)
    assert (found.better.makespan, found.better.stress) == (24, 3) if found.better else False
    assert (
        sentence(found)
        == "human (3 s): a better schedule, found only now, does it so: 24 s, stress 3."
    )
