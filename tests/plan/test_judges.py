"""Three judges that share no code must agree: the checker, the exhaustive search, and the exact
solver; and rules may not beat them.
"""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from tests.plan.brute_force import Point, front_in_order, front_of_all
from tests.plan.damage import DAMAGES
from tests.plan.tick_by_tick import is_sound
from tests.schedule.cells import (
    gearbox,
    gearbox_schedule,
    glued,
    glued_schedule,
    thesis,
    thesis_schedule,
)
from tests.strategies import cells

from tandem.cell.model import Cell
from tandem.errors import InfeasibleError, NothingFoundError
from tandem.plan.dynamic_programming import solve
from tandem.plan.methods import METHODS
from tandem.plan.question import Question
from tandem.plan.rules import RULES
from tandem.schedule.checker import faults
from tandem.schedule.measures import exact, makespan
from tandem.schedule.model import Assignment, Schedule

OPTIONS = {
    "deadline": None,
    "suppress_health_check": [
        HealthCheck.too_slow,
        HealthCheck.filter_too_much,
        HealthCheck.data_too_large,
    ],
}


def points(cell: Cell, method: str = "exhaustive", question: Question = Question()) -> list[Point]:
    """The proven front, each schedule of it checked; empty when it is proven that there is none."""
    try:
        front = METHODS[method](cell, question, time_limit=60, seed=0, workers=1)
    except InfeasibleError:
        return []
    assert front.complete
    for result in front:
        assert (
            faults(
                cell,
                result.schedule,
                max_makespan=question.max_makespan,
                max_stress=question.max_stress,
            )
            == []
        )
        assert is_sound(cell, result.schedule)
    return front.points


@settings(max_examples=40, **OPTIONS)
@given(cells(max_tasks=4))
def test_exhaustive_search_finds_what_trying_all_orders_finds(cell):
    assert points(cell) == front_in_order(cell.to_dict())


@settings(max_examples=40, **OPTIONS)
@given(cells(max_tasks=2))
def test_exhaustive_search_finds_what_trying_all_times_finds(cell):
    """No order, no argument: every task at every moment."""
    found = points(cell)
    assert found == front_of_all(cell.to_dict(), max((time for time, _ in found), default=12.0))


@settings(max_examples=40, **OPTIONS)
@given(cells(max_tasks=6))
def test_the_exact_solver_and_exhaustive_search_give_the_same_front(cell):
    assert points(cell, "exact") == points(cell, "exhaustive")


@settings(max_examples=30, **OPTIONS)
@given(
    cells(max_tasks=5),
    st.sampled_from(("makespan", "stress", "weighted")),
    st.floats(0, 1),
    st.floats(0, 1),
)
def test_single_questions_are_answered_by_a_point_of_the_front(cell, minimize, time, load):
    """With limits between the front's ends, exhaustive search picks the right one of the points
    that keep them.
    """
    front = points(cell)
    assume(front)
    longest, hardest = (
        front[0][0] + time * (front[-1][0] - front[0][0]),
        front[-1][1] + load * (front[0][1] - front[-1][1]),
    )
    kept = [(t, s) for t, s in front if t <= longest and s <= hardest]
    best = {
        "makespan": lambda p: p,
        "stress": lambda p: (p[1], p[0]),
        "weighted": lambda p: (exact(p[0]) + 2 * exact(p[1]), p[0]),
    }[minimize]
    question = Question(minimize, weights=(1.0, 2.0), max_makespan=longest, max_stress=hardest)
    assert points(cell, "exhaustive", question) == ([min(kept, key=best)] if kept else [])


@settings(max_examples=60, **OPTIONS)
@given(cells(max_tasks=6), st.sampled_from(sorted(RULES)), st.integers(0, 3))
def test_no_rule_beats_the_proven_front(cell, rule, seed):
    front = points(cell)
    try:
        results = list(RULES[rule](cell, seed=seed))
    except NothingFoundError:
        return
    for result in results:
        assert faults(cell, result.schedule) == []
        assert is_sound(cell, result.schedule)
        assert any(time <= result.makespan and stress <= result.stress for time, stress in front)
        assert result.bound.makespan <= front[0][0]
        assert result.bound.stress <= front[-1][1]


