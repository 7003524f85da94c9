"""1,024 copies of a cell, or of several, side by side under JAX: random legal decisions, compiled
whole. Each copy that ends begins anew by itself.

    python examples/many_copies.py examples/thesis.yaml --person random:0.5
    python examples/many_copies.py examples --steps 256

A learner of yours takes the place of `choose`.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp

from tandem.envs.functional import Functional, functional


def choose(key: Any, observation: dict[str, Any]) -> Any:
    """Any legal action, each as likely as another."""
    legal = jnp.where(observation["action_mask"] > 0, 0.0, -jnp.inf)
    return jax.random.categorical(key, legal)


def play(env: Functional, copies: int, steps: int, seed: int) -> dict[str, Any]:
    """So many steps of all copies: `[steps, copies]` each, what `step` tells of an end."""

    def one(carry: Any, key: Any) -> tuple[Any, dict[str, Any]]:
        observation, state = carry
        act, move = jax.random.split(key)
        action = jax.vmap(choose)(jax.random.split(act, copies), observation)
        keys = jax.random.split(move, copies)
        observation, state, _, done, info = jax.vmap(env.step)(keys, state, action)
        told = {name: info[name] for name in ("terminated", "makespan", "cell")}
        return (observation, state), {"done": done, **told}

    @jax.jit
    def whole(key: Any) -> dict[str, Any]:
        begin, play = jax.random.split(key)
        first = jax.vmap(env.reset)(jax.random.split(begin, copies))
        return jax.lax.scan(one, first, jax.random.split(play, steps))[1]

    return whole(jax.random.key(seed))


def main() -> None:
    """Plays, and says how long assemblies took on each cell."""
    parser = argparse.ArgumentParser(description="Many copies of a cell under JAX.")
    parser.add_argument("cell", type=Path, help="A cell file, or a folder of them.")
    parser.add_argument("--person", default="compliant")
    parser.add_argument("--copies", type=int, default=1024)
    parser.add_argument("--steps", type=int, default=128)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    env = functional(given.cell, person=given.person)
    told = play(env, given.copies, given.steps, given.seed)
    for number, cell in enumerate(env.cells):
        ended = told["terminated"] & (told["cell"] == number)
        if count := int(ended.sum()):
            mean = float(jnp.where(ended, told["makespan"], 0).sum()) / count
            print(f"{cell.name or number}: {count} assemblies, mean makespan {mean:.2f} s")


if __name__ == "__main__":
    main()
