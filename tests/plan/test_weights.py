"""Weights and objectives with long decimals: exact answers or a refusal, never a number that does
not fit.
"""

from __future__ import annotations

from fractions import Fraction
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.plan.brute_force import front_in_order

from tandem.errors import CellError
from tandem.files.generators import layered
from tandem.files.validate import cell_of
from tandem.plan import exact
from tandem.plan.methods import METHODS, plan
from tandem.plan.question import Question
from tandem.plan.weights import MOST_COUNTED, simplest
from tandem.schedule.checker import faults

LARGE = st.integers(1, 10**18)
SMALL = st.integers(1, 40)


def order(first: int, second: int, ticks: int, units: int) -> int:
    """Which of two schedules is better under these weights, if one takes so many ticks more and the
    other so many units more.
    """
    difference = first * ticks - second * units
    return (difference > 0) - (difference < 0)


@settings(max_examples=300)
@given(
    st.one_of(
        st.tuples(SMALL, SMALL),
        st.tuples(LARGE, LARGE),
        st.just((1, 10**300)),
        st.just((10**300, 7)),
    ),
    st.integers(0, 12),
    st.integers(0, 12),
)
def test_the_simplest_weights_order_every_two_schedules_as_the_given_ones_do(
    weights, most_ticks, most_units
):
    found = simplest(*weights, most_ticks, most_units)
    for ticks in range(most_ticks + 1):
        for units in range(most_units + 1):
            assert order(*found, ticks, units) == order(*weights, ticks, units)
    assert 0 < found[0] <= 2 * most_units + 1
    assert 0 < found[1] <= 2 * most_ticks + 1


def test_weights_that_are_simple_already_stay_as_they_are():
    assert simplest(3, 5, 100, 100) == (3, 5)
    assert simplest(10**15, 2 * 10**15, 100, 100) == (1, 2)


def numbers(random: Random, decimals: int, most: float) -> float:
    return (
        round(random.choice((1.0, most, random.random() * most)) * random.random(), decimals) or 1.0
    )


def wide_cell(random: Random, decimals: int) -> dict:
    """Two or three tasks, times and stress of up to so many decimals and up to nearly as large as a
    cell may have.
    """
    most = min(0.1 * 2**40 / 10**decimals, 9e6)
    operators = {"anna": {"kind": "human"}, "ben": {"kind": "human"}, "cobot": {"kind": "robot"}}
    tasks = {}
    for name in ("a", "b", "c")[: random.randint(2, 3)]:
        who = random.sample(list(operators), random.randint(1, 3))
        tasks[name] = {
            "time": {one: numbers(random, decimals, most) for one in who},
            "stress": {one: numbers(random, decimals, most / 3) for one in ("anna", "ben")},
        }
    if random.random() < 0.5:
        tasks["b"]["after"] = ["a"]
    return {"operators": operators, "tasks": tasks}


def some_weights(random: Random) -> tuple[float, float]:
    """From a millionth to a million, with up to 15 decimals."""

    def one() -> float:
        return random.choice(
            (1e-6, 1e6, 1.0, round(random.random(), 15), round(10 ** random.uniform(-6, 6), 15))
        )

    return one() or 1.0, one() or 1.0


@pytest.mark.parametrize("decimals", [0, 3, 5, 6])
@pytest.mark.parametrize("seed", range(12))
def test_wide_numbers_and_long_weights_are_answered_exactly(seed, decimals):
    random = Random(f"{seed} {decimals}")
    data = wide_cell(random, decimals)
    cell, weights = cell_of(data), some_weights(random)
    right = front_in_order(data)
    front = METHODS["exact"](cell, workers=1)
    assert front.points == right
    assert front.complete
    values = [
        sum(
            Fraction(repr(weight)) * Fraction(repr(part))
            for weight, part in zip(weights, point, strict=True)
        )
        for point in right
    ]
    best = [point for point, value in zip(right, values, strict=True) if value == min(values)]
    for method in ("exact", "exhaustive"):
        weighted = METHODS[method](cell, Question("weighted", weights), workers=1)
        assert weighted.complete
        assert weighted.points[0] in best
        cut = METHODS[method](
            cell, Question("stress", max_makespan=right[0][0] + 1e-15, max_stress=1e300), workers=1
        )
        assert cut.points == [right[0]]


def test_some_of_these_numbers_are_beyond_what_one_sum_can_count():
    """Or the test above would not show that they are answered in another way."""
    data = wide_cell(Random("2 6"), 6)
    search = exact._Search(cell_of(data), Question(), None, None, 0, 1, None)
    assert search._most_ticks() * search._most_stress() > MOST_COUNTED


@pytest.mark.parametrize(
    "question",
    [
        Question(),
        Question("makespan", max_stress=4e4),
        Question("weighted", (0.123456789012345, 98765.4321)),
    ],
)
def test_larger_cells_with_wide_numbers_are_planned_too(question):
    """More tasks than CP-SAT takes alone: neighbourhoods weigh stress against time as well."""
    cell = layered(34, 2, 1, seed=2)
    tasks = {
        name: {
            **task,
            "time": {who: round(time * 123.456789, 6) for who, time in task["time"].items()},
            "stress": task.get("stress", 0) * 517.123457,
        }
        for name, task in cell.to_dict()["tasks"].items()
    }
    wide = cell_of(
        {
            **cell.to_dict(),
            "tasks": {
                name: {**task, "stress": round(task["stress"], 6)} for name, task in tasks.items()
            },
        }
    )
    front = plan(wide, question, workers=1, time_limit=3)
    assert all(faults(wide, result.schedule) == [] for result in front)


@pytest.mark.parametrize(
    "change",
    [
        {"time": {"anna": 0.123456789012345}},
        {"time": {"anna": 1}, "stress": 0.000000000000001},
        {"time": {"anna": 1}, "release": 1.0000001},
        {"time": {"anna": 1}, "deadline": 3.123456789},
    ],
)
def test_more_decimals_than_can_be_counted_are_refused_with_how_many_would_do(change):
    with pytest.raises(CellError, match=r"has more than 6 decimals\. Round it"):
        cell_of({"operators": {"anna": {"kind": "human"}}, "tasks": {"a": change}})


def test_too_wide_a_range_is_refused_with_the_step_that_would_do():
    with pytest.raises(
        CellError, match=r"too wide a range to plan exactly\. Round the times to 1e-05 s"
    ):
        cell_of(
            {
                "operators": {"anna": {"kind": "human"}},
                "tasks": {"a": {"time": {"anna": 9e6}}, "b": {"time": {"anna": 0.000001}}},
            }
        )


def test_weights_beyond_counting_do_no_harm_where_there_is_no_stress() -> None:
    """A robot's tasks in millionths of seconds, and a weight of stress that no solver can hold: it
    weighs nothing.
    """
    robot = {
        "kind": "robot",
        "breaks": [[5.568393, 6.881986], [14.60234, 15.655153]],
        "setup": 2.132975,
    }
    cell = cell_of({
        "operators": {"robot": robot},
        "tasks": {
            "a": {"time": {"robot": 4.617091}, "stress": 2.790245, "release": 1.405225},
            "b": {"time": {"robot": 7.189979}, "stress": 1.692779, "after": ["a"]},
            "c": {"time": {"robot": 2.868211}, "stress": 3.931621, "after": ["b"]},
        },
    })  # fmt: skip
    front = exact.solve(cell, Question("weighted", (1e-6, 1e6)))
    assert (front.points, front.complete) == ([(25.713343, 0.0)], True)
