"""Random layered cells of 20 to 500 tasks: the gap to the best bound known after 1, 10 and 30 s,
Tandem beside plain CP-SAT and PyJobShop.

    python benchmarks/scaling.py [--tasks 20 50 100 200 500] [--operators 2 4] [--seeds 10]
        [--seconds 1 10 30] [-o FILE.csv]
    python benchmarks/scaling.py --show FILE.csv

The best bound known of a cell is the best that any of the three proved in this run. PyJobShop says
nothing while it works, so it is run once for each number of seconds. Every schedule goes through
the checker; a claim of optimality that another solver refutes is printed as WRONG.
"""

from __future__ import annotations

import argparse
import csv
import os
import sys
from importlib.metadata import version
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from peers import PEERS, Run
from tandem.files.generators import layered

COLUMNS = (
    "tasks",
    "operators",
    "seed",
    "solver",
    "seconds",
    "makespan",
    "bound",
    "proven",
    "wall_s",
    "best_bound",
)


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tasks", nargs="+", type=int, default=[20, 50, 100, 200, 500])
    parser.add_argument("--operators", nargs="+", type=int, default=[2, 3, 4])
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--seconds", nargs="+", type=float, default=[1.0, 10.0, 30.0])
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    parser.add_argument("--peers", nargs="+", default=list(PEERS), choices=list(PEERS))
    parser.add_argument("-o", "--output", type=Path)
    parser.add_argument("--show", type=Path, help="print the tables of an earlier run instead")
    options = parser.parse_args()
    if options.show:
        return _show(options.show)
    print(
        f"{options.workers} workers, ortools {version('ortools')}, pyjobshop"
        f" {version('pyjobshop')}",
        flush=True,
    )
    rows: list[tuple] = []
    for tasks in options.tasks:
        for operators in options.operators:
            for seed in range(options.seeds):
                cell = layered(tasks, operators - operators // 2, operators // 2, seed=seed)
                rows += _measured(cell, (tasks, operators, seed), options)
                _write(options.output, rows)
            _table([row for row in rows if row[:2] == (tasks, operators)])
    return 0


def _show(path: Path) -> int:
    with open(path, newline="", encoding="utf-8") as file:
        rows = [_row(record) for record in csv.DictReader(file)]
    for key in dict.fromkeys(row[:2] for row in rows):
        _table([row for row in rows if row[:2] == key])
    return 0


def _row(record: dict[str, str]) -> tuple:
    """A line of the CSV file as `_table` wants it."""
    key = (
        int(record["tasks"]),
        int(record["operators"]),
        int(record["seed"]),
        record["solver"],
        float(record["seconds"]),
    )
    found = float(record["makespan"]) if record["makespan"] else None
    return (
        *key,
        found,
        None,
        record["proven"] == "True",
        float(record["wall_s"]),
        float(record["best_bound"]),
    )


def _measured(cell, key: tuple[int, int, int], options: argparse.Namespace) -> list[tuple]:
    """Rows of one cell: solver by solver and second by second."""
    found: list[tuple[str, float, float | None, Run]] = []
    for peer in options.peers:
        longest = max(options.seconds)
        if peer == "pyjobshop":
            done: Run | None = None
            for seconds in sorted(options.seconds):
                done = (
                    done
                    if done is not None and done.proven
                    else PEERS[peer](cell, seconds, options.workers)
                )
                found.append((peer, seconds, done.makespan, done))
        else:
            run = PEERS[peer](cell, longest, options.workers)
            found += [
                (peer, seconds, run.after(seconds) if seconds < longest else run.makespan, run)
                for seconds in options.seconds
            ]
    best = max(run.bound for _, _, _, run in found if run.bound is not None and run.bound < 1e12)
    least = min((value for _, _, value, _ in found if value is not None), default=None)
    for peer, _, value, run in found:
        if run.proven and least is not None and value is not None and run.makespan > least + 1e-9:
            print(
                f"WRONG: {peer} claims {run.makespan} is optimal for {key}, {least} was found",
                flush=True,
            )
    return [
        (
            *key,
            peer,
            s,
            value,
            run.bound,
            run.proven and run.wall_s <= s + 0.5,
            round(run.wall_s, 2),
            best,
        )
        for peer, s, value, run in found
    ]


def _table(rows: list[tuple]) -> None:
    """Mean gap to the best bound, and how many were proven, per solver and time."""
    tasks, operators = rows[0][:2]
    for peer in dict.fromkeys(row[3] for row in rows):
        parts = []
        for seconds in dict.fromkeys(row[4] for row in rows):
            mine = [row for row in rows if row[3] == peer and row[4] == seconds]
            gaps = [(row[5] - row[9]) / row[9] for row in mine if row[5] is not None]
            mean = f"{sum(gaps) / len(gaps):7.2%}" if gaps else "nothing"
            lost = f" ({len(mine) - len(gaps)} none)" if len(gaps) < len(mine) and gaps else ""
            parts.append(
                f"{seconds:g} s: {mean}{lost} {sum(row[7] for row in mine)}/{len(mine)} proven"
            )
        print(
            f"{tasks:>4} tasks {operators} operators  {peer:<10} " + "   ".join(parts), flush=True
        )


def _write(path: Path | None, rows: list[tuple]) -> None:
    if path is None:
        return
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(COLUMNS)
        writer.writerows(rows)


if __name__ == "__main__":
    sys.exit(main())
