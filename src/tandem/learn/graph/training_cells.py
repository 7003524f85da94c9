"""The cells that the policy learns on, drawn without end: sizes, shapes of precedence, times,
joint ways, tools and zones. The seeds of test sets lie elsewhere.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from tandem.cell.model import Cell
from tandem.files.generators import layered
from tandem.files.validate import cell_of

FIRST_SEED = 1_000_000
"""Cells are drawn from this seed on; test sets take seeds below it."""
JOINT, TOOLS, ZONES = 0.15, 0.2, 0.2
"""Shares of cells with joint ways, with tools and with a zone."""


def training_cell(number: int, most_tasks: int) -> Cell:
    """The cell of this number, the same in every run.

    Args:
      number: from 0.
      most_tasks: the largest size that is drawn, 5 at least.
    """
    rng = np.random.default_rng(FIRST_SEED + number)
    humans, robots = int(rng.integers(1, 3)), int(rng.integers(1, 4))
    if rng.random() < 0.5:
        humans, robots = 1, 1
    tasks = int(rng.integers(5, most_tasks + 1))
    cell = layered(
        tasks,
        humans,
        robots,
        exclusive=float(rng.choice([0.0, 0.15, 0.3, 0.6])),
        density=float(rng.choice([0.1, 0.2, 0.4])),
        heterogeneity=float(rng.choice([0.2, 0.5, 1.0])),
        layers=int(rng.integers(1, tasks + 1)) if rng.random() < 0.5 else None,
        seed=FIRST_SEED + number,
    )
    data = cell.to_dict()
    if rng.random() < JOINT:
        _add_joint_ways(data, rng)
    if rng.random() < TOOLS:
        _add_tools(data, rng)
    if rng.random() < ZONES:
        _add_zone(data, rng)
    return cell_of(data)


def _add_joint_ways(data: dict[str, Any], rng: np.random.Generator) -> None:
    """A tenth of the tasks can be done by a human and a robot together, quicker than by either."""
    for task in data["tasks"].values():
        humans = [name for name in task["time"] if name.startswith("human")]
        robots = [name for name in task["time"] if name.startswith("robot")]
        if humans and robots and rng.random() < 0.1:
            least = min(float(seconds) for seconds in task["time"].values())
            seconds = max(1, round(least * rng.uniform(0.4, 0.9)))
            task["together"] = [{"operators": [robots[0], humans[0]], "time": seconds}]


def _add_tools(data: dict[str, Any], rng: np.random.Generator) -> None:
    """Two tools of which there is one each."""
    data["tools"] = {"driver": {}, "press": {}}
    for task in data["tasks"].values():
        if rng.random() < 0.3:
            task["tool"] = str(rng.choice(["driver", "press"]))


def _add_zone(data: dict[str, Any], rng: np.random.Generator) -> None:
    """A zone with room for one."""
    data["zones"] = {"fixture": {}}
    for task in data["tasks"].values():
        if rng.random() < 0.2:
            task["zone"] = "fixture"
