"""The best response as the trainer wants it: PPO with one agent beside a crowd, its figures and its results."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import jax
import numpy as np

from tandem.cell.model import plain
from tandem.learn import ppo
from tandem.learn.algorithms import Row
from tandem.learn.config import Config
from tandem.learn.play import Played, greedy, greedy_many, sampled
from tandem.learn.policy import Policy
from tandem.learn.ppo_training import best_of, of_seed, share
from tandem.learn.response.beside import BesidePeople, is_done
from tandem.learn.response.recipes import ResponseRecipe
from tandem.learn.trainer import Order
from tandem.world import state
from tandem.world.arrays import Names
from tandem.world.crowd import crowd

BEST_OF, PEOPLE = 64, 256
LONGEST_PLAY = 2000


class Trainee:
    """PPO on an order whose recipe is a `ResponseRecipe`.

    Raises CellError when the world cannot hold the cell or a population file is wrong, UsageError when the people's description is.
    """

    def __init__(self, order: Order) -> None:
        self.order, self.names = order, Names.of(order.cell)
        assert isinstance(order.recipe, ResponseRecipe)
        arrays, weights = self.names.arrays(), (1.0, order.stress_factor / -STEP)
        self.crowd = crowd(order.recipe.people, self.names, arrays, part="train")
        self.world = BesidePeople.of(self.crowd, weights=weights, seed=order.seeds[0])
        self.obedient = BesidePeople.of(crowd("compliant", self.names, arrays), weights=weights)

    @property
    def config(self) -> Config:
        config: Config = self.order.recipe.config
        return config

    @property
    def paid(self) -> dict[str, Any]:
        return {"step": STEP, "per_second": 1, "stress_factor": self.order.stress_factor}

    def begin(self) -> ppo.Learner:
        keys = jax.numpy.stack([jax.random.key(seed) for seed in self.order.seeds])
        return jax.jit(jax.vmap(partial(ppo.start, config=self.config), (0, None)))(keys, self.world)

    def advance(self, learners: ppo.Learner) -> tuple[ppo.Learner, ppo.Report]:
        return jax.block_until_ready(_advance(learners, self.world, self.config))

    def share(self, learners: ppo.Learner) -> float:
        return share(learners, self.config)

    def rows(self, learners: ppo.Learner, report: ppo.Report) -> list[Row]:
        """`greedy_*`: beside somebody who does all that is asked; `people_*`: means beside people of the crowd."""
        obedient, people = jax.device_get(_played(learners.parameters, self.obedient, self.world, self.config))
        rows = []
        for place in range(len(self.order.seeds)):
            one, many, said = of_seed((obedient, people, report), place)
            row: Row = {"stage": int(said.stage[-1]) + 1, "episodes": int(learners.episodes[place]), "steps": int(said.steps[-1])}
            row |= {"entropy": round(float(np.mean(said.entropy)), 5), **self._beside_people(many)}
            rows.append(row | {f"greedy_{name}": value for name, value in self._reached(one, 0).items()})
        return rows

    def play(self, learners: ppo.Learner) -> list[Row]:
        """`greedy` and `best_of_n` beside somebody who does all that is asked, means beside people of the crowd."""
        obedient, people = jax.device_get(_played(learners.parameters, self.obedient, self.world, self.config))
        drawn = jax.device_get(_sampled(jax.random.key(self.order.seeds[0]), learners.parameters, self.obedient, self.config))
        rows = []
        for place in range(len(self.order.seeds)):
            one, many, draws = of_seed((obedient, people, drawn), place)
            best = {"n": BEST_OF, **self._reached(draws, best_of(draws))}
            rows.append({"steps": int(learners.steps[place]), "greedy": self._reached(one, 0), "best_of_n": best, **self._beside_people(many)})
        return rows

    def save_policy(self, learners: ppo.Learner, place: int, path: Path) -> None:
        """The actor, for NumPy."""
        actor = jax.tree.map(lambda leaf: np.asarray(leaf[place]), learners.parameters["actor"])
        cell, config = self.order.cell, self.config
        notes = {
            "kind": "response",
            "cell": cell.name,
            "digest": cell.digest,
            "people": self.crowd.spec,
            "recipe": self.order.name,
            "stress_factor": self.order.stress_factor,
            "seed": self.order.seeds[place],
        }
        Policy(self.world.agents, actor, config.activation, config.masked, config.share_actor, notes).save(path)

    def _reached(self, played: Played, place: int) -> Row:
        """Makespan in seconds and stress of an episode; None when it did not come to its end."""
        shift = jax.tree.map(lambda leaf: leaf[place], played.state.shift)
        makespan = stress = None
        if bool(is_done(shift)):
            makespan = plain(self.names.seconds(int(state.makespan(shift.state))))
            stress = plain(round(self.names.stress(int(state.stress(self.names.arrays(), shift.state))), 6))
        return {"makespan": makespan, "stress": stress, "illegal": 0}

    def _beside_people(self, played: Played) -> Row:
        """Means over the episodes that came to their end, and which share did."""
        ended = [place for place in range(PEOPLE) if played.done[place]]
        reached = [row for row in (self._reached(played, place) for place in ended) if row["makespan"] is not None]
        mean = {f"people_{name}": round(float(np.mean([row[name] for row in reached])), 4) if reached else None for name in ("makespan", "stress")}
        return {**mean, "people_finished": len(reached) / PEOPLE}


STEP = -10.0
"""What a second costs where a unit of stress costs the stress factor, as in the thesis's rewards."""


def players(path: Path, cell: Any, order: Order, *, seed: int, episodes: int) -> Any:
    """Not here: a best response is judged beside people.

    Raises UsageError that says how.
    """
    from tandem.errors import UsageError

    raise UsageError(f"a best response is judged beside people: tandem simulate CELL --policy learned,auto --learned {path} --people random:0.5")


# --- Compiled, for all seeds ---


@partial(jax.jit, static_argnames="config")
def _advance(learners: ppo.Learner, world: BesidePeople, config: Config) -> tuple[ppo.Learner, ppo.Report]:
    return jax.lax.map(partial(ppo.advance, world=world, config=config, updates=INTERVAL), learners)


INTERVAL = 8
"""Updates between two rows of figures."""


@partial(jax.jit, static_argnames="config")
def _played(parameters: ppo.Parameters, obedient: BesidePeople, world: BesidePeople, config: Config) -> Sequence[Played]:
    def one(parameters: ppo.Parameters) -> Sequence[Played]:
        sure = greedy(parameters, obedient, config, LONGEST_PLAY)
        return sure, greedy_many(jax.random.key(0), parameters, world, config, LONGEST_PLAY, PEOPLE)

    return jax.lax.map(one, parameters)


@partial(jax.jit, static_argnames="config")
def _sampled(key: jax.Array, parameters: ppo.Parameters, world: BesidePeople, config: Config) -> Played:
    return jax.lax.map(lambda one: sampled(key, one, world, config, LONGEST_PLAY, BEST_OF), parameters)
