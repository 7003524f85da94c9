"""Which trained policy `learned` plays on each cell and seed of a sweep."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from tandem.cell.model import Cell
from tandem.errors import CellError, UsageError

LEARNED = "learned"
"""The policy that plays what was trained."""

Trained = Mapping[str, Mapping[int, tuple[str, str]]]
"""Digest of a cell -> seed -> file of the policy, and a digest of the file."""


def trained(
    sources: Sequence[Path], cells: Mapping[str, Cell], seeds: Sequence[int]
) -> tuple[Trained, list[str]]:
    """For each cell the run that was trained on it, else the first whose policies can read it; of
    the run the policy of the seed. A policy's file serves every seed. And what is wrong.

    Raises CellError where a folder holds no run, or a file no policy.
    """
    found: dict[str, dict[int, tuple[str, str]]] = {}
    faults = list[str]()
    runs = [_Source(path) for path in sources]
    for label, cell in cells.items():
        own = [run for run in runs if run.trained_on == cell.digest]
        if len(own) > 1:
            faults.append(
                f"{own[0].path} and {own[1].path} were both trained on {label!r}. Sweep them into"
                " folders of their own; `tandem bench show` lays these over each other."
            )
        reasons = list[str]()
        fits = own[:1] or [run for run in runs if run.reads(cell, reasons)][:1]
        if not fits:
            said = f": {' '.join(reasons)}" if reasons else "."
            faults.append(f"no trained policy can play {label!r}{said}")
            continue
        missing = [seed for seed in seeds if fits[0].file(seed) is None]
        if missing:
            faults.append(
                f"{fits[0].path}: has no policy of seed {', '.join(map(str, missing))}, which the"
                f" sweep asks for; there are {', '.join(map(str, fits[0].seeds)) or 'none'}."
            )
            continue
        found[cell.digest] = dict(_files(fits[0], seeds))
    return found, faults


def digest_of_file(path: str | Path) -> str:
    """Of a policy's bytes."""
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()[:16]


class _Source:
    """A run's folder, or the file of one policy."""

    def __init__(self, path: Path) -> None:
        from tandem.learn.training.runs import RunFolder, asked_cell

        self.path, self.run = path, RunFolder(path) if path.is_dir() else None
        self.trained_on = "" if self.run is None else asked_cell(self.run, self.run.asked()).digest

    @property
    def seeds(self) -> list[int]:
        return [] if self.run is None else self.run.seeds

    def file(self, seed: int) -> Path | None:
        """The policy of that seed, if there is one."""
        if self.run is None:
            return self.path
        return self.run.policy(seed) if seed in self.run.seeds else None

    def reads(self, cell: Cell, reasons: list[str]) -> bool:
        """Whether a policy of it decides on the cell; a reason is added where it does not."""
        from tandem.learn.graph.trained import KIND, weights_of
        from tandem.learn.training.algorithms import decider_of, origin_of

        file = self.path if self.run is None else self.file((self.seeds or [0])[0])
        if file is None:
            return False
        if origin_of(file)[0] == KIND:
            weights_of(file)  # of any cell
            return True
        try:
            decider_of(file, cell)
        except CellError:
            raise
        except UsageError as error:
            reasons.append(str(error))
            return False
        return True


def _files(source: _Source, seeds: Sequence[int]) -> Iterator[tuple[int, tuple[str, str]]]:
    for seed in seeds:
        file = source.file(seed)
        assert file is not None
        yield seed, (str(file), digest_of_file(file))
