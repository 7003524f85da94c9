"""Cycle time: the whole front of stations that repeat, Tandem beside a plain CP-SAT model of
periodic scheduling, in one run.

    python benchmarks/cycles.py [--limit 60] [--turns 5] [--seeds 1 2 3] [--workers 2] [-o
    benchmarks/results/cycles.json]

The cells: the thesis's (whole front, `--turns` times), random layered cells of 20 tasks with two
humans and a robot, two zones and three tools that exist once (whole front; once with changeovers
of 2 to 5 s, which the plain model does not know, and once without), and cells of 50 tasks and four
operators (the least cycle time after 10 s, and its gap). The plain model is what a modeller writes
down first: a start, a place in the cycle and a lap for each task, their product with the cycle time
as a multiplication, two copies of each interval; an epsilon-constraint loop walks the front. It is
given one lap more than Tandem found to be enough. Both get the same time and threads.
"""

from __future__ import annotations

import argparse
import json
import statistics
import sys
import time
from pathlib import Path
from random import Random
from typing import Any

from ortools.sat.python import cp_model

from tandem.cell.model import Cell
from tandem.files.generators import layered
from tandem.files.load import load
from tandem.learn.training.runs import versions
from tandem.plan.cycle.methods import plan_cycle
from tandem.plan.instance import Instance

THESIS = Path(__file__).parents[1] / "examples" / "thesis.yaml"
GAP_AFTER = 10.0
"""Seconds for cells of 50 tasks."""


def shared(seed: int, *, changeovers: bool) -> Cell:
    """A layered cell of 20 tasks whose tasks use two zones and three tools, each of which exists
    once; with changeovers, every operator takes 2 to 5 s to take up a tool.
    """
    random, cell = Random(seed), layered(20, 2, 1, seed=seed)
    document = cell.to_dict()
    for task in document["tasks"].values():
        if random.random() < 0.3:
            task["zone"] = random.choice(("bench", "fixture"))
        if random.random() < 0.3:
            task["tool"] = random.choice(("driver", "press", "gauge"))
    if changeovers:
        document["tools"] = {
            name: {"changeover": {who: random.randint(2, 5) for who in document["operators"]}}
            for name in ("driver", "press", "gauge")
        }
    return Cell.model_validate(document)


def plain_front(cell: Cell, laps: int, limit: float, workers: int) -> dict[str, Any]:
    """The front by the plain model; `complete` when it was walked to its end."""
    instance, points, cap = Instance.of(cell), [], None
    until = time.monotonic() + limit
    while True:
        answers = []
        for wanted in ("length", "stress", "makespan"):
            model, values = _plain(instance, laps)
            if cap is not None:
                model.add(values["stress"] <= cap)
            for name, value in zip(("length", "stress"), answers, strict=False):
                model.add(values[name] == value)
            model.minimize(values[wanted])
            solver = cp_model.CpSolver()
            solver.parameters.num_workers = workers
            solver.parameters.max_time_in_seconds = max(0.01, until - time.monotonic())
            status = solver.status_name(solver.solve(model))
            if status == "INFEASIBLE" and not answers:
                return {"points": points, "complete": True}
            if status != "OPTIMAL":
                return {"points": points, "complete": False}
            answers.append(round(solver.objective_value))
        points.append((instance.seconds(answers[0]), instance.stress(answers[1])))
        cap = answers[1] - 1


def _plain(instance: Instance, laps: int) -> tuple[cp_model.CpModel, dict[str, Any]]:
    model, high = cp_model.CpModel(), instance.horizon
    length = model.new_int_var(1, high, "")
    makespan = model.new_int_var(0, laps * high, "")
    lanes: dict[Any, list[Any]] = {}
    starts, ends, stress = [], [], []
    for task, ways in enumerate(instance.ways):
        start, place = model.new_int_var(0, laps * high, ""), model.new_int_var(0, high, "")
        lap, shift = model.new_int_var(0, laps - 1, ""), model.new_int_var(0, laps * high, "")
        model.add_multiplication_equality(shift, [lap, length])
        model.add(start == place + shift)
        model.add(place < length)
        again = model.new_int_var(0, 2 * high, "")
        model.add(again == place + length)
        literals = [model.new_bool_var("") for _ in ways]
        model.add_exactly_one(literals)
        zone = instance.zone[task]
        for way, literal in zip(ways, literals, strict=True):
            used = [("operator", operator) for operator in way.operators]
            used += [("tool", tool) for tool, _ in way.units]
            for key in [*used, *([] if zone is None else [("zone", zone)])]:
                for begin in (place, again):
                    lanes.setdefault(key, []).append(
                        model.new_optional_fixed_size_interval_var(begin, way.ticks, literal, "")
                    )
            stress.append(way.stress * literal)
        ticks = sum(way.ticks * x for way, x in zip(ways, literals, strict=True))
        starts.append(start)
        ends.append(start + ticks)
        model.add(ends[-1] <= makespan)
    for lane in lanes.values():
        model.add_no_overlap(lane)
    for task, firsts in enumerate(instance.before):
        for first in firsts:
            model.add(ends[first] <= starts[task])
    return model, {"length": length, "stress": sum(stress), "makespan": makespan}


