"""An old plan in a changed cell: changes are counted exactly, and nothing moves that may not."""

from __future__ import annotations

from collections.abc import Iterator
from random import Random
from typing import Any, NamedTuple

from tests.plan.brute_force import Plain, Row, latest, moments, schedules, worth

import tandem
from tandem.cell.model import Cell
from tandem.errors import CellError, InfeasibleError
from tandem.plan.least_change import replan
from tandem.plan.replanned import Replan
from tandem.schedule.checker import faults
from tandem.schedule.measures import changeovers
from tandem.schedule.model import Assignment, Schedule

THESIS: dict[str, Any] = {
    "operators": {"robot": {"kind": "robot"}, "human": {"kind": "human"}},
    "tasks": {
        "1": {"time": {"robot": 9, "human": 10}, "stress": 10},
        "2": {"time": {"robot": 7, "human": 8}, "stress": 11},
        "3": {"time": {"human": 10}, "stress": 2},
        "4": {"time": {"robot": 2}, "after": ["1", "2"]},
        "5": {"time": {"robot": 4, "human": 2}, "stress": 4, "after": ["3"]},
        "6": {"time": {"robot": 10, "human": 3}, "stress": 1, "after": ["1", "2", "4"]},
        "7": {
            "time": {"robot": 2, "human": 4},
            "stress": 5,
            "after": ["1", "2", "3", "4", "5", "6"],
        },
    },
}


def thesis(**times: dict[str, int]) -> Cell:
    """The thesis's cell with other times: `t6={"human": 7}`."""
    tasks = {
        name: {**task, "time": {**task["time"], **times.get(f"t{name}", {})}}
        for name, task in THESIS["tasks"].items()
    }
    return tandem.load({**THESIS, "tasks": tasks})


def plan_of(cell: Cell, place: int = 1) -> Schedule:
    return tandem.plan(cell, time_limit=10, workers=1)[place].schedule


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
    for seed, before, after, old in questions(50):
        was, still, options = asked(Random(seed), after, old)
        cell, stress = tandem.load(after), stress_in(before, old)
        try:
            found = replan(cell, old, stress=stress, workers=1, **options)
        except InfeasibleError:
            refused += 1
            everything = schedules(after, min(latest(Plain(after)) / 1e6, 16))
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
    for seed, before, after, old in questions(15, tasks=(3,)):
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
