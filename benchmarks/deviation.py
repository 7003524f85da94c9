"""People who deviate, beside everybody who can decide live: makespan, stress, regret against the
exact optimum, with 95 % intervals.

    python benchmarks/deviation.py [--case FILE] [--learned FILE]
        [-o benchmarks/results/deviation.csv]
    python benchmarks/deviation.py --show benchmarks/results/deviation.csv
    python benchmarks/deviation.py --again fixed --show benchmarks/results/deviation.csv
        [--only thesis]

Cells: the thesis's, ten random layered cells of 9 to 12 tasks (seeds 0 to 9), a case study
(--case), Yu's desk. All deciders meet the same episodes (seed 0). Where everything is certain one
episode is as good as many; those who re-plan by CP-SAT get fewer episodes than the others, and the
large cells fewer than the small ones; each row says how many. Cells already in the output file are
kept, so a run that was stopped goes on. `--again` judges one decider anew, and says which of its
rows have changed.
"""

from __future__ import annotations

import argparse
import csv
import json
import sys
import time
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from tandem.cell.model import Cell
from tandem.dispatch.deciders.by_value import MOST_TASKS
from tandem.dispatch.deciders.policy import Options
from tandem.dispatch.evaluation.trial import judge
from tandem.files.generators import layered
from tandem.files.load import load
from tandem.lab.yu2020.board import desk
from tandem.learn.training.runs import versions
from tandem.world.randomness import Chance

ROOT = Path(__file__).resolve().parents[1]
PEOPLE = (
    "compliant", "random:0.1", "random:0.5", "random:1", "pace:0.6", "pace:2", "utility:stress=1",
    "adversarial", "refusing:0.2", "forgetful:0.1",
)  # fmt: skip
ELSEWHERE = ("compliant", "random:0.5", "pace:0.6", "pace:2", "adversarial", "forgetful:0.1")
"""On the other cells."""
CERTAIN = ("compliant", "pace:0.6", "pace:2", "utility:stress=1", "adversarial")
"""Beside whom every episode is the same."""
SCATTER = Chance(spread="lognormal", cv=0.3)
SCATTERED = "compliant, times scatter (cv 0.3)"
POLICIES = ("replan-robust", "fixed", "longest-tail", "replan", "expected", "minimax")
COLUMNS = (
    "cell", "digest", "tasks", "people", "policy", "episodes", "done", "makespan", "low", "high",
    "p95", "stress", "stress_low", "stress_high",
    "changes", "optimum", "regret_share", "regret_low", "regret_high", "proximity", "difference",
    "difference_low", "difference_high",
    "p50_ms", "p99_ms",
)  # fmt: skip
PAIRED = ("difference", "difference_low", "difference_high")
JUDGED = ("digest", "episodes", "done", "makespan", "stress", "regret_share", "difference")
"""What makes a decider's row another one."""


def cells(case: Path | None) -> Iterator[tuple[str, Cell, int]]:
    """(name, cell, episodes)."""
    yield "thesis", load(ROOT / "examples" / "thesis.yaml"), 1000
    for seed in range(10):
        yield f"layered-{9 + seed % 4}-{seed}", layered(9 + seed % 4, seed=seed), 100
    if case is not None:
        yield case.stem, load(case), 100
    yield "desk", desk().to_cell(), 3


