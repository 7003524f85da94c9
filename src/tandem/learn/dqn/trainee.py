"""Deep Q-learning as the trainer wants it: any cell, compiled for all seeds, its figures, its
results; and the players of what it learned.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from tandem.cell.model import Cell
from tandem.learn.algorithm import Row, TrainingOrder
from tandem.learn.alphazero.config import EpsilonGreedy
from tandem.learn.alphazero.rollout import alone, as_document, game_of, play
from tandem.learn.alphazero.trained import Trained
from tandem.learn.dqn import learning
from tandem.learn.dqn.config import Config
from tandem.learn.dqn.network import ValueNetworks
from tandem.learn.dqn.recipes import ValueRecipe
from tandem.learn.env import Game
from tandem.learn.results import Reached, paid

INTERVALS = 30
"""Figures of a training."""


def players(
    path: Path, cell: Cell, order: TrainingOrder, *, seed: int, episodes: int
) -> dict[str, list[Reached]]:
    """How what a run has learned plays a cell: greedy, and with a twentieth of the moves drawn."""
    recipe = order.recipe
    assert isinstance(recipe, ValueRecipe)
    trained, game = (
        Trained.load(path, ValueNetworks),
        game_of(cell, order.stress_factor, waiting=recipe.waiting),
    )
    drawn = play(cell, game, trained, EpsilonGreedy(), games=episodes, seed=seed)
    return {
        "greedy": play(cell, game, trained),
        "sampled": drawn,
        f"best of {episodes}": [min(drawn, key=lambda one: one.cost)],
    }


class Trainee:
    """Deep Q-learning on an order whose recipe is a `ValueRecipe`. Raises CellError when the cell's
    times are too large to be counted.
    """

    players = staticmethod(players)
    costs = staticmethod(lambda cell, order: paid(order.stress_factor))

    def __init__(self, order: TrainingOrder) -> None:
        recipe = order.recipe
        assert isinstance(recipe, ValueRecipe)
        self.order, self.recipe = order, recipe
        self.game = jax.tree.map(
            jnp.asarray, game_of(order.cell, order.stress_factor, waiting=recipe.waiting)
        )
        self.network = learning.networks(self.game, recipe.config)
        self.stretch = max(1, learning.rounds_of(recipe.config) // INTERVALS)

    @property
    def paid(self) -> dict[str, Any]:
        return paid(self.order.stress_factor)

    def begin(self) -> learning.Learner:
        keys = jnp.stack([jax.random.key(seed) for seed in self.order.seeds])
        return jax.jit(jax.vmap(partial(learning.start, config=self.recipe.config), (0, None)))(
            keys, self.game
        )

    def advance(self, learners: learning.Learner) -> tuple[learning.Learner, learning.Report]:
        return jax.block_until_ready(
            _advance(learners, self.game, self.recipe.config, self.stretch)
        )

    def share(self, learners: learning.Learner) -> float:
        return min(1.0, float(np.min(learners.rounds)) / learning.rounds_of(self.recipe.config))

    def rows(self, learners: learning.Learner, report: learning.Report) -> list[Row]:
        """`mean_return_team` is minus the mean cost of the games that ended: all operators are paid
        the same.
        """
        results, found = alone(self.order.cell, self.game, self.network, learners.parameters), []
        for index in range(len(self.order.seeds)):
            seed_report = jax.tree.map(lambda leaf, index=index: leaf[index], report)
            row: Row = {"episodes": int(learners.games[index]), "steps": int(learners.moves[index])}
            row |= {
                "mean_return_team": round(-float(seed_report.cost), 4),
                "first_value_team": round(-results[index][1], 4),
            }
            row |= {
                "loss": round(float(seed_report.loss), 5),
                "explore": round(float(seed_report.explore), 4),
            }
            found.append(
                row
                | {
                    f"greedy_{name}": value
                    for name, value in as_document(results[index][0]).items()
                }
            )
        return found

    def play(self, learners: learning.Learner) -> list[Row]:
        """`greedy`: every agent does what it thinks costs least. `best_of_n`: of n games in which a
        twentieth of the moves is random, the best.
        """
        rows = []
        for index, seed in enumerate(self.order.seeds):
            trained = Trained(
                self.network,
                jax.tree.map(lambda leaf, index=index: leaf[index], learners.parameters),
            )
            drawn = play(
                self.order.cell,
                self.game,
                trained,
                EpsilonGreedy(),
                games=self.recipe.samples,
                seed=seed,
            )
            best = {"n": self.recipe.samples, **as_document(min(drawn, key=lambda game: game.cost))}
            rows.append(
                {
                    "steps": int(learners.moves[index]),
                    "greedy": as_document(play(self.order.cell, self.game, trained)[0]),
                    "best_of_n": best,
                }
            )
        return rows

    def save_policy(self, learners: learning.Learner, index: int, path: Path) -> None:
        parameters = jax.tree.map(lambda leaf: np.asarray(leaf[index]), learners.parameters)
        order, cell = self.order, self.order.cell
        notes = {
            "kind": "dqn",
            "cell": cell.name,
            "digest": cell.digest,
            "recipe": order.name,
            "stress_factor": order.stress_factor,
            "seed": order.seeds[index],
            "waiting": self.recipe.waiting,
        }
        Trained(self.network, parameters, notes).save(path)


@partial(jax.jit, static_argnames=("config", "rounds"))
def _advance(
    learners: learning.Learner, game: Game, config: Config, rounds: int
) -> tuple[learning.Learner, learning.Report]:
    """The seeds one after the other."""
    return jax.lax.map(partial(learning.advance, game=game, config=config, rounds=rounds), learners)
