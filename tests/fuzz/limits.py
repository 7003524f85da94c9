"""Random assessed cells with a limit for each person: no plan exceeds it by the exact formula, and
what the limit costs in makespan.

Of each cell the least makespan without a limit and with it; the limit is drawn between what the
quickest plan puts on its worst person and somewhat less than that. Cells for which it is proven
that no plan keeps the limit are counted apart.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from collections import Counter
from fractions import Fraction
from random import Random
from typing import Any

from tandem.errors import InfeasibleError
from tandem.files.validate import cell_of
from tandem.plan.axes.search import plan_axes

CYCLES = 420
KINDS = ("peak:reba", "time-above:reba:7", "dose:shoulder_tool", "stress")


def drawn(random: Random) -> dict[str, Any]:
    """A cell of 4 to 8 tasks, two people and a robot, with REBA and shoulder doses."""
    tasks: dict[str, Any] = {}
    for place in range(random.randint(4, 8)):
        row: dict[str, Any] = {
            "time": {who: random.randint(3, 12) for who in ("anna", "ben")},
            "stress": random.randint(0, 8),
            "ergonomics": [
                {"method": "reba", "score": random.randint(1, 12)},
                {"method": "shoulder_tool", "score": random.randint(1, 40) / 1e6},
            ],
        }
        if random.random() < 0.6:
            row["time"]["robot"] = random.randint(5, 18)
        if place and random.random() < 0.5:
            row["after"] = [f"t{random.randrange(place)}"]
        tasks[f"t{place}"] = row
    people = {"anna": {"kind": "human"}, "ben": {"kind": "human"}}
    return {"operators": {"robot": {"kind": "robot"}, **people}, "tasks": tasks}


def collected(data: dict[str, Any], rows: list[dict[str, Any]], kind: str) -> dict[str, Fraction]:
    """What each person comes to in a plan, said once more from plain data, in fractions."""
    sums = {"anna": Fraction(0), "ben": Fraction(0)}
    for row in rows:
        task = data["tasks"][row["task"]]
        reba, shoulder = (one["score"] for one in task["ergonomics"])
        seconds = Fraction(repr(row["end"])) - Fraction(repr(row["start"]))
        for who in set(row["operators"]) & set(sums):
            if kind == "peak:reba":
                sums[who] = max(sums[who], Fraction(reba))
            elif kind == "stress":
                sums[who] += task["stress"]
            elif kind.startswith("dose"):
                sums[who] += Fraction(repr(shoulder)) * CYCLES
            else:
                sums[who] += seconds * (reba >= 7)
    return sums


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cells", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--minutes", type=float, default=60.0)
    options = parser.parse_args(arguments)
    until, plans, wrong, impossible, asked = time.monotonic() + 60 * options.minutes, 0, 0, 0, 0
    paid: list[float] = []
    by_kind: Counter[str] = Counter()
    for seed in range(options.seed, options.seed + options.cells):
        if time.monotonic() > until:
            break
        random = Random(seed)
        data, kind = drawn(random), random.choice(KINDS)
        cell, asked = cell_of(data), asked + 1
        free = plan_axes(cell, ["makespan", "stress"]).points[0]
        most = max(collected(data, free.schedule.to_list(), kind).values())
        share = Fraction(random.randint(70, 100), 100)
        limit = f"{float(round(most * share, 6)):.6f}"
        try:
            front = plan_axes(
                cell, ["makespan", "stress"], limits=[f"{kind}={limit}"], cycles=CYCLES
            )
        except InfeasibleError:
            impossible += 1
            continue
        for point in front.points:
            plans, by_kind[kind] = plans + 1, by_kind[kind] + 1
            has = collected(data, point.schedule.to_list(), kind)
            if any(one > Fraction(limit) for one in has.values()):
                wrong += 1
                print(f"seed {seed}: {kind}={limit} and {has}", file=sys.stderr)
        paid.append(front.points[0].values[0] / free.values[0] - 1)
    print(
        f"{asked:,} cells, {plans:,} plans with a limit"
        f" ({', '.join(f'{name} {count:,}' for name, count in sorted(by_kind.items()))}):"
        f" {wrong} exceed it; {impossible} limits that no plan keeps. Makespan paid:"
        f" {100 * statistics.fmean(paid or [0.0]):.1f} % on the mean, most"
        f" {100 * max(paid or [0.0]):.0f} %."
    )
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main())
