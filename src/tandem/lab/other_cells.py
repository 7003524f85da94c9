"""Our recipe on cells that are not the thesis's: random ones, and human-robot case studies; greedy
result and gap to the exact optimum.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from tandem.cell.model import Cell
from tandem.files.generators import layered
from tandem.files.load import load
from tandem.lab.records import stored_document, write_document
from tandem.learn.training.runs import versions

RANDOM_TASKS, RANDOM_SEEDS = 12, (0, 1)
FACTORS = (0.0, 5.0)
SEEDS = 10
STORED = "cells.json"


def random_cells() -> dict[str, Cell]:
    """The random cells, by name."""
    return {
        f"random {RANDOM_TASKS} tasks, seed {seed}": layered(RANDOM_TASKS, seed=seed)
        for seed in RANDOM_SEEDS
    }


def fitted(cell: Cell) -> tuple[Cell, str]:
    """The cell as the thesis's station can hold it, and what was left out for that (empty when
    nothing was).
    """
    left_out = [
        name
        for name, given in (
            ("same_operator", cell.same_operator),
            ("stress_of_set", cell.stress_of_set),
        )
        if given
    ]
    return cell.replace(same_operator=(), stress_of_set=None), ", ".join(left_out)


def reproduce(
    folder: Path,
    *,
    quick: bool = False,
    seeds: int | None = None,
    cases: Sequence[Path] = (),
    tell: Callable[[str], None] = lambda _: None,
) -> dict[str, Any]:
    """The rows of `run` with what made them; also written to `folder/cells.json`. A quick run has 2
    seeds.
    """
    seeds = 2 if quick else seeds or SEEDS
    document = {
        "schema_version": 1,
        "command": " ".join(
            [
                "tandem reproduce cells",
                *["--quick"] * quick,
                *(f"--case {path.name}" for path in cases),
            ]
        ),
        "recipe": "tandem",
        "seeds": list(range(seeds)),
        "versions": versions(),
        "rows": run(cases, seeds=seeds, tell=tell),
    }
    return write_document(folder / STORED, document, indent=1)


def stored() -> dict[str, Any]:
    """The document that ships with the package: the random cells and two case studies of Pearce
    (2015).

    Raises CellError when this copy of the package has none, or a damaged one.
    """
    return stored_document("other_cells.json", "cells")


def run(
    cases: Sequence[Path] = (), *, seeds: int = SEEDS, tell: Callable[[str], None] = lambda _: None
) -> list[dict[str, Any]]:
    """One row per cell and ergonomic factor: the exact front and, over the seeds, what the greedy
    policies reach.

    Args:
      cases: files of case studies; `fitted` says what of them is left out.

    Raises:
      CellError: a case cannot be read, or holds what the station cannot.
    """
    named = [(name, cell, "") for name, cell in random_cells().items()]
    named += [(path.stem, *fitted(load(path))) for path in cases]
    rows = []
    for name, cell, left_out in named:
        has_stress = any(
            stress
            for task in cell.tasks
            for mode in cell.modes(task)
            for stress in mode.stress.values()
        )
        for factor in FACTORS if has_stress else FACTORS[:1]:
            rows.append(
                {
                    "cell": name,
                    "tasks": len(cell.tasks),
                    "left_out": left_out,
                    **_one(cell, factor, seeds),
                }
            )
            tell(line(rows[-1]))
    return rows


def table(document: Mapping[str, Any]) -> str:
    """A line per cell and factor."""
    return "\n".join(line(row) for row in document["rows"])


def draw_figures(document: Mapping[str, Any], folder: Path) -> list[Path]:
    """None: the lines say it."""
    return []


def line(row: dict[str, Any]) -> str:
    """A row for people."""
    gaps, finished = row["gaps"], [gap for gap in row["gaps"] if gap is not None]
    reached = (
        f"mean gap {row['mean_gap']:.2%}, largest {max(finished):.2%}"
        if finished
        else "none finished"
    )
    return (
        f"{row['cell']} ({row['tasks']}"
        f" tasks{', without ' + row['left_out'] if row['left_out'] else ''}), factor"
        f" {row['factor']:g}: optimal {row['optimal']} of {len(gaps)} seeds, {reached}; best of 64"
        f" optimal {row['best_of_n_optimal']} of {len(gaps)}; {row['cpu_s']:.1f} CPU s a seed"
    )


def _one(cell: Cell, factor: float, seeds: int) -> dict[str, Any]:
    from tandem.learn.training.trainer import train

    with TemporaryDirectory() as scratch:
        document = train(
            cell,
            recipe_name="station",
            stress_factor=factor,
            seeds=range(seeds),
            folder=Path(scratch) / "run",
            front_limit=120,
        )
    gaps = [seed["greedy"]["gap"] for seed in document["seeds"]]
    finished = [gap for gap in gaps if gap is not None]
    return {
        "factor": factor,
        "exact_front": document["exact_front"],
        "exact_front_complete": document["exact_front_complete"],
        "greedy": [
            [seed["greedy"]["makespan"], seed["greedy"]["stress"]] for seed in document["seeds"]
        ],
        "gaps": gaps,
        "optimal": sum(gap == 0 for gap in gaps),
        "mean_gap": round(sum(finished) / len(finished), 6) if finished else None,
        "best_of_n_optimal": sum(seed["best_of_n"]["gap"] == 0 for seed in document["seeds"]),
        "steps": document["seeds"][0]["steps"],
        "cpu_s": document["seeds"][0]["cpu_s"],
    }
