"""The policy for any cell, on cells that it was never trained on: how far above the optimum its
schedules are, beside the best dispatch rule and as many random schedules, and how long a decision
takes.

    python benchmarks/graph_policy.py cells [--tasks 10 20 50] [--operators 2] [--cells 30]
        [--rich] [--samples 64] [--work 20] [--key NAME] [-o FILE]
    python benchmarks/graph_policy.py public --data DIR [--sets fjsp_sd2_10x5 ...] [--cells 20]
        [--samples 100] [-o FILE]
    python benchmarks/graph_policy.py boards [--cells 20] [--samples 64] [-o FILE]
    python benchmarks/graph_policy.py fronts [--tasks 10] [--cells 100] [--samples 64] [--finer]
        [-o FILE]

`cells` are `layered` ones, seeds 0, 1, ... (the trainer draws from another range); makespan alone
counts. The yardstick is the proven optimum, or the bound where `--work` (CP-SAT's deterministic
seconds) proves none; gaps are the mean in per cent with a 95 % bootstrap interval. `greedy or a
rule` is the better of the greedy schedule and of what the rules find that draw nothing, which
a plan has by then. `best-of-n` is the rule of that name, at as many schedules, and `exact` the
planner with one worker for as many seconds as these schedules of the network took. Milliseconds are
processor time, of one thread. `--rich` gives the cells joint ways, tools and a zone.

`public` are flexible job shops made by others (or `--sets hrc_case_studies`, assembly by people and
robots), evenly spread over each set; gaps are to the best makespan known, beside what was
published. `boards` are the chessboards of Yu (2020), seeds 0, 1, ..., against their proven optima
with waiting, and the desk in seconds. `fronts` moves the weight of stress alone: how many exact
points of a cell's front are reached, and how much of its area; and the same of the thesis's cell.
`--finer` asks at 27 weights instead of 14.

What is measured goes under a key of its own into `-o FILE`; the others there stay.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import platform
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from random import Random
from typing import Any

# matrices of a decision are too small for more than one thread, which would only wait
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

from tandem import __version__
from tandem.cell.model import Cell
from tandem.files import atomic
from tandem.files.generators import layered
from tandem.files.load import load
from tandem.files.validate import cell_of
from tandem.learn.graph.drawing import Drawing
from tandem.learn.graph.making import Maker
from tandem.learn.graph.method import by_weights, weights_of_stress
from tandem.learn.graph.outlook import Outlook
from tandem.learn.graph.training_cells import add_joint_ways, add_tools, add_zone
from tandem.learn.graph.weights import shipped
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout, PartialSchedule
from tandem.plan.methods import plan
from tandem.plan.question import Question
from tandem.plan.rules import SPECS, attempts

QUICKEST = Question(minimize="makespan")
SETS = ("fjsp_sd1_10x5", "fjsp_sd1_20x5", "fjsp_sd2_10x5", "fjsp_sd2_20x5", "fjsp_brandimarte")
PUBLISHED = "published_results.csv"
THESIS = Path("examples/thesis.yaml")


def unseen_cells(
    tasks: Sequence[int], operators: int, count: int, rich: bool = False
) -> Iterator[tuple[int, Cell]]:
    """Size and cell: so many of each size, half of the operators human. Those that are `rich` have
    joint ways, tools and a zone.
    """
    for size in tasks:
        for seed in range(count):
            humans = (operators + 1) // 2
            cell = layered(size, humans, operators - humans, seed=seed)
            if rich:
                data, rng = cell.to_dict(), np.random.default_rng(seed)
                add_joint_ways(data, rng)
                add_tools(data, rng)
                add_zone(data, rng)
                cell = cell_of(data)
            yield size, cell


def least(states: Sequence[PartialSchedule | None]) -> float:
    """Ticks of the quickest."""
    return min((state.makespan for state in states if state is not None), default=float("inf"))


def rule(layout: Layout, name: str, samples: int) -> float:
    """Ticks of what the rule finds, `best-of-n` by so many schedules."""
    spec = SPECS[name]
    if spec.samples > 1:
        spec = replace(spec, samples=samples)
    return least(list(attempts(layout, spec, Random(0), QUICKEST, lambda: True)))


def by_policy(layout: Layout, samples: int) -> dict[str, float]:
    """Ticks of the greedy schedule and of the best of so many; `us` to look at the cell, and per
    decision of the greedy one.
    """
    began = time.process_time()
    maker = Maker.of(shipped(), Outlook.of(layout, 0.0))
    looked = time.process_time()
    drawing = Drawing.of(maker, np.random.default_rng(0))
    greedy, _ = drawing.greedy()
    chosen = time.process_time()
    drawn = list(drawing.drawn(samples - 1))
    return {
        "greedy": least([greedy]),
        f"best of {samples}": least([greedy, *drawn]),
        "look us": 1e6 * (looked - began),
        "decision us": 1e6 * (chosen - looked) / len(layout.steps),
        "s": time.process_time() - began,
    }


def measured(layout: Layout, samples: int, bound: float) -> dict[str, float]:
    """Gaps above the bound, ticks, as shares of it, and the times."""
    found = by_policy(layout, samples)
    best = {name: rule(layout, name, samples) for name in SPECS}
    ends = {name: found.pop(name) for name in ("greedy", f"best of {samples}")}
    ends["best-of-n"], ends["random"] = best.pop("best-of-n"), best.pop("random")
    ends["best rule without draws"] = min(best.values())
    ends["greedy or a rule"] = min(ends["greedy"], ends["best rule without draws"])
    return {**{name: end / bound - 1 for name, end in ends.items()}, **found}


def interval(values: Sequence[float]) -> tuple[float, float, float]:
    """The mean and its 95 % bootstrap interval."""
    rng, array = np.random.default_rng(0), np.array(values)
    means = rng.choice(array, (2000, len(array))).mean(1)
    low, high = np.quantile(means, (0.025, 0.975))
    return float(array.mean()), float(low), float(high)


def told(first: dict[str, Any], rows: Sequence[dict[str, float]]) -> dict[str, Any]:
    """One line of a table: the means of the rows."""
    document: dict[str, Any] = {**first, "cells": len(rows)}
    for name in rows[0]:
        values = [row[name] for row in rows]
        if name.endswith(" us"):
            document[name] = round(float(np.median(values)))
        elif name == "s":
            document[name] = round(float(np.median(values)), 2)
        elif name == "proven":
            document[name] = sum(values) / len(rows)
        else:
            mean, low, high = interval([100 * value for value in values])
            document[name] = {"gap": round(mean, 2), "ci95": [round(low, 2), round(high, 2)]}
    print(json.dumps(document), flush=True)
    return document


def cells(asked: argparse.Namespace) -> dict[str, Any]:
    """Generated cells against their optimum or bound."""
    document: dict[str, Any] = {
        key: getattr(asked, key) for key in ("operators", "rich", "cells", "samples", "work")
    }
    rows: dict[int, list[dict[str, float]]] = {}
    # bounds that the file holds stay proven, whatever the weights are
    known = kept_in(asked.output).get(asked.key or "cells", {}).get("yardsticks", {})
    document |= {"rows": [], "yardsticks": known}
    for size, cell in unseen_cells(asked.tasks, asked.operators, asked.cells, asked.rich):
        layout = Layout.of(Instance.of(cell))
        bound, proven = known.get(cell.digest) or yardstick(cell, asked.work)
        known[cell.digest] = (bound, proven)
        found = measured(layout, asked.samples, bound * layout.instance.per_second)
        found["exact"] = as_long(cell, found["s"]) / bound - 1
        rows.setdefault(size, []).append({**found, "proven": float(proven)})
        if len(rows[size]) == asked.cells:
            document["rows"].append(told({"tasks": size}, rows[size]))
    return document


def as_long(cell: Cell, seconds: float) -> float:
    """Seconds of the schedule that the planner finds in so many seconds."""
    return plan(cell, QUICKEST, time_limit=seconds, workers=1, confirm=False)[0].makespan


def yardstick(cell: Cell, work: float) -> tuple[float, bool]:
    """Seconds that no schedule is quicker than, and whether one is as quick."""
    found = plan(cell, QUICKEST, work=work, workers=1, settle=False, confirm=False)[0]
    return found.bound.makespan, found.status.name == "OPTIMAL"


def public(asked: argparse.Namespace) -> dict[str, Any]:
    """Public instances, flexible job shops first of all, against the best makespans known."""
    document: dict[str, Any] = {"samples": asked.samples, "rows": []}
    for name in asked.sets:
        folder = asked.data / name
        with (folder / "best_known.csv").open() as file:
            known = {row["instance"]: float(row["upper_bound"]) for row in csv.DictReader(file)}
        files = sorted(path for path in folder.iterdir() if path.stem in known and path.suffix in (
            ".fjs", ".txt", ".json"))  # fmt: skip
        step = max(1, len(files) // asked.cells)
        files = files[::step][: asked.cells]
        rows = []
        for path in files:
            layout = Layout.of(Instance.of(load(path)))
            best = known[path.stem] * layout.instance.per_second
            rows.append(measured(layout, asked.samples, best))
        line = told({"set": name}, rows)
        if (folder / PUBLISHED).exists():
            line["published"] = published(folder, known, {path.stem for path in files})
        document["rows"].append(line)
    return document


def published(folder: Path, known: dict[str, float], names: set[str]) -> dict[str, float]:
    """Mean gaps in per cent of what others published of the same instances, by their best model."""
    with (folder / PUBLISHED).open() as file:
        rows = [row for row in csv.DictReader(file) if row["instance"] in names]
    gaps: dict[tuple[str, str], dict[str, list[float]]] = {}
    for row in rows:
        gap = float(row["makespan"]) / known[row["instance"]] - 1
        models = gaps.setdefault((row["method"], row["mode"]), {})
        models.setdefault(row["trained_on"], []).append(100 * gap)
    return {
        f"{method} {mode}": round(min(float(np.mean(model)) for model in models.values()), 2)
        for (method, mode), models in gaps.items()
    }


def boards(asked: argparse.Namespace) -> dict[str, Any]:
    """Yu's chessboards, and the desk."""
    from tandem.lab.yu2020.board import desk, random_board
    from tandem.lab.yu2020.optimal import optimum

    rows = []
    for seed in range(asked.cells):
        board = random_board(seed=seed)
        layout = Layout.of(Instance.of(board.to_cell()))
        best = optimum(board, waiting=True).makespan * layout.instance.per_second
        rows.append(measured(layout, asked.samples, best))
    line = told({"set": "boards"}, rows)
    layout = Layout.of(Instance.of(desk().to_cell()))
    found = by_policy(layout, asked.samples)
    names = ("greedy", f"best of {asked.samples}")
    line["desk"] = {name: layout.instance.seconds(int(found[name])) for name in names}
    print(json.dumps(line["desk"]), flush=True)
    return {"samples": asked.samples, "rows": [line]}


