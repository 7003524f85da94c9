"""What a sweep says: for all who were asked the share of the optimum that they reach, over cells
and seeds, and for each cell what it costs; of one folder, or of several laid over each other.

A score is `bound / cost`, the proximity of `tandem simulate`: 1 at the proven optimum, 0 where
nothing was found. A gap is `cost / bound - 1`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from tandem.bench.folder import SweepFolder, digest_of
from tandem.bench.jobs import (
    BEST_RULE,
    OPTIMUM,
    Job,
    Kind,
    Task,
    asked_of,
    job_of,
    jobs_of,
    kinds_of,
    tasks_of,
)
from tandem.bench.outcome import Record, Took
from tandem.bench.spec import Spec
from tandem.bench.statistics import (
    DRAWS,
    Strata,
    better,
    better_interval,
    interquartile_mean,
    interval,
    mean,
    pooled,
    share_within,
)
from tandem.errors import UsageError

SCHEMA_VERSION = 1
STEPS = 200
"""Places of a performance profile."""
AT_LEAST = 1e-9
"""A cost that is so little above the optimum is the optimum."""


@dataclass(frozen=True)
class Run:
    """A sweep as far as it is done.

    Attributes:
      name: of its folder.
      version: of Tandem, which did it.
      records, times: of the jobs that are done.
    """

    name: str
    spec: Spec
    version: str
    records: Mapping[Job, Record]
    times: Mapping[Job, Took] = field(default_factory=dict)

    @property
    def asks(self) -> str:
        """A digest of what is asked, and of whom."""
        return digest_of(self.spec, self.version)

    def job(self, task: Task, who: str, seed: int) -> Job:
        """The run's job of this one on the task."""
        return job_of(self.spec, task, who, seed, self.version)


def read_runs(folders: Iterable[str | Path]) -> list[Run]:
    """The sweeps of those folders; folders that ask for the same, such as shards done on several
    machines, are one.

    Raises:
      CellError: one is no folder of a sweep, or damaged.
      UsageError: none, or the same one twice.
    """
    found = dict[str, Run]()
    places = [SweepFolder(Path(folder)) for folder in folders]
    if len({place.path.resolve() for place in places}) < len(places) or not places:
        raise UsageError("name one folder of a sweep at least, and each once.")
    for place in places:
        spec, version = place.spec()
        jobs = jobs_of(spec, version)
        run = Run(place.name, spec, version, place.records(jobs), place.times(jobs))
        if (first := found.get(run.asks)) is not None:
            records, times = {**run.records, **first.records}, {**run.times, **first.times}
            run = replace(first, records=records, times=times)
        found[run.asks] = run
    return _named_apart(list(found.values()))


def _named_apart(runs: list[Run]) -> list[Run]:
    """The runs, those of one name numbered."""
    names = [run.name for run in runs]
    return [
        run if names.count(run.name) == 1 else replace(run, name=f"{run.name} ({place})")
        for place, run in enumerate(runs, 1)
    ]


@dataclass(frozen=True)
class _Row:
    """One who is asked, in one run: per task the job of each seed, and its record."""

    who: str
    jobs: Mapping[Task, Sequence[Job]]
    records: Mapping[Task, Sequence[Record]]


def summarised(runs: Sequence[Run], *, draws: int = DRAWS, seed: int = 0) -> dict[str, Any]:
    """The tables as plain values: one of planning and one of dispatch, where there are such.

    Args:
      draws, seed: of the bootstrap. The same records give the same numbers, however they came.
    """
    kinds: list[Kind] = [
        kind for kind in ("plan", "dispatch") if any(kind in kinds_of(run.spec) for run in runs)
    ]
    return {
        "schema_version": SCHEMA_VERSION,
        "name": next((run.spec.name for run in runs if run.spec.name), ""),
        "runs": [
            {
                "run": run.name,
                "asks": run.asks,
                "jobs": len(run.records),
                "of": len(jobs_of(run.spec, run.version)),
            }
            for run in runs
        ],
        "statistics": {"interval": 0.95, "draws": draws, "seed": seed},
        "tables": [
            _table(kind, [run for run in runs if kind in kinds_of(run.spec)], draws, seed)
            for kind in kinds
        ],
    }


