"""How near to the exact optimum does `tandem train` come on every example cell, and does what it
learned run a shift?

    python benchmarks/learned_cells.py [CELL ...] [--seeds 5] [--factors 0 5]
        [-o benchmarks/results/learned_cells.json]
    python benchmarks/learned_cells.py --show benchmarks/results/learned_cells.json

The default recipe, unchanged, all seeds of a cell side by side. Each learned number stands beside
the exact one: the least weighted cost (10 for a second, the factor for a unit of stress) on the
front of the planner, or the least found where the front is not complete (marked with *). Gaps are
shares of that cost; their intervals are Student's over the seeds. The random player's means are
over the assemblies that it finishes. The run then goes, as it is, to `tandem dispatch --policy
learned --simulate pace:1.5`. A factor says nothing where no stress is stated.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from tandem.cli.compiled import keep_compiled
from tandem.files.atomic import store
from tandem.files.load import load
from tandem.learn.baseline import best_rule
from tandem.learn.results import cost, paid
from tandem.learn.training.evaluate import Line, evaluate
from tandem.learn.training.runs import versions
from tandem.learn.training.trainer import train

ROOT = Path(__file__).resolve().parents[1]
PLAYED = 100
"""Episodes of the random player."""
STUDENT = {2: 12.71, 3: 4.30, 4: 3.18, 5: 2.78, 6: 2.57, 7: 2.45, 8: 2.36, 9: 2.31, 10: 2.26}
"""Seeds -> half of a 95 % interval of their mean, in standard errors."""


def row_of(path: Path, factor: float, seeds: int) -> dict[str, Any]:
    """One cell at one factor: exact, learned, by rule, at random, and dispatched."""
    cell, began = load(path), time.process_time()
    with tempfile.TemporaryDirectory() as scratch:
        run = Path(scratch) / "run"
        document = train(cell, stress_factor=factor, seeds=range(seeds), folder=run)
        cpu_s = time.process_time() - began
        found = evaluate(run, episodes=PLAYED)
        shift = dispatched(path, run)
    front = document["exact_front"]
    rule = next(line for line in found.lines if line.player.startswith("rule "))
    return {
        "cell": path.stem,
        "factor": factor,
        "exact": min(front, key=lambda point: 10 * point[0] + factor * point[1]),
        "proven": document["exact_front_complete"],
        "seeds": [
            {name: row[name] for name in ("seed", "greedy", "best_of_n")}
            for row in document["seeds"]
        ],
        "rule": told(rule),
        "random": told(found.line("random")),
        "dispatched": shift,
        "cpu_s": round(cpu_s, 1),
    }


def told(line: Line) -> dict[str, Any]:
    return {
        "player": line.player,
        "finished": line.done,
        "makespan": line.makespan,
        "stress": line.stress,
        "gap": line.gap,
    }


def dispatched(path: Path, run: Path) -> dict[str, Any]:
    """How the shift ended that the run's policy steered beside people who need 1.5 times the stated
    times.
    """
    asked = [
        "dispatch",
        str(path),
        "--policy",
        "learned",
        "--learned",
        str(run),
        "--simulate",
        "pace:1.5",
        "--json",
    ]
    ended = subprocess.run(
        [sys.executable, "-m", "tandem", *asked], capture_output=True, text=True, check=False
    )
    if ended.returncode:
        return {"code": ended.returncode, "said": ended.stderr.strip().splitlines()[-1]}
    summary = json.loads(ended.stdout.splitlines()[-1])
    return {"code": 0, **{name: summary[name] for name in ("makespan", "over", "failed", "late")}}


def table(document: dict[str, Any]) -> str:
    """The rows as the manual has them."""
    seeds = len(document["rows"][0]["seeds"])
    heads = [
        "cell",
        "factor",
        "exact",
        f"greedy, {seeds} seeds",
        "gap",
        "best of 64",
        "best rule",
        "random player",
        "dispatched, pace 1.5",
    ]
    lines = [f"| {' | '.join(heads)} |", "|---" * len(heads) + "|"]
    lines += [f"| {' | '.join(_columns(row))} |" for row in document["rows"]]
    return "\n".join(lines)


def _columns(row: dict[str, Any]) -> list[str]:
    greedy, best = ([seed[name] for seed in row["seeds"]] for name in ("greedy", "best_of_n"))
    times = [played["makespan"] for played in greedy]
    shift, rule, random = row["dispatched"], rule_of(row), row["random"]
    return [
        row["cell"],
        f"{row['factor']:g}",
        f"{row['exact'][0]:g} s / {row['exact'][1]:g}{'' if row['proven'] else ' *'}",
        (
            f"{np.mean(times):.4g} s [{min(times):g} to {max(times):g}] /"
            f" {np.mean([played['stress'] for played in greedy]):.3g}"
        ),
        _share([played["gap"] for played in greedy])
        + more_stress(row, float(np.mean([played["stress"] for played in greedy]))),
        _share([played["gap"] for played in best]),
        f"{_pair(rule)} ({rule['player'].removeprefix('rule ')}), {100 * rule['gap']:.1f} %"
        + more_stress(row, rule["stress"]),
        f"{_pair(random)}, {100 * random['gap']:.1f} %"
        + ("" if random["finished"] == 1 else f" ({100 * random['finished']:.0f} % finish)"),
        f"{shift['makespan']:g} s" if shift["code"] == 0 else f"refused ({shift['code']})",
    ]


def rule_of(row: dict[str, Any]) -> dict[str, Any]:
    """The best rule, worked out anew in less than a second: what was stored earlier left out the
    strongest one, `best-of-n`.
    """
    pays = partial(cost, **paid(row["factor"]))
    best = best_rule(load(ROOT / "examples" / f"{row['cell']}.yaml"), pays)
    if best is None:
        found: dict[str, Any] = row["rule"]
        return found
    makespan, stress = best.result.makespan, best.result.stress
    gap = pays(makespan, stress) / pays(*row["exact"]) - 1
    return {"player": f"rule {best.name}", "makespan": makespan, "stress": stress, "gap": gap}


def more_stress(row: dict[str, Any], stress: float) -> str:
    """Where stress costs nothing, how much more of it there is than in the exact plan: what is as
    quick as can be need not be as good.
    """
    more = stress - row["exact"][1]
    return f", stress +{more:.3g}" if row["factor"] == 0 and more > 0 else ""


def _pair(line: dict[str, Any]) -> str:
    return f"{line['makespan']:.4g} s / {line['stress']:.3g}"


def _share(gaps: list[float]) -> str:
    """The mean gap, with half its 95 % interval where the seeds differ."""
    mean, spread = (
        100 * float(np.mean(gaps)),
        100 * float(np.std(gaps, ddof=1)) if len(gaps) > 1 else 0.0,
    )
    if not spread:
        return f"{mean:.1f} %"
    return f"{mean:.1f} ± {STUDENT[len(gaps)] * spread / len(gaps) ** 0.5:.1f} %"


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("cells", nargs="*", type=Path, help="cell files; all examples when absent")
    parser.add_argument("--seeds", type=int, default=5, choices=[1, *STUDENT])
    parser.add_argument("--factors", type=float, nargs="+", default=[0.0, 5.0])
    parser.add_argument(
        "-o", "--output", type=Path, help="store the document here, after every row"
    )
    parser.add_argument(
        "--show", type=Path, help="print the table of a stored document, and train nothing"
    )
    asked = parser.parse_args()
    if asked.show:
        print(table(json.loads(asked.show.read_text("utf-8"))))
        return
    keep_compiled()
    document: dict[str, Any] = {
        "benchmark": "learned_cells",
        "versions": versions(),
        "recipe": "tandem",
        "rows": [],
    }
    for path in asked.cells or sorted((ROOT / "examples").glob("*.yaml")):
        stressed = (
            any(
                sum(mode.stress.values())
                for task in load(path).tasks
                for mode in load(path).modes(task)
            )
            or load(path).stress_of_set
        )
        for factor in asked.factors if stressed else asked.factors[:1]:
            print(f"{path.stem}, factor {factor:g}", file=sys.stderr, flush=True)
            document["rows"].append(row_of(path, factor, asked.seeds))
            if asked.output:
                store(asked.output, json.dumps(document, indent=1) + "\n")
    print(table(document))
    print(f"{sum(row['cpu_s'] for row in document['rows']):.0f} CPU seconds of training")


if __name__ == "__main__":
    main()
