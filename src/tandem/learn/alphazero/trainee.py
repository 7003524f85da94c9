"""Self-play with a search as the trainer wants it: any cell, compiled for all seeds, its figures, its results; and the players of what it learned."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from tandem.cell.model import Cell
from tandem.learn.algorithms import Row
from tandem.learn.alphazero import training
from tandem.learn.alphazero.config import Config, Search
from tandem.learn.alphazero.network import Judge, Scorer, opinion
from tandem.learn.alphazero.recipes import SearchRecipe
from tandem.learn.alphazero.selfplay import Played, played
from tandem.learn.alphazero.trained import Trained
from tandem.learn.cell_games import CellGame, reached
from tandem.learn.game import Game, many, stacked
from tandem.learn.reached import Reached
from tandem.learn.trainer import Order

PAID = 10.0
"""What a second costs beside a unit of stress times the stress factor, as in the thesis's rewards."""

LONGEST_SEARCHED = 16
"""Games of the "searched" player of `tandem evaluate`."""


class Trainee:
    """Self-play on an order whose recipe is a `SearchRecipe`. Raises CellError when the cell's times are too large to be counted."""

    def __init__(self, order: Order) -> None:
        recipe = order.recipe
        assert isinstance(recipe, SearchRecipe)
        self.order, self.recipe = order, recipe
        self.game = game_of(order.cell, recipe, order.stress_factor)
        self.pool = stacked([self.game])

    @property
    def paid(self) -> dict[str, Any]:
        return {"step": -PAID, "per_second": 1, "stress_factor": self.order.stress_factor}

    def begin(self) -> training.Learner:
        keys = jnp.stack([jax.random.key(seed) for seed in self.order.seeds])
        return jax.jit(jax.vmap(partial(training.start, config=self.recipe.config), (0, None)))(keys, self.pool)

    def advance(self, learners: training.Learner) -> tuple[training.Learner, training.Report]:
        return jax.block_until_ready(_advance(learners, self.pool, self.recipe.config))

    def share(self, learners: training.Learner) -> float:
        return float(np.min(learners.rounds)) / self.recipe.config.iterations

    def rows(self, learners: training.Learner, report: training.Report) -> list[Row]:
        """`return_team` is minus the mean cost of the games of the self-play: all operators are paid the same."""
        played, value = jax.device_get(_greedy(learners.parameters, self.pool, self.recipe.config))
        found = []
        for place in range(len(self.order.seeds)):
            own = jax.tree.map(lambda leaf, place=place: leaf[place], report)
            row: Row = {"episodes": int(learners.games[place]), "steps": int(learners.moves[place])}
            row |= {"mean_return_team": round(-float(own.cost), 4), "first_value_team": round(-float(value[place]), 4)}
            row |= {name: round(float(getattr(own, name)), 5) for name in ("policy_loss", "value_loss", "entropy")}
            result = reached(self.order.cell, _one(played, place, 0))
            found.append(row | {"greedy_makespan": result.makespan, "greedy_stress": result.stress, "greedy_illegal": 0})
        return found

    def play(self, learners: training.Learner) -> list[Row]:
        """`greedy`: the network alone. `searched`: one game under a search that draws nothing. `best_of_n`: of n games under one that does the best."""
        recipe, cell, rows = self.recipe, self.order.cell, []
        for place, seed in enumerate(self.order.seeds):
            parameters = jax.tree.map(lambda leaf, place=place: leaf[place], learners.parameters)
            trained = Trained(training.judge(recipe.config), parameters)
            row: Row = {"steps": int(learners.moves[place]), "greedy": _told(play(cell, self.game, trained)[0])}
            row["searched"] = _told(play(cell, self.game, trained, sure(recipe))[0])
            drawn = play(cell, self.game, trained, drawing(recipe), games=recipe.samples, seed=seed)
            rows.append({**row, "best_of_n": {"n": recipe.samples, **_told(min(drawn, key=lambda game: game.cost))}})
        return rows

    def save_policy(self, learners: training.Learner, place: int, path: Path) -> None:
        parameters = jax.tree.map(lambda leaf: np.asarray(leaf[place]), learners.parameters)
        notes = {"cell": self.order.cell.name, "digest": self.order.cell.digest, "recipe": self.order.name, "seed": self.order.seeds[place]}
        Trained(training.judge(self.recipe.config), parameters, notes).save(path)


