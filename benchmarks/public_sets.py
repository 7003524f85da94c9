"""Public benchmark instances: Tandem beside a plain CP-SAT model and PyJobShop at equal seconds,
next to the best values known.

    python benchmarks/public_sets.py --data DIR [--sets fjsp_kacem ...] [--seconds 15]
        [--peers tandem ...] [-o FILE.csv]

DIR holds a folder per set with its instances and a best_known.csv (instance, lower_bound,
upper_bound). Prints a row per instance as it is done and a table per set at the end. Ends with 1
when a makespan lies below the best lower bound known, which would be an error of ours.
"""

from __future__ import annotations

import argparse
import csv
import os
import sys
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from peers import PEERS, Run
from tandem.files.load import load

SETS = (
    "fjsp_kacem",
    "fjsp_fattahi",
    "fjsp_brandimarte",
    "fjsp_dag_mini",
    "fjsp_dag_birgin",
    "hrc_case_studies",
    "hrc_battery_cells",
)
COLUMNS = (
    "set",
    "instance",
    "lower_known",
    "upper_known",
    "solver",
    "makespan",
    "bound",
    "proven",
    "wall_s",
)


def instances(folder: Path) -> Iterator[tuple[str, float, float, Path]]:
    """(name, lower bound known, upper bound known, file) of each instance of a set."""
    with open(folder / "best_known.csv", newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            found = [
                path
                for path in folder.iterdir()
                if path.stem == row["instance"] and path.suffix not in (".md", ".csv")
            ]
            if found:
                yield (
                    row["instance"],
                    float(row["lower_bound"]),
                    float(row["upper_bound"]),
                    found[0],
                )


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--sets", nargs="+", default=list(SETS))
    parser.add_argument("--seconds", type=float, default=15.0)
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--peers", nargs="+", default=list(PEERS), choices=list(PEERS))
    parser.add_argument("-o", "--output", type=Path)
    options = parser.parse_args()
    print(
        f"{options.seconds:g} s, {options.workers} workers, seed {options.seed}, ortools"
        f" {version('ortools')}, pyjobshop {version('pyjobshop')}",
        flush=True,
    )
    rows = []
    for name in options.sets:
        for instance, lower, upper, path in instances(options.data / name):
            cell = load(path)
            for peer in options.peers:
                run = PEERS[peer](cell, options.seconds, options.workers, options.seed)
                rows.append(
                    (
                        name,
                        instance,
                        lower,
                        upper,
                        peer,
                        run.makespan,
                        run.bound,
                        run.proven,
                        round(run.wall_s, 2),
                    )
                )
                print(_line(rows[-1]), flush=True)
                if options.output:
                    _write(options.output, rows)
    _summary(rows, options.peers)
    return _contradictions(rows)


def _line(row: tuple) -> str:
    name, instance, lower, upper, peer, makespan, bound, proven, wall = row
    gap = (
        "nothing"
        if makespan is None
        else f"{makespan:>9g}  {100 * (makespan - upper) / upper:+6.2f} %"
    )
    known = f"{name:<18}{instance:<26}{lower:>7g}{upper:>7g}"
    return (
        f"{known}  {peer:<10}{gap}  bound {bound or 0:>8g}  {'proven' if proven else '':<6}"
        f" {wall:6.2f} s"
    )


def _write(path: Path, rows: list[tuple]) -> None:
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(COLUMNS)
        writer.writerows(rows)


def _summary(rows: list[tuple], peers: list[str]) -> None:
    print(
        f"\n{'set':<18}{'solver':<11}{'instances':>9}{'solved':>8}{'proven':>8}"
        f"{'mean gap to best known':>25}{'worse':>7}{'better':>7}{'mean s':>8}"
    )
    for name in dict.fromkeys(row[0] for row in rows):
        for peer in peers:
            mine = [row for row in rows if row[0] == name and row[4] == peer]
            have = [row for row in mine if row[5] is not None]
            gap = sum((row[5] - row[3]) / row[3] for row in have) / max(len(have), 1)
            worse, better = (
                sum(row[5] > row[3] for row in have),
                sum(row[5] < row[3] for row in have),
            )
            seconds = sum(row[8] for row in mine) / max(len(mine), 1)
            print(
                f"{name:<18}{peer:<11}{len(mine):>9}{len(have):>8}"
                f"{sum(row[7] for row in mine):>8}{gap:>24.2%} {worse:>7}{better:>7}{seconds:>8.2f}"
            )


def _contradictions(rows: list[tuple]) -> int:
    wrong = [
        row
        for row in rows
        if (row[5] is not None and row[5] < row[2] - 1e-9)
        or (row[6] is not None and row[6] > row[3] + 1e-9)
    ]
    for row in wrong:
        print(f"CONTRADICTION with the bounds known: {_line(row)}", file=sys.stderr)
    return 1 if any(row[4] == "tandem" for row in wrong) else 0


__all__ = ["Run", "instances"]

if __name__ == "__main__":
    sys.exit(main())
