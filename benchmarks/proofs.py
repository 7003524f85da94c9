"""What each idea brings to a proof: CP-SAT on public cells, one model and one parameter set at a
time, from the best schedule that the archive holds.

    python benchmarks/proofs.py --data DIR [--only NAME ...] [--models plain ...]
        [--parameters default ...] [--work 1.2]

Each run has one search thread and so many of CP-SAT's deterministic seconds, which do not depend on
what else the machine does. Prints for each model and parameter set how many were proven, and per
instance whether, deterministic seconds, processor seconds, and the bound where it was not.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from typing import Any

from ortools.sat.python import cp_model

sys.path.insert(0, str(Path(__file__).parent))
from archive import SETS, entries, unpacked
from tandem.cell.model import Cell
from tandem.plan.cpsat import IMPLIED, RULES, formulate
from tandem.plan.instance import Instance
from tandem.plan.starts import measures
from tandem.schedule.model import Schedule

EIGHT = [
    *("battery_H3R4", "battery_H5R2", "battery_H5R3", "battery_H2R4", "battery_H4R3"),
    *("DAFJS02", "DAFJS05", "YFJS12"),
]
MODELS = {
    "plain": (False, None),
    "plain-cut": (False, 0),
    "plain-below": (False, -1),
    "rows": (True, None),
    "rows-cut": (True, 0),
    "rows-below": (True, -1),
}
"""Name -> with the implied rows; how far beyond the incumbent a schedule may last, in ticks (None:
to the horizon). Where the incumbent is in the model it is a hint.
"""
PARAMETERS: dict[str, dict[str, Any]] = {
    "default": {},
    "objective-lb": {"use_objective_lb_search": True},
    "objective-lb-dynamic": {
        "use_objective_lb_search": True,
        "use_dynamic_precedence_in_disjunctive": True,
    },
    "shaving": {"use_objective_shaving_search": True},
    "lb-tree": {"optimize_with_lb_tree_search": True, "linearization_level": 2},
    "dynamic": {"use_dynamic_precedence_in_disjunctive": True},
    "no-lp": {"linearization_level": 0},
    "max-lp": {"linearization_level": 2},
    "quick-restart": {"search_branching": 6},
    "quick-restart-no-lp": {"search_branching": 6, "linearization_level": 0},
    "strong": {
        "use_strong_propagation_in_disjunctive": True,
        "use_overload_checker_in_cumulative": True,
    },
    "core": {"optimize_with_core": True},
    "probing-level-3": {"cp_model_probing_level": 3},
    "probing": {"use_probing_search": True},
}


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--only", nargs="+", default=EIGHT, metavar="NAME")
    parser.add_argument("--models", nargs="+", default=["plain"], choices=list(MODELS))
    parser.add_argument(
        "--parameters", nargs="+", default=list(PARAMETERS), choices=list(PARAMETERS)
    )
    parser.add_argument("--work", type=float, default=1.2, help="deterministic seconds each")
    options = parser.parse_args()
    cells = [
        (entry.instance, cell, unpacked(cell, entry.schedule["tasks"]))
        for entry, cell, _ in entries(options.data, list(SETS), options.only)
        if entry.schedule is not None
    ]
    for model in options.models:
        for parameters in options.parameters:
            runs = [
                (name, *proven(cell, schedule, model, parameters, options.work))
                for name, cell, schedule in cells
            ]
            print(
                f"{model} {parameters}: proven {sum(run[1] for run in runs)} of {len(runs)},"
                f" processor {sum(run[3] for run in runs):.1f} s"
            )
            for name, ok, work, seconds, bound in runs:
                left = "proven" if ok else f"bound {bound:g}"
                print(f"    {name:<14}{left:<12}{work:6.2f}{seconds:8.1f} s", flush=True)
    return 0


def proven(
    cell: Cell, schedule: Schedule, model: str, parameters: str, work: float
) -> tuple[bool, float, float, float]:
    """Whether the schedule was proven optimal or a better one proven, the deterministic and the
    processor seconds, and the bound in ticks.
    """
    instance = Instance.of(cell)
    starts = instance.starts(schedule)
    rows, beyond = MODELS[model]
    upper = instance.horizon if beyond is None else measures(instance, starts)[0] + beyond
    plan = formulate(instance, upper, [rule for rule in RULES if rows or rule not in IMPLIED])
    if beyond is None or beyond >= 0:
        plan.hint(starts)
    plan.model.minimize(plan.makespan)
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    solver.parameters.max_deterministic_time = work
    for name, value in PARAMETERS[parameters].items():
        setattr(solver.parameters, name, value)
    began = time.process_time()
    status = solver.solve(plan.model)
    return (
        status in (cp_model.OPTIMAL, cp_model.INFEASIBLE),
        solver.response_proto.deterministic_time,
        time.process_time() - began,
        solver.best_objective_bound,
    )


if __name__ == "__main__":
    sys.exit(main())
