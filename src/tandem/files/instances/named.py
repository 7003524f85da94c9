"""Benchmark instances by name.

With Tandem come the three job shops of Fisher and Thompson (ft06, ft10, ft20), whose numbers were
printed in 1963, and Taillard's eighty (ta01 to ta80), which are drawn anew from the published
seeds. All others are read from the folder that the environment variable TANDEM_BENCHMARKS names,
because their owners have not said that they may be passed on.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from functools import cache
from importlib import resources
from pathlib import Path

from tandem.cell.model import Cell
from tandem.cell.names import Known
from tandem.errors import CellError, Fault, UsageError
from tandem.files.load import load, loads

FOLDER = "TANDEM_BENCHMARKS"
"""The environment variable that names a folder of benchmark sets, each a folder of files."""
NO_INSTANCES = (".md", ".csv")
"""Endings of what else lies in such a folder; a `.csv` counts when it holds an instance."""

MODULUS, FACTOR, QUOTIENT, REST = 2_147_483_647, 16_807, 127_773, 2_836


def shipped() -> Mapping[str, str]:
    """Name -> where it comes from, of the instances that ship with Tandem."""
    return dict.fromkeys(_printed(), "Fisher and Thompson 1963") | dict.fromkeys(
        _seeds(), "Taillard 1993"
    )


def instance(name: str) -> Cell:
    """The instance of that name: shipped, or a file `NAME`, `NAME.ending` or `SET/NAME` in the
    folder of benchmark sets.

    Raises:
      UsageError: there is none, or there are several; with what to do.
      CellError: its file cannot be read, or a cell cannot hold it.
    """
    if name in _printed():
        return loads(_printed()[name], "jsp", source=name)
    if name in _seeds():
        return loads(_drawn(*_seeds()[name]), "jsp", source=name)
    root = _folder()
    found = [path for path in files_of(root) if _names(path, name)] if root else []
    if len(found) == 1:
        return load(found[0])
    if root and found:
        sets = [str(path.relative_to(root)) for path in found]
        raise UsageError(
            f"several instances are called {name!r}. Name the set too: {', '.join(sets[:8])}."
        )
    raise UsageError(_unknown(name))


def files_of(folder: Path) -> Iterator[Path]:
    """The files below a folder that are, or may be, instances: in order, tables and notes left
    out.
    """
    for path in sorted(folder.rglob("*")):
        other = path.suffix.lower() in NO_INSTANCES and not path.name.startswith("instance")
        if path.is_file() and not path.name.startswith(".") and not other:
            yield path


def _unknown(name: str) -> str:
    known = Known(shipped())
    said = (
        f"there is no instance {name!r}. With Tandem come ft06, ft10, ft20 and ta01 to ta80."
        f" {known.hint(name) if known.nearest(name) else ''}"
    ).strip()
    root = _folder()
    if root is None:
        return (
            f"{said} Others are read from the folder that the environment variable {FOLDER} names;"
            " it names none."
        )
    near = Known({path.stem for path in files_of(root)}).nearest(name)
    return f"{said} {root} holds none of that name." + (f" Did you mean {near!r}?" if near else "")


def _folder() -> Path | None:
    named = os.environ.get(FOLDER)
    if not named:
        return None
    if not Path(named).is_dir():
        message = f"{FOLDER} names this folder, but there is none. Mend the variable."
        raise CellError([Fault(message, (), named)])
    return Path(named)


def _names(path: Path, name: str) -> bool:
    parts = name.split("/")
    own = [*path.parts[-len(parts) : -1], path.name]
    return own[:-1] == parts[:-1] and parts[-1] in (path.name, path.stem)


@cache
def _printed() -> Mapping[str, str]:
    """Name -> its lines, of the instances whose numbers ship."""
    text = (resources.files("tandem.files.instances") / "fisher_thompson.txt").read_text("utf-8")
    _, *shops = text.split("instance ")
    return {shop.split(maxsplit=1)[0]: shop.split("\n", 1)[1] for shop in shops}


@cache
def _seeds() -> Mapping[str, tuple[int, int, int, int]]:
    """Name -> jobs, machines, seed of the times, seed of the machines."""
    text = (resources.files("tandem.files.instances") / "taillard_seeds.txt").read_text("utf-8")
    rows = [line.split() for line in text.splitlines() if not line.startswith("#")]
    return {
        name: (int(jobs), int(machines), int(times), int(visits))
        for name, jobs, machines, times, visits in rows
    }


def _drawn(jobs: int, machines: int, time_seed: int, machine_seed: int) -> str:
    """A job shop as Taillard draws it: times from 1 to 99, then for each job a shuffle of the
    machines. The lines of a classic job shop.
    """
    times = _Uniform(time_seed)
    table = [[times.between(1, 99) for _ in range(machines)] for _ in range(jobs)]
    places = _Uniform(machine_seed)
    lines = [f"{jobs} {machines}"]
    for row in table:
        order = list(range(machines))
        for step in range(machines):
            other = places.between(step, machines - 1)
            order[step], order[other] = order[other], order[step]
        lines.append(" ".join(f"{m} {time}" for m, time in zip(order, row, strict=True)))
    return "\n".join(lines) + "\n"


class _Uniform:
    """Whole numbers, uniform in a range: the congruential generator of Bratley, Fox and Schrage,
    as Taillard (EJOR 64, 1993, section 2) uses it.
    """

    def __init__(self, seed: int) -> None:
        self.seed = seed

    def between(self, low: int, high: int) -> int:
        """The next one, `low` and `high` among them."""
        step = self.seed // QUOTIENT
        self.seed = FACTOR * (self.seed % QUOTIENT) - step * REST
        self.seed += MODULUS * (self.seed < 0)
        return low + int(self.seed / MODULUS * (high - low + 1))
