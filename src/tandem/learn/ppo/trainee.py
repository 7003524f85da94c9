"""PPO as the trainer wants it: one decider for all operators of any cell, beside people; its
figures and its results.
"""

from __future__ import annotations

import math
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from tandem.cell.model import plain
from tandem.learn.algorithm import Row, TrainingOrder
from tandem.learn.networks import Perceptron, forward
from tandem.learn.policy import Policy
from tandem.learn.ppo import observation, ppo
from tandem.learn.ppo.config import Config
from tandem.learn.ppo.env import BesidePeople
from tandem.learn.ppo.players import players
from tandem.learn.ppo.recipes import Recipe
from tandem.learn.results import SECOND, cost, paid
from tandem.world import episode
from tandem.world.arrays import Array, Arrays, Names
from tandem.world.episode import Shift
from tandem.world.people import Person, compliant, crew, stacked
from tandem.world.population import crowd
from tandem.world.randomness import scenario

BEST_OF, PEOPLE = 64, 256
INTERVAL = 8
"""Updates between two rows of figures, at the most; a stage holds a whole number of intervals."""


class Trainee:
    """PPO on an order whose recipe is a `recipes.Recipe`.

    Raises CellError when the world cannot hold the cell or a population file is wrong, UsageError
    when the people's description is.
    """

    players = staticmethod(players)
    costs = staticmethod(lambda cell, order: paid(order.stress_factor))

    def __init__(self, order: TrainingOrder) -> None:
        assert isinstance(order.recipe, Recipe)
        self.order, self.recipe, self.names = order, order.recipe, Names.of(order.cell)
        arrays, weights = self.names.arrays(), (1.0, order.stress_factor / SECOND)
        # a run's people are read from its folder again, and no file makes code run
        self.crowd = crowd(order.recipe.people, self.names, arrays, part="train", dotted=False)
        self.world = BesidePeople.of(self.crowd, weights=weights, seed=order.seeds[0])
        # Beside whom it is judged: one who does all that is asked, the same for the drawn plays,
        # and the people of the recipe, if they are others.
        company = [compliant(arrays)] * (1 + BEST_OF)
        self.people = 0 if order.recipe.people == "compliant" else PEOPLE
        drawn = self.crowd.draw(np.random.default_rng(order.seeds[0]), self.people)
        self.company = Person(
            *(np.concatenate(parts) for parts in zip(stacked(company), drawn, strict=True))
        )

    @property
    def config(self) -> Config:
        return self.recipe.config

    @property
    def paid(self) -> dict[str, Any]:
        return paid(self.order.stress_factor)

    def begin(self) -> ppo.Learner:
        keys = jax.numpy.stack([jax.random.key(seed) for seed in self.order.seeds])
        return jax.jit(jax.vmap(partial(ppo.start, config=self.config), (0, None)))(
            keys, self.world
        )

    def advance(self, learners: ppo.Learner) -> tuple[ppo.Learner, ppo.Report]:
        return jax.block_until_ready(_advance(learners, self.world, self.config, self._interval))

    @property
    def _interval(self) -> int:
        config = self.config
        return math.gcd(
            INTERVAL,
            *(
                math.ceil((stage.steps or 0) / (config.environments * config.horizon))
                for stage in config.stages
            ),
        )

    def share(self, learners: ppo.Learner) -> float:
        return share(learners, self.config)

    def rows(self, learners: ppo.Learner, report: ppo.Report) -> list[Row]:
        """`greedy_*`: beside somebody who does all that is asked; `people_*`: means beside people
        of the crowd.
        """
        rows = []
        for index, played in enumerate(self._played(learners)):
            said = of_seed(report, index)
            row: Row = {
                "stage": int(said.stage[-1]) + 1,
                "episodes": int(learners.episodes[index]),
                "steps": int(said.steps[-1]),
            }
            row |= {
                "entropy": round(float(np.mean(said.entropy)), 5),
                **self._beside_people(played),
            }
            rows.append(
                row | {f"greedy_{name}": value for name, value in self._reached(played, 0).items()}
            )
        return rows

    def play(self, learners: ppo.Learner) -> list[Row]:
        """`greedy` and `best_of_n` beside somebody who does all that is asked, means beside people
        of the crowd.
        """
        rows = []
        for index, played in enumerate(self._played(learners)):
            drawn = [self._reached(played, number) for number in range(1, 1 + BEST_OF)]
            best = min(drawn, key=self._cost)
            row = {
                "greedy": self._reached(played, 0),
                "best_of_n": {"n": BEST_OF, **best},
                **self._beside_people(played),
            }
            rows.append({"steps": int(learners.steps[index]), **row})
        return rows

    def save_policy(self, learners: ppo.Learner, index: int, path: Path) -> None:
        """The actor, for NumPy."""
        actor = jax.tree.map(lambda leaf: np.asarray(leaf[index]), learners.parameters["actor"])
        cell, config = self.order.cell, self.config
        notes = {
            "kind": "ppo",
            "cell": cell.name,
            "digest": cell.digest,
            "people": self.crowd.spec,
            "recipe": self.order.name,
            "stress_factor": self.order.stress_factor,
            "seed": self.order.seeds[index],
        }
        Policy(
            self.world.agents, actor, config.activation, config.masked, config.share_actor, notes
        ).save(path)

    def _played(self, learners: ppo.Learner) -> list[EpisodeResults]:
        """Per seed: one episode beside somebody obedient, `BEST_OF` with drawn actions, and one
        beside each of the people.
        """
        found = jax.device_get(
            _episodes(learners.parameters["actor"], self.world, self.company, self.config)
        )
        return [of_seed(found, index) for index in range(len(self.order.seeds))]

    def _reached(self, played: EpisodeResults, index: int) -> Row:
        """Makespan in seconds and stress of an episode; None when it did not come to its end."""
        if not played.done[index]:
            return {"makespan": None, "stress": None, "illegal": 0}
        stress = round(self.names.stress(int(played.stress[index])), 6)
        return {
            "makespan": plain(self.names.seconds(int(played.makespan[index]))),
            "stress": plain(stress),
            "illegal": 0,
        }

    def _cost(self, row: Row) -> float:
        return (
            float("inf")
            if row["makespan"] is None
            else cost(row["makespan"], row["stress"], **self.paid)
        )

    def _beside_people(self, played: EpisodeResults) -> Row:
        """Means over the episodes that came to their end, and which share did; nothing where
        everybody does what is asked.
        """
        if not self.people:
            return {}
        rows = [
            self._reached(played, index) for index in range(1 + BEST_OF, 1 + BEST_OF + self.people)
        ]
        ended = [row for row in rows if row["makespan"] is not None]
        mean = {
            f"people_{name}": round(float(np.mean([row[name] for row in ended])), 4)
            if ended
            else None
            for name in ("makespan", "stress")
        }
        return {**mean, "people_finished": len(ended) / self.people}


