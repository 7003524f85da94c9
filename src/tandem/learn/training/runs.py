"""A run's folder: what was asked, the figures as CSV and JSONL, the newest checkpoint, the
policies, the result. Readable without us.

run.json                what was asked: cell, recipe, factor, seeds, versions
metrics.jsonl, .csv     one row per interval and seed
checkpoint.safetensors  all that is needed to go on
checkpoint-before.safetensors  the same, an interval earlier: what is left when the newest is
damaged policy-SEED.safetensors the actors, for stations without JAX result.json             the
document of `tandem train --json`
"""

from __future__ import annotations

import contextlib
import csv
import importlib.metadata
import io
import json
import math
import os
import platform
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import ConfigDict, Field

from tandem.cell.model import Cell
from tandem.errors import CellError, UsageError
from tandem.files.atomic import store
from tandem.files.validate import cell_of
from tandem.learn.forms import Form, key_of, parsed, read_document, unreadable
from tandem.learn.results import cost, paid
from tandem.learn.training.algorithms import ALGORITHMS, FORMERLY

RUNS = Path("runs")
"""Where runs are put when no folder is named."""

Loaded = TypeVar("Loaded")


class Asked(Form):
    """`run.json`: what was asked. The cell and the settings are plain data; `trainer.order_of`
    makes them what they are.
    """

    cell: dict[str, Any]
    recipe: str
    algorithm: Annotated[str, key_of([*ALGORITHMS, *FORMERLY])] = "ppo"
    settings: dict[str, Any]
    seeds: tuple[int, ...] = Field(min_length=1)
    stress_factor: float
    front_limit: float
    versions: dict[str, str] = Field(default_factory=dict)


class _Figures(Form):
    """A row of `metrics.jsonl`: whose, from when, and numbers by name."""

    model_config = ConfigDict(frozen=True, strict=True, extra="allow")
    __pydantic_extra__: dict[str, float | None]

    interval: int = Field(ge=1)
    seed: int


class _Played(Form):
    """What a player reached; None where the assembly was not finished."""

    model_config = ConfigDict(frozen=True, strict=True, extra="allow")

    makespan: float | None
    stress: float | None


class _Seed(Form):
    """The result of one seed."""

    model_config = ConfigDict(frozen=True, strict=True, extra="allow")

    seed: int
    greedy: _Played
    people_makespan: float | None = None
    people_stress: float | None = None


class _Result(Form):
    """`result.json`, as far as others rely on it."""

    model_config = ConfigDict(frozen=True, strict=True, extra="allow")

    run: str
    seeds: list[_Seed]
    interrupted: bool
    stress_factor: float = 0.0