def fewer(people: str, episodes: int, small: bool) -> dict[str, int]:
    """How many episodes the deciders get, where it is less than all: what re-plans is slow, and so
    is what meets no situation twice.
    """
    if people in CERTAIN:
        return dict.fromkeys((*POLICIES, "learned"), 2)
    slow = max(3, episodes // 10)
    if people == SCATTERED or (people.startswith("forgetful") and not small):
        return (
            dict.fromkeys((*POLICIES, "learned"), min(slow, 12))
            if not small
            else {"replan": slow, "replan-robust": slow}
        )
    return {"replan": slow, "replan-robust": max(slow, episodes // 2)}


def rows_of(
    name: str,
    cell: Cell,
    episodes: int,
    options: Options,
    tell: Callable[[str], None],
    among: Sequence[str] = POLICIES,
    beside: Collection[str] | None = None,
) -> Iterator[tuple[Any, ...]]:
    """One row per people and decider `among` those; with `beside`, beside these people only."""
    small = len(cell.tasks) <= MOST_TASKS
    policies = tuple(one for one in among if small or one not in ("expected", "minimax"))
    if options.learned is not None and name == "thesis":
        policies = (*policies, "learned")
    for people in (*(PEOPLE if name == "thesis" else ELSEWHERE), SCATTERED):
        if beside is not None and people not in beside:
            continue
        scatter = people == SCATTERED
        (document,) = judge(
            cell,
            policies,
            ("compliant",) if scatter else (people,),
            episodes,
            0,
            chance=SCATTER if scatter else Chance(),
            options=options,
            fewer=fewer(people, episodes, name == "thesis"),
            tell=tell,
        )
        for row in document["policies"]:
            time_, stress, latency, apart = (
                row["makespan"],
                row["stress"],
                row["latency_ms"],
                row.get("difference", {"mean": "", "ci95": ["", ""]}),
            )
            best = document["optimum"]
            regret = (
                [None, None]
                if best is None
                else [round(edge / best, 5) for edge in row["regret_ci95"]]
            )
            yield (
                name, cell.digest, len(cell.tasks), people, row["policy"], row["episodes"],
                row["done"], time_["mean"], *time_["ci95"], time_["p95"],
                stress["mean"], *stress["ci95"], row["changes"], best, row["regret_share"], *regret,
                row["proximity"], apart["mean"], *apart["ci95"],
                latency["p50"], latency["p99"],
            )  # fmt: skip


def show(rows: list[dict[str, str]]) -> None:
    """Regret in %, or the makespan where there is no exact optimum; the random cells as the mean
    over them.
    """
    groups: dict[str, list[dict[str, str]]] = {}
    for row in rows:
        groups.setdefault(
            "layered" if row["cell"].startswith("layered") else row["cell"], []
        ).append(row)
    for title, mine in groups.items():
        policies = list(dict.fromkeys(row["policy"] for row in mine))
        count = len({row["cell"] for row in mine})
        print(
            f"\n{title} ({count} cell{'s' * (count != 1)}): regret against the exact optimum, %"
            " (half its 95 % interval);"
        )
        print("where there is none: seconds above replan-robust in the same episodes")
        print(f"{'':<36}" + "".join(f"{policy:>18}" for policy in policies))
        for people in dict.fromkeys(row["people"] for row in mine):
            beside = [row for row in mine if row["people"] == people]
            entries = [
                _entry([row for row in beside if row["policy"] == policy]) for policy in policies
            ]
            print(f"{people:<36}" + "".join(f"{entry:>18}" for entry in entries))


def _entry(rows: list[dict[str, str]]) -> str:
    if not rows:
        return "-"
    if all(row["regret_share"] for row in rows):
        low, high = (
            sum(float(row[edge]) for row in rows) / len(rows)
            for edge in ("regret_low", "regret_high")
        )
        half = sum(
            ((float(row["regret_high"]) - float(row["regret_low"])) / 2) ** 2 for row in rows
        ) ** 0.5 / len(rows)
        return f"{50 * (low + high):.1f} ({100 * half:.1f})"
    mean = sum(float(row["makespan"]) for row in rows) / len(rows)
    if all(row["difference"] for row in rows):
        apart = sum(float(row["difference"]) for row in rows) / len(rows)
        half = sum(
            ((float(row["difference_high"]) - float(row["difference_low"])) / 2) ** 2
            for row in rows
        ) ** 0.5 / len(rows)
        return f"{apart:+.2f} s ({half:.2f})"
    return f"{mean:.2f} s"


def again(decider: str, earlier: list[dict[str, str]], options: argparse.Namespace) -> None:
    """Judges the decider anew in the same episodes; prints the rows that came out otherwise, and
    with `-o` writes the earlier table with the decider's rows of today.

    Where there is no exact optimum, the first decider plays along, to be compared with.
    """
    told = replace(Options(), budget_ms=options.budget)
    place = {(row["cell"], row["people"], row["policy"]): row for row in earlier}
    same = other = 0
    for name, cell, episodes in cells(options.case):
        if options.only and name not in options.only:
            continue
        then = {key[1]: row for key, row in place.items() if (key[0], key[2]) == (name, decider)}
        known = [people for people, row in then.items() if row["optimum"]]
        rows = [
            *rows_of(name, cell, episodes, told, lambda _: None, (decider,), known),
            *rows_of(
                name,
                cell,
                episodes,
                told,
                lambda _: None,
                (POLICIES[0], decider),
                then.keys() - known,
            ),
        ]
        for row in rows:
            now = dict(zip(COLUMNS, ("" if one is None else str(one) for one in row), strict=True))
            if now["policy"] != decider:
                continue
            before = then[now["people"]]
            now |= {} if now["difference"] else {key: before[key] for key in PAIRED}
            differing = [
                f"{key} {before[key]} -> {now[key]}" for key in JUDGED if before[key] != now[key]
            ]
            same, other = same + (not differing), other + bool(differing)
            if differing:
                print(f"{name}, {now['people']}: {', '.join(differing)}", flush=True)
            place[name, now["people"], decider] = now
        if options.output:
            with open(options.output, "w", newline="", encoding="utf-8") as file:
                writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
                writer.writeheader()
                writer.writerows(place.values())
    print(f"{decider}: {same} rows as before, {other} otherwise")


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--case", type=Path, help="a case study: a cell of any format")
    parser.add_argument("--learned", help="a trained best response for the thesis's cell")
    parser.add_argument("--only", nargs="+", help="only these cells")
    parser.add_argument("--budget", type=float, default=200.0, help="milliseconds per decision")
    parser.add_argument("--quick", action="store_true", help="a tenth of the episodes")
    parser.add_argument("-o", "--output", type=Path)
    parser.add_argument("--show", type=Path, help="only print the tables of an earlier run")
    parser.add_argument("--again", metavar="DECIDER", help="judge this one anew, against --show")
    options = parser.parse_args()
    if options.show:
        with open(options.show, newline="", encoding="utf-8") as file:
            earlier = list(csv.DictReader(file))
        if options.again:
            again(options.again, earlier, options)
        else:
            show(earlier)
        return 0
    rows: list[list[str]] = []
    if options.output and options.output.exists():
        with open(options.output, newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))[1:]
    began = time.perf_counter()
    for name, cell, episodes in cells(options.case):
        if (options.only and name not in options.only) or any(row[0] == name for row in rows):
            continue
        episodes = max(3, episodes // 10) if options.quick else episodes
        settings = replace(Options(), budget_ms=options.budget, learned=options.learned)
        rows += [
            ["" if one is None else str(one) for one in row]
            for row in rows_of(name, cell, episodes, settings, lambda _: None)
        ]
        print(f"{name}: {time.perf_counter() - began:.0f} s", file=sys.stderr, flush=True)
        if options.output:
            _write(options.output, rows, options)
    show([dict(zip(COLUMNS, row, strict=True)) for row in rows])
    return 0


def _write(path: Path, rows: list[list[str]], options: argparse.Namespace) -> None:
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerows([COLUMNS, *rows])
    case = (
        None
        if options.case is None
        else {"name": options.case.name, "digest": load(options.case).digest}
    )
    about = {
        "seed": 0,
        "budget_ms": options.budget,
        "case": case,
        "learned": options.learned is not None,
        "versions": versions(),
    }
    path.with_suffix(".json").write_text(json.dumps(about, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
