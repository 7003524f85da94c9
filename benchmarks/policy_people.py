"""The policy for any cell beside people: `learned` as it is shipped, `auto`, re-planning and rules
on cells of 7 to 53 tasks, the same episodes for all of them, 50 ms for each decision.

    python benchmarks/policy_people.py [--sizes 7 12 20 30 53] [--minutes 60]
        [--folder tandem-out/policy_people] [--others FILE]
        [-o benchmarks/results/policy_people.json]
    python benchmarks/policy_people.py --show benchmarks/results/policy_people.json

Random layered cells of one robot and one human, seeds 0, 1, ...; nothing was trained on them. The
people are those of `beside_people`, and those of `examples/people/measured.yaml`, whose times
scatter: the cell states so, and every decider can read it. A budget is counted in work, so that the
load of the machine decides nothing. Differences are of the makespan, paired by episode, in shares
of the mean of `learned`; intervals are percentiles of a bootstrap over cells and episodes. Of the
rules the one that is best in the row.

Each job is a file in --folder: what was stopped goes on where it was, and --minutes ends it before
the next job. `--others FILE` takes from an earlier result what they did who know nothing of the
network's weights, re-planning and rules; it is the same each time, but for the time that it took.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from hashlib import sha256
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
from beside_people import PEOPLE, ROOT, Timed, paired, quantiles, rounded
from tandem.cell.model import Cell
from tandem.cli.compiled import keep_compiled
from tandem.dispatch.deciders.memory import settled_memory
from tandem.dispatch.deciders.policy import Options
from tandem.dispatch.deciders.table import policy
from tandem.dispatch.evaluation.batch import EpisodeBatch
from tandem.dispatch.lookahead.objective import SECONDS
from tandem.files.atomic import store
from tandem.files.generators import layered
from tandem.learn.graph.weights import SHIPPED
from tandem.learn.training.runs import versions
from tandem.world.arrays import Names
from tandem.world.population import crowd
from tandem.world.randomness import OFF, Chance, Draw

MEASURED, SCATTER = "measured", 0.5
"""The people whose times scatter, and their coefficient of variation."""
CROWDS = {**PEOPLE, MEASURED: f"population:{ROOT / 'examples' / 'people' / 'measured.yaml'}"}
TITLES = {
    **{name: f"`{spec}`" for name, spec in PEOPLE.items()},
    "population": "held-out population",
    MEASURED: "as measured",
}
CELLS = 3
EPISODES = {7: 20, 12: 16, 20: 8, 30: 5, 53: 3}
"""Tasks -> episodes of each cell beside each people: a long one says more and takes longer."""
REFERENCE = "learned"
PLANNERS = ("auto", "replan-robust")
RULES = ("longest-tail", "balanced", "earliest-completion", "heft", "spt", "lpt")
WEIGHED = (REFERENCE, "auto")
"""Who asks the network."""


@dataclass(frozen=True)
class Job:
    """A decider beside some people on a cell, and the name of its file."""

    tasks: int
    cell: int
    people: str
    who: str

    @property
    def file(self) -> str:
        return f"{self.tasks}-{self.cell}/{self.people}-{self.who}"


def jobs(sizes: list[int]) -> Iterator[Job]:
    """All of them: the first cell of each size, then the second ones."""
    for cell in range(CELLS):
        for tasks in sizes:
            for people in CROWDS:
                for who in (REFERENCE, *PLANNERS, *RULES):
                    yield Job(tasks, cell, people, who)


def station(job: Job) -> Cell:
    """The job's cell; where times scatter, it says how far those of people do."""
    cell = layered(job.tasks, seed=job.cell)
    if job.people != MEASURED:
        return cell
    document = cell.to_dict()
    for task in document["tasks"].values():
        if spread := {who: SCATTER for who in cell.humans if who in task["time"]}:
            task["spread"] = spread
    return Cell.model_validate(document)


def done(job: Job, episodes: int) -> dict[str, Any]:
    """What the job's file is to hold."""
    cell = station(job)
    names = Names.of(cell)
    scatters = job.people == MEASURED
    # who makes mistakes takes apart, too
    arrays = names.arrays(undo=1.0) if scatters else names.arrays()
    draw = Draw.of(names, arrays, Chance("lognormal") if scatters else OFF)
    people = crowd(CROWDS[job.people], names, arrays).draw(np.random.default_rng(0), episodes)
    stage = EpisodeBatch.of(names, arrays, draw, people, 0)
    timed = Timed(policy(job.who, cell, SECONDS, Options()))
    with settled_memory() as settle:
        outcome = stage.play(timed, between=settle)
    assert outcome.done.all()
    return {"makespans": rounded(outcome.makespan), "cpu_ms": quantiles(timed.own_ms)}


