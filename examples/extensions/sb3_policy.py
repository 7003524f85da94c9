"""A policy that MaskablePPO of sb3-contrib learned at the Gymnasium face, judged beside people and
run live.

    pip install 'tandem[sb3]'
    python examples/extensions/sb3_policy.py examples/thesis.yaml learned.zip
    tandem simulate examples/thesis.yaml --policy fixed,sb3_policy:make --learned learned.zip
    tandem dispatch examples/thesis.yaml --policy sb3_policy:make --learned learned.zip

In the folder of this file, or with it on PYTHONPATH. Nothing of Tandem is changed.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np

import tandem
import tandem.envs  # makes "tandem/RobotBesideHuman-v0" known
from tandem.dispatch.deciders.at_a_face import AtGymnasium, of_gymnasium
from tandem.dispatch.deciders.policy import Options
from tandem.dispatch.lookahead.objective import Objective


def learn(cell: tandem.Cell, *, person: str, steps: int, seed: int = 0) -> Any:
    """MaskablePPO after so many steps beside the person."""
    import torch
    from sb3_contrib import MaskablePPO

    torch.set_num_threads(1)  # the networks are small: more threads wait for each other
    model = MaskablePPO(
        "MultiInputPolicy",
        gymnasium.make("tandem/RobotBesideHuman-v0", cell=cell, person=person),
        n_steps=512,
        batch_size=128,
        gamma=1.0,
        learning_rate=1e-3,
        seed=seed,
        device="cpu",
    )
    return model.learn(steps)


def greedy(model: Any) -> Callable[[Mapping[str, np.ndarray]], int]:
    """What the model does when it does not draw; of any policy with SB3's `predict`."""

    def act(seen: Mapping[str, np.ndarray]) -> int:
        action, _ = model.predict(dict(seen), deterministic=True, action_masks=seen["action_mask"])
        return int(action)

    return act


def make(cell: tandem.Cell, objective: Objective, options: Options) -> AtGymnasium:
    """What `--learned FILE.zip` has learned in SB3: an example of a foreign learner."""
    from sb3_contrib import MaskablePPO

    if options.learned is None:
        raise tandem.UsageError("sb3_policy: name its file with --learned FILE.zip.")
    model = MaskablePPO.load(options.learned, device="cpu")
    return of_gymnasium(cell, greedy(model), name="sb3", objective=objective)


def main() -> None:
    """Learns, saves, and judges beside the plan."""
    parser = argparse.ArgumentParser(description="MaskablePPO, judged by Tandem.")
    parser.add_argument("cell", type=Path)
    parser.add_argument("file", type=Path, help="Of what was learned, .zip.")
    parser.add_argument("--person", default="random:0.5")
    parser.add_argument("--steps", type=int, default=20_000)
    parser.add_argument("--episodes", type=int, default=200)
    given = parser.parse_args()
    cell = tandem.load(given.cell)
    model = learn(cell, person=given.person, steps=given.steps)
    model.save(given.file)
    own = of_gymnasium(cell, greedy(model), name="sb3")
    (document,) = tandem.judge(cell, ["fixed", own], given.person, given.episodes)
    for row in document["policies"]:
        print(f"{row['policy']}: {row['makespan']['mean']} s")


if __name__ == "__main__":
    main()
