"""How the time of a front is spent: on every open gap, by every worker, and never at the price of a
claim that is not proven.
"""

from __future__ import annotations

from math import inf

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.strategies import cells

from tandem.errors import InfeasibleError, NothingFoundError
from tandem.files.generators import layered
from tandem.plan import sweep
from tandem.plan.knee import knee_index
from tandem.plan.methods import METHODS, plan
from tandem.plan.question import Question
from tandem.plan.sweep import Sweep
from tandem.schedule.checker import faults


@pytest.fixture
def asked(monkeypatch):
    """The questions of a run in the order in which they were asked, each with its round and who
    works beside it.
    """
    seen = []
    ask = Sweep._ask

    def watched(self, goal):
        seen.append((self.round, goal, tuple(self.running.values())))
        ask(self, goal)

    monkeypatch.setattr(Sweep, "_ask", watched)
    return seen


def next_to_no_work(monkeypatch, work=1e-4):
    """The first questions get so little that hardly any is answered."""
    monkeypatch.setattr(sweep, "FIRST_WORK", work)


def truth(cell, question=Question()):
    """The proven front, by the search that shares no code with CP-SAT."""
    try:
        return METHODS["exhaustive"](cell, question, time_limit=60).points
    except InfeasibleError:
        return []


def assert_nothing_is_claimed_that_is_not_so(front, points):
    """Every bound holds against the true front, every point called optimal is on it, and every
    schedule is sound.
    """
    for result in front:
        assert faults(front.cell, result.schedule) == []
        quickest = min(
            (makespan for makespan, stress in points if stress <= result.stress), default=inf
        )
        gentlest = min(
            (stress for makespan, stress in points if makespan <= result.makespan), default=inf
        )
        assert result.bound.makespan <= quickest <= result.makespan
        assert result.bound.stress <= gentlest <= result.stress
        if result.status == "optimal":
            assert (result.makespan, result.stress) in points
    if front.bound_front:
        for point in points:
            assert any(m <= point[0] and s <= point[1] for m, s in front.bound_front)
    if points and front.is_knee_certain:
        assert front.points[front.knee_place] == points[knee_index(points)]
    if front.complete:
        assert front.points == points
        assert not front.bound_front


@pytest.mark.parametrize(
    ("tasks", "humans", "robots", "seed", "points"),
    [(31, 1, 1, 4, 33), (30, 2, 1, 1, 39), (40, 1, 1, 0, 55), (32, 1, 1, 3, 33)],
)
def test_a_front_of_thirty_to_forty_tasks_is_proven_to_its_end(tasks, humans, robots, seed, points):
    """As many points as the plain walk gives, from cap to cap with CP-SAT's own order of search;
    the ends are asked for alone.
    """
    cell = layered(tasks, humans, robots, seed=seed)
    front = plan(cell, time_limit=None)
    assert front.complete
    assert all(result.status == "optimal" for result in front)
    assert len(front) == points
    assert [front.points[0]] == plan(cell, minimize="makespan", time_limit=None).points
    assert [front.points[-1]] == plan(cell, minimize="stress", time_limit=None).points


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("workers", [1, 3])
def test_every_open_gap_is_asked_about_again_until_it_is_closed(seed, workers, asked, monkeypatch):
    next_to_no_work(monkeypatch)
    cell = layered(12, 1, 1, seed=seed)
    front = plan(cell, workers=workers, time_limit=None)
    assert front.complete
    assert front.points == truth(cell)
    rounds = [round_ for round_, _, _ in asked]
    assert rounds == sorted(rounds)


def test_a_question_that_withstood_is_asked_again_with_more_work_and_none_twice_in_a_round(
    asked, monkeypatch
):
    next_to_no_work(monkeypatch)
    plan(layered(25, 2, 1, seed=1), workers=1, time_limit=None)
    in_round = [(round_, goal) for round_, goal, _ in asked]
    assert len(set(in_round)) == len(in_round)
    goals = [goal for _, goal in in_round]
    again = {goal for goal in goals if goals.count(goal) > 1}
    assert again
    assert max(round_ for round_, _ in in_round) >= 2


