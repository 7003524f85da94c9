"""Trains the policy for any cell that Tandem ships: imitation of decisions on nearly optimal ways,
then of those in states that the policy itself comes to. A run that is stopped goes on in its
folder, to the bit, whatever the number of processes that look up labels.

    python benchmarks/graph_training.py FOLDER [-o FILE] [--seed 0] [--workers 1]
    python benchmarks/graph_training.py FOLDER --ablations [--seeds 5] [-o FILE]

`-o FILE` writes the weights; those that are shipped are
`src/tandem/learn/graph/weights.npz`. A line a round is printed, as JSON.

With `--ablations` small policies are trained, each with something left out, and `-o FILE` gets how
far above good schedules theirs are: of twenty cells of 20 tasks (seeds from 500,000 on, neither
trained nor tested on), of which a search by insertion says what is good; mean in per cent over the
seeds of the training and its 95 % interval.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import sys
import time
from collections.abc import Iterator
from dataclasses import asdict, replace
from pathlib import Path
from statistics import mean, stdev
from typing import Any

# one thread: sums in the same order, whatever the machine
os.environ.setdefault(
    "XLA_FLAGS", "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
)

import numpy as np

from tandem.files import atomic
from tandem.files.generators import layered
from tandem.learn.graph.candidates import GROUPS, columns
from tandem.learn.graph.labels import Looks, layout_of, searched
from tandem.learn.graph.making import Maker
from tandem.learn.graph.network import Weights
from tandem.learn.graph.outlook import Outlook
from tandem.learn.graph.training import Config, Told, train
from tandem.learn.graph.weights import write_weights
from tandem.plan.list_scheduling import Layout

SMALL = Config(
    first=120, first_large=60, most_tasks=24, first_steps=600, rounds=1, drawn=60, drawn_large=40,
    steps=800,
)  # fmt: skip
"""What all ablations have in common."""
TUNED, CELLS, SAMPLES, VISITS = 500_000, 20, 16, 500_000
STUDENT = {2: 12.71, 3: 4.30, 4: 3.18, 5: 2.78}
"""Half a 95 % interval of a mean of so many, in standard errors."""


def ablations() -> Iterator[tuple[str, Config]]:
    """What is left out, and how the policy is trained then."""
    yield "nothing", SMALL
    cells = {
        "first": SMALL.first + SMALL.drawn,
        "first_large": SMALL.first_large + SMALL.drawn_large,
    }
    steps = SMALL.first_steps + SMALL.steps
    yield "its own states (imitation only)", replace(SMALL, **cells, first_steps=steps, rounds=0)
    yield "losses (one right choice)", replace(SMALL, sharp=-1.0)
    yield "search (self-labelling only)", replace(SMALL, looks=Looks(own=32))
    for name, values in GROUPS.items():
        yield f"features: {name}", replace(SMALL, blind=columns(values))


def tuned() -> list[tuple[Layout, int]]:
    """Cells, and ticks of a good schedule of each."""
    found = []
    for seed in range(TUNED, TUNED + CELLS):
        layout = layout_of(layered(20, seed=seed))
        ways, starts = layout.instance.ways, searched(layout, 0.0, VISITS, seed)
        ends = (begin + ways[task][way].ticks for task, (way, begin) in enumerate(starts))
        found.append((layout, max(ends)))
    return found


def gaps(weights: Weights, cells: list[tuple[Layout, int]]) -> tuple[float, float]:
    """Per cent above the good schedules: greedy, and the best of `SAMPLES`."""
    greedy, best = list[float](), list[float]()
    for layout, good in cells:
        maker, random = Maker.of(weights, Outlook.of(layout, 0.0)), np.random.default_rng(0)
        made = [maker.build(random if sample else None) for sample in range(SAMPLES)]
        ends = [state.makespan for state in made if state is not None]
        greedy.append(100 * (ends[0] / good - 1))
        best.append(100 * (min(ends) / good - 1))
    return mean(greedy), mean(best)


def judged(folder: Path, seeds: int) -> Iterator[dict[str, Any]]:
    """A row for each ablation."""
    cells = tuned()
    for at, (name, config) in enumerate(ablations()):
        found = []
        for seed in range(1, seeds + 1):
            run = folder / f"{at}-{seed}"
            weights = train(replace(config, seed=seed), run, lambda told: None)
            found.append(gaps(weights, cells))
        row: dict[str, Any] = {"without": name, "seeds": seeds}
        for kind, values in zip(
            ("greedy", f"best of {SAMPLES}"), zip(*found, strict=True), strict=True
        ):
            half = STUDENT[seeds] * stdev(values) / seeds**0.5
            row[kind] = {"gap": round(mean(values), 2), "half": round(half, 2)}
        print(json.dumps(row), flush=True)
        yield row


def say(told: Told) -> None:
    """A line for the round. Processes that look up labels count, for they have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = time.process_time() + used.ru_utime + used.ru_stime
    print(json.dumps({**asdict(told), "cpu_s": round(spent, 1)}), flush=True)


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, help="where the run is kept")
    parser.add_argument("-o", "--output", type=Path, help="file for the weights, or the results")
    parser.add_argument("--seed", type=int, default=Config().seed)
    parser.add_argument("--workers", type=int, default=1, help="processes that look up labels")
    parser.add_argument("--ablations", action="store_true", help="train with things left out")
    parser.add_argument("--seeds", type=int, default=5, choices=STUDENT, help="of each ablation")
    asked = parser.parse_args()
    if asked.ablations:
        rows = list(judged(asked.folder, asked.seeds))
        if asked.output is not None:
            document = {"benchmark": "graph_ablations", "rows": rows}
            atomic.store(asked.output, json.dumps(document, indent=1) + "\n")
        return 0
    weights = train(Config(seed=asked.seed), asked.folder, say, asked.workers)
    if asked.output is not None:
        write_weights(asked.output, weights)
    return 0


if __name__ == "__main__":
    sys.exit(main())
