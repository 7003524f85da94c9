"""Limits of people in random cells: random shifts and exact plans that must never exceed one by a
formula read from plain data, and what keeping them costs in makespan.

A limit is fair when it knows nothing of the plan. Here it is what a person comes to in so many per
cent of random shifts without limits: at 90, the busier of the two people would exceed it in one
unlimited shift of ten. Then as many shifts are played by the same rules with the limit in the cell
file, with the same chance, and the whole front is planned with and without it.
"""

from __future__ import annotations

import argparse
import json
import statistics
import sys
import time
from collections import Counter, defaultdict
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

import numpy as np

from tandem.cell.model import Cell
from tandem.errors import InfeasibleError
from tandem.files.validate import cell_of
from tandem.plan.methods import METHODS
from tandem.plan.question import Question
from tandem.world import state as world
from tandem.world.arrays import NEVER, Arrays, Names

CYCLES = 420
KINDS = ("peak:reba", "time-above:reba:7", "dose:shoulder_tool", "stress")
SHARES = (50, 75, 90, 95, 99)
"""Per cent of unlimited random shifts that keep the limit."""
PEOPLE = ("anna", "ben")
Array = Any


def drawn(random: Random, tasks: int) -> dict[str, Any]:
    """A cell of so many tasks, two people and a robot that can do four of them; all are assessed.
    Cells of one size have arrays of one shape.
    """
    rows: dict[str, Any] = {}
    of_robot = random.sample(range(tasks), 4)
    for place in range(tasks):
        row: dict[str, Any] = {
            "time": {who: random.randint(3, 12) for who in PEOPLE},
            "stress": random.randint(0, 8),
            "ergonomics": [
                {"method": "reba", "score": random.randint(1, 12)},
                {"method": "shoulder_tool", "score": random.randint(1, 40) / 1e6},
            ],
        }
        if place in of_robot:
            row["time"]["robot"] = random.randint(5, 18)
        if place and random.random() < 0.5:
            row["after"] = [f"t{random.randrange(place)}"]
        rows[f"t{place}"] = row
    operators = {"robot": {"kind": "robot"}, **{who: {"kind": "human"} for who in PEOPLE}}
    return {"operators": operators, "tasks": rows, "cycles_per_shift": CYCLES}


def limited(data: dict[str, Any], kind: str, units: int) -> dict[str, Any]:
    """The cell in which each person may have so much; in the units of `taken`."""
    most = units * CYCLES / 1_000_000 if kind.startswith("dose") else units
    stated = {"stress_limit": most} if kind == "stress" else {"limits": {kind: round(most, 6)}}
    people = {who: {"kind": "human", **stated} for who in PEOPLE}
    return {**data, "operators": {**data["operators"], **people}}


def taken(task: dict[str, Any], who: str, kind: str) -> int:
    """What the task alone puts on the person, whole units: millionths of a dose."""
    reba, shoulder = (one["score"] for one in task["ergonomics"])
    if kind == "peak:reba":
        return int(reba)
    if kind == "stress":
        return int(task["stress"])
    if kind.startswith("dose"):
        return round(shoulder * 1_000_000)
    return int(task["time"][who]) * (reba >= 7)


def worst(data: dict[str, Any], doers: list[list[str]], kind: str) -> Array:
    """`[N]`, what the busier of the two people comes to in each of `N` schedules.

    Args:
      doers: per schedule, who does each task, in the cell's order.
    """
    rows = list(data["tasks"].values())
    per = {who: np.array([taken(row, who, kind) for row in rows], np.int64) for who in PEOPLE}
    who_did = np.array(doers)
    most = np.zeros(len(doers), np.int64)
    for who, cost in per.items():
        costs = np.where(who_did == who, cost[None, :], 0)
        has = costs.max(axis=1) if kind == "peak:reba" else costs.sum(axis=1)
        most = np.maximum(most, has)
    return most