@pytest.mark.parametrize(("tasks", "workers"), [(20, 2), (32, 3), (45, 4)])
def test_no_worker_is_idle_while_a_gap_is_open(tasks, workers, monkeypatch):
    next_to_no_work(monkeypatch, 1e-2)
    seen = []
    hear, run = sweep.hear, Sweep.run

    def watched_run(self):
        seen.append(self)
        run(self)

    def watched(inbox, seconds):
        mine = seen[-1]
        assert len(mine.running) == workers or not mine.archive.gaps or mine.effort.left() <= 0
        hear(inbox, seconds)

    monkeypatch.setattr(Sweep, "run", watched_run)
    monkeypatch.setattr(sweep, "hear", watched)
    plan(layered(tasks, 1, 1, seed=7), workers=workers, time_limit=4)
    assert seen


def test_with_fewer_gaps_than_workers_several_work_on_the_same_one(asked):
    cell = layered(12, 1, 0, seed=0)  # a human alone: all schedules have the same stress
    front = plan(cell, workers=4, time_limit=None)
    assert len(front) == 1
    assert front.complete
    goals = [goal for _, goal, _ in asked]
    assert len(goals) in (0, 4) or any(goal in beside for _, goal, beside in asked)


def test_the_whole_front_is_seen_before_any_part_of_it_is_asked_twice(asked, monkeypatch):
    """A cell of which little can be proven: the first round enters the front over the whole range
    of stress.
    """
    cell = layered(50, 2, 2, seed=0)
    ask = Sweep._ask

    def one_round(self, goal):
        if self.round == 1:
            raise KeyboardInterrupt
        ask(self, goal)

    monkeypatch.setattr(Sweep, "_ask", one_round)
    front = plan(cell, workers=1, time_limit=None)
    caps = [
        goal.max_stress for round_, goal, _ in asked if goal.time and goal.max_stress is not None
    ]
    low, high = front[-1].stress, front[0].stress
    assert front.interrupted
    assert {int(4 * (cap - low) / (high - low + 1)) for cap in caps} >= {0, 1, 2}
    assert len(front) > 4


OPTIONS = {
    "deadline": None,
    "suppress_health_check": [
        HealthCheck.too_slow,
        HealthCheck.filter_too_much,
        HealthCheck.data_too_large,
    ],
}


@settings(max_examples=40, **OPTIONS)
@given(cells(max_tasks=5), st.sampled_from([1, 2]), st.integers(1, 12))
def test_what_is_cut_short_claims_nothing_that_is_not_proven(cell, workers, answers):
    """Stopped at some improvement, with hardly any work for each question; deadlines, tools, zones
    and limits are drawn too.
    """
    seen = []

    def stop(_):
        seen.append(None)
        if len(seen) == answers:
            raise KeyboardInterrupt

    work, sweep.FIRST_WORK = sweep.FIRST_WORK, 1e-4
    try:
        front = plan(cell, workers=workers, time_limit=None, on_solution=stop)
    except InfeasibleError:
        assert truth(cell) == []
        return
    finally:
        sweep.FIRST_WORK = work
    assert_nothing_is_claimed_that_is_not_so(front, truth(cell))


@pytest.mark.parametrize("seconds", [0.01, 0.05, 0.2, 0.5])
@pytest.mark.parametrize("asked_for", [{}, {"max_stress": 30}, {"max_makespan": 120}])
def test_bounds_hold_however_little_time_there_is(seconds, asked_for):
    cell = layered(13, 1, 1, seed=5)
    points = truth(cell, Question(**asked_for))
    try:
        front = plan(cell, time_limit=seconds, **asked_for)
    except NothingFoundError:
        return  # says nothing
    assert_nothing_is_claimed_that_is_not_so(front, points)


@pytest.mark.parametrize(("tasks", "humans", "robots"), [(24, 1, 1), (34, 1, 1), (26, 2, 1)])
def test_one_worker_asks_the_same_questions_again(tasks, humans, robots, asked):
    cell = layered(tasks, humans, robots, seed=3)
    runs = []
    for _ in range(2):
        asked.clear()
        front = plan(cell, workers=1, seed=5, time_limit=None)
        runs.append(([result.schedule for result in front], list(asked)))
    assert front.complete
    assert runs[0] == runs[1]


def test_one_worker_with_nothing_to_improve_still_proves():
    """No rule finds a schedule this quick, so there is none to begin with."""
    front = plan(
        layered(31, 1, 1, seed=4), minimize="stress", max_makespan=223, workers=1, time_limit=120
    )
    assert front.points == [(223, 76)]
    assert front.complete
