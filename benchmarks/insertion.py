"""How far insertion alone brings a large cell in so many processor seconds of one thread, by how
many tasks are taken out at once and how warm the search is.

    python benchmarks/insertion.py [--tasks 50 200 500 1000] [--seeds 2] [--seconds 2]
        [--most-out 3] [--warmth 0.03 0.06]

From the schedule of the rule "balanced"; gaps are to the bounds that need no search. Processor time
is counted, so that a busy machine changes little.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from random import Random

from tandem.files.generators import layered
from tandem.plan import insertion, insertion_moves
from tandem.plan.bounds import least_makespan
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout
from tandem.plan.rules import SPECS, build


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tasks", type=int, nargs="+", default=[50, 200, 500, 1000])
    parser.add_argument("--operators", type=int, default=4)
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--seconds", type=float, default=2.0)
    parser.add_argument("--most-out", type=int, nargs="+", default=[3])
    parser.add_argument("--warmth", type=float, nargs="+", default=[0.03, 0.06])
    options = parser.parse_args()
    insertion_moves.warm()
    for tasks in options.tasks:
        for insertion.MOST_OUT in options.most_out:
            for warmth in options.warmth:
                insertion.WARMTH_OF_FEW = insertion.WARMTH_OF_MANY = warmth
                rows = [_run(tasks, options, seed) for seed in range(options.seeds)]
                rule, early, end, rate = (
                    statistics.mean(column) for column in zip(*rows, strict=True)
                )
                print(
                    f"{tasks:5d} tasks, up to {insertion.MOST_OUT} out, warmth {warmth:g}: rule"
                    f" {rule:.1%}, after {options.seconds / 10:g} s {early:.2%}, after"
                    f" {options.seconds:g} s {end:.2%}; {rate / 1e6:.0f} million visits a second",
                    flush=True,
                )
    return 0


def _run(tasks: int, options: argparse.Namespace, seed: int) -> tuple[float, float, float, float]:
    """Gaps by the rule, after a tenth of the time and at its end, and visits a second."""
    humans = options.operators - options.operators // 2
    layout = Layout.of(Instance.of(layered(tasks, humans, options.operators // 2, seed=seed)))
    state, bound = build(layout, SPECS["balanced"], Random(0)), least_makespan(layout)
    search = insertion.Insertion(layout, insertion_moves, Random(seed))
    search.aim(1, 0, None, None)
    search.begin(tuple(state.starts()))
    began, visits, early = time.thread_time(), 0, None
    while (spent := time.thread_time() - began) < options.seconds:
        visits += search.go(100_000)
        if early is None and spent >= options.seconds / 10:
            early = search.value
    return (
        state.makespan / bound - 1,
        (early or search.value) / bound - 1,
        search.value / bound - 1,
        visits / spent,
    )


if __name__ == "__main__":
    sys.exit(main())
