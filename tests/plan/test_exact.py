"""The exact method: what it proves, what it repeats, what it says when it is stopped."""

from __future__ import annotations

import pytest
from tests.boards import OPTIMA
from tests.schedule.cells import thesis

from tandem.errors import InfeasibleError, NothingFoundError, UsageError
from tandem.files.generators import layered
from tandem.lab.yu2020.board import desk, random_board
from tandem.plan.methods import METHODS, describe, plan
from tandem.plan.question import Question
from tandem.plan.result import Status
from tandem.plan.rules import RULES
from tandem.schedule.checker import faults


@pytest.mark.parametrize("method", ["exact", "exhaustive"])
def test_the_front_of_the_thesis_cell(method):
    front = plan(thesis(), method=method)
    assert front.points == [(23, 7), (24, 3), (34, 2)]
    assert front.complete
    assert all(
        result.status == Status.OPTIMAL and faults(thesis(), result.schedule) == []
        for result in front
    )
    assert [(result.bound.makespan, result.bound.stress) for result in front] == front.points
    assert front.knee is front[1]


@pytest.mark.parametrize(
    ("asked", "point"),
    [
        ({"minimize": "makespan"}, (23, 7)),
        ({"minimize": "stress"}, (34, 2)),
        ({"minimize": "weighted", "weights": (1, 0.5)}, (24, 3)),
        ({"minimize": "weighted", "weights": (1, 0)}, (23, 7)),
        ({"minimize": "weighted", "weights": (0, 1)}, (34, 2)),
        ({"minimize": "makespan", "max_stress": 6.5}, (24, 3)),
        ({"minimize": "stress", "max_makespan": 33.9}, (24, 3)),
    ],
)
@pytest.mark.parametrize("method", ["exact", "exhaustive"])
def test_one_best_schedule(method, asked, point):
    front = plan(thesis(), method=method, **asked)
    assert front.points == [point]
    assert front.complete


@pytest.mark.parametrize(
    ("asked", "points"),
    [({"max_stress": 3}, [(24, 3), (34, 2)]), ({"max_makespan": 33}, [(23, 7), (24, 3)])],
)
def test_limits_cut_the_front(asked, points):
    front = plan(thesis(), **asked)
    assert front.points == points
    assert front.complete


@pytest.mark.parametrize("seed", range(4))
def test_one_worker_and_a_seed_repeat_exactly(seed):
    cell = layered(14, 1, 1, seed=seed)
    one, two = (plan(cell, workers=1, seed=seed, time_limit=None) for _ in range(2))
    assert one.complete
    assert [result.schedule for result in one] == [result.schedule for result in two]


def test_nothing_is_worse_than_the_best_rule():
    """The rules' schedules are the incumbent from the first moment on."""
    cell = layered(120, 2, 2, seed=3)
    best = min(
        RULES[name](cell, Question("makespan"))[0].makespan
        for name in ("balanced", "longest-tail", "heft", "spt")
    )
    assert plan(cell, minimize="makespan", time_limit=0.5)[0].makespan <= best


def test_a_hint_is_where_it_begins():
    cell = layered(60, 2, 1, seed=5)
    good = plan(cell, minimize="makespan", time_limit=3)[0]
    assert (
        plan(cell, minimize="makespan", time_limit=0.3, hint=good.schedule)[0].makespan
        <= good.makespan
    )


def test_when_time_runs_out_every_point_carries_its_bounds():
    front = plan(layered(80, 2, 2, seed=1), time_limit=3)
    assert not front.complete
    for result in front:
        assert result.bound.makespan <= result.makespan
        assert result.bound.stress <= result.stress
        assert (result.status == Status.OPTIMAL) == (
            (result.bound.makespan, result.bound.stress) == (result.makespan, result.stress)
        )
        assert faults(front.cell, result.schedule) == []
    assert front.points == sorted(front.points)
    assert len(front) > 1


def test_progress_only_gets_better_and_can_stop_the_search():
    seen = []

    def watch(progress):
        seen.append(min(result.makespan for result in progress.found))
        if len(seen) == 3:
            raise KeyboardInterrupt

    front = plan(layered(100, 1, 1, seed=2), minimize="makespan", time_limit=60, on_solution=watch)
    assert front.interrupted
    assert seen == sorted(seen, reverse=True)
    assert front[0].makespan <= seen[-1]


def test_infeasible_limits_are_explained_in_the_cells_words():
    with pytest.raises(InfeasibleError) as caught:
        plan(thesis(), max_makespan=24, max_stress=2)
    together, without_time, without_stress = caught.value.reasons
    assert (
        together
        == "the limit on the makespan (24 s) and the limit on stress (2) cannot be kept together."
    )
    assert (
        without_time
        == "Without the limit on the makespan (24 s) it works: 34 s with a stress of 2."
    )
    assert without_stress == "Without the limit on stress (2) it works: 23 s with a stress of 7."


def test_only_the_limits_that_matter_are_blamed():
    """Task 7 must end by 22 s, which nothing allows; the human's stress limit and the break are
    innocent.
    """
    cell = thesis()
    tasks = {**cell.tasks, "7": cell.tasks["7"].model_copy(update={"deadline": 22.0})}
    human = cell.operators["human"].model_copy(
        update={"stress_limit": 30.0, "breaks": ((100.0, 110.0),)}
    )
    with pytest.raises(
        InfeasibleError,
        match=(
            r"the deadline of task 7 \(22 s\) cannot be kept\.\n.*Without .* it works: 23 s with a"
            r" stress of 7"
        ),
    ) as caught:
        plan(cell.replace(tasks=tasks, operators={**cell.operators, "human": human}))
    assert len(caught.value.reasons) == 2


def test_wrong_options_are_refused():
    with pytest.raises(UsageError, match=r"no method 'exat'.*Did you mean 'exact'"):
        plan(thesis(), method="exat")
    with pytest.raises(UsageError, match="time limit 0"):
        plan(thesis(), time_limit=0)
    with pytest.raises(UsageError, match="weights"):
        plan(thesis(), minimize="weighted", weights=(0, 0))


def test_nothing_found_is_no_proof():
    """The desk can be done in 94 s, but no rule does it in less than 95."""
    with pytest.raises(NothingFoundError, match="whether there is one is open"):
        plan(desk().to_cell(), minimize="makespan", max_makespan=94, time_limit=0.02)


@pytest.mark.parametrize(
    ("seed", "optimum"),
    list(enumerate(OPTIMA)),
)
def test_the_optimum_of_yus_boards(seed, optimum):
    front = plan(random_board(seed=seed).to_cell(), minimize="makespan")
    assert front.points == [(optimum, 0)]
    assert front.complete


def test_the_optimum_of_yus_desk():
    front = plan(desk().to_cell(), minimize="makespan", time_limit=120)
    assert front.points == [(94, 0)]
    assert front.complete


def test_every_method_says_what_it_does():
    assert all(describe(name) for name in METHODS)
