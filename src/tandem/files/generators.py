"""Random cells for experiments and benchmarks; the same seed gives the same cell."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from tandem.cell.model import Cell

if TYPE_CHECKING:
    import numpy as np

SHORTEST, LONGEST = 2, 30
"""Seconds between which times are drawn."""
HARDEST = 10
"""The most stress that a task is drawn with."""


def layered(
    tasks: int,
    humans: int = 1,
    robots: int = 1,
    *,
    exclusive: float = 0.3,
    density: float = 0.2,
    heterogeneity: float = 0.5,
    layers: int | None = None,
    seed: int,
) -> Cell:
    """A cell whose tasks lie in layers, each waiting for some of the layer before.

    Every draw is uniform and comes from NumPy's `default_rng(seed)`, in this order:

    - layer of a task: each layer has one task, the others are spread over all; tasks are numbered
      layer by layer.
    - predecessors: each task of the layer before with probability `density`; where none is drawn,
      one of them.
    - time: a base of 2 to 30 s for the task and an own time of 2 to 30 s for each operator, both
      whole; `(1 - heterogeneity) * base + heterogeneity * own`, rounded to whole seconds, half to
      even. At 0 all operators take the same time, at 1 their times have nothing to do with each
      other.
    - who can do it: with probability `exclusive` only the humans or only the robots, either with
      equal chance (where there is only one kind: only one operator); else everyone.
    - stress: 0 to 10, whole, for tasks that a human can do.

    Args:
      tasks, humans, robots: how many.
      exclusive, density, heterogeneity: shares from 0 to 1.
      layers: how many; the square root of the number of tasks, rounded, when not given.

    Raises:
      ValueError: a number is out of its range.
    """
    import numpy as np

    layers = max(1, round(math.sqrt(tasks))) if layers is None else layers
    _check(
        tasks,
        humans,
        robots,
        layers,
        exclusive=exclusive,
        density=density,
        heterogeneity=heterogeneity,
    )
    rng = np.random.default_rng(seed)
    names = [f"robot_{place + 1}" for place in range(robots)] + [
        f"human_{place + 1}" for place in range(humans)
    ]
    layer = np.sort(np.concatenate([np.arange(layers), rng.integers(layers, size=tasks - layers)]))
    after = _predecessors(rng, layer, density)
    base = rng.integers(SHORTEST, LONGEST + 1, size=(tasks, 1))
    own = rng.integers(SHORTEST, LONGEST + 1, size=(tasks, len(names)))
    times = np.rint((1 - heterogeneity) * base + heterogeneity * own).astype(int)
    able = _able(rng, tasks, humans, robots, exclusive)
    stress = rng.integers(HARDEST + 1, size=tasks)
    entries: dict[str, Any] = {}
    for task in range(tasks):
        entry: dict[str, Any] = {
            "time": {
                name: int(times[task, place])
                for place, name in enumerate(names)
                if able[task, place]
            }
        }
        if able[task, robots:].any():
            entry["stress"] = int(stress[task])
        entry["after"] = [str(first + 1) for first in after[task]]
        entries[str(task + 1)] = entry
    operators = {
        name: {"kind": "robot" if place < robots else "human"} for place, name in enumerate(names)
    }
    return Cell.model_validate(
        {
            "name": f"Layered random cell, {tasks} tasks, seed {seed}",
            "operators": operators,
            "tasks": entries,
        }
    )


def _check(tasks: int, humans: int, robots: int, layers: int, **shares: float) -> None:
    if tasks < 1 or humans < 0 or robots < 0 or humans + robots < 1:
        raise ValueError(
            f"{tasks} tasks, {humans} humans, {robots} robots: a cell needs a task and an operator"
            " at least."
        )
    if not 1 <= layers <= tasks:
        raise ValueError(
            f"layers is {layers}, but must be between 1 and the number of tasks, {tasks}."
        )
    for name, share in shares.items():
        if not 0 <= share <= 1:
            raise ValueError(f"{name} is {share}, but must be between 0 and 1.")


def _predecessors(rng: np.random.Generator, layer: np.ndarray, density: float) -> list[list[int]]:
    import numpy as np

    after: list[list[int]] = []
    for depth in layer:
        before = np.flatnonzero(layer == depth - 1)
        if len(before) == 0:
            after.append([])
            continue
        drawn = before[rng.random(len(before)) < density]
        after.append(
            [int(first) for first in (drawn if len(drawn) else before[[rng.integers(len(before))]])]
        )
    return after


def _able(
    rng: np.random.Generator, tasks: int, humans: int, robots: int, exclusive: float
) -> np.ndarray:
    """`[task, operator]` bool, robots first."""
    import numpy as np

    able = np.ones((tasks, robots + humans), dtype=bool)
    special = rng.random(tasks) < exclusive
    if humans and robots:
        for_robots = rng.random(tasks) < 0.5
        able[special & for_robots, robots:] = False
        able[special & ~for_robots, :robots] = False
    else:
        only = rng.integers(robots + humans, size=tasks)
        able[special] = np.arange(robots + humans) == only[special, None]
    return able
