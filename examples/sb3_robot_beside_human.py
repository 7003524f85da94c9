"""MaskablePPO of sb3-contrib learns to work beside a person as any client would: `gymnasium.make`,
masks, `learn`, `predict`.

    pip install 'tandem[sb3]'
    python examples/sb3_robot_beside_human.py CELL.yaml [--person random:0.5] [--steps 40000]
        [--episodes 200] [--seed 0]

Trains beside the person, then plays so many further episodes with the greedy policy and as many
with random legal actions, on the same seeds.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import gymnasium
import numpy as np

import tandem.envs  # makes "tandem/RobotBesideHuman-v0" known


@dataclass(frozen=True)
class Learned:
    """Mean makespan (s) of the greedy policy and of random legal actions on the same episodes;
    steps, seconds and CPU seconds of the training.
    """

    makespan: float
    random: float
    steps: int
    wall_s: float
    cpu_s: float


def learn(
    cell: object,
    *,
    person: str = "random:0.5",
    steps: int = 40_000,
    episodes: int = 200,
    seed: int = 0,
) -> Learned:
    """Trains beside the person for so many steps, then measures."""
    import torch
    from sb3_contrib import MaskablePPO

    torch.set_num_threads(1)  # the networks are small: more threads wait for each other
    began, began_cpu = time.perf_counter(), time.process_time()
    model = MaskablePPO(
        "MultiInputPolicy",
        gymnasium.make("tandem/RobotBesideHuman-v0", cell=cell, person=person),
        n_steps=1024,
        batch_size=128,
        n_epochs=4,
        gamma=1.0,
        ent_coef=0.01,
        learning_rate=1e-3,
        seed=seed,
        device="cpu",
    )
    model.learn(steps)
    wall_s, cpu_s = time.perf_counter() - began, time.process_time() - began_cpu
    arena, rng = (
        gymnasium.make("tandem/RobotBesideHuman-v0", cell=cell, person=person),
        np.random.default_rng(seed),
    )
    greedy = mean_makespan(
        arena,
        lambda seen: int(
            model.predict(seen, deterministic=True, action_masks=seen["action_mask"])[0]
        ),
        episodes,
    )
    random = mean_makespan(
        arena, lambda seen: int(rng.choice(np.flatnonzero(seen["action_mask"]))), episodes
    )
    return Learned(greedy, random, model.num_timesteps, wall_s, cpu_s)


def mean_makespan(
    env: gymnasium.Env, act: Callable[[dict[str, np.ndarray]], int], episodes: int
) -> float:
    """Seconds, over the episodes of the seeds 1,000,000, 1,000,001, ...: the same people and the
    same chance for everybody.
    """
    total = 0.0
    for episode in range(episodes):
        observation, info = env.reset(seed=1_000_000 + episode)
        ended = cut = False
        while not (ended or cut):
            observation, _, ended, cut, info = env.step(act(observation))
        total += info["makespan"]
    return total / episodes


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description="MaskablePPO beside a person.")
    parser.add_argument("cell", type=Path)
    parser.add_argument("--person", default="random:0.5")
    parser.add_argument("--steps", type=int, default=40_000)
    parser.add_argument("--episodes", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    found = learn(
        tandem.load(given.cell),
        person=given.person,
        steps=given.steps,
        episodes=given.episodes,
        seed=given.seed,
    )
    sys.stdout.write(
        f"beside {given.person}: mean makespan {found.makespan:.3f} s, random legal actions"
        f" {found.random:.3f} s ({given.episodes} episodes) after {found.steps:,} steps,"
        f" {found.wall_s:.1f} s, {found.cpu_s:.1f} CPU s\n"
    )


if __name__ == "__main__":
    main()
