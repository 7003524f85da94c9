"""What cannot be kept together is a minimal set: the set alone has no schedule, and the set without
any one of its members has one. The judge is the exhaustive search, which knows no CP-SAT.
"""

from __future__ import annotations

import itertools
import json
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

import pytest
from tests.fuzz.cells import cell as random_cell

from tandem.cell.model import Cell
from tandem.cli.root import run
from tandem.errors import CellError, InfeasibleError
from tandem.files.validate import cell_of
from tandem.plan import dynamic_programming
from tandem.plan.infeasible import Limit, conflict, lift, limits, minimal_core
from tandem.plan.methods import plan
from tandem.plan.question import Question
from tandem.schedule.checker import faults


def has_a_schedule(cell: Cell, question: Question, kept: tuple[Limit, ...]) -> bool:
    """With these limits alone, by the exhaustive search."""
    lifted = [limit for limit in limits(cell, question) if limit not in kept]
    variant, asked = lift(cell, question, lifted)
    try:
        return len(dynamic_programming.solve(variant, asked)) > 0
    except InfeasibleError:
        return False


@cache
def infeasible_cells(count: int, seed: int) -> list[tuple[Cell, Question]]:
    """Random cells with every feature that no schedule keeps, and others with a limit of the
    question that none does.
    """
    random, found = Random(seed), []
    while len(found) < count:
        try:
            cell = cell_of(random_cell(random))
        except CellError:
            continue
        question = Question()
        try:
            quickest = dynamic_programming.solve(cell, Question("makespan"))[0]
        except InfeasibleError:
            found.append((cell, question))
            continue
        if len(found) % 3 == 0:
            cap = max(quickest.stress - 0.5, 0)
            question = Question(max_makespan=quickest.makespan, max_stress=cap)
            if quickest.stress and not has_a_schedule(
                cell, question, tuple(limits(cell, question))
            ):
                found.append((cell, question))
    return found


@pytest.mark.parametrize("place", range(24))
def test_every_member_is_needed_and_the_set_alone_is_infeasible(place: int) -> None:
    cell, question = infeasible_cells(24, seed=7)[place]
    found = conflict(cell, question)
    if found is None:
        assert not has_a_schedule(cell, question, ())
        return
    core = found.core
    assert core.is_minimal
    assert not has_a_schedule(cell, question, core.items)
    for left_out in core.items:
        rest = tuple(limit for limit in core.items if limit is not left_out)
        assert has_a_schedule(cell, question, rest), left_out
    for gain in found.gains:
        variant, asked = lift(cell, question, [gain.limit])
        helps = has_a_schedule(variant, asked, tuple(limits(variant, asked)))
        assert helps == (gain.makespan is not None)


def test_what_is_gained_is_what_planning_without_the_limit_gives() -> None:
    cell = cell_of(
        {
            "operators": {"anna": {"kind": "human", "stress_limit": 3}},
            "tasks": {
                "a": {"time": {"anna": 4}, "stress": 5},
                "b": {"time": {"anna": 6}, "stress": 5, "deadline": 20},
            },
        }
    )
    found = conflict(cell, Question())
    assert found is not None
    (gain,) = found.gains
    variant, _ = lift(cell, Question(), [gain.limit])
    (point,) = plan(variant, workers=1)
    assert (gain.makespan, gain.stress) == (point.makespan, point.stress) == (10, 10)
    assert faults(variant, point.schedule) == []


def named(*names: str) -> list[Limit]:
    return [Limit(name, (name,)) for name in names]


def words(some: Any) -> str:
    return "".join(limit.words for limit in some)


@pytest.mark.parametrize(
    "bad", ["c", "a", "h", "ah", "cdf", "bg", "abcdefgh"], ids=lambda bad: f"conflict {bad}"
)
def test_the_filter_finds_the_set_wherever_it_lies(bad: str) -> None:
    asked: list[str] = []

    def possible(some: Any) -> bool:
        asked.append(words(some))
        return not set(bad) <= set(words(some))

    core = minimal_core(named(*"abcdefgh"), possible)
    assert (words(core.items), core.is_minimal) == (bad, True)
    assert len(asked) <= 16


@pytest.mark.parametrize("pair", list(itertools.combinations(["ab", "bc", "cd", "ad"], 2)))
def test_of_two_sets_one_is_found_whole(pair: tuple[str, str]) -> None:
    def possible(some: Any) -> bool:
        return not any(set(bad) <= set(words(some)) for bad in pair)

    core = minimal_core(named(*"abcd"), possible)
    assert words(core.items) in pair
    assert core.is_minimal


def test_where_time_is_too_short_it_says_so() -> None:
    """Whether "b" can be missed is never known, so nothing is concluded about it."""

    def possible(some: Any) -> bool | None:
        return None if "b" not in words(some) else not {"b", "d"} <= set(words(some))

    core = minimal_core(named(*"abcd"), possible)
    assert (words(core.items), core.needed, core.is_minimal) == ("bd", (False, True), False)
    assert core.doubt() == ["There was no time to show that this needs b: fewer may do."]


def test_many_limits_take_few_questions() -> None:
    """Two of 256 contradict each other."""
    asked = 0

    def possible(some: Any) -> bool:
        nonlocal asked
        asked += 1
        return not {"7", "200"} <= {limit.words for limit in some}

    core = minimal_core(named(*map(str, range(256))), possible)
    assert [limit.words for limit in core.items] == ["7", "200"]
    assert asked <= 40


def infeasible_document(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    assert run([*arguments, "--json"]) == 4
    captured = capsys.readouterr()
    document: dict[str, Any] = json.loads(captured.out)
    for sentence in document["infeasible"]["reasons"]:
        assert sentence in captured.err
    return document


def test_limits_of_a_front_are_told_as_data(capsys: pytest.CaptureFixture[str]) -> None:
    document = infeasible_document(
        ["plan", "examples/thesis.yaml", "--max-makespan", "24", "--max-stress", "2", "-q"], capsys
    )
    assert document["schema_version"] == 1
    told = document["infeasible"]
    assert told["message"].endswith("this is proven.")
    time = {
        "words": "the limit on the makespan (24 s)",
        "where": ["question", "max_makespan"],
    }
    load = {"words": "the limit on stress (2)", "where": ["question", "max_stress"]}
    assert told["together"] == [{**time, "needed": True}, {**load, "needed": True}]
    assert told["minimal"] is True
    assert told["without"] == [
        {**time, "helps": True, "makespan": 34, "stress": 2},
        {**load, "helps": True, "makespan": 23, "stress": 7},
    ]


def test_limits_of_a_plan_under_way_are_told_as_data(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan_file = tmp_path / "plan.json"
    assert run(["plan", "examples/thesis.yaml", "-o", str(plan_file), "-q", "--no-risk"]) == 0
    capsys.readouterr()
    replanned = ["replan", "examples/thesis.yaml", "--from", str(plan_file), "--point", "3", "-q"]
    late = [*replanned, "--at", "30", "--set", "tasks.7.deadline=33"]
    told = infeasible_document(late, capsys)["infeasible"]
    assert [item["where"] for item in told["together"]] == [["tasks", "7", "deadline"]]
    assert told["minimal"] is True
    assert told["without"][0]["helps"] is True
