"""Random layered cells of 20 to 500 tasks: the gap to the best bound known after 1, 10 and 30 s,
Tandem beside plain CP-SAT, PyJobShop and discrete-optimization of Airbus.

    python benchmarks/scaling.py [--tasks 20 50 100 200 500] [--operators 2 4] [--seeds 10]
        [--seconds 1 10 30] [--peers tandem ...] [-o FILE.csv]
    python benchmarks/scaling.py --show FILE.csv

The best bound known of a cell is the best that any of them proved. PyJobShop says nothing while it
works, so it is run once for each number of seconds. Every schedule goes through the checker; a
claim of optimality that another solver refutes is printed as WRONG. With -o it goes on where an
earlier run stopped, or adds further peers to it.
"""

from __future__ import annotations

import argparse
import csv
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

sys.path.insert(0, str(Path(__file__).parent))
from peers import PEERS, Run, versions
from tandem.files.generators import layered


class Row(NamedTuple):
    """What one solver had for one cell after so many seconds: a line of the table, seconds."""

    tasks: int
    operators: int
    seed: int
    solver: str
    seconds: float
    makespan: float | None
    bound: float | None
    proven: bool
    wall_s: float
    best_bound: float = 0.0

    @property
    def cell(self) -> tuple[int, int, int]:
        """Tasks, operators and seed, which make the cell."""
        return self[:3]

    @property
    def gap(self) -> float | None:
        """How far the makespan is above the best bound known, as a share of it."""
        return (
            None if self.makespan is None else (self.makespan - self.best_bound) / self.best_bound
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
        f"{options.workers} workers, {versions(options.peers)}",
        flush=True,
    )
    rows = read(options.output) if options.output and options.output.exists() else []
    for tasks in options.tasks:
        for operators in options.operators:
            for seed in range(options.seeds):
                key = tasks, operators, seed
                rows = _together([*rows, *_missing(key, rows, options)], key)
                if options.output:
                    _write(options.output, rows)
            _table([row for row in rows if row[:2] == (tasks, operators)])
    return 0


def _show(path: Path) -> int:
    rows = read(path)
    for key in dict.fromkeys(row[:2] for row in rows):
        _table([row for row in rows if row[:2] == key])
    return 0


def read(path: Path) -> list[Row]:
    """The rows of a table."""
    with open(path, newline="", encoding="utf-8") as file:
        return [
            Row(
                int(line["tasks"]),
                int(line["operators"]),
                int(line["seed"]),
                line["solver"],
                float(line["seconds"]),
                float(line["makespan"]) if line["makespan"] else None,
                float(line["bound"]) if line["bound"] else None,
                line["proven"] == "True",
                float(line["wall_s"]),
                float(line["best_bound"]),
            )
            for line in csv.DictReader(file)
        ]


def _missing(
    key: tuple[int, int, int], rows: list[Row], options: argparse.Namespace
) -> Iterator[Row]:
    """Rows of one cell that are not there yet: solver by solver and second by second."""
    tasks, operators, seed = key
    done = {row.solver for row in rows if row.cell == key}
    made = {row.seconds for row in rows if row.cell == key}
    if made and made != set(options.seconds):
        raise SystemExit(
            f"-o {options.output}: {tasks} tasks, seed {seed} were run for"
            f" {' '.join(f'{s:g}' for s in sorted(made))} s; ask for these, or name another file"
        )
    cell = layered(tasks, operators - operators // 2, operators // 2, seed=seed)
    for peer in options.peers:
        if peer in done:
            continue
        if peer == "pyjobshop":
            run: Run | None = None
            for seconds in sorted(options.seconds):
                if run is None or not run.proven:
                    run = PEERS[peer](cell, seconds, options.workers)
                yield _row(key, peer, seconds, run.makespan, run)
            continue
        longest = max(options.seconds)
        run = PEERS[peer](cell, longest, options.workers)
        for seconds in options.seconds:
            value = run.after(seconds) if seconds < longest else run.makespan
            yield _row(key, peer, seconds, value, run)


def _row(
    key: tuple[int, int, int], peer: str, seconds: float, value: float | None, run: Run
) -> Row:
    is_proven = run.proven and run.wall_s <= seconds + 0.5
    return Row(*key, peer, seconds, value, run.bound, is_proven, round(run.wall_s, 2))


def _together(rows: list[Row], key: tuple[int, int, int]) -> list[Row]:
    """The rows, those of this cell with the best bound that any of them proved."""
    mine = [row for row in rows if row.cell == key]
    best = max(row.bound for row in mine if row.bound is not None and row.bound < 1e12)
    least = min((row.makespan for row in mine if row.makespan is not None), default=None)
    for row in mine:
        if row.proven and row.makespan is not None and row.makespan > (least or 0) + 1e-9:
            told = f"WRONG: {row.solver} claims {row.makespan} is optimal for {key}, {least} was"
            print(f"{told} found", flush=True)
    return [row._replace(best_bound=best) if row.cell == key else row for row in rows]


def _table(rows: list[Row]) -> None:
    """Mean gap to the best bound, and how many were proven, per solver and time."""
    tasks, operators = rows[0][:2]
    for peer in dict.fromkeys(row.solver for row in rows):
        parts = []
        for seconds in dict.fromkeys(row.seconds for row in rows):
            mine = [row for row in rows if (row.solver, row.seconds) == (peer, seconds)]
            gaps = [row.gap for row in mine if row.gap is not None]
            mean = f"{sum(gaps) / len(gaps):7.2%}" if gaps else "nothing"
            lost = f" ({len(mine) - len(gaps)} none)" if len(gaps) < len(mine) and gaps else ""
            proven = sum(row.proven for row in mine)
            parts.append(f"{seconds:g} s: {mean}{lost} {proven}/{len(mine)} proven")
        print(
            f"{tasks:>4} tasks {operators} operators  {peer:<10} " + "   ".join(parts), flush=True
        )


def _write(path: Path, rows: list[Row]) -> None:
    part = path.with_suffix(".part")
    with open(part, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(Row._fields)
        writer.writerows(rows)
    part.replace(path)


if __name__ == "__main__":
    sys.exit(main())
