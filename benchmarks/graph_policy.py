"""The policy for any cell, on cells that it was never trained on: how far above the optimum its
schedules are, beside the best dispatch rule and as many random schedules, and how long a decision
takes.

    python benchmarks/graph_policy.py [--tasks 10 20 50] [--operators 2] [--cells 30]
        [--samples 64] [--work 20] [-o FILE]

Cells are `layered` ones, seeds 0, 1, ... (the trainer draws from another range); makespan alone
counts. The yardstick is the proven optimum, or the bound where `--work` (CP-SAT's deterministic
seconds) proves none; gaps are the mean in per cent with a 95 % bootstrap interval. `best-of-n` is
the rule of that name, at as many schedules. Milliseconds are processor time.
"""

from __future__ import annotations

import argparse
import json
import platform
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from random import Random
from typing import Any

import numpy as np

from tandem import __version__
from tandem.cell.model import Cell
from tandem.files import atomic
from tandem.files.generators import layered
from tandem.learn.graph.making import Maker
from tandem.learn.graph.outlook import Outlook
from tandem.learn.graph.weights import shipped
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout, PartialSchedule
from tandem.plan.methods import plan
from tandem.plan.question import Question
from tandem.plan.rules import SPECS, attempts

QUICKEST = Question(minimize="makespan")


def unseen_cells(tasks: Sequence[int], operators: int, count: int) -> Iterator[tuple[int, Cell]]:
    """Size and cell: so many of each size, half of the operators human."""
    for size in tasks:
        for seed in range(count):
            humans = (operators + 1) // 2
            yield size, layered(size, humans, operators - humans, seed=seed)


def least(states: Sequence[PartialSchedule | None]) -> float:
    """Ticks of the quickest."""
    return min((state.makespan for state in states if state is not None), default=float("inf"))


def rule(layout: Layout, name: str, samples: int) -> float:
    """Ticks of what the rule finds, `best-of-n` by so many schedules."""
    spec = SPECS[name]
    if spec.samples > 1:
        spec = replace(spec, samples=samples)
    return least(list(attempts(layout, spec, Random(0), QUICKEST, lambda: True)))


def measured(cell: Cell, samples: int, work: float) -> dict[str, float]:
    """Gaps above the bound, shares of it; `us` a decision, greedy and when many are drawn."""
    layout = Layout.of(Instance.of(cell))
    found = plan(cell, QUICKEST, work=work, workers=1, settle=False, confirm=False)[0]
    bound = found.bound.makespan * layout.instance.per_second
    began = time.process_time()
    maker = Maker.of(shipped(), Outlook.of(layout, 0.0))
    looked = time.process_time()
    greedy = maker.build()
    chosen = time.process_time()
    random = np.random.default_rng(0)
    drawn = [maker.build(random) for _ in range(samples - 1)]
    best = {name: rule(layout, name, samples) for name in SPECS if name != "random"}
    ends = {
        "greedy": least([greedy]),
        f"best of {samples}": least([greedy, *drawn]),
        "best-of-n": best.pop("best-of-n"),
        "best rule without draws": min(best.values()),
    }
    gaps = {name: end / bound - 1 for name, end in ends.items()}
    return {
        **gaps,
        "proven": float(found.status.name == "OPTIMAL"),
        "look us": 1e6 * (looked - began),
        "decision us": 1e6 * (chosen - looked) / len(cell.tasks),
    }


def interval(values: Sequence[float]) -> tuple[float, float, float]:
    """The mean and its 95 % bootstrap interval."""
    rng, array = np.random.default_rng(0), np.array(values)
    means = rng.choice(array, (2000, len(array))).mean(1)
    low, high = np.quantile(means, (0.025, 0.975))
    return float(array.mean()), float(low), float(high)


def told(size: int, rows: Sequence[dict[str, float]]) -> dict[str, Any]:
    """One line of the table."""
    document: dict[str, Any] = {"tasks": size, "cells": len(rows)}
    document["proven"] = sum(row["proven"] for row in rows) / len(rows)
    for name in rows[0]:
        if name in ("proven", "look us", "decision us"):
            continue
        mean, low, high = interval([100 * row[name] for row in rows])
        document[name] = {"gap": round(mean, 2), "ci95": [round(low, 2), round(high, 2)]}
    for name in ("look us", "decision us"):
        document[name] = round(float(np.median([row[name] for row in rows])))
    return document


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tasks", type=int, nargs="+", default=[10, 20, 50])
    parser.add_argument("--operators", type=int, default=2)
    parser.add_argument("--cells", type=int, default=30, help="of each size")
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--work", type=float, default=20.0, help="for the yardstick of a cell")
    parser.add_argument("-o", "--output", type=Path)
    asked = parser.parse_args()
    rows: dict[int, list[dict[str, float]]] = {}
    document: dict[str, Any] = {
        "benchmark": "graph_policy",
        "tandem": __version__,
        "python": platform.python_version(),
        **{key: getattr(asked, key) for key in ("operators", "cells", "samples", "work")},
        "rows": [],
    }
    for size, cell in unseen_cells(asked.tasks, asked.operators, asked.cells):
        rows.setdefault(size, []).append(measured(cell, asked.samples, asked.work))
        if len(rows[size]) == asked.cells:
            document["rows"].append(told(size, rows[size]))
            print(json.dumps(document["rows"][-1]), flush=True)
    if asked.output is not None:
        atomic.store(asked.output, json.dumps(document, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
