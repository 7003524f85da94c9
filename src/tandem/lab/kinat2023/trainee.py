"""Independent PPO on the thesis's station as the trainer wants it: compiled for all seeds, its
figures, its results.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import jax
import numpy as np

from tandem.cell.model import plain
from tandem.lab.kinat2023.episode import seconds
from tandem.lab.kinat2023.learn_env import StationWorld
from tandem.lab.kinat2023.players import costs, players
from tandem.lab.kinat2023.recipe import StationRecipe
from tandem.lab.kinat2023.simulations import pair
from tandem.lab.kinat2023.station import whole_ticks
from tandem.learn.algorithm import Row, TrainingOrder
from tandem.learn.networks import joined
from tandem.learn.policy import Policy
from tandem.learn.ppo import play, ppo
from tandem.learn.ppo.config import Config
from tandem.learn.ppo.play import Rollout
from tandem.learn.ppo.trainee import of_seed, share

EPISODES_BETWEEN_FIGURES = 30
LONGEST_PLAY = 1400
BEST_OF = 64


class Trainee:
    """PPO on an order whose recipe is a `StationRecipe`. Raises CellError when the thesis's station
    cannot hold the cell.
    """

    players = staticmethod(players)
    costs = staticmethod(costs)
    pair = staticmethod(pair)

    def __init__(self, order: TrainingOrder) -> None:
        assert isinstance(order.recipe, StationRecipe)
        self.order, self.recipe = order, order.recipe
        self.world = StationWorld.of(order.cell, self.recipe, stress_factor=order.stress_factor)

    @property
    def config(self) -> Config:
        return self.recipe.config

    @property
    def paid(self) -> dict[str, Any]:
        return costs(self.order.cell, self.order)

    def begin(self) -> ppo.Learner:
        keys = jax.numpy.stack([jax.random.key(seed) for seed in self.order.seeds])
        return jax.jit(jax.vmap(partial(ppo.start, config=self.config), (0, None)))(
            keys, self.world
        )

    def advance(self, learners: ppo.Learner) -> tuple[ppo.Learner, ppo.Report]:
        updates = EPISODES_BETWEEN_FIGURES if self.config.stop_at_end else 1
        return jax.block_until_ready(_advance(learners, self.world, self.config, updates))

    def share(self, learners: ppo.Learner) -> float:
        return share(learners, self.config)

    def rows(self, learners: ppo.Learner, report: ppo.Report) -> list[Row]:
        """The figures that the thesis watches, and those that say how good the agents are."""
        played = jax.device_get(_greedy(learners.parameters, self.world, self.config))
        return [
            self._row(learners, index, *of_seed((report, played), index))
            for index in range(len(self.order.seeds))
        ]

    def play(self, learners: ppo.Learner) -> list[Row]:
        """`best_of_n`: of n sampled episodes the one with the largest sum of returns."""
        greedy = jax.device_get(_greedy(learners.parameters, self.world, self.config))
        drawn = jax.device_get(
            _sampled(
                jax.random.key(self.order.seeds[0]), learners.parameters, self.world, self.config
            )
        )
        rows = []
        for index in range(len(self.order.seeds)):
            sure, draws = of_seed((greedy, drawn), index)
            best = {"n": BEST_OF, **self._reached(draws, best_of(draws))}
            rows.append(
                {
                    "steps": int(learners.steps[index]),
                    "greedy": self._reached(sure, 0),
                    "best_of_n": best,
                }
            )
        return rows

    def save_policy(self, learners: ppo.Learner, index: int, path: Path) -> None:
        """The actors, for NumPy."""
        order, config = self.order, self.config
        actor = joined(
            jax.tree.map(lambda leaf: np.asarray(leaf[index]), learners.parameters["actor"])
        )
        notes = {
            "kind": "station",
            "cell": order.cell.name,
            "digest": order.cell.digest,
            "recipe": order.name,
            "stress_factor": order.stress_factor,
            "seed": order.seeds[index],
            "pace": self.recipe.pace,
            "sees": self.recipe.sees,
            "rewards": self.recipe.rewards,
        }
        Policy(
            self.world.agents, actor, config.activation, config.masked, config.share_actor, notes
        ).save(path)

    def _row(self, learners: ppo.Learner, index: int, report: ppo.Report, played: Rollout) -> Row:
        ended = np.asarray(report.episodes)
        last = int(np.flatnonzero(ended)[-1]) if ended.any() else len(ended) - 1
        weights = ended / max(ended.sum(), 1)
        mean, illegal = np.asarray(weights @ report.returns), np.asarray(weights @ report.illegal)
        row: Row = {
            "stage": int(report.stage[-1]) + 1,
            "episodes": int(learners.episodes[index]),
            "steps": int(report.steps[-1]),
        }
        for name, agent in enumerate(self.world.agents):
            row[f"return_{agent}"] = round(float(report.returns[last][name]), 4)
            row[f"mean_return_{agent}"] = round(float(mean[name]), 4)
            row[f"first_value_{agent}"] = round(float(report.first_value[-1][name]), 4)
            row[f"illegal_{agent}"] = round(float(illegal[name]), 4)
            row[f"entropy_{agent}"] = round(float(np.mean(np.asarray(report.entropy)[:, name])), 5)
        return row | {f"greedy_{name}": value for name, value in self._reached(played, 0).items()}

    def _reached(self, played: Rollout, index: int) -> Row:
        """Makespan in seconds and stress of an episode, None when it did not come to its end; and
        how many rules were broken.
        """
        makespan = stress = None
        if played.done[index]:
            makespan = plain(seconds(int(played.state.clock[index]), whole_ticks(self.order.cell)))
            stress = plain(round(float(played.state.stress[index]), 6))
        return {
            "makespan": makespan,
            "stress": stress,
            "illegal": int(np.sum(played.illegal[index])),
        }


def best_of(played: Rollout) -> int:
    """Which of the episodes that ended has the largest sum of returns; 0 when none ended."""
    return int(np.argmax(np.where(played.done, np.asarray(played.returns).sum(-1), -np.inf)))


# --- Compiled, for all seeds ---


@partial(jax.jit, static_argnames=("config", "updates"))
def _advance(
    learners: ppo.Learner, world: StationWorld, config: Config, updates: int
) -> tuple[ppo.Learner, ppo.Report]:
    """Side by side where every rollout has the same length; else one after the other, so that none
    waits for the longest episode.
    """
    one = partial(ppo.advance, world=world, config=config, updates=updates)
    return jax.lax.map(one, learners) if config.stop_at_end else jax.vmap(one)(learners)


@partial(jax.jit, static_argnames="config")
def _greedy(parameters: ppo.Parameters, world: StationWorld, config: Config) -> Rollout:
    return jax.lax.map(
        lambda one: play.greedy(one, world, config, config.episode_limit or LONGEST_PLAY),
        parameters,
    )


@partial(jax.jit, static_argnames="config")
def _sampled(
    key: jax.Array, parameters: ppo.Parameters, world: StationWorld, config: Config
) -> Rollout:
    limit = config.episode_limit or LONGEST_PLAY
    return jax.lax.map(
        lambda one: play.sampled(key, one, world, config, limit, BEST_OF), parameters
    )
