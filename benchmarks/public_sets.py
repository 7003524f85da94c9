"""Public benchmark instances: Tandem beside a plain CP-SAT model, PyJobShop and
discrete-optimization of Airbus at equal seconds, next to the best values known.

    python benchmarks/public_sets.py --data DIR [--sets fjsp_kacem ...] [--limit-per-set 3]
        [--only NAME ...] [--seconds 15] [--peers tandem ...] [-o FILE.csv]
    python benchmarks/public_sets.py --data DIR --show FILE.csv

DIR holds a folder per set with its instances and a best_known.csv (instance, lower_bound,
upper_bound). Without --sets it runs every set of flexible job shops and of human-robot cells that
is there; with --limit-per-set N so many instances of each, evenly spread. With -o it goes on where
an earlier run of the same limits stopped. Prints a row per instance as it is done, with the seconds
of a core that its threads took, and at the end a table per set, who is ahead there, and what was
run. Ends with 1 when a makespan lies below the best lower bound known, which would be an error of
ours.
"""

from __future__ import annotations

import argparse
import csv
import os
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

sys.path.insert(0, str(Path(__file__).parent))
from peers import PEERS, Run, versions
from tandem.files.load import load

FAMILIES = ("fjsp_", "hrc_")
"""Sets of cells, by the beginning of their names."""
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
    "cpu_s",
    "limit_s",
    "workers",
    "seed",
)


class Row(NamedTuple):
    """What one solver had for one instance: a line of the table, seconds.

    `cpu_s` are seconds of a core that all its threads took, which say more than `wall_s` on a busy
    machine; None in older tables.
    """

    set: str
    instance: str
    lower: float
    upper: float
    solver: str
    makespan: float | None
    bound: float | None
    proven: bool
    wall_s: float
    cpu_s: float | None = None

    @property
    def gap(self) -> float | None:
        """How far the makespan is above the best known, as a share of it; None without one."""
        return None if self.makespan is None else (self.makespan - self.upper) / self.upper


Instance = tuple[str, float, float, Path]


def instances(folder: Path) -> Iterator[Instance]:
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
                    float(row["lower_bound"] or 0),
                    float(row["upper_bound"]),
                    found[0],
                )


def sets(data: Path) -> list[str]:
    """The names of all sets of cells in the folder."""
    return sorted(
        path.parent.name
        for path in data.glob("*/best_known.csv")
        if path.parent.name.startswith(FAMILIES)
    )


