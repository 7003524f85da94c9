"""Short trainings that tests of several files look at. Each is made once in a run of the suite, by
whichever worker asks first; nobody may change what lies there.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

from tests.learn import tiny

import tandem
from tandem.learn.alphazero import config as alphazero
from tandem.learn.alphazero.recipes import SearchRecipe
from tandem.learn.dqn.config import Config as DqnConfig
from tandem.learn.dqn.recipes import ValueRecipe
from tandem.learn.training import trainer

SEARCHED = SearchRecipe(
    alphazero.Config(
        alphazero.Search(simulations=12),
        iterations=14,
        games=16,
        kept=3,
        minibatch=64,
        minibatches=12,
        units=16,
    ),
    simulations=12,
    samples=4,
)
"""Learns what is best on the thesis's cell."""
SEARCHED_FACTOR = 5.0
VALUED = ValueRecipe(
    DqnConfig(640, games=8, kept=64, minibatch=8, warm_up=2, target_every=5, units=8), samples=2
)
"""Deep Q-learning for a moment: its two seeds differ, and know little."""


def with_every_interval(folder: Path, cell: tandem.Cell, **asked: Any) -> dict[str, Any]:
    """A training, beside whose folder is kept what it held after each interval."""

    def keep(progress: trainer.TrainingProgress) -> None:
        shutil.copytree(folder, held_after(folder, progress.rows[0]["interval"]))

    return trainer.train(cell, folder=folder, on_progress=keep, seeds=(3, 4), **asked)


def held_after(folder: Path, interval: int) -> Path:
    return folder.with_name(f"after-{interval}")


def _searched(folder: Path) -> dict[str, Any]:
    asked = {"recipe_name": "alphazero", "own_recipe": SEARCHED, "stress_factor": SEARCHED_FACTOR}
    return with_every_interval(folder, tandem.load(tiny.CELL), **asked)


def _valued(folder: Path) -> dict[str, Any]:
    return trainer.train(
        tandem.load(tiny.CELL),
        recipe_name="dqn",
        own_recipe=VALUED,
        stress_factor=1.0,
        seeds=(3, 4),
        folder=folder,
    )


RUNS: dict[str, Callable[[Path], dict[str, Any]]] = {
    "tiny": tiny.train,
    "alphazero": _searched,
    "dqn": _valued,
}
"""Name -> how it is trained, on the thesis's cell with the seeds 3 and 4, into the folder."""


def run_once(shared: Path, name: str) -> tuple[Path, dict[str, Any]]:
    """The folder of the run and the document that its training gave back.

    Args:
      shared: a folder that all workers of this run of the suite see, and no other run.
    """
    from filelock import FileLock  # comes with the extra tandem[learn]

    place = shared / "short-runs" / name
    place.mkdir(parents=True, exist_ok=True)
    told = place / "told.json"
    with FileLock(place / "lock"):
        if not told.exists():
            shutil.rmtree(place / "run", ignore_errors=True)  # of a worker that died at it
            document = RUNS[name](place / "run")
            told.write_text(json.dumps(document), encoding="utf-8")
    found: dict[str, Any] = json.loads(told.read_text(encoding="utf-8"))
    return place / "run", found
