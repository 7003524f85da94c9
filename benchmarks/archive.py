"""The best schedule and the best bound that we hold for public cells, each with who found it; a
long run that may be stopped at any time and goes on.

    python benchmarks/archive.py --data DIR [--sets fjsp_dag_birgin ...] [--only NAME ...]
        [--seconds 30] [--workers 1] [--rounds 1]
    python benchmarks/archive.py --data DIR --show

Works through the instances that are open, the least often worked on first and of those the one with
the widest gap. A schedule comes in through the checker only, and only when it is better; a bound
only when it is higher, and never above a schedule. Ctrl-C keeps what was found; the next call goes
on. `benchmarks/archive/README.md` says what the files hold.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import date
from decimal import Decimal
from pathlib import Path
from time import monotonic
from typing import Any

sys.path.insert(0, str(Path(__file__).parent))
from public_sets import instances
from tandem import __version__
from tandem.cell.model import Cell
from tandem.errors import NothingFoundError
from tandem.files.load import load
from tandem.plan import bounds
from tandem.plan.cpsat import SOLVER
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout
from tandem.plan.lower_bound import prove_makespan
from tandem.plan.method import Progress
from tandem.plan.methods import plan
from tandem.plan.proving import REFUTABLE, REFUTABLE_OPERATORS
from tandem.schedule.checker import faults
from tandem.schedule.measures import makespan
from tandem.schedule.model import Schedule

HERE = Path(__file__).parent / "archive"
SETS = ("fjsp_dag_birgin", "hrc_battery_cells")
STATES_FROM = 0.9
"""It is asked when the bound is at least this share of the makespan."""
CLOSED: dict[str, Callable[[Layout], int]] = {
    "chain bound": bounds.chain_bound,
    "one-operator bound": bounds.one_operator_bound,
    "load bound": bounds.load_bound,
}
"""Who proves without a search: name -> ticks."""
Row = dict[str, Any]


class ContradictionError(Exception):
    """A bound above a checked schedule, or a stored schedule that breaks its cell."""


@dataclass
class Entry:
    """What is held for one instance.

    Attributes:
      digest: of the cell; another one means that the instance or its reading has changed.
      schedule: `makespan` seconds, `tasks` (name -> operators and start in seconds; the ends follow
        from the cell), and how it was found; None when there is none.
      bound: `makespan` seconds below which no schedule ends, `by` whom it was proven, and how.
      rounds: how often it has been worked on; `seconds` in all.
    """

    set: str
    instance: str
    digest: str
    schedule: Row | None = None
    bound: Row | None = None
    rounds: int = 0
    seconds: float = 0.0

    @classmethod
    def read(cls, name: str, instance: str, cell: Cell) -> Entry:
        """The stored entry, or an empty one. Raises ContradictionError when it is of another cell
        or holds what the checker refuses.
        """
        path = HERE / name / f"{instance}.json"
        if not path.exists():
            return cls(name, instance, cell.digest)
        entry = cls(**json.loads(path.read_text(encoding="utf-8")))
        if wrong := entry.faults(cell):
            raise ContradictionError(f"{path}: {' '.join(wrong)} Remove the file to begin anew.")
        return entry

    def faults(self, cell: Cell | None = None) -> list[str]:
        """What is wrong with the entry by itself and, where the cell is given, with its schedule;
        in sentences.
        """
        wrong = []
        if self.lower > self.upper:
            wrong.append(f"the bound {self.lower:g} lies above the schedule's {self.upper:g}.")
        if cell is None or self.schedule is None:
            return wrong
        if cell.digest != self.digest:
            return [*wrong, f"it is of a cell {self.digest}, and the file there is {cell.digest}."]
        schedule = unpacked(cell, self.schedule["tasks"])
        wrong += faults(cell, schedule)
        if makespan(schedule) != self.upper:
            wrong.append(f"its makespan is {makespan(schedule):g} and not {self.upper:g}.")
        return wrong

    def write(self) -> None:
        """Writes the file as a whole or not at all."""
        path = HERE / self.set / f"{self.instance}.json"
        path.parent.mkdir(parents=True, exist_ok=True)
        part = path.with_suffix(".part")
        rows = ",\n ".join(
            f"{json.dumps(key)}: {json.dumps(vars(self)[key])}" for key in vars(self)
        )
        part.write_text(f"{{{rows}}}\n", encoding="utf-8")
        part.replace(path)

    @property
    def upper(self) -> float:
        """The makespan of the schedule, seconds."""
        return float("inf") if self.schedule is None else self.schedule["makespan"]

    @property
    def lower(self) -> float:
        """The bound, seconds."""
        return 0.0 if self.bound is None else self.bound["makespan"]

    @property
    def gap(self) -> float:
        """How far the schedule may be above the optimum, as a share of the bound."""
        return (self.upper - self.lower) / self.lower if self.lower else float("inf")

    @property
    def proven(self) -> bool:
        """The schedule is optimal."""
        return self.lower >= self.upper

    def take_schedule(self, cell: Cell, schedule: Schedule, how: Row) -> None:
        """Takes a schedule that is better and that the checker accepts. Raises ContradictionError
        when it beats the bound.
        """
        value = makespan(schedule)
        if value >= self.upper or faults(cell, schedule):
            return
        if value < self.lower:
            raise ContradictionError(
                f"{self.instance}: a checked schedule of {value:g} s lies below the bound"
                f" {self.lower:g} s by {self.bound and self.bound['by']}."
            )
        self.schedule = {"makespan": short(value), "tasks": packed(schedule), **how}

    def take_bound(self, value: float, by: str, how: Row) -> None:
        """Takes a bound that is higher. Raises ContradictionError when it is above a schedule."""
        if value <= self.lower:
            return
        if value > self.upper:
            raise ContradictionError(
                f"{self.instance}: {by} proves {value:g} s, above a checked schedule of"
                f" {self.upper:g} s."
            )
        self.bound = {"makespan": short(value), "by": by, **how}


def packed(schedule: Schedule) -> dict[str, list[Any]]:
    """Task -> operators and start in seconds. The ends, which are times of the cell, stay out."""
    return {a.task: [list(a.operators), short(a.start)] for a in schedule}


def short(seconds: float) -> float:
    """The same number, written without a point where it is whole."""
    return int(seconds) if seconds == int(seconds) else seconds


def unpacked(cell: Cell, tasks: dict[str, list[Any]]) -> Schedule:
    """The inverse of `packed`, each task in the quickest way in which these operators do it."""
    instance = Instance.of(cell)
    names = list(cell.tasks)
    operators = list(cell.operators)
    starts = []
    for task, ways in zip(names, instance.ways, strict=True):
        who, start = tasks[task]
        team = {operators.index(name) for name in who}
        way = min(
            (w for w in range(len(ways)) if set(ways[w].operators) == team),
            key=lambda w: ways[w].ticks,
        )
        starts.append((way, int(Decimal(repr(start)) * instance.per_second)))
    return instance.schedule(starts)


def work_on(entry: Entry, cell: Cell, seconds: float, workers: int) -> bool:
    """Some seconds of work on one instance; false when it was interrupted."""
    began = monotonic()
    instance = Instance.of(cell)
    layout = Layout.of(instance)

    def how() -> Row:
        return {
            "seconds": round(monotonic() - began, 1),
            "machine": f"{platform.machine()}, {os.cpu_count()} cores, {workers} workers",
            "date": date.today().isoformat(),
            "version": f"tandem {__version__}",
        }

    def note(progress: Progress) -> None:
        best = min(progress.found, key=lambda result: result.makespan)
        entry.take_schedule(cell, best.schedule, {"by": "tandem exact", **how()})

    for name, bound in CLOSED.items():
        entry.take_bound(instance.seconds(bound(layout)), name, how())
    finished = True
    try:
        is_refutable = (
            len(instance.tasks) <= REFUTABLE and len(instance.operators) <= REFUTABLE_OPERATORS
        )
        if entry.schedule is not None and is_refutable:
            _through_states(entry, cell, instance, seconds / 3, how)
        left = seconds - (monotonic() - began)
        if not entry.proven and left > 0:
            front = plan(
                cell,
                minimize="makespan",
                time_limit=left,
                workers=workers,
                seed=entry.rounds,
                hint=None if entry.schedule is None else unpacked(cell, entry.schedule["tasks"]),
                on_solution=note,
            )
            finished = not front.interrupted
            entry.take_schedule(cell, front[0].schedule, {"by": "tandem exact", **how()})
            # one worker asks CP-SAT alone; several have the search through states beside it
            by = SOLVER if workers == 1 else f"{SOLVER} beside dynamic programming"
            entry.take_bound(front[0].bound.makespan, by, how())
    except NothingFoundError as error:
        print(f"{entry.instance}: {error}", file=sys.stderr)
    except KeyboardInterrupt:
        finished = False
    entry.rounds += 1
    entry.seconds = round(entry.seconds + monotonic() - began, 1)
    entry.write()
    return finished


def _through_states(
    entry: Entry, cell: Cell, instance: Instance, seconds: float, how: Callable[[], Row]
) -> None:
    if entry.lower < STATES_FROM * entry.upper:
        return
    upper = round(entry.upper * instance.per_second)
    proof = prove_makespan(instance, upper, seconds)
    if proof.starts is not None:
        entry.take_schedule(
            cell, instance.schedule(proof.starts), {"by": "dynamic programming", **how()}
        )
    entry.take_bound(instance.seconds(proof.bound), "dynamic programming", how())


def entries(data: Path, sets: list[str], only: list[str]) -> Iterator[tuple[Entry, Cell, Row]]:
    """Entry, cell, and the best values known elsewhere, of each instance asked for."""
    for name in sets:
        for instance, lower, upper, path in instances(data / name):
            if not only or instance in only:
                cell = load(path)
                known = {"lower": lower, "upper": upper}
                yield Entry.read(name, instance, cell), cell, known


def show(held: list[tuple[Entry, Cell, Row]]) -> None:
    """The table: a line per instance and a sum per set."""
    print(
        f"{'instance':<14}{'schedule':>9}{'bound':>8}{'gap':>8}  {'known':>11}  bound by",
    )
    for entry, _, known in held:
        there = f"{known['lower']:g}-{known['upper']:g}"
        mark = "proven" if entry.proven else f"{entry.gap:.2%}"
        by = "" if entry.bound is None else entry.bound["by"]
        better = " *" if entry.upper < known["upper"] or entry.lower > known["lower"] else ""
        print(
            f"{entry.instance:<14}{entry.upper:>9g}{entry.lower:>8g}{mark:>8}  {there:>11}"
            f"  {by}{better}"
        )
    for name in dict.fromkeys(entry.set for entry, _, _ in held):
        mine = [(entry, known) for entry, _, known in held if entry.set == name]
        over = [(entry.upper - known["upper"]) / known["upper"] for entry, known in mine]
        print(
            f"{name}: {len(mine)} instances, {sum(entry.proven for entry, _ in mine)} proven, mean"
            f" gap {sum(entry.gap for entry, _ in mine) / len(mine):.2%}; to the best known"
            f" {sum(over) / len(mine):+.2%}, {sum(x < 0 for x in over)} schedules and"
            f" {sum(entry.lower > known['lower'] for entry, known in mine)} bounds better,"
            f" {sum(x > 0 for x in over)} schedules worse"
        )
    print("* better than the best known value")


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--data", type=Path, required=True, help="the folder of the sets")
    parser.add_argument("--sets", nargs="+", default=list(SETS))
    parser.add_argument("--only", nargs="+", default=[], metavar="NAME")
    parser.add_argument("--seconds", type=float, default=30.0, help="for each instance")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--rounds", type=int, default=1, help="how often each open instance")
    parser.add_argument("--show", action="store_true", help="print what is held, and work on none")
    options = parser.parse_args()
    for name in options.sets:
        if not (options.data / name / "best_known.csv").is_file():
            parser.error(f"--data {options.data}: no set {name!r} with a best_known.csv there")
    try:
        held = list(entries(options.data, options.sets, options.only))
        if not held:
            parser.error(f"--only: no instance of {', '.join(options.sets)} has such a name")
        if options.show:
            show(held)
            return 0
        for _ in range(options.rounds):
            if not _one_round(held, options):
                return 130
        show(held)
    except ContradictionError as error:
        print(f"CONTRADICTION: {error}", file=sys.stderr)
        return 1
    return 0


def _one_round(held: list[tuple[Entry, Cell, Row]], options: argparse.Namespace) -> bool:
    """Each open instance once; false when it was interrupted."""
    for entry, cell, _ in sorted(held, key=lambda row: (row[0].rounds, -row[0].gap)):
        if entry.proven:
            continue
        before = (entry.upper, entry.lower)
        finished = work_on(entry, cell, options.seconds, options.workers)
        print(
            f"{entry.instance:<14}{before[1]:>7g}-{before[0]:<7g} now"
            f" {entry.lower:>7g}-{entry.upper:<7g}"
            f" {'proven' if entry.proven else f'{entry.gap:.2%}'}"
            f" by {entry.bound and entry.bound['by']}",
            flush=True,
        )
        if not finished:
            print("stopped; the next call goes on.", file=sys.stderr)
            return False
    return True


if __name__ == "__main__":
    sys.exit(main())
