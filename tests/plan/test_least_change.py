"""An old plan in a changed cell: what it changes is counted exactly, and nothing moves that may not."""

from __future__ import annotations

from collections.abc import Iterator
from random import Random
from typing import Any

from tests.plan.brute_force import Plain, Row, latest, moments, schedules

import tandem
from tandem.cell.model import Cell
from tandem.errors import InfeasibleError, UsageError
from tandem.plan.least_change import Replan, replan
from tandem.schedule.checker import faults
from tandem.schedule.model import Schedule

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


def stays(old: dict[str, Row], rows: tuple[Row, ...], fixed: set[str], at: float) -> bool:
    """Whether the fixed tasks are where they were and all others begin from `at` on."""
    for row in rows:
        if row.task in fixed:
            was = old[row.task]
            if row.start != was.start or set(row.who) != set(was.who):
                return False
        elif row.start < at:
            return False
    return True


def small(random: Random, rich: bool) -> dict[str, Any]:
    """A cell of three or four tasks that take 1 to 3 seconds, with every feature now and then."""

    def seldom() -> bool:
        return rich and random.random() < 0.35

    operators: dict[str, Any] = {"r": {"kind": "robot"}, "h": {"kind": "human"}}
    tools = {
        "driver": {"capacity": 1, "changeover": {"r": 1, "h": 1}},
        "wrench": {"changeover": {"h": 1}},
    }
    tasks: dict[str, Any] = {}
    names = [str(number) for number in range(1, random.choice((4, 5, 5)))]
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


def questions(count: int) -> Iterator[tuple[int, dict[str, Any], dict[str, Any], Schedule]]:
    """So many changed cells, each with an old plan."""
    seed = found = 0
    while found < count:
        seed += 1
        random = Random(seed)
        before = small(random, rich=seed % 4 > 0)
        after = changed(random, before)
        try:
            front = tandem.plan(tandem.load(before), time_limit=10, workers=1)
            tandem.plan(tandem.load(after), time_limit=10, workers=1)
        except InfeasibleError:
            continue
        if moments(after) <= 40:
            found += 1
            yield seed, before, after, front[random.randrange(len(front))].schedule


def test_no_schedule_at_all_changes_less() -> None:
    """Every schedule of small cells within the limits is looked at, on the grid of their times."""
    moved = 0
    for seed, before, after, old in questions(60):
        random = Random(seed)
        cell, was = tandem.load(after), rows_of(old)
        stress = tandem.Result(
            tandem.load(before), old, None, None  # type: ignore[arg-type]
        ).stress  # fmt: skip
        at = random.choice((None, None, 1.0, 3.0))
        allow, tolerance = random.choice((0.0, 2.0, 30.0)), random.choice((0.0, 1.0))
        fixed = {name for name, row in was.items() if at is not None and row.start < at}
        fixed &= set(after["tasks"])
        keep = [random.choice([name for name in was if name in after["tasks"]])]
        keep = keep if random.random() < 0.3 else []
        try:
            found = replan(
                cell, old, stress=stress, at=at, keep=keep, allow=allow, tolerance=tolerance,
                workers=1,
            )  # fmt: skip
        except UsageError:
            assert at is not None
            assert at >= max(row.end for row in was.values())
            continue
        except InfeasibleError:
            horizon = min(latest(Plain(after)) / 1e6, 16)
            everything = schedules(after, horizon)
            assert not any(
                stays(was, rows, fixed | set(keep), at or 0.0) for _, _, rows in everything
            ), seed
            continue
        best = found[0]
        assert isinstance(best, Replan) and found.complete and best.canonical, seed
        assert faults(cell, best.schedule) == []
        limit, most = found.question.max_makespan, found.question.max_stress
        assert limit is not None
        assert most is not None
        seen = [
            (numbers(was, rows, tolerance), makespan, load)
            for makespan, load, rows in schedules(after, limit)
            if stays(was, rows, fixed | set(keep), at or 0.0)
        ]
        gentle = [makespan for _, makespan, load in seen if load <= (found.optimum.stress or 0)]
        assert min(gentle) == found.optimum.makespan, seed
        within = [row for row in seen if row[2] <= most]
        assert min(within) == (best.changes.counts, best.makespan, best.stress), (seed, at, keep)
        assert numbers(was, tuple(rows_of(best.schedule).values()), tolerance) == (
            best.changes.counts
        )
        moved += sum(best.changes.counts) > 0
    assert moved >= 10, "the questions were too easy"
