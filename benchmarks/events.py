"""How fast the event world moves: decisions and events per second with random legal ways, by cell,
people and batch.

    python benchmarks/events.py [--cell FILE] [--seconds 2] [--batches 1 64 1024]

An event is a decision or a stretch of time that runs on. One call plays a whole batch of episodes
from their random numbers to their end; the best call counts. The last rows are the same episodes in
NumPy, one after the other, and the Gymnasium face.
"""

from __future__ import annotations

import argparse
import os
import platform
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import gymnasium
import jax
import jax.numpy as jnp
import numpy as np

import tandem.envs  # noqa: F401 (makes the environments known)
from tandem.cell.model import Cell
from tandem.files.load import load
from tandem.world.arrays import Arrays, Names, namespace
from tandem.world.episode import Shift, play_many, play_one
from tandem.world.people import Person
from tandem.world.people import crew as crew_of
from tandem.world.population import crowd
from tandem.world.randomness import OFF, Chance, Draw, Scenario, scenarios
from tandem.world.state import legal_of

ROOT = Path(__file__).resolve().parents[1]
WILD = Chance("lognormal", cv=0.2, failure_s=60.0, absence_s=60.0)
PEOPLE = {
    "compliant": OFF,
    "random:0.5": OFF,
    "random:0.5+pace:0.7..2+tiring:weak": WILD,
    "random:0.5+forgetful:0.1+refusing:0.1": WILD,
}


class Measured(NamedTuple):
    """Events per second of wall time and of CPU time (all threads), the best of the repeats."""

    wall: float
    cpu: float


def best_of(play: Callable[[], int], seconds: float) -> Measured:
    """Calls `play`, which returns how many events it made, for about so long; the quickest call
    counts.
    """
    play()
    wall = cpu = 0.0
    end = time.perf_counter() + seconds
    while time.perf_counter() < end:
        began, began_cpu = time.perf_counter(), time.process_time()
        events = play()
        wall = max(wall, events / (time.perf_counter() - began))
        cpu = max(cpu, events / max(time.process_time() - began_cpu, 1e-9))
    return Measured(wall, cpu)


def any_way(arrays: Arrays, shift: Shift) -> Any:
    """A legal way of whose turn it is that changes from decision to decision: random enough, and it
    needs no random numbers of its own.
    """
    mine = legal_of(arrays, shift.mask, shift.turn)
    xp = namespace(mine)
    rank = (shift.decisions * 7 + shift.state.clock) % xp.maximum(1, xp.sum(mine))
    return xp.argmax(xp.cumsum(mine) > rank)


def prepared(
    cell: Cell, spec: str, chance: Chance, batch: int
) -> tuple[Names, Arrays, Draw, Person]:
    names = Names.of(cell)
    people = crowd(spec, names, names.arrays())
    arrays = names.arrays(undo=chance.undo if people.makes_mistakes else None)
    return (
        names,
        arrays,
        Draw.of(names, arrays, chance),
        people.draw(np.random.default_rng(0), batch),
    )


def compiled(cell: Cell, spec: str, chance: Chance, batch: int) -> Callable[[], int]:
    """A batch of whole episodes in JAX, a new key each call."""
    _, arrays, draw, people = prepared(cell, spec, chance, batch)
    keys = iter(jax.random.split(jax.random.key(0), 100_000))
    arrays, people = jax.tree.map(jnp.asarray, (arrays, people))

    def play() -> int:
        shift = play_many(next(keys), draw, arrays, people, any_way).shift
        return int((shift.decisions + shift.events).sum())

    return play


def in_numpy(cell: Cell, spec: str, chance: Chance) -> Callable[[], int]:
    """Twenty episodes, one after the other."""
    names, arrays, draw, people = prepared(cell, spec, chance, 20)
    chances = scenarios(jax.random.key(0), draw, arrays, 20)
    ready = [
        (
            Scenario(*(part[e] for part in chances)),
            crew_of(arrays, Person(*(part[e] for part in people))),
        )
        for e in range(20)
    ]

    def play() -> int:
        return sum(
            2 * play_one(names, arrays, scenario, crew, any_way).decisions
            for scenario, crew in ready
        )  # as many stretches of time as decisions, about

    return play


def gymnasium_loop(cell: Cell, spec: str, chance: Chance) -> Callable[[], int]:
    """Our Gymnasium face in the loop that every client writes: decisions."""
    env, rng = (
        gymnasium.make("tandem/RobotBesideHuman-v0", cell=cell, person=spec, chance=chance),
        np.random.default_rng(0),
    )

    def play() -> int:
        steps = 0
        for _ in range(10):
            observation, _ = env.reset()
            ended = cut = False
            while not (ended or cut):
                observation, _, ended, cut, _ = env.step(
                    int(rng.choice(np.flatnonzero(observation["action_mask"])))
                )
                steps += 1
        return steps

    return play


def rows(
    cell: Cell, batches: list[int]
) -> Iterator[tuple[str, str, int, Callable[[], Callable[[], int]]]]:
    """How, beside whom, batch, and what makes the player."""
    for spec, chance in PEOPLE.items():
        for batch in batches:
            yield "JAX", spec, batch, partial(compiled, cell, spec, chance, batch)
    yield "NumPy", "random:0.5", 1, partial(in_numpy, cell, "random:0.5", OFF)
    yield "Gymnasium (decisions)", "random:0.5", 1, partial(gymnasium_loop, cell, "random:0.5", OFF)


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description="Events per second of the event world.")
    parser.add_argument("--cell", type=Path, default=ROOT / "examples" / "thesis.yaml")
    parser.add_argument("--seconds", type=float, default=2.0, help="how long each row is measured")
    parser.add_argument("--batches", type=int, nargs="+", default=[1, 64, 1024])
    given = parser.parse_args()
    cell, device = load(given.cell), jax.devices()[0]
    print(
        f"{cell.name}; {len(os.sched_getaffinity(0))} cores, load {os.getloadavg()[0]:.1f};"
        f" {device.platform} {device.device_kind}; ",
        end="",
    )
    print(f"JAX {jax.__version__}, NumPy {np.__version__}, Python {platform.python_version()}")
    print(f"{'':24}{'people':42}{'batch':>6}{'events/s':>14}{'per CPU s':>14}")
    for how, spec, batch, make in rows(cell, given.batches):
        found = best_of(make(), given.seconds)
        print(f"{how:24}{spec:42}{batch:>6}{found.wall:>14,.0f}{found.cpu:>14,.0f}", flush=True)


if __name__ == "__main__":
    main()
