"""How long a decision takes with 50 ms: the decider itself, on the clock and in its own time on a
core, what the floor waits for, and how often the guard cut.

    python benchmarks/replan_latency.py [--policy auto] [--episodes 8] [--budget 50] [-o
    benchmarks/results/replan_latency.json]

Random layered cells with one robot and one human (30 tasks, seed 1), two of each (30 tasks, seed 3)
and two robots with one human (20 tasks, seed 2), and Yu's desk (53 tasks), beside a person who
picks at random now and then and whose pace differs. An assembly is a shift, as `tandem dispatch
--simulate` runs it: a decider that is late is not waited for, a rule answers. The target is that
the decider ends within its budget, so that it is never late. It limits its work, not its time: its
own time on a core is what it would take where cores are free.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from tandem.cell.model import Cell
from tandem.dispatch.deciders.memory import settled_memory
from tandem.dispatch.deciders.policy import Decision, Options, Policy
from tandem.dispatch.deciders.table import policy
from tandem.dispatch.journal import Journal
from tandem.dispatch.lookahead.branch_and_bound import measured
from tandem.dispatch.lookahead.objective import SECONDS
from tandem.dispatch.shift.deadline import InTime
from tandem.dispatch.shift.live import FOR_PLANNING, RULE, Settings, Shift
from tandem.dispatch.shift.simulated import SimulatedFloor
from tandem.dispatch.situation.model import Situation
from tandem.files.generators import layered
from tandem.lab.yu2020.board import desk
from tandem.learn.training.runs import versions

PEOPLE = "random:0.3+pace:0.8..1.6"
CELLS: dict[str, Callable[[], Cell]] = {
    "30 tasks, one robot, one human": lambda: layered(30, humans=1, robots=1, seed=1),
    "30 tasks, two robots, two humans": lambda: layered(30, humans=2, robots=2, seed=3),
    "20 tasks, two robots, one human": lambda: layered(20, humans=1, robots=2, seed=2),
    "Yu's desk, 53 tasks": lambda: desk().to_cell(),
}
"""Name -> how the cell is made."""


@dataclass
class Timed:
    """A decider whose decisions are timed, those too that come late."""

    policy: Policy
    spent_ms: list[float] = field(default_factory=list)
    own_ms: list[float] = field(default_factory=list)

    @property
    def name(self) -> str:
        """As the decider's."""
        return self.policy.name

    def decide(self, situation: Situation) -> Decision:
        """As the decider."""
        began, own = time.perf_counter(), time.thread_time()
        said = self.policy.decide(situation)
        self.spent_ms.append(1000 * (time.perf_counter() - began))
        self.own_ms.append(1000 * (time.thread_time() - own))
        return said


def measure(
    name: str, cell: Cell, episodes: int, budget_ms: float, steps_per_ms: float
) -> dict[str, Any]:
    """Decisions of so many shifts: how many, how many late, and p50, p99 and the most of all
    times.
    """
    told = Options(budget_ms=budget_ms * FOR_PLANNING, steps_per_ms=steps_per_ms)
    deciding: list[float] = []
    own: list[float] = []
    answering: list[float] = []
    late = 0
    with settled_memory() as settle:
        for seed in range(episodes):
            timed = Timed(policy(name, cell, SECONDS, told))
            decider = InTime(timed, policy(RULE, cell, SECONDS, told), budget_ms)
            settings = Settings(name, SECONDS, replace(told, budget_ms=budget_ms))
            with Journal() as journal:
                shift = Shift.open(cell, journal, settings, decider=decider)
                warmed_up = 1
                floor = SimulatedFloor(cell, PEOPLE, seed=seed)
                while event := floor.next(shift.situation, shift.decision["look_again"]):
                    shift.take(json.dumps(event.to_dict()))
                    decider.settle()  # seconds pass between two events of a floor
                    settle()
                made = [entry.decision for entry in journal.entries() if entry.decision]
            asked = [one for one in made if one["by"] != "shift"]
            answering += [one["latency_ms"] for one in asked]
            late += sum(one["instead"] == "late" for one in asked)
            deciding += timed.spent_ms[warmed_up:]
            own += timed.own_ms[warmed_up:]
    return {
        "decisions": len(answering),
        "late": late,
        "late_share": round(late / len(answering), 4),
        "decider_ms": quantiles(deciding),
        "decider_own_ms": quantiles(own),
        "answer_ms": quantiles(answering),
    }


def quantiles(numbers: Sequence[float]) -> dict[str, float]:
    """Median, 99 % and the most."""
    return {
        "p50": round(float(np.percentile(numbers, 50)), 1),
        "p99": round(float(np.percentile(numbers, 99)), 1),
        "max": round(max(numbers), 1),
    }


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--episodes", type=int, default=8, help="shifts on each cell, seeds 0, 1, ..."
    )
    parser.add_argument("--budget", type=float, default=50.0, help="milliseconds per decision")
    parser.add_argument("--policy", default="auto", help="who decides")
    parser.add_argument("-o", "--output", type=Path)
    asked = parser.parse_args()
    sys.setswitchinterval(0.001)  # as a shift does
    rows, steps = [], measured()
    for name, made in CELLS.items():
        cell = made()
        before = os.times()
        found = measure(asked.policy, cell, asked.episodes, asked.budget, steps)
        after = os.times()
        cpu_s = after.user + after.system - before.user - before.system
        rows.append(
            {
                "cell": name,
                **found,
                "cpu_share": round(cpu_s / (after.elapsed - before.elapsed), 2),
            }
        )
    document = {
        "benchmark": "replan_latency",
        "decider": asked.policy,
        "steps_per_ms": steps,
        "people": PEOPLE,
        "budget_ms": asked.budget,
        "shift_seeds": list(range(asked.episodes)),
        "load_average": [round(load, 2) for load in os.getloadavg()]
        if hasattr(os, "getloadavg")
        else None,
        "cores": os.cpu_count(),
        "versions": versions(),
        "rows": rows,
    }
    text = json.dumps(document, indent=1) + "\n"
    if asked.output:
        asked.output.write_text(text, encoding="utf-8")
    print(text, end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
