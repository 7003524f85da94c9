"""A human whose pace nobody has told: how much longer than the optimum that knows it, for plain
re-planning and for the decider that learns.

    python benchmarks/pace.py [--cells 10] [--tasks 9] [-o benchmarks/results/pace.csv]
    python benchmarks/pace.py --show benchmarks/results/pace.csv

The thesis's cell and random layered cells (seeds 0, 1, ...), times certain, the human compliant and
so many times as slow as stated. On the thesis's cell also the exact Bayes-adaptive value: the best
that any decider with this prior can reach on average, if it acts at events only, and if it may look
in between. The peers run in the same table: `replan` (CP-SAT, stated times, the first plan found)
and `fixed`.
"""

from __future__ import annotations

import argparse
import csv
import json
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from random import Random

from tandem.cell.model import Cell
from tandem.dispatch.deciders.policy import Options
from tandem.dispatch.evaluation.trial import judge
from tandem.dispatch.lookahead.bayes_adaptive import bayes_adaptive, belief_values
from tandem.dispatch.lookahead.dynamic_programming import expected
from tandem.files.generators import layered
from tandem.files.load import load
from tandem.learn.training.runs import versions

ROOT = Path(__file__).resolve().parents[1]
TOLD = (0.6, 1.5, 2.0, 3.0)
"""The paces that count."""
BETWEEN = (0.7, 1.25, 2.5)
"""Paces that the prior does not hold."""
PRIOR = dict(Options().prior)
"""The deciders' own."""
POLICIES = ("replan", "replan-robust", "fixed")
COLUMNS = (
    "cell",
    "digest",
    "tasks",
    "pace",
    "in_prior",
    "policy",
    "makespan",
    "optimum",
    "loss",
    "p50_ms",
    "p99_ms",
)


def rows_of(
    name: str, cell: Cell, budget_ms: float, prior: dict[float, float]
) -> Iterator[tuple[object, ...]]:
    """One row per pace and policy."""
    paces = tuple(sorted({*prior, *TOLD, *BETWEEN}))
    documents = judge(
        cell,
        POLICIES,
        tuple(f"pace:{pace:g}" for pace in paces),
        2,
        0,
        options=Options(prior=prior, budget_ms=budget_ms),
    )
    for pace, document in zip(paces, documents, strict=True):
        for row in document["policies"]:
            loss = row["makespan"]["mean"] / document["optimum"] - 1
            latency = row["latency_ms"]
            yield (
                name, cell.digest, len(cell.tasks), pace, int(pace in prior), row["policy"],
                row["makespan"]["mean"], document["optimum"],
                round(loss, 5), latency["p50"], latency["p99"],
            )  # fmt: skip


def bayes(cell: Cell, prior: dict[float, float]) -> dict[str, float]:
    """Mean makespans under the prior: knowing the pace, and the exact best without being told
    it.
    """
    return {
        "knowing the pace": sum(
            share * expected(cell, pace=dict.fromkeys(cell.humans, pace))
            for pace, share in prior.items()
        ),
        "Bayes-adaptive, acting at events": bayes_adaptive(cell, prior),
        "Bayes-adaptive, looking in between": bayes_adaptive(cell, prior, watches=True),
    }


def exact_losses(cell: Cell, prior: dict[float, float]) -> list[float]:
    """Per pace of the prior, in its order, what the exact Bayes-adaptive policy (looking in
    between) loses against who knows the pace; shares.
    """
    found = belief_values(cell, prior, watches=True)
    found.value(found.root())
    return [
        round(found.played(number) / values.value(values.moves.root()) - 1, 4)
        for number, values in enumerate(found.under)
    ]


def over_priors(cell: Cell, count: int) -> list[list[float]]:
    """The different losses at `TOLD` of the exact Bayes-adaptive policies for so many random priors
    on these paces (Gamma(0.4) weights, seed 0).
    """
    draws = Random(0)
    drawn = ({pace: draws.gammavariate(0.4, 1.0) + 1e-6 for pace in TOLD} for _ in range(count))
    return sorted({tuple(exact_losses(cell, prior)) for prior in drawn}, key=max)


