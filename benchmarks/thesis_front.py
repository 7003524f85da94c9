"""The whole front of the thesis cell, proven, inside the process: Tandem beside a plain CP-SAT
epsilon-constraint loop, turn by turn.

python benchmarks/thesis_front.py [--turns 20] [--cell examples/thesis.yaml]
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from pathlib import Path

from ortools.sat.python import cp_model

from tandem.cell.model import Cell
from tandem.files.load import load
from tandem.plan.instance import Instance
from tandem.plan.methods import plan


def plain_loop(cell: Cell) -> list[tuple[float, float]]:
    """The textbook: least makespan under a cap on stress, then least stress at that makespan, then
    a cap just below it, one model each.
    """
    instance = Instance.of(cell)
    points: list[tuple[float, float]] = []
    cap = None
    while True:
        makespan = _least(instance, cap, None)
        if makespan is None:
            return points
        stress = _least(instance, cap, makespan)
        assert stress is not None
        points.append((instance.seconds(makespan), instance.stress(stress)))
        cap = stress - 1


def _least(instance: Instance, cap: int | None, makespan_cap: int | None) -> int | None:
    model = cp_model.CpModel()
    starts, ends, stress, lanes = [], [], [], [[] for _ in instance.operators]
    for ways in instance.ways:
        start, end = (
            model.new_int_var(0, instance.horizon, ""),
            model.new_int_var(0, instance.horizon, ""),
        )
        literals = [model.new_bool_var("") for _ in ways]
        model.add_exactly_one(literals)
        for way, literal in zip(ways, literals, strict=True):
            for operator in way.operators:
                lanes[operator].append(
                    model.new_optional_interval_var(start, way.ticks, end, literal, "")
                )
            stress.append(way.stress * literal)
        starts.append(start)
        ends.append(end)
    for lane in lanes:
        model.add_no_overlap(lane)
    for task, firsts in enumerate(instance.before):
        for first in firsts:
            model.add(starts[task] >= ends[first])
    makespan = model.new_int_var(0, instance.horizon if makespan_cap is None else makespan_cap, "")
    model.add_max_equality(makespan, ends)
    if cap is not None:
        model.add(sum(stress) <= cap)
    model.minimize(makespan if makespan_cap is None else sum(stress))
    solver = cp_model.CpSolver()
    return round(solver.objective_value) if solver.solve(model) == cp_model.OPTIMAL else None


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--turns", type=int, default=20)
    parser.add_argument(
        "--cell", type=Path, default=Path(__file__).parent.parent / "examples" / "thesis.yaml"
    )
    options = parser.parse_args()
    cell = load(options.cell)
    ours: list[float] = []
    theirs: list[float] = []
    for _ in range(options.turns + 1):
        began = time.perf_counter()
        front = plan(cell)
        ours.append(time.perf_counter() - began)
        began = time.perf_counter()
        points = plain_loop(cell)
        theirs.append(time.perf_counter() - began)
        if front.points != points or not front.complete:
            print(f"DIFFERENT: {front.points} and {points}")
            return 1
    ours, theirs = ours[1:], theirs[1:]  # the first turn warms both up
    ratio = statistics.median(a / b for a, b in zip(ours, theirs, strict=True))
    print(f"front {front.points}, both complete, {options.turns} turns")
    print(f"tandem     median {1000 * statistics.median(ours):7.1f} ms")
    print(f"plain loop median {1000 * statistics.median(theirs):7.1f} ms")
    print(f"ratio tandem / plain loop, median of turns: {ratio:.2f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