@cache
def player(tasks: int) -> Any:
    """`(arrays, keys) -> (way [N, T], makespan [N], done [N])`: shifts in which everybody begins
    something legal at random, or waits, and takes as long as chance will have it.
    """
    import jax

    def step(arrays: Arrays, state: world.State, key: Array) -> world.State:
        waits, picks, scatters = jax.random.split(key, 3)
        mask = world.legal(arrays, state)
        is_still = world.next_event(arrays, state) == NEVER
        begins = mask.any() & (is_still | (jax.random.uniform(waits) < 0.85))
        lots = jax.random.uniform(picks, mask.shape)
        way = jax.numpy.where(begins, jax.numpy.argmax(jax.numpy.where(mask, lots, -1.0)), -1)
        ticks = arrays.way_ticks[way] * jax.numpy.exp(0.3 * jax.random.normal(scatters))
        begun = world.assign(arrays, state, way, jax.numpy.maximum(1, ticks.astype("int32")))
        return jax.tree.map(
            lambda one, other: jax.numpy.where(begins, one, other),
            begun,
            world.advance(arrays, state),
        )

    def shift(arrays: Arrays, key: Array) -> tuple[Array, Array, Array]:
        keys = jax.random.split(key, 3 * tasks)
        end, _ = jax.lax.scan(
            lambda state, key: (step(arrays, state, key), None), world.reset(arrays), keys
        )
        return end.way, world.makespan(end), (end.way >= 0).all()

    return jax.jit(jax.vmap(shift, in_axes=(None, 0)))


@dataclass
class Tally:
    """What was played and planned; per share and in all."""

    shifts: int = 0
    plans: int = 0
    wrong: int = 0
    open: Counter[int] = field(default_factory=Counter)
    played: Counter[int] = field(default_factory=Counter)
    unkept: Counter[int] = field(default_factory=Counter)
    asked: Counter[int] = field(default_factory=Counter)
    over: dict[int, list[float]] = field(default_factory=lambda: defaultdict(list))
    of_plans: dict[int, list[float]] = field(default_factory=lambda: defaultdict(list))
    of_shifts: dict[int, list[float]] = field(default_factory=lambda: defaultdict(list))

    def to_dict(self) -> dict[str, Any]:
        """As the result file holds it."""

        def mean(rows: dict[int, list[float]]) -> dict[str, float]:
            return {
                str(share): round(100 * statistics.fmean(rows[share]), 2) for share in sorted(rows)
            }

        every = [price for rows in self.of_plans.values() for price in rows]
        return {
            "random_shifts": self.shifts,
            "plans": self.plans,
            "violations": self.wrong,
            "paid_by_plans_percent": mean(self.of_plans),
            "paid_by_plans_percent_all": round(100 * statistics.fmean(every or [0.0]), 2),
            "plans_that_pay_nothing_percent": mean(
                {s: [float(p == 0) for p in rows] for s, rows in self.of_plans.items()}
            ),
            "quickest_plan_would_exceed_percent": mean(self.over),
            "paid_by_random_shifts_percent": mean(self.of_shifts),
            "limits_no_plan_keeps": {str(s): self.unkept[s] for s in sorted(self.asked)},
            "limits_asked": {str(s): self.asked[s] for s in sorted(self.asked)},
            "random_shifts_left_unfinished_percent": {
                str(s): round(100 * self.open[s] / self.played[s], 2) for s in sorted(self.played)
            },
        }


