"""Trained policies played beside the exact front, the best dispatch rule and a random player."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from tandem.cell.model import Cell, plain
from tandem.errors import NothingFoundError, UsageError
from tandem.learn.algorithm import TrainingOrder
from tandem.learn.baseline import best_rule
from tandem.learn.episodes import at_random
from tandem.learn.forms import unreadable
from tandem.learn.graph.recipes import GRAPH
from tandem.learn.graph.trained import KIND, notes_of
from tandem.learn.results import Reached, cost, dominating, relative_gap
from tandem.learn.training.algorithms import origin_of, trainee
from tandem.learn.training.runs import RunFolder
from tandem.learn.training.trainer import order_of
from tandem.plan.methods import plan
from tandem.plan.result import Front
from tandem.schedule.checker import faults
from tandem.schedule.model import Schedule


@dataclass(frozen=True)
class Line:
    """One player in the table.

    Attributes:
      makespan, stress: seconds and stress; means with `episodes` above 1, None when no episode was
        finished.
      makespan_ci95, stress_ci95: half widths of the 95 % intervals of the means; None for a single
        episode.
      illegal: rules broken, mean per episode.
      gap: how far the weighted cost is above the least on the exact front, as a share.
      schedule: of a single finished episode that keeps to the cell; `faults` says why there is
        none.
      beaten_by: of a single episode, the point of the exact front that is at least as good in both
        and better in one; None where there is none. With a gap of 0 the other number is not the
        best.
    """

    player: str
    episodes: int
    done: float
    makespan: float | None
    stress: float | None
    makespan_ci95: float | None
    stress_ci95: float | None
    illegal: float
    gap: float | None
    schedule: Schedule | None = None
    faults: tuple[str, ...] = ()
    beaten_by: tuple[float, float] | None = None

    def to_dict(self) -> dict[str, Any]:
        """Plain values."""
        parts = {
            name: getattr(self, name)
            for name in (
                "player",
                "episodes",
                "done",
                "makespan",
                "stress",
                "makespan_ci95",
                "stress_ci95",
                "illegal",
                "gap",
            )
        }
        return {
            **parts,
            "beaten_by": None if self.beaten_by is None else list(map(plain, self.beaten_by)),
            "assignments": self.schedule.to_list() if self.schedule else None,
            "faults": list(self.faults),
        }


@dataclass(frozen=True)
class Evaluation:
    """The players of what was learned on a cell, and the exact front that they are held against
    (None when the planner found none in time).
    """

    cell: Cell
    front: Front | None
    lines: tuple[Line, ...]
    stress_factor: float
    seed: int

    def line(self, player: str) -> Line:
        """The line of that player. Raises KeyError."""
        return {line.player: line for line in self.lines}[player]

    def to_dict(self) -> dict[str, Any]:
        """The document of `tandem evaluate --json`."""
        front = self.front
        return {
            "schema_version": 1,
            "cell": self.cell.name,
            "cell_digest": self.cell.digest,
            "stress_factor": plain(self.stress_factor),
            "seed": self.seed,
            "exact_front": (
                []
                if front is None
                else [[plain(value) for value in point] for point in front.points]
            ),
            "exact_front_complete": front is not None and front.complete,
            "players": [line.to_dict() for line in self.lines],
        }


def evaluate(
    learned: str | Path,
    cell: Cell | None = None,
    *,
    seed: int | None = None,
    episodes: int = 100,
    front_limit: float = 30.0,
) -> Evaluation:
    """Plays one seed of a run: greedy, sampled, best of the sampled; and a random player and the
    dispatch rules beside it.

    Args:
      learned: a run's folder, or the file of a policy: one that lies in its run, or the network for
        all cells wherever it lies.
      cell: another cell than the run's own; for PPO it needs the same shape. A file outside of its
        run needs one.
      seed: which policy of a folder; the run's best when absent (`RunFolder.best_seed`). It also
        seeds the draws.
      episodes: of the sampled and the random player.
      front_limit: seconds for the exact front.

    Raises:
      CellError: the folder holds no run, the file no policy, or the algorithm cannot hold the cell.
      UsageError: no such seed, no cell, or the policy does not fit the cell.
    """
    policy, seed, order = _asked(Path(learned), seed, cell)
    plays_on, learner = cell or order.cell, trainee(order.recipe.algorithm)
    costs = learner.costs(plays_on, order)
    found = learner.players(policy, plays_on, order, seed=seed, episodes=episodes)
    # last, for it takes longest: what does not fit is said before
    front = exact_front(plays_on, front_limit)
    found["random"] = at_random(plays_on, order.stress_factor, seed=seed, episodes=episodes)
    lines = [line_of(plays_on, front, costs, player, reached) for player, reached in found.items()]
    rule = _best_rule(plays_on, front, costs)
    return Evaluation(
        plays_on,
        front,
        (*lines[:-1], *([rule] if rule else []), lines[-1]),
        order.stress_factor,
        seed,
    )


def _asked(learned: Path, seed: int | None, cell: Cell | None) -> tuple[Path, int, TrainingOrder]:
    """The policy's file, its seed, and what was asked when it was trained."""
    if not learned.is_file():
        run, order = RunFolder(learned), order_of(RunFolder(learned))
        if seed is None:
            seed = run.best_seed() if run.seeds else order.seeds[0]
        if seed not in run.seeds:
            raise UsageError(
                f"{learned}: has no policy of seed {seed}; there are"
                f" {', '.join(map(str, run.seeds)) or 'none yet'}."
            )
        return run.policy(seed), seed, order
    if seed is not None:
        raise UsageError(f"seed {seed}: chooses among a run's policies; {learned} is one of them.")
    run = RunFolder(learned.parent)
    if (run.path / "run.json").exists():
        for own in run.seeds:
            if run.policy(own).samefile(learned):
                return learned, own, order_of(run)
    return _alone(learned, cell)


