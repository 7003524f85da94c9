"""Who proved it: the share of bounds that stand without CP-SAT, by size.

    python benchmarks/certificates.py [--tasks 8 12 20 30 50] [--seeds 2] [--work 4] [-o FILE]

Work is limited instead of time, so that fronts repeat on a busy machine. Of each front every proven
bound is counted: the least makespan at a point's stress, and the least stress at its makespan.
`reckoned` are closed forms (critical path, load of one operator, load shared out, least stress),
`states` Tandem's own state search, `confirmed` what CP-SAT proved and the dynamic program
confirmed. What is left is `CP-SAT alone`, the allocation relaxation included, since CP-SAT solves
it.

Of what is left the state search, which calls no solver, is asked for so many processor seconds
each (`--certify`): no schedule within this stress is quicker, or none of less stress ends by then.
`on request` is what it certifies.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from pathlib import Path
from time import thread_time
from typing import Any

from tandem.files.generators import layered
from tandem.plan.cpsat import SOLVER
from tandem.plan.instance import Instance
from tandem.plan.lower_bound import prove_makespan
from tandem.plan.methods import plan
from tandem.plan.provers import Prover
from tandem.plan.result import Front, Result

GROUPS = {
    "reckoned": (Prover.CHAIN, Prover.LOAD, Prover.SHARED, Prover.LEAST_STRESS),
    "states": (Prover.STATES,),
    "confirmed": (Prover.CONFIRMED, Prover.DYNAMIC),
    "CP-SAT alone": (Prover.CP_SAT, Prover.ALLOCATION),
}


def main() -> int:
    """Prints the table, and stores it."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tasks", nargs="+", type=int, default=[8, 12, 20, 30, 50])
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--work", type=float, default=4.0, help="CP-SAT's deterministic seconds")
    parser.add_argument("--certify", type=float, default=0.5, help="processor seconds each")
    parser.add_argument("-o", "--output", type=Path)
    options = parser.parse_args()
    rows = []
    print(f"{options.seeds} cells of each size, 1 human and 1 robot, work {options.work:g} each:")
    print("tasks  bounds  proven  " + "  ".join(GROUPS) + "  on request  without CP-SAT")
    for tasks in options.tasks:
        rows.append(_of_size(tasks, options))
        print(_line(rows[-1]), flush=True)
        if options.output:
            about = {"command": "benchmarks/certificates.py", "solver": SOLVER, **vars(options)}
            about.pop("output")
            document = {**about, "rows": rows}
            options.output.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    return 0


def _of_size(tasks: int, options: argparse.Namespace) -> dict[str, Any]:
    counts: Counter[str] = Counter()
    for seed in range(options.seeds):
        cell = layered(tasks, 1, 1, seed=seed)
        front = plan(cell, work=options.work, seed=seed)
        counts["fronts complete"] += front.complete
        counts["partial schedules"] += (
            0 if front.confirmation is None else front.confirmation.states
        )
        for result in front:
            _count(front, result, counts, options.certify)
    return {"tasks": tasks, "seeds": options.seeds, **counts}


def _count(front: Front, result: Result, counts: Counter[str], seconds: float) -> None:
    """The two bounds of one point."""
    by = result.bound.proved_by
    assert by is not None
    proven = (
        result.bound.makespan >= result.makespan,
        result.bound.stress >= result.stress,
    )
    for of_stress, (prover, is_proven) in enumerate(zip(by, proven, strict=True)):
        counts["bounds"] += 1
        if not is_proven:
            continue
        counts["proven"] += 1
        counts[next(name for name, group in GROUPS.items() if prover in group)] += 1
        if prover.needs_cp_sat and _by_states(front, result, bool(of_stress), seconds):
            counts["on request"] += 1


def _by_states(front: Front, result: Result, of_stress: bool, seconds: float) -> bool:
    """Whether the state search proves it alone: that nothing of this stress is quicker, or that
    nothing of less stress ends by then.
    """
    instance = Instance.of(front.cell)
    upper = round(result.makespan * instance.per_second) + of_stress
    units = round(result.stress * instance.per_stress) - of_stress
    until = thread_time() + seconds
    proof = prove_makespan(
        instance, upper, 60.0, most_units=units, stop=lambda: thread_time() > until
    )
    return proof.starts is None and proof.bound >= upper


def _line(row: dict[str, Any]) -> str:
    def share(*names: str) -> str:
        return f"{sum(row.get(name, 0) for name in names) / max(row['proven'], 1):.0%}"

    cells = [f"{row['tasks']:>5}", f"{row['bounds']:>6}", f"{row['proven']:>6}"]
    cells += [f"{share(name):>{len(name)}}" for name in GROUPS]
    cells += [f"{share('on request'):>10}"]
    alone = share("reckoned", "states", "confirmed", "on request")
    return "  ".join([*cells, f"{alone:>14}"])


if __name__ == "__main__":
    sys.exit(main())