def spread(rows: list[Instance], most: int | None) -> list[Instance]:
    """So many of them, the first and then at even distances."""
    if most is None or most >= len(rows):
        return rows
    return [rows[index * len(rows) // most] for index in range(most)]


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--sets", nargs="+")
    parser.add_argument("--limit-per-set", type=int, metavar="N")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="these instances of the sets")
    parser.add_argument("--seconds", type=float, default=15.0)
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--peers", nargs="+", default=list(PEERS), choices=list(PEERS))
    parser.add_argument("-o", "--output", type=Path)
    parser.add_argument("--show", type=Path, metavar="FILE.csv", help="print its tables, run none")
    options = parser.parse_args()
    there = sets(options.data)
    if unknown := set(options.sets or ()) - set(there):
        parser.error(
            f"--sets {' '.join(sorted(unknown))}: not in {options.data}; there are"
            f" {', '.join(there) or 'none'}"
        )
    if options.show:
        rows = read(options.show)
        _summary(rows, there, options.data)
        return _contradictions(rows)
    limits = (options.seconds, options.workers, options.seed)
    try:
        rows = read(options.output, limits) if options.output and options.output.exists() else []
    except ValueError as error:
        parser.error(f"-o {options.output}: {error}")
    print(
        f"{options.seconds:g} s, {options.workers} workers, seed {options.seed},"
        f" {versions(options.peers)}; {len(rows)} rows from before",
        flush=True,
    )
    try:
        _run(options, options.sets or there, limits, rows)
    except KeyboardInterrupt:
        print("stopped; the next call with the same -o goes on.", file=sys.stderr)
        return 130
    _summary(rows, there, options.data)
    return _contradictions(rows)


def _run(
    options: argparse.Namespace, names: list[str], limits: tuple[float, int, int], rows: list[Row]
) -> None:
    """Adds what is missing to the rows."""
    done = {(row.set, row.instance, row.solver) for row in rows}
    for name in names:
        asked = [one for one in instances(options.data / name) if one[0] in (options.only or one)]
        for instance, lower, upper, path in spread(asked, options.limit_per_set):
            wanted = [peer for peer in options.peers if (name, instance, peer) not in done]
            cell = load(path) if wanted else None
            for peer in wanted:
                began = time.process_time()
                run = PEERS[peer](cell, *limits)
                spent = round(time.process_time() - began, 2)
                found = run.makespan, run.bound, run.proven, round(run.wall_s, 2), spent
                rows.append(Row(name, instance, lower, upper, peer, *found))
                print(_line(rows[-1]), flush=True)
                if options.output:
                    _write(options.output, rows, limits)


def read(path: Path, limits: tuple[float, int, int] | None = None) -> list[Row]:
    """The rows of a table. Raises ValueError when it was made under other limits than these."""
    with open(path, newline="", encoding="utf-8") as file:
        lines = list(csv.DictReader(file))
    for line in lines:
        made = tuple(line.get(key) for key in ("limit_s", "workers", "seed"))
        if limits is not None and made != tuple(f"{value:g}" for value in limits):
            raise ValueError(
                f"it was made with {made[0]} s, {made[1]} workers, seed {made[2]}, and this is"
                f" {limits[0]:g} s, {limits[1]} workers, seed {limits[2]}; name another file"
            )
    return [
        Row(
            line["set"],
            line["instance"],
            float(line["lower_known"]),
            float(line["upper_known"]),
            line["solver"],
            float(line["makespan"]) if line["makespan"] else None,
            float(line["bound"]) if line["bound"] else None,
            line["proven"] == "True",
            float(line["wall_s"]),
            float(line["cpu_s"]) if line.get("cpu_s") else None,
        )
        for line in lines
    ]


def _line(row: Row) -> str:
    gap = "nothing" if row.gap is None else f"{row.makespan:>9g}  {100 * row.gap:+6.2f} %"
    known = f"{row.set:<20}{row.instance:<26}{row.lower:>7g}{row.upper:>7g}"
    return (
        f"{known}  {row.solver:<10}{gap}  bound {row.bound or 0:>8g} "
        f" {'proven' if row.proven else '':<6} {row.wall_s:6.2f} s"
        f"{'' if row.cpu_s is None else f', {row.cpu_s:.2f} of a core'}"
    )


def _write(path: Path, rows: list[Row], limits: tuple[float, int, int]) -> None:
    part = path.with_suffix(".part")
    with open(part, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(COLUMNS)
        writer.writerows((*row, *(f"{value:g}" for value in limits)) for row in rows)
    part.replace(path)


def _summary(rows: list[Row], there: list[str], data: Path) -> None:
    print(
        f"\n{'set':<20}{'solver':<11}{'instances':>9}{'solved':>8}{'proven':>8}"
        f"{'mean gap to best known':>25}{'worse':>7}{'better':>7}{'mean s':>8}"
    )
    peers = list(dict.fromkeys(row.solver for row in rows))
    names = list(dict.fromkeys(row.set for row in rows))
    for name in names:
        for peer in peers:
            mine = [row for row in rows if (row.set, row.solver) == (name, peer)]
            gaps = [row.gap for row in mine if row.gap is not None]
            seconds = sum(row.wall_s for row in mine) / max(len(mine), 1)
            print(
                f"{name:<20}{peer:<11}{len(mine):>9}{len(gaps):>8}"
                f"{sum(row.proven for row in mine):>8}{sum(gaps) / max(len(gaps), 1):>24.2%} "
                f"{sum(gap > 0 for gap in gaps):>7}{sum(gap < 0 for gap in gaps):>7}"
                f"{seconds:>8.2f}"
            )
        print(f"{name:<20}ahead: {ahead(rows, name)}")
    run = {name: len({row.instance for row in rows if row.set == name}) for name in names}
    print(
        "\nrun:", ", ".join(f"{count} of {_size(data, name)} {name}" for name, count in run.items())
    )
    if left := [name for name in there if name not in run]:
        print("not run:", ", ".join(left))


def ahead(rows: list[Row], name: str) -> str:
    """Who is ahead on a set, by proofs and by the mean gap over the instances that all of them
    solved.
    """
    mine = [row for row in rows if row.set == name]
    peers = list(dict.fromkeys(row.solver for row in mine))
    proven = {peer: sum(row.proven for row in mine if row.solver == peer) for peer in peers}
    nothing = {row.instance for row in mine if row.gap is None}
    gaps = {
        peer: [row.gap or 0 for row in mine if row.solver == peer and row.instance not in nothing]
        for peer in peers
    }
    mean = {peer: round(sum(own) / max(len(own), 1), 6) for peer, own in gaps.items()}
    most = [peer for peer in peers if proven[peer] == max(proven.values())]
    solved_by = {peer: sum(r.gap is not None for r in mine if r.solver == peer) for peer in peers}
    # where no instance was solved by all, who solved most
    able = peers
    if not any(gaps.values()):
        able = [peer for peer in peers if solved_by[peer] == max(solved_by.values())]
    least = [peer for peer in able if mean[peer] == min(mean[other] for other in able)]
    solved = f" ({len(nothing)} not solved by all)" if nothing else ""
    return f"proofs {', '.join(most)}; mean gap {', '.join(least)}{solved}"


def _size(data: Path, name: str) -> int:
    return len(list(instances(data / name))) if (data / name).is_dir() else 0


def _contradictions(rows: list[Row]) -> int:
    wrong = [
        row
        for row in rows
        if (row.makespan is not None and row.makespan < row.lower - 1e-9)
        or (row.bound is not None and row.bound > row.upper + 1e-9)
    ]
    for row in wrong:
        print(f"CONTRADICTION with the bounds known: {_line(row)}", file=sys.stderr)
    return 1 if any(row.solver == "tandem" for row in wrong) else 0


__all__ = ["Run", "instances"]

if __name__ == "__main__":
    sys.exit(main())
