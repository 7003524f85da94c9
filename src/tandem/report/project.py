"""A project folder: a cell, variants of it, and results that say which state of which cell they
belong to.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any

from tandem.cell.model import Cell
from tandem.errors import CellError, Fault, UsageError
from tandem.files.atomic import store
from tandem.files.load import dumps, load
from tandem.report.results import faults_of, is_result, patterns_of

CELL, VARIANTS, RESULTS, README = "cell.yaml", "variants", "results", "README.md"
EXAMPLE_VARIANT = "faster.yaml"
ENDINGS = (".json", ".html")
"""Results that say which cell they belong to."""
EMBEDDED = re.compile(r'<script type="application/json" id="result">(.*?)</script>', re.DOTALL)


class Freshness(StrEnum):
    """Whether a result belongs to a cell as it is now."""

    CURRENT = "current"
    STALE = "stale"
    DAMAGED = "damaged"
    UNKNOWN = "unknown"


@dataclass(frozen=True)
class Standing:
    """One file under `results`.

    Attributes:
      belongs_to: the cell file that it was made for; None when it is stale or does not say.
      schedules: how many it holds.
      faults: what breaks the cell that it belongs to; empty when it belongs to none.
      damage: what keeps it from being a result, each fault at its place.
    """

    path: Path
    state: Freshness
    belongs_to: Path | None = None
    schedules: int = 0
    faults: tuple[str, ...] = ()
    damage: tuple[Fault, ...] = ()


def lay_out(
    folder: Path, cell: Cell, *, text: str | bytes | None = None, force: bool = False
) -> tuple[Path, ...]:
    """Makes the folder of a project: the cell, a variant of it to begin with, an empty folder for
    results, and a page that says how to go on.

    Args:
      text: the cell's file as its author wrote it, to be kept with its comments; written from the
        cell when not given.
      force: replace files of these names. Results are never touched.

    Returns:
      The files written.

    Raises:
      UsageError: a file of one of these names exists already, and `force` is not set; nothing is
        written then.
      OSError: a folder or a file cannot be written.
    """
    other, sentence = example_variant(cell)
    files: dict[Path, str | bytes] = {
        folder / CELL: text if text is not None else dumps(cell),
        folder / VARIANTS / EXAMPLE_VARIANT: (
            f"# {CELL} with one thing changed: {sentence}.\n{dumps(other)}"
        ),
        folder / README: _readme(cell, sentence),
    }
    files = {path: content for path, content in files.items() if not _holds(path, content)}
    there = [str(path) for path in files if path.exists()]
    if there and not force:
        raise UsageError(
            f"{', '.join(there)}: exist{'s' * (len(there) == 1)} already. Give --force to replace,"
            " or another folder."
        )
    for place in (folder / VARIANTS, folder / RESULTS):
        place.mkdir(parents=True, exist_ok=True)
    for path, content in files.items():
        store(path, content)
    return tuple(files)


def _holds(path: Path, content: str | bytes) -> bool:
    data = content.encode() if isinstance(content, str) else content
    return path.is_file() and path.read_bytes() == data


def example_variant(cell: Cell) -> tuple[Cell, str]:
    """The cell with the longest time of any task a fifth shorter, a robot's or a machine's if there
    is one; and what that is, in words.
    """
    from tandem.explain.sensitivity import scaled

    modes = [(name, mode) for name in cell.tasks for mode in cell.modes(name)]
    task, mode = max(
        modes,
        key=lambda row: (
            len(row[1].operators) == 1 and row[1].operators[0] not in cell.humans,
            row[1].time,
        ),
    )
    found = scaled(cell, task, -0.2, mode.operators)
    then = next(way.time for way in found.modes(task) if way.operators == mode.operators)
    title = f"{cell.name}, task {task} faster" if cell.name else f"task {task} faster"
    return (
        found.replace(name=title),
        f"task {task}: {' + '.join(mode.operators)} takes {then:g} s instead of {mode.time:g} s",
    )


def _readme(cell: Cell, sentence: str) -> str:
    return f"""# {" ".join((cell.name or "Assembly cell").split())}

