"""Tiny cells for one robot and one human."""

from __future__ import annotations

import numpy as np
import pytest

from tandem.cell.model import Cell

THESIS = {
    "1": ({"robot": 9, "human": 10}, 10, []),
    "2": ({"robot": 7, "human": 8}, 11, []),
    "3": ({"human": 10}, 2, []),
    "4": ({"robot": 2}, 0, ["1", "2"]),
    "5": ({"robot": 4, "human": 2}, 4, ["3"]),
    "6": ({"robot": 10, "human": 3}, 1, ["1", "2", "4"]),
    "7": ({"robot": 2, "human": 4}, 5, ["1", "2", "3", "4", "5", "6"]),
}


REPRODUCTIONS = {"quick", "short"}
"""Fixtures that run a published system once, in small: ten seconds and more."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if REPRODUCTIONS & set(getattr(item, "fixturenames", ())):
            item.add_marker(pytest.mark.slow)


def cell_of(tasks: dict, **more) -> Cell:
    """name -> (seconds per operator, stress, after) as a cell with one robot and one human."""
    return Cell.model_validate(
        {
            "operators": {"robot": {"kind": "robot"}, "human": {"kind": "human"}},
            "tasks": {
                name: {
                    "time": {who: float(seconds) for who, seconds in time.items()},
                    "stress": float(stress),
                    "after": after,
                }
                for name, (time, stress, after) in tasks.items()
            },
            **more,
        }
    )


def random_cell(seed: int, tasks: int, longest: int) -> Cell:
    """A random cell the thesis's encoding can hold: times of 2..longest seconds, stress in
    quarters, so that sums of floats are exact.
    """
    rng = np.random.default_rng(seed)
    rows = {}
    for i in range(tasks):
        who = [("robot",), ("human",), ("robot", "human"), ("robot", "human")][rng.integers(4)]
        after = [str(j + 1) for j in range(i) if rng.random() < 0.3]
        rows[str(i + 1)] = (
            {name: int(rng.integers(2, longest + 1)) for name in who},
            rng.integers(0, 20) / 4,
            after,
        )
    return cell_of(rows)


@pytest.fixture(scope="session")
def thesis() -> Cell:
    return cell_of(THESIS)


@pytest.fixture(scope="session")
def pair() -> Cell:
    """Two independent tasks of 3 s and 2 s that both can do, and a third of 2 s that waits for the
    first.
    """
    return cell_of(
        {
            "a": ({"robot": 3, "human": 4}, 1, []),
            "b": ({"robot": 2, "human": 2}, 2, []),
            "c": ({"human": 2}, 4, ["a"]),
        }
    )
