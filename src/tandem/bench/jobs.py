"""The single jobs of a sweep: who is asked, on which cell, with which seed, beside whom.

A job is known by all that its result depends on. The same job of another call, shard or engine has
the same name, so that nothing is done twice; a cell that was changed gives another job.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any, Literal

import tandem
from tandem.bench.spec import Spec
from tandem.bench.trained import LEARNED

Kind = Literal["plan", "dispatch"]

OPTIMUM, BEST_RULE, RANDOM = "optimum", "best rule", "random"
"""Whom every sweep has beside those who are asked for: the exact optimum or what is proven of it,
the best dispatch rule, and tasks in random order.
"""


@dataclass(frozen=True)
class Job:
    """One of them.

    Attributes:
      kind: a whole assembly is planned, or episodes are dispatched beside people.
      who: a method of planning, a policy, or one of those that every sweep has.
      cell: its digest.
      seed: None for the optimum of a cell, which has none.
      people: description of those who are there, with a digest of their file; None of planning.
      settings: what else the result depends on, such as limits and weights.
      version: of Tandem; another one may find another result.
      learned: file of the trained policy, and a digest of it; None for who plays none.
    """

    kind: Kind
    who: str
    cell: str
    seed: int | None
    people: tuple[str, str] | None
    settings: tuple[tuple[str, float | None], ...]
    version: str = tandem.__version__
    learned: tuple[str, str] | None = None

    @cached_property
    def name(self) -> str:
        """Of its files: who, and a digest of all the rest."""
        told = asdict(self)
        # what was trained counts, not where its file lies; who plays nothing trained says nothing
        if (learned := told.pop("learned")) is not None:
            told["learned"] = learned[1]
        text = json.dumps(told, sort_keys=True)
        readable = re.sub(r"[^\w.-]+", "-", self.who).strip("-.")[:40]
        return f"{self.kind}-{readable}-{hashlib.sha256(text.encode()).hexdigest()[:16]}"

    @property
    def weights(self) -> tuple[float, float]:
        """Of a second and of a unit of stress."""
        told = dict(self.settings)
        return told["time"] or 0.0, told["stress"] or 0.0

    def setting(self, name: str) -> float | None:
        """What is set under that name."""
        return dict(self.settings)[name]

    def to_dict(self) -> dict[str, Any]:
        """As a result's file holds it."""
        return {
            "kind": self.kind,
            "who": self.who,
            "cell": self.cell,
            "seed": self.seed,
            **({} if self.people is None else {"people": self.people[0]}),
            "settings": dict(self.settings),
            "version": self.version,
            **({} if self.learned is None else {"learned": self.learned[1]}),
        }


@dataclass(frozen=True)
class Task:
    """What a score belongs to, one stratum of the statistics: a cell, and who works there."""

    kind: Kind
    cell: str
    people: tuple[str, str] | None
    settings: tuple[tuple[str, float | None], ...]


def tasks_of(spec: Spec, kind: Kind) -> Iterator[tuple[str, Task]]:
    """The cell's label and the task, of planning or of dispatch."""
    settings: dict[str, float | None] = dict(zip(("time", "stress"), spec.weights, strict=True))
    if kind == "dispatch":
        settings["episodes"] = spec.episodes
    for label, cell in spec.cells.items():
        for people in spec.people.items() if kind == "dispatch" else [None]:
            yield label, Task(kind, cell.digest, people, tuple(settings.items()))


def asked_of(spec: Spec, kind: Kind) -> tuple[str, ...]:
    """Who is asked for, and the best rule and `random` beside them."""
    named = spec.methods if kind == "plan" else spec.policies
    return tuple(dict.fromkeys((*named, BEST_RULE, RANDOM)))


def kinds_of(spec: Spec) -> tuple[Kind, ...]:
    """Planning, dispatch, or both."""
    named: Mapping[Kind, tuple[str, ...]] = {"plan": spec.methods, "dispatch": spec.policies}
    return tuple(kind for kind, names in named.items() if names)


def job_of(spec: Spec, task: Task, who: str, seed: int, version: str | None = None) -> Job:
    """The job of this one on the task; `version` of Tandem when it is not this one's. The optimum
    of a planned cell is the same for all seeds.
    """
    settings = dict(task.settings)
    if who == OPTIMUM:
        settings["work"] = spec.optimum_work
    elif task.kind == "plan" and who not in (BEST_RULE, RANDOM):
        settings |= {"work": spec.work, "time_limit": spec.time_limit}
    elif task.kind == "dispatch":
        settings |= {"budget": spec.budget, "work": spec.work or spec.optimum_work}
    alone = who == OPTIMUM and task.kind == "plan"
    return Job(
        task.kind,
        who,
        task.cell,
        None if alone else seed,
        task.people,
        tuple(settings.items()),
        version or tandem.__version__,
        spec.learned[task.cell][seed] if who == LEARNED and task.kind == "dispatch" else None,
    )


def jobs_of(spec: Spec, version: str | None = None) -> tuple[Job, ...]:
    """All of them, in the order in which they are begun; each once."""
    found = [
        job_of(spec, task, who, seed, version)
        for kind in kinds_of(spec)
        for _, task in tasks_of(spec, kind)
        for who in (OPTIMUM, *asked_of(spec, kind))
        for seed in spec.seeds
    ]
    return tuple(dict.fromkeys(found))


def sharded(jobs: tuple[Job, ...], shard: tuple[int, int] | None) -> tuple[Job, ...]:
    """Shard `i` of `n`, counted from 1: every n-th job."""
    if shard is None:
        return jobs
    place, number = shard
    return jobs[place - 1 :: number]
