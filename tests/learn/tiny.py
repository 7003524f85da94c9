"""A training of the thesis's cell that takes a second once it is compiled; as a program it trains
into the folder it is given.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import tandem
from tandem.lab.kinat2023.recipe import StationRecipe
from tandem.learn.ppo.config import Config, Stage

CELL = Path(__file__).parents[2] / "examples" / "thesis.yaml"
INTERVALS = 12
RECIPE = StationRecipe(
    Config(
        stages=(
            Stage(steps=6 * 128, entropy=0.1, learning_rate=3e-3),
            Stage(steps=6 * 128, entropy=0.01, learning_rate=1e-3),
        ),
        environments=8,
        horizon=16,
        episode_limit=100,
        minibatch=64,
        epochs=2,
        hidden=(8,),
    ),
    pace="decisions",
    sees="normalised",
)


def train(folder: Path, **options: Any) -> dict[str, Any]:
    from tandem.learn.training import trainer

    settings = {
        "own_recipe": RECIPE,
        "stress_factor": 1.0,
        "seeds": (3, 4),
        "front_limit": 60.0,
        **options,
    }
    return trainer.train(tandem.load(CELL), folder=folder, **settings)


if __name__ == "__main__":
    train(Path(sys.argv[1]))
