"""Fronts of three axes, makespan, dose of the shoulder and worst person: seconds until proven.

    python benchmarks/axes.py [--tasks 20] [--seeds 10] [--time-limit 60] [-o FILE.json]
    python benchmarks/axes.py --show benchmarks/results/axes.json

Random layered cells (seeds 0, 1, ...): a robot and one, two or three people. Each task that people
can do carries facts for the Shoulder Tool, drawn by the cell's seed: lever arm 20 to 70 cm, load
0.5 to 6 kg in steps of 0.5, one to four efforts in each execution. The axes are the makespan,
`dose:shoulder_tool` and `worst:stress`. One worker; processor seconds are those of this process.
"""

from __future__ import annotations

import argparse
import json
import statistics
import sys
import time
from pathlib import Path
from random import Random
from typing import Any

from tandem.cell.model import Cell
from tandem.files.generators import layered
from tandem.plan.axes.search import plan_axes
from tandem.plan.cpsat import SOLVER

AXES = ("makespan", "dose:shoulder_tool", "worst:stress")
PEOPLE = (1, 2, 3)


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tasks", type=int, default=20)
    parser.add_argument("--people", nargs="+", type=int, default=list(PEOPLE))
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--time-limit", type=float, default=60.0, help="seconds for each front")
    parser.add_argument("--show", type=Path, help="print the table of a stored run")
    parser.add_argument("-o", "--output", type=Path)
    options = parser.parse_args()
    if options.show:
        print(table(json.loads(options.show.read_text(encoding="utf-8"))))
        return 0
    document: dict[str, Any] = {
        "command": "benchmarks/axes.py",
        "solver": SOLVER,
        "tasks": options.tasks,
        "axes": list(AXES),
        "cells": [],
    }
    for people in options.people:
        for seed in range(options.seeds):
            row = measured(options.tasks, people, seed, options.time_limit)
            document["cells"].append(row)
            print(
                f"{people} people, seed {seed}: {row['points']} points,"
                f" {'proven' if row['complete'] else 'NOT proven'},"
                f" {row['cpu_s']:.2f} s of processor, {row['wall_s']:.2f} s",
                flush=True,
            )
    print()
    print(table(document))
    if options.output:
        options.output.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    return 0


def measured(tasks: int, people: int, seed: int, time_limit: float) -> dict[str, Any]:
    """What the front of one cell took."""
    cell = assessed(tasks, people, seed)
    began, clock = time.process_time(), time.monotonic()
    front = plan_axes(cell, AXES, time_limit=time_limit)
    return {
        "people": people,
        "seed": seed,
        "digest": cell.digest,
        "points": len(front.points),
        "complete": front.complete,
        "cpu_s": round(time.process_time() - began, 2),
        "wall_s": round(time.monotonic() - clock, 2),
    }


def assessed(tasks: int, people: int, seed: int) -> Cell:
    """The cell of this seed, with facts for the shoulders of people."""
    data, random = layered(tasks, humans=people, seed=seed).to_dict(), Random(seed)
    for row in data["tasks"].values():
        facts = {
            "method": "shoulder_tool",
            "side": "right",
            "lever arm": f"{random.randint(20, 70)} cm",
            "load": f"{random.randint(1, 12) / 2:g} kg",
            "type": "handling",
            "reps_per_cycle": random.randint(1, 4),
        }
        if any(who.startswith("human") for who in row["time"]):
            row["ergonomics"] = [facts]
    return Cell.model_validate(data)


def table(document: dict[str, Any]) -> str:
    """A row for each number of people."""
    lines = [
        "| people beside a robot | cells | proven | points | processor, median | most"
        " | within 10 s |",
        "|---:|---:|---:|---:|---:|---:|---:|",
    ]
    for people in sorted({row["people"] for row in document["cells"]}):
        rows = [row for row in document["cells"] if row["people"] == people]
        points = [row["points"] for row in rows]
        spent = [row["cpu_s"] for row in rows]
        lines.append(
            f"| {people} | {len(rows)} | {sum(row['complete'] for row in rows)} |"
            f" {min(points)} to {max(points)} | {statistics.median(spent):.2f} s |"
            f" {max(spent):.2f} s | {sum(row['complete'] and row['cpu_s'] < 10 for row in rows)} |"
        )
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main())