def whole_front(name: str, cell: Cell, turns: int, limit: float, workers: int) -> dict[str, Any]:
    """Both on one cell, turn by turn."""
    ours, theirs = [], []
    for _ in range(turns):
        began = time.perf_counter()
        front = plan_cycle(cell, time_limit=limit, workers=workers)
        ours.append(time.perf_counter() - began)
        laps = 1 + max(point.in_process for point in front)
        began = time.perf_counter()
        plain = plain_front(cell, laps, limit, workers)
        theirs.append(time.perf_counter() - began)
    settled = sum(point.in_process == point.bound.in_process for point in front)
    row = {
        "cell": name,
        "points": len(front),
        "complete": front.complete,
        "fewest_in_process_proven": settled,
        "seconds": round(statistics.median(ours), 3),
        "plain_points": len(plain["points"]),
        "plain_complete": plain["complete"],
        "plain_seconds": round(statistics.median(theirs), 3),
        "ratio": round(statistics.median(a / b for a, b in zip(ours, theirs, strict=True)), 3),
    }
    if plain["complete"] and front.complete:
        row["same"] = plain["points"] == front.points
    print(json.dumps(row), flush=True)
    return row


def ours_alone(name: str, cell: Cell, limit: float, workers: int) -> dict[str, Any]:
    """The whole front where the plain model lacks a rule."""
    front = plan_cycle(cell, time_limit=limit, workers=workers)
    row = {
        "cell": name,
        "points": len(front),
        "complete": front.complete,
        "fewest_in_process_proven": sum(p.in_process == p.bound.in_process for p in front),
        "seconds": round(front.wall_s, 3),
    }
    print(json.dumps(row), flush=True)
    return row


def gap_of(seed: int, workers: int) -> dict[str, Any]:
    """How far the least cycle time found for 50 tasks is above the bound."""
    cell = layered(50, 2, 2, seed=seed)
    front = plan_cycle(cell, minimize="cycle_time", time_limit=GAP_AFTER, workers=workers)
    whole = plan_cycle(cell, time_limit=GAP_AFTER, workers=workers)
    row = {
        "cell": f"50 tasks, 4 operators, seed {seed}",
        "cycle_time": front[0].cycle_time,
        "gap": round(front[0].gap, 4),
        "seconds": round(front.wall_s, 2),
        "points_of_front": len(whole),
        "front_complete": whole.complete,
        "worst_gap_of_front": round(max(point.gap for point in whole), 4),
        "front_seconds": round(whole.wall_s, 2),
    }
    print(json.dumps(row), flush=True)
    return row


def main() -> int:
    """Prints and keeps the rows."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    parser.add_argument("--limit", type=float, default=60.0, help="seconds for a front")
    parser.add_argument("--turns", type=int, default=5)
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3])
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("-o", "--output", type=Path)
    asked = parser.parse_args()
    rows = [whole_front("thesis", load(THESIS), asked.turns, asked.limit, asked.workers)]
    for seed in asked.seeds:
        name = f"20 tasks, 3 operators, zones and tools, seed {seed}"
        cell = shared(seed, changeovers=False)
        rows.append(whole_front(name, cell, 1, asked.limit, asked.workers))
        cell = shared(seed, changeovers=True)
        rows.append(ours_alone(f"{name}, with changeovers", cell, asked.limit, asked.workers))
    rows += [gap_of(seed, asked.workers) for seed in asked.seeds]
    kept = {"benchmark": "cycles", **vars(asked), "versions": versions(), "rows": rows}
    kept.pop("output")
    if asked.output:
        asked.output.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
