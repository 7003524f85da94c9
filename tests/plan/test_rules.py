"""Dispatch rules: sound schedules at once, and bounds that hold."""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import HealthCheck, given, settings
from tests.schedule.cells import THESIS, gearbox, thesis
from tests.strategies import cells

import tandem
from tandem.cell.model import Cell
from tandem.errors import InfeasibleError, NothingFoundError
from tandem.files.generators import layered
from tandem.plan.bounds import (
    chain_bound,
    least_makespan,
    least_stress,
    load_bound,
    load_prices,
    one_operator_bound,
    preemptive,
)
from tandem.plan.dynamic_programming import solve
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout, append_in_order
from tandem.plan.method import Progress
from tandem.plan.question import Question
from tandem.plan.result import Status
from tandem.plan.rules import RULES, SPECS, build
from tandem.schedule.checker import faults
from tandem.schedule.measures import makespan


@pytest.mark.parametrize("name", RULES)
@pytest.mark.parametrize(
    "cell",
    [thesis(), gearbox(), layered(60, humans=2, robots=1, seed=4)],
    ids=["thesis", "gearbox", "layered"],
)
def test_every_rule_gives_sound_schedules_with_bounds(name, cell):
    front = RULES[name](cell)
    assert not front.complete
    assert front.method == name
    for result in front:
        assert faults(cell, result.schedule) == []
        assert result.status == Status.FEASIBLE
        assert result.bound.makespan <= result.makespan
        assert result.bound.stress <= result.stress


@pytest.mark.parametrize("name", RULES)
def test_every_rule_repeats_for_a_seed(name):
    cell = layered(30, seed=1)
    assert RULES[name](cell, seed=5).results == RULES[name](cell, seed=5).results


def test_chance_depends_on_the_seed():
    cell = layered(30, seed=1)
    assert len({RULES["random"](cell, seed=seed).points[0] for seed in range(5)}) > 1


def test_the_weighted_rule_finds_the_thesis_s_whole_front():
    assert RULES["weighted"](thesis()).points == [(23, 7), (24, 3), (34, 2)]


@pytest.mark.parametrize(
    ("question", "points"),
    [
        (Question("makespan"), [(23, 7)]),
        (Question("stress"), [(34, 2)]),
        (Question("weighted"), [(24, 3)]),
        (Question(max_stress=3), [(24, 3), (34, 2)]),
    ],
)
def test_best_of_n_answers_each_question_of_the_thesis(question, points):
    assert RULES["best-of-n"](thesis(), question).points == points


@pytest.mark.parametrize("name", RULES)
def test_a_rule_that_breaks_a_limit_is_repaired(name):
    assert RULES[name](thesis(), Question("makespan", max_stress=2)).points == [(34, 2)]


@pytest.mark.parametrize("name", RULES)
def test_a_rule_says_when_it_finds_nothing(name):
    with pytest.raises(
        NothingFoundError,
        match=(
            rf"{name}: no schedule that keeps a makespan of at most 20 s and the cell's own limits"
        ),
    ):
        RULES[name](thesis(), Question(max_makespan=20))


@pytest.mark.parametrize("name", RULES)
def test_rules_do_what_only_listed_sets_allow(name):
    cell = thesis().replace(stress_of_set={"3,6": 1.5})
    assert {stress for _, stress in RULES[name](cell).points} == {1.5}


def test_short_and_long_tasks_go_first_where_the_rule_says_so():
    tasks = {
        "long": {"time": {"robot": 5}},
        "short": {"time": {"robot": 1}},
        "middle": {"time": {"robot": 3}, "after": []},
        "end": {"time": {"robot": 1}, "after": ["middle"]},
    }
    cell = Cell.model_validate({"operators": {"robot": {"kind": "robot"}}, "tasks": tasks})

    def order(name: str) -> list[str]:
        return [a.task for a in RULES[name](cell, Question("makespan"))[0].schedule]

    assert order("spt") == ["short", "middle", "end", "long"]
    assert order("lpt") == ["long", "middle", "short", "end"]
    assert order("longest-tail") == ["long", "middle", "short", "end"]


def test_progress_is_told_and_can_stop_it():
    seen: list[Progress] = []

    def stop(progress: Progress) -> None:
        seen.append(progress)
        raise KeyboardInterrupt

    front = RULES["best-of-n"](thesis(), on_solution=stop)
    assert front.interrupted
    assert front.results == seen[0].found