def players(path: Path, cell: Cell, order: Order, *, seed: int, episodes: int) -> dict[str, list[Reached]]:
    """How what a run has learned plays a cell, any cell: alone, under the run's search, and the best of so many searched games."""
    recipe = order.recipe
    assert isinstance(recipe, SearchRecipe)
    trained, game = Trained.load(path), game_of(cell, recipe, order.stress_factor)
    games = min(episodes, LONGEST_SEARCHED)
    drawn = play(cell, game, trained, drawing(recipe), games=games, seed=seed)
    return {
        "greedy": play(cell, game, trained),
        f"searched ({recipe.simulations})": play(cell, game, trained, sure(recipe)),
        "sampled": drawn,
        f"best of {games}": [min(drawn, key=lambda one: one.cost)],
    }


def game_of(cell: Cell, recipe: SearchRecipe, stress_factor: float) -> CellGame:
    """The cell's game as the recipe plays it."""
    return CellGame.of(cell, time_weight=PAID, stress_weight=stress_factor, waiting=recipe.waiting)


def sure(recipe: SearchRecipe) -> Search:
    """The recipe's search for playing, which draws nothing."""
    return replace(recipe.config.search, simulations=recipe.simulations, gumbel_scale=0.0, noise=0.0, temperature=0.0)


def drawing(recipe: SearchRecipe) -> Search:
    """The recipe's search for playing, drawing as in the self-play."""
    return replace(recipe.config.search, simulations=recipe.simulations)


def play(cell: Cell, game: CellGame, trained: Trained, looking: Search | None = None, *, games: int = 1, seed: int = 0) -> list[Reached]:
    """So many games on the cell: by the network alone, or under a search."""
    found = _play(jax.random.key(seed), trained.judge, trained.parameters, many(game, games), looking)
    return [reached(cell, jax.tree.map(lambda leaf, place=place: leaf[place], jax.device_get(found))) for place in range(games)]


def _one(played: Played, *places: int) -> Played:
    return jax.tree.map(lambda leaf: leaf[places], played)


def _told(result: Reached) -> Row:
    return {"makespan": result.makespan, "stress": result.stress, "illegal": 0}


# --- Compiled ---


@partial(jax.jit, static_argnames="config")
def _advance(learners: training.Learner, pool: Game, config: Config) -> tuple[training.Learner, training.Report]:
    """The seeds one after the other: each fills the processor, and a game that is over costs the others nothing."""
    return jax.lax.map(partial(training.advance, games=pool, config=config), learners)


@partial(jax.jit, static_argnames="config")
def _greedy(parameters: Any, pool: Game, config: Config) -> tuple[Any, jax.Array]:
    """One game of each seed's network, and what it thinks of the first state, in the game's cost. Moves are left out: only seeds lead."""
    judge: Scorer = training.judge(config)
    game = jax.tree.map(lambda leaf: leaf[0], pool)

    def one(parameters: Any) -> tuple[Any, jax.Array]:
        found = played(jax.random.key(0), judge, parameters, pool)
        return found._replace(moves=found.moves.T), opinion(judge, parameters, game, game.reset()).to_come * game.unit

    return jax.lax.map(one, parameters)


@partial(jax.jit, static_argnames=("judge", "looking"))
def _play(key: jax.Array, judge: Judge, parameters: Any, games: Game, looking: Search | None) -> Played:
    found = played(key, judge, parameters, games, looking)
    return found._replace(moves=found.moves.T)