class EpisodeResults(NamedTuple):
    """What came of episodes: makespan `[E]` int32 ticks, stress `[E]` int32 units, done `[E]`
    bool.
    """

    makespan: Array
    stress: Array
    done: Array


def share(learners: ppo.Learner, config: Config) -> float:
    """How much of the budget the slowest seed has behind it, 0 to 1."""
    stages, done = config.stages, []
    for index, stage in enumerate(np.asarray(learners.stage).tolist()):
        left = 0.0
        if stage < len(stages):
            within = (
                int(learners.stage_episodes[index]) / (stages[stage].episodes or 2**31),
                int(learners.stage_steps[index]) / (stages[stage].steps or 2**31),
            )
            left = min(max(within), 1.0)
        done.append((stage + left) / len(stages))
    return min(done)


def of_seed(tree: Any, index: int) -> Any:
    """One seed's part of results that have a leading axis of seeds."""
    return jax.tree.map(lambda leaf: leaf[index], tree)


# --- Compiled, for all seeds ---


@partial(jax.jit, static_argnames=("config", "updates"))
def _advance(
    learners: ppo.Learner, world: BesidePeople, config: Config, updates: int
) -> tuple[ppo.Learner, ppo.Report]:
    return jax.lax.map(partial(ppo.advance, world=world, config=config, updates=updates), learners)


@partial(jax.jit, static_argnames="config")
def _episodes(
    actors: Perceptron, world: BesidePeople, company: Person, config: Config
) -> EpisodeResults:
    """`[S, E]`: the episodes of `Trainee._played`. Noise of Gumbel's distribution turns the most
    probable action into a drawn one.
    """
    # the first is greedy and stands for the result, `BEST_OF` are drawn, the others are greedy
    number = company.pace.shape[0]
    drawn = (jnp.arange(number) > 0) & (jnp.arange(number) <= BEST_OF)
    keys, draw_key = jax.random.split(jax.random.key(0), number), jax.random.key(1)
    uniform = jax.random.uniform(draw_key, (number, world.draw.numbers))

    def of_actor(actor: Perceptron) -> EpisodeResults:
        alone = jax.tree.map(lambda leaf: leaf[0], actor)

        def one(person: Person, uniform: Array, key: Array, drawn: Array) -> EpisodeResults:
            def decide(arrays: Arrays, shift: Shift) -> Array:
                logits = forward(
                    jnp,
                    alone,
                    observation.observe(arrays, shift.state, shift.mask, shift.turn),
                    config.activation,
                )
                # adding the noise to the logits draws from the policy and keeps one loop for both
                logits = logits + drawn * jax.random.gumbel(
                    jax.random.fold_in(key, shift.decisions), logits.shape
                )
                action = jnp.argmax(
                    jnp.where(
                        observation.choices(arrays, shift.state, shift.mask, shift.turn),
                        logits,
                        -jnp.inf,
                    )
                )
                # the last action lets the turn pass, which the world calls -1
                return jnp.where(action == world.actions - 1, -1, action)

            played = episode.play(
                world.arrays,
                scenario(world.draw, world.arrays, uniform),
                crew(world.arrays, person),
                decide,
            )
            return EpisodeResults(played.makespan, played.stress, played.done)

        return jax.vmap(one)(company, uniform, keys, drawn)

    return jax.lax.map(of_actor, actors)
