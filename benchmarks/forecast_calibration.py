"""Do the forecasts of a shift hold? Many simulated shifts beside people whose pace is drawn from
the prior and whose times scatter as the cell says: the share of products that were done by the P50
and by the P90 that was told, at the product's first decision and when half of its tasks were done.

    python benchmarks/forecast_calibration.py [--shifts 10000] [--policy longest-tail]
        [--tasks 7] [--cv 0.2] [--seed 0] [-o FILE]
    python benchmarks/forecast_calibration.py --show FILE

`--tasks 7` is the thesis's cell, any other number a random one. A shift has the products that
`--products` names, up to the last of them; those in between are made too, and not measured.
"""

from __future__ import annotations

import argparse
import json
import math
import platform
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from tandem import __version__, load
from tandem.cell.model import Cell
from tandem.dispatch.deciders.policy import Decision, Options, Policy
from tandem.dispatch.deciders.table import policy
from tandem.dispatch.lookahead.objective import SECONDS
from tandem.dispatch.shift.forecast import forecast
from tandem.dispatch.situation.events import Event
from tandem.dispatch.situation.legal import next_change
from tandem.dispatch.situation.model import Product, Running, Situation, exact
from tandem.dispatch.situation.transitions import after, begun, ordered
from tandem.files.generators import layered
from tandem.plan.rules import SPECS

LEVELS = {"p50": 50.0, "p90": 90.0}
MOMENTS = ("first", "half")


def cell_of(tasks: int, cv: float, seed: int) -> Cell:
    """The thesis's cell, or a random one of so many tasks; its times scatter by `cv`."""
    cell = load("examples/thesis.yaml") if tasks == 7 else layered(tasks, seed=seed)
    return cell.replace(
        tasks={name: task.model_copy(update={"spread": cv}) for name, task in cell.tasks.items()}
    )


class Floor:
    """People who do as they are asked, each at a pace of their own; robots; times that scatter."""

    def __init__(self, cell: Cell, prior: dict[float, float], rng: np.random.Generator) -> None:
        self.cell, self.rng = cell, rng
        shares = np.array(list(prior.values()))
        self.pace = {
            who: float(rng.choice(list(prior), p=shares / shares.sum())) for who in cell.humans
        }

    def takes(self, task: str, at: Running) -> float:
        """Seconds that the task really takes, drawn when it begins."""
        spread = self.cell.tasks[task].spread
        assert not isinstance(spread, dict)
        sigma = math.sqrt(math.log1p(float(spread) ** 2))  # type: ignore[arg-type]
        slowest = max(self.pace.get(who, 1.0) for who in at.operators)
        factor = math.exp(sigma * self.rng.standard_normal() - sigma**2 / 2)
        return exact(at.stated * slowest * factor)


def made(
    situation: Situation, decider: Policy, floor: Floor, told: Any
) -> tuple[Situation, dict[str, dict[str, float]]]:
    """One product from its beginning to its end; and what was forecast of it, by moment. `told`
    makes the forecast; None makes none.
    """
    ends: dict[str, float] = {}
    forecasts: dict[str, dict[str, float]] = {}
    while True:
        decision = decider.decide(situation)
        if told is not None and "first" not in forecasts:
            forecasts["first"] = told(situation, decision)
        if told is not None and "half" not in forecasts and _is_half(situation):
            forecasts["half"] = told(situation, decision)
        situation = _begins(ordered(situation, decision, 0), decision)
        for task, at in situation.running.items():
            if task not in ends:
                ends[task] = exact(situation.now + floor.takes(task, at))
        looks = (decision.look_again, next_change(situation))
        ahead = [time for time in looks if time is not None and time > situation.now]
        until = min([*(ends[task] for task in situation.running), *ahead])
        events = [Event("tick", situation.on_clock(until))] + [
            Event("done", situation.on_clock(until), task)
            for task in situation.running
            if ends[task] <= until
        ]
        for event in events:
            situation = after(situation, event)
        if situation.is_over:
            return situation, forecasts