def _table(kind: Kind, runs: Sequence[Run], draws: int, seed: int) -> dict[str, Any]:
    labels = {task: label for run in runs for label, task in tasks_of(run.spec, kind)}
    shared = [task for task in labels if all(task in _tasks(run, kind) for run in runs)]
    bounds = {task: _bound(task, runs) for task in shared}
    known = [task for task in shared if bounds[task] is not None]
    rows = list(_rows(kind, runs, shared))
    strata = {
        row.who: [_scores(row.records.get(task, ()), bounds[task]) for task in known]
        for row in rows
    }
    whole = {who: [scores for scores in found if len(scores)] for who, found in strata.items()}
    rules = [row.who for row in rows if row.who.startswith(BEST_RULE)]
    return {
        "kind": kind,
        "rows": [
            {
                "who": row.who,
                **_counts(kind, row, shared, bounds),
                **_statistics(whole[row.who], draws, seed),
                **_beside(strata[row.who], strata[_rule_of(row.who, rules)], draws, seed),
            }
            for row in rows
        ],
        "cells": [_cell(labels[task], task, bounds[task], rows) for task in shared],
        "profiles": _profiles(whole, draws, seed),
        "left_out": list(_left_out(labels, shared, bounds, runs)),
    }


def _tasks(run: Run, kind: Kind) -> set[Task]:
    return {task for _, task in tasks_of(run.spec, kind)}


def _rows(kind: Kind, runs: Sequence[Run], shared: Sequence[Task]) -> Iterator[_Row]:
    """Everybody in every run, the optimum aside. What several runs have alike is one row."""
    found = list[tuple[str, Run, dict[Task, list[Job]]]]()
    for run in runs:
        for who in asked_of(run.spec, kind):
            jobs = {task: [run.job(task, who, seed) for seed in run.spec.seeds] for task in shared}
            if (who, jobs) not in [(other, same) for other, _, same in found]:
                found.append((who, run, jobs))
    names = [who for who, _, _ in found]
    for who, run, jobs in found:
        yield _Row(
            who if names.count(who) == 1 else f"{who} [{run.name}]",
            jobs,
            {
                task: [run.records[job] for job in some if job in run.records]
                for task, some in jobs.items()
            },
        )


def _rule_of(who: str, rules: Sequence[str]) -> str:
    """The row of the best rule that this one is held against: that of its own run."""
    own = who[who.rindex("[") :] if who.endswith("]") else ""
    return next((rule for rule in rules if own and rule.endswith(own)), rules[0])


def _bound(task: Task, runs: Sequence[Run]) -> tuple[float, bool] | None:
    """What nobody can be below on the task, the mean over the seeds, and whether it is the optimum
    itself. None while it is not known.
    """
    found = []
    for run in runs:
        wanted = {run.job(task, OPTIMUM, seed) for seed in run.spec.seeds}
        kept = [run.records[job] for job in sorted(wanted, key=_order) if job in run.records]
        low = [record.bound for record in kept if record.bound is not None]
        if kept and len(low) == len(kept):
            found.append((float(np.mean(low)), all(record.proven for record in kept)))
    best = max(found, default=None)
    return best if best is not None and best[0] > 0 else None


def _order(job: Job) -> tuple[int, str]:
    return job.seed or 0, job.name


def _scores(records: Sequence[Record], bound: tuple[float, bool] | None) -> Any:
    """`[seeds]`: the share of the optimum that each reached."""
    assert bound is not None
    return np.array(
        [0.0 if record.cost is None else bound[0] / record.cost for record in records], float
    )


def _gaps(records: Sequence[Record], bound: tuple[float, bool] | None) -> list[float]:
    if bound is None:
        return []
    return [record.cost / bound[0] - 1 for record in records if record.cost is not None]


def _counts(
    kind: Kind,
    row: _Row,
    shared: Sequence[Task],
    bounds: Mapping[Task, tuple[float, bool] | None],
) -> dict[str, Any]:
    """How many jobs there are and are done, how many found something, and reached the optimum,
    which beside people is an expectation that no episodes reach exactly.
    """
    records = [record for task in shared for record in row.records[task]]
    gaps = [gap for task in shared for gap in _gaps(row.records[task], bounds[task])]
    proven = [
        gap <= AT_LEAST
        for task in shared
        for gap in _gaps(row.records[task], bounds[task])
        if (bound := bounds[task]) is not None and bound[1]
    ]
    return {
        "jobs": sum(len(jobs) for jobs in row.jobs.values()),
        "done": len(records),
        "found": sum(record.cost is not None for record in records),
        "worst_gap": _rounded(max(gaps)) if gaps else None,
        "optimal": None if kind == "dispatch" else sum(proven),
        "chosen": sorted({record.chosen for record in records if record.chosen is not None}),
    }


def _statistics(strata: Strata, draws: int, seed: int) -> dict[str, Any]:
    if not strata:
        return dict.fromkeys(("iqm", "iqm_ci95", "mean", "mean_ci95", "gap", "gap_ci95"))
    found = [scores for scores in strata if scores.all()]  # a gap is only known of what was found
    gaps = [1 / scores - 1 for scores in found]
    return {
        **_measured("iqm", strata, interquartile_mean, draws, seed),
        **_measured("mean", strata, mean, draws, seed),
        **(
            _measured("gap", gaps, mean, draws, seed)
            if len(found) == len(strata)
            else {"gap": None, "gap_ci95": None}
        ),
    }