class Case:
    """A drawn cell with its unlimited shifts and its unlimited front."""

    def __init__(self, seed: int, tasks: int, shifts: int) -> None:
        import jax

        self.seed, self.tasks = seed, tasks
        self.random = Random(seed)
        self.data = drawn(self.random, tasks)
        self.keys = jax.random.split(jax.random.key(seed), shifts)
        self.kind = self.random.choice(KINDS)
        self.doers, self.makespans, _ = self.played(None)
        self.free = METHODS["exhaustive"](cell_of(self.data), Question("makespan"))[0]
        rows = [_doers(cell_of(self.data), self.free.schedule)]
        self.quickest = int(worst(self.data, rows, self.kind)[0])

    def played(self, units: int | None) -> tuple[list[list[str]], Array, Array]:
        """Who did what in shifts with this limit, how long they took, and which were finished."""
        stated = 0 if units is None else units
        names = Names.of(cell_of(limited(self.data, self.kind, stated)), per_second=1000)
        arrays = names.arrays()
        if units is None:
            arrays = arrays._replace(
                limit=np.full_like(arrays.limit, NEVER // 2), must=np.zeros_like(arrays.must)
            )
        way, makespan, done = (np.asarray(part) for part in player(self.tasks)(arrays, self.keys))
        who = np.array(["", *(mode.operators[0] for _, mode in names.ways)])
        return who[way + 1].tolist(), makespan, done


def judge(case: Case, share: int, tally: Tally) -> None:
    """Plays and plans the case with the limit that so many per cent of its shifts keep."""
    units = int(np.quantile(worst(case.data, case.doers, case.kind), share / 100, method="higher"))
    doers, makespans, done = case.played(units)
    tally.shifts += len(doers)
    tally.played[share] += len(doers)
    tally.open[share] += int((~done).sum())
    exceeded = int((worst(case.data, doers, case.kind) > units).sum())
    both = done & (case.makespans > 0)
    if both.any():
        paid = makespans[both].sum() / case.makespans[both].sum() - 1
        tally.of_shifts[share].append(float(paid))
    tally.asked[share] += 1
    tally.over[share].append(float(case.quickest > units))
    cell = cell_of(limited(case.data, case.kind, units))
    try:
        front = METHODS["exhaustive"](cell, Question())
    except InfeasibleError:
        tally.unkept[share] += 1
    else:
        tally.plans += len(front)
        rows = [_doers(cell, result.schedule) for result in front]
        exceeded += int((worst(case.data, rows, case.kind) > units).sum())
        tally.of_plans[share].append(front[0].makespan / case.free.makespan - 1)
    if exceeded:
        tally.wrong += exceeded
        print(f"seed {case.seed}: {case.kind} of {units} is exceeded {exceeded} x", file=sys.stderr)


def _doers(cell: Cell, schedule: Any) -> list[str]:
    by_task = {a.task: a.operators[0] for a in schedule}
    return [by_task[task] for task in cell.tasks]


HEAD = (
    "of 100 unlimited random shifts keep the limit",
    "quickest plan exceeds it",
    "plans pay",
    "pay nothing",
    "no plan keeps it",
    "random shifts pay",
    "come to a stop",
)


def table(found: dict[str, Any]) -> str:
    """What was found as the docs show it: a row for each share, in per cent."""
    lines = [f"| {' | '.join(HEAD)} |", "|---:" * len(HEAD) + "|"]
    for share in map(str, SHARES):
        unkept = 100 * found["limits_no_plan_keeps"][share] / found["limits_asked"][share]
        row = [
            found["quickest_plan_would_exceed_percent"][share],
            found["paid_by_plans_percent"][share],
            found["plans_that_pay_nothing_percent"][share],
            unkept,
            found["paid_by_random_shifts_percent"][share],
            found["random_shifts_left_unfinished_percent"][share],
        ]
        lines.append(f"| {share} | {' | '.join(f'{value:.1f} %' for value in row)} |")
    return "\n".join(lines)


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="dev.py fuzz people", description=(__doc__ or "").splitlines()[0]
    )
    parser.add_argument("--cells", type=int, default=20, help="how many cells (20)")
    parser.add_argument("--tasks", type=int, default=7, help="tasks of each (7)")
    parser.add_argument("--shifts", type=int, default=100, help="shifts of a cell and limit (100)")
    parser.add_argument("--seed", type=int, default=1, help="seed of the first cell (1)")
    parser.add_argument("--minutes", type=float, default=600.0, help="stop after so many minutes")
    parser.add_argument("--out", type=Path, help="write the summary to this file as well")
    parser.add_argument("--show", type=Path, help="print the table of such a file, and run nothing")
    asked = parser.parse_args(arguments)
    if asked.show:
        print(table(json.loads(asked.show.read_text(encoding="utf-8"))))
        return 0
    until, tally, cells = time.monotonic() + 60 * asked.minutes, Tally(), 0
    for seed in range(asked.seed, asked.seed + asked.cells):
        if time.monotonic() > until:
            break
        case, cells = Case(seed, asked.tasks, asked.shifts), cells + 1
        for share in SHARES:
            judge(case, share, tally)
        print(f"\r{cells} cells, {tally.wrong} violations", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    command = (
        f"python3 dev.py fuzz people --cells {cells} --tasks {asked.tasks}"
        f" --shifts {asked.shifts} --seed {asked.seed}"
    )
    text = json.dumps({"command": command, "cells": cells, **tally.to_dict()}, indent=1)
    print(text)
    if asked.out:
        asked.out.write_text(text + "\n", encoding="utf-8")
    return int(tally.wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
