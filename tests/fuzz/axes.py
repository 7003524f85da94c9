"""Random assessed cells, and two or three axes each, to `plan --axes` and to all allocations in all
orders.

Each cell has up to five tasks, two people and a robot, ways that two do together, and values on two
scales. Its front over the makespan and one, two or three measures drawn for it must have the points
of the enumeration, no more and no fewer, be complete, and pass the checker.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from random import Random

from tests.plan.every_allocation import MEASURES, assessed, expected, of_all

from tandem.files.validate import cell_of
from tandem.plan.axes.search import plan_axes
from tandem.schedule.checker import faults


def judge(seed: int) -> tuple[int, list[str]]:
    """Points of the cell's front, and what is wrong with it, in sentences."""
    random = Random(seed)
    data = assessed(random, random.randint(2, 5))
    names = tuple(random.sample(MEASURES, random.choice((1, 2, 2, 2, 3))))
    cell = cell_of(data)
    front = plan_axes(cell, ["makespan", *names], time_limit=None)
    right, found = expected(of_all(data), names), sorted(point.values for point in front.points)
    same = len(found) == len(right) and all(
        math.isclose(mine, theirs, rel_tol=1e-12)
        for row, other in zip(found, right, strict=True)
        for mine, theirs in zip(row, other, strict=True)
    )
    wrong = [] if same else [f"seed {seed}, {names}: {found}, all allocations {right}"]
    wrong += [] if front.complete else [f"seed {seed}, {names}: not complete"]
    wrong += [
        f"seed {seed}, {names}: {fault}"
        for point in front.points
        for fault in faults(cell, point.schedule)
    ]
    return len(right), wrong


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cells", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--minutes", type=float, default=60.0)
    options = parser.parse_args(arguments)
    until, asked, points, differ = time.monotonic() + 60 * options.minutes, 0, 0, 0
    for seed in range(options.seed, options.seed + options.cells):
        if time.monotonic() > until:
            break
        count, wrong = judge(seed)
        asked, points, differ = asked + 1, points + count, differ + bool(wrong)
        for sentence in wrong:
            print(sentence, file=sys.stderr)
    print(f"axes: {asked:,} cells, {points:,} points, {differ} differ")
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
