"""Self-play with a search as the trainer wants it: any cell, compiled for all seeds, its figures,
its results; and the players of what it learned.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from tandem.cell.model import Cell
from tandem.learn.algorithm import Row, TrainingOrder
from tandem.learn.alphazero import training
from tandem.learn.alphazero.config import Config, Search
from tandem.learn.alphazero.network import Scorer
from tandem.learn.alphazero.recipes import SearchRecipe
from tandem.learn.alphazero.rollout import alone, as_document, game_of, play
from tandem.learn.alphazero.trained import Trained
from tandem.learn.env import Game, stacked
from tandem.learn.results import Reached, paid

MOST_SEARCHED = 16
"""Searched games of `tandem evaluate`, however many episodes are asked for."""


def players(
    path: Path, cell: Cell, order: TrainingOrder, *, seed: int, episodes: int
) -> dict[str, list[Reached]]:
    """How what a run has learned plays a cell, any cell: alone, under the run's search, and the
    best of so many searched games.
    """
    recipe = order.recipe
    assert isinstance(recipe, SearchRecipe)
    trained, game = (
        Trained.load(path, Scorer),
        game_of(cell, order.stress_factor, waiting=recipe.waiting),
    )
    games = min(episodes, MOST_SEARCHED)
    drawn = play(cell, game, trained, drawing(recipe), games=games, seed=seed)
    return {
        "greedy": play(cell, game, trained),
        f"searched ({recipe.simulations})": play(cell, game, trained, sure(recipe)),
        "sampled": drawn,
        f"best of {games}": [min(drawn, key=lambda one: one.cost)],
    }


class Trainee:
    """Self-play on an order whose recipe is a `SearchRecipe`. Raises CellError when the cell's
    times are too large to be counted.
    """

    players = staticmethod(players)
    costs = staticmethod(lambda cell, order: paid(order.stress_factor))

    def __init__(self, order: TrainingOrder) -> None:
        recipe = order.recipe
        assert isinstance(recipe, SearchRecipe)
        self.order, self.recipe = order, recipe
        self.game = game_of(order.cell, order.stress_factor, waiting=recipe.waiting)
        self.pool = stacked([self.game])

    @property
    def paid(self) -> dict[str, Any]:
        return paid(self.order.stress_factor)

    def begin(self) -> training.Learner:
        keys = jnp.stack([jax.random.key(seed) for seed in self.order.seeds])
        return jax.jit(jax.vmap(partial(training.start, config=self.recipe.config), (0, None)))(
            keys, self.pool
        )

    def advance(self, learners: training.Learner) -> tuple[training.Learner, training.Report]:
        return jax.block_until_ready(_advance(learners, self.pool, self.recipe.config))

    def share(self, learners: training.Learner) -> float:
        return float(np.min(learners.rounds)) / self.recipe.config.iterations

    def rows(self, learners: training.Learner, report: training.Report) -> list[Row]:
        """`return_team` is minus the mean cost of the games of the self-play: all operators are
        paid the same.
        """
        results = alone(
            self.order.cell, self.game, training.network_of(self.recipe.config), learners.parameters
        )
        found = []
        for index in range(len(self.order.seeds)):
            seed_report = jax.tree.map(lambda leaf, index=index: leaf[index], report)
            row: Row = {"episodes": int(learners.games[index]), "steps": int(learners.moves[index])}
            row |= {
                "mean_return_team": round(-float(seed_report.cost), 4),
                "first_value_team": round(-results[index][1], 4),
            }
            row |= {
                name: round(float(getattr(seed_report, name)), 5)
                for name in ("policy_loss", "value_loss", "entropy")
            }
            found.append(
                row
                | {
                    f"greedy_{name}": value
                    for name, value in as_document(results[index][0]).items()
                }
            )
        return found

    def play(self, learners: training.Learner) -> list[Row]:
        """`greedy`: the network alone. `searched`: a game under a search that draws nothing.
        `best_of_n`: of n games under one that draws.
        """
        recipe, cell, rows = self.recipe, self.order.cell, []
        for index, seed in enumerate(self.order.seeds):
            parameters = jax.tree.map(lambda leaf, index=index: leaf[index], learners.parameters)
            trained = Trained(training.network_of(recipe.config), parameters)
            row: Row = {
                "steps": int(learners.moves[index]),
                "greedy": as_document(play(cell, self.game, trained)[0]),
            }
            row["searched"] = as_document(play(cell, self.game, trained, sure(recipe))[0])
            drawn = play(cell, self.game, trained, drawing(recipe), games=recipe.samples, seed=seed)
            rows.append(
                {
                    **row,
                    "best_of_n": {
                        "n": recipe.samples,
                        **as_document(min(drawn, key=lambda game: game.cost)),
                    },
                }
            )
        return rows

    def save_policy(self, learners: training.Learner, index: int, path: Path) -> None:
        parameters = jax.tree.map(lambda leaf: np.asarray(leaf[index]), learners.parameters)
        order, cell = self.order, self.order.cell
        notes = {
            "kind": "alphazero",
            "cell": cell.name,
            "digest": cell.digest,
            "recipe": order.name,
            "stress_factor": order.stress_factor,
            "seed": order.seeds[index],
            "waiting": self.recipe.waiting,
        }
        Trained(training.network_of(self.recipe.config), parameters, notes).save(path)


def sure(recipe: SearchRecipe) -> Search:
    """The recipe's search for playing, which draws nothing."""
    return replace(
        recipe.config.search,
        simulations=recipe.simulations,
        gumbel_scale=0.0,
        noise=0.0,
        temperature=0.0,
    )


def drawing(recipe: SearchRecipe) -> Search:
    """The recipe's search for playing, drawing as in the self-play."""
    return replace(recipe.config.search, simulations=recipe.simulations)


# --- Compiled ---


@partial(jax.jit, static_argnames="config")
def _advance(
    learners: training.Learner, pool: Game, config: Config
) -> tuple[training.Learner, training.Report]:
    """The seeds one after the other: each fills the processor, and a game that is over costs the
    others nothing.
    """
    return jax.lax.map(partial(training.advance, games=pool, config=config), learners)
