"""A cell with everything that a cell can say, and the thesis's."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tandem.cell.model import Cell
from tandem.files.load import load
from tandem.files.validate import cell_of

jax = pytest.importorskip("jax", reason="chance is drawn with the extra tandem[learn]")

RICH = {
    "operators": {
        "arm": {"kind": "robot"},
        "cart": {"kind": "robot", "breaks": [[12.0, 14.0]]},
        "anna": {"kind": "human", "stress_limit": 14.0, "tool": "driver"},
        "ben": {"kind": "human", "breaks": [[6.0, 9.0]]},
    },
    "tools": {
        "driver": {"capacity": 1, "changeover": {"anna": 1.5, "ben": 1.0, "arm": 0.5}},
        "wrench": {"capacity": 2, "changeover": {"anna": 2.0}},
    },
    "zones": {"bench": {"capacity": 2}},
    "same_operator": [["3", "6"]],
    "tasks": {
        "1": {"time": {"arm": 4.0, "anna": 5.0}, "stress": 3.0, "tool": "driver", "spread": 0.2},
        "2": {"time": {"cart": 6.0, "ben": 4.5}, "stress": 2.0, "zone": "bench"},
        "3": {"time": {"anna": 3.0, "ben": 4.0}, "stress": 4.0, "after": ["1"], "tool": "wrench"},
        "4": {
            "time": {"arm": 5.0},
            "together": [{"operators": ["cart", "ben"], "time": 3.0, "stress": 1.0}],
            "after": ["2"],
            "zone": "bench",
        },
        "5": {
            "time": {"anna": 2.5, "arm": 3.5, "ben": 3.0},
            "stress": 2.5,
            "after": ["1", "2"],
            "release": 7.0,
            "deadline": 30.0,
        },
        "6": {
            "time": {"anna": 2.0, "ben": 2.0},
            "stress": 4.0,
            "after": ["4", "5"],
            "tool": "driver",
            "zone": "bench",
        },
    },
}


@pytest.fixture(scope="session")
def thesis() -> Cell:
    return load("examples/thesis.yaml")


@pytest.fixture(scope="session")
def rich() -> Cell:
    return cell_of({"name": "rich", **RICH})


@pytest.fixture(autouse=True)
def _no_rank_promotion() -> Iterator[None]:
    """A forgotten axis fails instead of being guessed."""
    with jax.numpy_rank_promotion("raise"):
        yield