def _is_half(situation: Situation) -> bool:
    return 2 * len(situation.done) >= len(situation.cell.tasks)


def _begins(situation: Situation, decision: Decision) -> Situation:
    for task, operators in dict.fromkeys((*decision.asks, *decision.starts)):
        situation = after(situation, Event("started", situation.clock, task, operators))
    return situation


def run(
    shifts: int, name: str, tasks: int, cv: float, seed: int, products: Sequence[int]
) -> dict[str, Any]:
    """The shares of products that were done by what was told; the document that is printed."""
    cell, options = cell_of(tasks, cv, seed), Options(budget_ms=60_000.0)
    decider = policy(name, cell, SECONDS, options)
    prior, began = dict(options.prior), time.perf_counter()
    held: dict[tuple[int, str, str], list[bool]] = {
        (product, moment, level): []
        for product in products
        for moment in MOMENTS
        for level in LEVELS
    }
    gaps: list[float] = []

    def told(situation: Situation, decision: Decision) -> dict[str, float]:
        found = forecast(
            situation,
            decision,
            prior,
            plans=name not in SPECS,
            order=getattr(decider, "order", ()),
        )
        assert found is not None
        return found

    start = Situation.of(cell)
    for number in range(shifts):
        rng = np.random.default_rng((seed, number))
        floor, situation = Floor(cell, prior, rng), start
        for product in range(1, max(products) + 1):
            if product > 1:
                situation = begun(replace(situation, queued=(Product(product),)))
            measured = told if product in products else None
            situation, forecasts = made(situation, decider, floor, measured)
            for moment, ahead in forecasts.items():
                for level in LEVELS:
                    held[product, moment, level].append(situation.clock <= ahead[level] + 1e-3)
                if product == max(products) and moment == "first":
                    gaps.append((ahead["p50"] - situation.began) / situation.now)
    return {
        "benchmark": "forecast_calibration",
        "tandem": __version__,
        "python": platform.python_version(),
        "policy": name,
        "cell": cell.name,
        "tasks": tasks,
        "cv": cv,
        "shifts": shifts,
        "seed": seed,
        "wall_s": round(time.perf_counter() - began, 1),
        "p50_over_the_end_mean": round(float(np.mean(gaps)), 3),
        "rows": [
            {
                "product": product,
                "decision": moment,
                "products": len(held[product, moment, "p50"]),
                **{
                    level: round(100 * float(np.mean(held[product, moment, level])), 1)
                    for level in LEVELS
                },
            }
            for product in products
            for moment in MOMENTS
        ],
    }


def table(documents: Sequence[dict[str, Any]]) -> str:
    """The results as the manual shows them."""
    lines = [
        "| policy | tasks | product | decision | products | by the P50 | by the P90 |",
        "|---|---|---|---|---|---|---|",
    ]
    lines += [
        f"| `{one['policy']}` | {one['tasks']} | {row['product']} | {row['decision']} |"
        f" {row['products']} | {row['p50']:.1f} % | {row['p90']:.1f} % |"
        for one in documents
        for row in one["rows"]
    ]
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--shifts", type=int, default=10_000)
    parser.add_argument("--policy", default="longest-tail")
    parser.add_argument("--tasks", type=int, default=7)
    parser.add_argument("--cv", type=float, default=0.2)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--products", default="1,5,20", help="which are measured")
    parser.add_argument("-o", "--output", type=Path, help="file of results; added to it")
    parser.add_argument("--show", type=Path, help="print the table of such a file")
    asked = parser.parse_args()
    if asked.show:
        print(table(json.loads(asked.show.read_text())["runs"]))
        return
    products = [int(part) for part in asked.products.split(",")]
    document = run(asked.shifts, asked.policy, asked.tasks, asked.cv, asked.seed, products)
    if asked.output:
        runs = json.loads(asked.output.read_text())["runs"] if asked.output.exists() else []
        asked.output.write_text(json.dumps({"runs": [*runs, document]}, indent=1) + "\n")
    print(table([document]))
    print(document["p50_over_the_end_mean"], document["wall_s"])


if __name__ == "__main__":
    main()
