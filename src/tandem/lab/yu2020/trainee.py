"""The training of Yu, Huang and Chang (2020) as the trainer wants it: a cell that their board can
hold, figures, results, players.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from tandem.cell.model import Cell, plain
from tandem.errors import UsageError
from tandem.lab.yu2020 import board_training, training
from tandem.lab.yu2020.board import HUMAN, ROBOT, Board
from tandem.lab.yu2020.config import YuConfig, YuSearch
from tandem.lab.yu2020.learn_env import BoardGame
from tandem.lab.yu2020.network import YuNetworks
from tandem.lab.yu2020.play import play as play_one
from tandem.lab.yu2020.recipe import YuRecipe
from tandem.learn.algorithm import Row, TrainingOrder
from tandem.learn.alphazero.rollout import as_document
from tandem.learn.alphazero.selfplay import Looking
from tandem.learn.alphazero.trained import Trained
from tandem.learn.env import Game, stacked
from tandem.learn.forms import unreadable
from tandem.learn.results import Reached, paid
from tandem.schedule.model import Schedule

GAMES_BETWEEN_FIGURES = 10
MOST_SEARCHED = 16


def players(
    path: Path, cell: Cell, order: TrainingOrder, *, seed: int, episodes: int
) -> dict[str, list[Reached]]:
    """How the networks play the cell: alone, under their search, and with moves drawn by the
    visits.

    Raises:
      CellError: the board cannot hold the cell. UsageError: it makes a board of another size than
        the one that was learned on.
    """
    recipe = order.recipe
    assert isinstance(recipe, YuRecipe)
    trained, board = Trained.load(path, YuNetworks), Board.of(cell)
    trained_on = Board.of(order.cell)
    if (board.height // 4, board.width) != (trained_on.height // 4, trained_on.width):
        raise UsageError(
            f"the networks read a board of {trained_on.height} rows and {trained_on.width} columns;"
            f" this cell makes one of {board.height} and {board.width}."
        )
    assert isinstance(trained.network, YuNetworks)
    if not trained.network.reads(trained.parameters, board.height, board.width):
        raise unreadable(
            path,
            [
                f"does not fit the run: its networks read no board of {board.height} rows and"
                f" {board.width} columns."
            ],
        )

    def game(looking: Looking | None) -> Reached:
        done = play_one(board, board_training.decider(trained, board, looking=looking, seed=seed))
        return replace(_reached(done.makespan), schedule=_in_words_of(cell, done.schedule))

    games = min(episodes, MOST_SEARCHED)
    drawn = [
        _reached(seconds)
        for seconds in board_training.play(
            trained, [board], looking=drawing(recipe), samples=games, seed=seed
        )[0]
    ]
    return {
        "greedy": [game(None)],
        f"searched ({recipe.config.search.simulations})": [game(sure(recipe))],
        "sampled": drawn,
        f"best of {games}": [min(drawn, key=lambda one: one.cost)],
    }


class Trainee:
    """Their training on an order whose recipe is a `YuRecipe`.

    Raises:
      CellError: the board cannot hold the cell. UsageError: stress is to count, which their game
        does not know.
    """

    players = staticmethod(players)
    costs = staticmethod(lambda cell, order: paid(order.stress_factor))

    def __init__(self, order: TrainingOrder) -> None:
        recipe = order.recipe
        assert isinstance(recipe, YuRecipe)
        if order.stress_factor:
            raise UsageError(
                f"stress factor {order.stress_factor}: recipe {order.name!r} knows time only; leave"
                " it at 0, or take --recipe alphazero."
            )
        self.order, self.recipe = order, recipe
        self.board = Board.of(order.cell)
        self.pool = stacked([BoardGame.of(self.board, sees="board")])

    @property
    def paid(self) -> dict[str, Any]:
        return paid(0.0)

    def begin(self) -> training.Learner:
        keys = jnp.stack([jax.random.key(seed) for seed in self.order.seeds])
        return jax.jit(jax.vmap(partial(training.start, config=self.recipe.config), (0, None)))(
            keys, self.pool
        )

    def advance(self, learners: training.Learner) -> tuple[training.Learner, training.Report]:
        return jax.block_until_ready(_advance(learners, self.pool, self.recipe.config))

    def share(self, learners: training.Learner) -> float:
        return float(np.min(learners.games)) / self.recipe.config.games

    def rows(self, learners: training.Learner, report: training.Report) -> list[Row]:
        """`mean_return_team` is minus the mean seconds of the interval's games; `greedy` is what
        both networks play without a search.
        """
        found = []
        for index in range(len(self.order.seeds)):
            seed_report = jax.tree.map(lambda leaf, index=index: leaf[index], report)
            row: Row = {"episodes": int(learners.games[index]), "steps": int(learners.moves[index])}
            row |= {"mean_return_team": round(-float(np.mean(seed_report.cost)), 4)}
            row |= {
                name: round(float(getattr(seed_report, name)[-1]), 5)
                for name in ("policy_loss", "value_loss")
            }
            reached = _reached(
                board_training.play(self._trained(learners, index), [self.board])[0, 0]
            )
            found.append(
                row | {f"greedy_{name}": value for name, value in as_document(reached).items()}
            )
        return found

    def play(self, learners: training.Learner) -> list[Row]:
        """`greedy`: the networks alone. `searched`: their search for both agents. `best_of_n`:
        moves drawn by the visits, the best of n games.
        """
        rows = []
        for index, seed in enumerate(self.order.seeds):
            trained = self._trained(learners, index)
            row: Row = {
                "steps": int(learners.moves[index]),
                "greedy": as_document(_reached(board_training.play(trained, [self.board])[0, 0])),
            }
            row["searched"] = as_document(
                _reached(
                    board_training.play(trained, [self.board], looking=sure(self.recipe))[0, 0]
                )
            )
            drawn = board_training.play(
                trained,
                [self.board],
                looking=drawing(self.recipe),
                samples=self.recipe.samples,
                seed=seed,
            )
            rows.append(
                {
                    **row,
                    "best_of_n": {"n": self.recipe.samples, **as_document(_reached(drawn.min()))},
                }
            )
        return rows

    def save_policy(self, learners: training.Learner, index: int, path: Path) -> None:
        notes = {
            "cell": self.order.cell.name,
            "digest": self.order.cell.digest,
            "recipe": self.order.name,
            "seed": self.order.seeds[index],
        }
        replace(self._trained(learners, index), notes=notes).save(path)

    def _trained(self, learners: training.Learner, index: int) -> Trained:
        return Trained(
            training.networks(self.recipe.config),
            jax.tree.map(lambda leaf: np.asarray(leaf[index]), learners.parameters),
        )


def sure(recipe: YuRecipe) -> YuSearch:
    """Their search for playing: the most visited move."""
    return replace(recipe.config.search, temperature=0.0)


def drawing(recipe: YuRecipe) -> YuSearch:
    """Their search with moves drawn in proportion to the visits."""
    return replace(recipe.config.search, temperature=1.0)


def _in_words_of(cell: Cell, schedule: Schedule) -> Schedule:
    """The board's robot and human under the names that the cell has for them."""
    names = {ROBOT: cell.robots[0], HUMAN: cell.humans[0]}
    return Schedule(
        tuple(
            replace(row, operators=tuple(names[who] for who in row.operators)) for row in schedule
        )
    )


def _reached(seconds: Any) -> Reached:
    return Reached(plain(float(seconds)), 0, 0, float(seconds), None)


@partial(jax.jit, static_argnames="config")
def _advance(
    learners: training.Learner, pool: Game, config: YuConfig
) -> tuple[training.Learner, training.Report]:
    """Some games more for each seed; the reports have leading axes of seeds and games."""
    one = lambda learner, _: training.advance(learner, pool, config)  # noqa: E731
    return jax.lax.map(
        lambda learner: jax.lax.scan(one, learner, None, GAMES_BETWEEN_FIGURES), learners
    )
