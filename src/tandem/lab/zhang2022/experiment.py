"""Zhang, Lv, Li, Bao, Liu, Liu (2022), RCIM 73, 102227: two actors and a shared critic on an
alternator-like cell, beside what is exact.

Their numbers are not public: the cell, the cost and every setting of the training are ASSUMPTIONS
(docs/zhang.md).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from tandem.cell.model import Cell
from tandem.lab.kinat2023.game import thesis_cell
from tandem.lab.records import kept_record, stored_document, write_document
from tandem.lab.systems import Features, Played
from tandem.lab.zhang2022.runs import (
    ARMS,
    FACTORS,
    QUICK,
    Arm,
    Record,
    Size,
    alternator,
    random_player,
    run,
)
from tandem.lab.zhang2022.setting import AGENTS, Duo, duo
from tandem.lab.zhang2022.summary import guides, summary, table
from tandem.lab.zhang2022.yardstick import as_stress, exact_front, matching
from tandem.learn.baseline import BestRule, best_rule

STORED = "zhang2022.json"
OTHERS: dict[str, Callable[[], Cell]] = {"thesis": thesis_cell}
"""Cells that are not the system's own, by name."""
ON_OTHERS = Arm("ours", False)
OTHER_SEEDS = 5


def reproduce(
    folder: Path,
    *,
    quick: bool = False,
    seeds: int | None = None,
    tell: Callable[[str], None] = lambda _: None,
) -> dict[str, Any]:
    """Trains, plays and returns the document, which is also written to `folder/zhang2022.json`.

    The trainings of each recipe are kept in `folder/records` when they are done; a run that was
    stopped goes on from there.

    Args:
      quick: one seed, and a twenty-fifth of the steps.
      seeds: trainings an arm and factor; 10 when absent.
    """
    plain = QUICK if quick else Size()
    size = Size(**{**vars(plain), "seeds": seeds or plain.seeds})
    cell = alternator()
    front = exact_front(cell)
    tell(
        f"exact front: {len(front)} points,"
        f" {'complete' if front.complete else 'not proven complete'}"
    )
    rows: list[Record] = []
    for recipe in dict.fromkeys(arm.recipe for arm in ARMS):
        arms = [arm for arm in ARMS if arm.recipe == recipe]
        file = folder / "records" / f"{_file(recipe)}-{size.seeds}-{size.steps}.json"
        rows += kept_record(file, partial(run, cell, arms, size, front.points, tell))
    document = assemble(
        rows,
        cell,
        front.points,
        front.complete,
        random_player(cell, FACTORS, size),
        quick=quick,
        seeds=size.seeds,
    )
    kept = [
        (name, folder / "records" / f"{_file(name)}-{size.seeds}-{size.steps}.json")
        for name in OTHERS
    ]
    document["other_cells"] = [
        kept_record(file, partial(_on, name, size, tell)) for name, file in kept
    ]
    return write_document(folder / STORED, document)


def assemble(
    rows: Sequence[Record],
    cell: Cell,
    front: Sequence[tuple[float, float]],
    complete: bool,
    chance: Sequence[Mapping[str, Any]],
    *,
    quick: bool,
    seeds: int,
) -> dict[str, Any]:
    """The document: what is exact, what a random player and the best dispatch rule do, a summary an
    arm and factor, the display, every record.
    """
    from tandem.learn.training.runs import versions

    best = {factor: matching(list(front), 1.0, factor) for factor in FACTORS}
    rules = {factor: _by_rule(cell, factor) for factor in FACTORS}
    return {
        "schema_version": 1,
        "command": "tandem reproduce zhang2022" + " --quick" * quick,
        "quick": quick,
        "seeds": list(range(seeds)),
        "versions": versions(),
        "published": "not public",
        "cell": cell.name,
        "exact_front": [list(point) for point in front],
        "exact_front_complete": complete,
        "matching": {f"{factor:g}": list(point) for factor, point in best.items()},
        "rule": {
            f"{factor:g}": {
                "rule": best.name,
                "makespan": best.result.makespan,
                "difficulty": best.result.stress,
            }
            for factor, best in rules.items()
            if best is not None
        },
        "random": {
            f"{factor:g}": dict(found) for factor, found in zip(FACTORS, chance, strict=True)
        },
        "summary": summary(
            rows, {factor: point[0] + factor * point[1] for factor, point in best.items()}
        ),
        "display": guides(cell, rows),
        "records": list(rows),
    }


