"""What is to be swept: a YAML file, or the same keys as options.

    format: 1
    methods: [exact, best-of-n, mine.search:solve]
    policies: [fixed, replan-robust]
    cells: [thesis.yaml, ft06, folder-of-cells]
    seeds: 5
    people: [compliant, "random:0.5"]

Read as strictly as a cell: every fault is told at its place, all of them at once.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from tandem.bench.trained import LEARNED, Trained, trained
from tandem.cell.model import Cell
from tandem.cell.names import Known
from tandem.errors import CellError, Fault, TandemError, UsageError
from tandem.files import yaml_reader
from tandem.files.instances.named import files_of, instance
from tandem.files.load import load
from tandem.files.positions import Document
from tandem.plan.methods import METHODS

FORMAT = 1
LARGEST = 1_000_000
"""Characters that such a file may have."""
MOST_SEEDS = 10_000

OPTIONS = {
    "name": "--name",
    "methods": "--method",
    "policies": "--policy",
    "cells": "--cell",
    "seeds": "--seeds",
    "people": "--people",
    "episodes": "--episodes",
    "weights": "--weights",
    "work": "--work",
    "time_limit": "--time-limit",
    "optimum_work": "--optimum-work",
    "budget": "--budget",
    "learned": "--learned",
}
"""Key of a file -> the option that says the same."""


@dataclass(frozen=True)
class Spec:
    """A sweep that can be carried out.

    Attributes:
      name: its title.
      methods: of planning; each with every cell and seed.
      policies: of dispatch; each with every cell, seed and kind of people.
      cells: label -> cell.
      seeds: of whoever draws, and of the episodes.
      people: description -> a digest of the population file that it names, else empty.
      episodes: that a policy plays for one job.
      weights: per second and per unit of stress: `cost = time * makespan + stress * stress`.
      work: the limit of a method's job, CP-SAT's deterministic seconds; None where `time_limit`,
        seconds of a clock, is the limit instead.
      optimum_work: the limit for proving what each cell is held against, in the same measure.
      budget: milliseconds for each decision of a policy.
      learned: what the policy `learned` plays on each cell, with each seed.
    """

    cells: Mapping[str, Cell]
    methods: tuple[str, ...] = ()
    policies: tuple[str, ...] = ()
    seeds: tuple[int, ...] = (0, 1, 2, 3, 4)
    people: Mapping[str, str] = field(default_factory=lambda: {"compliant": ""})
    name: str = ""
    episodes: int = 200
    weights: tuple[float, float] = (1.0, 0.0)
    work: float | None = 10.0
    time_limit: float | None = None
    optimum_work: float = 60.0
    budget: float = 50.0
    learned: Trained = field(default_factory=dict)

    def to_dict(self) -> dict[str, Any]:
        """As plain values; of the cells their digests."""
        return {
            "format": FORMAT,
            "name": self.name,
            "methods": list(self.methods),
            "policies": list(self.policies),
            "cells": {label: cell.digest for label, cell in self.cells.items()},
            "seeds": list(self.seeds),
            "people": dict(self.people),
            "episodes": self.episodes,
            "weights": list(self.weights),
            "work": self.work,
            "time_limit": self.time_limit,
            "optimum_work": self.optimum_work,
            "budget": self.budget,
            "learned": {
                cell: {str(seed): list(file) for seed, file in files.items()}
                for cell, files in self.learned.items()
            },
        }


def read_spec(path: str | Path | None = None, **given: Any) -> Spec:
    """The sweep that a file describes, that the keys of such a file do, or both: a key that is
    given takes the place of the file's. Files are looked for beside the one that names them.

    Raises:
      CellError: a file is not of its form, or names what is not there; with every fault.
      UsageError: no file, and what is given does not hold.
    """
    document = None if path is None else _document(Path(path))
    data = {} if document is None else document.plain()
    if not isinstance(data, dict):
        raise CellError(
            [
                Fault(
                    "a sweep is a mapping with `cells`, and `methods` or `policies`.", (), str(path)
                )
            ]
        )
    reader = _Reader(document, data, {key: one for key, one in given.items() if one is not None})
    spec = reader.spec()
    if not reader.faults:
        return spec
    if document is not None or reader.bad_file:
        raise CellError(sorted(reader.faults, key=_line_of))
    raise UsageError("\n".join(map(str, reader.faults)))


def _line_of(fault: Fault) -> tuple[str, int]:
    """File and line, so that faults are told in the order in which they stand there."""
    file, _, rest = fault.place.partition(":")
    line = rest.partition(":")[0]
    return file, int(line) if line.isdigit() else 0


def _document(path: Path) -> Document:
    try:
        text = path.read_text("utf-8")
    except OSError as error:
        here = path.parent.glob("*.y*ml") if path.parent.is_dir() else ()
        near = Known(sorted(one.name for one in here)).nearest(path.name)
        meant = f" Did you mean {str(path.parent / near)!r}?" if near else ""
        said = f"this file cannot be read: {(error.strerror or str(error)).lower()}.{meant}"
        raise CellError([Fault(said, (), str(path))]) from error
    except UnicodeDecodeError as error:
        raise CellError([Fault("this is no UTF-8. Save the file so.", (), str(path))]) from error
    if len(text) > LARGEST:
        raise CellError([Fault("a sweep has at most a million characters.", (), str(path))])
    if not text.strip():
        said = "the file is empty. A sweep has `cells`, and `methods` or `policies`."
        raise CellError([Fault(said, (), str(path))])
    return yaml_reader.read(text, str(path))


class _Reader:
    """Makes a sweep of plain values, and collects what is wrong with them."""

    def __init__(
        self, document: Document | None, data: Mapping[str, Any], given: Mapping[str, Any]
    ) -> None:
        self.document, self.given = document, given
        self.data = {**data, **given}
        self.bad_file = False  # one that the sweep names
        self.faults: list[Fault] = [] if document is None else list(document.faults)

    def spec(self) -> Spec:
        """The sweep; of no use where there are faults."""
        for key in self.data:
            if key not in (*OPTIONS, "format"):
                known = Known((*OPTIONS, "format"))
                self.note((key,), f"there is no key {key!r}. {known.hint(key)}")
        if self.data.get("format", FORMAT) != FORMAT:
            said = f"format is {self.data['format']!r}; this version reads format {FORMAT}."
            self.note(("format",), said)
        methods = self.choices("methods", METHODS, "method", "tandem methods")
        policies = self.policies()
        cells = self.cells()
        usual = Spec(cells)
        work, time_limit = self.limits(usual)
        seeds = self.seeds(usual)
        spec = Spec(
            cells,
            methods,
            policies,
            seeds,
            self.people(cells, bool(policies), usual),
            self.title(),
            self.whole("episodes", 2, 1_000_000, usual.episodes),
            self.weights(usual),
            work,
            time_limit,
            self.positive("optimum_work", usual.optimum_work),
            self.positive("budget", usual.budget),
            self.learned(cells, policies, seeds),
        )
        if not {"methods", "policies"} & set(self.data):
            where = () if self.document else ("methods",)
            self.note(where, "name `methods` of planning, or `policies` of dispatch, or both.")
        return spec

    def note(self, path: tuple[str | int, ...], message: str) -> None:
        """A fault of the value at the path: in the file, or of the option that gives it."""
        key = path[0] if path else ""
        if path and (key in self.given or self.document is None):
            place = OPTIONS.get(str(key), str(key))
        else:
            place = "" if self.document is None else self.document.place(path).text
        self.faults.append(Fault(message, path, place))

    def texts(self, key: str) -> Iterator[tuple[tuple[str | int, ...], str]]:
        """The texts of a list, or the one that stands without, each with its path; what is no text
        or stands there twice is a fault.
        """
        value = self.data.get(key, [])
        if not isinstance(value, list | tuple):
            value = [value]
        if not value and key in self.data:
            self.note((key,), f"{key} is an empty list. Name one at least, or leave the key out.")
        seen = set[str]()
        for place, one in enumerate(value):
            path = (key, place)
            if not isinstance(one, str) or not one.strip():
                self.note(path, f"{one!r} must be text. Put it in quotes.")
            elif one.strip() in seen:
                self.note(path, f"{one.strip()!r} is named twice. Name it once.")
            else:
                seen.add(one.strip())
                yield path, one.strip()

    def choices(self, key: str, table: Mapping[str, Any], what: str, lists: str) -> tuple[str, ...]:
        """Names of a table; each is loaded, so that one that cannot be is told now."""
        found = []
        for path, name in self.texts(key):
            if name not in table:
                hint = f"{Known(table).hint(name)} `{lists}` lists them."
                self.note(path, f"there is no {what} {name!r}. {hint}")
                continue
            try:
                table[name]
            except UsageError as error:
                self.note(path, str(error))
                continue
            found.append(name)
        return tuple(found)

    def policies(self) -> tuple[str, ...]:
        if "policies" not in self.data:
            return ()
        from tandem.dispatch.deciders.table import POLICIES

        return self.choices("policies", POLICIES, "policy", "tandem policies")

    def learned(
        self, cells: Mapping[str, Cell], policies: tuple[str, ...], seeds: tuple[int, ...]
    ) -> Trained:
        """What `learned` plays: of runs, and of policies' files."""
        if LEARNED not in policies:
            if "learned" in self.data:
                self.note(("learned",), "is what the policy `learned` plays. Name that policy too.")
            return {}
        if "learned" not in self.data:
            where = () if self.document else ("learned",)
            self.note(
                where,
                "is missing: in a sweep the policy `learned` is played by what was trained on each"
                " cell. Name the folders of those runs.",
            )
            return {}
        paths = [self.beside(name, path) for path, name in self.texts("learned")]
        try:
            found, wrong = trained(paths, cells, seeds)
        except CellError as error:
            self.faults += error.faults
            self.bad_file = True
            return {}
        for sentence in wrong:
            self.note(("learned",), sentence)
        return found

    def cells(self) -> dict[str, Cell]:
        """Label -> cell: of files, all in a folder, and instances by their names."""
        if "cells" not in self.data:
            where = () if self.document else ("cells",)
            self.note(where, "name `cells`: files, folders of them, or benchmark instances.")
        found, digests = dict[str, Cell](), dict[str, str]()
        for path, name in self.texts("cells"):
            for source, read in self.sources(path, name):
                try:
                    cell = read()
                except CellError as error:
                    self.faults += error.faults
                    self.bad_file = True
                    continue
                except UsageError as error:
                    self.note(path, str(error))
                    continue
                if cell.digest in digests:
                    other = digests[cell.digest]
                    self.note(path, f"{source!r} is the same cell as {other!r}. Name it once.")
                    continue
                digests[cell.digest] = source
                stem = Path(source).stem if "." in Path(source).name else source
                found[source if stem in found else stem] = cell
        return found

    def sources(
        self, path: tuple[str | int, ...], name: str
    ) -> Iterator[tuple[str, Callable[[], Cell]]]:
        """Each cell that an entry names, as it is called, and how it is read."""
        place = self.beside(name, path)
        if place.is_dir():
            files = list(files_of(place))
            if not files:
                self.note(path, f"the folder {name!r} holds no cell.")
            for file in files:
                yield str(Path(name) / file.relative_to(place)), partial(load, file)
        elif place.exists() or place.suffix:
            yield name, partial(load, place)
        else:
            yield name, partial(instance, name)

    def beside(self, name: str, path: tuple[str | int, ...]) -> Path:
        """The file of that name: beside the file that names it, else where the command runs."""
        if self.document is None or path[0] in self.given:
            return Path(name)
        return Path(self.document.source).parent / name

    def seeds(self, usual: Spec) -> tuple[int, ...]:
        value = self.data.get("seeds", usual.seeds)
        if _is_whole(value):
            if not 1 <= value <= MOST_SEEDS:
                said = f"seeds {value}: how many, from 1 to {MOST_SEEDS:,}; or a list of them."
                self.note(("seeds",), said)
                return usual.seeds
            return tuple(range(value))
        good = isinstance(value, list | tuple) and value and all(map(_is_whole, value))
        if not good or min(value) < 0:
            said = f"seeds {value!r}: how many there are, or a list of whole numbers, 0 or more."
            self.note(("seeds",), said)
            return usual.seeds
        if len(set(value)) < len(value):
            self.note(("seeds",), f"seeds {list(value)}: one stands there twice. Name each once.")
        return tuple(value)

    def people(self, cells: Mapping[str, Cell], wanted: bool, usual: Spec) -> Mapping[str, str]:
        """Description -> digest of its population file; each is held against every cell."""
        if "people" not in self.data:
            return usual.people
        if not wanted and "policies" not in self.data:
            self.note(("people",), "people play a part beside `policies` only. Leave them out.")
            return usual.people
        from tandem.world.arrays import Names
        from tandem.world.population import crowd

        found = {}
        for path, text in self.texts("people"):
            kind, colon, file = text.partition(":")
            is_file = kind == "population"
            spec = f"population{colon}{self.beside(file, path)}" if is_file else text
            faults = list[Fault]()
            for label, cell in cells.items():
                names = Names.of(cell)
                try:
                    crowd(spec, names, names.arrays())
                except CellError as error:
                    faults += error.faults
                    self.bad_file = True
                except TandemError as error:
                    self.note(path, f"{text!r} beside {label!r}: {error}")
            self.faults += dict.fromkeys(faults)
            found[spec] = _digest_of(spec) if is_file and not faults else ""
        return found

    def title(self) -> str:
        value = self.data.get("name", "")
        if not isinstance(value, str):
            self.note(("name",), f"{value!r} must be text. Put it in quotes.")
        return str(value)

    def whole(self, key: str, least: int, most: int, usual: int) -> int:
        value = self.data.get(key, usual)
        if _is_whole(value) and least <= value <= most:
            return int(value)
        self.note((key,), f"{key} {value!r}: must be a whole number from {least} to {most:,}.")
        return usual

    def positive(self, key: str, usual: float) -> float:
        value = self.data.get(key, usual)
        if _is_number(value) and value > 0:
            return float(value)
        self.note((key,), f"{key} {value!r}: must be a number above 0.")
        return usual

    def weights(self, usual: Spec) -> tuple[float, float]:
        value = self.data.get("weights", usual.weights)
        good = isinstance(value, list | tuple) and len(value) == 2 and all(map(_is_number, value))
        if good and value[0] > 0 and value[1] >= 0:
            return float(value[0]), float(value[1])
        said = (
            f"weights {value!r}: must be two numbers, of a second (above 0, so that no cost is 0)"
            " and of a unit of stress (0 or more)."
        )
        self.note(("weights",), said)
        return usual.weights

    def limits(self, usual: Spec) -> tuple[float | None, float | None]:
        """Work and time of a method's job, of which one is None. What is given takes the place of
        a file's other one.
        """
        asked = [key for key in ("work", "time_limit") if key in self.data]
        chosen = [key for key in asked if key in self.given] or asked
        if len(chosen) > 1:
            self.note((chosen[1],), "work and time_limit exclude each other: give one of them.")
        if chosen == ["time_limit"]:
            return None, self.positive("time_limit", 60.0)
        return self.positive("work", usual.work or 10.0), None


def _is_whole(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _is_number(value: Any) -> bool:
    good = isinstance(value, int | float) and not isinstance(value, bool)
    return good and math.isfinite(value)


def _digest_of(spec: str) -> str:
    """Of the population file that a description names."""
    file = Path(spec.partition(":")[2].removesuffix(":train").removesuffix(":held_out"))
    return hashlib.sha256(file.read_bytes()).hexdigest()[:16]
