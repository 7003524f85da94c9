"""How fast the thesis's station moves: joint steps per second with random legal actions, beside
other ways to write it and other worlds.

    python benchmarks/world.py [--cell FILE] [--seconds 2] [--batches 1 64 1024]

One table, one run, one machine. Every player draws a legal action for each agent at each step, and
a finished assembly begins again. Rows for Jumanji and JaxMARL appear when they are installed (`pip
install jumanji jaxmarl`); else the table says that they are absent.
"""

from __future__ import annotations

import argparse
import os
import platform
import random
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from tests.lab.kinat2023.thesis_port import ThesisPort  # noqa: E402

import tandem.envs  # noqa: E402
from tandem.cell.model import Cell  # noqa: E402
from tandem.files.load import load  # noqa: E402
from tandem.lab.kinat2023 import (  # noqa: E402
    HUMAN,
    after_human,
    choices,
    decide_step,
    legal,
    reset,
    reward_set,
    station,
    step,
)

INNER = 500
"""Steps in one compiled call."""


class Measured(NamedTuple):
    """Joint steps per second of wall time and of CPU time (all threads), the best of the
    repeats.
    """

    wall: float
    cpu: float


def best_of(play: Callable[[], int], seconds: float) -> Measured:
    """Calls `play`, which returns how many joint steps it made, for about so long; the quickest
    call counts.
    """
    play()
    wall = cpu = 0.0
    end = time.perf_counter() + seconds
    while time.perf_counter() < end:
        began, began_cpu = time.perf_counter(), time.process_time()
        steps = play()
        wall = max(wall, steps / (time.perf_counter() - began))
        cpu = max(cpu, steps / max(time.process_time() - began_cpu, 1e-9))
    return Measured(wall, cpu)


def picked(mask: Any, bits: Any) -> Any:
    """`[...]` int32: one of the legal actions of `mask` `[..., A]`, drawn by 16 random bits."""
    rank = (bits * jnp.sum(mask, axis=-1, dtype=jnp.int32)) >> 16
    return jnp.sum(
        jnp.cumsum(mask, axis=-1, dtype=jnp.int32) <= rank[..., None], axis=-1, dtype=jnp.int32
    )


def halves(bits: Any) -> tuple[Any, Any]:
    """32 random bits as two numbers of 16."""
    return (bits & 0xFFFF).astype(jnp.int32), (bits >> 16).astype(jnp.int32)


def tick(data: Any, paid: Any, state: Any, bits: Any) -> tuple[Any, Any]:
    """One second of the station under random legal actions."""
    state, reward, done, _ = step(
        data, paid, state, picked(legal(data, state), jnp.stack(halves(bits)))
    )
    return jax.tree.map(partial(jnp.where, done), reset(data), state), reward


def decision(data: Any, paid: Any, state: Any, bits: Any) -> tuple[Any, Any]:
    """One decision of the station under random allowed actions."""
    mask, (first, second) = choices(data, state), halves(bits)
    human = picked(mask[HUMAN], second)
    robot = picked(after_human(state, mask, human), first)
    state, reward, done, _ = decide_step(data, paid, state, jnp.stack([robot, human]))
    return jax.tree.map(partial(jnp.where, done), reset(data), state), reward


def compiled(move: Callable[..., Any], cell: Cell, batch: int) -> Callable[[], int]:
    """The station in JAX: random bits drawn once per step for the whole batch, `INNER` steps a
    call.
    """
    data, paid = station(cell), reward_set(stress_factor=1.0)
    one = jax.vmap(partial(move, data, paid))

    @jax.jit
    def run(key: Any, state: Any) -> Any:
        def body(carry: Any, key: Any) -> Any:
            state, total = carry
            state, reward = one(state, jax.random.bits(key, (batch,), jnp.uint32))
            return (state, total + reward), None

        return jax.lax.scan(body, (state, jnp.zeros((batch, 2))), jax.random.split(key, INNER))[0]

    state = jax.tree.map(
        lambda part: jnp.repeat(jnp.asarray(part)[None], batch, axis=0), reset(data)
    )
    keys = keys_from(0)

    def play() -> int:
        nonlocal state
        state, total = run(next(keys), state)
        total.block_until_ready()
        return batch * INNER

    return play


def keys_from(seed: int) -> Iterator[Any]:
    """Fresh keys, one after the other."""
    key = jax.random.key(seed)
    while True:
        key, drawn = jax.random.split(key)
        yield drawn


