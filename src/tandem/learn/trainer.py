"""Trainings that people can follow, stop and take up again: several seeds side by side, figures and a checkpoint at every interval."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import jax
import numpy as np

from tandem.cell.model import Cell
from tandem.errors import NothingFoundError, UsageError
from tandem.learn import checkpoint, play, ppo
from tandem.learn.config import Config
from tandem.learn.policy import Policy
from tandem.learn.recipes import Recipe, recipe
from tandem.learn.runs import RunFolder, new_folder
from tandem.learn.stations import StationWorld
from tandem.plan.methods import plan
from tandem.plan.result import Front

EPISODES_BETWEEN_FIGURES = 30
LONGEST_PLAY = 1400
BEST_OF = 64

Row = dict[str, Any]


class NotFiniteError(NothingFoundError):
    """The numbers of a training stopped being finite; the last good checkpoint was kept."""


@dataclass(frozen=True)
class Progress:
    """What a training tells after every interval: `share` of the budget that is done (the slowest seed's), and the newest row of each seed."""

    share: float
    rows: Sequence[Row]


@dataclass(frozen=True)
class Order:
    """What is to be trained.

    Attributes:
      recipe: and `name`, what it is called.
      seeds: one training each, side by side.
      stress_factor: how much a unit of stress counts in the rewards.
      front_limit: seconds that the planner has for the exact front, against which everything is held.
    """

    cell: Cell
    recipe: Recipe
    name: str = "tandem"
    seeds: tuple[int, ...] = (0,)
    stress_factor: float = 0.0
    front_limit: float = 30.0

    def __post_init__(self) -> None:
        if not self.seeds or len(set(self.seeds)) < len(self.seeds):
            raise UsageError(f"seeds {list(self.seeds)}: give one or more, each once.")
        if not (np.isfinite(self.stress_factor) and self.stress_factor >= 0):
            raise UsageError(f"stress factor {self.stress_factor}: must be a number, 0 or more.")

    def to_dict(self) -> dict[str, Any]:
        """Plain values."""
        return {
            "cell": self.cell.to_dict(),
            "recipe": self.name,
            "settings": {"pace": self.recipe.pace, "sees": self.recipe.sees, "rewards": self.recipe.rewards, "config": self.recipe.config.to_dict()},
            "seeds": list(self.seeds),
            "stress_factor": self.stress_factor,
            "front_limit": self.front_limit,
        }

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Order:
        """The inverse of `to_dict`."""
        settings = dict(data["settings"])
        made = Recipe(Config.from_dict(settings.pop("config")), **settings)
        return cls(Cell.model_validate(data["cell"]), made, data["recipe"], tuple(data["seeds"]), data["stress_factor"], data["front_limit"])


@dataclass
class Training:
    """A training under way."""

    order: Order
    folder: RunFolder
    world: StationWorld
    front: Front | None
    learners: ppo.Learner
    interval: int = 0
    cpu_s: float = 0.0
    tensorboard: Any = None
    since: float = field(default_factory=time.process_time)

    @property
    def config(self) -> Config:
        return self.order.recipe.config

    @property
    def share(self) -> float:
        """How much of the budget the slowest seed has behind it, 0 to 1."""
        done = []
        for place in range(len(self.order.seeds)):
            stage = int(self.learners.stage[place])
            left = 0.0
            if stage < len(self.config.stages):
                now = self.config.stages[stage]
                within = (
                    int(self.learners.stage_episodes[place]) / (now.episodes or 2**31),
                    int(self.learners.stage_steps[place]) / (now.steps or 2**31),
                )
                left = min(max(within), 1.0)
            done.append((stage + left) / len(self.config.stages))
        return min(done)

    def spent(self) -> float:
        """CPU seconds so far, compiling included."""
        return self.cpu_s + time.process_time() - self.since


def train(
    cell: Cell,
    *,
    recipe_name: str = "tandem",
    own_recipe: Recipe | None = None,
    stress_factor: float = 0.0,
    seeds: Sequence[int] = (0,),
    folder: str | Path | None = None,
    front_limit: float = 30.0,
    tensorboard: bool = False,
    on_progress: Callable[[Progress], None] | None = None,
) -> dict[str, Any]:
    """Trains the cell's robot and human and returns the result document (see `documents.result`); everything is kept in the run's folder.

    Args:
      recipe_name: a name in `recipes.RECIPES`; `own_recipe` is taken instead when given.
      stress_factor: how much a unit of stress counts against a second (the rewards' step is -10 in the appendix's set).
      folder: where the run is kept; a new one under `runs/` when absent.
      front_limit: seconds for the exact front.
      tensorboard: write TensorBoard events too.
      on_progress: called after every interval; may raise KeyboardInterrupt to stop.

    A KeyboardInterrupt ends it after saving: the document then says `"interrupted": true` and `resume` goes on.

    Raises:
      CellError: the station cannot hold the cell. UsageError: an option is out of range.
      NotFiniteError: a parameter became infinite or nan; the last good checkpoint is kept.
    """
    order = Order(cell, own_recipe or recipe(recipe_name), recipe_name, tuple(seeds), stress_factor, front_limit)
    world = StationWorld.of(cell, order.recipe, stress_factor=stress_factor)
    run = RunFolder(Path(folder) if folder else new_folder(cell, recipe_name))
    run.begin(order.to_dict())
    training = Training(order, run, world, exact_front(cell, front_limit), _begin(order, world))
    _save(training)
    return _go_on(training, tensorboard, on_progress)


def resume(folder: str | Path, *, tensorboard: bool = False, on_progress: Callable[[Progress], None] | None = None) -> dict[str, Any]:
    """Goes on with a run from its newest checkpoint, to the same end (bit by bit, on the same machine) as without the stop.

    Raises CellError when the folder holds no run, or one whose checkpoint cannot be read.
    """
    run = RunFolder(Path(folder))
    order = Order.from_dict(run.asked())
    world = StationWorld.of(order.cell, order.recipe, stress_factor=order.stress_factor)
    learners, notes = checkpoint.load(run.checkpoint, _begin(order, world))
    run.back_to(notes["interval"])
    training = Training(order, run, world, exact_front(order.cell, order.front_limit), learners, notes["interval"], notes["cpu_s"])
    return _go_on(training, tensorboard, on_progress)


def exact_front(cell: Cell, limit: float) -> Front | None:
    """The planner's front, complete or not; None when it found nothing within the limit."""
    try:
        return plan(cell, time_limit=limit, seed=0)
    except NothingFoundError:
        return None


def _go_on(training: Training, tensorboard: bool, on_progress: Callable[[Progress], None] | None) -> dict[str, Any]:
    from tandem.learn.documents import result

    if tensorboard:
        from tensorboardX import SummaryWriter

        training.tensorboard = SummaryWriter(str(training.folder.path / "tensorboard"))
    interrupted = False
    try:
        while np.min(training.learners.stage) < len(training.config.stages):
            rows = _interval(training)
            if on_progress:
                on_progress(Progress(training.share, rows))
    except KeyboardInterrupt:
        interrupted = True
        _save(training)
    finally:
        if training.tensorboard:
            training.tensorboard.close()
    _save_policies(training)
    document = result(training, interrupted=interrupted)
    if not interrupted:
        training.folder.write_result(document)
    return document


def _interval(training: Training) -> list[Row]:
    """Trains up to the next figures, writes them down and saves."""
    updates = EPISODES_BETWEEN_FIGURES if training.config.stop_at_end else 1
    learners, reports = jax.block_until_ready(_advance(training.learners, training.world, training.config, updates))
    if not np.all(reports.finite):
        seeds = [seed for seed, fine in zip(training.order.seeds, np.all(reports.finite, 1), strict=True) if not fine]
        raise NotFiniteError(
            f"the numbers of seed {', '.join(map(str, seeds))} are no longer finite; training stopped. The last good checkpoint, after interval "
            f"{training.interval}, is kept in {training.folder.path}. A lower learning rate helps, or a limit on the gradient."
        )
    played = jax.device_get(_greedy(learners.parameters, training.world, training.config))
    training.learners, training.interval = learners, training.interval + 1
    rows = [
        _row(training, place, jax.tree.map(lambda leaf, place=place: leaf[place], (reports, played))) for place in range(len(training.order.seeds))
    ]
    training.folder.append(rows)
    if training.tensorboard:
        _to_tensorboard(training.tensorboard, rows)
    _save(training)
    return rows


def _row(training: Training, place: int, seen: tuple[ppo.Report, play.Played]) -> Row:
    """The figures that the thesis watches, and those that say how good the agents are; of one seed."""
    from tandem.learn.documents import gap, pair

    report, played = seen
    ended = np.asarray(report.episodes)
    last = int(np.flatnonzero(ended)[-1]) if ended.any() else len(ended) - 1
    weights = ended / max(ended.sum(), 1)
    mean, illegal = np.asarray(weights @ report.returns), np.asarray(weights @ report.illegal)
    makespan, stress = pair(training.world, training.order.cell, played, 0)
    row: Row = {
        "interval": training.interval,
        "seed": training.order.seeds[place],
        "stage": int(report.stage[-1]) + 1,
        "episodes": int(training.learners.episodes[place]),
        "steps": int(report.steps[-1]),
    }
    for name, agent in enumerate(training.world.agents):
        row[f"return_{agent}"] = round(float(report.returns[last][name]), 4)
        row[f"mean_return_{agent}"] = round(float(mean[name]), 4)
        row[f"first_value_{agent}"] = round(float(report.first_value[-1][name]), 4)
        row[f"illegal_{agent}"] = round(float(illegal[name]), 4)
        row[f"entropy_{agent}"] = round(float(np.mean(np.asarray(report.entropy)[:, name])), 5)
    row |= {"greedy_makespan": makespan, "greedy_stress": stress, "greedy_illegal": int(np.sum(played.illegal[0]))}
    row["gap"] = gap(training, makespan, stress)
    return row


def _to_tensorboard(writer: Any, rows: Sequence[Row]) -> None:
    for row in rows:
        for name, value in row.items():
            if name not in ("interval", "seed") and value is not None:
                writer.add_scalar(f"seed_{row['seed']}/{name}", value, row["steps"])


def _save(training: Training) -> None:
    checkpoint.save(training.folder.checkpoint, training.learners, {"interval": training.interval, "cpu_s": training.spent()})


def _save_policies(training: Training) -> None:
    for place, seed in enumerate(training.order.seeds):
        policy_of(training, place).save(training.folder.policy(seed))


def policy_of(training: Training, place: int) -> Policy:
    """The actors of one seed, for NumPy."""
    order, config = training.order, training.config
    actor = jax.tree.map(lambda leaf: np.asarray(leaf[place]), training.learners.parameters["actor"])
    notes = {
        "cell": order.cell.name,
        "digest": order.cell.digest,
        "recipe": order.name,
        "stress_factor": order.stress_factor,
        "seed": order.seeds[place],
        "pace": order.recipe.pace,
        "sees": order.recipe.sees,
        "rewards": order.recipe.rewards,
    }
    return Policy(training.world.agents, actor, config.activation, config.masked, config.share_actor, notes)


# --- Compiled, for all seeds ---


def _begin(order: Order, world: StationWorld) -> ppo.Learner:
    keys = jax.numpy.stack([jax.random.key(seed) for seed in order.seeds])
    return jax.jit(jax.vmap(partial(ppo.start, config=order.recipe.config), (0, None)))(keys, world)


@partial(jax.jit, static_argnames=("config", "updates"))
def _advance(learners: ppo.Learner, world: StationWorld, config: Config, updates: int) -> tuple[ppo.Learner, ppo.Report]:
    """Side by side where every rollout has the same length; else one after the other, so that none waits for the longest episode."""
    one = partial(ppo.advance, world=world, config=config, updates=updates)
    return jax.lax.map(one, learners) if config.stop_at_end else jax.vmap(one)(learners)


@partial(jax.jit, static_argnames="config")
def _greedy(parameters: ppo.Parameters, world: StationWorld, config: Config) -> play.Played:
    return jax.lax.map(lambda one: play.greedy(one, world, config, config.episode_limit or LONGEST_PLAY), parameters)


@partial(jax.jit, static_argnames="config")
def _sampled(key: jax.Array, parameters: ppo.Parameters, world: StationWorld, config: Config) -> play.Played:
    limit = config.episode_limit or LONGEST_PLAY
    return jax.lax.map(lambda one: play.sampled(key, one, world, config, limit, BEST_OF), parameters)