def test_five_hundred_tasks_have_a_good_schedule():
    """At most 2 % above the bound: work goes to whom it suits."""
    layout = Layout.of(Instance.of(layered(500, seed=1)))
    state = build(layout, SPECS["balanced"], Random(0))
    assert state is not None
    assert state.makespan <= 1.02 * least_makespan(layout)


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(cells(max_tasks=5))
def test_bounds_hold_on_cells_with_every_feature(cell):
    try:
        front = solve(cell).points
    except InfeasibleError:
        return
    layout = Layout.of(Instance.of(cell))
    for bound in (chain_bound, one_operator_bound, load_bound, least_makespan):
        assert bound(layout) <= front[0][0] * layout.instance.per_second
    assert least_stress(layout) <= front[-1][1] * layout.instance.per_stress
    assert sum(load_prices(layout)[1]) == pytest.approx(len(cell.operators))


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(cells(max_tasks=6))
def test_appending_a_schedule_in_its_own_order_makes_it_no_longer(cell):
    """The decoder reaches an optimum: any schedule's order and ways give times that are no
    later.
    """
    try:
        front = solve(cell)
    except InfeasibleError:
        return
    instance = Instance.of(cell)
    layout = Layout.of(instance)
    for result in front:
        order, steps = [], [row[0] for row in layout.steps]
        for a in result.schedule:
            task = instance.tasks.index(a.task)
            who = tuple(instance.operators.index(name) for name in a.operators)
            steps[task] = next(step for step in layout.steps[task] if step.operators == who)
            order.append(task)
        again = instance.schedule(append_in_order(layout, order, steps).starts())
        assert faults(cell, again) == []
        assert makespan(again) == result.makespan


def test_work_that_suits_one_operator_is_bounded_by_a_fair_share():
    """Three tasks that take the human twice as long: two for the robot and one for the human fill 6
    s each, and no share is fairer.
    """
    tasks = {name: {"time": {"robot": 3, "human": 6}} for name in "abc"}
    layout = Layout.of(
        Instance.of(Cell.model_validate({"operators": THESIS["operators"], "tasks": tasks}))
    )
    assert load_bound(layout) == 6
    assert chain_bound(layout) == 3
    assert one_operator_bound(layout) == 0


def test_one_operator_who_may_interrupt():
    """Carlier's example by hand: the second task has the longer tail and breaks into the first."""
    assert preemptive([(0, 4, 0), (1, 2, 7)]) == 10
    assert preemptive([(0, 4, 0), (1, 2, 1)]) == 6
    assert preemptive([]) == 0
    assert preemptive([(5, 1, 2)]) == 8


def test_least_stress_gives_each_task_to_whom_it_strains_least():
    front = RULES["least-stress"](thesis())
    assert front.points == [(34, 2)]


def test_earliest_completion_gives_a_task_to_who_ends_it_first_though_busy_now():
    cell = Cell.model_validate(
        {
            "operators": {"quick": {"kind": "robot"}, "slow": {"kind": "robot"}},
            "tasks": {name: {"time": {"quick": 2, "slow": 9}} for name in ("a", "b", "c")},
        }
    )
    (result,) = RULES["earliest-completion"](cell)
    assert {step.operators for step in result.schedule} == {("quick",)}


def test_no_rule_looks_at_every_waiting_task_before_each_step():
    """On a cell of independent tasks, most of which wait all the time, the looks grow with the
    tasks, not with their square.
    """
    looks = []
    for tasks in (200, 400):
        layout = Layout.of(Instance.of(layered(tasks, layers=1, seed=1)))
        for name, rule in SPECS.items():
            count = 0

            def counted(end, step, rule=rule):
                nonlocal count
                count += 1
                return rule.time * end + rule.stress * step.stress

            assert rule.build(layout, rule.priority(layout, Random(0)), counted) is not None
            looks.append((name, count))
    small, large = dict(looks[: len(SPECS)]), dict(looks[len(SPECS) :])
    assert all(large[name] < 3 * small[name] for name in SPECS), (small, large)


def test_after_its_limit_a_search_makes_no_second_schedule():
    found = []
    front = tandem.plan(layered(300, seed=2), time_limit=1e-9, on_solution=found.append)
    assert len(front) == 1
    assert not front.complete
    told = {point.schedule.digest for progress in found for point in progress.found}
    assert told == {front[0].schedule.digest}
