"""Behind a proven point stands one schedule: the first by the rule, in every run."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from random import Random
from typing import Any

import pytest
from tests.fuzz.cells import cell as random_cell
from tests.plan.brute_force import first_by_rule, moments
from tests.plan.first_by_rule import first_of_equals

from tandem.cell.model import Cell
from tandem.errors import CellError, InfeasibleError, UsageError
from tandem.files.generators import layered
from tandem.files.load import load
from tandem.files.validate import cell_of
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout
from tandem.plan.methods import METHODS, plan
from tandem.plan.question import Question
from tandem.plan.result import Front
from tandem.plan.starts import moved_up
from tandem.schedule.checker import faults
from tandem.schedule.measures import exact
from tandem.schedule.model import Assignment, Schedule

EXAMPLES = Path(__file__).parents[2] / "examples"
FEW = ("thesis", "cover", "gearbox", "line-of-four", "strain-index")


def small_cells(seeds: range) -> Iterator[tuple[dict[str, Any], Cell]]:
    """Random cells with every feature, those left out that are refused."""
    for seed in seeds:
        data = random_cell(Random(seed))
        try:
            yield data, cell_of(data)
        except CellError:
            continue


def front_of(cell: Cell, **options: Any) -> Front | None:
    """The proven answer; None where there is none."""
    try:
        front = plan(cell, time_limit=None, **options)
    except InfeasibleError:
        return None
    assert front.complete
    assert front.ended_by == "proof"
    assert all(result.canonical for result in front)
    return front


def document(front: Front) -> str:
    """As `tandem plan --json` prints it, but for the time it took."""
    whole = front.to_dict()
    del whole["wall_s"]
    return json.dumps(whole)


def test_it_is_the_schedule_that_the_rule_names_when_all_are_tried():
    compared = 0
    for data, cell in small_cells(range(1, 100)):
        if moments(data) ** len(data["tasks"]) > 25_000 or (front := front_of(cell)) is None:
            continue
        for result in front:
            right = first_by_rule(data, (result.makespan, result.stress))
            said = [(a.task, a.start, a.end, set(a.operators)) for a in result.schedule]
            assert sorted(said, key=lambda row: row[0]) == sorted(
                [(task, start, end, set(who)) for task, start, end, who in right],
                key=lambda row: row[0],
            )
            compared += 1
    assert compared > 30


@pytest.mark.parametrize(
    "cell",
    [
        *(pytest.param(load(EXAMPLES / f"{name}.yaml"), id=name) for name in FEW),
        *(
            pytest.param(layered(tasks, humans, robots, seed=seed), id=f"layered-{tasks}-{seed}")
            for tasks, humans, robots, seed in ((8, 1, 1, 1), (8, 2, 1, 2))
        ),
    ],
)
def test_dynamic_programming_without_a_solver_names_the_same(cell):
    front = front_of(cell)
    assert front is not None
    instance = Instance.of(cell)
    layout = Layout.of(instance)
    for result in front:
        ticks = int(exact(result.makespan) * instance.per_second)
        units = int(exact(result.stress) * instance.per_stress)
        assert result.schedule == instance.schedule(first_of_equals(layout, ticks, units))


def test_exact_and_exhaustive_search_show_the_same_schedules():
    compared = 0
    for _, cell in small_cells(range(200, 224)):
        for question in (Question(), Question("weighted", (1.0, 1.0)), Question("stress")):
            fronts = [
                front_of(cell, question=question, method=method, workers=1)
                for method in ("exact", "exhaustive")
            ]
            if fronts[0] is not None and fronts[1] is not None:
                assert fronts[0].results == fronts[1].results
                compared += 1
            else:
                assert fronts == [None, None]
    assert compared > 24


def test_runs_with_one_two_and_four_workers_and_another_seed_show_the_same():
    for cell in (load(EXAMPLES / "thesis.yaml"), layered(10, 2, 1, seed=4), changeovers()):
        for minimize in ("front", "makespan"):
            runs = [front_of(cell, minimize=minimize, workers=count) for count in (1, 2, 4)]
            assert len({document(front) for front in runs if front is not None}) == 1
            other = front_of(cell, minimize=minimize, seed=7)
            assert other is not None
            assert runs[0] is not None
            assert other.results == runs[0].results


def test_a_hint_and_the_end_of_a_front_asked_alone_change_nothing():
    cell = layered(9, 2, 1, seed=5)
    front = front_of(cell)
    assert front is not None
    late = Schedule(
        tuple(replace(a, start=a.start + 50, end=a.end + 50) for a in front[0].schedule)
    )
    for hint in (late, front[-1].schedule):
        hinted = front_of(cell, hint=hint)
        assert hinted is not None
        assert hinted.results == front.results
    quickest, gentlest = front_of(cell, minimize="makespan"), front_of(cell, minimize="stress")
    assert quickest is not None
    assert gentlest is not None
    assert (quickest[0], gentlest[0]) == (front[0], front[-1])


def changeovers() -> Cell:
    """Tools that change hands, a break, a zone and a joint task."""
    return cell_of(
        {
            "operators": {
                "anna": {"kind": "human", "breaks": [[6, 9]]},
                "ben": {"kind": "human", "tool": "driver"},
                "cobot": {"kind": "robot", "setup": 2},
            },
            "tools": {
                "driver": {"changeover": {"anna": 1, "ben": 2, "cobot": 3}},
                "press": {"changeover": {"anna": 2, "ben": 1, "cobot": 2}},
            },
            "zones": {"jig": {}},
            "tasks": {
                "a": {"time": {"anna": 4, "ben": 3}, "stress": 2, "tool": "press"},
                "b": {"time": {"anna": 2, "cobot": 5}, "stress": 3, "tool": "driver"},
                "c": {"time": {"ben": 4, "cobot": 4}, "stress": 1, "zone": "jig", "after": ["a"]},
                "d": {"together": [{"operators": ["anna", "ben"], "time": 3}], "stress": 1},
                "e": {"time": {"anna": 3, "ben": 3}, "stress": 4, "zone": "jig", "release": 5},
                "f": {"time": {"cobot": 3, "ben": 2}, "stress": 2, "tool": "press", "after": ["b"]},
                "g": {"time": {"anna": 2, "cobot": 3}, "stress": 1, "after": ["c", "d"]},
            },
        }
    )


def fits_earlier(cell: Cell, schedule: Schedule) -> list[str]:
    """Tasks that could start earlier while the others stay, as the checker sees it; all moments at
    which something ends, and those a changeover later, are tried.
    """
    changes = {0.0, *(s for tool in cell.tools.values() for s in tool.changeover.values())}
    ends = {0.0, *(a.end for a in schedule), *(task.release for task in cell.tasks.values())}
    for operator in cell.operators.values():
        ends |= {off.end for off in operator.times_off}
    moments = {round(end + change, 6) for end in ends for change in changes}
    return [
        f"{a.task} at {moment}"
        for a in schedule
        for moment in moments
        if moment < a.start and not faults(cell, with_start(schedule, a, moment))
    ]


def with_start(schedule: Schedule, moved: Assignment, start: float) -> Schedule:
    """The schedule with one task at another time."""
    end = round(start + moved.end - moved.start, 6)
    return Schedule(tuple(replace(a, start=start, end=end) if a == moved else a for a in schedule))


def test_no_task_could_start_earlier_alone():
    looked_at = 0
    cells = [cell for _, cell in small_cells(range(300, 340))]
    for cell in (*cells, changeovers(), layered(21, 1, 1, seed=1)):
        try:
            front = plan(cell, work=0.1)
        except InfeasibleError:
            continue
        for result in front:
            assert fits_earlier(cell, result.schedule) == []
            looked_at += 1
    assert looked_at > 40


def test_moving_up_fills_gaps_and_keeps_who_does_what():
    for seed in range(4):
        cell = layered(25, 2, 1, seed=seed)
        instance = Instance.of(cell)
        clock, starts = 3, [(0, 0)] * len(instance.tasks)
        for task in instance.order:
            way = seed % len(instance.ways[task])
            starts[task] = (way, clock)
            clock += instance.ways[task][way].ticks + 1
        moved = moved_up(Layout.of(instance), tuple(starts))
        assert [way for way, _ in moved] == [way for way, _ in starts]
        assert all(new <= old for (_, new), (_, old) in zip(moved, starts, strict=True))
        schedule = instance.schedule(moved)
        assert faults(cell, schedule) == []
        assert fits_earlier(cell, schedule) == []


def test_stress_is_spread_over_people():
    data = {
        "operators": {"anna": {"kind": "human"}, "ben": {"kind": "human"}},
        "tasks": {
            str(i): {"time": {"anna": 2, "ben": 2}, "stress": hard}
            for i, hard in enumerate((5, 3, 2))
        }
        | {"last": {"time": {"anna": 4}, "stress": 0, "after": ["0", "1", "2"]}},
    }
    front = front_of(cell_of(data))
    assert front is not None
    alone = [
        a.task
        for a in front[0].schedule
        if a.operators == front[0].schedule.of("anna")[0].operators
    ]
    assert sorted(task for task in alone if task != "last") in (["0"], ["1", "2"])


def test_a_run_that_time_cuts_short_says_so():
    front = plan(layered(60, 2, 2, seed=0), time_limit=0.3)
    assert not front.complete
    assert front.ended_by == front.to_dict()["ended_by"] == "time"
    assert not any(result.canonical for result in front if result.status == "feasible")


def test_a_limit_on_work_repeats_what_is_not_proven_too():
    cell = layered(31, 2, 2, seed=0)
    runs = [plan(cell, work=0.2, seed=3, workers=count) for count in (1, 2)]
    assert runs[0].ended_by == "work"
    assert document(runs[0]) == document(runs[1])
    assert plan(cell, work=0.2, seed=4).points != [] != runs[0].points


@pytest.mark.parametrize("method", METHODS)
def test_every_method_takes_a_limit_on_work(method):
    fronts = [
        plan(load(EXAMPLES / "thesis.yaml"), method=method, work=0.01, seed=1) for _ in range(2)
    ]
    assert document(fronts[0]) == document(fronts[1])
    assert fronts[0].ended_by in ("proof", "work")


def test_exhaustive_search_ends_when_its_work_is_done():
    front = plan(layered(12, 2, 1, seed=1), method="exhaustive", work=0.01)
    assert front.ended_by == "work"
    assert not front.complete


@pytest.mark.parametrize("work", [0, -1, float("nan"), float("inf")])
def test_no_work_is_refused(work):
    with pytest.raises(UsageError, match=r"work .*: must be a number of more than 0\."):
        plan(load(EXAMPLES / "thesis.yaml"), work=work)


def test_of_equal_weighted_sums_the_quickest_is_taken():
    """A second more costs the human's two units less: at equal weights of 1 and 0.5 both are
    worth the same.
    """
    data = {
        "operators": {"anna": {"kind": "human"}, "cobot": {"kind": "robot"}},
        "tasks": {"a": {"time": {"anna": 4, "cobot": 5}, "stress": 2}},
    }
    for method in ("exact", "exhaustive"):
        front = front_of(cell_of(data), minimize="weighted", weights=(1.0, 0.5), method=method)
        assert front is not None
        assert front.points == [(4.0, 2.0)]


def test_an_interrupt_in_the_last_step_keeps_what_was_found(monkeypatch):
    from tandem.plan import canonical

    def interrupted(self: Any, result: Any) -> Any:
        raise KeyboardInterrupt

    monkeypatch.setattr(canonical._LastStep, "settle", interrupted)
    front = plan(load(EXAMPLES / "thesis.yaml"))
    assert front.points == [(23, 7), (24, 3), (34, 2)]
    assert front.interrupted
    assert front.ended_by == "interrupted"
    assert not any(result.canonical for result in front)


def test_the_recommended_point_has_its_turn_first(monkeypatch):
    from tandem.plan import canonical

    settle, seen = canonical._LastStep.settle, []

    def watched(self: Any, result: Any) -> Any:
        seen.append((result.makespan, result.stress))
        return settle(self, result)

    monkeypatch.setattr(canonical._LastStep, "settle", watched)
    front = plan(load(EXAMPLES / "thesis.yaml"), workers=1)
    assert front.knee_place == 1
    assert seen == [front.points[1], front.points[0], front.points[2]]


def test_who_reads_the_values_alone_gets_them_without_the_last_step():
    cell = load(EXAMPLES / "thesis.yaml")
    front = plan(cell, settle=False)
    assert front.complete
    assert front.points == plan(cell).points
    assert not any(result.canonical for result in front)
    assert all(faults(cell, result.schedule) == [] for result in front)