def _alone(file: Path, cell: Cell | None) -> tuple[Path, int, TrainingOrder]:
    """The same of a policy outside of its run: as much as the file itself says."""
    algorithm, recipe = origin_of(file)
    if algorithm != KIND:
        raise UsageError(
            f"{file}: was trained by the recipe {recipe or algorithm!r}, whose policies are judged"
            " with the settings of their run, and here is none. Name the run's folder, or the file"
            " in it."
        )
    if cell is None:
        raise UsageError(
            f"{file}: holds no cell of its own. Name what to judge it on: tandem evaluate"
            f" {file} CELL|FOLDER"
        )
    notes = notes_of(file)
    try:
        order = TrainingOrder(cell, GRAPH, recipe or KIND, (notes.seed,), notes.stress_factor)
    except UsageError as error:
        raise unreadable(file, [f"is no network: {error}"]) from None
    return file, notes.seed, order


def line_of(
    cell: Cell, front: Front | None, paid: dict[str, Any], player: str, episodes: Sequence[Reached]
) -> Line:
    """What a player's episodes come to, beside the exact front."""
    ended = [
        (episode.makespan, episode.stress)
        for episode in episodes
        if episode.makespan is not None and episode.stress is not None
    ]
    makespan, makespan_ci = _mean([makespan for makespan, _ in ended])
    stress, stress_ci = _mean([stress for _, stress in ended])
    alone = episodes[0].schedule if len(episodes) == 1 else None
    wrong = faults(cell, alone) if alone else []
    return Line(
        player,
        len(episodes),
        len(ended) / len(episodes),
        makespan,
        stress,
        makespan_ci,
        stress_ci,
        float(np.mean([episode.illegal for episode in episodes])),
        relative_gap(front, makespan, stress, **paid),
        alone if ended and not wrong else None,
        tuple(wrong),
        dominating(front, makespan, stress) if len(ended) == 1 else None,
    )


def _best_rule(cell: Cell, front: Front | None, paid: dict[str, Any]) -> Line | None:
    """The dispatch rule whose best schedule costs least under these rewards."""
    best = best_rule(cell, partial(cost, **paid))
    if best is None:
        return None
    makespan, stress = best.result.makespan, best.result.stress
    return Line(
        f"rule {best.name}",
        1,
        1.0,
        plain(makespan),
        plain(stress),
        None,
        None,
        0.0,
        relative_gap(front, makespan, stress, **paid),
        best.result.schedule,
        beaten_by=dominating(front, makespan, stress),
    )


def _mean(values: Sequence[float]) -> tuple[float | None, float | None]:
    """Mean and half width of its 95 % interval (normal approximation); Nones where there are none
    or only one.
    """
    if not values:
        return None, None
    half = 1.96 * float(np.std(values, ddof=1)) / len(values) ** 0.5 if len(values) > 1 else None
    return plain(round(float(np.mean(values)), 4)), None if half is None else round(half, 4)


def exact_front(cell: Cell, limit: float) -> Front | None:
    """The front within so many seconds; None where the planner found none."""
    try:
        return plan(cell, time_limit=limit, seed=0)
    except NothingFoundError:
        return None
