"""What each idea brings to a proof: CP-SAT on public cells, one model and one parameter set at a
time, from the best schedule that the archive holds, or from that of a rule, as a search begins.

    python benchmarks/proofs.py --data DIR [--only NAME ...] [--models plain ...]
        [--parameters default ...] [--begin best|rule|none] [--seeds 1] [--work 1.2]

Each run has one search thread and so many of CP-SAT's deterministic seconds, which do not depend on
what else the machine does. Prints for each model and parameter set how many were proven, and per
instance and seed whether, deterministic seconds, processor seconds, and the bound where it was not.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterable
from itertools import combinations, pairwise, product
from pathlib import Path
from random import Random
from typing import Any

from ortools.sat.python import cp_model

sys.path.insert(0, str(Path(__file__).parent))
from archive import SETS, Entry, entries, unpacked
from tandem.cell.model import Cell
from tandem.plan.cpsat import (
    IMPLIED,
    RULES,
    Decisions,
    Rule,
    an_operator_does_one_thing_at_a_time,
    closure,
    formulate,
)
from tandem.plan.instance import Instance
from tandem.plan.list_scheduling import Layout
from tandem.plan.rules import SPECS, build
from tandem.plan.starts import Starts, measures

EIGHT = [
    *("battery_H3R4", "battery_H5R2", "battery_H5R3", "battery_H2R4", "battery_H4R3"),
    *("DAFJS02", "DAFJS05", "YFJS12"),
]


def windows(plan: Decisions) -> None:
    """For every pair of a head and a tail, what an operator does of the tasks that lie between fits
    there (energetic reasoning; Baptiste, Le Pape, Nuijten 2001, Constraint-Based Scheduling).
    """
    instance, tasks = plan.instance, range(len(plan.instance.tasks))
    heads = sorted({instance.head[task] for task in tasks})
    rests = sorted({instance.rest[task] for task in tasks})
    for operator in range(len(instance.operators)):
        seen: set[tuple[int, ...]] = set()
        for head, rest in product(heads, rests):
            inside = tuple(
                task
                for task in tasks
                if instance.head[task] >= head
                and instance.rest[task] >= rest
                and plan.does(task, operator)
            )
            if len(inside) > 1 and inside not in seen:
                seen.add(inside)
                plan.model.add(_work(plan, operator, inside) + head + rest <= plan.makespan)


def between(plan: Decisions) -> None:
    """What an operator does behind one task and before another fits between the two."""
    instance = plan.instance
    above = closure(instance.before, instance.order)
    below = closure(instance.behind, instance.order[::-1])
    for last in range(len(instance.tasks)):
        for first in above[last]:
            inside = sorted(below[first] & above[last])
            for operator in range(len(instance.operators)):
                mine = [task for task in inside if plan.does(task, operator)]
                if len(mine) > 1:
                    plan.model.add(
                        plan.end[first] + _work(plan, operator, mine) <= plan.start[last]
                    )


def all_at_once(plan: Decisions) -> None:
    """Never more tasks at a time than there are operators: one cumulative over intervals that are
    always present.
    """
    instance, model = plan.instance, plan.model
    spans = []
    for task, ways in enumerate(instance.ways):
        ticks = {way.ticks for way in ways}
        length = model.new_int_var(min(ticks), max(ticks), "")
        model.add(length == plan.end[task] - plan.start[task])
        end = model.new_int_var(0, plan.upper, "")
        spans.append(model.new_interval_var(plan.start[task], length, end, ""))
    teams = [min(len(way.operators) for way in ways) for ways in instance.ways]
    model.add_cumulative(spans, teams, len(instance.operators))


def alike_in_order(plan: Decisions) -> None:
    """Of operators that nothing tells apart the second takes no task before the first has one, by
    the order of the tasks in the cell.
    """
    instance = plan.instance
    kinds: dict[object, list[int]] = {}
    for operator in range(len(instance.operators)):
        others = [
            sorted((way.ticks, way.stress) for way in ways if way.operators == (operator,))
            for ways in instance.ways
        ]
        joint = any(
            operator in w.operators and len(w.operators) > 1 for r in instance.ways for w in r
        )
        kinds.setdefault((operator,) if joint else str(others), []).append(operator)
    for one, other in (pair for kind in kinds.values() for pair in pairwise(kind)):
        mine: list[cp_model.IntVar] = []
        for task in range(len(instance.tasks)):
            for x in plan.does(task, other):
                plan.model.add(x <= sum(mine))
            mine += plan.does(task, one)


def tied(plan: Decisions) -> None:
    """An end that is a variable is the start and a sum over the ways as well."""
    for task, end in enumerate(plan.end):
        if isinstance(end, cp_model.IntVar):
            ways = zip(plan.instance.ways[task], plan.chosen[task], strict=True)
            plan.model.add(end == plan.start[task] + sum(way.ticks * x for way, x in ways))


def all_before_the_end(plan: Decisions) -> None:
    """Every task ends before the makespan, not only those that nothing comes after."""
    for end in plan.end:
        plan.model.add(end <= plan.makespan)


def in_pairs(plan: Decisions) -> None:
    """Instead of optional intervals that do not overlap: of two tasks that may have an operator in
    common one ends before the other begins, whenever both are given to that operator.
    """
    instance, model = plan.instance, plan.model
    above = closure(instance.before, instance.order)
    for one, other in combinations(range(len(instance.tasks)), 2):
        if one in above[other] or other in above[one]:
            continue
        first = None
        for operator in range(len(instance.operators)):
            for x, y in product(plan.does(one, operator), plan.does(other, operator)):
                first = model.new_bool_var("") if first is None else first
                begins, ends = plan.start, plan.end
                model.add(ends[one] <= begins[other]).only_enforce_if([x, y, first])
                model.add(ends[other] <= begins[one]).only_enforce_if([x, y, ~first])


def always_there(plan: Decisions) -> None:
    """Instead of optional intervals: each operator has one for every task, of no length and
    wherever it likes when somebody else does the task.
    """
    model = plan.model
    for operator in range(len(plan.instance.operators)):
        spans = []
        for task, ways in enumerate(plan.instance.ways):
            mine = [
                (way.ticks, x)
                for way, x in zip(ways, plan.chosen[task], strict=True)
                if operator in way.operators
            ]
            if not mine:
                continue
            begin, end = (model.new_int_var(0, plan.upper, "") for _ in range(2))
            length = model.new_int_var(0, max(ticks for ticks, _ in mine), "")
            model.add(length == sum(ticks * x for ticks, x in mine))
            for _, x in mine:
                model.add(begin == plan.start[task]).only_enforce_if(x)
            spans.append(model.new_interval_var(begin, length, end, ""))
        model.add_no_overlap(spans)


def _work(plan: Decisions, operator: int, tasks: Iterable[int]) -> cp_model.LinearExprT:
    return sum(
        way.ticks * x
        for task in tasks
        for x, way in zip(plan.chosen[task], plan.instance.ways[task], strict=True)
        if operator in way.operators
    )


PLAIN = tuple(rule for rule in RULES if rule not in IMPLIED)
NO_INTERVALS = tuple(rule for rule in PLAIN if rule is not an_operator_does_one_thing_at_a_time)
MODELS: dict[str, tuple[tuple[Rule, ...], int | None]] = {
    "plain": (PLAIN, None),
    "plain-ends": (PLAIN, None),
    "plain-ends-cut": (PLAIN, 0),
    "plain-ends-tied": ((*PLAIN, tied), None),
    "plain-ends-all": ((*PLAIN, all_before_the_end), None),
    "plain-ends-pairs": ((*NO_INTERVALS, in_pairs), None),
    "plain-ends-always": ((*NO_INTERVALS, always_there), None),
    "plain-cut": (PLAIN, 0),
    "plain-below": (PLAIN, -1),
    "plain-windows": ((*PLAIN, windows), None),
    "plain-between": ((*PLAIN, between), None),
    "plain-at-once": ((*PLAIN, all_at_once), None),
    "plain-alike": ((*PLAIN, alike_in_order), None),
    "rows": (RULES, None),
    "rows-cut": (RULES, 0),
    "rows-ends": (RULES, None),
    "rows-below": (RULES, -1),
    "rows-ends-below": (RULES, -1),
    "rows-windows-below": ((*RULES, windows), -1),
    "rows-between-below": ((*RULES, between), -1),
    "rows-at-once-below": ((*RULES, all_at_once), -1),
    "rows-alike-below": ((*RULES, alike_in_order), -1),
}
"""Name -> the rules of the model; how far beyond the incumbent a schedule may last, in ticks (None:
to the horizon). With `ends` in the name the ends of tasks are variables of their own. Where the
incumbent is in the model it is a hint. `pairs` and `always` know no breaks, walks or changes of
tools. `alike` may leave it out, and has another one of the same
makespan.
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
    parser.add_argument("--begin", default="best", choices=["best", "rule", "none"])
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--work", type=float, default=1.2, help="deterministic seconds each")
    options = parser.parse_args()
    cells = [
        (entry.instance, cell, _first(cell, entry, options.begin))
        for entry, cell, _ in entries(options.data, list(SETS), options.only)
        if entry.schedule is not None
    ]
    for model in options.models:
        for parameters in options.parameters:
            runs = [
                (name, *proven(cell, starts, model, parameters, options.work, seed))
                for name, cell, starts in cells
                for seed in range(options.seeds)
            ]
            print(
                f"{model} {parameters} {options.begin}: proven {sum(run[1] for run in runs)} of"
                f" {len(runs)}, processor {sum(run[3] for run in runs):.1f} s"
            )
            for name, ok, work, seconds, bound in runs:
                left = "proven" if ok else f"bound {bound:g}"
                print(f"    {name:<14}{left:<12}{work:6.2f}{seconds:8.1f} s", flush=True)
    return 0


def _first(cell: Cell, entry: Entry, begin: str) -> Starts | None:
    """The schedule that a run begins with."""
    instance = Instance.of(cell)
    if begin == "none":
        return None
    if begin == "best":
        return instance.starts(unpacked(cell, entry.schedule["tasks"]))
    layout, random = Layout.of(instance), Random(0)
    states = (build(layout, SPECS[rule], random) for rule in ("longest-tail", "balanced"))
    found = [state.starts() for state in states if state is not None]
    return min(found, key=lambda starts: measures(instance, starts)[0])


def proven(
    cell: Cell, starts: Starts | None, model: str, parameters: str, work: float, seed: int
) -> tuple[bool, float, float, float]:
    """Whether the schedule was proven optimal or a better one proven, the deterministic and the
    processor seconds, and the bound in ticks.
    """
    instance = Instance.of(cell)
    rules, beyond = MODELS[model]
    is_wide = beyond is None or starts is None
    upper = instance.horizon if is_wide else measures(instance, starts)[0] + beyond
    plan = formulate(instance, upper, rules, own_ends="-ends" in model)
    if starts is not None and (beyond is None or beyond >= 0):
        plan.hint(starts)
    plan.model.minimize(plan.makespan)
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    solver.parameters.random_seed = seed
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