def numpy_port(cell: Cell) -> Callable[[], int]:
    """The literal NumPy port of the tests, with NumPy's random numbers."""
    data, rng = station(cell), np.random.default_rng(0)
    port = ThesisPort(
        data.time[0], data.time[1], data.stress, data.needs, reward_set(stress_factor=1.0)._asdict()
    )
    port.reset()

    def drawn(agent: int) -> int:
        if port.task[agent]:
            return 0
        tasks = np.flatnonzero((port.t[agent] > 0) & ~port.C.any(axis=1))
        return int(rng.choice(np.concatenate([[0], tasks + 1])))

    def play() -> int:
        for _ in range(1000):
            _, done = port.step((drawn(0), drawn(1)))
            if done:
                port.reset()
        return 1000

    return play


class Lists:
    """The same rules in plain Python, on lists and ints: what a careful programmer writes without
    any library.
    """

    def __init__(self, cell: Cell):
        data, self.pay = station(cell), reward_set(stress_factor=1.0)
        self.start = [[max(ticks - 1, 0) for ticks in row] for row in data.time.tolist()]
        self.stress = data.stress.tolist()
        self.needs = [
            sum(1 << j for j, needed in enumerate(row) if needed) for row in data.needs.tolist()
        ]
        self.reset()

    def reset(self) -> None:
        self.time, self.doing, self.ended, self.left = (
            [row[:] for row in self.start],
            [-1, -1],
            0,
            len(self.stress),
        )

    def legal(self, agent: int) -> list[int]:
        if self.doing[agent] >= 0:
            return [-1]
        ended = self.ended
        return [
            -1,
            *(
                i
                for i, ticks in enumerate(self.time[agent])
                if ticks and not self.needs[i] & ~ended
            ),
        ]

    def step(self, robot: int, human: int) -> tuple[float, float, bool]:
        pay, action, reward = self.pay, [robot, human], [self.pay.step, self.pay.step]
        needs, ended = self.needs, self.ended
        frozen = [False, False]
        for agent in (0, 1):
            named = action[agent]
            if named >= 0:
                broken = (
                    (self.doing[agent] >= 0)
                    + bool(needs[named] & ~ended)
                    + (self.time[agent][named] == 0)
                )
                if broken:
                    reward[agent] += pay.illegal * broken
                    action[agent], frozen[agent] = -1, True
            elif self.doing[agent] < 0:
                reward[agent] += pay.idle
        for agent in (0, 1):
            task = self.doing[agent]
            if task >= 0 and not frozen[agent]:
                self.time[agent][task] -= 1
                if self.time[agent][task] == 0:
                    self.doing[agent], self.ended, self.left = (
                        -1,
                        self.ended | 1 << task,
                        self.left - 1,
                    )
                    reward[agent] += pay.task_done
        if action[0] == action[1]:
            action[0] = -1
        for agent, sign in ((0, 1.0), (1, -1.0)):
            if action[agent] >= 0:
                self.doing[agent] = action[agent]
                self.time[1 - agent][action[agent]] = 0
                reward[agent] += sign * self.stress[action[agent]] * pay.stress_factor
        done = self.left == 0
        return reward[0] + pay.all_done * done, reward[1] + pay.all_done * done, done


def plain_python(cell: Cell) -> Callable[[], int]:
    """`Lists` with Python's own random numbers."""
    world, rng = Lists(cell), random.Random(0)

    def play() -> int:
        for _ in range(5000):
            robot, human = world.legal(0), world.legal(1)
            if world.step(
                robot[int(rng.random() * len(robot))], human[int(rng.random() * len(human))]
            )[2]:
                world.reset()
        return 5000

    return play


def pettingzoo_loop(cell: Cell) -> Callable[[], int]:
    """Our own PettingZoo face in the loop that every PettingZoo client writes."""
    env = tandem.envs.parallel_env("thesis", cell, stress_factor=1.0)
    observations, _ = env.reset(seed=0)

    def play() -> int:
        nonlocal observations
        for _ in range(300):
            actions = {
                agent: env.action_space(agent).sample(observations[agent]["action_mask"])
                for agent in env.agents
            }
            observations = env.step(actions)[0]
            if not env.agents:
                observations, _ = env.reset()
        return 300

    return play


