"""Fronts under a time limit: how the time is spent, how much is proven, and how good what was found
is.

    python benchmarks/fronts.py [--tasks 31 60 100 160] [--seeds 2] [--seconds 10] [-o AFTER.json]
    python benchmarks/fronts.py --compare BEFORE.json AFTER.json

To hold two versions against each other, run the first command with each (PYTHONPATH=OTHER/src) in
one session, in turn. On a machine that others use too, wall time says little; so two figures stand
beside it: processor seconds, and `wanted`, the share of the time in which at least as many threads
wanted a core as there are workers, whether they got one or not (Linux only).

`gap` is the mean distance of a point's makespan to its bound. `volume` is the hypervolume of a
front as a share of the best of all compared, both axes scaled to the range of all points found.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import resource
import sys
import time
from pathlib import Path
from typing import Any

import tandem
from tandem.files.generators import layered
from tandem.plan.methods import plan

SAMPLE_S = 0.01
Row = dict[str, Any]


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tasks", nargs="+", type=int, default=[31, 60, 100, 160])
    parser.add_argument("--humans", type=int, default=1)
    parser.add_argument("--robots", type=int, default=1)
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("-o", "--output", type=Path)
    parser.add_argument(
        "--compare",
        nargs="+",
        type=Path,
        help="print the tables of earlier runs side by side instead",
    )
    options = parser.parse_args()
    if options.compare:
        return _compare(options.compare)
    print(
        f"{Path(tandem.__file__).parent}, {options.workers} workers, {options.seconds:g} s",
        flush=True,
    )
    rows: list[Row] = []
    for tasks in options.tasks:
        for seed in range(options.seeds):
            rows.append(_measured(tasks, seed, options))
            print(_line(rows[-1]), flush=True)
            if options.output:
                options.output.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    return 0


def _measured(tasks: int, seed: int, options: argparse.Namespace) -> Row:
    """One front, and what it took."""
    cell = layered(tasks, options.humans, options.robots, seed=seed)
    ours, theirs = multiprocessing.Pipe()
    watch = multiprocessing.get_context("spawn").Process(
        target=_watch, args=(os.getpid(), options.workers, theirs), daemon=True
    )
    watch.start()
    ours.recv()  # it has begun
    wall, cpu = time.monotonic(), _processor_seconds()
    front = plan(cell, time_limit=options.seconds, workers=options.workers, seed=seed)
    wall, cpu = time.monotonic() - wall, _processor_seconds() - cpu
    ours.send("end")
    wanted = ours.recv()
    watch.join()
    return {
        "cell": f"{tasks} tasks {options.humans}+{options.robots} seed {seed}",
        "wall": round(wall, 2),
        "cpu": round(cpu, 2),
        "wanted": wanted,
        "complete": front.complete,
        "points": [
            [r.makespan, r.stress, r.bound.makespan, r.bound.stress, str(r.status) == "optimal"]
            for r in front
        ],
        "recommended": [front.knee.makespan, front.knee.stress],
    }


def _processor_seconds() -> float:
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def _watch(pid: int, workers: int, pipe: Any) -> None:
    """Counts, from outside, how often at least so many threads of the process run or wait for a
    core only.
    """
    pipe.send("begun")
    looks = enough = 0
    while not pipe.poll(SAMPLE_S):
        looks += 1
        enough += _runnable(pid) >= workers
    pipe.send(enough / looks if looks else None)


def _runnable(pid: int) -> int:
    count = 0
    for stat in Path(f"/proc/{pid}/task").glob("*/stat"):
        try:
            count += stat.read_text().rsplit(")", 1)[1].split()[0] == "R"
        except OSError:
            continue  # a thread that has ended meanwhile
    return count


def _line(row: Row, volume: float | None = None) -> str:
    points = row["points"]
    proven = sum(point[4] for point in points)
    gap = sum((point[0] - point[2]) / point[0] for point in points) / len(points)
    wanted = "" if row["wanted"] is None else f"wanted {row['wanted']:4.0%}  "
    return (
        f"{row['cell']:<24} wall {row['wall']:6.2f} s  cpu {row['cpu']:6.2f} s  {wanted}{proven:>3}"
        f" of {len(points):>3} proven{'  complete' if row['complete'] else '          '}  gap"
        f" {gap:6.2%}" + ("" if volume is None else f"  volume {volume:7.2%}")
    )


def _compare(paths: list[Path]) -> int:
    """The same cells, file by file."""
    runs = {
        path.stem: {row["cell"]: row for row in json.loads(path.read_text(encoding="utf-8"))}
        for path in paths
    }
    for cell in dict.fromkeys(cell for rows in runs.values() for cell in rows):
        rows = {name: rows[cell] for name, rows in runs.items() if cell in rows}
        volumes = _volumes(
            [[(point[0], point[1]) for point in row["points"]] for row in rows.values()]
        )
        for (name, row), volume in zip(rows.items(), volumes, strict=True):
            print(f"{name:<12} {_line(row, volume)}")
    return 0


def _volumes(fronts: list[list[tuple[float, float]]]) -> list[float]:
    """Hypervolume of each front within the box of all their points, as a share of that of all
    points together.
    """
    everything = [point for front in fronts for point in front]
    latest, most = (max(axis) for axis in zip(*everything, strict=True))
    whole = _volume(everything, latest, most)
    return [_volume(front, latest, most) / whole if whole else 1.0 for front in fronts]


def _volume(points: list[tuple[float, float]], latest: float, most: float) -> float:
    area, roof = 0.0, most
    for makespan, stress in sorted(points):
        if stress < roof:
            area += (latest - makespan) * (roof - stress)
            roof = stress
    return area


if __name__ == "__main__":
    sys.exit(main())
