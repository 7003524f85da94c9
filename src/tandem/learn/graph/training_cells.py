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
CHAINS, JOINT, TOOLS, ZONES = 0.5, 0.1, 0.1, 0.1
"""Shares of cells whose tasks are chains, of those with joint ways, with tools and with a zone."""


def training_cell(number: int, most_tasks: int) -> Cell:
    """The cell of this number, the same in every run.

    Args:
      number: from 0.
      most_tasks: the largest size that is drawn, 5 at least.
    """
    rng = np.random.default_rng(FIRST_SEED + number)
    data = _chains(rng, most_tasks) if rng.random() < CHAINS else _layers(rng, number, most_tasks)
    if rng.random() < JOINT:
        add_joint_ways(data, rng)
    if rng.random() < TOOLS:
        add_tools(data, rng)
    if rng.random() < ZONES:
        add_zone(data, rng)
    return cell_of(data)


def _layers(rng: np.random.Generator, number: int, most_tasks: int) -> dict[str, Any]:
    """Mostly one human and one robot, as assembly cells are."""
    humans, robots = int(rng.integers(1, 3)), int(rng.integers(1, 4))
    if rng.random() < 0.6:
        humans, robots = 1, 1
    tasks = int(rng.integers(5, most_tasks + 1))
    layers = int(rng.integers(1, tasks + 1)) if rng.random() < 0.3 else None
    cell = layered(
        tasks,
        humans,
        robots,
        exclusive=float(rng.choice([0.0, 0.3, 0.3, 0.3, 0.7])),
        density=float(rng.choice([0.1, 0.2, 0.2, 0.4])),
        heterogeneity=float(rng.choice([0.0, 0.2, 0.5, 0.5, 1.0])),
        layers=layers,
        seed=FIRST_SEED + number,
    )
    return cell.to_dict()


OPERATORS = (2, 3, 4, 5, 5, 5, 6, 8, 10)
"""How many operators cells of chains have, each as often; three tasks for each at least."""


def _chains(rng: np.random.Generator, most_tasks: int) -> dict[str, Any]:
    """Products that go their own ways, as in a flexible job shop: each task by a few, by any number
    or by all operators, in times that are alike (within a fifth), in a ratio of a fifth to five, or
    that have nothing to do with each other.
    """
    operators = min(int(rng.choice(OPERATORS)), max(2, most_tasks // 3))
    humans = int(rng.integers(1, min(3, operators)))
    kinds = ["human"] * humans + ["robot"] * (operators - humans)
    names = [f"{kind}_{at + 1}" for at, kind in enumerate(kinds)]
    tasks = int(rng.integers(max(5, min(3 * operators, most_tasks)), most_tasks + 1))
    most_able = int(rng.choice([2, 3, operators, operators, operators]))
    least_able = operators if rng.random() < 0.15 else 1
    longest = int(rng.choice([6, 20, 20, 40]))
    times = int(rng.integers(3))
    entries, length = dict[str, Any](), int(rng.integers(2, 9))
    first = 0
    for task in range(tasks):
        if task - first >= length + int(rng.integers(-1, 2)):
            first = task
        count = int(rng.integers(least_able, max(least_able, most_able) + 1))
        able = sorted(rng.choice(operators, min(count, operators), replace=False).tolist())
        base = int(rng.integers(1, longest + 1))
        entry: dict[str, Any] = {
            "time": {names[one]: _time(rng, times, base) for one in able},
            "after": [str(task)] if task > first else [],
        }
        if able[0] < humans:
            entry["stress"] = int(rng.integers(11))
        entries[str(task + 1)] = entry
    people = {name: {"kind": kind} for name, kind in zip(names, kinds, strict=True)}
    return {"name": f"Chains of {length}", "operators": people, "tasks": entries}


def _time(rng: np.random.Generator, times: int, base: int) -> int:
    """Seconds of an operator: alike, in a ratio of a fifth to five, or of any length."""
    if times == 0:
        return int(rng.integers(max(1, -(-4 * base // 5)), max(1, 6 * base // 5) + 1))
    if times == 1:
        return max(1, round(base * float(np.exp(rng.uniform(-1.6, 1.6)))))
    return int(rng.integers(1, 100))


def add_joint_ways(data: dict[str, Any], rng: np.random.Generator) -> None:
    """A tenth of the tasks can be done by a human and a robot together, quicker than by either."""
    for task in data["tasks"].values():
        humans = [name for name in task["time"] if name.startswith("human")]
        robots = [name for name in task["time"] if name.startswith("robot")]
        if humans and robots and rng.random() < 0.1:
            least = min(float(seconds) for seconds in task["time"].values())
            seconds = max(1, round(least * rng.uniform(0.4, 0.9)))
            task["together"] = [{"operators": [robots[0], humans[0]], "time": seconds}]


def add_tools(data: dict[str, Any], rng: np.random.Generator) -> None:
    """Two tools of which there is one each."""
    data["tools"] = {"driver": {}, "press": {}}
    for task in data["tasks"].values():
        if rng.random() < 0.3:
            task["tool"] = str(rng.choice(["driver", "press"]))


def add_zone(data: dict[str, Any], rng: np.random.Generator) -> None:
    """A zone with room for one."""
    data["zones"] = {"fixture": {}}
    for task in data["tasks"].values():
        if rng.random() < 0.2:
            task["zone"] = "fixture"
