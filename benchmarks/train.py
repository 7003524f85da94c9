"""How fast a whole training is: joint steps per CPU second of ours, beside Stable-Baselines3's
MaskablePPO when it is installed.

    python benchmarks/train.py [--seeds 20] [--sb3-steps 31000]

Ours: the recipe `tandem` on the thesis's cell, factors 0, 1 and 5 times so many seeds side by side.
It also says how many of them reach a return-optimal pair with the greedy policy; the target is all
60 in under 120 CPU seconds, compiling included, and 25,000 joint steps per CPU second, compiling
left out. SB3: one MaskablePPO on the joint action of the Gymnasium face.
"""

from __future__ import annotations

import argparse
import json
import math
import platform
import time
from functools import partial
from typing import Any

from tandem.lab.kinat2023.recipe import STATION
from tandem.lab.kinat2023.runs import FACTORS, thesis_cell
from tandem.learn.training.runs import versions


def ours(seeds: int) -> dict[str, Any]:
    import jax
    import jax.numpy as jnp

    from tandem.lab.kinat2023.learn_env import StationWorld
    from tandem.lab.kinat2023.optimal import return_optimal
    from tandem.lab.kinat2023.rewards import reward_set
    from tandem.learn.ppo import play, ppo

    cell, config = thesis_cell(), STATION.config
    best = {
        factor: set(return_optimal(cell, reward_set("appendix", stress_factor=factor)).pairs)
        for factor in FACTORS
    }
    wanted = [(factor, seed) for factor in FACTORS for seed in range(seeds)]
    worlds = jax.tree.map(
        lambda *leaves: jnp.stack(leaves),
        *[StationWorld.of(cell, STATION, stress_factor=factor) for factor, _ in wanted],
    )
    keys = jnp.stack([jax.random.key(seed) for _, seed in wanted])
    updates = sum(
        math.ceil((stage.steps or 0) / (config.environments * config.horizon))
        for stage in config.stages
    )
    began = time.process_time()
    train = (
        jax.jit(jax.vmap(partial(ppo.train, config=config, updates=updates)))
        .lower(keys, worlds)
        .compile()
    )
    compiled = time.process_time()
    learners, _ = jax.block_until_ready(train(keys, worlds))
    trained = time.process_time()
    played = jax.jit(
        jax.vmap(lambda parameters, world: play.greedy(parameters, world, config, 400))
    )(learners.parameters, worlds)
    clock, stress, done = (
        jax.device_get(leaf)[:, 0]
        for leaf in (played.state.clock, played.state.stress, played.done)
    )
    missed = [
        index
        for index, (factor, _) in enumerate(wanted)
        if not done[index] or (float(clock[index]), float(stress[index])) not in best[factor]
    ]
    steps = int(jnp.sum(learners.steps))
    return {
        "trainings": len(wanted),
        "joint_steps": steps,
        "compile_cpu_s": round(compiled - began, 2),
        "train_cpu_s": round(trained - compiled, 2),
        "steps_per_cpu_s": round(steps / (trained - compiled)),
        "return_optimal": len(wanted) - len(missed),
        "missed": [
            {
                "factor": wanted[index][0],
                "seed": wanted[index][1],
                "makespan": int(clock[index]),
                "stress": float(stress[index]),
            }
            for index in missed
        ],
    }


def sb3(steps: int) -> dict[str, Any] | None:
    """None when Stable-Baselines3 is not installed."""
    try:
        from sb3_contrib import MaskablePPO
    except ImportError:
        return None
    import gymnasium
    import torch

    import tandem.envs  # noqa: F401 (registers the worlds)

    torch.set_num_threads(1)
    world = gymnasium.make("tandem/Thesis-v0", cell=thesis_cell())
    learner = MaskablePPO("MlpPolicy", world, seed=0, n_steps=512, batch_size=128)
    began = time.process_time()
    learner.learn(steps)
    spent = time.process_time() - began
    return {
        "joint_steps": learner.num_timesteps,
        "train_cpu_s": round(spent, 2),
        "steps_per_cpu_s": round(learner.num_timesteps / spent),
    }


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--sb3-steps", type=int, default=31_000)
    asked = parser.parse_args()
    document = {
        "benchmark": "train",
        "versions": versions(),
        "processor": platform.processor() or platform.machine(),
    }
    print(
        json.dumps(
            {
                **document,
                "ours": ours(asked.seeds),
                "stable_baselines3_maskable_ppo": sb3(asked.sb3_steps),
            },
            indent=1,
        )
    )


if __name__ == "__main__":
    main()
