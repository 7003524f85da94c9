"""Stations that repeat to draw and to print: a front that the planner finds in a moment, and one
made by hand.
"""

from __future__ import annotations

from functools import cache

from tests.draw.cells import rows, thesis

from tandem.cell.model import Cell
from tandem.plan.cycle.methods import plan_cycle
from tandem.plan.cycle.question import CycleQuestion
from tandem.plan.cycle.result import CycleBound, CycleFront, CycleResult
from tandem.plan.result import Status
from tandem.schedule.cycle import PeriodicSchedule


@cache
def thesis_cycles() -> CycleFront:
    """(19, 12), (20, 7), (24, 3), (34, 2)."""
    return plan_cycle(thesis(), workers=1)


def bench() -> Cell:
    """Two people and a cobot: a joint task, a tool with changeovers, a zone for two, set-up,
    breaks, labels, a name that could be a formula.
    """
    return Cell.model_validate(
        {
            "name": "Bench <b> with two people & a cobot",
            "operators": {
                "anna": {"kind": "human", "label": "Anna", "setup": 5},
                "ben": {"kind": "human", "label": "Ben", "breaks": [[90, 120]]},
                "cobot": {"kind": "robot", "label": "Cobot on the rail", "tool": "gripper"},
            },
            "tools": {
                "gripper": {"changeover": {"cobot": 2}},
                "driver": {"capacity": 2, "changeover": {"cobot": 3}},
            },
            "zones": {"jig": {"capacity": 2}},
            "tasks": {
                "place": {
                    "label": "Place the housing",
                    "part": "housing",
                    "time": {"cobot": 6},
                    "tool": "gripper",
                    "zone": "jig",
                },
                "=grease": {"time": {"anna": 4.5, "ben": 5}, "stress": 1},
                "lift": {
                    "label": "Lift the shaft in",
                    "together": [{"operators": ["anna", "cobot"], "time": 5, "stress": 2}],
                    "after": ["place", "=grease"],
                    "zone": "jig",
                },
                "screw": {
                    "label": "Drive 4 screws",
                    "time": {"cobot": 7},
                    "tool": "driver",
                    "after": ["lift"],
                },
                "check": {"time": {"anna": 9, "ben": 8}, "stress": 1, "after": ["screw"]},
                "label": {"time": {"ben": 2}, "after": ["check"]},
            },
        }
    )


def bench_pattern() -> PeriodicSchedule:
    """Every 24 s: the cobot works 18 s and changes tools for 5 s."""
    return PeriodicSchedule(
        rows(
            ("place", "cobot", 0, 6),
            ("=grease", "anna", 0, 4.5),
            ("lift", "anna+cobot", 6, 11),
            ("screw", "cobot", 14, 21),
            ("check", "ben", 22, 30),
            ("label", "ben", 40, 42),
        ),
        24,
    )


def bench_front() -> CycleFront:
    """That pattern, not proven, within a takt of 26 s."""
    result = CycleResult(bench(), bench_pattern(), Status.FEASIBLE, CycleBound(23, 3, 1))
    question = CycleQuestion(takt=26)
    return CycleFront(
        bench(), (result,), False, "exact", "cp-sat 9.14.6206", 0, 0.05, question=question
    )


FRONTS = {"thesis": thesis_cycles, "bench": bench_front}
