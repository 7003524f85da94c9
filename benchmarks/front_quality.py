"""Fronts cut short: how far from the best front known after 1, 10 and 60 s, beside plain CP-SAT and
PyJobShop, and whether two runs recommend the same point.

    python benchmarks/front_quality.py [--seconds 1 10 60] [--limit N] [--seed 0] [--workers 2]
        [-o benchmarks/results/front_quality.json]

The cells: twelve random layered ones of 20 to 50 tasks whose people have stress, `--limit N` the
first N of them. Everybody gets each limit anew, with the same threads. Tandem plans twice. A peer
walks the front by the epsilon constraint (Haimes, Lasdon, Wismer 1971): the least makespan, then
with less stress than the schedule that it found, and so on, each question until it is proven or a
tenth of the limit is over. The schedules of all pass through our checker.

The gap is the hypervolume that a front lacks, as a share of that of the best front known: all
points that anybody found in any run of the cell. Up to a corner just beyond the latest and the
hardest of these points.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from peers import PEERS, Run
from tandem.cell.model import Cell
from tandem.files.generators import layered
from tandem.learn.training.runs import versions
from tandem.plan.archive import dominated_area
from tandem.plan.instance import Instance
from tandem.plan.methods import plan
from tandem.schedule.checker import faults
from tandem.schedule.measures import exact, makespan, stress
from tandem.schedule.model import Schedule

CELLS = (
    (20, 1, 1), (25, 2, 1), (30, 2, 1), (30, 1, 2), (35, 2, 1), (35, 1, 1),
    (40, 2, 1), (40, 2, 2), (45, 2, 1), (45, 3, 1), (50, 2, 1), (50, 2, 2),
)  # fmt: skip
"""Tasks, humans, robots."""
QUESTION = 0.1
"""The share of the limit that a peer gives one question at most."""

K = TypeVar("K")
Points = list[tuple[int, int]]
"""Makespan in ticks and stress in units, as `dominated_area` wants them."""


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seconds", nargs="+", type=float, default=[1.0, 10.0, 60.0])
    parser.add_argument("--limit", type=int, default=len(CELLS), help="so many of the cells")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("-o", "--output", type=Path)
    asked = parser.parse_args()
    rows: list[dict[str, Any]] = []
    for tasks, humans, robots in CELLS[: asked.limit]:
        cell = layered(tasks, humans, robots, seed=asked.seed)
        rows.append({"cell": f"{tasks} tasks {humans}+{robots}", **_measured(cell, asked)})
        _tell(rows[-1])
        if asked.output:
            kept = {
                "benchmark": "front_quality",
                "seconds": asked.seconds,
                "seed": asked.seed,
                "workers": asked.workers,
                "load": os.getloadavg()[0],
                "versions": versions(),
                "rows": rows,
            }
            asked.output.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
    _summary(rows, asked.seconds)
    return 0


def _measured(cell: Cell, asked: argparse.Namespace) -> dict[str, Any]:
    """All runs of one cell, and their gaps to the best front that they give together."""
    instance = Instance.of(cell)
    fronts: dict[tuple[str, float], Points] = {}
    recommended: dict[float, list[Any]] = {}
    for seconds in asked.seconds:
        for turn in range(2):
            front = plan(cell, time_limit=seconds, workers=asked.workers, seed=asked.seed)
            found = [_value(cell, instance, result.schedule) for result in front]
            fronts.setdefault(("tandem", seconds), found)
            knee = [*found[front.knee_place], front.is_knee_certain]
            recommended.setdefault(seconds, []).append(knee)
            if turn:
                fronts["tandem again", seconds] = found
        for name in ("cp-sat", "pyjobshop"):
            fronts[name, seconds] = _walk(PEERS[name], cell, instance, seconds, asked)
    best = unbeaten([point for points in fronts.values() for point in points])
    gaps: dict[str, dict[str, float]] = {}
    for (name, seconds), share in lacking(fronts).items():
        gaps.setdefault(name, {})[f"{seconds:g}"] = share
    return {
        "points": len(best),
        "gap": gaps,
        "recommended": {f"{seconds:g}": knees for seconds, knees in recommended.items()},
        "same": {f"{s:g}": one[:2] == two[:2] for s, (one, two) in recommended.items()},
        "on_best": {
            f"{s:g}": [tuple(knee[:2]) in best for knee in knees]
            for s, knees in recommended.items()
        },
    }


def _walk(
    peer: Callable[..., Run],
    cell: Cell,
    instance: Instance,
    seconds: float,
    asked: argparse.Namespace,
) -> Points:
    """The points that a peer finds by the epsilon constraint, from the quick end on. Where it finds
    nothing in the time for a question, it gets twice as much.
    """
    end, most, points = time.monotonic() + seconds, None, []
    patience = QUESTION * seconds
    while (left := end - time.monotonic()) > 0:
        began = time.monotonic()
        run = peer(cell, min(left, patience), asked.workers, asked.seed, most)
        if run.schedule is None and time.monotonic() - began < patience / 2:
            break  # proven that there is none
        if run.schedule is None:
            patience *= 2  # too little to find any
            continue
        points.append(_value(cell, instance, run.schedule))
        most = points[-1][1] - 1
        if most < 0:
            break
    return points


def _value(cell: Cell, instance: Instance, schedule: Schedule) -> tuple[int, int]:
    if wrong := faults(cell, schedule):
        raise AssertionError("; ".join(wrong))
    ticks = exact(makespan(schedule)) * instance.per_second
    return int(ticks), int(exact(stress(cell, schedule)) * instance.per_stress)


def unbeaten(points: Points) -> Points:
    """Those that none of the others beats, the quickest first."""
    kept: Points = []
    for makespan_, stress_ in sorted(set(points)):
        if not kept or stress_ < kept[-1][1]:
            kept.append((makespan_, stress_))
    return kept


def lacking(fronts: dict[K, Points]) -> dict[K, float]:
    """The share that each front lacks of the area of the best one, which all of them give
    together.
    """
    best = unbeaten([point for points in fronts.values() for point in points])
    corner = max(m for m, _ in best) + 1, max(s for _, s in best) + 1
    whole = dominated_area(best, *corner)
    return {
        key: round(1 - dominated_area(unbeaten(points), *corner) / whole, 5)
        for key, points in fronts.items()
    }


def _tell(row: dict[str, Any]) -> None:
    gaps = {name: " ".join(f"{g:7.2%}" for g in by.values()) for name, by in row["gap"].items()}
    told = "  ".join(f"{name} {values}" for name, values in gaps.items())
    same = " ".join("same" if s else "other" for s in row["same"].values())
    print(f"{row['cell']:<14} {row['points']:>3} points  {told}  recommended: {same}", flush=True)


def _summary(rows: list[dict[str, Any]], seconds: list[float]) -> None:
    for name in rows[0]["gap"]:
        means = (statistics.fmean(row["gap"][name][f"{s:g}"] for row in rows) for s in seconds)
        print(f"mean {name:<13}", " ".join(f"{mean:7.2%}" for mean in means))
    for s in seconds:
        same = sum(row["same"][f"{s:g}"] for row in rows)
        on_best = sum(all(row["on_best"][f"{s:g}"]) for row in rows)
        print(
            f"after {s:g} s: the same point recommended in {same} of {len(rows)} cells, on the best"
            f" front known by both runs in {on_best}"
        )


if __name__ == "__main__":
    sys.exit(main())
