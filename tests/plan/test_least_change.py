"""An old plan in a changed cell: changes are counted exactly, and nothing moves that may not."""

from __future__ import annotations

from collections.abc import Iterator
from random import Random
from typing import Any, NamedTuple

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from tests.plan.brute_force import Plain, Row, latest, moments, schedules, worth
from tests.strategies import cells

import tandem
from tandem.cell.model import Cell
from tandem.errors import CellError, InfeasibleError, UsageError
from tandem.files.generators import layered
from tandem.plan import change_terms
from tandem.plan.door import RefusedScheduleWarning
from tandem.plan.least_change import replan
from tandem.plan.method import Progress
from tandem.plan.replanned import Replan
from tandem.schedule.checker import faults
from tandem.schedule.measures import changeovers
from tandem.schedule.model import Assignment, Schedule

# --- the yardstick --------------------------------------------------------------------------------


def numbers(old: dict[str, Row], rows: tuple[Row, ...], tolerance: float) -> tuple[int, int, int]:
    """How many tasks change operator, order, start: said once more, from the rows alone."""
    new = {row.task: row for row in rows}
    both = [task for task in old if task in new]

    def before(plan: dict[str, Row], task: str, operator: str) -> set[str]:
        return {
            other
            for other in both
            if operator in old[other].who
            and operator in new[other].who
            and plan[other].start < plan[task].start
        }

    others = order = start = 0
    for task in both:
        if set(old[task].who) != set(new[task].who):
            others += 1
        elif any(before(old, task, who) != before(new, task, who) for who in old[task].who):
            order += 1
        elif abs(old[task].start - new[task].start) > tolerance:
            start += 1
    return others, order, start


def rows_of(schedule: Schedule) -> dict[str, Row]:
    return {a.task: Row(a.task, a.start, a.end, a.operators) for a in schedule}


class Still(NamedTuple):
    """What may not move: `fixed` tasks; all else begins at `now` or later or, if `may_stay`, where
    it was.
    """

    fixed: set[str]
    now: float
    may_stay: bool

    def holds(self, old: dict[str, Row], rows: tuple[Row, ...]) -> bool:
        """Whether these rows keep to it."""
        for row in rows:
            was = old.get(row.task)
            as_it_was = was is not None and (row.start, set(row.who)) == (was.start, set(was.who))
            if row.task in self.fixed:
                if not as_it_was:
                    return False
            elif row.start < self.now and not (self.may_stay and as_it_was):
                return False
        return True


def small(random: Random, count: int, rich: bool) -> dict[str, Any]:
    """A cell of three or four tasks that take 1 to 3 seconds, with every feature now and then."""

    def seldom() -> bool:
        return rich and random.random() < 0.35

    operators: dict[str, Any] = {"r": {"kind": "robot"}, "h": {"kind": "human"}}
    tools = {
        "driver": {"capacity": 1, "changeover": {"r": 1, "h": 1}},
        "wrench": {"changeover": {"h": 1}},
    }
    tasks: dict[str, Any] = {}
    names = [str(number) for number in range(1, count + 1)]
    for place, name in enumerate(names):
        who = random.choice((["r"], ["h"], ["r", "h"], ["r", "h"], ["r", "h"]))
        task: dict[str, Any] = {
            "time": {operator: random.randint(1, 3) for operator in who},
            "stress": random.randint(0, 4),
            "after": [other for other in names[:place] if random.random() < 0.25],
        }
        if seldom():
            task["together"] = [{"operators": ["r", "h"], "time": random.randint(1, 2)}]
        if seldom():
            task["zone"] = "jig"
        if seldom():
            task["tool"] = random.choice(("driver", "wrench"))
        if rich and random.random() < 0.15:
            task["release"] = random.randint(1, 3)
        if rich and random.random() < 0.15:
            task["deadline"] = random.randint(6, 10)
        tasks[name] = task
    if seldom():
        operators["h"]["breaks"] = [[2, 4]]
    if seldom():
        operators["r"]["setup"] = 1
    if seldom():
        operators["h"]["tool"] = "driver"
    return {
        "operators": operators,
        "tasks": tasks,
        **({"tools": tools} if rich else {}),
        **({"zones": {"jig": {"capacity": 1}}} if rich else {}),
    }


