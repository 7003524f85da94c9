"""Limits of stress that cannot be kept together: the least that can is said, and is the least."""

from __future__ import annotations

from typing import Any

import pytest
from tests.plan.brute_force import front_in_order

from tandem.cell.model import Cell
from tandem.errors import InfeasibleError
from tandem.files.validate import cell_of
from tandem.plan.least_limits import least_limit
from tandem.plan.methods import plan
from tandem.plan.question import Question


def pair(anna: float, ben: float, **more: Any) -> dict[str, Any]:
    """Two people; the loads of five tasks are 30, 25, 20, 15.5 and 8: 98.5 in all."""
    loads = {"a": 30, "b": 25, "c": 20, "d": 15.5, "e": 8}
    return {
        "operators": {
            "anna": {"kind": "human", "stress_limit": anna},
            "ben": {"kind": "human", "stress_limit": ben},
        },
        "tasks": {
            name: {"time": {"anna": 4, "ben": 5}, "stress": load} for name, load in loads.items()
        },
        **more,
    }


def told(cell: Cell, **asked: Any) -> list[str]:
    with pytest.raises(InfeasibleError) as caught:
        plan(cell, workers=1, **asked)
    return list(caught.value.reasons)


def test_of_equal_limits_the_least_equal_one_is_said_and_the_least_beside_the_other() -> None:
    said = told(cell_of(pair(40, 40)))
    assert said[:4] == [
        "the stress limit of anna (40) and the stress limit of ben (40) cannot be kept together.",
        "The least limit that each of them can keep is 50.",
        "The least limit that anna can keep with ben at 40 is 60.5.",
        "The least limit that ben can keep with anna at 40 is 60.5.",
    ]


@pytest.mark.parametrize(
    ("least", "less"),
    [((50, 50), (49.5, 49.5)), ((60.5, 40), (60, 40)), ((40, 60.5), (40, 60))],
)
def test_what_is_said_can_be_kept_and_nothing_less(
    least: tuple[float, float], less: tuple[float, float]
) -> None:
    """By the brute force, which shares nothing with the planner."""
    assert front_in_order(pair(*least)) != []
    assert front_in_order(pair(*less)) == []


def test_a_limit_of_one_person_is_answered_with_the_least_for_that_person() -> None:
    data = pair(10, 1000)
    data["tasks"]["a"]["time"] = {"anna": 4}
    said = told(cell_of(data))
    assert said[:2] == [
        "the stress limit of anna (10) cannot be kept.",
        "The least limit that anna can keep is 30.",
    ]


def test_the_limit_on_the_makespan_is_kept_besides() -> None:
    """All within 13 s: at most three tasks are Anna's and two are Ben's."""
    cell = cell_of(pair(45, 45))
    assert least_limit(cell, Question(), ["anna", "ben"], seconds=10) == 50
    assert least_limit(cell, Question(max_makespan=13), ["anna", "ben"], seconds=10) == 50
    assert least_limit(cell, Question(max_makespan=12), ["anna"], seconds=10) == 53.5
    assert least_limit(cell, Question(max_makespan=9), ["anna", "ben"], seconds=10) is None


def test_the_cells_other_rules_are_kept_besides() -> None:
    cell = cell_of(pair(45, 45, same_operator=[["a", "b"]]))
    assert least_limit(cell, Question(), ["anna", "ben"], seconds=10) == 55
    assert front_in_order(pair(55, 55, same_operator=[["a", "b"]])) != []
    assert front_in_order(pair(54.5, 54.5, same_operator=[["a", "b"]])) == []
