"""Trainings that people can follow, stop and take up again: several seeds side by side, figures and
a checkpoint at every interval.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import jax
import numpy as np

from tandem.cell.model import Cell
from tandem.errors import CellError, Fault, NothingFoundError, TandemError, UsageError
from tandem.learn.algorithm import AnyRecipe, Row, TrainingOrder
from tandem.learn.forms import SettingsError, unreadable
from tandem.learn.room import make_room
from tandem.learn.training import checkpoint
from tandem.learn.training.algorithms import FORMERLY, algorithm
from tandem.learn.training.recipes import RECIPES, recipe, recipe_from
from tandem.learn.training.results import gap, result
from tandem.learn.training.runs import Asked, RunFolder, asked_cell, new_folder
from tandem.learn.training.state import Training
from tandem.plan.methods import plan
from tandem.plan.result import Front


class NotFiniteError(NothingFoundError):
    """The numbers of a training stopped being finite; the last good checkpoint was kept."""


@dataclass(frozen=True)
class TrainingProgress:
    """What a training tells after every interval: `share` of the budget that is done (the slowest
    seed's), and the newest row of each seed.
    """

    share: float
    rows: Sequence[Row]


def order_of(run: RunFolder) -> TrainingOrder:
    """What a run was asked.

    Raises CellError when the folder holds no run, or one whose cell or settings do not hold; with
    everything that is wrong.
    """
    asked, faults = run.asked(), list[str]()
    try:
        cell = asked_cell(run, asked)
    except CellError as error:
        faults += [fault.message for fault in error.faults]
    try:
        made = recipe_from(_algorithm_of(asked), asked.settings)
    except SettingsError as error:
        faults += [f"settings.{fault}" for fault in error.faults]
    if faults:
        raise unreadable(run.path / "run.json", faults)
    try:
        return TrainingOrder(
            cell, made, asked.recipe, asked.seeds, asked.stress_factor, asked.front_limit
        )
    except UsageError as error:
        raise unreadable(run.path / "run.json", [str(error)]) from None


def _algorithm_of(asked: Asked) -> str:
    """The algorithm of a run; earlier versions called PPO on the thesis's station "ppo" too, and
    said its pace.
    """
    if asked.algorithm == "ppo" and "pace" in asked.settings:
        return "station"
    return FORMERLY.get(asked.algorithm, asked.algorithm)


def train(
    cell: Cell,
    *,
    recipe_name: str = "tandem",
    own_recipe: AnyRecipe | None = None,
    stress_factor: float = 0.0,
    seeds: Sequence[int] = (0,),
    folder: str | Path | None = None,
    front_limit: float = 30.0,
    tensorboard: bool = False,
    on_progress: Callable[[TrainingProgress], None] | None = None,
) -> dict[str, Any]:
    """Trains the cell's operators and returns the result document (see `documents.result`);
    everything is kept in the run's folder.

    Args:
      recipe_name: a name in `recipes.RECIPES`; `own_recipe` is taken instead when given.
      stress_factor: how much a unit of stress counts against a second (the rewards' step is -10 in
        the appendix's set).
      folder: where the run is kept; a new one under `runs/` when absent.
      front_limit: seconds for the exact front.
      tensorboard: write TensorBoard events too.
      on_progress: called after every interval; may raise KeyboardInterrupt to stop.

    A KeyboardInterrupt ends it after saving: the document then says `"interrupted": true` and
    `resume` goes on.

    Raises:
      CellError: the algorithm cannot hold the cell. UsageError: an option is out of range.
      NotFiniteError: a parameter became infinite or nan; the last good checkpoint is kept.
    """
    order = TrainingOrder(
        cell,
        own_recipe or recipe(recipe_name),
        recipe_name,
        tuple(seeds),
        stress_factor,
        front_limit,
    )
    try:
        learner = algorithm(order)
    except CellError as error:
        raise CellError([*error.faults, *_other_recipes(order)]) from None
    run = RunFolder(Path(folder) if folder else new_folder(cell, recipe_name))
    run.begin(order.to_dict())
    training = Training(order, run, learner, exact_front(cell, front_limit), learner.begin())
    _save(training)
    return _go_on(training, tensorboard, on_progress)


def _other_recipes(order: TrainingOrder) -> Iterator[Fault]:
    """Which recipes can take a cell that the order's cannot."""

    def takes(name: str, other: AnyRecipe) -> bool:
        try:
            algorithm(replace(order, recipe=other, name=name))
        except TandemError:
            return False
        return True

    able = [name for name, other in RECIPES.sound().items() if takes(name, other)]
    if able:
        yield Fault(
            f"this cell can be trained with {', '.join(able)}: tandem train CELL --recipe {able[0]}"
        )


def resume(
    folder: str | Path,
    *,
    tensorboard: bool = False,
    on_progress: Callable[[TrainingProgress], None] | None = None,
    on_notice: Callable[[str], None] = warnings.warn,
) -> dict[str, Any]:
    """Goes on with a run from its newest checkpoint, to the same end (bit by bit, on the same
    machine) as without the stop.

    When the newest checkpoint is damaged and the one before it is not, it goes on from that and
    says so with `on_notice`.

    Raises CellError when the folder holds no run, or one that is damaged beyond that; nothing has
    been changed then.
    """
    run = RunFolder(Path(folder))
    order = order_of(run)
    try:
        learner = algorithm(order)
    except UsageError as error:
        raise unreadable(run.path / "run.json", str(error).splitlines()) from None
    run.rows()  # before anything is written: figures that cannot be read must not be forgotten
    like = jax.eval_shape(learner.begin)
    (learners, notes), notice = run.newest_checkpoint(lambda path: checkpoint.load(path, like))
    if notice:
        on_notice(notice)
    run.back_to(notes.interval)
    training = Training(
        order,
        run,
        learner,
        exact_front(order.cell, order.front_limit),
        learners,
        notes.interval,
        notes.cpu_s,
    )
    return _go_on(training, tensorboard, on_progress)


def exact_front(cell: Cell, limit: float) -> Front | None:
    """The planner's front, complete or not; None when it found nothing within the limit."""
    try:
        return plan(cell, time_limit=limit, seed=0, settle=False, confirm=False)
    except NothingFoundError:
        return None


def _go_on(
    training: Training, tensorboard: bool, on_progress: Callable[[TrainingProgress], None] | None
) -> dict[str, Any]:
    if tensorboard:
        from tensorboardX import SummaryWriter

        training.tensorboard = SummaryWriter(str(training.folder.path / "tensorboard"))
    make_room()
    interrupted = False
    try:
        while training.share < 1:
            rows = _interval(training)
            if on_progress:
                on_progress(TrainingProgress(training.share, rows))
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
    learners, report = training.algorithm.advance(training.learners)
    finite = [bool(np.all(own)) for own in np.asarray(report.finite)]
    if not all(finite):
        seeds = [seed for seed, fine in zip(training.order.seeds, finite, strict=True) if not fine]
        raise NotFiniteError(
            f"the numbers of seed {', '.join(map(str, seeds))} are no longer finite; training"
            f" stopped. The last good checkpoint, after interval {training.interval}, is kept in"
            f" {training.folder.path}. A lower learning rate helps, or a limit on the gradient."
        )
    training.learners, training.interval = learners, training.interval + 1
    found = training.algorithm.rows(learners, report)
    rows = [
        {
            "interval": training.interval,
            "seed": seed,
            **row,
            "gap": gap(training, row["greedy_makespan"], row["greedy_stress"]),
        }
        for seed, row in zip(training.order.seeds, found, strict=True)
    ]
    training.folder.append(rows)
    if training.tensorboard:
        _to_tensorboard(training.tensorboard, rows)
    _save(training)
    return rows


def _to_tensorboard(writer: Any, rows: Sequence[Row]) -> None:
    for row in rows:
        for name, value in row.items():
            if name not in ("interval", "seed") and value is not None:
                writer.add_scalar(f"seed_{row['seed']}/{name}", value, row["steps"])


def _save(training: Training) -> None:
    notes = checkpoint.Notes(interval=training.interval, cpu_s=training.spent())
    training.folder.keep_checkpoint(lambda path: checkpoint.save(path, training.learners, notes))


def _save_policies(training: Training) -> None:
    for index, seed in enumerate(training.order.seeds):
        training.algorithm.save_policy(training.learners, index, training.folder.policy(seed))