def fronts(asked: argparse.Namespace) -> dict[str, Any]:
    """Whole fronts by moving the weight of stress alone."""
    counts: dict[str, list[float]] = {"all points": [], "points": [], "hypervolume": []}
    for seed in range(asked.cells):
        cell = layered(asked.tasks[0], 1, 1, seed=seed)
        exact = plan(cell, workers=1, work=asked.work, settle=False, confirm=False).points
        found = moved(cell, asked.samples, asked.finer)
        met = sum(point in found for point in exact)
        counts["all points"].append(met == len(exact))
        counts["points"].append(met / len(exact))
        counts["hypervolume"].append(hypervolume(found, exact) / max(hypervolume(exact, exact), 1))
    document = {
        "tasks": asked.tasks[0],
        "cells": asked.cells,
        "samples": asked.samples,
        "finer": asked.finer,
        **{name: round(100 * float(np.mean(values)), 1) for name, values in counts.items()},
        "thesis": sorted(moved(load(THESIS), asked.samples, asked.finer)),
    }
    print(json.dumps(document), flush=True)
    return document


def moved(cell: Cell, samples: int, finer: bool) -> set[tuple[float, float]]:
    """What the policy finds, without rules, that nothing else of it beats: so many schedules at
    each weight of stress, and if `finer` at one more between every two of them.
    """
    layout, found = Layout.of(Instance.of(cell)), set[tuple[float, float]]()
    instance, weights = layout.instance, list(weights_of_stress(layout, Question()))
    if finer:
        between = [(one * two) ** 0.5 if one else two / 2 for one, two in pairwise(weights)]
        weights += between
    for state in by_weights(layout, shipped(), weights, samples, 0):
        if state is not None:
            found.add((instance.seconds(state.makespan), instance.stress(state.stress)))
    return {
        one
        for one in found
        if not any(other != one and other[0] <= one[0] and other[1] <= one[1] for other in found)
    }


