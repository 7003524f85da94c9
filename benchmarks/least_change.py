"""One robot time changes by so many seconds: how many of 21 tasks change when the cell is planned
anew, and how many when the old plan is carried over.

    python benchmarks/least_change.py [--cells 6] [--changes 5] [--longer 4] [-o FILE.csv]
    python benchmarks/least_change.py --show benchmarks/results/least_change.csv

Random layered cells of 21 tasks (seeds 0, 1, ...), a robot and a human. The old plan is the
recommended point of the front. Then the robot takes four seconds longer (`--longer`) for one task
of its plan: for each of so many tasks, drawn by the cell's seed. Anew: the point of `tandem plan`'s
new front that is quickest with at most the old plan's stress. Carried over: `tandem replan`, as it
is when nothing is said (2 % above the new optimum, starts within 5 s are the same). A task has
changed when others do it, its order on its operator is another, or its start has moved by more than
5 s.
"""

from __future__ import annotations

import argparse
import csv
import time
from collections.abc import Iterator
from pathlib import Path
from random import Random

from tandem.cell.model import Cell
from tandem.files.generators import layered
from tandem.plan.least_change import replan
from tandem.plan.methods import plan
from tandem.plan.replanned import Replan
from tandem.report.stored import point_of
from tandem.schedule.changes import changes
from tandem.schedule.model import Schedule

TASKS = 21
COLUMNS = (
    "seed", "digest", "task", "old_makespan", "old_stress",
    "anew_makespan", "anew_operator", "anew_order", "anew_start", "anew_any",
    "replan_makespan", "replan_operator", "replan_order", "replan_start", "replan_any",
    "proven", "replan_s",
)  # fmt: skip


def rows_of(
    seed: int, count: int, longer: float, workers: int | None
) -> Iterator[tuple[object, ...]]:
    """One row for each of the cell's changes."""
    cell = layered(TASKS, seed=seed)
    old = plan(cell, workers=workers).knee
    robots = [
        a.task for a in old.schedule for who in a.operators if cell.operators[who].kind == "robot"
    ]
    for task in sorted(Random(seed).sample(robots, min(count, len(robots))), key=int):
        changed = slower(cell, task, longer)
        front = plan(changed, workers=workers)
        anew = front[point_of(front, stress=max(old.stress, min(r.stress for r in front)))]
        began = time.perf_counter()
        found = replan(changed, old.schedule, stress=old.stress, workers=workers)
        spent = time.perf_counter() - began
        best = found[0]
        assert isinstance(best, Replan)
        yield (
            seed, cell.digest, task, old.makespan, old.stress,
            anew.makespan, *counted(old.schedule, anew.schedule),
            best.makespan, *counted(old.schedule, best.schedule),
            int(found.complete), round(spent, 2),
        )  # fmt: skip


def counted(old: Schedule, new: Schedule) -> tuple[int, int, int, int]:
    """Tasks that change operator, order and start, and all whose operators or start differ at
    all.
    """
    return *changes(old, new).counts, sum(changes(old, new, 0.0).counts)


def slower(cell: Cell, task: str, longer: float) -> Cell:
    """The cell in which robots take so much longer for the task."""
    time_ = {
        who: seconds + longer * (cell.operators[who].kind == "robot")
        for who, seconds in cell.tasks[task].time.items()
    }
    data = cell.to_dict()
    data["tasks"][task]["time"] = time_
    return Cell.model_validate(data)


def show(rows: list[dict[str, str]]) -> None:
    """The table of the page: per cell, means over its changes."""
    head = ["seed", "changes"]
    for way in ("anew", "replan"):
        head += [f"{way}: changed", "most", "operator / order / start", "begin at another moment"]
    print(f"| {' | '.join([*head, 'makespan above anew'])} |")
    print("|---:|" + "---:|" * len(head))
    groups = {seed: [row for row in rows if row["seed"] == seed] for seed in seeds(rows)}
    for name, group in [*groups.items(), ("all", rows)]:
        said = [text for way in ("anew", "replan") for text in summed(group, way)]
        above = [float(row["replan_makespan"]) / float(row["anew_makespan"]) - 1 for row in group]
        print(f"| {name} | {len(group)} | {' | '.join(said)} | {100 * mean(above):.1f} % |")
    proven = sum(int(row["proven"]) for row in rows)
    slowest = max(float(row["replan_s"]) for row in rows)
    print(f"\nproven to change least: {proven} of {len(rows)}; at most {slowest:.1f} s each")


def summed(group: list[dict[str, str]], way: str) -> list[str]:
    """What one way of planning changes, in four cells of the table."""
    counts = [[int(row[f"{way}_{what}"]) for row in group]
              for what in ("operator", "order", "start")]  # fmt: skip
    total = [sum(column) for column in zip(*counts, strict=True)]
    return [
        f"{mean(total):.1f}",
        f"{max(total)}",
        " / ".join(f"{mean(column):.1f}" for column in counts),
        f"{mean([int(row[f'{way}_any']) for row in group]):.1f}",
    ]


def seeds(rows: list[dict[str, str]]) -> list[str]:
    """Every seed once, in order."""
    return list(dict.fromkeys(row["seed"] for row in rows))


def mean(values: list[int] | list[float]) -> float:
    """The arithmetic mean."""
    return sum(values) / len(values)


def main() -> None:
    """Runs and shows, or shows what was stored."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n\n")[0])
    parser.add_argument("--cells", type=int, default=6, help="how many cells")
    parser.add_argument("--changes", type=int, default=5, help="tasks that get slower, per cell")
    parser.add_argument("--longer", type=float, default=4, help="seconds more that robots take")
    parser.add_argument("--workers", type=int, help="threads; one per core when absent")
    parser.add_argument("--show", type=Path, help="show this file and run nothing")
    parser.add_argument("-o", "--output", type=Path, help="CSV file to write")
    arguments = parser.parse_args()
    if arguments.show:
        with arguments.show.open() as file:
            return show(list(csv.DictReader(file)))
    rows = [
        row
        for seed in range(arguments.cells)
        for row in rows_of(seed, arguments.changes, arguments.longer, arguments.workers)
    ]
    if arguments.output:
        with arguments.output.open("w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerows([COLUMNS, *rows])
    return show([dict(zip(COLUMNS, map(str, row), strict=True)) for row in rows])


if __name__ == "__main__":
    main()