def jumanji_job_shop(batch: int) -> Callable[[], int]:
    """Jumanji's JobShop, 5 jobs of up to 4 operations on 4 machines, random legal jobs on every
    machine.
    """
    from jumanji.environments.packing.job_shop import JobShop
    from jumanji.environments.packing.job_shop.generator import RandomGenerator

    env = JobShop(
        generator=RandomGenerator(num_jobs=5, num_machines=4, max_num_ops=4, max_op_duration=10)
    )

    def move(state: Any, key: Any) -> Any:
        action = jax.random.categorical(key, jnp.where(state.action_mask, 0.0, -jnp.inf))
        moved, timestep = env.step(state, action)
        fresh, _ = env.reset(key)
        return jax.tree.map(partial(jnp.where, timestep.last()), fresh, moved), timestep.reward

    return foreign(lambda key: env.reset(key)[0], move, batch)


def jaxmarl_overcooked(batch: int) -> Callable[[], int]:
    """JaxMARL's Overcooked, cramped room, two cooks with random actions (all are legal there); it
    resets itself.
    """
    from jaxmarl import make

    env = make("overcooked")

    def move(state: Any, key: Any) -> Any:
        drawn = jax.random.randint(key, (2,), 0, 6)
        _, state, reward, _, _ = env.step(
            key, state, {agent: drawn[i] for i, agent in enumerate(env.agents)}
        )
        return state, reward[env.agents[0]]

    return foreign(lambda key: env.reset(key)[1], move, batch)


def foreign(
    first: Callable[[Any], Any], move: Callable[[Any, Any], Any], batch: int
) -> Callable[[], int]:
    """Another library's world in the same scan; each takes a key per environment and step, as it is
    made.
    """
    keys = keys_from(0)
    state = jax.vmap(first)(jax.random.split(next(keys), batch))

    @jax.jit
    def run(key: Any, state: Any) -> Any:
        def body(carry: Any, key: Any) -> Any:
            state, total = carry
            state, reward = jax.vmap(move)(state, jax.random.split(key, batch))
            return (state, total + reward), None

        return jax.lax.scan(body, (state, jnp.zeros(batch)), jax.random.split(key, INNER))[0]

    def play() -> int:
        nonlocal state
        state, total = run(next(keys), state)
        total.block_until_ready()
        return batch * INNER

    return play


def rows(
    cell: Cell, batches: list[int]
) -> Iterator[tuple[str, int, Callable[[], Callable[[], int]]]]:
    """Name, batch, and what makes the player."""
    yield "literal NumPy port (tests)", 1, partial(numpy_port, cell)
    yield "plain Python, lists", 1, partial(plain_python, cell)
    yield "PettingZoo loop, our face", 1, partial(pettingzoo_loop, cell)
    for batch in batches:
        yield "tandem, ticks", batch, partial(compiled, tick, cell, batch)
    for batch in batches:
        yield "tandem, decisions", batch, partial(compiled, decision, cell, batch)
    for batch in batches:
        yield "Jumanji JobShop 5 x 4", batch, partial(jumanji_job_shop, batch)
    for batch in batches:
        yield "JaxMARL Overcooked", batch, partial(jaxmarl_overcooked, batch)


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(
        description="Joint steps per second of the thesis's station and others."
    )
    parser.add_argument("--cell", type=Path, default=ROOT / "examples" / "thesis.yaml")
    parser.add_argument("--seconds", type=float, default=2.0, help="how long each row is measured")
    parser.add_argument("--batches", type=int, nargs="+", default=[1, 64, 1024])
    given = parser.parse_args()
    cell, base = load(given.cell), None
    device = jax.devices()[0]
    print(
        f"{cell.name}; {len(os.sched_getaffinity(0))} cores, load {os.getloadavg()[0]:.1f};"
        f" {device.platform} {device.device_kind}; ",
        end="",
    )
    print(f"JAX {jax.__version__}, NumPy {np.__version__}, Python {platform.python_version()}")
    print(f"{'':28}{'batch':>6}{'steps/s':>14}{'per CPU s':>14}{'x NumPy port':>14}")
    for name, batch, make in rows(cell, given.batches):
        try:
            found = best_of(make(), given.seconds)
        except ImportError as missing:
            print(f"{name:28}{batch:>6}  absent: {missing}")
            continue
        base = base or found.wall
        speeds = f"{found.wall:>14,.0f}{found.cpu:>14,.0f}{found.wall / base:>14,.1f}"
        print(f"{name:28}{batch:>6}{speeds}", flush=True)


if __name__ == "__main__":
    main()
