"""Alessio, Aliev and Antonelli (2022): adversarial PPO in a grid world, beside the exact minimax
value; and the successor's claim on cells.

What is published is qualitative: the wrong terminal state that the human pursues is blocked by the
robot, and the right one is reached. Layout, rewards, networks and figures are not public; what
stands for them is in `docs/alessio.md`, marked ASSUMPTION.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from statistics import fmean
from typing import TYPE_CHECKING, Any

from tandem.cell.model import Cell
from tandem.lab.alessio2022 import cells, exact, grid_runs, results_table, robots
from tandem.lab.alessio2022.grid_runs import ADVERSARIAL, DESCRIBED, PLAIN
from tandem.lab.alessio2022.layout import Layout, layout
from tandem.lab.kinat2023.station import station, whole_ticks
from tandem.lab.kinat2023.world import Station
from tandem.lab.records import kept_record, stored_document, write_document
from tandem.lab.statistics import interval, larger, rank_sum
from tandem.learn.training.runs import versions

if TYPE_CHECKING:
    from tandem.lab.systems import Features

STORED = "alessio2022.json"
SEEDS, UPDATES = 10, 60
GRIDS: dict[str, tuple[str, ...]] = {
    "crossing": (
        PLAIN,
        "plain: human with a random goal",
        ADVERSARIAL,
        "adversarial, share 0 %",
        "adversarial, share 100 %",
        *DESCRIBED,
    ),
    "crossing-12": (),
}
"""Grid -> what is trained on it, names in `TRAININGS`. The large one has exact values only: a
training there takes three times as long.
"""
RANDOM_GRIDS, PRICED_CELLS, COVERING_SEEDS = 1000, 100, 3
QUICK_SEEDS, QUICK_UPDATES = 2, 6

Document = Mapping[str, Any]


def reproduce(
    folder: Path,
    *,
    quick: bool = False,
    seeds: int | None = None,
    tell: Callable[[str], None] = lambda _: None,
) -> dict[str, Any]:
    """Trains, judges and returns the document, which is also written to `folder/alessio2022.json`.

    Each training's records are kept in `folder/records` as they come; a run that was stopped goes
    on from there.

    Args:
      quick: two seeds, a tenth of the updates, the small grid and two trainings only, one cell.
      seeds: how many; 10 when absent.
    """
    number = seeds or (QUICK_SEEDS if quick else SEEDS)
    plan = {"crossing": (PLAIN, ADVERSARIAL)} if quick else GRIDS
    kept = _Kept(folder / "records" / f"{'quick-' * quick}{number}", tell)
    document = {
        "schema_version": 1,
        "command": (
            "tandem reproduce alessio2022"
            + " --quick" * quick
            + (f" --seeds {seeds}" if seeds else "")
        ),
        "quick": quick,
        "seeds": list(range(number)),
        "updates": QUICK_UPDATES if quick else UPDATES,
        "versions": versions(),
        "published": (
            "qualitative only: the wrong terminal state that the human pursues is blocked, the"
            " right one is reached"
        ),
        "formulations": kept.get(
            "formulations", lambda: grid_runs.formulations(40 if quick else RANDOM_GRIDS)
        ),
        "coverage": kept.get("coverage", lambda: _coverage(number, quick)),
        "cells": [
            _of_cell(cell, name, number, quick, kept)
            for name, cell in list(cells.cells().items())[: 1 if quick else None]
        ],
        "price": kept.get("price", lambda: cells.prices(9 if quick else PRICED_CELLS)),
    }
    document["grids"] = [
        _of_grid(name, list(_trained(name, trainings, number, quick, kept)), kept)
        for name, trainings in plan.items()
    ]
    return write_document(folder / STORED, document)


def stored() -> dict[str, Any]:
    """The document of the long run that ships with the package. Raises CellError when this copy has
    none, or a damaged one.
    """
    return stored_document("alessio2022/results.json", "alessio2022")


def runs_on(cell: Cell) -> Station:
    """The cell as the agents learn it: the thesis's station, by decisions.

    The grid itself is no cell; what runs on cells is the training against an adversary, and the
    exact bound.

    Raises CellError that names every feature that the station cannot express.
    """
    return station(cell, per_second=whole_ticks(cell))


def comparison(
    records: Sequence[Mapping[str, Any]], first: str, second: str, human: str
) -> dict[str, Any]:
    """Whether `first` succeeds more often than `second` against that human: means, one-sided p
    (permutation), share of pairs won (Mann-Whitney).
    """
    rates = [
        [record["success"][human] for record in records if record["training"] == name]
        for name in (first, second)
    ]
    return {
        "first": first,
        "second": second,
        "human": human,
        "means": [round(fmean(each), 4) for each in rates],
        "p": larger(*rates),
        "rank_sum": round(rank_sum(*rates), 4),
    }


def summary(records: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """A row per training: success against each human with its 95 % interval over seeds, and the
    greedy robots judged exactly.
    """
    rows = []
    for name in dict.fromkeys(record["training"] for record in records):
        own = [record for record in records if record["training"] == name]
        rates = {human: [record["success"][human] for record in own] for human in own[0]["success"]}
        sure = [
            record["greedy"]["worst"] for record in own if record["greedy"]["worst"] is not None
        ]
        nominal = [
            record["greedy"]["nominal"] for record in own if record["greedy"]["nominal"] is not None
        ]
        rows.append(
            {
                "training": name,
                "seeds": len(own),
                "success": {
                    human: {
                        "mean": round(fmean(each), 4),
                        "ci95": [round(end, 4) for end in interval(each)],
                    }
                    for human, each in rates.items()
                },
                "bounded": len(sure),
                "worst": max(sure, default=None),
                "nominal": round(fmean(nominal), 2) if nominal else None,
                "barred": sum(record["greedy"]["barred"] for record in own),
                "cpu_s": round(fmean(record["cpu_s"] for record in own), 2),
            }
        )
    return rows


def table(document: Document) -> str:
    """Published, as described, our recipe and exact, side by side, as Markdown."""
    return results_table.table(document)


def draw_figures(document: Document, folder: Path) -> list[Path]:
    """The blocked wrong terminal state, the success rates, and the price of robustness, as SVG and
    PNG; returns the files.
    """
    from tandem.draw.saving import save
    from tandem.lab.alessio2022.figures import figures

    folder.mkdir(parents=True, exist_ok=True)
    return [
        save(figure, folder / f"{name}{form}", dpi=110)
        for name, figure in figures(document)
        for form in (".svg", ".png")
    ]


# --- Parts of the document ---


def _mean(rates: Sequence[float]) -> dict[str, Any]:
    return {"mean": round(fmean(rates), 4), "ci95": [round(end, 4) for end in interval(rates)]}


class _Kept:
    """Records on disk, so that a run goes on where it was stopped."""

    def __init__(self, folder: Path, tell: Callable[[str], None]):
        self.folder, self.tell = folder, tell

    def get(self, name: str, make: Callable[[], Any]) -> Any:
        file = self.folder / (
            name.replace(":", "").replace(",", "").replace(" %", "").replace(" ", "-") + ".json"
        )

        def told() -> Any:
            self.tell(name)
            return make()

        return kept_record(file, told)


def _trained(
    grid: str, trainings: Sequence[str], number: int, quick: bool, kept: _Kept
) -> Iterator[dict[str, Any]]:
    updates, episodes = (QUICK_UPDATES, 50) if quick else (UPDATES, 200)
    for name in trainings:
        yield from kept.get(
            f"{grid} {name}",
            partial(
                grid_runs.run, name, layout(grid), range(number), updates=updates, episodes=episodes
            ),
        )


def _of_grid(name: str, records: Sequence[Mapping[str, Any]], kept: _Kept) -> dict[str, Any]:
    drawn = layout(name)
    pairs = [(PLAIN, ADVERSARIAL), DESCRIBED]
    there = {record["training"] for record in records}
    return {
        "grid": name,
        "rows": list(drawn.rows),
        "exact": kept.get(f"{name} exact", lambda: _exact(drawn)),
        "summary": summary(records),
        "tests": [
            comparison(records, adversarial, plain, "adversary")
            for plain, adversarial in pairs
            if {plain, adversarial} <= there
        ],
        "records": list(records),
    }


def _of_cell(cell: Cell, name: str, number: int, quick: bool, kept: _Kept) -> dict[str, Any]:
    learned = kept.get(
        f"cell {name}", partial(cells.compare, cell, name, seeds=number, quick=quick)
    )
    return {
        **learned,
        "untrained": kept.get(f"untrained {name}", partial(cells.untrained, cell, seeds=number)),
    }


def _coverage(number: int, quick: bool) -> list[dict[str, Any]]:
    return grid_runs.cover(
        layout("crossing"),
        range(min(number, COVERING_SEEDS)),
        updates=QUICK_UPDATES if quick else UPDATES,
    )


def _exact(drawn: Layout) -> dict[str, Any]:
    """The minimax value, the quickest robot, and the most that can be reached beside a random
    human.
    """
    best, quick = exact.minimax(drawn), grid_runs.judged(drawn, robots.quickest(drawn))
    return {
        "minimax": best.moves,
        "states": best.states,
        "line": [list(pair) for pair in best.line],
        "quickest": quick,
        "random": round(exact.chance_value(drawn), 6),
    }


def __getattr__(name: str) -> Features:
    """`FEATURES`, made when asked for: it needs what only the laboratory loads."""
    if name != "FEATURES":
        raise AttributeError(name)
    from tandem.lab.alessio2022.features import FEATURES

    return FEATURES