- `{CELL}`: operators and tasks. Edit it in any editor.
- `{VARIANTS}/`: other states of the cell, each a cell file. `{EXAMPLE_VARIANT}` is an
  example ({sentence}); copy `{CELL}` for others.
- `{RESULTS}/`: what was found. Every result says which state of which cell it belongs to.

Run these here:

```
tandem plan {CELL} -o {RESULTS}/plan.json --report {RESULTS}/plan.html
tandem compare {CELL} {VARIANTS}/{EXAMPLE_VARIANT}
tandem check .
```

The first finds the plans and writes the report; open `{RESULTS}/plan.html` in a
browser and print it. The second says what the variant would bring. The third lists each result as
current or stale: after a change of the cell, plan anew.
`tandem explain {CELL}` says why a plan is as it is.
"""


# --- results --------------------------------------------------------------------------------------


def cells_of(folder: Path) -> dict[Path, Cell]:
    """The cell of the project and its variants.

    Raises:
      CellError: there is none, or one of them is not sound; with every fault of all.
    """
    if not (folder / CELL).is_file():
        raise CellError(
            [
                Fault(
                    f"is a folder without a {CELL}. Name a cell file, or lay out a project with"
                    " `tandem init`.",
                    (),
                    str(folder),
                )
            ]
        )
    found: dict[Path, Cell] = {}
    wrong: list[Fault] = []
    for path in [
        folder / CELL,
        *sorted(
            p
            for p in (folder / VARIANTS).glob("*")
            if p.suffix.lower() in (".yaml", ".yml", ".json")
        ),
    ]:
        try:
            found[path] = load(path)
        except CellError as error:
            wrong += error.faults
    if wrong:
        raise CellError(wrong)
    return found


def standings(folder: Path, cells: Mapping[Path, Cell]) -> Iterator[Standing]:
    """Each `.json` and `.html` file under `results`, with folders in it, in order of their
    names.
    """
    homes = {cell.digest: path for path, cell in reversed(list(cells.items()))}
    for path in sorted((folder / RESULTS).rglob("*")):
        if path.suffix.lower() in ENDINGS and path.is_file():
            yield _standing(path, cells, homes)


def _standing(path: Path, cells: Mapping[Path, Cell], homes: Mapping[str, Path]) -> Standing:
    document = _document(path)
    digest = document.get("cell_digest")
    if not isinstance(digest, str):
        return Standing(path, Freshness.UNKNOWN)
    try:
        patterns = list(patterns_of(document)) if is_result(document) else []
    except CellError as error:
        damage = tuple(fault.at(str(path)) for fault in error.faults)
        return Standing(path, Freshness.DAMAGED, damage=damage)
    home = homes.get(digest)
    if home is None:
        return Standing(path, Freshness.STALE, None, len(patterns))
    found = [
        f"schedule {place}: {fault}"
        for place, pattern in enumerate(patterns, 1)
        for fault in faults_of(document, cells[home], pattern)
    ]
    return Standing(path, Freshness.CURRENT, home, len(patterns), tuple(found))


def stale_at_home(path: Path) -> bool:
    """The result lies in a project, under `results`, and was made for another state of its cell and
    of every variant.
    """
    folder = path.resolve().parent.parent
    if path.resolve().parent.name != RESULTS or not (folder / CELL).is_file():
        return False
    try:
        homes = {cell.digest for cell in cells_of(folder).values()}
    except CellError:
        return False
    digest = _document(path).get("cell_digest")
    return isinstance(digest, str) and digest not in homes


def _document(path: Path) -> dict[str, Any]:
    """The result document that a file is or, as a report, carries; empty when it holds none."""
    try:
        text = path.read_text(encoding="utf-8")
        if path.suffix.lower() == ".html":
            carried = EMBEDDED.search(text)
            text = carried[1] if carried else "{}"
        document = json.loads(text)
    except (OSError, ValueError, RecursionError):
        return {}
    return document if isinstance(document, dict) else {}