def work_off(
    sizes: list[int], folder: Path, minutes: float, known: dict[str, Any]
) -> dict[str, Any]:
    """Does what is neither done nor known yet until the minutes are over; all results that there
    are.
    """
    began, results = time.perf_counter(), dict[str, Any]()
    for job in jobs(sizes):
        path = folder / f"{job.file}.json"
        if job.who not in WEIGHED and job.file in known:
            results[job.file] = known[job.file]
            continue
        if not path.exists():
            if time.perf_counter() - began > 60 * minutes:
                continue
            print(f"{time.perf_counter() - began:.0f} s: {job.file}", file=sys.stderr, flush=True)
            path.parent.mkdir(parents=True, exist_ok=True)
            store(path, json.dumps(done(job, EPISODES[job.tasks])) + "\n")
        results[job.file] = json.loads(path.read_text(encoding="utf-8"))
    return results


def row_of(results: dict[str, Any], tasks: int, people: str) -> dict[str, Any] | None:
    """A line of the table, over the cells in which everybody has played; None where there is
    none.
    """
    everybody = (REFERENCE, *PLANNERS, *RULES)
    of: dict[str, list[Any]] = {who: [] for who in everybody}
    for cell in range(CELLS):
        played = {who: results.get(Job(tasks, cell, people, who).file) for who in everybody}
        if all(played.values()):
            for who, found in played.items():
                of[who].append(np.array([found["makespans"]]))
    if not of[REFERENCE]:
        return None
    best = min(RULES, key=lambda rule: np.mean(of[rule]))
    others = {**{who: of[who] for who in PLANNERS}, "best rule": of[best]}
    return {
        "cells": len(of[REFERENCE]),
        "seconds": float(np.mean(of[REFERENCE])),
        "rule": best,
        **{
            who: paired(list(zip(cells, of[REFERENCE], strict=True)))
            for who, cells in others.items()
        },
    }


def tables(document: dict[str, Any]) -> Iterator[str]:
    """The Markdown lines: differences, then the time of a decision."""
    results, sizes = document["results"], document["sizes"]
    heads = ", ".join(
        ("tasks", "people", "cells x episodes", "`learned` [s]", *map("`{}`".format, PLANNERS))
    )
    yield f"| {heads.replace(', ', ' | ')} | best rule |"
    yield "|---|---|---|---|---|---|---|"
    for tasks in sizes:
        for people, title in TITLES.items():
            row = row_of(results, tasks, people)
            if row is None:
                continue
            told = [_words(row[who]) for who in (*PLANNERS, "best rule")]
            told[-1] += f" `{row['rule']}`"
            played = f"{row['cells']} x {row['auto']['episodes']}"
            yield f"| {tasks} | {title} | {played} | {row['seconds']:.1f} | {' | '.join(told)} |"
    yield ""
    yield "| tasks | `learned` | `auto` | `replan-robust` | `longest-tail` |"
    yield "|---|---|---|---|---|"
    for tasks in sizes:
        times = []
        for who in (REFERENCE, *PLANNERS, "longest-tail"):
            mine = [
                one["cpu_ms"]
                for job in jobs([tasks])
                if job.who == who and (one := results.get(job.file)) is not None
            ]
            shares = [f"{np.mean([t[part] for t in mine]):.1f}" for part in ("p50", "p99") if mine]
            times.append(" / ".join(shares) or "–")
        if "–" not in times:
            yield f"| {tasks} | {' | '.join(times)} |"


def _words(found: dict[str, Any]) -> str:
    low, high = found["ci95"]
    return f"{found['mean']:+.1%} [{low:+.1%}, {high:+.1%}]"


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--sizes", type=int, nargs="+", choices=list(EPISODES), default=list(EPISODES)
    )
    parser.add_argument("--minutes", type=float, default=1e9, help="begin no job after these")
    parser.add_argument("--folder", type=Path, default=Path("tandem-out/policy_people"))
    parser.add_argument(
        "--others", type=Path, help="an earlier result, for those who do not ask the network"
    )
    parser.add_argument("--show", type=Path, help="only print the tables of an earlier run")
    parser.add_argument("-o", "--output", type=Path)
    asked = parser.parse_args()
    if asked.show:
        document = json.loads(asked.show.read_text(encoding="utf-8"))
    else:
        keep_compiled()
        weights = files("tandem.learn.graph").joinpath(SHIPPED).read_bytes()
        known = json.loads(asked.others.read_text())["results"] if asked.others else {}
        document = {
            "benchmark": "policy_people",
            "sizes": asked.sizes,
            "weights": sha256(weights).hexdigest()[:12],
            "versions": versions(),
            "load": round(os.getloadavg()[2], 1),
            "results": work_off(asked.sizes, asked.folder, asked.minutes, known),
        }
    if asked.output:
        store(asked.output, json.dumps(document) + "\n")
    print("\n".join(tables(document)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
