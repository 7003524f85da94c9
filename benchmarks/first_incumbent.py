"""What the policy for any cell gives the exact planner: how far above its bound it ends with and
without the policy's schedules to begin from.

    python benchmarks/first_incumbent.py [--tasks 50 100 200 500] [--cells 3] [--work 0.33 3.3]
        [--samples 1] [-o benchmarks/results/first_incumbent.json]
    python benchmarks/first_incumbent.py --seconds 1 10 [--workers 2] ...
    python benchmarks/first_incumbent.py --show benchmarks/results/first_incumbent.json

Random layered cells of two humans and two robots, seeds 0, 1, ..., makespan alone. The limit is
work, CP-SAT's deterministic seconds of which one takes about three on a core, so that the load of
the machine decides nothing; what the policy takes is counted for nothing, which favours it. With
`--seconds` the limit is the clock's, what the policy takes counts, and all cores search: that asks
for a machine that does nothing else. Gaps are above the greatest bound that either has proven.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Iterator
from hashlib import sha256
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from tandem.cell.model import Cell
from tandem.files.atomic import store
from tandem.files.generators import layered
from tandem.learn.graph.making import Maker
from tandem.learn.graph.outlook import Outlook
from tandem.learn.graph.weights import SHIPPED, shipped
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout
from tandem.plan.methods import plan
from tandem.schedule.model import Schedule


def proposed(cell: Cell, samples: int) -> tuple[list[Schedule], float]:
    """The policy's schedules, the greedy one first, and CPU seconds that they took."""
    began = time.process_time()
    layout = Layout.of(Instance.of(cell))
    maker, random = Maker.of(shipped(), Outlook.of(layout, 0.0)), np.random.default_rng(0)
    states = [maker.build(random if sample else None) for sample in range(samples)]
    found = [layout.instance.schedule(state.starts()) for state in states if state is not None]
    return found, time.process_time() - began


def row_of(tasks: int, seed: int, asked: argparse.Namespace) -> dict[str, Any]:
    """A cell: makespans and bounds, without the policy's schedules and with them."""
    cell = layered(tasks, 2, 2, seed=seed)
    schedules, cpu_s = proposed(cell, asked.samples)
    row: dict[str, Any] = {
        "tasks": tasks, "seed": seed, "policy_cpu_s": round(cpu_s, 3),
        "policy": min(max(one.end for one in schedule) for schedule in schedules),
    }  # fmt: skip
    for limit in asked.seconds or asked.work:
        for name, hint in (("without", None), ("with", schedules)):
            if asked.seconds:
                began = time.monotonic()
                hint = hint and proposed(cell, asked.samples)[0]
                left = limit - (time.monotonic() - began)
                bounded: dict[str, Any] = {"time_limit": left, "workers": asked.workers}
            else:
                bounded = {"work": limit, "workers": 1}
            (found,) = plan(
                cell, minimize="makespan", hint=hint, settle=False, confirm=False, **bounded
            )
            row[f"{name} {limit:g}"] = [found.makespan, found.bound.makespan]
    return row


def tables(document: dict[str, Any]) -> Iterator[str]:
    """The Markdown lines."""
    by_clock = "seconds" in document
    works, rows = document["seconds" if by_clock else "works"], document["rows"]
    told_of = "{:g} s" if by_clock else "work {:g}"
    heads = [f"{name}, {told_of.format(work)}" for work in works for name in ("without", "with")]
    yield f"| tasks | cells | the policy alone | {' | '.join(heads)} |"
    yield f"|---|---|---|{'---|' * len(heads)}"
    for tasks in sorted({row["tasks"] for row in rows}):
        mine = [row for row in rows if row["tasks"] == tasks]
        bounds = [
            max(row[f"{n} {w:g}"][1] for w in works for n in ("without", "with")) for row in mine
        ]
        told = [_gap([row["policy"] for row in mine], bounds)]
        for work in works:
            for name in ("without", "with"):
                told.append(_gap([row[f"{name} {work:g}"][0] for row in mine], bounds))
        yield f"| {tasks} | {len(mine)} | {' | '.join(told)} |"


def _gap(makespans: list[float], bounds: list[float]) -> str:
    return f"{100 * np.mean(np.array(makespans) / np.array(bounds) - 1):.2f} %"


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tasks", type=int, nargs="+", default=[50, 100, 200, 500])
    parser.add_argument("--cells", type=int, default=3)
    parser.add_argument("--work", type=float, nargs="+", default=[0.33, 3.3])
    parser.add_argument("--seconds", type=float, nargs="+", help="limits of the clock instead")
    parser.add_argument("--workers", type=int, default=2, help="with --seconds")
    parser.add_argument("--samples", type=int, default=1, help="schedules by the policy")
    parser.add_argument("--show", type=Path, help="only print the table of an earlier run")
    parser.add_argument("-o", "--output", type=Path)
    asked = parser.parse_args()
    if asked.show:
        document = json.loads(asked.show.read_text(encoding="utf-8"))
    else:
        weights = files("tandem.learn.graph").joinpath(SHIPPED).read_bytes()
        document = {
            "benchmark": "first_incumbent",
            **({"seconds": asked.seconds} if asked.seconds else {"works": asked.work}),
            "samples": asked.samples,
            "weights": sha256(weights).hexdigest()[:12],
            "rows": [],
        }
        for seed in range(asked.cells):
            for tasks in asked.tasks:
                document["rows"].append(row_of(tasks, seed, asked))
                print(document["rows"][-1], file=sys.stderr, flush=True)
                if asked.output:
                    store(asked.output, json.dumps(document, indent=1) + "\n")
    print("\n".join(tables(document)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