def changed(random: Random, data: dict[str, Any]) -> dict[str, Any]:
    """The same with one or two other times, or a task more, or less."""
    tasks = {name: dict(task) for name, task in data["tasks"].items()}
    for name in random.sample(list(tasks), random.choice((1, 2))):
        who = random.choice(list(tasks[name]["time"]))
        tasks[name]["time"] = {**tasks[name]["time"], who: random.randint(1, 4)}
    if random.random() < 0.2:
        tasks["new"] = {"time": {"h": 1, "r": 1}, "stress": 1}
        tasks.pop(random.choice(list(data["tasks"])))
        names = set(tasks)
        tasks = {
            name: {**task, "after": [x for x in task.get("after", ()) if x in names]}
            for name, task in tasks.items()
        }
    return {**data, "tasks": tasks}


def questions(
    count: int, tasks: tuple[int, ...] = (3, 4, 4)
) -> Iterator[tuple[int, dict[str, Any], dict[str, Any], Schedule]]:
    """So many changed cells, each with an old plan."""
    seed = found = 0
    while found < count:
        seed += 1
        random = Random(seed)
        before = small(random, random.choice(tasks), rich=seed % 4 > 0)
        after = changed(random, before)
        try:
            front = tandem.plan(tandem.load(before), time_limit=10, workers=1)
            tandem.plan(tandem.load(after), time_limit=10, workers=1)
        except (InfeasibleError, CellError):
            continue
        if moments(after) <= 40:
            found += 1
            yield seed, before, after, front[random.randrange(len(front))].schedule


class Asked(NamedTuple):
    """A question to a changed cell, and the options that say it."""

    old: dict[str, Row]
    still: Still
    options: dict[str, Any]


def asked(random: Random, after: dict[str, Any], old: Schedule) -> Asked:
    """A question with or without a moment, tasks that are done, and tasks to keep."""
    was = rows_of(old)
    both = [name for name in was if name in after["tasks"]]
    at = random.choice((None, None, 1.0, min(3.0, max(row.start for row in was.values()))))
    started = {name for name in both if at is not None and was[name].start < at}
    done: set[str] = set()
    if at is None and random.random() < 0.4:
        done = {random.choice(both)}
        while more := {x for name in done for x in after["tasks"][name]["after"]} - done:
            done |= more
        done = done if done <= set(both) else set()
    keep = {random.choice(both)} if random.random() < 0.3 else set()
    now = max((was[name].end for name in done), default=0.0) if at is None else at
    options = {
        "at": at,
        "done": sorted(done),
        "keep": sorted(keep),
        "allow": random.choice((0.0, 2.0, 30.0)),
        "tolerance": random.choice((0.0, 1.0)),
    }
    return Asked(was, Still(started | done | keep, now, at is None), options)


def stress_in(data: dict[str, Any], old: Schedule) -> float:
    """The stress of a plan in the cell that it was made for."""
    found = worth(data, [(a.task, a.start, a.end, a.operators) for a in old])
    assert found is not None
    return found[1]


def test_no_schedule_at_all_changes_less() -> None:
    """Every schedule of small cells within the limits is looked at, on the grid of their times."""
    moved = refused = 0
    for seed, before, after, old in questions(64, tasks=(3, 3, 3, 4)):
        was, still, options = asked(Random(seed), after, old)
        cell, stress = tandem.load(after), stress_in(before, old)
        try:
            found = replan(cell, old, stress=stress, workers=1, **options)
        except InfeasibleError:
            refused += 1
            everything = schedules(after, min(latest(Plain(after)) / 1e6, 12))
            assert not any(still.holds(was, rows) for _, _, rows in everything), seed
            continue
        best = found[0]
        assert isinstance(best, Replan)
        assert found.complete, seed
        assert best.canonical, seed
        assert faults(cell, best.schedule) == []
        limits = found.question
        assert limits.max_makespan is not None
        assert limits.max_stress is not None
        seen = [
            (numbers(was, rows, options["tolerance"]), makespan, load)
            for makespan, load, rows in schedules(after, limits.max_makespan)
            if still.holds(was, rows) and not begun_too_early(cell, still, old, rows)
        ]
        gentle = [makespan for _, makespan, load in seen if load <= (found.optimum.stress or 0)]
        assert min(gentle) == found.optimum.makespan, seed
        within = [row for row in seen if row[2] <= limits.max_stress]
        assert min(within) == (best.changes.counts, best.makespan, best.stress), (seed, options)
        rows = tuple(rows_of(best.schedule).values())
        assert numbers(was, rows, options["tolerance"]) == best.changes.counts
        moved += sum(best.changes.counts) > 0
    assert moved >= 10, "the questions were too easy"
    assert refused >= 2


