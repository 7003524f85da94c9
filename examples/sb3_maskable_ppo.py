"""MaskablePPO of sb3-contrib learns the thesis's example as any client would: `gymnasium.make`,
masks, `learn`, `predict`.

    pip install 'tandem[sb3]'
    python examples/sb3_maskable_ppo.py CELL.yaml [--steps 60000] [--target 23]
        [--by ticks|decisions] [--stress-factor 0] [--seed 0]

Plays its greedy policy every 1,000 steps and stops at the first whose makespan is at most the
target.
"""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import gymnasium

import tandem.envs  # makes "tandem/Thesis-v0" known


@dataclass(frozen=True)
class Learned:
    """Makespan (s) and stress of the greedy policy; steps, seconds and CPU seconds until it played
    so; the schedule as text.
    """

    makespan: float
    stress: float
    steps: int
    wall_s: float
    cpu_s: float
    gantt: str


def learn(
    cell: object,
    *,
    by: str = "ticks",
    steps: int = 60_000,
    target: float = 0.0,
    stress_factor: float = 0.0,
    seed: int = 0,
) -> Learned:
    """Trains until the greedy policy takes at most `target` seconds, or for `steps`; returns the
    best that the greedy policy did.
    """
    import torch
    from sb3_contrib import MaskablePPO
    from stable_baselines3.common.callbacks import BaseCallback

    torch.set_num_threads(1)  # the networks are small: more threads wait for each other
    options = {
        "cell": cell,
        "by": by,
        "observation": "normalised",
        "stress_factor": stress_factor,
        "limit": 200,
    }
    arena = gymnasium.make("tandem/Thesis-v0", render_mode="ansi", **options)
    began, began_cpu, best = time.perf_counter(), time.process_time(), None

    class Watch(BaseCallback):
        def _on_step(self) -> bool:
            nonlocal best
            if self.num_timesteps % 1000 == 0:
                makespan, stress = greedy(self.model, arena)
                if best is None or makespan < best.makespan:
                    wall_s, cpu_s = time.perf_counter() - began, time.process_time() - began_cpu
                    best = Learned(
                        makespan, stress, self.num_timesteps, wall_s, cpu_s, str(arena.render())
                    )
            return best is None or best.makespan > target

    model = MaskablePPO(
        "MultiInputPolicy",
        gymnasium.make("tandem/Thesis-v0", **options),
        n_steps=1024,
        batch_size=128,
        n_epochs=4,
        gamma=1.0,
        ent_coef=0.01,
        learning_rate=1e-3,
        seed=seed,
        device="cpu",
    )
    model.learn(steps, callback=Watch())
    if best is None:
        raise SystemExit("fewer than 1,000 steps: nothing was played")
    return best


def greedy(model: object, env: gymnasium.Env) -> tuple[float, float]:
    """Makespan and stress of the policy that always takes its likeliest action; an episode that is
    cut off counts as endless.
    """
    observation, info = env.reset(seed=0)
    ended = cut = False
    while not (ended or cut):
        action, _ = model.predict(
            observation, deterministic=True, action_masks=observation["action_mask"]
        )
        observation, _, ended, cut, info = env.step(int(action))
    return (info["makespan"] if ended else float("inf")), info["stress"]


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description="MaskablePPO on the thesis's station.")
    parser.add_argument("cell", type=Path)
    parser.add_argument("--steps", type=int, default=60_000)
    parser.add_argument("--target", type=float, default=23.0)
    parser.add_argument("--by", choices=("ticks", "decisions"), default="ticks")
    parser.add_argument("--stress-factor", type=float, default=0.0)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    found = learn(
        tandem.load(given.cell),
        by=given.by,
        steps=given.steps,
        target=given.target,
        stress_factor=given.stress_factor,
        seed=given.seed,
    )
    sys.stdout.write(found.gantt)
    sys.stdout.write(
        f"makespan {found.makespan:g} s, stress {found.stress:g} after {found.steps:,} steps,"
        f" {found.wall_s:.1f} s, {found.cpu_s:.1f} CPU s\n"
    )


if __name__ == "__main__":
    main()
