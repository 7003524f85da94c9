"""Tandem plans and runs the work that people and collaborative robots share.

    cell = tandem.load("cell.yaml")
    front = tandem.plan(cell, time_limit=10, seed=0)  # the trade-off of makespan and stress
    tandem.faults(cell, front.knee.schedule)          # [] or sentences

Importing it is quick: each name is fetched from its home when it is first used.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from tandem.cell.model import Cell
    from tandem.cell.parts import Operator, Task, Together, Tool, Zone
    from tandem.errors import (
        CellError,
        Fault,
        InfeasibleError,
        NothingFoundError,
        TandemError,
        UnsoundScheduleError,
        UsageError,
    )
    from tandem.files.load import load
    from tandem.plan.cycle.methods import plan_cycle
    from tandem.plan.cycle.question import CycleQuestion
    from tandem.plan.cycle.result import CycleFront, CycleResult
    from tandem.plan.least_change import replan
    from tandem.plan.methods import plan
    from tandem.plan.question import Question
    from tandem.plan.result import Front, Result
    from tandem.schedule.checker import faults
    from tandem.schedule.model import Assignment, Schedule

    judge: Any  # `tandem.dispatch.evaluation.trial.judge`; rooms below it import this face

__all__ = [
    "Assignment",
    "Cell",
    "CellError",
    "CycleFront",
    "CycleQuestion",
    "CycleResult",
    "Fault",
    "Front",
    "InfeasibleError",
    "NothingFoundError",
    "Operator",
    "Question",
    "Result",
    "Schedule",
    "TandemError",
    "Task",
    "Together",
    "Tool",
    "UnsoundScheduleError",
    "UsageError",
    "Zone",
    "faults",
    "judge",
    "load",
    "plan",
    "plan_cycle",
    "replan",
]

_HOME = {
    "tandem.files.load": ("load",),
    "tandem.cell.model": ("Cell",),
    "tandem.cell.parts": ("Operator", "Task", "Together", "Tool", "Zone"),
    "tandem.dispatch.evaluation.trial": ("judge",),
    "tandem.errors": (
        "CellError",
        "Fault",
        "InfeasibleError",
        "NothingFoundError",
        "TandemError",
        "UnsoundScheduleError",
        "UsageError",
    ),
    "tandem.plan.cycle.methods": ("plan_cycle",),
    "tandem.plan.cycle.question": ("CycleQuestion",),
    "tandem.plan.cycle.result": ("CycleFront", "CycleResult"),
    "tandem.plan.least_change": ("replan",),
    "tandem.plan.question": ("Question",),
    "tandem.plan.result": ("Front", "Result"),
    "tandem.schedule.checker": ("faults",),
    "tandem.schedule.model": ("Assignment", "Schedule"),
}


def __getattr__(name: str) -> Any:
    # a room and a verb: tandem.plan(cell) plans, tandem.plan.methods is a module; and a room alone
    if name in ("plan", "ergonomics"):
        return importlib.import_module(f"tandem.{name}")
    for home, names in _HOME.items():
        if name in names:
            return getattr(importlib.import_module(home), name)
    raise AttributeError(f"module 'tandem' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