@dataclass(frozen=True)
class RunFolder:
    """One run on disk."""

    path: Path

    @property
    def checkpoint(self) -> Path:
        """The newest checkpoint."""
        return self.path / "checkpoint.safetensors"

    @property
    def checkpoint_before(self) -> Path:
        """The one before it."""
        return self.path / "checkpoint-before.safetensors"

    def keep_checkpoint(self, save: Callable[[Path], None]) -> None:
        """Writes a new checkpoint; the newest so far becomes the one before. At every moment one of
        them is whole.
        """
        fresh = self.path / ".checkpoint-new.safetensors"
        save(fresh)
        if self.checkpoint.exists():
            os.replace(self.checkpoint, self.checkpoint_before)
        os.replace(fresh, self.checkpoint)

    def newest_checkpoint(self, load: Callable[[Path], Loaded]) -> tuple[Loaded, str]:
        """What the newest checkpoint that can be read holds, and what is to be said when it is not
        the newest of all.

        A damaged one is put aside, so that the good one is not written over by it.

        Raises CellError when none can be read; of the newest, then.
        """
        try:
            return load(self.checkpoint), ""
        except CellError as error:
            try:
                older = load(self.checkpoint_before)
            except CellError:
                raise error from None
            damaged, kept = self.path / "checkpoint-damaged.safetensors", ""
            if self.checkpoint.exists():
                os.replace(self.checkpoint, damaged)
                kept = f" What was damaged is kept as {damaged.name}."
            return (
                older,
                (
                    f"{error.faults[0]} The training goes on from {self.checkpoint_before.name}, an"
                    f" interval earlier.{kept}"
                ),
            )

    def policy(self, seed: int) -> Path:
        """The actors of one seed."""
        return self.path / f"policy-{seed}.safetensors"

    @property
    def seeds(self) -> list[int]:
        """Of the policies that are there."""
        names = (
            re.fullmatch(r"policy-(\d{1,10})", file.stem)
            for file in self.path.glob("policy-*.safetensors")
        )
        return sorted(int(name[1]) for name in names if name)

    def begin(self, asked: Mapping[str, Any]) -> None:
        """Makes the folder and writes down what was asked.

        Raises UsageError when there is a run already.
        """
        if (self.path / "run.json").exists():
            raise UsageError(
                f"{self.path}: holds a run already. Name another folder, or go on with --resume"
                f" {self.path}."
            )
        self.path.mkdir(parents=True, exist_ok=True)
        self._write("run.json", {**asked, "versions": versions()})

    def asked(self) -> Asked:
        """What was asked.

        Raises CellError when the folder holds no run that can be read; with everything that is
        wrong with it.
        """
        try:
            return read_document(self.path / "run.json", Asked)
        except OSError as error:
            raise unreadable(self.path, [f"holds no run (run.json: {error.strerror})."]) from error

    def result(self) -> dict[str, Any]:
        """The result document. Raises CellError when the training has not ended, or the document is
        damaged.
        """
        return self._result().model_dump(exclude_unset=True)

    def best_seed(self) -> int:
        """The seed of the policy that did best when the run tried what it had learned: beside its
        people where it has some, else greedily. The first that there is, while the training goes
        on.

        Raises:
          UsageError: there is no policy yet.
          CellError: the result is damaged.
        """
        if not self.seeds:
            raise UsageError(
                f"{self.path}: holds no trained policy. Train one with: tandem train CELL"
            )
        if not (self.path / "result.json").exists():
            return self.seeds[0]
        result = self._result()
        tried = {row.seed: _loss(row, result.stress_factor) for row in result.seeds}
        return min(self.seeds, key=lambda seed: (tried.get(seed, math.inf), seed))

    def chosen(self) -> str:
        """Which seed `best_seed` names, in words; empty where there is only one."""
        if len(self.seeds) < 2:
            return ""
        seed, number = self.best_seed(), len(self.seeds)
        if not (self.path / "result.json").exists():
            return f"{self.path}: seed {seed}, the first of {number}, while the training goes on."
        return f"{self.path}: seed {seed}, the best of {number} by the run's own evaluation."

    def _result(self) -> _Result:
        try:
            return read_document(self.path / "result.json", _Result)
        except OSError as error:
            what = (
                "holds a run that has not ended; go on with --resume (result.json:"
                f" {error.strerror})."
            )
            raise unreadable(self.path, [what]) from error

    def write_result(self, document: Mapping[str, Any]) -> None:
        self._write("result.json", document)

    def append(self, rows: Sequence[Mapping[str, Any]]) -> None:
        """Adds rows to both files of figures; they are on disk when this returns, but only a
        checkpoint makes them count.
        """
        file = self.path / "metrics.jsonl"
        header = not (self.path / "metrics.csv").exists()
        with open(file, "a", encoding="utf-8") as lines:
            lines.writelines(json.dumps(row) + "\n" for row in rows)
        with open(self.path / "metrics.csv", "a", encoding="utf-8", newline="") as table:
            table.write(_table(rows, header))

    def rows(self) -> list[dict[str, Any]]:
        """The figures so far; an end that was cut off by a power cut is left out.

        Raises CellError for lines before it that cannot be read; with all of them.
        """
        file = self.path / "metrics.jsonl"
        if not file.exists():
            return []
        try:
            *lines, end = file.read_bytes().split(b"\n")
        except OSError as error:
            raise unreadable(file, [f"cannot be read ({error.strerror})."]) from error
        rows: list[dict[str, Any]] = []
        faults: list[str] = []
        for number, line in enumerate(lines, 1):
            try:
                rows.append(_row(file, line))
            except CellError as error:
                faults += [f"line {number} {fault.message}" for fault in error.faults]
        if faults:
            told = [
                *faults[:MOST_LINES],
                *[f"and {len(faults) - MOST_LINES} more."] * (len(faults) > MOST_LINES),
            ]
            raise unreadable(
                file,
                [
                    *told,
                    (
                        "Take these lines out: they are figures only, and a training goes on"
                        " without them."
                    ),
                ],
            )
        with contextlib.suppress(CellError):
            rows += [_row(file, end)] if end else []
        return rows

    def figures(self) -> list[dict[str, Any]]:
        """`rows`, each with the same figures. Raises CellError for a row that has others than the
        first.
        """
        return self._alike(self.rows())

    def _alike(self, rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
        for number, row in enumerate(rows, 1):
            if differ := sorted(row.keys() ^ rows[0].keys()):
                raise unreadable(
                    self.path / "metrics.jsonl",
                    [
                        f"line {number} has not the figures of the first line; they differ in"
                        f" {', '.join(differ[:5])}."
                    ],
                )
        return rows

    def back_to(self, interval: int) -> None:
        """Forgets the figures after that interval: they will come again."""
        kept = self._alike([row for row in self.rows() if row["interval"] <= interval])
        store(self.path / "metrics.jsonl", "".join(json.dumps(row) + "\n" for row in kept))
        if kept:
            store(self.path / "metrics.csv", _table(kept, True))
        else:
            (self.path / "metrics.csv").unlink(missing_ok=True)

    def _write(self, name: str, document: Mapping[str, Any]) -> None:
        store(self.path / name, json.dumps(document, indent=1, ensure_ascii=False) + "\n")


MOST_LINES = 5
"""Damaged lines of figures, of which a message speaks."""


def _loss(row: _Seed, stress_factor: float) -> float:
    """What the seed's policy cost when it was tried; infinite where the assembly was not
    finished.
    """
    tried = (row.people_makespan, row.people_stress)
    makespan, stress = (row.greedy.makespan, row.greedy.stress) if None in tried else tried
    if makespan is None or stress is None:
        return math.inf
    return cost(makespan, stress, **paid(stress_factor))


def _row(file: Path, line: bytes) -> dict[str, Any]:
    """One line of figures. Raises CellError."""
    parsed(file, line, _Figures)
    found: dict[str, Any] = json.loads(line)
    return found


def asked_cell(run: RunFolder, asked: Asked) -> Cell:
    """The cell that a run was asked about. Raises CellError at `run.json` with everything that is
    wrong with it.
    """
    try:
        return cell_of(asked.cell)
    except CellError as error:
        raise unreadable(
            run.path / "run.json", [f"cell: {fault}" for fault in error.faults]
        ) from None


def new_folder(cell: Cell, recipe: str) -> Path:
    """A folder name under `runs/` that nothing has yet: cell, recipe, time."""
    words = "".join(letter if letter.isalnum() else "-" for letter in (cell.name or "cell").lower())
    name = (
        f"{'-'.join(filter(None, words.split('-')))[:40]}-{recipe.replace(':', '-')}"
        f"-{datetime.now():%Y%m%d-%H%M%S}"
    )
    path, number = RUNS / name, 2
    while path.exists():
        path, number = RUNS / f"{name}-{number}", number + 1
    return path


def versions() -> dict[str, str]:
    """What made the numbers: packages, Python, machine."""
    packages = {
        name: importlib.metadata.version(name)
        for name in ("tandem", "jax", "jaxlib", "optax", "numpy", "ortools")
    }
    return {
        **packages,
        "python": platform.python_version(),
        "machine": f"{platform.system()} {platform.machine()}",
    }


def _table(rows: Sequence[Mapping[str, Any]], header: bool) -> str:
    buffer = io.StringIO()
    writer = csv.DictWriter(buffer, list(rows[0]), lineterminator="\n")
    if header:
        writer.writeheader()
    writer.writerows(rows)
    return buffer.getvalue()
