"""What the policy for any cell gives the exact planner: how far above its bound it ends with and
without the policy's greedy schedules to begin from.

    python benchmarks/first_incumbent.py [--tasks 50 100 200 500] [--operators 4] [--cells 3]
        [--work 0.33 3.3] [-o benchmarks/results/first_incumbent.json]
    python benchmarks/first_incumbent.py --seconds 1 10 [--workers 2] [--front] ...
    python benchmarks/first_incumbent.py --show benchmarks/results/first_incumbent.json

Random layered cells, half of the operators human, seeds 0, 1, ..., makespan alone. The policy is
asked at each size and limit, whether or not the planner does so by itself (`tandem.plan.opening`).
The limit is work, CP-SAT's deterministic seconds of which one takes about three on a core, so that
the load of the machine decides nothing; what the policy takes counts as reckoned. With `--seconds`
the limit is the clock's, and all cores search: that asks for a machine that does nothing else. Gaps
are above the greatest bound that either has proven. With `--front` the whole trade-off with stress
is asked for: first the area that a front lacks, as a share of that of the best front known, which
all runs of the cell give together (up to a corner just beyond its ends), then the gap of its
quickest schedule.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from hashlib import sha256
from importlib.resources import files
from itertools import product
from pathlib import Path
from statistics import mean
from typing import Any

# as on the command line: matrices of a decision are too small for more than one thread
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

sys.path.insert(0, str(Path(__file__).parent))

from front_quality import Points, lacking
from tandem.cell.model import Cell
from tandem.files.atomic import store
from tandem.files.generators import layered
from tandem.learn.graph import method
from tandem.learn.graph.weights import SHIPPED
from tandem.plan import opening
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout
from tandem.plan.methods import plan
from tandem.plan.question import Question
from tandem.plan.starts import measures


def by_policy(cell: Cell, question: Question) -> tuple[Points, float]:
    """Ticks and units of the policy's greedy schedules, and CPU seconds that they took."""
    began = time.process_time()
    layout = Layout.of(Instance.of(cell))
    found = [
        measures(layout.instance, starts)
        for starts in method.opening(layout, question, lambda: False)
    ]
    return found, time.process_time() - began


@contextmanager
def asking(tasks: range) -> Iterator[None]:
    """The planner asks the policy in cells of so many tasks, whatever its limit."""
    names = ("OF_ONE", "OF_FRONT", "LEAST_S", "LEAST_OF_FRONT_S")
    usual = [getattr(opening, name) for name in names]
    for name, value in zip(names, (tasks, tasks, 0.0, 0.0), strict=True):
        setattr(opening, name, value)
    try:
        yield
    finally:
        for name, value in zip(names, usual, strict=True):
            setattr(opening, name, value)


def row_of(tasks: int, operators: int, seed: int, asked: argparse.Namespace) -> dict[str, Any]:
    """A cell: makespans and bounds, without the policy's schedules and with them, and for a front
    what each lacks.
    """
    cell = layered(tasks, operators // 2, operators - operators // 2, seed=seed)
    instance = Instance.of(cell)
    question = Question() if asked.front else Question("makespan")
    alone, cpu_s = by_policy(cell, question)
    row: dict[str, Any] = {"tasks": tasks, "operators": operators, "seed": seed}
    row |= {"policy": instance.seconds(min(alone)[0]), "policy_cpu_s": round(cpu_s, 3)}
    fronts = {"policy": alone}
    for limit in asked.seconds or asked.work:
        if asked.seconds:
            bounded = {"time_limit": limit, "workers": asked.workers}
        else:
            bounded = {"work": limit, "workers": 1}
        for name, sizes in (("without", range(0)), ("with", range(tasks, tasks + 1))):
            with asking(sizes):
                found = plan(cell, question, settle=False, confirm=False, **bounded)
            quickest, key = found[0], f"{name} {limit:g}"
            row[key] = [quickest.makespan, quickest.bound.makespan]
            fronts[key] = [
                (round(one.makespan * instance.per_second), round(one.stress * instance.per_stress))
                for one in found
            ]
    return row | ({"lacking": lacking(fronts)} if asked.front else {})


def tables(document: dict[str, Any]) -> Iterator[str]:
    """The Markdown lines, per cent; of fronts a table of what they lack, then one of gaps."""
    by_clock = "seconds" in document
    limits, rows = document["seconds" if by_clock else "works"], document["rows"]
    told_of = "{} {:g} s" if by_clock else "{}, work {:g}"
    keys = {
        f"{name} {limit:g}": told_of.format(name, limit)
        for limit in limits
        for name in ("without", "with")
    }
    if "lacking" in rows[0]:
        shares = [{key: row["lacking"][key] for key in ("policy", *keys)} for row in rows]
        yield from _table("area lacking, %", list(keys.values()), rows, shares, 1)
        yield ""
    gaps = list[dict[str, float]]()
    for row in rows:
        bound = max(row[key][1] for key in keys)
        found = {"policy": row["policy"], **{key: row[key][0] for key in keys}}
        gaps.append({name: makespan / bound - 1 for name, makespan in found.items()})
    yield from _table("gap, %", list(keys.values()), rows, gaps, 2)


def _table(
    what: str,
    heads: list[str],
    rows: list[dict[str, Any]],
    values: list[dict[str, float]],
    digits: int,
) -> Iterator[str]:
    """Means over the cells of a size, which are shares, in per cent."""
    yield f"| {what} | cells | policy alone | {' | '.join(heads)} |"
    yield f"|---|---|---|{'---|' * len(heads)}"
    sizes = [(row["tasks"], row["operators"]) for row in rows]
    for size in sorted(set(sizes)):
        mine = [one for one, of in zip(values, sizes, strict=True) if of == size]
        told = [f"{100 * mean(one[key] for one in mine):.{digits}f}" for key in mine[0]]
        yield f"| {size[0]} x {size[1]} | {len(mine)} | {' | '.join(told)} |"


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tasks", type=int, nargs="+", default=[50, 100, 200, 500])
    parser.add_argument("--operators", type=int, nargs="+", default=[4])
    parser.add_argument("--cells", type=int, default=3)
    parser.add_argument("--work", type=float, nargs="+", default=[0.33, 3.3])
    parser.add_argument("--seconds", type=float, nargs="+", help="limits of the clock instead")
    parser.add_argument("--workers", type=int, default=2, help="with --seconds")
    parser.add_argument("--front", action="store_true", help="the whole trade-off with stress")
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
            "weights": sha256(weights).hexdigest()[:12],
            "rows": [],
        }
        for seed, tasks, operators in product(range(asked.cells), asked.tasks, asked.operators):
            document["rows"].append(row_of(tasks, operators, seed, asked))
            print(document["rows"][-1], file=sys.stderr, flush=True)
            if asked.output:
                store(asked.output, json.dumps(document, indent=1) + "\n")
    print("\n".join(tables(document)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