def hypervolume(points: Any, exact: Sequence[tuple[float, float]]) -> float:
    """The area that the points leave below a tenth more than the exact front's worst values."""
    right = max(time for time, _ in exact) * 1.1
    top = max(stress for _, stress in exact) * 1.1 + 1
    area, above = 0.0, top
    for seconds, stress in sorted(points):
        if seconds < right and stress < above:
            area += (right - seconds) * (above - stress)
            above = stress
    return area


def kept_in(path: Path | None) -> dict[str, Any]:
    """What the file holds by now."""
    found: dict[str, Any] = json.loads(path.read_text()) if path and path.exists() else {}
    return found


PARTS: dict[str, Callable[[argparse.Namespace], dict[str, Any]]] = {
    "cells": cells,
    "public": public,
    "boards": boards,
    "fronts": fronts,
}


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("part", choices=PARTS)
    parser.add_argument("--tasks", type=int, nargs="+", default=[10, 20, 50])
    parser.add_argument("--operators", type=int, default=2)
    parser.add_argument("--rich", action="store_true", help="with joint ways, tools and a zone")
    parser.add_argument("--cells", type=int, default=30, help="of each size or set")
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--work", type=float, default=20.0, help="for the yardstick of a cell")
    parser.add_argument("--data", type=Path, help="folder with a folder for each public set")
    parser.add_argument("--sets", nargs="+", default=SETS)
    parser.add_argument("--finer", action="store_true", help="more weights of stress for fronts")
    parser.add_argument("--key", help="of the file; the part's own name when absent")
    parser.add_argument("-o", "--output", type=Path)
    asked = parser.parse_args()
    if asked.part == "public" and asked.data is None:
        parser.error("public: give --data, the folder of the sets.")
    found = PARTS[asked.part](asked)
    if asked.output is not None:
        kept = kept_in(asked.output) | {
            "benchmark": "graph_policy",
            "tandem": __version__,
            "python": platform.python_version(),
            asked.key or asked.part: found,
        }
        atomic.store(asked.output, json.dumps(kept, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