def begun_too_early(cell: Cell, still: Still, old: Schedule, rows: tuple[Row, ...]) -> bool:
    """Whether somebody changes tools before now for a task that has not begun, and had not begun to
    by the old plan.
    """

    def begun(schedule: Schedule) -> set[tuple[str, str]]:
        return {
            (change.operator, change.task)
            for change in changeovers(cell, schedule)
            if change.start < still.now
        }

    schedule = Schedule(tuple(Assignment(r.start, r.end, r.task, tuple(r.who)) for r in rows))
    known = Schedule(tuple(a for a in old if a.task in cell.tasks))
    running = {row.task for row in rows if row.task in still.fixed and row.start < still.now}
    early = begun(schedule) - begun(known)
    return any(task not in running for _, task in early)


def test_no_schedule_lies_below_the_front_of_changes_and_makespan() -> None:
    longest = 0
    for seed, before, after, old in questions(12, tasks=(3,)):
        random = Random(seed)
        was, tolerance = rows_of(old), random.choice((0.0, 1.0))
        stress = stress_in(before, old)
        found = replan(
            tandem.load(after), old, stress=stress, tolerance=tolerance, front=True, workers=1
        )
        assert found.complete, seed
        most = found.question.max_stress
        assert most is not None
        least: dict[int, float] = {}
        for makespan, load, rows in schedules(after, latest(Plain(after)) / 1e6):
            count = sum(numbers(was, rows, tolerance))
            if load <= most:
                least[count] = min(makespan, least.get(count, makespan))
        expected: list[tuple[int, float]] = []
        for count in sorted(least):
            if not expected or least[count] < expected[-1][1]:
                expected.append((count, least[count]))
        points = [
            (sum(result.changes.counts), result.makespan)
            for result in reversed(found.results)
            if isinstance(result, Replan)
        ]
        assert points == expected, seed
        longest = max(longest, len(points))
    assert longest >= 2


# --- what is promised -----------------------------------------------------------------------------


def two_tools() -> Cell:
    """A cobot with two tools that take it three seconds to change, and a human."""
    tasks = {
        "a": {"time": {"cobot": 4}, "tool": "gripper"},
        "b": {"time": {"cobot": 4}, "tool": "driver", "after": ["a"]},
        "c": {"time": {"cobot": 4}, "tool": "gripper", "after": ["a"]},
        "d": {"time": {"anna": 9}, "stress": 2},
    }
    return tandem.load(
        {
            "operators": {"cobot": {"kind": "robot"}, "anna": {"kind": "human"}},
            "tasks": tasks,
            "tools": {
                "gripper": {"changeover": {"cobot": 3}},
                "driver": {"changeover": {"cobot": 3}},
            },
        }
    )


def schedule(*rows: tuple[str, str, float, float]) -> Schedule:
    return Schedule(tuple(Assignment(start, end, task, (who,)) for task, who, start, end in rows))


def test_tools_are_not_changed_in_the_past_unless_that_had_begun() -> None:
    """At second 8 the cobot is about to go on with c; by another old plan it is changing tools."""
    going_on = schedule(("a", "cobot", 0, 4), ("c", "cobot", 9, 13), ("b", "cobot", 16, 20),
                        ("d", "anna", 0, 9))  # fmt: skip
    found = replan(two_tools(), going_on, at=8, workers=1)
    assert [a.start for a in found[0].schedule if a.task in "bc"] == [8, 15]
    changing = schedule(("a", "cobot", 0, 4), ("b", "cobot", 9, 13), ("c", "cobot", 16, 20),
                        ("d", "anna", 0, 9))  # fmt: skip
    found = replan(two_tools(), changing, at=8, workers=1)
    begins = {a.task: a.start for a in found[0].schedule}
    assert begins["c"] == 8 or begins["b"] in (8, 9)
    kept = replan(two_tools(), changing, at=8, keep=["b"], workers=1)
    assert {a.task: a.start for a in kept[0].schedule}["b"] == 9


