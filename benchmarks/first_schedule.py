"""How soon a first complete schedule of a large cell is there, and how much memory ten seconds of
planning take.

python benchmarks/first_schedule.py [--tasks 500] [--operators 4] [--turns 10] [--seconds 10]
"""

from __future__ import annotations

import argparse
import resource
import statistics
import sys
import time

from tandem.files.generators import layered
from tandem.plan.bounds import load_bound
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout
from tandem.plan.method import Progress
from tandem.plan.methods import plan


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tasks", type=int, default=500)
    parser.add_argument("--operators", type=int, default=4)
    parser.add_argument("--turns", type=int, default=10)
    parser.add_argument("--seconds", type=float, default=10.0)
    options = parser.parse_args()
    waits, gaps = [], []
    for seed in range(options.turns + 1):
        cell = layered(
            options.tasks,
            options.operators - options.operators // 2,
            options.operators // 2,
            seed=seed,
        )
        first: list[tuple[float, Progress]] = []

        def note(progress: Progress, first: list[tuple[float, Progress]] = first) -> None:
            first.append((time.perf_counter(), progress))
            raise KeyboardInterrupt

        began = time.perf_counter()
        plan(cell, minimize="makespan", on_solution=note)
        waits.append(first[0][0] - began)
        gaps.append(first[0][1].found[0].makespan / load_bound(Layout.of(Instance.of(cell))) - 1)
    waits, gaps = waits[1:], gaps[1:]  # the first turn loads the libraries
    print(
        f"{options.tasks} tasks, {options.operators} operators, {options.turns} seeds: first"
        " checked schedule after"
    )
    print(
        f"  median {1000 * statistics.median(waits):.0f} ms, worst {1000 * max(waits):.0f} ms; mean"
        f" {statistics.mean(gaps):.1%} above the load bound"
    )
    front = plan(cell, time_limit=options.seconds)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(
        f"  after {options.seconds:g} s of planning its front: {len(front)} points, peak memory"
        f" {peak:.0f} MiB"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