def show(rows: list[dict[str, str]]) -> None:
    """The tables."""
    for title, mine in (
        ("thesis", [row for row in rows if row["cell"] == "thesis"]),
        ("random", [row for row in rows if row["cell"] != "thesis"]),
    ):
        if not mine:
            continue
        cells = len({row["cell"] for row in mine})
        print(
            f"\n{title}: {cells} cell{'s' * (cells != 1)}, loss against the optimum that knows the"
            " pace, mean (worst)"
        )
        paces = sorted({float(row["pace"]) for row in mine})
        print(
            f"{'policy':<16}"
            + "".join(f"{pace:>16g}" for pace in paces)
            + f"{'mean over ' + ', '.join(f'{p:g}' for p in TOLD):>28}"
        )
        for policy in POLICIES:
            losses = {
                pace: [
                    float(row["loss"])
                    for row in mine
                    if row["policy"] == policy and float(row["pace"]) == pace
                ]
                for pace in paces
            }
            told = [loss for pace in TOLD for loss in losses[pace]]
            cellwise = "".join(
                f"{f'{sum(one) / len(one):.1%} ({max(one):.1%})':>16}" for one in losses.values()
            )
            print(f"{policy:<16}{cellwise}{sum(told) / len(told):>28.2%}")


def _prior(text: str) -> dict[float, float]:
    pairs = [part.split(":") for part in text.split(",")]
    total = sum(float(weight) for _, weight in pairs)
    return {float(pace): float(weight) / total for pace, weight in pairs}


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--cells", type=int, default=10)
    parser.add_argument("--first", type=int, default=0, help="seed of the first random cell")
    parser.add_argument("--tasks", type=int, default=9)
    parser.add_argument("--budget", type=float, default=50.0, help="milliseconds per decision")
    parser.add_argument(
        "--prior",
        type=_prior,
        default=PRIOR,
        help="factors with weights, such as 0.6:1,1:1,2:1; the deciders' own when absent",
    )
    parser.add_argument(
        "--exact",
        action="store_true",
        help="also what the exact Bayes-adaptive policy loses on each random cell",
    )
    parser.add_argument("-o", "--output", type=Path)
    parser.add_argument("--show", type=Path, help="only print the tables of an earlier run")
    options = parser.parse_args()
    if options.show:
        with open(options.show, newline="", encoding="utf-8") as file:
            show(list(csv.DictReader(file)))
        print(
            json.dumps(
                json.loads(options.show.with_suffix(".json").read_text(encoding="utf-8"))["thesis"],
                indent=1,
            )
        )
        return 0
    thesis = load(ROOT / "examples" / "thesis.yaml")
    began, rows = time.perf_counter(), []
    for name, cell in [
        ("thesis", thesis),
        *(
            (f"layered-{seed}", layered(options.tasks, seed=seed))
            for seed in range(options.first, options.first + options.cells)
        ),
    ]:
        rows += rows_of(name, cell, options.budget, options.prior)
        print(f"{name}: {time.perf_counter() - began:.0f} s", file=sys.stderr, flush=True)
    values = bayes(thesis, options.prior)
    played = {
        policy: sum(
            options.prior[row[3]] * row[6]
            for row in rows
            if row[0] == "thesis" and row[5] == policy and row[4]
        )
        for policy in POLICIES
    }
    played = {policy: round(mean, 4) for policy, mean in played.items()}
    found = {
        "prior": options.prior,
        "exact": values,
        "played": played,
        "above_bayes_adaptive": (
            played["replan-robust"] / values["Bayes-adaptive, looking in between"] - 1
        ),
        "losses_over_100_priors": over_priors(thesis, 100),
    }
    if options.exact:
        losses = [
            exact_losses(layered(options.tasks, seed=seed), options.prior)
            for seed in range(options.first, options.first + options.cells)
        ]
        means = [round(sum(column) / len(losses), 4) for column in zip(*losses, strict=True)]
        found["bayes_adaptive_losses_on_random_cells"] = dict(
            zip(options.prior, means, strict=True)
        )
    as_text = [dict(zip(COLUMNS, map(str, row), strict=True)) for row in rows]
    show(as_text)
    print(json.dumps(found, indent=1))
    if options.output:
        with open(options.output, "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerows([COLUMNS, *rows])
        document = {
            "thesis": found,
            "cells": options.cells,
            "first_seed": options.first,
            "tasks": options.tasks,
            "budget_ms": options.budget,
            "versions": versions(),
        }
        options.output.with_suffix(".json").write_text(
            json.dumps(document, indent=1) + "\n", encoding="utf-8"
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())