def test_while_nothing_is_said_of_the_time_nothing_is_put_into_the_past() -> None:
    """a is done at second 4; d, which the old plan began at 0, stays or begins now."""
    old = schedule(("a", "cobot", 0, 4), ("c", "cobot", 4, 8), ("b", "cobot", 11, 15),
                   ("d", "anna", 6, 15))  # fmt: skip
    found = replan(two_tools(), old, done=["a"], workers=1)
    begins = {a.task: a.start for a in found[0].schedule}
    assert begins["d"] >= 4
    early = schedule(("a", "cobot", 0, 4), ("c", "cobot", 4, 8), ("b", "cobot", 11, 15),
                     ("d", "anna", 1, 10))  # fmt: skip
    found = replan(two_tools(), early, done=["a"], workers=1)
    assert {a.task: a.start for a in found[0].schedule}["d"] == 1


def test_starts_between_the_ticks_of_the_cell_are_kept_as_they_are() -> None:
    """The old plan has tenths of a second, the cell whole seconds."""
    old = schedule(("a", "cobot", 0, 4), ("c", "cobot", 4.3, 8.3), ("b", "cobot", 11.3, 15.3),
                   ("d", "anna", 0.7, 9.7))  # fmt: skip
    found = replan(two_tools(), old, keep=["c", "d"], tolerance=0, workers=1)
    begins = {a.task: a.start for a in found[0].schedule}
    assert (begins["c"], begins["d"]) == (4.3, 0.7)
    assert found.complete


def test_the_stress_that_can_be_reached_takes_the_place_of_one_that_cannot() -> None:
    cell = two_tools()
    old = tandem.plan(cell, workers=1).knee.schedule
    found = replan(cell, old, stress=1, allow=0, workers=1)
    assert found.optimum.reachable is False
    assert found.optimum.stress == 2
    assert found.optimum.proven
    assert found[0].stress == 2


def test_short_of_time_bounds_are_true_and_nothing_is_called_proven() -> None:
    cell = layered(60, 2, 2, seed=3)
    old = tandem.plan(cell, minimize="makespan", time_limit=2)[0]
    data = cell.to_dict()
    for name in list(data["tasks"])[10:40:3]:
        time = data["tasks"][name]["time"]
        data["tasks"][name]["time"] = {who: seconds + 9 for who, seconds in time.items()}
    slower = tandem.load(data)
    found = replan(slower, old.schedule, stress=old.stress, time_limit=1)
    assert faults(slower, found[0].schedule) == []
    assert found.optimum.bound <= found.optimum.makespan
    if not found.complete:
        assert found[0].status == "feasible"
        assert not found[0].canonical
    assert found[0].bound.makespan <= found[0].makespan


def test_stopped_from_outside_the_best_so_far_is_given() -> None:
    cell = layered(60, 2, 2, seed=3)
    old = tandem.plan(cell, minimize="makespan", time_limit=2)[0]
    seen = []

    def stop(progress: Progress) -> None:
        seen.append(progress)
        raise KeyboardInterrupt

    found = replan(cell, old.schedule, stress=old.stress, on_solution=stop)
    assert found.interrupted
    assert not found.complete
    assert len(seen) == 1
    assert faults(cell, found[0].schedule) == []


def test_a_model_that_counts_wrongly_proves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Were orders left out of the model, two tasks could swap and be called unchanged."""
    monkeypatch.setattr(change_terms, "_order_is_kept", lambda *_: None)
    tasks = {
        "a": {"time": {"anna": 2}},
        "b": {"time": {"anna": 2}},
        "c": {"time": {"cobot": 9}, "after": ["b"]},
    }
    cell = tandem.load(
        {"operators": {"anna": {"kind": "human"}, "cobot": {"kind": "robot"}}, "tasks": tasks}
    )
    old = schedule(("a", "anna", 0, 2), ("b", "anna", 2, 4), ("c", "cobot", 4, 13))
    with pytest.warns(RefusedScheduleWarning, match="counted wrongly"):
        found = replan(cell, old, workers=1)
    assert not found.complete
    assert found[0].status == "feasible"
    assert not found.optimum.proven
    assert faults(cell, found[0].schedule) == []


@settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck))
@given(cells(max_tasks=6), st.integers(0, 99))
def test_where_nothing_has_changed_the_plan_of_any_cell_stays_as_it_is(
    cell: Cell, place: int
) -> None:
    try:
        front = tandem.plan(cell, workers=1)
    except InfeasibleError:
        assume(False)
        return
    old = front[place % len(front)]
    found = replan(cell, old.schedule, stress=old.stress, workers=1)
    assert found.complete
    assert found[0].schedule == old.schedule


def test_fewest_changes_are_no_question_to_a_cell_alone() -> None:
    with pytest.raises(UsageError, match="counted from an old plan"):
        tandem.plan(two_tools(), minimize="change")