def fixture() -> Cell:
    """People may share the fixture, a person and a robot may not."""
    return Cell.model_validate({
        "operators": {
            "anna": {"kind": "human"}, "ben": {"kind": "human"}, "cobot": {"kind": "robot"},
        },
        "tasks": {
            "left": {"time": {"anna": 4.0}, "zone": "fixture"},
            "right": {"time": {"ben": 3.0}, "zone": "fixture"},
            "weld": {"time": {"cobot": 5.0}, "zone": "fixture"},
        },
        "zones": {"fixture": {"capacity": 2, "apart": ["human", "robot"]}},
    })  # fmt: skip


def two_parts() -> Cell:
    """One press, two parts; Anna and Ben put them in and take them out, the press also stamps."""
    return Cell.model_validate({
        "operators": {
            "anna": {"kind": "human"}, "ben": {"kind": "human"},
            "press": {"kind": "machine", "holds": [["in 1", "out 1"], ["in 2", "out 2"]]},
        },
        "tasks": {
            "in 1": {"time": {"anna": 4.0}},
            "run 1": {"time": {"press": 10.0}, "after": ["in 1"]},
            "out 1": {"time": {"ben": 3.0}, "after": ["run 1"]},
            "in 2": {"time": {"ben": 4.0}},
            "run 2": {"time": {"press": 10.0}, "after": ["in 2"]},
            "out 2": {"time": {"anna": 3.0}, "after": ["run 2"]},
            "stamp": {"time": {"press": 2.0}},
        },
    })  # fmt: skip


def some_schedule(cell: Cell) -> Schedule:
    """A sound schedule of the cell, if there is one."""
    try:
        return solve(cell, Question("makespan")).results[0].schedule
    except InfeasibleError:
        assume(False)
        raise


@pytest.mark.parametrize("damage", DAMAGES)
@settings(max_examples=15, **OPTIONS)
@given(cell=cells(max_tasks=5))
def test_a_schedule_damaged_in_any_one_way_is_caught(damage, cell):
    plan = some_schedule(cell)
    assert faults(cell, plan) == []
    for other, damaged, limits in damage(cell, plan):
        assert faults(other, damaged, **limits), (damaged, limits)


def test_every_damage_has_something_to_break():
    """The test above would pass on cells in which a damage finds nothing to do."""
    table = thesis().replace(stress_of_set={"3,5,6": 7, "3": 1})
    known = [
        (gearbox(), gearbox_schedule()),
        (table, thesis_schedule()),
        (glued(), glued_schedule()),
    ]
    known += [(cell, some_schedule(cell)) for cell in (fixture(), two_parts())]
    for damage in DAMAGES:
        broken = [case for cell, plan in known for case in damage(cell, plan)]
        assert broken, damage.__name__
        for other, damaged, limits in broken:
            assert faults(other, damaged, **limits), (damage.__name__, damaged)


@settings(max_examples=150, **OPTIONS)
@given(cells(max_tasks=5), st.data())
def test_the_checker_and_watching_every_moment_agree_on_shaken_schedules(cell, data):
    """Tasks are moved by a few of the cell's steps or given to others; most of it breaks something,
    some of it does not.
    """
    plan = some_schedule(cell)
    rows = list(plan)
    step = min(exact(mode.time) for name in cell.tasks for mode in cell.modes(name))
    for _ in range(data.draw(st.integers(1, 3))):
        place = data.draw(st.integers(0, len(rows) - 1))
        a = rows[place]
        mode = data.draw(st.sampled_from(cell.modes(a.task)))
        start = exact(a.start) + data.draw(st.integers(-4, 6)) * step / data.draw(
            st.sampled_from((1, 2))
        )
        rows[place] = Assignment(
            float(start), float(start + exact(mode.time)), a.task, mode.operators
        )
    shaken = Schedule(tuple(rows))
    assert (faults(cell, shaken) == []) == is_sound(cell, shaken)


def test_the_two_yardsticks_know_the_thesis():
    assert front_of_all(
        thesis().replace(tasks={name: thesis().tasks[name] for name in "12"}).to_dict(), 20
    ) == [
        (9.0, 11.0),
        (10.0, 10.0),
        (16.0, 0.0),
    ]
    assert is_sound(thesis(), thesis_schedule())
    late = Schedule(
        tuple(Assignment(a.start + 1, a.end + 1, a.task, a.operators) for a in thesis_schedule())
    )
    assert is_sound(thesis(), late)
    assert makespan(late) == 24
    one_late = [
        Assignment(a.start + (a.task == "2"), a.end + (a.task == "2"), a.task, a.operators)
        for a in thesis_schedule()
    ]
    assert not is_sound(thesis(), Schedule(tuple(one_late)))