def _measured(name: str, strata: Strata, statistic: Any, draws: int, seed: int) -> dict[str, Any]:
    edges = interval(strata, statistic, draws=draws, seed=seed)
    return {
        name: _rounded(statistic(pooled(strata))),
        f"{name}_ci95": [_rounded(edge) for edge in edges],
    }


def _beside(own: Strata, rule: Strata, draws: int, seed: int) -> dict[str, Any]:
    """How likely this one is ahead of the best rule."""
    pairs = [(a, b) for a, b in zip(own, rule, strict=True) if len(a) and len(b)]
    if not pairs:
        return {"better_than_rule": None, "better_than_rule_ci95": None}
    first, second = [a for a, _ in pairs], [b for _, b in pairs]
    edges = better_interval(first, second, draws=draws, seed=seed)
    return {
        "better_than_rule": _rounded(better(first, second)),
        "better_than_rule_ci95": [_rounded(edge) for edge in edges],
    }


def _cell(
    label: str, task: Task, bound: tuple[float, bool] | None, rows: Sequence[_Row]
) -> dict[str, Any]:
    """What the task costs everybody, mean over the seeds that found something."""
    costs = {}
    for row in rows:
        found = [record.cost for record in row.records[task] if record.cost is not None]
        costs[row.who] = _rounded(float(np.mean(found))) if found else None
    return {
        "cell": label,
        "digest": task.cell,
        **({} if task.people is None else {"people": task.people[0]}),
        "bound": None if bound is None else _rounded(bound[0]),
        "proven": bound is not None and bound[1],
        "cost": costs,
    }


def _profiles(strata: Mapping[str, Strata], draws: int, seed: int) -> dict[str, Any]:
    """Per name the share of jobs whose gap is at most so large, over the same limits for all."""
    gaps = {
        who: [np.where(scores > 0, 1 / np.maximum(scores, 1e-12) - 1, np.inf) for scores in found]
        for who, found in strata.items()
        if found
    }
    finite = [gap for found in gaps.values() for gap in pooled(found) if np.isfinite(gap)]
    if not finite:
        return {"gaps": [], "lines": {}}
    most = max(*finite, 0.01)
    limits = np.linspace(0.0, most, STEPS) + AT_LEAST
    statistic = share_within(limits)
    lines = {}
    for who, found in gaps.items():
        low, high = interval(found, statistic, draws=draws, seed=seed)
        lines[who] = {
            "share": [_rounded(share) for share in statistic(pooled(found))],
            "low": [_rounded(share) for share in low],
            "high": [_rounded(share) for share in high],
        }
    return {"gaps": [_rounded(limit) for limit in limits], "lines": lines}


def seconds(runs: Sequence[Run]) -> list[dict[str, Any]]:
    """What the jobs took, mean over them: no result, and different on every machine."""
    took = dict[tuple[str, str, str], list[Took]]()
    for run in runs:
        for job, one in run.times.items():
            took.setdefault((run.name, job.kind, job.who), []).append(one)
    found = []
    for (name, kind, who), some in took.items():
        slow = [one.p99_ms for one in some if one.p99_ms is not None]
        found.append(
            {
                "run": name,
                "kind": kind,
                "who": who,
                "jobs": len(some),
                "wall_s": round(float(np.mean([one.wall_s for one in some])), 3),
                "cpu_s": round(float(np.mean([one.cpu_s for one in some])), 3),
                "worst_p99_ms": max(slow, default=None),
            }
        )
    return found


def _left_out(
    labels: Mapping[Task, str],
    shared: Sequence[Task],
    bounds: Mapping[Task, tuple[float, bool] | None],
    runs: Sequence[Run],
) -> Iterator[str]:
    """What a reader has to know of the tasks that the statistics are not about."""
    for task, label in labels.items():
        name = label if task.people is None else f"{label} beside {task.people[0]}"
        if task not in shared:
            yield f"{name}: not in every run, so it is left out."
        elif bounds[task] is None:
            wanted = [
                run.records[job]
                for run in runs
                for seed in run.spec.seeds
                if (job := run.job(task, OPTIMUM, seed)) in run.records
            ]
            why = next((record.reason for record in wanted if record.reason), "not yet proven")
            yield f"{name}: no optimum to be held against ({why}); its costs are told, no more."


def _rounded(value: float) -> float:
    return float(round(value, 6))
