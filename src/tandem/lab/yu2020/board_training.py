"""Networks for chessboards: trained on one board or many, played on any, with or without trouble,
and timed.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from tandem.errors import UsageError
from tandem.lab import yu2020
from tandem.lab.yu2020 import Fate, Layout
from tandem.lab.yu2020 import training as yu_training
from tandem.lab.yu2020.board import Board
from tandem.lab.yu2020.config import YuConfig
from tandem.lab.yu2020.learn_env import BoardGame
from tandem.lab.yu2020.network import YuNetworks
from tandem.lab.yu2020.play import play as play_one
from tandem.learn.alphazero import training
from tandem.learn.alphazero.config import Config
from tandem.learn.alphazero.network import Network, greedy_action
from tandem.learn.alphazero.selfplay import Looking, find
from tandem.learn.alphazero.trained import Trained
from tandem.learn.env import stacked

Array = Any
Anyhow = Config | YuConfig

TOGETHER = (1, 16, 128)
"""How many games are played side by side: one compiled function for each number. More of them do
not fit into the processor's caches.
"""

Point = dict[str, float]


def train(
    boards: Sequence[Board],
    config: Anyhow,
    *,
    seed: int,
    held: Sequence[Board] = (),
    looking: Looking | None = None,
    every: int = 10,
    tell: Callable[[Point], None] = lambda _: None,
) -> tuple[Trained, list[Point]]:
    """A network trained by self-play on these boards, and its curve.

    Args:
      boards: all of one height, width and number of pieces.
      config: `Config` for our network, which then plays boards of any size; `YuConfig` for the
        authors' networks, on boards of this size.
      held: boards that the network plays from time to time, alone and, where `looking` names one,
        with a search; nothing is learned from them.
      every: rounds (of `Config`) or games (of `YuConfig`) between the points of the curve.
      tell: called with each new point.

    A point has `games`, `cpu_s`, `mean_cost` (seconds, of the games of the self-play since the last
    one) and, with boards held out, `held` and `searched` (mean seconds). The same seed gives the
    same network on the same machine.

    Raises:
      UsageError: the boards are not of one size.
    """
    pool = _pool(boards, config)
    learner = _start(jax.random.key(seed), pool, config)
    began, curve, costs = time.process_time(), list[Point](), list[float]()
    last = config.games if isinstance(config, YuConfig) else config.iterations
    for number in range(1, last + 1):
        learner, report = _advance(learner, pool, config)
        costs.append(float(report.cost))
        if not report.finite:
            raise UsageError(
                f"the numbers of the training are no longer finite after round {number}; a lower"
                " learning_rate helps."
            )
        if number % every == 0 or number == last:
            point = {
                "games": int(learner.games),
                "cpu_s": round(time.process_time() - began, 1),
                "mean_cost": round(float(np.mean(costs)), 3),
            }
            if held:
                point["held"] = round(
                    float(np.mean(play(_trained(learner, config, seed), held))), 3
                )
            if held and looking is not None:
                point["searched"] = round(
                    float(np.mean(play(_trained(learner, config, seed), held, looking=looking))), 3
                )
            curve.append(point)
            costs.clear()
            tell(point)
    return _trained(learner, config, seed), curve


def untrained(config: Anyhow, board: Board, *, seed: int) -> Trained:
    """The network that `train` would begin with."""
    return _trained(_start(jax.random.key(seed), _pool([board], config), config), config, seed)


def play(
    trained: Trained,
    boards: Sequence[Board],
    *,
    looking: Looking | None = None,
    samples: int = 1,
    seed: int = 0,
    fates: Fate | None = None,
) -> NDArray[np.int64]:
    """`[B, samples]` seconds that each game on each of `B` boards takes.

    Args:
      looking: the search before each move; None for the network alone.
      samples: games on each board; they differ when the search draws, or chance does.
      fates: `[B, samples, h, w]`, what goes wrong (`chessboard.fate`). The search does not know of
        it: at each move it plans from where things really stand as if nothing went wrong any more.
    """
    found = np.zeros((len(boards), samples), np.int64)
    for size in sorted({_size(board) for board in boards}):
        places = [index for index, board in enumerate(boards) if _size(board) == size]
        rows = [(index, sample) for index in places for sample in range(samples)]
        games = {
            index: BoardGame.of(boards[index], sees=_sees(trained.network)) for index in places
        }
        together = min(number for number in TOGETHER if number >= min(len(rows), TOGETHER[-1]))
        for number, start in enumerate(range(0, len(rows), together)):
            chunk = rows[start : start + together]
            filled = chunk + chunk[:1] * (together - len(chunk))
            happens = jax.tree.map(
                lambda *leaves: np.stack(leaves),
                *(
                    _happens(games[index].layout, fates, (index, sample))
                    for index, sample in filled
                ),
            )
            key = jax.random.fold_in(jax.random.key(seed), number)
            seconds = _played(
                key,
                trained.network,
                trained.parameters,
                stacked([games[index] for index, _ in filled]),
                happens,
                looking,
            )
            for row, clock in zip(chunk, np.asarray(seconds), strict=False):
                found[row] = clock
    return found


def decider(
    trained: Trained, board: Board, *, looking: Looking | None = None, seed: int = 0
) -> Callable[[Any, Any], int]:
    """Layout, state -> column: one game at a time, as `chessboard.play.play` wants it. What draws
    draws anew at each decision.
    """
    games, key = stacked([BoardGame.of(board, sees=_sees(trained.network))]), jax.random.key(seed)

    def choose(_: Any, state: Any) -> int:
        nonlocal key
        move_key, key = jax.random.split(key)
        return int(
            _decided(
                move_key,
                trained.network,
                trained.parameters,
                games,
                jax.tree.map(lambda leaf: np.asarray(leaf)[None], state),
                looking,
            )[0]
        )

    return choose


def decide_ms(trained: Trained, board: Board, *, looking: Looking | None = None) -> float:
    """Median milliseconds of a decision in one game on the board, compiling left out."""
    choose, spent = decider(trained, board, looking=looking), list[float]()

    def timed(laid: Any, state: Any) -> int:
        began = time.perf_counter()
        column = choose(laid, state)
        spent.append(time.perf_counter() - began)
        return column

    play_one(board, timed)
    return 1000 * float(np.median(spent))


def _happens(layout: Layout, fates: Fate | None, row: tuple[int, int]) -> Fate:
    """What goes wrong in that game."""
    return (
        Fate(layout.time * 0, layout.time * 0)
        if fates is None
        else Fate(*(part[row] for part in fates))
    )


def _pool(boards: Sequence[Board], config: Anyhow) -> BoardGame:
    if len({_size(board) for board in boards}) != 1:
        raise UsageError(
            f"{len(boards)} boards to train on: give one or more, all of one height, width and"
            " number of pieces."
        )
    pool: BoardGame = stacked(
        [
            BoardGame.of(board, sees="board" if isinstance(config, YuConfig) else "features")
            for board in boards
        ]
    )
    return pool


def _size(board: Board) -> tuple[int, int, int]:
    return board.height, board.width, len(board.pieces)


def _sees(network: Network) -> Any:
    return "board" if isinstance(network, YuNetworks) else "features"


def _trained(learner: Any, config: Anyhow, seed: int) -> Trained:
    network = (
        yu_training.networks(config)
        if isinstance(config, YuConfig)
        else training.network_of(config)
    )
    return Trained(
        network,
        jax.tree.map(np.asarray, learner.parameters),
        {"config": config.to_dict(), "seed": seed, "games": int(learner.games)},
    )


# --- Compiled ---


@partial(jax.jit, static_argnames="config")
def _start(key: Array, pool: BoardGame, config: Anyhow) -> Any:
    return (
        yu_training.start(key, pool, config)
        if isinstance(config, YuConfig)
        else training.start(key, pool, config)
    )


@partial(jax.jit, static_argnames="config")
def _advance(learner: Any, pool: BoardGame, config: Anyhow) -> tuple[Any, Any]:
    return (
        yu_training.advance(learner, pool, config)
        if isinstance(config, YuConfig)
        else training.advance(learner, pool, config)
    )


@partial(jax.jit, static_argnames=("network", "looking"))
def _decided(
    key: Array,
    network: Network,
    parameters: Any,
    games: BoardGame,
    states: Any,
    looking: Looking | None,
) -> Array:
    """`[B]` int32, the column for each game."""
    if looking is None:
        return jax.vmap(lambda game, state: greedy_action(network, parameters, game, state))(
            games, states
        ).astype(jnp.int32)
    return find(key, network, parameters, games, states, looking).move


@partial(jax.jit, static_argnames=("network", "looking"))
def _played(
    key: Array,
    network: Network,
    parameters: Any,
    games: BoardGame,
    fates: Fate,
    looking: Looking | None,
) -> Array:
    """`[B]` int32 seconds."""
    step = jax.vmap(yu2020.step)

    def goes_on(carry: tuple[Any, Array]) -> Array:
        return ~jnp.all(jax.vmap(yu2020.is_over)(carry[0]))

    def move(carry: tuple[Any, Array]) -> tuple[Any, Array]:
        states, key = carry
        move_key, key = jax.random.split(key)
        return (
            step(
                games.layout,
                states,
                _decided(move_key, network, parameters, games, states, looking),
                fates,
            ),
            key,
        )

    states = jax.vmap(yu2020.reset)(games.layout)
    return jax.lax.while_loop(goes_on, move, (states, key))[0].clock
