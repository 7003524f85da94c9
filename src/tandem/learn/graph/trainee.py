"""Tuning the policy for any cell as the trainer wants it: its figures, its results; and the players
of what was tuned.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from tandem.cell.model import Cell, plain
from tandem.errors import CellError, Fault
from tandem.files.validate import cell_of
from tandem.learn.algorithm import Row, TrainingOrder
from tandem.learn.graph.making import Maker
from tandem.learn.graph.network import Weights
from tandem.learn.graph.recipes import GraphRecipe
from tandem.learn.graph.trained import KIND, save, weights_of
from tandem.learn.graph.tuning import Learner, Problem, Report, begun, one_round, problems
from tandem.learn.graph.weights import unpacked
from tandem.learn.results import SECOND, Reached, paid
from tandem.plan.list_scheduling import PartialSchedule
from tandem.plan.rules import drawn_together

LEAST_RATE = 0.1
"""Of the rate at the beginning, in the last round."""


def players(
    path: Path, cell: Cell, order: TrainingOrder, *, seed: int, episodes: int
) -> dict[str, list[Reached]]:
    """How tuned weights make schedules of a cell, any cell: always what they like best, drawn, and
    the best of the drawn ones.
    """
    (problem, *_) = problems(cell, order.stress_factor / SECOND, ())
    greedy, *drawn = made(weights_of(path), problem, episodes + 1, seed)
    best = min(drawn, key=lambda one: one.cost)
    return {"greedy": [greedy], "sampled": drawn, f"best of {len(drawn)}": [best]}


def made(weights: Weights, problem: Problem, samples: int, seed: int) -> list[Reached]:
    """So many schedules, the greedy one first."""
    rng, maker = np.random.default_rng(seed), Maker.of(weights, problem.outlook)
    states = (
        drawn_together(problem.layout, maker.build(rng if sample else None))
        for sample in range(samples)
    )
    return [reached(problem, state) for state in states]


def reached(problem: Problem, state: PartialSchedule | None) -> Reached:
    """The schedule in the cell's seconds and stress."""
    if state is None:
        return Reached(None, None, 0, float("inf"), None)
    instance = problem.layout.instance
    makespan = state.makespan / instance.per_second
    return Reached(
        plain(makespan),
        plain(round(instance.stress(state.stress), 6)),
        0,
        problem.cost(state),
        instance.schedule(state.starts()),
    )


class Trainee:
    """The tuning of an order whose recipe is a `GraphRecipe`.

    Raises CellError when the policy cannot take one of the cells.
    """

    players = staticmethod(players)
    costs = staticmethod(lambda cell, order: paid(order.stress_factor))

    def __init__(self, order: TrainingOrder) -> None:
        recipe = order.recipe
        assert isinstance(recipe, GraphRecipe)
        self.order, self.recipe = order, recipe
        exchange = order.stress_factor / SECOND
        self.problems = [
            one for cell in self._cells() for one in problems(cell, exchange, recipe.weights)
        ]

    def _cells(self) -> Iterator[Cell]:
        """The order's cell, and those beside it."""
        yield self.order.cell
        for number, document in enumerate(self.recipe.beside or ()):
            try:
                yield cell_of(document)
            except CellError as error:
                what = f"beside.{number}: is no cell: {error.faults[0].message}"
                raise CellError([Fault(what, ("settings",))]) from None

    @property
    def paid(self) -> dict[str, Any]:
        return paid(self.order.stress_factor)

    def begin(self) -> Learner:
        """One learner for each seed, alike so far."""
        found = [begun(self.problems) for _ in self.order.seeds]
        stacked: Learner = jax.tree.map(lambda *parts: jnp.stack(parts), *found)
        return stacked

    def advance(self, learners: Learner) -> tuple[Learner, Report]:
        recipe, found = self.recipe, []
        for index, seed in enumerate(self.order.seeds):
            mine = _of(learners, index)
            done = int(mine.rounds) / recipe.rounds
            rate = recipe.rate * (1 - (1 - LEAST_RATE) * done)
            found.append(
                one_round(
                    mine, self.problems, samples=recipe.samples, steps=recipe.steps, rate=rate,
                    seed=seed,
                )
            )  # fmt: skip
        stacked: tuple[Learner, Report] = jax.tree.map(
            lambda *parts: np.stack([np.asarray(part) for part in parts]), *found
        )
        return stacked

    def share(self, learners: Learner) -> float:
        return min(1.0, float(np.min(learners.rounds)) / self.recipe.rounds)

    def rows(self, learners: Learner, report: Report) -> list[Row]:
        """`above_best`: how far the greedy schedules of a round cost more than the best that were
        ever found, mean over cells and weights, before its steps.
        """
        found = []
        for index in range(len(self.order.seeds)):
            (greedy,) = made(self._weights(learners, index), self.problems[0], 1, 0)
            row: Row = {
                "episodes": int(learners.drawn[index]),
                "steps": int(learners.rounds[index]) * self.recipe.steps,
                "loss": round(float(report.loss[index]), 5),
                "above_best": round(float(report.above[index]), 6),
            }
            found.append(row | {f"greedy_{name}": part for name, part in _document(greedy).items()})
        return found

    def play(self, learners: Learner) -> list[Row]:
        """`greedy`: always what it likes best. `best_of_n`: of n schedules, the greedy one among
        them.
        """
        rows = []
        for index, seed in enumerate(self.order.seeds):
            weights, samples = self._weights(learners, index), self.recipe.samples
            drawn = made(weights, self.problems[0], samples, seed)
            best = min(drawn, key=lambda one: one.cost)
            rows.append(
                {
                    "steps": int(learners.rounds[index]) * self.recipe.steps,
                    "greedy": _document(drawn[0]),
                    "best_of_n": {"n": samples, **_document(best)},
                }
            )
        return rows

    def save_policy(self, learners: Learner, index: int, path: Path) -> None:
        order = self.order
        notes = {
            "kind": KIND,
            "cell": order.cell.name,
            "digest": order.cell.digest,
            "recipe": order.name,
            "stress_factor": order.stress_factor,
            "seed": order.seeds[index],
            "cells": 1 + len(self.recipe.beside or ()),
        }
        save(path, self._weights(learners, index), notes)

    def _weights(self, learners: Learner, index: int) -> Weights:
        return unpacked({name: np.asarray(part[index]) for name, part in learners.weights.items()})


def _of(learners: Learner, index: int) -> Learner:
    """One seed's."""
    mine: Learner = jax.tree.map(lambda leaf: np.asarray(leaf)[index], learners)
    return mine


def _document(result: Reached) -> Row:
    return {"makespan": result.makespan, "stress": result.stress, "illegal": result.illegal}
