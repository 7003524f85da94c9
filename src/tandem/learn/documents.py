"""What trainings say: makespan and stress of what was played, the gap to the exact optimum, and the result document."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import jax
import numpy as np

from tandem.cell.model import Cell, plain
from tandem.envs.thesis.episode import seconds
from tandem.envs.thesis.station import whole_ticks
from tandem.learn.gaps import relative_gap
from tandem.learn.play import Played
from tandem.learn.stations import StationWorld

if TYPE_CHECKING:
    from tandem.learn.trainer import Training


def pair(world: StationWorld, cell: Cell, played: Played, place: int) -> tuple[float | None, float | None]:
    """(makespan in seconds, stress) of an episode; (None, None) when it did not come to its end."""
    if not played.done[place]:
        return None, None
    return plain(seconds(int(played.state.clock[place]), whole_ticks(cell))), plain(round(float(played.state.stress[place]), 6))


def gap(training: Training, makespan: float | None, stress: float | None) -> float | None:
    """`relative_gap` under the training's rewards."""
    return relative_gap(training.front, makespan, stress, **weights(training))


def weights(training: Training) -> dict[str, Any]:
    """The keyword arguments of `cost` for a training."""
    step = float(training.world.rewards.step)
    return {"step": step, "per_second": whole_ticks(training.order.cell), "stress_factor": training.order.stress_factor}


def result(training: Training, *, interrupted: bool = False) -> dict[str, Any]:
    """The document of `tandem train --json`.

    `seeds[].greedy`: the joint policy of most probable actions; `best_of_n`: of n sampled episodes the one with the largest sum of returns.
    Makespan and stress are None where the assembly was not finished. `gap` is that of `relative_gap`.
    """
    from tandem.learn.trainer import BEST_OF, _greedy, _sampled

    config, seeds = training.config, training.order.seeds
    greedy = jax.device_get(_greedy(training.learners.parameters, training.world, config))
    drawn = jax.device_get(_sampled(jax.random.key(seeds[0]), training.learners.parameters, training.world, config))
    spent = training.spent() / len(seeds)
    rows = []
    for place, seed in enumerate(seeds):
        plain_play, draws = jax.tree.map(lambda leaf, place=place: leaf[place], (greedy, drawn))
        rows.append(
            {
                "seed": seed,
                "steps": int(training.learners.steps[place]),
                "cpu_s": round(spent, 3),
                "greedy": _played(training, plain_play, 0),
                "best_of_n": {"n": BEST_OF, **_played(training, draws, best(draws))},
            }
        )
    front = training.front
    return {
        "schema_version": 1,
        "run": str(training.folder.path),
        "cell": training.order.cell.name,
        "cell_digest": training.order.cell.digest,
        "recipe": training.order.name,
        "stress_factor": plain(training.order.stress_factor),
        "interrupted": interrupted,
        "exact_front": [] if front is None else [[plain(value) for value in point] for point in front.points],
        "exact_front_complete": front is not None and front.complete,
        "seeds": rows,
    }


def best(played: Played) -> int:
    """Which of the episodes that ended has the largest sum of returns; 0 when none ended."""
    return int(np.argmax(np.where(played.done, np.asarray(played.returns).sum(-1), -np.inf)))


def _played(training: Training, played: Played, place: int) -> dict[str, Any]:
    makespan, stress = pair(training.world, training.order.cell, played, place)
    return {"makespan": makespan, "stress": stress, "illegal": int(np.sum(played.illegal[place])), "gap": gap(training, makespan, stress)}
