"""The folder of a sweep: what was asked, the cells, and one file for each job.

    sweep.json            what is asked, and the version that asks
    cells/DIGEST.json     each cell, so that the folder explains itself
    jobs/NAME.json        a job's result, the same on every machine
    times/NAME.json       the seconds that it took on this one
    summary.*             the tables and the picture

A file is whole or not there, so a sweep may be stopped at any moment.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from pydantic import Field

from tandem.bench.jobs import Job
from tandem.bench.outcome import Answer, Record, Took
from tandem.bench.spec import Spec
from tandem.cell.model import Cell
from tandem.errors import CellError, Fault, UsageError
from tandem.files.atomic import store
from tandem.files.json_writer import to_json
from tandem.files.load import load
from tandem.learn.forms import Form, read_document, unreadable

SPEC = "sweep.json"


class _Kept(Form):
    """What `sweep.json` holds."""

    format: Literal[1]
    name: str
    methods: list[str]
    policies: list[str]
    cells: dict[str, str]
    seeds: list[int]
    people: dict[str, str]
    episodes: int
    weights: list[float]
    work: float | None
    time_limit: float | None
    optimum_work: float
    budget: float
    learned: dict[str, dict[str, tuple[str, str]]] = Field(default_factory=dict)
    version: str


@dataclass(frozen=True)
class SweepFolder:
    """One of them, which need not exist yet."""

    path: Path

    @property
    def name(self) -> str:
        """What tables call it."""
        return self.path.resolve().name

    def begin(self, spec: Spec) -> None:
        """Writes down what is asked. Raises UsageError for a folder that holds something else."""
        if self.path.is_file() or (
            self.path.is_dir() and any(self.path.iterdir()) and not (self.path / SPEC).is_file()
        ):
            raise UsageError(
                f"{self.path}: is there already, and holds no sweep. Name another folder with -o."
            )
        for part in ("cells", "jobs", "times"):
            (self.path / part).mkdir(parents=True, exist_ok=True)
        for cell in spec.cells.values():
            store(self.path / "cells" / f"{cell.digest}.json", to_json(cell))
        from tandem import __version__

        store(self.path / SPEC, _text({**spec.to_dict(), "version": __version__}))

    def spec(self) -> tuple[Spec, str]:
        """What was asked last, and by which version. Raises CellError where the folder is none of
        a sweep, or damaged.
        """
        file = self.path / SPEC
        if not file.is_file():
            said = f"this is no folder of a sweep: it has no {SPEC}. `tandem bench` makes them."
            raise CellError([Fault(said, (), str(self.path))])
        kept = read_document(file, _Kept).model_dump()
        cells, faults = dict[str, Cell](), list[Fault]()
        for label, digest in kept["cells"].items():
            try:
                cells[label] = load(self.path / "cells" / f"{digest}.json")
            except CellError as error:
                faults += error.faults
        if faults:
            raise CellError(faults)
        version, _ = kept.pop("version"), kept.pop("format")
        tuples = {key: tuple(kept[key]) for key in ("methods", "policies", "seeds", "weights")}
        learned = {
            cell: {int(seed): file for seed, file in files.items()}
            for cell, files in kept["learned"].items()
        }
        return Spec(**{**kept, **tuples, "cells": cells, "learned": learned}), version

    def has(self, job: Job) -> bool:
        """Whether the job is done."""
        return self._file("jobs", job).is_file()

    def keep(self, answer: Answer) -> None:
        """Writes what a job came to. The seconds go first: a job is done once its result lies
        there.
        """
        store(self._file("times", answer.job), _text(answer.took.model_dump()))
        store(self._file("jobs", answer.job), _text(answer.record.model_dump()))

    def records(self, jobs: Iterable[Job]) -> dict[Job, Record]:
        """Of those jobs that are done. Raises CellError for files that are damaged or were changed,
        all of them at once.
        """
        found, faults = dict[Job, Record](), list[Fault]()
        for job in jobs:
            if not self.has(job):
                continue
            file = self._file("jobs", job)
            try:
                record = read_document(file, Record)
                if record.job != json.loads(json.dumps(job.to_dict())):
                    raise unreadable(file, ["is the result of another job."])
            except CellError as error:
                remedy = "Delete the file: the next call does this job again."
                faults += [Fault(f"{one.message} {remedy}", (), one.place) for one in error.faults]
                continue
            found[job] = record
        if faults:
            raise CellError(faults)
        return found

    def times(self, jobs: Iterable[Job]) -> dict[Job, Took]:
        """Of those jobs whose seconds are there; what is damaged of them is left out."""
        found = dict[Job, Took]()
        for job in jobs:
            try:
                found[job] = read_document(self._file("times", job), Took)
            except (OSError, CellError):
                continue
        return found

    def write(self, name: str, content: str | bytes) -> None:
        """A file beside the results."""
        store(self.path / name, content)

    def _file(self, part: str, job: Job) -> Path:
        return self.path / part / f"{job.name}.json"


def digest_of(spec: Spec, version: str) -> str:
    """Sweeps of one digest ask for the same, of the same version."""
    text = json.dumps([spec.to_dict(), version], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def _text(document: Mapping[str, Any]) -> str:
    return json.dumps(document, indent=1, ensure_ascii=False) + "\n"
