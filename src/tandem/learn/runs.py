"""A run's folder: what was asked, the figures as CSV and JSONL, the newest checkpoint, the policies, the result. Readable without us.

run.json                what was asked: cell, recipe, factor, seeds, versions
metrics.jsonl, .csv     one row per interval and seed
checkpoint.safetensors  all that is needed to go on
policy-SEED.safetensors the actors, for stations without JAX
result.json             the document of `tandem train --json`
"""

from __future__ import annotations

import csv
import importlib.metadata
import io
import json
import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

from tandem.cell.model import Cell
from tandem.cell.storing import store
from tandem.errors import CellError, Fault, UsageError

RUNS = Path("runs")
"""Where runs are put when no folder is named."""


@dataclass(frozen=True)
class RunFolder:
    """One run on disk."""

    path: Path

    @property
    def checkpoint(self) -> Path:
        """The newest checkpoint."""
        return self.path / "checkpoint.safetensors"

    def policy(self, seed: int) -> Path:
        """The actors of one seed."""
        return self.path / f"policy-{seed}.safetensors"

    @property
    def seeds(self) -> list[int]:
        """Of the policies that are there."""
        return sorted(int(file.stem.removeprefix("policy-")) for file in self.path.glob("policy-*.safetensors"))

    def begin(self, asked: Mapping[str, Any]) -> None:
        """Makes the folder and writes down what was asked.

        Raises UsageError when there is a run already.
        """
        if (self.path / "run.json").exists():
            raise UsageError(f"{self.path}: holds a run already. Name another folder, or go on with --resume {self.path}.")
        self.path.mkdir(parents=True, exist_ok=True)
        self._write("run.json", {**asked, "versions": versions()})

    def asked(self) -> dict[str, Any]:
        """What was asked.

        Raises CellError when the folder holds no run that can be read.
        """
        return self._read("run.json")

    def result(self) -> dict[str, Any]:
        """The result document. Raises CellError when the training has not ended."""
        return self._read("result.json")

    def write_result(self, document: Mapping[str, Any]) -> None:
        self._write("result.json", document)

    def append(self, rows: Sequence[Mapping[str, Any]]) -> None:
        """Adds rows to both files of figures; they are on disk when this returns, but only a checkpoint makes them count."""
        file = self.path / "metrics.jsonl"
        header = not (self.path / "metrics.csv").exists()
        with open(file, "a", encoding="utf-8") as lines:
            lines.writelines(json.dumps(row) + "\n" for row in rows)
        with open(self.path / "metrics.csv", "a", encoding="utf-8", newline="") as table:
            table.write(_table(rows, header))

    def rows(self) -> list[dict[str, Any]]:
        """The figures so far; a last line that was cut off by a power cut is left out."""
        file = self.path / "metrics.jsonl"
        rows = []
        for line in file.read_text(encoding="utf-8").splitlines() if file.exists() else ():
            try:
                rows.append(json.loads(line))
            except ValueError:
                break
        return rows

    def back_to(self, interval: int) -> None:
        """Forgets the figures after that interval: they will come again."""
        kept = [row for row in self.rows() if row["interval"] <= interval]
        store(self.path / "metrics.jsonl", "".join(json.dumps(row) + "\n" for row in kept))
        if kept:
            store(self.path / "metrics.csv", _table(kept, True))
        else:
            (self.path / "metrics.csv").unlink(missing_ok=True)

    def _write(self, name: str, document: Mapping[str, Any]) -> None:
        store(self.path / name, json.dumps(document, indent=1, ensure_ascii=False) + "\n")

    def _read(self, name: str) -> dict[str, Any]:
        try:
            document: dict[str, Any] = json.loads((self.path / name).read_text(encoding="utf-8"))
        except OSError as error:
            what = "holds no run" if name == "run.json" else "holds a run that has not ended; go on with --resume"
            raise CellError([Fault(f"{what} ({name}: {error.strerror}).", (), str(self.path))]) from error
        except ValueError as error:
            raise CellError([Fault(f"{name} cannot be read: {error}.", (), str(self.path))]) from error
        return document


def new_folder(cell: Cell, recipe: str) -> Path:
    """A folder name under `runs/` that nothing has yet: cell, recipe, time."""
    words = "".join(letter if letter.isalnum() else "-" for letter in (cell.name or "cell").lower())
    name = f"{'-'.join(filter(None, words.split('-')))[:40]}-{recipe}-{datetime.now():%Y%m%d-%H%M%S}"
    path, number = RUNS / name, 2
    while path.exists():
        path, number = RUNS / f"{name}-{number}", number + 1
    return path


def versions() -> dict[str, str]:
    """What made the numbers: packages, Python, machine."""
    packages = {name: importlib.metadata.version(name) for name in ("tandem", "jax", "jaxlib", "optax", "numpy", "ortools")}
    return {**packages, "python": platform.python_version(), "machine": f"{platform.system()} {platform.machine()}"}


def _table(rows: Sequence[Mapping[str, Any]], header: bool) -> str:
    buffer = io.StringIO()
    writer = csv.DictWriter(buffer, list(rows[0]), lineterminator="\n")
    if header:
        writer.writeheader()
    writer.writerows(rows)
    return buffer.getvalue()
