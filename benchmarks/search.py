"""How many simulations a second a search makes on the desk, beside the same search in plain Python;
and how long one decision takes.

    python benchmarks/search.py [--seconds 3] [--batches 1 64 256]

One table, one run, one machine. All play whole games on the height-adjustable desk (Yu, Huang and
Chang 2020): 53 pieces, 30 simulations for each decision. "Yu 2020" is their search and networks;
the peer is `tests/lab/yu2020/plain_yu.py`, held against it by a test. Weights are untrained.
"""

from __future__ import annotations

import argparse
import os
import platform
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jax
import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from tests.lab.yu2020.plain_yu import PlainGame, PlainSearch  # noqa: E402

from tandem.lab import yu2020  # noqa: E402
from tandem.lab.yu2020.board import desk  # noqa: E402
from tandem.lab.yu2020.board_training import decide_ms, untrained  # noqa: E402
from tandem.lab.yu2020.config import YuConfig, YuSearch  # noqa: E402
from tandem.lab.yu2020.learn_env import BoardGame  # noqa: E402
from tandem.learn.alphazero.config import Config, Search  # noqa: E402
from tandem.learn.alphazero.selfplay import Looking, find  # noqa: E402
from tandem.learn.alphazero.trained import Trained  # noqa: E402
from tandem.learn.env import many  # noqa: E402

SIMULATIONS = 30


def best_of(play: Callable[[], int], seconds: float) -> tuple[float, float]:
    """Simulations per second of wall and of CPU time: `play` is called for about so long, and the
    quickest call counts.
    """
    play()
    wall = cpu = 0.0
    end = time.perf_counter() + seconds
    while time.perf_counter() < end:
        began, began_cpu = time.perf_counter(), time.process_time()
        made = play()
        wall = max(wall, made / (time.perf_counter() - began))
        cpu = max(cpu, made / max(time.process_time() - began_cpu, 1e-9))
    return wall, cpu


def plain(trained: Trained, config: YuSearch) -> Callable[[], int]:
    """Plain Python: some decisions from the start of the game on."""
    game = PlainGame(desk())
    search = PlainSearch(game, trained.parameters, (110.0, 90.0), config)
    decisions = 3

    def play() -> int:
        at = game.start()
        for _ in range(decisions):
            visits, _ = search.visits(at)
            at = game.step(at, max(visits, key=lambda column: visits[column]))
        return decisions * config.simulations

    return play


def batched(trained: Trained, looking: Looking, batch: int) -> Callable[[], int]:
    """Ours: a decision of so many games at once, then the next one, from the start of the games
    on.
    """
    game = BoardGame.of(desk(), sees="board" if isinstance(looking, YuSearch) else "features")
    games, decisions = many(game, batch), 3
    first = jax.tree.map(
        lambda leaf: np.repeat(np.asarray(leaf)[None], batch, 0), yu2020.reset(game.layout)
    )

    @jax.jit
    def decided(key: Any, games: BoardGame, states: Any) -> Any:
        found = find(key, trained.network, trained.parameters, games, states, looking)
        return jax.vmap(yu2020.step)(games.layout, states, found.move)

    def play() -> int:
        states = first
        for number in range(decisions):
            states = decided(jax.random.key(number), games, states)
        jax.block_until_ready(states)
        return decisions * batch * looking.simulations

    return play


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(
        description="Simulations a second, and milliseconds a decision, on the desk."
    )
    parser.add_argument("--seconds", type=float, default=3.0, help="how long each row is measured")
    parser.add_argument("--batches", type=int, nargs="+", default=[1, 64, 256])
    given = parser.parse_args()
    device = jax.devices()[0]
    print(
        f"{desk().name}; {SIMULATIONS} simulations; {len(os.sched_getaffinity(0))} cores, load"
        f" {os.getloadavg()[0]:.1f}; ",
        end="",
    )
    print(f"{device.platform}; ", end="")
    print(f"JAX {jax.__version__}, NumPy {np.__version__}, Python {platform.python_version()}")
    print(f"{'':34}{'games':>6}{'sims/s':>12}{'per CPU s':>12}{'x plain':>9}")
    theirs, ours = untrained(YuConfig(), desk(), seed=0), untrained(Config(), desk(), seed=0)
    base = best_of(plain(theirs, YuSearch(SIMULATIONS)), given.seconds)
    print(f"{'Yu 2020, plain Python':34}{1:>6}{base[0]:>12,.0f}{base[1]:>12,.0f}{1:>9}", flush=True)
    kinds: list[tuple[str, Trained, Looking]] = [
        ("Yu 2020, batched", theirs, YuSearch(SIMULATIONS)),
        ("Gumbel, our network", ours, Search(simulations=SIMULATIONS, gumbel_scale=0.0)),
        (
            "PUCT, our network",
            ours,
            Search("puct", simulations=SIMULATIONS, noise=0.0, temperature=0.0),
        ),
    ]
    for name, trained, looking in kinds:
        for batch in given.batches:
            wall, cpu = best_of(batched(trained, looking, batch), given.seconds)
            print(
                f"{name:34}{batch:>6}{wall:>12,.0f}{cpu:>12,.0f}{cpu / base[1]:>9,.0f}", flush=True
            )
    for name, trained, looking in kinds:
        print(
            f"{name}: {decide_ms(trained, desk(), looking=looking):.1f} ms a decision (median of a"
            " game, one game at a time)",
            flush=True,
        )


if __name__ == "__main__":
    main()