def stored() -> dict[str, Any]:
    """The document of the long run that ships with the package. Raises CellError when this copy has
    none, or a damaged one.
    """
    return stored_document("zhang2022/results.json", "zhang2022")


def draw_figures(document: Mapping[str, Any], folder: Path) -> list[Path]:
    """Front, noise, recovery, curves and schedules, as SVG and PNG; returns the files."""
    from tandem.draw.saving import save
    from tandem.lab.zhang2022.figures import figures

    folder.mkdir(parents=True, exist_ok=True)
    return [
        save(figure, folder / f"{name}{form}", dpi=110)
        for name, figure in figures(document)
        for form in (".svg", ".png")
    ]


def runs_on(cell: Cell) -> Duo:
    """The cell as two agents share it. Raises CellError that names every feature that they cannot
    express.
    """
    return duo(cell)[0]


def _on(name: str, size: Size, tell: Callable[[str], None]) -> dict[str, Any]:
    """Our recipe on another cell, at a factor of 1: the exact front, and what the greedy policies
    reach.
    """
    cell = OTHERS[name]()
    front = exact_front(cell)
    small = Size(
        seeds=min(size.seeds, OTHER_SEEDS), steps=size.steps, noisy=1, changed=1, sampled=0
    )
    rows = run(cell, [ON_OTHERS], small, front.points, tell)
    return {
        "cell": name,
        "tasks": len(cell.tasks),
        "exact_front": [list(point) for point in front.points],
        "exact_front_complete": front.complete,
        "matching": list(matching(front.points, 1.0, FACTORS[0])),
        "greedy": [[row["greedy"]["makespan"], row["greedy"]["difficulty"]] for row in rows],
        "gaps": [row["greedy"]["gap"] for row in rows],
    }


def _file(name: str) -> str:
    return "-".join("".join(letter if letter.isalnum() else " " for letter in name).split())


# --- What the laboratory asks ---


def _cost(cell: Cell) -> float:
    points = exact_front(cell, time_limit=10).points
    best = matching(points, 1.0, 1.0)
    return best[0] + best[1]


def _play(cell: Cell, seed: int, deviates: float = 0.0) -> Played:
    from tandem.lab.zhang2022.play import play_on

    return play_on(cell, seed, deviates)


def _beside_a_stray(cell: Cell, seed: int) -> Played:
    """The first of a few episodes in which the human really does something else: on a small cell
    there is not always something else to do.
    """
    played = [_play(cell, 100 * seed + number, deviates=1.0) for number in range(20)]
    return next((one for one in played if one.deviations), played[0])


def _exact(document: Mapping[str, Any]) -> list[float]:
    return (
        [value for point in document["exact_front"] for value in point]
        if document["exact_front_complete"]
        else []
    )


def _trains() -> Callable[..., Any]:
    from tandem.lab.zhang2022 import ddpg

    return ddpg.train


FEATURES = Features(
    trains=_trains,
    agents=lambda: AGENTS,
    cost=_cost,
    play=_play,
    deviate=_beside_a_stray,
    exact=_exact,
)

__all__ = ["FEATURES", "assemble", "draw_figures", "reproduce", "runs_on", "stored", "table"]


def _by_rule(cell: Cell, factor: float) -> BestRule | None:
    """The rule of the least makespan + factor x difficulty."""
    return best_rule(as_stress(cell), lambda makespan, difficulty: makespan + factor * difficulty)
