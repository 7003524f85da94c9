"""Cells to draw, with schedules that a person can check by hand or that the checker passes."""

from __future__ import annotations

import random
from decimal import Decimal
from functools import cache
from pathlib import Path

from tandem.cell.model import Cell
from tandem.cell.parts import Mode
from tandem.files.load import load
from tandem.plan.result import Bound, Front, Result, Status
from tandem.schedule.measures import exact, made_ready, stress
from tandem.schedule.model import Assignment, Schedule

THESIS = {
    "name": "Exemplary assembly (Kinat 2023, chapter 6)",
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


def thesis() -> Cell:
    return Cell.model_validate(THESIS)


def rows(*found: tuple[str, str, float, float]) -> Schedule:
    return Schedule(
        tuple(
            Assignment(float(start), float(end), task, tuple(who.split("+")))
            for task, who, start, end in found
        )
    )


def thesis_schedules() -> list[Schedule]:
    robot, human = "robot", "human"
    return [
        rows(
            ("1", robot, 0, 9),
            ("2", robot, 9, 16),
            ("4", robot, 16, 18),
            ("3", human, 0, 10),
            ("5", human, 10, 12),
            ("6", human, 18, 21),
            ("7", robot, 21, 23),
        ),
        rows(
            ("3", human, 0, 10),
            ("1", robot, 0, 9),
            ("2", robot, 9, 16),
            ("4", robot, 16, 18),
            ("5", robot, 18, 22),
            ("6", human, 18, 21),
            ("7", robot, 22, 24),
        ),
        rows(
            ("3", human, 0, 10),
            ("1", robot, 0, 9),
            ("2", robot, 9, 16),
            ("4", robot, 16, 18),
            ("5", robot, 18, 22),
            ("6", robot, 22, 32),
            ("7", robot, 32, 34),
        ),
    ]


def thesis_front() -> Front:
    return front_of(thesis(), thesis_schedules())


def front_of(
    cell: Cell, schedules: list[Schedule], *, proven: bool = True, slack: float = 0.0
) -> Front:
    """A front of these schedules; `slack` is how far the bounds of an unproven one lie below."""
    results = []
    for schedule in schedules:
        bare = Result(cell, schedule, Status.OPTIMAL, Bound(0, 0))
        bound = Bound(bare.makespan * (1 - slack), bare.stress * (1 - slack))
        results.append(Result(cell, schedule, Status.OPTIMAL if proven else Status.FEASIBLE, bound))
    return Front(cell, tuple(results), proven, "exact", "cp-sat 9.14.6206", 0, 0.05)


def gearbox() -> Cell:
    """Two humans, two robots; joint tasks, a tool with changeovers, breaks, deadlines, labels."""
    return Cell.model_validate(
        {
            "name": "Gearbox, two people and two robots",
            "operators": {
                "anna": {"kind": "human", "label": "Anna", "breaks": [[30, 40]], "tool": "driver"},
                "ben": {"kind": "human", "label": "Ben", "stress_limit": 30},
                "cobot": {"kind": "robot", "label": "Cobot 1", "tool": "gripper"},
                "cobot2": {"kind": "robot", "label": "Cobot 2"},
            },
            "tools": {
                "driver": {"capacity": 2, "changeover": {"cobot": 4, "anna": 2, "ben": 2}},
                "gripper": {"capacity": 2, "changeover": {"cobot": 3, "cobot2": 3}},
            },
            "tasks": {
                "housing": {
                    "label": "Place housing",
                    "time": {"anna": 6.5},
                    "together": [{"operators": ["anna", "cobot"], "time": 8, "stress": 1}],
                    "stress": 6,
                    "tool": None,
                },
                "shaft": {
                    "label": "Insert shaft",
                    "time": {"anna": 9, "ben": 8, "cobot2": 12},
                    "stress": {"anna": 3, "ben": 2},
                    "after": ["housing"],
                },
                "gear1": {
                    "label": "Press gear 1",
                    "time": {"cobot": 7, "cobot2": 7},
                    "after": ["shaft"],
                    "tool": "gripper",
                    "deadline": 30,
                },
                "gear2": {
                    "label": "Press gear 2",
                    "time": {"cobot": 7, "cobot2": 7},
                    "after": ["shaft"],
                    "tool": "gripper",
                },
                "seal": {
                    "label": "Grease the seal",
                    "time": {"anna": 4.2, "ben": 4.2},
                    "stress": 2,
                    "after": ["housing"],
                },
                "cover": {
                    "label": "Set the cover on together",
                    "together": [{"operators": ["ben", "cobot2"], "time": 5, "stress": 2}],
                    "after": ["gear1", "gear2", "seal"],
                },
                "screws": {
                    "label": "Tighten 8 screws",
                    "time": {"anna": 14, "cobot": 10},
                    "stress": 8,
                    "tool": "driver",
                    "after": ["cover"],
                    "deadline": 70,
                },
                "label": {
                    "label": "Label",
                    "time": {"ben": 2, "anna": 2},
                    "stress": 0.5,
                    "after": ["cover"],
                },
                "check": {
                    "label": "Final inspection",
                    "time": {"anna": 6, "ben": 6},
                    "stress": 1,
                    "after": ["screws", "label"],
                },
            },
        }
    )


def desk() -> Cell:
    """A board in the manner of Yu's desk: 53 pieces in 15 rows, each resting on the pieces under
    it; symmetric halves.
    """
    halves = [
        [2, 2],
        [1, 2, 3, 4],
        [1, 2, 3, 4],
        [2, 2],
        [1, 2, 3, 4],
        [1, 2, 3, 4],
        [2, 2],
        [2, 2],
        [1, 2, 3, 4],
        [1, 2, 3, 4],
        [2, 2],
        list(range(1, 9)),
        list(range(1, 9)),
        [2, 2],
        [4],
    ]
    kinds = "RRHERHERRHRRHRR"
    tasks, under, counts = {}, [], {"R": 0, "H": 0, "E": 0}
    for kind, times in zip(kinds, halves, strict=True):
        width, row = 8 // len(times), []
        for place, time in enumerate(times):
            counts[kind] += 1
            name = f"{'ABC'['RHE'.index(kind)]}{counts[kind]}"
            left, right = place * width, (place + 1) * width
            resting = [other for other, a, b in under if a < right and b > left]
            who = {"R": ["robot"], "H": ["human"], "E": ["robot", "human"]}[kind]
            tasks[name] = {
                "time": dict.fromkeys(who, time),
                "stress": time if "human" in who else 0,
                "after": resting,
            }
            row.append((name, left, right))
        under = row
    return Cell.model_validate(
        {
            "name": "Desk of 53 pieces (after Yu)",
            "operators": {"robot": {"kind": "robot"}, "human": {"kind": "human"}},
            "tasks": tasks,
        }
    )


def eighteen() -> Cell:
    """Eighteen tasks with labels for two people and a robot; `eighteen.yaml` beside this file."""
    return load(Path(__file__).with_name("eighteen.yaml"))


def layered(tasks: int, *, seed: int = 0, operators: int = 4) -> Cell:
    """A random layered cell; the same seed gives the same one."""
    dice = random.Random(seed)
    people = {
        f"{kind} {i + 1}": {"kind": kind}
        for i in range(operators // 2)
        for kind in ("human", "robot")
    }
    made: dict[str, dict[str, object]] = {}
    names = [f"T{i + 1:03d}" for i in range(tasks)]
    for place, name in enumerate(names):
        near = names[max(0, place - 12) : place]
        who = dice.sample(sorted(people), dice.randint(1, len(people)))
        made[name] = {
            "time": {w: dice.randint(2, 30) for w in who},
            "stress": dice.randint(0, 9),
            "after": dice.sample(near, min(len(near), dice.choice([0, 1, 1, 2]))),
        }
    return Cell.model_validate(
        {"name": f"Layered cell of {tasks} tasks", "operators": people, "tasks": made}
    )


def greedy(cell: Cell, *, dislike: float = 0.0) -> Schedule:
    """A sound schedule of a cell without zones and limits: always the task and mode that ends
    first; stress costs `dislike` seconds each.
    """
    free = dict.fromkeys(cell.operators, Decimal(0))
    ended: dict[str, Decimal] = {}
    done: dict[str, list[Assignment]] = {name: [] for name in cell.operators}
    found: list[Assignment] = []

    def change_of(task: str, mode: Mode, who: str) -> Decimal:
        if not (cell.tools or cell.walking):
            return Decimal(0)
        last = Assignment(0, 0, task, mode.operators)
        return exact(made_ready(cell, who, [*done[who], last])[-1].seconds)

    def start_of(task: str, mode: Mode) -> Decimal:
        ready = max(
            [exact(cell.tasks[task].release), *(ended[first] for first in cell.tasks[task].after)]
        )
        change = {who: change_of(task, mode, who) for who in mode.operators}
        start = max([ready, *(free[who] + change[who] for who in mode.operators)])
        moved = True
        while moved:
            moved = False
            for who in mode.operators:
                for off, back, _ in cell.operators[who].times_off:
                    if start - change[who] < exact(back) and exact(off) < start + exact(mode.time):
                        start, moved = exact(back) + change[who], True
        return start

    while len(ended) < len(cell.tasks):
        ready = [
            name
            for name, task in cell.tasks.items()
            if name not in ended and all(first in ended for first in task.after)
        ]
        options = [
            (start_of(name, mode), name, mode) for name in ready for mode in cell.modes(name)
        ]
        start, name, mode = min(
            options,
            key=lambda o: (
                o[0]
                + exact(o[2].time)
                + Decimal(repr(dislike)) * sum(map(exact, o[2].stress.values())),
                o[0],
                o[1],
            ),
        )
        end = start + exact(mode.time)
        found.append(Assignment(float(start), float(end), name, mode.operators))
        ended[name] = end
        for who in mode.operators:
            free[who] = end
            done[who].append(found[-1])
    return Schedule(tuple(found))


def front_by_rule(
    cell: Cell, dislikes: list[float], *, proven: bool = True, slack: float = 0.0
) -> Front:
    """What `greedy` finds with different dislikes of stress, without what is dominated."""
    found = {}
    for dislike in dislikes:
        schedule = greedy(cell, dislike=dislike)
        found[max(a.end for a in schedule), stress(cell, schedule)] = schedule
    kept = [
        p for p in sorted(found) if not any(q != p and q[0] <= p[0] and q[1] <= p[1] for q in found)
    ]
    return front_of(cell, [found[point] for point in kept], proven=proven, slack=slack)


@cache
def gearbox_front() -> Front:
    return front_by_rule(gearbox(), [0, 0.2, 0.5, 1, 2, 4])


@cache
def layered_front() -> Front:
    return front_by_rule(layered(120), [x / 5 for x in range(30)], proven=False, slack=0.1)
