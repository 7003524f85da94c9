"""How soon a first complete schedule of a large cell is there, how far a time limit is overrun, and
how much memory planning takes.

    python benchmarks/first_schedule.py [--tasks 500 1000 2000 5000] [--operators 4] [--turns 10]
        [--seconds 10]

Wall and processor time of this process until the first schedule that the checker has accepted, the
cell being read already: on a busy machine the latter says more. Each size is measured in a process
of its own, so that peak memory is its own.
"""

from __future__ import annotations

import argparse
import multiprocessing
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
    parser.add_argument("--tasks", type=int, nargs="+", default=[500, 1000, 2000, 5000])
    parser.add_argument("--operators", type=int, default=4)
    parser.add_argument("--turns", type=int, default=10)
    parser.add_argument("--seconds", type=float, default=10.0)
    options = parser.parse_args()
    for tasks in options.tasks:
        process = multiprocessing.get_context("spawn").Process(
            target=_measure, args=(tasks, options.operators, options.turns, options.seconds)
        )
        process.start()
        process.join()
        if process.exitcode:
            return 1
    return 0


def _measure(tasks: int, operators: int, turns: int, seconds: float) -> None:
    waits, work, gaps = [], [], []
    for seed in range(turns + 1):
        cell = layered(tasks, operators - operators // 2, operators // 2, seed=seed)
        first: list[tuple[float, float, Progress]] = []

        def note(progress: Progress, first: list[tuple[float, float, Progress]] = first) -> None:
            first.append((time.perf_counter(), time.process_time(), progress))
            raise KeyboardInterrupt

        wall, cpu = time.perf_counter(), time.process_time()
        plan(cell, minimize="makespan", on_solution=note)
        waits.append(first[0][0] - wall)
        work.append(first[0][1] - cpu)
        gaps.append(first[0][2].found[0].makespan / load_bound(Layout.of(Instance.of(cell))) - 1)
    waits, work, gaps = waits[1:], work[1:], gaps[1:]  # the first turn loads the libraries
    print(
        f"{tasks} tasks, {operators} operators, {turns} seeds: first checked schedule after median"
        f" {1000 * statistics.median(waits):.0f} ms, worst {1000 * max(waits):.0f} ms (processor"
        f" {1000 * statistics.median(work):.0f} and {1000 * max(work):.0f} ms),"
        f" {statistics.mean(gaps):.1%} above the load bound",
        flush=True,
    )
    for minimize in ("makespan", "front"):
        began = time.perf_counter()
        front = plan(cell, minimize=minimize, time_limit=seconds)
        took = time.perf_counter() - began
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        gap = front[0].makespan / front[0].bound.makespan - 1
        print(
            f"  {minimize}, limit {seconds:g} s: over by {took - seconds:.2f} s, {len(front)}"
            f" points, {gap:.1%} above the bound, peak memory {peak:.0f} MiB",
            flush=True,
        )


if __name__ == "__main__":
    sys.exit(main())
