"""Do the forecasts of a shift hold? Many simulated shifts beside people whose pace is drawn from
the prior and whose times scatter as the cell says: the share of products that were done by the P50
and by the P90 that was told, at the product's first decision and when half of its tasks were done.

    python benchmarks/forecast_calibration.py [--shifts 500] [--policy replan-robust]
        [--tasks 7] [--cv 0.2] [--seed 0] [-o FILE]
    python benchmarks/forecast_calibration.py --show FILE

`--tasks 7` is the thesis's cell, any other number a random one. A shift has twenty products, so
that 500 shifts are 10,000. Of the first product nothing is known but the prior.
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

LEVELS = ("p50", "p90")
PRODUCTS = {"1": range(1, 2), "2 to 5": range(2, 6), "6 to 20": range(6, 21)}
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


def run(shifts: int, name: str, tasks: int, cv: float, seed: int) -> dict[str, Any]:
    """The shares of products that were done by what was told; the document that is printed."""
    cell, options = cell_of(tasks, cv, seed), Options(budget_ms=60_000.0)
    decider = policy(name, cell, SECONDS, options)
    prior, began, start = dict(options.prior), time.process_time(), Situation.of(cell)
    held: dict[tuple[str, str], list[tuple[bool, bool]]] = {
        (products, moment): [] for products in PRODUCTS for moment in MOMENTS
    }

    spent: list[float] = []

    def told(situation: Situation, decision: Decision) -> dict[str, float]:
        before = time.process_time()
        found = forecast(
            situation,
            decision,
            prior,
            plans=name not in SPECS,
            order=getattr(decider, "order", ()),
        )
        spent.append(1000 * (time.process_time() - before))
        assert found is not None
        return found

    for number in range(shifts):
        rng = np.random.default_rng((seed, number))
        floor, situation = Floor(cell, prior, rng), start
        for products, numbers in PRODUCTS.items():
            for product in numbers:
                if product > 1:
                    situation = begun(replace(situation, queued=(Product(product),)))
                situation, forecasts = made(situation, decider, floor, told)
                for moment, ahead in forecasts.items():
                    p50, p90 = (situation.clock <= ahead[level] + 1e-3 for level in LEVELS)
                    held[products, moment].append((p50, p90))
    return {
        "benchmark": "forecast_calibration",
        "tandem": __version__,
        "python": platform.python_version(),
        "policy": name,
        "tasks": tasks,
        "cv": cv,
        "shifts": shifts,
        "seed": seed,
        "forecast_ms": {
            level: round(float(np.quantile(spent, share)), 1)
            for level, share in (("p50", 0.5), ("p99", 0.99))
        },
        "cpu_s": round(time.process_time() - began, 1),
        "rows": [
            _row(products, moment, held[products, moment])
            for products in PRODUCTS
            for moment in MOMENTS
        ]
        + [
            _row("all", moment, [one for products in PRODUCTS for one in held[products, moment]])
            for moment in MOMENTS
        ],
    }


def _row(products: str, moment: str, held: Sequence[tuple[bool, bool]]) -> dict[str, Any]:
    p50, p90 = (round(100 * float(np.mean(column)), 1) for column in zip(*held, strict=True))
    return {"products": products, "decision": moment, "count": len(held), "p50": p50, "p90": p90}


def table(documents: Sequence[dict[str, Any]]) -> str:
    """The results as the manual shows them."""
    lines = [
        "| policy | tasks | products | decision | how many | by the P50 | by the P90 |",
        "|---|---|---|---|---|---|---|",
    ]
    lines += [
        f"| `{one['policy']}` | {one['tasks']} | {row['products']} | {row['decision']} |"
        f" {row['count']} | {row['p50']:.1f} % | {row['p90']:.1f} % |"
        for one in documents
        for row in one["rows"]
    ]
    lines += [
        f"\n`{one['policy']}`, {one['tasks']} tasks: a forecast takes {one['forecast_ms']['p50']}"
        f" ms of a processor (median), {one['forecast_ms']['p99']} ms in 99 of 100 cases."
        for one in documents
    ]
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--shifts", type=int, default=500)
    parser.add_argument("--policy", default="replan-robust")
    parser.add_argument("--tasks", type=int, default=7)
    parser.add_argument("--cv", type=float, default=0.2)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("-o", "--output", type=Path, help="file of results; added to it")
    parser.add_argument("--show", type=Path, help="print the table of such a file")
    asked = parser.parse_args()
    if asked.show:
        print(table(json.loads(asked.show.read_text())["runs"]))
        return
    document = run(asked.shifts, asked.policy, asked.tasks, asked.cv, asked.seed)
    if asked.output:
        runs = json.loads(asked.output.read_text())["runs"] if asked.output.exists() else []
        asked.output.write_text(json.dumps({"runs": [*runs, document]}, indent=1) + "\n")
    print(table([document]))


if __name__ == "__main__":
    main()
